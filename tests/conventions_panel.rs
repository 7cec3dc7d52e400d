//! The bar above the pose table and its dialogs, driven by the names that screen readers see.
#![expect(clippy::expect_used, reason = "helpers of tests may fail as tests do")]

use std::sync::Arc;

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use handeye::app::{Command, Workbench};
use handeye::geometry::notation::{AngleUnit, LengthUnit, OrientationForm};
use handeye::geometry::{PoseConvention, PoseNotation, Transform, Vec3, so3};
use handeye::session::edit::shown_numbers;
use handeye::session::{self, Edit, Session, samples};
use handeye::text::conventions as words;
use handeye::ui::actions::Action;
use handeye::ui::poses::convention::model::{self, Draft, Preview};
use handeye::ui::poses::panel::{self as poses_panel, PosesState};
use handeye::ui::{self, PanelContext, Selection};

struct Bench {
    workbench: Workbench,
    selection: Selection,
    commands: Vec<Command>,
    actions: Vec<Action>,
    poses: PosesState,
}

impl Bench {
    fn ui(ui: &mut egui::Ui, bench: &mut Self) {
        let mut context = PanelContext {
            workbench: &bench.workbench,
            selection: &mut bench.selection,
            commands: &mut bench.commands,
            actions: &mut bench.actions,
        };
        poses_panel::show(ui, &mut context, &mut bench.poses);
    }

    fn harness(session: Session) -> Harness<'static, Self> {
        let mut workbench = Workbench::new(Arc::new(|| {}));
        workbench.open_session(session, None);
        let bench = Self {
            workbench,
            selection: Selection::default(),
            commands: Vec::new(),
            actions: Vec::new(),
            poses: PosesState::default(),
        };
        let mut harness = Harness::builder()
            .with_size([1100.0, 820.0])
            .with_context_setup(ui::theme::install)
            .build_ui_state(Self::ui, bench);
        harness.run_steps(4);
        harness
    }
}

fn convention(id: &str) -> &'static PoseConvention {
    PoseConvention::by_id(id).expect("known")
}

/// In FANUC's angles.
fn sample() -> Session {
    let sample = samples::ALL.iter().find(|sample| sample.file_name == "few-rotations.json").expect("a sample");
    let session = session::parse(sample.json.as_bytes(), sample.file_name).expect("the sample is a session");
    assert_eq!(session.robot.notation, PoseNotation::of(convention("fanuc-wpr")));
    session
}

fn click(harness: &mut Harness<'static, Bench>, name: &str) {
    harness.get_by_label(name).click();
    harness.run_steps(4);
}

fn choose(harness: &mut Harness<'static, Bench>, row: &str, name: &str) {
    click(harness, &words::choice_name(row, name));
}

/// The edits asked for since the last time.
fn edits(harness: &mut Harness<'static, Bench>) -> Vec<Edit> {
    let edit = |command| match command {
        Command::Edit { edit, gesture: None } => edit,
        command => panic!("{command:?}"),
    };
    harness.state_mut().commands.drain(..).map(edit).collect()
}

#[test]
fn a_maker_is_chosen_from_the_list_by_a_search_and_shows_its_usual_units() {
    let mut harness = Bench::harness(sample());
    choose(&mut harness, words::SHOWN_AS, "FANUC W P R");
    assert!(harness.query_by_label("KUKA A B C").is_some() && harness.query_by_label("UR RX RY RZ").is_some());
    // The search has the keyboard, and Enter takes the first that it finds.
    harness.event(egui::Event::Text("kaw".to_owned()));
    harness.run_steps(4);
    assert!(harness.query_by_label("KUKA A B C").is_none() && harness.query_by_label("Yaskawa Rx Ry Rz").is_none());
    harness.key_press(egui::Key::Enter);
    harness.run_steps(4);
    assert_eq!(edits(&mut harness), [Edit::SwitchNotation(PoseNotation::of(convention("kawasaki-oat")))]);
    assert!(harness.query_by_label(words::SEARCH).is_none(), "the list closes");
    choose(&mut harness, words::SHOWN_AS, "FANUC W P R");
    harness.event(egui::Event::Text("stau".to_owned()));
    harness.run_steps(4);
    click(&mut harness, "Stäubli Rx Ry Rz");
    assert_eq!(edits(&mut harness), [Edit::SwitchNotation(PoseNotation::of(convention("staubli-rxryrz")))]);

    choose(&mut harness, words::SHOWN_AS, "FANUC W P R");
    harness.get_by_label(words::SEARCH).type_text("no such maker");
    harness.run_steps(4);
    harness.get_by_label(words::NOTHING_FOUND);

    let mut harness = Bench::harness(sample());
    choose(&mut harness, words::SHOWN_AS, "FANUC W P R");
    click(&mut harness, "UR RX RY RZ");
    let radians = PoseNotation { angle_unit: AngleUnit::Radians, ..PoseNotation::of(convention("ur-rotvec")) };
    assert_eq!(edits(&mut harness), [Edit::SwitchNotation(radians)]);
}

