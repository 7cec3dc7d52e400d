//! The import's preview, driven by the names that screen readers see.
#![expect(clippy::expect_used, reason = "a test that finds nothing to check must fail")]

use std::sync::Arc;
use std::sync::mpsc::{Receiver, sync_channel};

use egui::accesskit::Role;
use egui::{Event, Key};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use handeye::app::{Command, ImportInto, Workbench};
use handeye::geometry::PoseNotation;
use handeye::geometry::notation::LengthUnit;
use handeye::session::import::bag::Taking;
use handeye::session::import::{self, BagOptions, ImportOptions, Imported, Kind};
use handeye::session::{self, Target, samples};
use handeye::text::{import as words, import_bag as bag_words, shell as shell_words, start as start_words};
use handeye::ui::dialogs::SavePath;
use handeye::ui::file_dialog::Purpose;
use handeye::ui::import::{ImportMemory, ImportState};
use handeye::ui::{self, Start, Step, Window};

const SIZE: [f32; 2] = [1440.0, 900.0];

const TABLE: &str = "label,x,y,z,w,p,r,point x,point y,point z\n\
    a,562.4,-110.2,-139.4,170.5,10.2,-40.1,-8.5,18.7,-46.1\n\
    b,555.8,-129.2,154.9,160.0,-12.5,-35.3,17.2,29.1,-36.5\n\
    c,576.5,-98.9,-141.6,-175.1,5.0,-60.2,-20.1,21.4,-40.0\n\
    d,553.8,oops,-133.0,168.0,22.1,10.0,-12.5,-10.5,-48.5\n";

/// A table as a paper prints it, of two stations.
const PRINTED: &str = "Table 1. Poses and ball centres\n\
    | 1 | $q_0=0.5$ | $t_1=300.5$ | $x_s=-26.25$ |\n\
    |   | $q_1=-0.5$ | $t_2=-54.9$ | $y_s=4.02$ |\n\
    |   | $q_2=0.5$ | $t_3=59.2$ | $z_s=78.46$ |\n\
    |   | $q_3=0.5$ | | |\n\
    | 2 | $q_0=0.6$ | $t_1=340.9$ | $x_s=-25.88$ |\n\
    |   | $q_1=0.0$ | $t_2=-76.5$ | $y_s=2.69$ |\n\
    |   | $q_2=-0.8$ | $t_3=112.2$ | $z_s=32.09$ |\n\
    |   | $q_3=0.0$ | | |\n";

struct Bench {
    workbench: Workbench,
    woken: Receiver<()>,
    state: ImportState,
    memory: ImportMemory,
    commands: Vec<Command>,
}

impl Bench {
    fn empty() -> Self {
        let (sender, woken) = sync_channel(64);
        let wake = move || {
            // A full channel already holds the news that there is news.
            sender.try_send(()).ok();
        };
        Self {
            workbench: Workbench::new(Arc::new(wake)),
            woken,
            state: ImportState::default(),
            memory: ImportMemory::default(),
            commands: Vec::new(),
        }
    }

    fn with(text: &str) -> Self {
        let mut bench = Self::empty();
        bench.apply(Command::ImportText(text.to_owned()));
        bench
    }

    fn apply(&mut self, command: Command) {
        self.workbench.apply(command);
        while self.workbench.is_busy() {
            self.woken.recv().expect("the worker wakes us");
            self.workbench.poll();
        }
    }

    fn imported(&self) -> &Imported {
        let outcome = self.workbench.import().expect("a preview").outcome.as_ref();
        outcome.expect("read").as_deref().expect("recognised")
    }

    fn ui(ui: &mut egui::Ui, bench: &mut Self) {
        let ctx = ui.ctx().clone();
        ui::import::show(&ctx, &bench.workbench, &mut bench.state, &mut bench.memory, &mut bench.commands);
    }

    fn harness(self) -> Harness<'static, Self> {
        self.harness_of_size(SIZE)
    }

    fn harness_of_size(self, size: [f32; 2]) -> Harness<'static, Self> {
        let mut harness =
            Harness::builder().with_size(size).with_context_setup(ui::theme::install).build_ui_state(Self::ui, self);
        harness.run_steps(4);
        harness
    }
}

fn click<T>(harness: &mut Harness<'static, T>, name: &str) {
    harness.get_by_label(name).click();
    harness.run_steps(3);
}

/// Clicks an entry of the list that is open.
fn pick<T>(harness: &mut Harness<'static, T>, entry: &str) {
    harness.get_by_role_and_label(Role::Button, entry).click();
    harness.run_steps(3);
}

