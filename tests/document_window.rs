//! The document in the window: its fields, its history, and the questions that keep it safe.
#![expect(clippy::expect_used, reason = "a test that finds nothing to check must fail")]

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use egui::accesskit::Role;
use egui::{Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use handeye::app::{Command, Document, RecoverySettings, Workbench};
use handeye::calibrate::Mount;
use handeye::geometry::Vec3;
use handeye::session::{self, Edit, Session, SetupField, Target, samples};
use handeye::text::{document as words, import as import_words, shell as shell_words, start as start_words};
use handeye::ui::{Start, Step, Window};

type Handeye = Harness<'static, Window>;

fn window_with(start: Start) -> Handeye {
    let mut harness = Harness::builder()
        .with_size([1440.0, 900.0])
        .with_os(egui::os::OperatingSystem::Nix)
        .build_eframe(|creation| Window::new(creation, start));
    settle(&mut harness);
    harness
}

/// Runs until no job is left and the window has shown what came of them.
fn settle(harness: &mut Handeye) {
    loop {
        harness.step();
        if !harness.state().shell().is_busy() {
            break;
        }
        std::thread::yield_now();
    }
    harness.run_steps(3);
}

/// Runs until what the recovery thread does has come to the window.
fn settle_until(harness: &mut Handeye, is_done: impl Fn(&Workbench) -> bool) {
    while !is_done(workbench(harness)) {
        harness.step();
        std::thread::yield_now();
    }
    settle(harness);
}

fn click(harness: &mut Handeye, name: &str) {
    harness.get_by_label(name).click();
    settle(harness);
}

fn workbench(harness: &Handeye) -> &Workbench {
    harness.state().shell().workbench()
}

fn document(harness: &Handeye) -> &Document {
    workbench(harness).document().expect("a session is open")
}

fn request(harness: &mut Handeye, command: Command) {
    harness.state_mut().shell_mut().request(command);
    settle(harness);
}

fn set_notes(harness: &mut Handeye, notes: &str) {
    request(harness, Command::Edit { edit: Edit::Setup(SetupField::Notes(notes.to_owned())), gesture: None });
}

/// The window with a sample's file of its own.
fn window_with_file(folder: &Path) -> (Handeye, PathBuf) {
    let path = folder.join("cell-3.json");
    fs::write(&path, samples::ALL[0].json).expect("written");
    (window_with(Start { file: Some(path.clone()), ..Start::default() }), path)
}

/// Puts the cursor into a field behind its text. Its label stands beside it under the same name.
fn enter(harness: &mut Handeye, name: &str) {
    harness.get_by_role_and_label(Role::TextInput, name).focus();
    harness.run_steps(2);
    harness.key_press(Key::End);
    harness.run_steps(2);
}

fn type_text(harness: &mut Handeye, name: &str, text: &str) {
    for letter in text.chars() {
        harness.get_by_role_and_label(Role::TextInput, name).type_text(&letter.to_string());
        harness.run_steps(2);
    }
}

/// Types a number in place of the one that is there.
fn retype(harness: &mut Handeye, name: &str, text: &str) {
    enter(harness, name);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    harness.run_steps(2);
    type_text(harness, name, text);
}

fn radius_mm(harness: &Handeye) -> f64 {
    match document(harness).session.target {
        Target::Ball { radius_mm, .. } => radius_mm,
        _ => f64::NAN,
    }
}

fn radius_field() -> String {
    start_words::field_name(start_words::BALL_RADIUS, "mm")
}

fn open_sample() -> Handeye {
    let mut harness = window_with(Start::default());
    request(&mut harness, Command::OpenSample(0));
    harness.state_mut().shell_mut().go_to(Step::Session);
    settle(&mut harness);
    harness
}

#[test]
fn a_typing_is_one_step_and_the_text_follows_an_undo() {
    let mut harness = open_sample();
    let before = document(&harness).session.name.clone();
    enter(&mut harness, start_words::NAME);
    type_text(&mut harness, start_words::NAME, " abc");
    assert_eq!(document(&harness).session.name, format!("{before} abc"));
    assert_eq!(document(&harness).history.undo_labels().collect::<Vec<_>>(), ["change the session's name"]);
    // The field keeps the focus, and shows what was undone instead of writing over it.
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    settle(&mut harness);
    assert_eq!(document(&harness).session.name, before);
    enter(&mut harness, start_words::NAME);
    type_text(&mut harness, start_words::NAME, "!");
    assert_eq!(document(&harness).session.name, format!("{before}!"));
}

#[test]
fn a_number_is_taken_over_when_its_field_is_left_and_a_wrong_one_says_why() {
    let mut harness = open_sample();
    let before = radius_mm(&harness);
    let field = radius_field();
    retype(&mut harness, &field, "12,75");
    assert_eq!(radius_mm(&harness).to_bits(), before.to_bits(), "not yet");
    harness.key_press(Key::Enter);
    settle(&mut harness);
    assert!((radius_mm(&harness) - 12.75).abs() < 1e-12);

    retype(&mut harness, &field, "0");
    harness.key_press(Key::Tab);
    settle(&mut harness);
    assert!((radius_mm(&harness) - 12.75).abs() < 1e-12, "a wrong number does not reach the document");
    let reason = "✖ found 0, needed a ball's radius in mm from 0.001 to 10000";
    harness.get_by_label(reason);
    // Another edit leaves it in sight; one of the same field drops it.
    set_notes(&mut harness, "x");
    harness.get_by_label(reason);
    request(&mut harness, Command::Undo);
    request(&mut harness, Command::Undo);
    assert_eq!(radius_mm(&harness).to_bits(), before.to_bits());
    assert!(harness.query_by_label(reason).is_none());
    retype(&mut harness, &field, "7");
    harness.key_press(Key::Escape);
    settle(&mut harness);
    assert_eq!(radius_mm(&harness).to_bits(), before.to_bits(), "Escape gives it up");
}

#[test]
fn what_is_known_of_targets_is_shown_typed_and_undone() {
    let open = |name: &str| {
        let mut harness = window_with(Start::default());
        let sample = samples::ALL.iter().position(|sample| sample.file_name == name).expect("a sample");
        request(&mut harness, Command::OpenSample(sample));
        harness.state_mut().shell_mut().go_to(Step::Session);
        settle(&mut harness);
        harness
    };
    for (name, shown) in [
        ("three-targets.json", "right-angle plate · 18 of 18 stations used"),
        ("workpiece.json", "workpiece · 2 of 2 stations used · pitch 15 mm · height 10 mm"),
    ] {
        open(name).get_by_label(shown);
    }
    let mut harness = open("tip.json");
    let before = document(&harness).session.clone();
    retype(&mut harness, &start_words::field_name(start_words::TOUCHED_POINT, "mm"), "1 2,5; -3");
    harness.key_press(Key::Enter);
    settle(&mut harness);
    let touched_mm = document(&harness).session.known.point_in_base_mm;
    assert_eq!(touched_mm, Some(Vec3::new(1.0, 2.5, -3.0)));
    retype(&mut harness, &start_words::field_name(start_words::ROUGH_MOUNTING, "mm °"), "10 0 120 0 0 90");
    harness.key_press(Key::Enter);
    settle(&mut harness);
    assert!(document(&harness).session.sensor.rough_flange_from_sensor.is_some());
    request(&mut harness, Command::Undo);
    request(&mut harness, Command::Undo);
    assert_eq!(document(&harness).session, before);
}

#[test]
fn a_focused_field_does_not_overwrite_an_undo() {
    let mut harness = open_sample();
    let before = radius_mm(&harness);
    request(&mut harness, Command::Edit { edit: Edit::Setup(SetupField::Target(Target::ball(20.0))), gesture: None });
    retype(&mut harness, &radius_field(), "21");
    // From outside, as a button of the bar would do after the field was left; here it still has the focus.
    harness.state_mut().shell_mut().workbench_mut().apply(Command::Undo);
    settle(&mut harness);
    assert_eq!(radius_mm(&harness).to_bits(), before.to_bits());
    harness.key_press(Key::Tab);
    settle(&mut harness);
    assert_eq!(radius_mm(&harness).to_bits(), before.to_bits());
}

#[test]
fn what_is_typed_is_part_of_what_is_saved() {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut harness, path) = window_with_file(folder.path());
    retype(&mut harness, &radius_field(), "12.5");
    harness.key_press_modifiers(Modifiers::COMMAND, Key::S);
    settle(&mut harness);
    assert_eq!(session::load(&path).expect("loads").target, document(&harness).session.target);
    assert!((radius_mm(&harness) - 12.5).abs() < 1e-12);
    assert!(!document(&harness).is_unsaved());
}