#[test]
fn units_and_frame_are_put_together_in_a_form() {
    let mut harness = Bench::harness(sample());
    click(&mut harness, words::MORE);
    choose(&mut harness, words::ORIENTATION, words::orientation_form(OrientationForm::QuaternionXyzw));
    choose(&mut harness, words::LENGTH_UNIT, words::length_unit(LengthUnit::Metres));
    choose(&mut harness, words::DIRECTION, words::INVERSE);
    assert!(edits(&mut harness).is_empty(), "nothing is changed before the button");
    click(&mut harness, words::SHOW);
    let expected = PoseNotation {
        orientation: OrientationForm::QuaternionXyzw,
        length_unit: LengthUnit::Metres,
        is_inverse: true,
        ..PoseNotation::of(convention("fanuc-wpr"))
    };
    assert_eq!(edits(&mut harness), [Edit::SwitchNotation(expected)]);
    assert!(harness.query_by_label(words::SHOW_TITLE).is_none(), "the dialog closes");

    click(&mut harness, words::MORE);
    choose(&mut harness, words::AXES, words::MOVING_AXES);
    choose(&mut harness, words::FRAME, words::TOOL_POINT);
    harness.get_by_label(&words::tool_number("z"));
    click(&mut harness, words::CANCEL);
    assert!(edits(&mut harness).is_empty());
}

#[test]
fn a_tool_point_is_typed_in_the_units_and_angles_chosen() {
    let mut harness = Bench::harness(sample());
    click(&mut harness, words::MORE);
    choose(&mut harness, words::LENGTH_UNIT, words::length_unit(LengthUnit::Metres));
    choose(&mut harness, words::FRAME, words::TOOL_POINT);
    for (name, typed) in [("z", "0,15"), ("R", "90")] {
        let field = words::tool_number(name);
        click(&mut harness, &field);
        harness.get_by_label(&field).type_text(typed);
        harness.run_steps(2);
        harness.key_press(egui::Key::Enter);
        harness.run_steps(2);
    }
    click(&mut harness, words::SHOW);
    let edits = edits(&mut harness);
    let [Edit::SwitchNotation(PoseNotation { flange_from_tcp: Some(flange_from_tcp), .. })] = edits.as_slice() else {
        panic!("{edits:?}");
    };
    assert!((flange_from_tcp.translation_mm() - Vec3::new(0.0, 0.0, 150.0)).norm() < 1e-9);
    let quarter_turn = so3::exp(Vec3::z() * std::f64::consts::FRAC_PI_2);
    assert!(flange_from_tcp.rotation().angle_to(&quarter_turn) < 1e-12);
}

#[test]
fn both_are_one_step_of_undo_each() {
    let session = sample();
    let mut workbench = Workbench::new(Arc::new(|| {}));
    workbench.open_session(session.clone(), None);
    let kuka = PoseNotation::of(convention("kuka-abc"));
    for (edit, keeps_poses) in [(Edit::SwitchNotation(kuka), true), (Edit::Reinterpret(kuka), false)] {
        workbench.apply(Command::Edit { edit, gesture: None });
        let document = workbench.document().expect("open");
        assert_eq!(document.session.robot.notation, kuka);
        assert_eq!(document.session.stations == session.stations, keeps_poses);
        workbench.apply(Command::Undo);
        assert_eq!(*workbench.document().expect("open").session, session);
    }
}