fn type_into<T>(harness: &mut Harness<'static, T>, name: &str, text: &str) {
    harness.get_by_label(name).focus();
    harness.run_steps(2);
    harness.get_by_label(name).type_text(text);
    harness.run_steps(2);
}

#[test]
fn a_role_chosen_over_a_column_yields_exactly_the_options_with_it() {
    let mut harness = Bench::with(TABLE).harness();
    let roles = harness.state().imported().preview.roles.clone();
    assert_eq!(roles[1..3], [import::Role::Position(0), import::Role::Position(1)]);
    click(&mut harness, &words::column_role(2));
    let y = words::role(import::Role::Position(1), &PoseNotation::default(), LengthUnit::Millimetres);
    pick(&mut harness, &y);
    let mut swapped = roles;
    swapped.swap(1, 2);
    let options = ImportOptions { roles: Some(swapped), ..ImportOptions::default() };
    assert_eq!(harness.state().commands, [Command::SetImportOptions(Box::new(options))]);
}

#[test]
fn a_unit_chosen_at_the_left_changes_that_and_nothing_else() {
    let mut harness = Bench::with(TABLE).harness();
    let notation = harness.state().imported().options.notation.expect("recognised");
    click(&mut harness, &words::setting(words::POSITION_UNIT));
    click(&mut harness, words::METRES);
    let notation = PoseNotation { length_unit: LengthUnit::Metres, ..notation };
    let options = ImportOptions { notation: Some(notation), ..ImportOptions::default() };
    assert_eq!(harness.state().commands, [Command::SetImportOptions(Box::new(options))]);
}

#[test]
fn a_tool_point_is_typed_as_six_numbers() {
    let mut bench = Bench::with(TABLE);
    let notation = bench.imported().options.notation.expect("recognised");
    let tcp = handeye::geometry::Transform::identity();
    let options = ImportOptions {
        notation: Some(PoseNotation { flange_from_tcp: Some(tcp), ..notation }),
        ..ImportOptions::default()
    };
    bench.apply(Command::SetImportOptions(Box::new(options)));
    let mut harness = bench.harness();
    let field = words::frame_number(words::TOOL_POINT_IN_FLANGE, "z / mm");
    type_into(&mut harness, &field, "15");
    harness.key_press(Key::Enter);
    harness.run_steps(3);
    let [Command::SetImportOptions(options)] = &harness.state().commands[..] else {
        panic!("found {:?}", harness.state().commands);
    };
    let tcp = options.notation.and_then(|notation| notation.flange_from_tcp).expect("a tool point");
    // The field held a 0 already.
    let z = tcp.translation_mm().z;
    assert!((z - 150.0).abs() < 1e-9 || (z - 15.0).abs() < 1e-9, "{z}");
}

#[test]
fn a_bag_shows_its_topics_and_what_became_of_its_messages() {
    let mut bench = Bench::empty();
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/bags/tf_cloud_db3");
    bench.apply(Command::Import(vec![path]));
    let report = bench.imported().notes.iter().find_map(|note| match note {
        import::Note::Bag(_) => Some(words::note(note)),
        _ => None,
    });
    assert_eq!(bench.imported().stations.len(), 3);
    let mut harness = bench.harness();
    harness.get_by_label(&report.expect("what became of the bag"));
    harness.get_by_label(&words::setting(bag_words::PROFILE_TOPIC));
    let flange = words::setting(bag_words::FLANGE_FRAME);
    assert_eq!(harness.get_by_label(&flange).value().as_deref(), Some("tool0 (fixed in wrist)"));
    // The topics with their counts, and those in use.
    harness.get_by_label("/tf_static");
    harness.get_by_label("profiles, in use");
    harness.get_by_label("PointCloud2");
    // Another frame of the tree is picked from the list.
    click(&mut harness, &flange);
    pick(&mut harness, "wrist (in arm)");
    let bag = BagOptions { flange_frame: Some("wrist".to_owned()), ..BagOptions::default() };
    let picked = ImportOptions { bag, ..ImportOptions::default() };
    assert_eq!(harness.state().commands, [Command::SetImportOptions(Box::new(picked))]);
    harness.state_mut().commands.clear();
    click(&mut harness, &words::setting(bag_words::TAKING));
    pick(&mut harness, bag_words::taking(Taking::EveryProfile));
    let bag = BagOptions { taking: Some(Taking::EveryProfile), ..BagOptions::default() };
    let options = ImportOptions { bag, ..ImportOptions::default() };
    assert_eq!(harness.state().commands, [Command::SetImportOptions(Box::new(options.clone()))]);
    let bench = harness.state_mut();
    bench.apply(Command::SetImportOptions(Box::new(options)));
    // Every profile with a pose: more captures than stays, sweeps of one orientation together.
    let captures: usize = bench.imported().stations.iter().map(|station| station.captures.len()).sum();
    assert!(captures > 20, "{captures}");
}

