//! The window, driven by the names that screen readers see. No display, driver or system font is needed.

use std::path::Path;
use std::sync::Arc;

use eframe::App as _;
use egui::accesskit::Role;
use egui::{Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use handeye::app::{Command, NoticeKind, Workbench};
use handeye::diagnose::Severity;
use handeye::session::edit::CellValue;
use handeye::session::table::Column;
use handeye::session::{self, Edit, Place, Target, samples};
use handeye::text::start::{open_sample, sample_lesson};
use handeye::text::{poses as pose_words, shell as shell_words, start as start_words};
use handeye::ui::actions::Action;
use handeye::ui::dialogs::{SavePath, SavePathAnswer};
use handeye::ui::persisted::ThemeChoice;
use handeye::ui::poses::panel::{self as poses_panel, PosesState};
use handeye::ui::{self, PanelContext, Selection, Start, Step, Window};

const SIZE: [f32; 2] = [1440.0, 900.0];

/// The whole window, with the samples read.
fn window() -> Harness<'static, Window> {
    let mut harness = Harness::builder()
        .with_size(SIZE)
        .with_os(egui::os::OperatingSystem::Nix)
        .build_eframe(|creation| Window::new(creation, Start::default()));
    settle(&mut harness);
    harness
}

/// Runs until no job is left and the window has shown what came of them.
fn settle(harness: &mut Harness<'static, Window>) {
    loop {
        harness.step();
        if !harness.state().shell().is_busy() {
            break;
        }
        std::thread::yield_now();
    }
    harness.run_steps(3);
}

/// The window with a sample opened through its card.
fn window_with(file_name: &str) -> Harness<'static, Window> {
    let mut harness = window();
    click(&mut harness, &open_sample(sample_lesson(file_name).0));
    harness
}

fn click(harness: &mut Harness<'static, Window>, name: &str) {
    harness.get_by_label(name).click();
    settle(harness);
}

fn workbench<'a>(harness: &'a Harness<'static, Window>) -> &'a Workbench {
    harness.state().shell().workbench()
}

fn is_enabled(harness: &Harness<'static, Window>, station_idx: usize) -> bool {
    workbench(harness).document().is_some_and(|document| document.session.stations[station_idx].enabled)
}

#[test]
fn the_start_page_shows_every_sample() {
    let harness = window();
    for sample in samples::ALL {
        harness.get_by_label(&open_sample(sample_lesson(sample.file_name).0));
    }
    // Tests run where the recorded sequence is.
    harness.get_by_label(&open_sample(start_words::SEQUENCE_LESSON.0));
}

#[test]
fn a_click_on_a_sample_opens_and_solves_it() {
    let mut harness = window_with("few-rotations.json");
    let document = workbench(&harness).document().expect("the sample is open");
    assert_eq!(document.session.stations.len(), 8);
    assert!(workbench(&harness).results_are_current());
    // Its rotations are too few, so the way leads to what is said about that.
    let findings = &workbench(&harness).current_diagnosis().expect("diagnosed").findings;
    let num_serious = findings.iter().filter(|finding| finding.severity != Severity::Note).count();
    assert!(num_serious > 0);
    click(&mut harness, &shell_words::next_findings(num_serious));
    assert_eq!(harness.state().shell().step(), Step::Diagnosis);
}

#[test]
fn where_nothing_is_wrong_the_way_leads_along_the_rail() {
    let mut harness = window_with("clean-sweeps.json");
    for (next, step) in [
        (shell_words::next_arcs(&Target::ball(15.0)), Step::Arcs),
        (shell_words::NEXT_POSES, Step::Poses),
        (shell_words::NEXT_COMPARE, Step::Compare),
        (shell_words::NEXT_DIAGNOSIS, Step::Diagnosis),
    ] {
        click(&mut harness, next);
        assert_eq!(harness.state().shell().step(), step);
    }
}

#[test]
fn every_step_draws_every_sample() {
    for sample in samples::ALL {
        let mut harness = window_with(sample.file_name);
        for step in Step::ALL {
            click(&mut harness, step.name());
            assert_eq!(harness.state().shell().step(), step, "{}", sample.file_name);
        }
    }
}