#[test]
fn reinterpreting_shows_what_it_does_and_asks_for_one_edit() {
    let session = sample();
    let (num_poses, num_frames) = (session.num_captures(), model::frames(&session).len());
    let mut harness = Bench::harness(session);
    click(&mut harness, words::REINTERPRET);
    harness.get_by_label(words::REINTERPRET_WARNING);
    harness.get_by_label(words::NO_CHANGE);
    choose(&mut harness, words::ANGLES_OF, "FANUC W P R");
    harness.event(egui::Event::Text("kuka".to_owned()));
    harness.run_steps(4);
    harness.key_press(egui::Key::Enter);
    harness.run_steps(4);
    harness.get_by_label(&words::choice_name(words::ANGLES_OF, "KUKA A B C"));
    assert!(harness.query_by_label(words::NO_CHANGE).is_none());
    harness.get_by_label(&words::picture_name(words::THEN, num_frames));
    assert!(edits(&mut harness).is_empty(), "nothing is changed before the button");
    click(&mut harness, &words::reinterpret_poses(num_poses));
    assert_eq!(edits(&mut harness), [Edit::Reinterpret(PoseNotation::of(convention("kuka-abc")))]);
    assert!(harness.query_by_label(words::REINTERPRET_WARNING).is_none());
}

#[test]
fn what_cannot_be_read_so_is_said_in_the_dialog_and_cannot_be_applied() {
    let mut session = sample();
    session.stations[0].captures[0].base_from_flange =
        Transform::from_parts(Vec3::new(5000.0, 0.0, 0.0), so3::exp(Vec3::zeros()));
    let in_metres = PoseNotation { length_unit: LengthUnit::Metres, ..session.robot.notation };
    let refusal = Edit::Reinterpret(in_metres).apply(&session).expect_err("five kilometres").to_string();
    let num_poses = session.num_captures();
    let mut harness = Bench::harness(session);
    click(&mut harness, words::REINTERPRET);
    choose(&mut harness, words::LENGTH_UNIT, words::length_unit(LengthUnit::Metres));
    harness.get_by_label(&format!("! {refusal}"));
    click(&mut harness, &words::reinterpret_poses(num_poses));
    assert!(edits(&mut harness).is_empty());
    click(&mut harness, words::CANCEL);
    assert!(edits(&mut harness).is_empty());
}

#[test]
fn the_picture_unfolds_below_the_table_and_turns_by_a_drag() {
    let mut harness = Bench::harness(sample());
    let name = words::picture_name(words::PICTURE_TITLE, model::frames(&sample()).len());
    assert!(harness.query_by_label(&name).is_none());
    click(&mut harness, words::PICTURE);
    let place = harness.get_by_label(&name).rect().center();
    harness.drag_at(place);
    harness.run_steps(2);
    harness.drop_at(place + egui::vec2(60.0, 20.0));
    harness.run_steps(2);
    click(&mut harness, words::PICTURE);
    assert!(harness.query_by_label(&name).is_none() && harness.state().commands.is_empty());
}

#[test]
fn the_bar_tells_the_truth_of_any_notation() {
    let mut session = sample();
    session.robot.notation = PoseNotation {
        convention: convention("epson-uvw"),
        orientation: OrientationForm::QuaternionWxyz,
        angle_unit: AngleUnit::Radians,
        length_unit: LengthUnit::Metres,
        flange_from_tcp: Some(Transform::from_parts(Vec3::new(0.0, 0.0, 150.0), so3::exp(Vec3::zeros()))),
        is_inverse: true,
    };
    let harness = Bench::harness(session);
    harness.get_by_label(&words::choice_name(words::SHOWN_AS, "Quaternion w x y z"));
    harness.get_by_label("m");
    harness.get_by_label("tool point, inverse");
}