#[test]
fn noise_that_is_not_stated_is_an_empty_field_and_the_mount_is_chosen() {
    let mut harness = open_sample();
    let field = start_words::field_name(start_words::POSITION_STD, "mm");
    retype(&mut harness, &field, "0.03");
    harness.key_press(Key::Enter);
    settle(&mut harness);
    assert_eq!(document(&harness).session.robot.position_std_mm, Some(0.03));
    enter(&mut harness, &field);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    harness.key_press(Key::Backspace);
    harness.run_steps(2);
    harness.key_press(Key::Enter);
    settle(&mut harness);
    assert_eq!(document(&harness).session.robot.position_std_mm, None);
    harness.get_by_role_and_label(Role::ComboBox, start_words::MOUNT).click();
    settle(&mut harness);
    click(&mut harness, start_words::mount(Mount::Fixed));
    assert_eq!(document(&harness).session.mount, Mount::Fixed);
}

#[test]
fn a_new_session_leads_to_the_poses() {
    let mut harness = window_with(Start::default());
    let field = start_words::OTHER_BALL_NAME;
    retype(&mut harness, field, "0");
    click(&mut harness, start_words::BEGIN);
    harness.get_by_label("✖ found 0, needed a ball's radius in mm from 0.001 to 10000");
    retype(&mut harness, field, "9,525");
    click(&mut harness, start_words::BEGIN);
    assert_eq!(*document(&harness).session, Session::new(Target::ball(9.525)));
    assert_eq!(harness.state().shell().step(), Step::Poses);
    assert!(!document(&harness).is_unsaved(), "an empty session is no loss");
}

