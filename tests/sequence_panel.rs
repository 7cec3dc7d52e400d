//! The view of an RGB-D sequence, driven by the names that screen readers see, in the whole window.

mod step_window;

use std::path::{Path, PathBuf};

use egui::Key;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use handeye::app::workbench::sequence::{SequenceCommand, TrackOptions};
use handeye::app::{Command, NoticeKind};
use handeye::calibrate::Method;
use handeye::odometry::Estimator;
use handeye::session;
use handeye::text::sequence as words;
use handeye::ui::{Start, Step, Window};
use step_window::{apply, click, settle, workbench};

fn sample() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("sample_sessions/room-on-robot.json")
}

/// The window with a session file or a sequence's folder, at the sequence.
fn window_on(path: &Path) -> Harness<'static, Window> {
    let mut harness = Harness::builder()
        .with_size([1440.0, 900.0])
        .with_os(egui::os::OperatingSystem::Nix)
        .build_eframe(|creation| Window::new(creation, Start::default()));
    harness.state_mut().shell_mut().workbench_mut().apply(Command::to_read(vec![path.to_owned()]));
    settle(&mut harness);
    harness.state_mut().shell_mut().go_to(Step::Arcs);
    settle(&mut harness);
    harness
}

fn frame_in_sight(harness: &Harness<'static, Window>) -> Option<usize> {
    workbench(harness).sequence().pictures().map(|pictures| pictures.frame_idx)
}

fn press(harness: &mut Harness<'static, Window>, key: Key) {
    harness.key_press(key);
    settle(harness);
}

#[test]
fn a_sequence_is_tracked_by_itself_and_gives_the_calibration() {
    let harness = window_on(&sample());
    let tracked = workbench(&harness).sequence().tracked().expect("tracked to its end");
    assert_eq!(tracked.records.len(), 31);
    // The table of docs/samples.md says 0.4 mm; a camera that is lost is off by centimetres.
    assert!(tracked.evaluation.expect("there is a ground truth").ate_rmse_mm < 1.0);
    let results = workbench(&harness).results().expect("solved");
    let solution = results.method(Method::Motion).expect("there is flange.txt").outcome.as_ref().expect("solved");
    assert!(solution.uncertainty.is_some());
    for name in [words::PICTURE, words::WAY, words::TRAVEL, words::EFFORT] {
        assert!(harness.query_all_by_label(name).next().is_some(), "{name}");
    }
    assert!(harness.query_by_label(words::STEP).is_some(), "the rail speaks of a sequence");
}

#[test]
fn keys_and_buttons_go_through_the_frames() {
    let mut harness = window_on(&sample());
    assert_eq!(frame_in_sight(&harness), Some(30), "the newest is followed while it is tracked");
    press(&mut harness, Key::Home);
    assert_eq!(frame_in_sight(&harness), Some(0));
    press(&mut harness, Key::ArrowRight);
    press(&mut harness, Key::ArrowRight);
    assert_eq!(frame_in_sight(&harness), Some(2));
    click(&mut harness, words::FRAME_BEFORE);
    assert_eq!(frame_in_sight(&harness), Some(1));
    click(&mut harness, words::LAST_FRAME);
    assert_eq!(frame_in_sight(&harness), Some(30));
    for shown in [words::COLOR, words::DEPTH, words::ALIGNED, words::FEATURES, words::MATCHES] {
        click(&mut harness, shown);
        assert!(harness.query_by_label(&words::picture_name(shown)).is_some(), "{shown}");
    }
    click(&mut harness, words::IN_SPACE);
    assert!(harness.query_by_label(words::SPACE_NAME).is_some());
}

#[test]
fn the_published_estimator_can_be_chosen() {
    let mut harness = window_on(&sample());
    let ours = workbench(&harness).sequence().tracked().and_then(|tracked| tracked.evaluation).expect("a truth");
    let published = TrackOptions { estimator: Estimator::Published, period_s: None };
    apply(&mut harness, Command::Sequence(SequenceCommand::Track(published)));
    let tracked = workbench(&harness).sequence().tracked().expect("tracked to its end");
    let theirs = tracked.evaluation.expect("a truth");
    assert!(theirs.rpe_translation_rmse_mm > ours.rpe_translation_rmse_mm, "{theirs:?} {ours:?}");
}

#[test]
fn a_folder_becomes_a_session_beside_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let sequence = folder.path().join("walk");
    let copy = |from: &Path, to: &Path| {
        std::fs::create_dir_all(to).expect("a folder");
        for entry in std::fs::read_dir(from).expect("a folder") {
            let entry = entry.expect("an entry");
            if entry.path().is_file() {
                std::fs::copy(entry.path(), to.join(entry.file_name())).expect("copied");
            }
        }
    };
    let recorded = sample().with_file_name("room-on-robot-sequence");
    for part in ["", "rgb", "depth"] {
        copy(&recorded.join(part), &sequence.join(part));
    }
    // Only what a free camera has: no robot, no truth, and one picture is damaged.
    for name in ["flange.txt", "groundtruth.txt"] {
        std::fs::remove_file(sequence.join(name)).expect("removed");
    }
    let damaged = std::fs::read_dir(sequence.join("rgb")).expect("a folder").next().expect("one").expect("one").path();
    std::fs::write(&damaged, b"no picture").expect("written");
    let mut harness = window_on(&sequence);
    let tracked = workbench(&harness).sequence().tracked().expect("tracked to its end");
    let num_broken = tracked.records.iter().filter(|record| record.outcome.is_err()).count();
    assert_eq!((tracked.records.len(), num_broken), (31, 1));
    let results = workbench(&harness).results().expect("an answer");
    let refusal = results.refusal.as_deref().expect("no calibration");
    assert!(refusal.contains("flange.txt"), "{refusal}");
    apply(&mut harness, Command::Save);
    let saved = session::load(&folder.path().join("walk.json")).expect("saved beside the folder");
    assert!(matches!(saved.target, session::Target::Rgbd { sequence } if sequence == "walk"));
}

#[test]
fn a_folder_that_is_no_sequence_says_what_it_lacks() {
    let folder = tempfile::tempdir().expect("a folder");
    let command = Command::to_open_sequence(folder.path());
    assert!(matches!(&command, Command::Tell(NoticeKind::Error, said) if said.contains("camera.json")), "{command:?}");
    let sequence = sample().with_file_name("room-on-robot-sequence");
    assert_eq!(Command::to_open_sequence(&sequence), Command::Open(sequence));
}

#[test]
fn what_is_wrong_with_a_folder_is_said() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("lost.json");
    let text = std::fs::read_to_string(sample()).expect("the sample");
    std::fs::write(&file, text).expect("written");
    let harness = window_on(&file);
    let refusal = workbench(&harness).results().and_then(|results| results.refusal.clone()).expect("a refusal");
    assert!(refusal.contains("room-on-robot-sequence"), "{refusal}");
    assert!(harness.query_all_by_label(&refusal).next().is_some(), "it is shown: {refusal}");
}
