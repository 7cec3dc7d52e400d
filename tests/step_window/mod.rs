//! What tests of a step in the whole window share: it is driven by the names that screen readers see.

#![allow(dead_code, reason = "each test of a step takes what it needs")]

use std::time::{Duration, Instant};

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use handeye::app::{Command, Workbench};
use handeye::session::Session;
use handeye::ui::{Start, Step, Window};

pub fn workbench<'a>(harness: &'a Harness<'static, Window>) -> &'a Workbench {
    harness.state().shell().workbench()
}

/// Runs until nothing is under way; how long that takes is the machine's affair.
pub fn settle(harness: &mut Harness<'static, Window>) {
    const PATIENCE: Duration = Duration::from_mins(2);
    let start = Instant::now();
    harness.run_steps(2);
    while harness.state().shell().is_busy() {
        assert!(start.elapsed() < PATIENCE, "{:?}", workbench(harness).notices());
        harness.step();
        std::thread::sleep(Duration::from_millis(2));
    }
    harness.run_steps(3);
}

/// The window with a session, at a step.
pub fn window_at(step: Step, session: Session, size: [f32; 2]) -> Harness<'static, Window> {
    let mut harness = Harness::builder()
        .with_size(size)
        .with_os(egui::os::OperatingSystem::Nix)
        .build_eframe(|creation| Window::new(creation, Start::default()));
    let shell = harness.state_mut().shell_mut();
    shell.workbench_mut().open_session(session, None);
    settle(&mut harness);
    harness.state_mut().shell_mut().go_to(step);
    settle(&mut harness);
    harness
}

/// The window with a session, at Verify.
pub fn window_of_size(session: Session, size: [f32; 2]) -> Harness<'static, Window> {
    window_at(Step::Verify, session, size)
}

pub fn window_on(session: Session) -> Harness<'static, Window> {
    window_of_size(session, [1440.0, 900.0])
}

pub fn click(harness: &mut Harness<'static, Window>, name: &str) {
    harness.get_by_label(name).scroll_to_me();
    harness.run_steps(3);
    harness.get_by_label(name).click();
    settle(harness);
}

pub fn apply(harness: &mut Harness<'static, Window>, command: Command) {
    harness.state_mut().shell_mut().workbench_mut().apply(command);
    settle(harness);
}