#[test]
fn what_was_set_for_a_bag_is_remembered_as_far_as_the_next_one_has_it() {
    let path = |name: &str| std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/bags").join(name);
    let mut bench = Bench::empty();
    bench.apply(Command::Import(vec![path("tf_cloud_db3")]));
    let mut harness = bench.harness();
    let bag = BagOptions {
        pose_topic: Some("/tf".to_owned()),
        flange_frame: Some("wrist".to_owned()),
        still_within_mm: 0.07,
        joins_stays: false,
        ..BagOptions::default()
    };
    let options = ImportOptions { bag: bag.clone(), ..ImportOptions::default() };
    harness.state_mut().apply(Command::SetImportOptions(Box::new(options)));
    harness.run_steps(3);
    type_into(&mut harness, words::RADIUS_FIELD, "15");
    click(&mut harness, words::NEW_SESSION);
    // The next recording of the same robot, and one without these topics.
    for (name, expected) in [
        ("tf_cloud_db3", bag.clone()),
        ("pose_cloud_f64_lz4.mcap", BagOptions { pose_topic: None, flange_frame: None, ..bag.clone() }),
    ] {
        let bench = harness.state_mut();
        bench.apply(Command::CancelImport);
        bench.commands.clear();
        bench.apply(Command::Import(vec![path(name)]));
        harness.run_steps(3);
        let found = harness.state().commands.iter().find_map(|command| match command {
            Command::SetImportOptions(options) => Some(options.bag.clone()),
            _ => None,
        });
        assert_eq!(found, Some(expected), "{name}");
    }
}

#[test]
fn problems_are_listed_with_their_place_and_marked_in_the_table() {
    let harness = Bench::with(TABLE).harness();
    let problem = harness.state().imported().problems.first().expect("one cell is no number").to_string();
    assert!(problem.contains("line 5"), "{problem}");
    harness.get_by_label(&problem);
    harness.get_by_label(&words::outcome(harness.state().imported()));
}

#[test]
fn a_new_session_needs_a_radius_and_then_is_the_next_step() {
    let poses: Vec<String> = TABLE.lines().map(|line| line.split(',').take(7).collect::<Vec<_>>().join(",")).collect();
    let mut harness = Bench::with(&poses.join("\n")).harness();
    click(&mut harness, words::NEW_SESSION);
    assert!(harness.state().commands.is_empty(), "without a radius there is no ball");
    type_into(&mut harness, words::RADIUS_FIELD, "12,5");
    click(&mut harness, words::NEW_SESSION);
    let into = ImportInto::NewSession { name: "Pasted poses".to_owned(), target: Target::ball(12.5) };
    assert_eq!(harness.state().commands, [Command::FinishImport(into)]);
    assert_eq!(harness.state().memory.ball_radius_mm, Some(12.5));
}

#[test]
fn points_that_are_reduced_need_no_radius_of_the_user() {
    let mut harness = Bench::with(TABLE).harness();
    click(&mut harness, words::NEW_SESSION);
    let into = ImportInto::NewSession { name: "Pasted poses".to_owned(), target: Target::ball(15.0) };
    assert_eq!(harness.state().commands, [Command::FinishImport(into)]);
}

#[test]
fn stations_can_be_added_only_where_a_session_is_open() {
    let mut harness = Bench::with(TABLE).harness();
    click(&mut harness, words::ADD);
    assert!(harness.state().commands.is_empty());
    let mut bench = Bench::with(TABLE);
    let sample = session::parse(samples::ALL[0].json.as_bytes(), "sample").expect("valid");
    bench.workbench.open_session(sample, None);
    let mut harness = bench.harness();
    click(&mut harness, words::ADD);
    assert_eq!(harness.state().commands, [Command::FinishImport(ImportInto::OpenSession)]);
}