#[test]
fn a_wrong_path_is_answered_with_the_error_itself() {
    let mut harness = window();
    let path = "/nowhere/at-all.json";
    harness.get_by_label(start_words::PATH).focus();
    harness.run_steps(2);
    harness.get_by_label(start_words::PATH).type_text(path);
    harness.run_steps(2);
    harness.key_press(Key::Enter);
    settle(&mut harness);
    let sentence = session::load(Path::new(path)).expect_err("there is no such file").to_string();
    harness.get_by_label(&sentence);
    assert!(workbench(&harness).document().is_none());
}

#[test]
fn unticking_a_station_sends_exactly_that_command() {
    struct Bench {
        workbench: Workbench,
        selection: Selection,
        commands: Vec<Command>,
        actions: Vec<Action>,
        state: PosesState,
    }
    let mut workbench = Workbench::new(Arc::new(|| {}));
    let sample = &samples::ALL[0];
    let session = session::parse(sample.json.as_bytes(), sample.file_name).expect("the sample is a session");
    let name = pose_words::use_station(&session.stations[1].label);
    workbench.open_session(session, None);
    let bench = Bench {
        workbench,
        selection: Selection::default(),
        commands: Vec::new(),
        actions: Vec::new(),
        state: PosesState::default(),
    };
    let mut harness = Harness::builder().with_size(SIZE).with_context_setup(ui::theme::install).build_ui_state(
        |ui, bench: &mut Bench| {
            let mut context = PanelContext {
                workbench: &bench.workbench,
                selection: &mut bench.selection,
                commands: &mut bench.commands,
                actions: &mut bench.actions,
            };
            poses_panel::show(ui, &mut context, &mut bench.state);
        },
        bench,
    );
    harness.run_steps(3);
    harness.get_by_label(&name).click();
    harness.run_steps(3);
    let values = vec![(Place { station_idx: 1, capture_idx: 0 }, CellValue::Used(false))];
    assert_eq!(harness.state().commands, [Command::Edit { edit: Edit::SetCells(values), gesture: None }]);
}

#[test]
fn an_edit_is_undone_and_redone_with_keys_and_buttons() {
    let mut harness = window_with("few-rotations.json");
    click(&mut harness, Step::Poses.name());
    click(&mut harness, &pose_words::use_station("2"));
    assert!(!is_enabled(&harness, 1));
    harness.get_by_label(shell_words::UNSAVED);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    settle(&mut harness);
    assert!(is_enabled(&harness, 1));
    click(&mut harness, shell_words::REDO);
    assert!(!is_enabled(&harness, 1));
    click(&mut harness, shell_words::UNDO);
    assert!(is_enabled(&harness, 1));
}

#[test]
fn digits_and_arrows_move_through_the_window() {
    let mut harness = window_with("few-rotations.json");
    let keys = [Key::Num5, Key::Num6, Key::Num7, Key::Num8, Key::Num2, Key::Num3, Key::Num1, Key::Num4];
    for (key, step) in keys.into_iter().zip([
        Step::Compare,
        Step::Diagnosis,
        Step::Verify,
        Step::Report,
        Step::Capture,
        Step::Arcs,
        Step::Session,
        Step::Poses,
    ]) {
        harness.key_press(key);
        harness.run_steps(2);
        assert_eq!(harness.state().shell().step(), step);
    }
    harness.key_press(Key::ArrowDown);
    harness.run_steps(2);
    harness.get_by_label(&shell_words::station_heading("2", Some(1)));
}

#[test]
fn the_help_fits_into_a_low_window() {
    for size in [[1100.0, 720.0], SIZE] {
        let mut harness = Harness::builder()
            .with_size(size)
            .with_os(egui::os::OperatingSystem::Nix)
            .build_eframe(|creation| Window::new(creation, Start::default()));
        settle(&mut harness);
        harness.key_press(Key::F1);
        harness.run_steps(4);
        let screen = egui::Rect::from_min_size(egui::Pos2::ZERO, size.into());
        let heading = harness.get_by_label(shell_words::SHORTCUTS).rect();
        // The list names an action that is called the same.
        let button = harness.get_by_role_and_label(Role::Button, shell_words::CLOSE);
        for place in [heading, button.rect()] {
            assert!(screen.contains_rect(place), "{place} in {size:?}");
        }
        button.click_accesskit();
        harness.run_steps(8);
        assert!(harness.query_by_label(shell_words::SHORTCUTS).is_none());
    }
}