#[test]
fn the_history_lists_all_steps_and_goes_to_any() {
    let mut harness = open_sample();
    harness.key_press_modifiers(Modifiers::COMMAND, Key::H);
    settle(&mut harness);
    harness.get_by_label(words::NO_HISTORY);
    let before = document(&harness).session.notes.clone();
    for notes in ["a", "b", "c"] {
        set_notes(&mut harness, notes);
    }
    harness.get_by_label(&words::history_step("change the notes", true));
    click(&mut harness, &words::history_step(words::AS_OPENED, false));
    assert_eq!(document(&harness).session.notes, before);
    assert!(!document(&harness).is_unsaved());
    harness.get_by_label(&words::history_step(words::AS_OPENED, true));
    let name = words::history_step("change the notes", false);
    let steps: Vec<_> = harness.get_all_by_label(&name).collect();
    assert_eq!(steps.len(), 3);
    steps[1].click();
    settle(&mut harness);
    assert_eq!(document(&harness).session.notes, "b");
}

#[test]
fn a_changed_file_is_answered_with_a_question_before_it_is_replaced() {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut harness, path) = window_with_file(folder.path());
    set_notes(&mut harness, "mine");
    let mut others = session::load(&path).expect("loads");
    others.notes = "theirs".to_owned();
    session::save(&others, &path).expect("saved by another");
    request(&mut harness, Command::CheckFile);
    harness.get_by_label(&words::changed_strip("cell-3.json"));

    let save = |harness: &mut Handeye| {
        harness.key_press_modifiers(Modifiers::COMMAND, Key::S);
        settle(harness);
        harness.get_by_label(&words::changed_title("cell-3.json"));
    };
    save(&mut harness);
    click(&mut harness, shell_words::CANCEL);
    assert_eq!(session::load(&path).expect("loads").notes, "theirs");
    save(&mut harness);
    click(&mut harness, words::SAVE_OVER);
    assert_eq!(session::load(&path).expect("loads").notes, "mine");
    assert!(harness.query_by_label(&words::changed_strip("cell-3.json")).is_none());

    session::save(&others, &path).expect("saved by another");
    request(&mut harness, Command::CheckFile);
    click(&mut harness, words::RELOAD);
    assert_eq!(document(&harness).session.notes, "theirs");
    click(&mut harness, shell_words::UNDO);
    assert_eq!(document(&harness).session.notes, "mine");
}