#[test]
fn a_column_edge_makes_a_plate_and_goes_to_no_other_target() {
    const PLATE: &str = "label,edge,x,y,z,w,p,r,px,py,pz\n\
        a,p,562.4,-110.2,-139.4,170.5,10.2,-40.1,1,0,80\n\
        b,q,555.8,-129.2,154.9,160.0,-12.5,-35.3,2,0,81\n";
    let mut harness = Bench::with(PLATE).harness();
    click(&mut harness, words::NEW_SESSION);
    let into = ImportInto::NewSession { name: "Pasted poses".to_owned(), target: Target::RightAnglePlate };
    assert_eq!(harness.state().commands, [Command::FinishImport(into)]);
    let mut harness = Bench::with(PLATE).harness();
    click(&mut harness, words::TARGET_FIELD);
    pick(&mut harness, words::POINT);
    click(&mut harness, words::NEW_SESSION);
    assert!(harness.state().commands.is_empty(), "the edges would be lost");
    let mut bench = Bench::with(PLATE);
    let sample = session::parse(samples::ALL[0].json.as_bytes(), "sample").expect("valid");
    bench.workbench.open_session(sample, None);
    let mut harness = bench.harness();
    click(&mut harness, words::ADD);
    assert!(harness.state().commands.is_empty(), "the open session is about a ball");
}

#[test]
fn escape_closes_a_list_first_and_then_the_preview() {
    let mut harness = Bench::with(TABLE).harness();
    click(&mut harness, &words::setting(words::ORIENTATION));
    harness.key_press(Key::Escape);
    harness.run_steps(3);
    assert!(harness.state().commands.is_empty());
    harness.get_by_label(words::RADIUS_FIELD).focus();
    harness.run_steps(2);
    harness.key_press(Key::Escape);
    harness.run_steps(3);
    assert!(harness.state().commands.is_empty(), "the field is left first");
    harness.key_press(Key::Escape);
    harness.run_steps(1);
    assert_eq!(harness.state().commands, [Command::CancelImport]);
}

#[test]
fn what_was_set_for_a_table_is_applied_to_the_next_with_the_same_columns() {
    let bench = Bench::with(TABLE);
    let notation = bench.imported().options.notation.expect("recognised");
    let options = ImportOptions {
        notation: Some(PoseNotation { length_unit: LengthUnit::Metres, ..notation }),
        ..ImportOptions::default()
    };
    let mut harness = bench.harness();
    harness.state_mut().apply(Command::SetImportOptions(Box::new(options.clone())));
    harness.run_steps(3);
    type_into(&mut harness, words::RADIUS_FIELD, "15");
    click(&mut harness, words::NEW_SESSION);
    harness.state_mut().commands.clear();
    let other = TABLE.replace("562.4", "1.25");
    harness.state_mut().apply(Command::ImportText(other));
    harness.run_steps(3);
    let recalled = Command::SetImportOptions(Box::new(options));
    assert_eq!(harness.state().commands, std::slice::from_ref(&recalled));
    harness.state_mut().commands.clear();
    harness.state_mut().apply(recalled);
    harness.run_steps(3);
    harness.get_by_label(words::AS_LAST_TIME);
    click(&mut harness, words::FORGET);
    assert_eq!(harness.state().commands, [Command::SetImportOptions(Box::default())]);
    harness.state_mut().apply(Command::ImportText(TABLE.to_owned()));
    harness.state_mut().commands.clear();
    harness.run_steps(3);
    assert!(harness.state().commands.is_empty(), "forgotten");
}

#[test]
fn what_is_not_recognised_says_what_can_be_read_and_lets_the_form_be_chosen() {
    let mut harness = Bench::with("dear colleague, see the poses attached").harness();
    harness.get_by_label(words::CHOOSE_FORM);
    click(&mut harness, &words::setting(words::FORM));
    pick(&mut harness, words::kind(Kind::UrScript));
    let options = ImportOptions { kind: Some(Kind::UrScript), ..ImportOptions::default() };
    assert_eq!(harness.state().commands, [Command::SetImportOptions(Box::new(options))]);
}

#[test]
fn every_kind_of_outcome_is_drawn_at_every_size() {
    let lines = |lines: Vec<String>| lines.join("\n");
    let profile = lines((0..40).map(|idx| format!("{:.2},1.0", f64::from(idx) * 0.05)).collect());
    let wide = lines(TABLE.lines().map(|line| format!("{line},{}", "0,".repeat(20))).collect());
    for text in [TABLE, PRINTED, "", "prose", &profile, &wide, samples::ALL[0].json] {
        for size in [SIZE, [1024.0, 768.0], [960.0, 640.0]] {
            let harness = Bench::with(text).harness_of_size(size);
            harness.get_by_label(words::NEW_SESSION);
        }
    }
}

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