#[test]
fn another_session_is_not_opened_over_unsaved_changes_unasked() {
    let mut harness = window_with("few-rotations.json");
    click(&mut harness, Step::Poses.name());
    click(&mut harness, &pose_words::use_station("2"));
    click(&mut harness, Step::Session.name());
    let other = open_sample(sample_lesson("lin-mu-2019-table-1.json").0);
    harness.state_mut().shell_mut().request(Command::OpenSample(0));
    settle(&mut harness);
    assert!(
        workbench(&harness).document().is_some_and(handeye::app::Document::is_unsaved),
        "the edited session is there"
    );
    click(&mut harness, shell_words::CANCEL);
    assert!(!is_enabled(&harness, 1), "cancelling changes nothing");
    harness.get_by_label(&other).scroll_to_me();
    settle(&mut harness);
    harness.get_by_label(&other).click();
    settle(&mut harness);
    click(&mut harness, shell_words::DISCARD);
    let document = workbench(&harness).document().expect("the other session is open");
    assert_eq!(document.session.stations.len(), 5);
}

#[test]
fn saving_before_closing_writes_the_file_and_then_closes() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("session.json");
    std::fs::write(&path, samples::ALL[0].json).expect("written");
    let mut harness = window();
    harness.state_mut().shell_mut().request(Command::Open(path.clone()));
    settle(&mut harness);
    click(&mut harness, Step::Poses.name());
    let label = session::load(&path).expect("readable").stations[1].label.clone();
    click(&mut harness, &pose_words::use_station(&label));
    harness.state_mut().shell_mut().request(Command::CloseDocument);
    settle(&mut harness);
    click(&mut harness, shell_words::SAVE);
    settle(&mut harness);
    assert!(workbench(&harness).document().is_none(), "closed after saving");
    assert!(!session::load(&path).expect("readable").stations[1].enabled);
}

#[test]
fn an_opened_file_is_listed_as_recent() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("cell 3.json");
    std::fs::write(&path, samples::ALL[0].json).expect("written");
    let mut harness = window();
    harness.state_mut().shell_mut().request(Command::Open(path.clone()));
    settle(&mut harness);
    assert_eq!(harness.state().shell().persisted().recent_files, [path]);
}

#[test]
fn dark_theme_draws_too() {
    let mut harness = window_with("few-rotations.json");
    click(&mut harness, shell_words::VIEW);
    click(&mut harness, shell_words::DARK);
    for step in Step::ALL {
        harness.state_mut().shell_mut().go_to(step);
        settle(&mut harness);
    }
    let errors = workbench(&harness).notices().iter().filter(|notice| notice.kind == NoticeKind::Error);
    assert_eq!(errors.count(), 0);
}

#[test]
fn what_is_saved_is_what_was_chosen() {
    let mut harness = window();
    click(&mut harness, shell_words::VIEW);
    click(&mut harness, "125 %");
    let mut storage = Memory::default();
    harness.state_mut().save(&mut storage);
    let remembered: ui::persisted::Persisted =
        eframe::get_value(&storage, ui::persisted::Persisted::KEY).expect("it was saved");
    assert!((remembered.scale - 1.25).abs() < 1e-6);
}

#[derive(Default)]
struct Memory(std::collections::HashMap<String, String>);

impl eframe::Storage for Memory {
    fn get_string(&self, key: &str) -> Option<String> {
        self.0.get(key).cloned()
    }

    fn set_string(&mut self, key: &str, value: String) {
        self.0.insert(key.to_owned(), value);
    }

    fn remove_string(&mut self, key: &str) {
        self.0.remove(key);
    }

    fn flush(&mut self) {}
}

#[test]
fn pictures_of_all_steps_are_drawn_without_a_display() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("session.json");
    std::fs::write(&path, samples::ALL[3].json).expect("written");
    for step in Step::ALL {
        let picture = ui::screenshot::render(Some(&path), step, ThemeChoice::Light, [1024, 768]).expect("drawn");
        let pixels: Vec<_> = picture.pixels().map(|pixel| pixel.0).collect();
        assert!(pixels.iter().all(|[.., alpha]| *alpha == 255), "the window covers the picture");
        let distinct: std::collections::HashSet<_> = pixels.iter().collect();
        assert!(distinct.len() > 50, "{step:?} shows text and colours");
    }
}

/// A question for a path, and what was answered.
struct SaveBench {
    question: SavePath,
    answers: Vec<SavePathAnswer>,
}

