//! The pose table alone, driven by the names that screen readers see and by the keyboard.
#![expect(clippy::expect_used, reason = "helpers of tests may fail as tests do")]

use std::sync::Arc;

use egui::{Event, Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use handeye::app::{Command, Workbench};
use handeye::geometry::notation::OrientationForm;
use handeye::session::edit::CellValue;
use handeye::session::{self, Edit, Place, Session, samples};
use handeye::text::poses as words;
use handeye::ui::actions::Action;
use handeye::ui::poses::panel::{self, PosesState};
use handeye::ui::{self, PanelContext, Selection};

struct Bench {
    workbench: Workbench,
    selection: Selection,
    /// What was asked for since it was last looked at.
    commands: Vec<Command>,
    actions: Vec<Action>,
    state: PosesState,
}

type Table = Harness<'static, Bench>;

/// The table with a session, and the workbench behind it: what the table asks for is carried out.
fn table_of(session: Session) -> Table {
    let mut workbench = Workbench::new(Arc::new(|| {}));
    workbench.open_session(session, None);
    let bench = Bench {
        workbench,
        selection: Selection::default(),
        commands: Vec::new(),
        actions: Vec::new(),
        state: PosesState::default(),
    };
    let mut harness =
        Harness::builder().with_size([1100.0, 700.0]).with_context_setup(ui::theme::install).build_ui_state(
            |ui, bench: &mut Bench| {
                let mut commands = Vec::new();
                let mut context = PanelContext {
                    workbench: &bench.workbench,
                    selection: &mut bench.selection,
                    commands: &mut commands,
                    actions: &mut bench.actions,
                };
                panel::show(ui, &mut context, &mut bench.state);
                for command in commands {
                    bench.commands.push(command.clone());
                    bench.workbench.apply(command);
                }
            },
            bench,
        );
    harness.run_steps(3);
    harness
}

fn sample(file_name: &str) -> Session {
    let sample = samples::ALL.iter().find(|sample| sample.file_name == file_name).expect("a sample");
    session::parse(sample.json.as_bytes(), sample.file_name).expect("the sample is a session")
}

/// Five stations with one pose each, reduced points, labels 1 to 5.
fn printed() -> Session {
    sample("lin-mu-2019-table-1.json")
}

fn click(table: &mut Table, name: &str) {
    table.get_by_label(name).click();
    table.run_steps(3);
}

fn press(table: &mut Table, key: Key) {
    table.key_press(key);
    table.run_steps(3);
}

fn press_with(table: &mut Table, modifiers: Modifiers, key: Key) {
    table.key_press_modifiers(modifiers, key);
    table.run_steps(3);
}

fn type_in(table: &mut Table, text: &str) {
    table.event(Event::Text(text.to_owned()));
    table.run_steps(3);
}

fn paste(table: &mut Table, text: &str) {
    table.event(Event::Paste(text.to_owned()));
    table.run_steps(4);
}

fn taken(table: &mut Table) -> Vec<Command> {
    std::mem::take(&mut table.state_mut().commands)
}

fn now(table: &Table) -> Arc<Session> {
    Arc::clone(&table.state().workbench.document().expect("a session is open").session)
}

fn shown(table: &Table, cell: &str) -> String {
    table.get_by_label(cell).value().unwrap_or_default()
}

fn place(station_idx: usize) -> Place {
    Place { station_idx, capture_idx: 0 }
}

/// The one edit that was asked for.
#[track_caller]
fn only_edit(table: &mut Table) -> Edit {
    let commands = taken(table);
    match &commands[..] {
        [Command::Edit { edit, gesture: None }] => edit.clone(),
        other => panic!("{other:?}"),
    }
}

#[track_caller]
fn typed_x(table: &mut Table) -> (Place, f64) {
    match only_edit(table) {
        Edit::SetCells(values) => match &values[..] {
            [(place, CellValue::Pose(pose, _))] => (*place, pose.translation_mm().x),
            other => panic!("{other:?}"),
        },
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_number_and_enter_yield_exactly_that_edit() {
    let mut table = table_of(printed());
    let before = now(&table);
    click(&mut table, "x of 2");
    type_in(&mut table, "5");
    type_in(&mut table, "12,5");
    assert!(taken(&mut table).is_empty(), "nothing before Enter");
    press(&mut table, Key::Enter);
    assert_eq!(typed_x(&mut table), (place(1), 512.5));
    let now = now(&table);
    assert_eq!(
        now.stations[1].captures[0].base_from_flange.rotation(),
        before.stations[1].captures[0].base_from_flange.rotation()
    );
    assert_eq!(shown(&table, "x of 2"), "512.500");
    type_in(&mut table, "7");
    press(&mut table, Key::Tab);
    assert_eq!(typed_x(&mut table), (place(2), 7.0), "Enter went down");
    assert_eq!(table.state().selection.station_idx, 2, "the inspector follows");
}

#[test]
fn keys_that_come_all_at_once_do_the_same() {
    let mut table = table_of(printed());
    click(&mut table, "x of 1");
    for event in ["1", "2"].map(|text| Event::Text(text.to_owned())) {
        table.event(event);
    }
    table.key_press(Key::Enter);
    table.event(Event::Text("34".to_owned()));
    table.key_press(Key::Enter);
    table.run_steps(6);
    let session = now(&table);
    let x = |idx: usize| session::table::text(&session, place(idx), session::table::Column::Number(0));
    assert_eq!((x(0), x(1)), ("12".to_owned(), "34".to_owned()));
}

#[test]
fn escape_changes_nothing() {
    let mut table = table_of(printed());
    let before = shown(&table, "y of 3");
    click(&mut table, "y of 3");
    type_in(&mut table, "99");
    press(&mut table, Key::Escape);
    press(&mut table, Key::F2);
    press(&mut table, Key::Enter);
    assert!(taken(&mut table).is_empty(), "an editor left as it was is no edit");
    assert_eq!(shown(&table, "y of 3"), before);
}

#[test]
fn what_cannot_be_read_stays_with_its_reason_and_reaches_nothing() {
    let mut table = table_of(printed());
    let before = now(&table);
    click(&mut table, "z of 2");
    type_in(&mut table, "12..5");
    press(&mut table, Key::Enter);
    assert!(taken(&mut table).is_empty());
    assert_eq!(shown(&table, "z of 2"), "12..5");
    click(&mut table, "z of 2");
    table.get_by_label_contains("\"12..5\" is not in the session: found \"12..5\", needed a number");
    // It stays while other things change, and goes when it is corrected.
    click(&mut table, &words::sort_by("x / mm"));
    taken(&mut table);
    assert_eq!(shown(&table, "z of 2"), "12..5");
    click(&mut table, "z of 2");
    press(&mut table, Key::F2);
    for _ in 0..2 {
        press(&mut table, Key::Backspace);
    }
    press(&mut table, Key::Enter);
    assert_eq!(shown(&table, "z of 2"), "12.000");
    assert_ne!(before, now(&table));
}

#[test]
fn a_quaternion_waits_until_it_is_a_rotation() {
    let mut session = printed();
    session.robot.notation.orientation = OrientationForm::QuaternionWxyz;
    let mut table = table_of(session);
    click(&mut table, "qw of 1");
    for text in ["0.5", "0.5", "-0.5"] {
        type_in(&mut table, text);
        press(&mut table, Key::Tab);
        assert!(taken(&mut table).is_empty());
    }
    assert_eq!(shown(&table, "qw of 1"), "0.5");
    assert!(shown(&table, "check of 1").contains("not a rotation"));
    type_in(&mut table, "0.5");
    press(&mut table, Key::Enter);
    only_edit(&mut table);
    assert_eq!(shown(&table, "qy of 1"), "−0.50000");
    assert!(!shown(&table, "check of 1").contains("not a rotation"));
}

#[test]
fn an_editor_whose_document_changed_closes_without_a_word() {
    let mut table = table_of(printed());
    click(&mut table, "x of 1");
    type_in(&mut table, "1");
    press(&mut table, Key::Enter);
    click(&mut table, "x of 2");
    type_in(&mut table, "99999");
    taken(&mut table);
    let start = printed();
    table.state_mut().workbench.apply(Command::Undo);
    table.run_steps(3);
    press(&mut table, Key::Enter);
    press(&mut table, Key::Escape);
    assert!(taken(&mut table).is_empty(), "a focused cell does not overwrite an undo");
    assert_eq!(now(&table).stations, start.stations);
}

#[test]
fn a_click_elsewhere_takes_what_was_typed() {
    let mut table = table_of(printed());
    click(&mut table, "x of 1");
    type_in(&mut table, "42");
    click(&mut table, "y of 3");
    assert_eq!(typed_x(&mut table), (place(0), 42.0));
}

#[test]
fn a_block_from_a_spreadsheet_changes_adds_and_waits_in_one_step() {
    let mut table = table_of(printed());
    let before = now(&table);
    click(&mut table, "x of 4");
    paste(&mut table, "1\t2\t3\t10\t20\t30\r\n4,5\t5\t6\t1\t2\t3\r\n7\t8\t9\t1\t2\t3\r\n7\tabc\t9\t1\t2\t3\r\n");
    only_edit(&mut table);
    let session = now(&table);
    assert_eq!(session.stations.len(), 7);
    for (idx, text) in [(3, "1"), (4, "4.5"), (5, "7"), (6, "7")] {
        assert_eq!(session::table::text(&session, place(idx), session::table::Column::Number(0)), text);
    }
    assert_eq!([session.stations[5].enabled, session.stations[6].enabled], [true, false]);
    let label = session.stations[6].label.clone();
    assert_eq!(shown(&table, &format!("y of {label}")), "abc");
    table.get_by_label_contains("1 new station is left out until then");
    click(&mut table, &format!("y of {label}"));
    type_in(&mut table, "8");
    press(&mut table, Key::Enter);
    assert!(now(&table).stations[6].enabled, "complete, it takes part");
    for _ in 0..2 {
        table.state_mut().workbench.apply(Command::Undo);
    }
    assert_eq!(now(&table).stations, before.stations, "one paste is one step");
}

#[test]
fn what_is_copied_is_pasted_back_as_it_was() {
    let mut table = table_of(printed());
    let before = now(&table);
    click(&mut table, "x of 1");
    press_with(&mut table, Modifiers::COMMAND, Key::A);
    table.event(Event::Copy);
    table.step();
    let copied = table.output().platform_output.commands.iter().find_map(|command| match command {
        egui::OutputCommand::CopyText(text) => Some(text.clone()),
        _ => None,
    });
    let copied = copied.expect("something was copied");
    assert!(copied.starts_with("use\tstation\tside\tx (mm)\ty (mm)\tz (mm)\t"), "{copied}");
    assert_eq!(copied.lines().count(), 6);
    paste(&mut table, &copied);
    for (before, after) in before.stations.iter().zip(&now(&table).stations) {
        let (before, after) = (&before.captures[0].base_from_flange, &after.captures[0].base_from_flange);
        assert!((before.translation_mm() - after.translation_mm()).norm() < 1e-8);
        assert!(before.rotation().angle_to(&after.rotation()).to_degrees() < 1e-7);
    }
}

#[test]
fn one_value_fills_a_selection_and_ctrl_d_fills_down() {
    let mut table = table_of(printed());
    click(&mut table, "z of 1");
    for _ in 0..2 {
        press_with(&mut table, Modifiers::SHIFT, Key::ArrowDown);
    }
    paste(&mut table, "77");
    let Edit::SetCells(values) = only_edit(&mut table) else { panic!("cells") };
    assert_eq!(values.len(), 3);
    click(&mut table, "station of 3");
    type_in(&mut table, "B7");
    press(&mut table, Key::Enter);
    press(&mut table, Key::ArrowUp);
    for _ in 0..2 {
        press_with(&mut table, Modifiers::SHIFT, Key::ArrowDown);
    }
    taken(&mut table);
    press_with(&mut table, Modifiers::COMMAND, Key::D);
    let labels: Vec<String> = now(&table).stations.iter().map(|station| station.label.clone()).collect();
    assert_eq!(labels, ["1", "2", "B7", "B8", "B9"]);
}

#[test]
fn rows_are_added_duplicated_moved_and_deleted() {
    let mut table = table_of(printed());
    click(&mut table, &words::row_head("2"));
    press_with(&mut table, Modifiers::ALT, Key::ArrowDown);
    press_with(&mut table, Modifiers::ALT, Key::ArrowDown);
    let labels = |table: &Table| now(table).stations.iter().map(|station| station.label.clone()).collect::<Vec<_>>();
    assert_eq!(labels(&table), ["1", "3", "4", "2", "5"]);
    press(&mut table, Key::Insert);
    assert_eq!(labels(&table), ["1", "3", "4", "2", "6", "5"], "its label counts on, past those taken");
    assert!(shown(&table, "check of 6").contains("same pose"));
    press_with(&mut table, Modifiers::COMMAND, Key::Delete);
    assert_eq!(labels(&table), ["1", "3", "4", "2", "5"]);
    table.get_by_label(&words::deleted(1));
    click(&mut table, "station of 3");
    press_with(&mut table, Modifiers::COMMAND.plus(Modifiers::SHIFT), Key::D);
    assert_eq!(labels(&table), ["1", "3", "6", "4", "2", "5"]);
    taken(&mut table);
    click(&mut table, &words::sort_by("station"));
    assert!(matches!(only_edit(&mut table), Edit::Reorder(_)));
    assert_eq!(labels(&table), ["1", "2", "3", "4", "5", "6"]);
    click(&mut table, &words::sort_by("station"));
    assert_eq!(labels(&table), ["6", "5", "4", "3", "2", "1"]);
}

#[test]
fn the_checkbox_and_the_blank_key_apply_to_the_selected_rows() {
    let mut table = table_of(printed());
    click(&mut table, &words::row_head("2"));
    press_with(&mut table, Modifiers::SHIFT, Key::ArrowDown);
    type_in(&mut table, " ");
    let Edit::SetCells(values) = only_edit(&mut table) else { panic!("cells") };
    let expected = [1, 2].map(|idx| (place(idx), CellValue::Used(false)));
    assert_eq!(values, expected);
    click(&mut table, &words::use_station("5"));
    assert_eq!(only_edit(&mut table), Edit::SetCells(vec![(place(4), CellValue::Used(false))]));
}

#[test]
fn sides_are_chosen_from_a_list_or_typed() {
    let mut table = table_of(printed());
    click(&mut table, "side of 1");
    type_in(&mut table, "-");
    let minus = handeye::calibrate::SideChoice::Given(handeye::calibrate::Side::Minus);
    let first = now(&table).stations[0].side;
    assert_eq!(first, minus);
    press(&mut table, Key::F2);
    press(&mut table, Key::ArrowUp);
    press(&mut table, Key::ArrowUp);
    press(&mut table, Key::Enter);
    assert_eq!(now(&table).stations[0].side, handeye::calibrate::SideChoice::Auto);
}

#[test]
fn sweeps_fold_into_their_station_and_open_for_editing() {
    let session = sample("clean-sweeps.json");
    let label = session.stations[1].label.clone();
    let mut table = table_of(session);
    let capture = format!("x of {}", words::capture_name(&label, 1));
    assert!(table.query_by_label(&capture).is_none());
    click(&mut table, &format!("x of {label}"));
    type_in(&mut table, "5");
    press(&mut table, Key::Enter);
    assert_eq!(typed_x(&mut table), (place(1), 5.0));
    table.get_by_label(&capture);
    click(&mut table, &words::fold_station(&label));
    assert!(table.query_by_label(&capture).is_none());
    click(&mut table, words::UNFOLD_ALL);
    table.get_by_label(&format!("x of {}", words::capture_name("1", 1)));
}

#[test]
fn a_label_that_is_taken_waits() {
    let mut table = table_of(printed());
    click(&mut table, "station of 2");
    type_in(&mut table, "3");
    press(&mut table, Key::Enter);
    assert!(taken(&mut table).is_empty());
    assert_eq!(shown(&table, "station of 2"), "3");
    press(&mut table, Key::ArrowUp);
    press(&mut table, Key::Delete);
    assert_eq!(shown(&table, "station of 2"), "2", "thrown away");
}

#[test]
fn a_robot_program_goes_to_the_import() {
    let mut table = table_of(printed());
    click(&mut table, "x of 1");
    let program = "/PROG MAIN\n/POS\nP[1]{ GP1: UF : 1, UT : 1, };\n/END\n";
    paste(&mut table, program);
    assert_eq!(taken(&mut table), [Command::ImportText(program.to_owned())]);
}

#[test]
fn two_thousand_stations_are_edited_like_five() {
    let mut session = printed();
    let model = session.stations[0].clone();
    for idx in 5..2000_u16 {
        let mut station = model.clone();
        station.label = (idx + 1).to_string();
        let mut position = model.captures[0].base_from_flange.translation_mm();
        position.x += f64::from(idx % 50);
        position.y += f64::from(idx / 50);
        station.captures[0].base_from_flange =
            handeye::geometry::Transform::from_parts(position, model.captures[0].base_from_flange.rotation());
        session.stations.push(station);
    }
    session.published = None;
    let mut table = table_of(session);
    click(&mut table, "x of 1");
    press_with(&mut table, Modifiers::COMMAND, Key::ArrowDown);
    assert_eq!(table.state().selection.station_idx, 1999);
    type_in(&mut table, "5");
    press(&mut table, Key::Enter);
    assert_eq!(typed_x(&mut table), (place(1999), 5.0));
    assert!(table.query_by_label("x of 1").is_none(), "only rows in sight are drawn");
}

/// Types into a cell without Enter, then clicks a button once, as a mouse does.
fn type_and_click(cell: &str, text: &str, button: &str) -> Table {
    let mut table = table_of(printed());
    click(&mut table, cell);
    type_in(&mut table, text);
    click(&mut table, button);
    table.run_steps(3);
    table
}

fn button(hint: &str) -> &str {
    hint.split(" (").next().unwrap_or(hint)
}

fn x_of(session: &Session) -> Vec<(String, String)> {
    let x = |idx: usize| session::table::text(session, place(idx), session::table::Column::Number(0));
    session.stations.iter().enumerate().map(|(idx, station)| (station.label.clone(), x(idx))).collect()
}

#[test]
fn a_button_takes_over_the_open_cell_before_it_moves_anything() {
    let start = x_of(&printed());
    let with = |label: &str, x: &str, order: &[usize]| {
        let typed = |(name, old): &(String, String)| (name.clone(), if name == label { x } else { old }.to_owned());
        order.iter().map(|idx| typed(&start[*idx])).collect::<Vec<_>>()
    };
    let deleted = type_and_click("x of 2", "500", button(words::DELETE_HINT));
    assert_eq!(x_of(&now(&deleted)), with("2", "500", &[0, 2, 3, 4]));
    let up = type_and_click("x of 2", "500", button(words::MOVE_UP_HINT));
    assert_eq!(x_of(&now(&up)), with("2", "500", &[1, 0, 2, 3, 4]));
    let down = type_and_click("x of 2", "500", button(words::MOVE_DOWN_HINT));
    assert_eq!(x_of(&now(&down)), with("2", "500", &[0, 2, 1, 3, 4]));
    // The order is that of the new values.
    for name in [button(words::SORT_BUTTON_HINT), words::sort_by("x / mm").as_str()] {
        let sorted = x_of(&now(&type_and_click("x of 2", "-99999", name)));
        assert_eq!(sorted[0], ("2".to_owned(), "-99999".to_owned()), "{name}");
    }
}

#[test]
fn rows_picked_one_by_one_stay_picked_as_they_move() {
    let mut table = table_of(printed());
    click(&mut table, &words::row_head("2"));
    table.get_by_label(&words::row_head("5")).click_modifiers(Modifiers::COMMAND);
    table.run_steps(3);
    for _ in 0..2 {
        press_with(&mut table, Modifiers::ALT, Key::ArrowUp);
    }
    let labels: Vec<String> = now(&table).stations.iter().map(|station| station.label.clone()).collect();
    assert_eq!(labels, ["2", "1", "3", "5", "4"], "at the top it stops");
}

#[test]
fn what_is_pasted_into_an_empty_table_goes_to_the_preview() {
    let mut session = printed();
    session.stations.clear();
    session.published = None;
    let mut table = table_of(session);
    click(&mut table, button(words::ADD_HINT));
    assert_eq!(now(&table).stations.len(), 1);
    press_with(&mut table, Modifiers::COMMAND, Key::Delete);
    taken(&mut table);
    paste(&mut table, "1\t2\t3\t0\t0\t0");
    assert_eq!(taken(&mut table), [Command::ImportText("1\t2\t3\t0\t0\t0".to_owned())]);
}

#[test]
fn texts_go_with_their_station() {
    let mut table = table_of(printed());
    click(&mut table, "x of 5");
    paste(&mut table, "1\t2\t3\t0\t0\t0\n4\tabc\t6\t0\t0\t0\n");
    assert_eq!(shown(&table, "y of 6"), "abc");
    table.state_mut().workbench.apply(Command::Undo);
    table.run_steps(3);
    press_with(&mut table, Modifiers::COMMAND, Key::End);
    press(&mut table, Key::Insert);
    assert_ne!(shown(&table, "y of 6"), "abc");
}

#[test]
fn an_empty_cell_of_a_line_leaves_the_selected_rows_as_they_are() {
    let mut table = table_of(printed());
    click(&mut table, &words::row_head("2"));
    press_with(&mut table, Modifiers::SHIFT, Key::ArrowDown);
    paste(&mut table, "\t\t\t77");
    let session = now(&table);
    assert!(session.stations.iter().all(|station| station.enabled));
    let x = x_of(&session);
    assert_eq!([x[1].1.as_str(), x[2].1.as_str()], ["77", "77"]);
    assert!(!shown(&table, "check of 2").contains("not read"));
}