fn workbench<'a>(harness: &'a Harness<'static, Window>) -> &'a Workbench {
    harness.state().shell().workbench()
}

#[test]
fn a_printed_table_is_pasted_made_a_session_and_undone_changes_are_asked_for() {
    let mut harness = window();
    harness.event(Event::Paste(PRINTED.to_owned()));
    settle(&mut harness);
    type_into(&mut harness, words::RADIUS_FIELD, "30");
    harness.get_by_label(words::NEW_SESSION).click();
    settle(&mut harness);
    let document = workbench(&harness).document().expect("made");
    assert_eq!((document.session.stations.len(), document.is_unsaved()), (2, true));
    assert_eq!(harness.state().shell().step(), Step::Poses);
    // The next one would put it away: it is asked for first.
    harness.state_mut().shell_mut().go_to(Step::Session);
    harness.run_steps(2);
    harness.event(Event::Paste(PRINTED.to_owned()));
    settle(&mut harness);
    harness.get_by_label(words::NEW_SESSION).click();
    settle(&mut harness);
    harness.get_by_label(shell_words::DISCARD);
    assert!(workbench(&harness).import().is_some(), "the preview waits for the answer");
}

#[test]
fn pasting_into_a_field_is_no_import() {
    let mut harness = window();
    harness.get_by_label(start_words::PATH).focus();
    harness.run_steps(2);
    harness.event(Event::Paste("/some/path.json".to_owned()));
    settle(&mut harness);
    assert!(workbench(&harness).import().is_none());
}

#[test]
fn an_empty_clipboard_is_told_in_the_preview_and_keys_below_it_do_nothing() {
    let mut harness = window();
    harness.get_by_label(words::PASTE).click();
    settle(&mut harness);
    harness.get_by_label(words::CLIPBOARD_EMPTY);
    harness.key_press(Key::Num4);
    settle(&mut harness);
    assert_eq!(harness.state().shell().step(), Step::Session);
    harness.event(Event::Paste(TABLE.to_owned()));
    settle(&mut harness);
    harness.get_by_label(&words::column_role(1));
    harness.key_press(Key::Escape);
    settle(&mut harness);
    assert!(workbench(&harness).import().is_none());
}

#[test]
fn a_table_typed_as_a_path_is_previewed_and_a_broken_session_is_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let table = folder.path().join("poses.csv");
    std::fs::write(&table, TABLE).expect("written");
    let broken = folder.path().join("broken.json");
    std::fs::write(&broken, "{").expect("written");
    let mut harness = window();
    harness.state_mut().shell_mut().request(Command::Open(broken));
    settle(&mut harness);
    assert!(workbench(&harness).import().is_none());
    assert_eq!(workbench(&harness).notices().len(), 1);
    harness.state_mut().shell_mut().request(Command::Open(table));
    settle(&mut harness);
    harness.get_by_label(&words::column_role(1));
    assert!(workbench(&harness).notices().is_empty());
}

#[test]
fn a_path_is_typed_for_every_purpose_where_there_is_no_dialog() {
    for purpose in [Purpose::ImportFiles, Purpose::AddSession, Purpose::ExportPoses, Purpose::ExportProfiles] {
        let question = SavePath::to(purpose, "/some/where".to_owned());
        let mut harness = Harness::builder().with_size(SIZE).with_context_setup(ui::theme::install).build_ui_state(
            |ui, (question, answers): &mut (SavePath, Vec<_>)| answers.extend(question.ask(&ui.ctx().clone())),
            (question, Vec::new()),
        );
        harness.run_steps(3);
        harness.get_by_label(purpose.title());
        harness.get_by_label(purpose.button()).click();
        harness.run_steps(3);
        assert_eq!(harness.state().1.len(), 1, "{purpose:?}");
    }
}

#[test]
fn columns_that_do_not_make_a_pose_leave_everything_to_be_set() {
    let mut bench = Bench::with(TABLE);
    let roles = vec![import::Role::Ignore; 10];
    bench.apply(Command::SetImportOptions(Box::new(ImportOptions { roles: Some(roles), ..ImportOptions::default() })));
    let mut harness = bench.harness();
    harness.get_by_label(words::NOTHING);
    harness.get_by_label(&words::column_role(1));
    harness.get_by_label(&words::setting(words::ORIENTATION));
    click(&mut harness, words::RESET);
    assert_eq!(harness.state().commands, [Command::SetImportOptions(Box::default())]);
}