#[test]
fn the_preview_keeps_the_numbers_and_says_how_far_poses_turn_and_move() {
    let session = sample();
    let kuka_in_metres = PoseNotation { length_unit: LengthUnit::Metres, ..PoseNotation::of(convention("kuka-abc")) };
    let Err(refusal) =
        Preview::of(&session, &PoseNotation { orientation: OrientationForm::QuaternionWxyz, ..kuka_in_metres })
    else {
        panic!("six numbers are no quaternion");
    };
    assert!(refusal.to_string().contains("found 6 numbers, needed 7"), "{refusal}");
    let kuka = PoseNotation::of(convention("kuka-abc"));
    let preview = Preview::of(&session, &kuka).expect("angles are angles");
    for ((now, then), change) in preview.now.iter().zip(&preview.then).zip(&preview.changes) {
        let capture = |frame: &model::NamedFrame| {
            let mut capture = session.stations[0].captures[0].clone();
            capture.base_from_flange = frame.base_from_flange;
            capture.written_angles = None;
            capture
        };
        let before = session.robot.notation.numbers(&now.base_from_flange);
        let again = kuka.base_from_flange(&before).expect("numbers");
        assert!(again.rotation().angle_to(&then.base_from_flange.rotation()) < 1e-12);
        assert_eq!(shown_numbers(&capture(now), &session.robot.notation), before);
        let turned = now.base_from_flange.rotation().angle_to(&then.base_from_flange.rotation()).to_degrees();
        assert!((change.turns_deg - turned).abs() < 1e-6 && change.moves_mm < 1e-9, "{change:?}");
    }
}

#[test]
fn a_jog_about_an_axis_of_the_tool_is_one_only_in_the_right_convention() {
    let mut session = sample();
    let before = convention("kuka-abc").rotation_from_angles_deg([70.0, -35.0, 160.0]);
    for (station, rotation) in session.stations.iter_mut().zip([before, before * so3::exp(Vec3::z() * 0.4)]) {
        station.captures[0].base_from_flange = Transform::from_parts(Vec3::new(500.0, 0.0, 300.0), rotation);
        station.captures[0].written_angles = None;
    }
    let kuka = PoseNotation::of(convention("kuka-abc"));
    let misread = Edit::SwitchNotation(kuka)
        .apply(&session)
        .and_then(|shown| Edit::Reinterpret(PoseNotation::of(convention("mitsubishi-abc"))).apply(&shown))
        .expect("angles");
    let preview = Preview::of(&misread, &kuka).expect("angles");
    let (now, then) = (model::jog(&preview.now).expect("two"), model::jog(&preview.then).expect("two"));
    assert!((then.axis_in_flange - Vec3::z()).norm() < 1e-9 && (then.angle_deg - 0.4_f64.to_degrees()).abs() < 1e-9);
    assert!((now.axis_in_flange - Vec3::z()).norm() > 0.1, "{now:?}");
}

#[test]
fn a_tool_point_stays_the_same_in_other_numbers() {
    let flange_from_tcp = Transform::from_parts(Vec3::new(10.0, -20.0, 150.0), so3::exp(Vec3::new(0.2, 1.1, -0.4)));
    let fanuc = PoseNotation { flange_from_tcp: Some(flange_from_tcp), ..PoseNotation::default() };
    let mut draft = Draft::of(&fanuc);
    for convention in PoseConvention::all() {
        let radians_and_metres = PoseNotation {
            angle_unit: AngleUnit::Radians,
            length_unit: LengthUnit::Metres,
            orientation: OrientationForm::QuaternionXyzw,
            is_inverse: true,
            ..PoseNotation::of(convention)
        };
        draft.set(radians_and_metres);
        draft.set(PoseNotation::of(convention));
        let kept = draft.notation().expect("a notation").flange_from_tcp.expect("a tool point");
        assert!((kept.translation_mm() - flange_from_tcp.translation_mm()).norm() < 1e-9, "{}", convention.id);
        assert!(kept.rotation().angle_to(&flange_from_tcp.rotation()) < 1e-7, "{}", convention.id);
    }
    draft.has_tool_point = false;
    assert_eq!(draft.notation().expect("a notation").flange_from_tcp, None);
}

#[test]
fn the_search_finds_makers_names_formulas_and_orders() {
    let found = |search: &str| -> Vec<&'static str> {
        model::choices(search, true).into_iter().flat_map(|(_, choices)| choices).map(|choice| choice.label).collect()
    };
    let all = found("");
    assert_eq!(all.len(), PoseConvention::all().count() + 2);
    assert_eq!((all.first(), all.last()), (Some(&"FANUC W P R"), Some(&"Rotation vector")));
    assert_eq!(found("KUKA"), ["KUKA A B C"]);
    assert_eq!(found("staubli"), ["Stäubli Rx Ry Rz"]);
    assert_eq!(found("ros"), ["Quaternion x y z w"]);
    assert!(found("intrinsic zyz").contains(&"Kawasaki O A T"));
    assert_eq!(found("nothing like this"), [""; 0]);
}
