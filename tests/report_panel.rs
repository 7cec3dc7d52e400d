//! The Report step, driven by the names that screen readers see, in the whole window.
#![expect(clippy::expect_used, reason = "helpers of tests may fail as tests do")]

mod step_window;

use egui::Key;
use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use handeye::report::document::SectionId;
use handeye::report::tool_frame::{Format, formats};
use handeye::session::{self, Session, Target, samples};
use handeye::text::{report_panel, shell as shell_words, tool_frame as words};
use handeye::ui::{Step, Window};
use step_window::{click, settle, window_at, workbench};

const SIZE: [f32; 2] = [1440.0, 900.0];

fn sample(name: &str) -> Session {
    let sample = samples::ALL.iter().find(|sample| sample.file_name == name).expect("a sample");
    session::parse(sample.json.as_bytes(), name).expect("a session")
}

/// At the tool frame.
fn tool_frame_of(session: Session) -> Harness<'static, Window> {
    let mut harness = window_at(Step::Report, session, SIZE);
    click(&mut harness, report_panel::TOOL_FRAME);
    harness
}

fn window() -> Harness<'static, Window> {
    tool_frame_of(sample("clean-sweeps.json"))
}

/// The text in a field.
fn text_of(harness: &Harness<'static, Window>, name: &str) -> String {
    harness.get_by_label(name).value().expect("a field with a text")
}

/// Types the path that the window asks for.
fn save_as(harness: &mut Harness<'static, Window>, path: &std::path::Path) {
    settle(harness);
    let field = harness.get_by_label(shell_words::FILE_PATH);
    field.focus();
    harness.key_press_modifiers(egui::Modifiers::COMMAND, Key::A);
    harness.get_by_label(shell_words::FILE_PATH).type_text(&path.display().to_string());
    harness.run_steps(2);
    harness.key_press(Key::Enter);
    settle(harness);
}

#[test]
fn the_sessions_own_controller_comes_first() {
    let harness = window();
    let fanuc = Format::by_id("fanuc-ls").expect("a format");
    let text = text_of(&harness, words::TEXT);
    assert!(text.starts_with("/PROG"), "{text}");
    let own = harness.get_by_label(words::OWN_ROBOT).rect();
    let others = harness.get_by_label(words::CONTROLLERS).rect();
    // The name stands above the text as well.
    let row = harness.get_all_by_label(fanuc.label).map(|node| node.rect()).find(|rect| rect.left() < 460.0);
    assert!(row.is_some_and(|row| own.bottom() <= row.top() && row.bottom() <= others.top()));
}

#[test]
fn every_format_is_shown_with_what_came_back() {
    let mut harness = window();
    let best = handeye::calibrate::best_available(&workbench(&harness).results().expect("solved").methods)
        .expect("a solution")
        .flange_from_sensor;
    for format in formats() {
        // A screen reader's click: what scrolls is no moving target for it.
        harness.get_all_by_role_and_label(Role::Button, format.label).next().expect("in the list").click_accesskit();
        settle(&mut harness);
        let text = text_of(&harness, words::TEXT);
        let again = format.read(&text).expect("read back");
        assert!((again.translation_mm() - best.translation_mm()).norm() < 0.01, "{text}");
        assert!(harness.query_by_label_contains("Read back from this text: equal within").is_some());
    }
}

#[test]
fn the_text_is_copied_and_saved() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("tool.ls");
    let mut harness = window();
    let text = text_of(&harness, words::TEXT);
    harness.get_by_label(words::COPY).click();
    harness.run_steps(1);
    let is_copy = |command: &egui::OutputCommand| *command == egui::OutputCommand::CopyText(text.clone());
    assert!(harness.output().platform_output.commands.iter().any(is_copy));
    click(&mut harness, words::SAVE);
    save_as(&mut harness, &path);
    assert_eq!(std::fs::read_to_string(&path).expect("written"), text);
    assert!(harness.query_by_label(&report_panel::wrote(&path.display().to_string())).is_some());
}

#[test]
fn name_and_number_stand_in_the_text() {
    let mut harness = window();
    let field = harness.get_by_role_and_label(Role::TextInput, words::NAME);
    field.focus();
    harness.key_press_modifiers(egui::Modifiers::COMMAND, Key::A);
    harness.get_by_role_and_label(Role::TextInput, words::NAME).type_text("left head");
    settle(&mut harness);
    let text = text_of(&harness, words::TEXT);
    assert!(text.contains("left_head"), "{text}");
}

#[test]
fn a_fixed_sensor_has_no_tool() {
    let mut session = sample("clean-sweeps.json");
    session.mount = handeye::calibrate::Mount::Fixed;
    let harness = tool_frame_of(session);
    assert!(
        harness.query_by_label(words::NO_TOOL).is_some() || harness.query_by_label(words::NO_CALIBRATION).is_some()
    );
    assert!(harness.query_by_label(words::CONTROLLERS).is_none());
}

#[test]
fn without_a_calibration_it_says_what_to_do() {
    let session = Session::new(Target::ball(15.0));
    let harness = tool_frame_of(session);
    assert!(harness.query_by_label(words::NO_CALIBRATION).is_some());
}

#[test]
fn the_report_is_seen_and_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let place = folder.path().join("report");
    let mut harness = window_at(Step::Report, sample("clean-sweeps.json"), SIZE);
    for section in [SectionId::Verdict, SectionId::Calibration] {
        // On the page, and in the list of what it holds.
        assert_eq!(harness.get_all_by_label(section.title()).count(), 2, "{}", section.title());
    }
    harness.get_by_role_and_label(Role::CheckBox, SectionId::Calibration.title()).click();
    settle(&mut harness);
    assert_eq!(harness.get_all_by_label(SectionId::Calibration.title()).count(), 1);
    let operator = harness.get_by_role_and_label(Role::TextInput, report_panel::OPERATOR);
    operator.focus();
    operator.type_text("A. Operator");
    settle(&mut harness);
    harness.get_by_label(report_panel::SAVE_REPORT).click();
    save_as(&mut harness, &place);
    let page = std::fs::read_to_string(place.join("report.html")).expect("written");
    assert!(page.contains("A. Operator") && !page.contains("id=\"calibration\""));
    for file in ["report.md", "result.json", "tables/methods.csv"] {
        assert!(place.join(file).exists(), "{file}");
    }
    assert!(harness.query_by_label(report_panel::COPY_PATH).is_some());
}

#[test]
fn a_report_of_an_earlier_state_is_marked_and_follows() {
    let mut harness = window_at(Step::Report, sample("clean-sweeps.json"), SIZE);
    let before = workbench(&harness).report().last().expect("gathered").revision;
    step_window::apply(&mut harness, handeye::app::Command::SetStationEnabled { station_idx: 1, enabled: false });
    let after = workbench(&harness).report().last().expect("gathered").revision;
    assert!(after > before && workbench(&harness).is_current(after));
}

#[test]
fn with_nothing_to_report_it_says_what_to_do() {
    let harness = window_at(Step::Report, Session::new(Target::ball(15.0)), SIZE);
    assert!(harness.query_by_label(report_panel::NOTHING_TO_REPORT).is_some());
}