#[test]
fn closing_goes_on_after_the_question_of_a_changed_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut harness, path) = window_with_file(folder.path());
    set_notes(&mut harness, "mine");
    session::save(&Session::new(Target::Point), &path).expect("saved by another");
    request(&mut harness, Command::CloseDocument);
    click(&mut harness, shell_words::SAVE);
    assert!(workbench(&harness).document().is_some());
    click(&mut harness, words::SAVE_OVER);
    settle(&mut harness);
    assert!(workbench(&harness).document().is_none());
    assert_eq!(session::load(&path).expect("loads").notes, "mine");
}

#[test]
fn a_read_only_file_says_so_in_the_title() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("cell-3.json");
    fs::write(&path, samples::ALL[0].json).expect("written");
    let mut permissions = fs::metadata(&path).expect("there").permissions();
    permissions.set_readonly(true);
    fs::set_permissions(&path, permissions).expect("set");
    let harness = window_with(Start { file: Some(path), ..Start::default() });
    harness.get_by_label(&shell_words::title_with("cell-3.json", words::READ_ONLY));
}

/// What a run that ended badly leaves in the folder.
fn crash(folder: &Path) {
    let mut workbench = Workbench::new(Arc::new(|| {}));
    workbench.keep_copies(RecoverySettings { folder: folder.to_owned(), interval: Duration::ZERO });
    let sample = &samples::ALL[0];
    let session = session::parse(sample.json.as_bytes(), sample.file_name).expect("a session");
    workbench.open_unsaved_session(Session { name: "cell 3".to_owned(), ..session });
}

#[test]
fn unsaved_work_of_a_crash_is_offered_recovered_or_discarded() {
    let folder = tempfile::tempdir().expect("a folder");
    let recovery_folder = Some(folder.path().to_owned());
    crash(folder.path());
    let mut harness = window_with(Start { recovery_folder: recovery_folder.clone(), ..Start::default() });
    settle_until(&mut harness, |workbench| !workbench.recoverable().is_empty());
    harness.get_by_label(words::RECOVERY);
    click(&mut harness, &words::discard("cell 3"));
    click(&mut harness, words::KEEP);
    harness.get_by_label(&words::recover("cell 3")).click();
    settle_until(&mut harness, |workbench| workbench.document().is_some() && workbench.recoverable().is_empty());
    assert_eq!(document(&harness).session.name, "cell 3");
    assert!(document(&harness).is_unsaved());
    harness.get_by_label(shell_words::UNSAVED);
    // Another crash: the work of the first is still there.
    drop(harness);
    let mut harness = window_with(Start { recovery_folder, ..Start::default() });
    settle_until(&mut harness, |workbench| !workbench.recoverable().is_empty());
    click(&mut harness, &words::discard("cell 3"));
    harness.get_by_label(words::DISCARD_FOR_GOOD).click();
    settle_until(&mut harness, |workbench| workbench.recoverable().is_empty());
    assert!(harness.query_by_label(words::RECOVERY).is_none());
}

#[test]
fn recent_files_that_are_gone_say_so_and_can_be_removed() {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut harness, path) = window_with_file(folder.path());
    fs::remove_file(&path).expect("removed");
    harness.state_mut().shell_mut().look_again();
    harness.state_mut().shell_mut().request(Command::CloseDocument);
    while harness.query_by_label(words::MISSING).is_none() {
        settle(&mut harness);
    }
    click(&mut harness, &words::remove_recent(&path.display().to_string()));
    assert_eq!(harness.state().shell().persisted().recent_files, Vec::<PathBuf>::new());
}

/// A new text in the second station's x, still being typed.
fn type_into_table(harness: &mut Handeye, text: &str) {
    harness.state_mut().shell_mut().go_to(Step::Poses);
    settle(harness);
    click(harness, "x of 2");
    harness.event(egui::Event::Text(text.to_owned()));
    settle(harness);
}

