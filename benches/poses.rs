//! What a frame and an edit of the pose table cost with 2,000 stations: `cargo bench --bench poses`.
#![allow(clippy::expect_used, reason = "a benchmark that cannot run must stop")]

use std::sync::Arc;
use std::time::{Duration, Instant};

use egui::{Event, Key, Modifiers, Pos2, RawInput, Rect, vec2};
use handeye::app::{Command, Workbench};
use handeye::geometry::{Transform, Vec3, so3};
use handeye::session::edit::CellValue;
use handeye::session::{self, Edit, Place, Session, check, samples};
use handeye::ui::poses::panel::{self, PosesState};
use handeye::ui::{self, PanelContext, Selection};

/// Stations of the session.
const NUM_STATIONS: u16 = 2000;
/// Edits that are averaged over.
const NUM_EDITS: u32 = 30;
/// Frames that are averaged over.
const NUM_FRAMES: u32 = 200;

fn main() {
    if !std::env::args().any(|argument| argument == "--bench") {
        return;
    }
    let session = large_session();
    let timed = |what: &str, times: u32, run: &mut dyn FnMut()| {
        run();
        let start = Instant::now();
        (0..times).for_each(|_| run());
        println!("{what}: {:.3} ms", start.elapsed().as_secs_f64() * 1e3 / f64::from(times));
    };
    timed("check of the session", 20, &mut || {
        std::hint::black_box(check::findings(&session));
    });
    let pose = session.stations[7].captures[0].base_from_flange;
    let edit = Edit::SetCells(vec![(Place { station_idx: 1000, capture_idx: 0 }, CellValue::Pose(pose, None))]);
    timed("one edit, applied", 50, &mut || {
        std::hint::black_box(edit.apply(&session).expect("it can be made"));
    });

    let mut workbench = Workbench::new(Arc::new(|| {}));
    workbench.open_session(session, None);
    workbench.apply(Command::CancelSolve);
    let ctx = egui::Context::default();
    ui::theme::install(&ctx);
    let mut table = Table {
        workbench,
        selection: Selection::default(),
        state: PosesState::default(),
        ctx,
        time: 0.0,
        drawing: Duration::ZERO,
        applying: Duration::ZERO,
    };
    for _ in 0..5 {
        table.frame(Vec::new());
    }
    timed("one frame at rest", NUM_FRAMES, &mut || table.frame(Vec::new()));
    table.press(Key::ArrowDown);
    timed("one frame with the cursor going down", NUM_FRAMES, &mut || table.press(Key::ArrowDown));
    timed("one frame, scrolled by pages", 90, &mut || table.press(Key::PageDown));
    // The solver starts anew with every edit; it is stopped, so that it does not take its share of the processor.
    (table.drawing, table.applying) = (Duration::ZERO, Duration::ZERO);
    for _ in 0..NUM_EDITS {
        table.frame(vec![Event::Text("5".to_owned())]);
        table.press(Key::Enter);
        table.workbench.apply(Command::CancelSolve);
        while table.workbench.is_busy() {
            table.workbench.poll();
            std::thread::yield_now();
        }
        table.frame(Vec::new());
    }
    let mean_ms = |duration: Duration| duration.as_secs_f64() * 1e3 / f64::from(NUM_EDITS);
    println!("a number typed, three frames: {:.3} ms", mean_ms(table.drawing));
    println!("its edit on the bench, solver started: {:.3} ms", mean_ms(table.applying));
}

struct Table {
    workbench: Workbench,
    selection: Selection,
    state: PosesState,
    ctx: egui::Context,
    time: f64,
    drawing: Duration,
    applying: Duration,
}

impl Table {
    fn press(&mut self, key: Key) {
        let event = Event::Key { key, physical_key: None, pressed: true, repeat: false, modifiers: Modifiers::NONE };
        self.frame(vec![event]);
    }

    fn frame(&mut self, events: Vec<Event>) {
        self.time += 1.0 / 60.0;
        let input = RawInput {
            screen_rect: Some(Rect::from_min_size(Pos2::ZERO, vec2(1440.0, 900.0))),
            time: Some(self.time),
            events,
            ..RawInput::default()
        };
        let start = Instant::now();
        let mut commands = Vec::new();
        let mut output = self.ctx.run_ui(input, |ui| {
            let mut context = PanelContext {
                workbench: &self.workbench,
                selection: &mut self.selection,
                commands: &mut commands,
                actions: &mut Vec::new(),
            };
            panel::show(ui, &mut context, &mut self.state);
        });
        // Nothing here has a texture to put them into.
        output.textures_delta.clear();
        let primitives = self.ctx.tessellate(output.shapes, output.pixels_per_point);
        std::hint::black_box(primitives);
        self.drawing += start.elapsed();
        let start = Instant::now();
        for command in commands {
            self.workbench.apply(command);
        }
        self.applying += start.elapsed();
    }
}

/// A printed session with its first station measured again and again from other poses.
fn large_session() -> Session {
    let sample = samples::ALL.iter().find(|sample| sample.file_name == "lin-mu-2019-table-1.json").expect("a sample");
    let mut session = session::parse(sample.json.as_bytes(), sample.file_name).expect("a session");
    session.published = None;
    let model = session.stations[0].clone();
    for idx in 5..NUM_STATIONS {
        let mut station = model.clone();
        station.label = (idx + 1).to_string();
        let along = f64::from(idx);
        let position = Vec3::new(300.0 + 100.0 * along.sin(), 80.0 * (1.7 * along).cos(), 60.0 + 0.1 * along);
        let rotation = so3::exp(Vec3::new(3.0 + 0.2 * along.sin(), 0.3 * along.cos(), 0.2));
        station.captures[0].base_from_flange = Transform::from_parts(position, rotation);
        station.captures[0].written_angles = None;
        session.stations.push(station);
    }
    session
}