fn save_question(path: &Path, own_file: Option<&Path>) -> Harness<'static, SaveBench> {
    let question = SavePath::new(path.display().to_string(), own_file.map(Path::to_owned));
    let mut harness = Harness::builder().with_size(SIZE).with_context_setup(ui::theme::install).build_ui_state(
        |ui, bench: &mut SaveBench| bench.answers.extend(bench.question.ask(&ui.ctx().clone())),
        SaveBench { question, answers: Vec::new() },
    );
    harness.run_steps(3);
    harness.get_by_label(shell_words::SAVE).click();
    harness.run_steps(3);
    harness
}

#[test]
fn another_file_is_replaced_only_after_a_question() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("other.json");
    std::fs::write(&path, "{}").expect("written");
    let mut harness = save_question(&path, None);
    assert!(harness.state().answers.is_empty(), "nothing is written unasked");
    harness.get_by_label(shell_words::CANCEL).click();
    harness.run_steps(3);
    harness.get_by_label(shell_words::FILE_PATH);
    assert!(harness.state().answers.is_empty(), "back to the path");
    harness.get_by_label(shell_words::SAVE).click();
    harness.run_steps(3);
    harness.get_by_label(shell_words::REPLACE).click();
    harness.run_steps(3);
    assert_eq!(harness.state().answers, [SavePathAnswer::Save(path)]);
}

#[test]
fn a_new_file_and_the_sessions_own_are_written_unasked() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("own.json");
    assert_eq!(save_question(&path, None).state().answers, [SavePathAnswer::Save(path.clone())]);
    std::fs::write(&path, "{}").expect("written");
    assert_eq!(save_question(&path, Some(&path)).state().answers, [SavePathAnswer::Save(path)]);
}

#[test]
fn an_error_of_opening_goes_once_something_opens() {
    let mut harness = window();
    harness.state_mut().shell_mut().request(Command::Open("/nowhere/at-all.json".into()));
    settle(&mut harness);
    assert!(workbench(&harness).notices().iter().all(|notice| notice.is_of_opening));
    assert_eq!(workbench(&harness).notices().len(), 1);
    click(&mut harness, &open_sample(sample_lesson("few-rotations.json").0));
    assert!(workbench(&harness).notices().is_empty());
}

#[test]
fn ctrl_y_brings_back_what_was_undone() {
    let mut harness = window_with("few-rotations.json");
    click(&mut harness, Step::Poses.name());
    click(&mut harness, &pose_words::use_station("2"));
    click(&mut harness, shell_words::UNDO);
    assert!(is_enabled(&harness, 1));
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Y);
    settle(&mut harness);
    assert!(!is_enabled(&harness, 1));
}

#[test]
fn in_the_table_digits_are_typed_and_undo_is_the_texts_own() {
    let mut harness = window_with("lin-mu-2019-table-1.json");
    click(&mut harness, Step::Poses.name());
    click(&mut harness, "x of 2");
    for text in ["5", "4"] {
        harness.event(egui::Event::Text(text.to_owned()));
        harness.run_steps(2);
    }
    harness.key_press(Key::Enter);
    settle(&mut harness);
    assert_eq!(harness.state().shell().step(), Step::Poses, "digits go to the cell");
    let x_mm = |harness: &Harness<'static, Window>| {
        let document = workbench(harness).document().expect("open");
        session::table::text(&document.session, Place { station_idx: 1, capture_idx: 0 }, Column::Number(0))
    };
    assert_eq!(x_mm(&harness), "54");
    harness.key_press(Key::F2);
    harness.run_steps(2);
    harness.event(egui::Event::Text("7".to_owned()));
    harness.run_steps(2);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    settle(&mut harness);
    assert_eq!(x_mm(&harness), "54", "what is typed has an undo of its own");
    harness.key_press(Key::Escape);
    harness.run_steps(2);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    settle(&mut harness);
    assert_eq!(x_mm(&harness), "340.971");
}

#[test]
fn closing_asks_about_a_cell_that_could_not_be_read() {
    let mut harness = window_with("few-rotations.json");
    click(&mut harness, Step::Poses.name());
    click(&mut harness, "z of 1");
    harness.event(egui::Event::Text("abc".to_owned()));
    settle(&mut harness);
    harness.key_press(Key::Enter);
    settle(&mut harness);
    assert!(!workbench(&harness).document().expect("open").is_unsaved(), "the text is not in the session");
    harness.state_mut().shell_mut().request(Command::CloseDocument);
    settle(&mut harness);
    harness.get_by_label(&shell_words::unread_cells(1));
    click(&mut harness, shell_words::DISCARD);
    assert!(workbench(&harness).document().is_none());
}