fn x_mm_of_second(session: &Session) -> f64 {
    session.stations[1].captures[0].base_from_flange.translation_mm().x
}

#[test]
fn a_cell_still_being_typed_is_part_of_what_is_saved() {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut harness, path) = window_with_file(folder.path());
    type_into_table(&mut harness, "512");
    harness.key_press_modifiers(Modifiers::COMMAND, Key::S);
    settle(&mut harness);
    assert!((x_mm_of_second(&document(&harness).session) - 512.0).abs() < 1e-9);
    let saved = session::load(&path).expect("loads");
    assert!((x_mm_of_second(&saved) - 512.0).abs() < 1e-9);
    // What cannot be read waits, and the rest is saved.
    type_into_table(&mut harness, "5..1");
    harness.key_press_modifiers(Modifiers::COMMAND, Key::S);
    settle(&mut harness);
    harness.get_by_label_contains("\"5..1\" is not in the session");
}

#[test]
fn the_history_goes_where_it_says_although_a_cell_is_being_typed() {
    let mut harness = open_sample();
    let start = Arc::clone(&document(&harness).session);
    set_notes(&mut harness, "one");
    harness.key_press_modifiers(Modifiers::COMMAND, Key::H);
    settle(&mut harness);
    type_into_table(&mut harness, "512");
    click(&mut harness, &words::history_step(words::AS_OPENED, false));
    assert_eq!(*document(&harness).session, *start);
}

#[test]
fn what_is_pasted_into_an_empty_table_is_shown_before_it_is_taken() {
    let mut harness = open_sample();
    let num_stations = document(&harness).session.stations.len();
    let rows = (0..num_stations).map(session::Row::Station).collect();
    request(&mut harness, Command::Edit { edit: Edit::Remove(rows), gesture: None });
    harness.state_mut().shell_mut().go_to(Step::Poses);
    settle(&mut harness);
    harness.event(egui::Event::Paste("1\t2\t3\t0\t0\t0\n4\t5\t6\t0\t0\t0\n".to_owned()));
    settle(&mut harness);
    assert!(workbench(&harness).import().is_some(), "the preview asks");
    assert_eq!(document(&harness).session.stations, []);
}

#[test]
fn keys_answer_the_question_that_waits_and_nothing_below_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut harness, _) = window_with_file(folder.path());
    set_notes(&mut harness, "mine");
    request(&mut harness, Command::CloseDocument);
    harness.get_by_label(shell_words::DISCARD);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    settle(&mut harness);
    harness.key_press(Key::Num3);
    settle(&mut harness);
    assert_eq!(document(&harness).session.notes, "mine");
    assert_eq!(harness.state().shell().step(), handeye::ui::Step::Session);
    harness.key_press(Key::Escape);
    settle(&mut harness);
    assert!(harness.query_by_label(shell_words::DISCARD).is_none(), "Escape goes on working");
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    settle(&mut harness);
    assert_ne!(document(&harness).session.notes, "mine");
}

#[test]
fn a_session_of_a_board_is_begun_and_says_how_its_pairs_come_in() {
    let mut harness = window_with(Start::default());
    click(&mut harness, &start_words::preset(start_words::BOARD, false, 15.0));
    assert!(document(&harness).session.target.is_pose());
    // At the poses, where a new session begins, and in its overview.
    for step in [Step::Poses, Step::Arcs, Step::Session] {
        harness.state_mut().shell_mut().go_to(step);
        settle(&mut harness);
        assert!(harness.query_by_label(import_words::PAIRS).is_some(), "{step:?}");
    }
    let rotation_std = start_words::field_name(start_words::TARGET_ROTATION_STD, "°");
    retype(&mut harness, &rotation_std, "0,1");
    harness.key_press(Key::Enter);
    settle(&mut harness);
    let expected = Target::Pose { translation_std_mm: None, rotation_std_deg: Some(0.1) };
    assert_eq!(document(&harness).session.target, expected);
    let profile_std = start_words::field_name(start_words::PROFILE_STD, "mm");
    assert!(harness.query_by_label(&profile_std).is_none(), "a camera sees no profiles");
}
