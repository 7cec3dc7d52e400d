//! The capture panel, driven by the names that screen readers see: from made-up cells, and on a simulated one.
#![expect(clippy::expect_used, reason = "helpers of tests may fail as tests do")]

use std::sync::Arc;
use std::time::{Duration, Instant};

use egui::Key;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use handeye::app::Command;
use handeye::app::cell::{
    Activity, CellCommand, CellSettings, CellView, LinkView, LiveProfile, Proposal, ReplayView, RoughMounting, RunView,
};
use handeye::calibrate::SideChoice;
use handeye::device::search::{CurveEstimate, SearchPoint};
use handeye::device::sim::SimOptions;
use handeye::device::{
    DeviceError, Endpoint, LinkState, MotionRefusal, ProfileReading, Readiness, RobotKind, RobotReport, RobotSetup,
    RoutineEnd, SearchEnd, SearchPhase, SearchReport, SensorKind, SensorSetup,
};
use handeye::fit::{ArcOptions, ArcRefusal, Sought};
use handeye::geometry::{Profile, Transform, Vec3};
use handeye::plan::PlannedStation;
use handeye::session::model::UnknownFields;
use handeye::session::{self, Capture, Edge, Reading, Session, Station, Target, samples, sought};
use handeye::text::{
    capture as words, capture_edges as words_of_edges, capture_settings as setting_words, shell as shell_words,
};
use handeye::ui::actions::Action;
use handeye::ui::capture::{self, CaptureState, CellMemory, View};
use handeye::ui::{self, Start, Step, Window};

/// A cell made up by hand, with the panel that shows it.
struct Bench {
    cell: CellView,
    session: Option<Session>,
    memory: CellMemory,
    state: CaptureState,
    commands: Vec<Command>,
    actions: Vec<Action>,
}

impl Bench {
    fn new(cell: CellView) -> Self {
        Self {
            cell,
            session: Some(empty_session()),
            memory: CellMemory::default(),
            state: CaptureState::default(),
            commands: Vec::new(),
            actions: Vec::new(),
        }
    }

    fn ui(ui: &mut egui::Ui, bench: &mut Self) {
        let view = View {
            cell: &bench.cell,
            session: bench.session.as_ref(),
            has_solution: false,
            outlook: None,
            has_other_mounting: false,
            results: None,
        };
        let (memory, state) = (&mut bench.memory, &mut bench.state);
        capture::show_view(ui, view, memory, state, &mut bench.commands, &mut bench.actions);
    }

    fn harness(self) -> Harness<'static, Self> {
        self.harness_of_size([1244.0, 792.0])
    }

    fn harness_of_size(self, size: [f32; 2]) -> Harness<'static, Self> {
        let mut harness =
            Harness::builder().with_size(size).with_context_setup(ui::theme::install).build_ui_state(Self::ui, self);
        harness.run_steps(4);
        harness
    }

    /// What a click on a name asks for.
    fn asked_by(self, name: &str) -> Vec<Command> {
        let mut harness = self.harness();
        harness.get_by_label(name).click();
        harness.run_steps(3);
        harness.state().commands.clone()
    }
}

fn sample() -> Session {
    let sample = samples::ALL.iter().find(|sample| sample.file_name == "clean-sweeps.json").expect("a sample");
    session::parse(sample.json.as_bytes(), sample.file_name).expect("the sample is a session")
}

fn empty_session() -> Session {
    Session { stations: Vec::new(), target: Target::ball(15.0), ..sample() }
}

fn report(readiness: Readiness) -> RobotReport {
    RobotReport {
        base_from_flange: Transform::from_parts(
            Vec3::new(459.068, 72.709, 204.782),
            nalgebra::UnitQuaternion::from_euler_angles(std::f64::consts::PI, 0.0, 0.314),
        ),
        joints_deg: Vec::new(),
        is_moving: Some(false),
        readiness,
        tool: "UTOOL 1 in UFRAME 0".to_owned(),
        resolution_mm: 0.001,
        received_at: Instant::now(),
    }
}

/// A ball's section of radius `section_mm` above a table.
fn live(section_mm: f64) -> LiveProfile {
    let x_mm: Vec<f64> = (-200..=200_i16).map(|idx| f64::from(idx) * 0.15).collect();
    let z_at = |x: &f64| {
        let inside = section_mm * section_mm - x * x;
        if inside > 20.0 { 8.0 - inside.sqrt() } else { 30.0 + 0.1 * x }
    };
    // The profile hardly repeats: a little noise that looks it.
    let noisy = |(idx, x): (usize, &f64)| Some(z_at(x) + 0.004 * f64::from(u8::try_from(idx * 37 % 11).unwrap_or(0)));
    let z_mm: Vec<_> = x_mm.iter().enumerate().map(noisy).collect();
    let profile = Arc::new(Profile::new(x_mm, &z_mm).expect("valid"));
    let ball = Sought::Arc(ArcOptions { ball_radius_mm: 15.0, profile_std_mm: None });
    let found = ball.find(&profile);
    let reading = ProfileReading { profile, trigger_count: 7, received_at: Instant::now() };
    LiveProfile { reading, found, rate_hz: 30.0 }
}

fn robot_setup(kind: RobotKind) -> RobotSetup {
    RobotSetup { kind, endpoint: Endpoint { host: "192.168.0.10".to_owned(), port: kind.default_port() } }
}

fn sensor_setup() -> SensorSetup {
    let kind = SensorKind::KeyenceLjv;
    let endpoint = Endpoint { host: "192.168.0.20".to_owned(), port: kind.default_port() };
    SensorSetup { kind, endpoint, folder: std::path::PathBuf::new(), is_z_inverted: false }
}

fn connected(readiness: Readiness) -> CellView {
    let setup = Some(robot_setup(RobotKind::FanucMappdk));
    let live = live(13.5);
    CellView {
        robot: LinkView { setup, state: LinkState::Ready, latest: Some(report(readiness)) },
        sensor: LinkView { setup: Some(sensor_setup()), state: LinkState::Ready, latest: Some(live.reading.clone()) },
        live: Some(live),
        ..CellView::default()
    }
}

/// Ready for anything.
fn armed() -> CellView {
    let mounting = RoughMounting { translation_mm: [20.0, -10.0, 250.0], quaternion_wxyz: [1.0, 0.0, 0.0, 0.0] };
    let settings = CellSettings { mounting: Some(mounting), ..CellSettings::default() };
    CellView { is_armed: true, settings, ..connected(Readiness::Ready) }
}

fn proposal(refusal: Option<MotionRefusal>) -> Proposal {
    let station = PlannedStation {
        base_from_flange: Transform::from_parts(
            Vec3::new(404.1, 123.5, 188.1),
            nalgebra::UnitQuaternion::from_euler_angles(2.8, 0.13, 1.25),
        ),
        edge: None,
        tilt_deg: 18.0,
        azimuth_deg: 60.0,
        spin_deg: -30.0,
        workspace_point_std_mm: Some(0.12),
    };
    let reason = "tilted 18° towards 60°: it brings σ of the workspace point from 0.13 to about 0.12 mm".to_owned();
    Proposal { station, reason, distance_mm: 82.0, turn_deg: 31.0, refusal }
}

/// A search that is past the peak.
fn search(end: Option<SearchEnd>) -> SearchReport {
    let seen = |idx: u8| {
        let travelled_mm = 0.75 * f64::from(idx);
        let radius_mm = (225.0 - (travelled_mm - 6.0).powi(2)).sqrt();
        SearchPoint { commanded_mm: travelled_mm, travelled_mm, radius_and_std_mm: Some([radius_mm, 0.004]) }
    };
    SearchReport {
        phase: if end.is_some() { SearchPhase::Ended } else { SearchPhase::Pass },
        sign: 1.0,
        points: (0..11).map(seen).collect(),
        curve: Some(CurveEstimate { peak_mm: 6.003, peak_std_mm: 0.021, curvature: 1.0 }),
        published_stop_idx: Some(9),
        end,
    }
}

const RUN: RunView = RunView { num_done: 3, num_failed: 0, num_stations: 8, is_paused: false, is_asking: false };

fn cell(command: CellCommand) -> Vec<Command> {
    vec![Command::Cell(Box::new(command))]
}

#[test]
fn every_button_asks_for_exactly_its_command() {
    let with_proposal = |refusal| CellView { proposal: Some(proposal(refusal)), ..armed() };
    let running = CellView { run: Some(RUN), activity: Activity::Settling, ..armed() };
    let paused = CellView { run: Some(RunView { is_paused: true, ..RUN }), ..armed() };
    let replaying = CellView { replay: Some(ReplayView { station_idx: 0, capture_idx: 2, is_over: false }), ..armed() };
    for (view, name, command) in vec![
        (armed(), words::FIND, CellCommand::FindLargestArc),
        (armed(), words::CAPTURE, CellCommand::CaptureStation),
        (armed(), words::PROPOSE_NAME, CellCommand::ProposeStation),
        (armed(), words::START_RUN, CellCommand::StartRun { num_stations: 8 }),
        (armed(), words::ARM, CellCommand::Arm(false)),
        (armed(), words::STOP, CellCommand::Stop),
        (connected(Readiness::Ready), words::ARM, CellCommand::Arm(true)),
        (armed(), words::DISCONNECT_ROBOT, CellCommand::DisconnectRobot),
        (armed(), words::DISCONNECT_PROFILER, CellCommand::DisconnectSensor),
        (with_proposal(None), words::ACCEPT, CellCommand::AcceptProposal),
        (with_proposal(None), words::ANOTHER_NAME, CellCommand::SkipProposal),
        (with_proposal(None), words::FORGET_NAME, CellCommand::DropProposal),
        (running.clone(), words::PAUSE_NAME, CellCommand::PauseRun),
        (running, words::STOP, CellCommand::Stop),
        (paused, words::RESUME_NAME, CellCommand::ResumeRun),
        (replaying, words::END_REPLAY, CellCommand::EndReplay),
        (CellView { is_practice: true, ..armed() }, words::END_PRACTICE, CellCommand::EndPractice),
        (CellView::default(), words::PRACTISE_SHORT, CellCommand::Practise(None)),
        (CellView { run: Some(RunView { num_done: 8, ..RUN }), ..armed() }, words::DISARM, CellCommand::Arm(false)),
    ] {
        assert_eq!(Bench::new(view).asked_by(name), cell(command), "{name}");
    }
    let with_stations = Bench { session: Some(sample()), ..Bench::new(CellView::default()) };
    assert_eq!(with_stations.asked_by(words::REPLAY), cell(CellCommand::StartReplay));
}

#[test]
fn the_next_thing_is_the_primary_button() {
    let start = CellCommand::StartRun { num_stations: 8 };
    for (view, label, command) in [
        (connected(Readiness::Ready), words::ARM, CellCommand::Arm(true)),
        (connected(Readiness::ReadOnly), words::CAPTURE, CellCommand::CaptureStation),
        (armed(), words::START_RUN, start),
        (CellView { proposal: Some(proposal(None)), ..armed() }, words::ACCEPT, CellCommand::AcceptProposal),
    ] {
        assert_eq!(Bench::new(view).asked_by(&words::next_button(label)), cell(command), "{label}");
    }
    let over = CellView { run: Some(RunView { num_done: 8, ..RUN }), ..armed() };
    let mut harness = Bench::new(over).harness();
    harness.get_by_label(&words::next_button(words::COMPARE)).click();
    harness.run_steps(3);
    assert_eq!(harness.state().actions, [Action::GoTo(Step::Compare)]);
    assert!(harness.state().commands.is_empty());
}

#[test]
fn settings_in_use_cannot_be_changed() {
    for (activity, num_asked) in [(Activity::Idle, 1), (Activity::Settling, 0)] {
        let mut harness = Bench::new(CellView { activity, ..armed() }).harness();
        harness.get_by_label(setting_words::LIMITS).click();
        harness.run_steps(4);
        harness.get_by_label(setting_words::WORKSPACE).click();
        harness.run_steps(2);
        assert!(harness.state().commands.len() == num_asked, "{activity:?}: {:?}", harness.state().commands);
        assert_eq!(harness.query_by_label(setting_words::IN_USE).is_some(), num_asked == 0);
    }
}

#[test]
fn the_last_search_is_told_from_the_one_under_way() {
    let found = SearchEnd::Found { peak_mm: 6.003, peak_std_mm: 0.021 };
    let view = |activity, end| CellView { search: Some(Arc::new(search(end))), activity, run: Some(RUN), ..armed() };
    for (activity, end, is_past) in [
        (Activity::Moving, Some(found.clone()), true),
        (Activity::Idle, Some(found), false),
        (Activity::Settling, None, false),
    ] {
        let harness = Bench::new(view(activity, end)).harness();
        let num_told = harness.query_all_by_label(words::LAST_STATION).count();
        assert_eq!(num_told, if is_past { 2 } else { 0 }, "at the curve and at the boxes: {activity:?}");
    }
}

#[test]
fn a_slanted_travel_and_the_noise_of_repeats_are_told() {
    let mut slanted = search(None);
    slanted.curve = Some(CurveEstimate { peak_mm: 6.0, peak_std_mm: 0.02, curvature: 0.97 });
    let view = CellView { search: Some(Arc::new(slanted)), repeat_std_mm: Some(0.0042), ..armed() };
    let harness = Bench::new(view).harness();
    harness.get_by_label_contains("c = 0.970");
    harness.get_by_label(&words::repeat_noise("4.2"));
}

#[test]
fn what_cannot_be_done_does_nothing() {
    let refused = CellView { proposal: Some(proposal(Some(MotionRefusal::NotArmed))), ..armed() };
    for (view, name) in [
        (connected(Readiness::Ready), words::FIND),
        (connected(Readiness::Ready), words::START_RUN),
        (connected(Readiness::Ready), words::PROPOSE_NAME),
        (connected(Readiness::ReadOnly), words::ARM),
        (CellView::default(), words::CAPTURE),
        (CellView::default(), words::STOP),
        (CellView::default(), words::CONNECT_ROBOT),
        (refused, words::ACCEPT),
        (CellView { activity: Activity::Moving, ..armed() }, words::FIND),
    ] {
        assert_eq!(Bench::new(view).asked_by(name), [], "{name}");
    }
}

#[test]
fn a_broken_link_says_what_happened_and_when_it_is_tried_again() {
    let error = DeviceError::Timeout { device: "Robot", request: "curpos".to_owned(), waited: Duration::from_secs(2) };
    let state = LinkState::Failed { error: error.clone(), retry_in: Some(Duration::from_secs(4)) };
    let robot = LinkView { setup: Some(robot_setup(RobotKind::FanucMappdk)), state, latest: None };
    let harness = Bench::new(CellView { robot, ..connected(Readiness::Ready) }).harness();
    harness.get_by_label_contains(&words::again_in(Duration::from_secs(4)));
    let told = harness.query_all_by_label_contains(&error.to_string()).count();
    assert_eq!(told, 1, "in one place");
    harness.get_by_label(&words::next_button(words::RETRY));
    harness.get_by_label(words::RETRY_ROBOT);
    let delay = harness.output().viewport_output[&egui::ViewportId::ROOT].repaint_delay;
    assert!(delay <= Duration::from_secs(1), "it counts down: {delay:?}");
}

#[test]
fn states_are_told_in_words() {
    let not_remote = Readiness::NotReady { found: "T1 mode".to_owned(), remedy: "turn the key to AUTO" };
    let page = LinkView {
        setup: Some(robot_setup(RobotKind::FanucPage)),
        state: LinkState::Ready,
        latest: Some(report(Readiness::ReadOnly)),
    };
    let refusal = MotionRefusal::TooFar { found_mm: 512.0, max_mm: 400.0 };
    let no_arc = LiveProfile { found: Err(ArcRefusal::TooFewPoints { found: 3, needed: 20 }.into()), ..live(13.5) };
    let reason = ArcRefusal::TooFewPoints { found: 3, needed: 20 }.to_string();
    let never_still = RoutineEnd::NeverStill { moved_mm: Some(0.4) };
    for (view, sentence) in [
        (connected(not_remote), "turn the key to AUTO".to_owned()),
        (CellView { robot: page, ..connected(Readiness::Ready) }, words::COARSE_POSES.to_owned()),
        (CellView { proposal: Some(proposal(Some(refusal.clone()))), ..armed() }, refusal.to_string()),
        (CellView { live: Some(no_arc), ..armed() }, reason),
        (CellView { live: None, ..armed() }, words::LIVE_NOTHING.to_owned()),
        (CellView { last_end: Some(never_still), ..armed() }, "0.400 mm".to_owned()),
        (CellView { is_practice: true, ..armed() }, words::PRACTICE_HINT.to_owned()),
        (CellView::default(), words::LIVE_OFF.to_owned()),
        (CellView::default(), words::NO_SEARCH.to_owned()),
    ] {
        let harness = Bench::new(view).harness();
        assert!(harness.query_all_by_label_contains(&sentence).next().is_some(), "{sentence}");
    }
}

#[test]
fn the_state_machine_is_told_to_those_who_do_not_see_it() {
    let found = SearchEnd::Found { peak_mm: 6.003, peak_std_mm: 0.021 };
    let name = |phase, state| words::phase_name(words::phase(phase), state);
    let harness = Bench::new(CellView { search: Some(Arc::new(search(None))), ..armed() }).harness();
    harness.get_by_label(&name(SearchPhase::Climb, words::PHASE_DONE));
    harness.get_by_label(&name(SearchPhase::Reverse, words::PHASE_AHEAD));
    harness.get_by_label(&name(SearchPhase::Pass, words::PHASE_NOW));
    let view = CellView { search: Some(Arc::new(search(Some(found.clone())))), ..armed() };
    let harness = Bench::new(view).harness();
    harness.get_by_label(&name(SearchPhase::Ended, words::PHASE_DONE));
    harness.get_by_label(&words::sentence(&found.to_string()));
    let lost = SearchEnd::ArcLost { travelled_mm: 3.0, reason: "no points".to_owned() };
    let view = CellView { search: Some(Arc::new(search(Some(lost)))), ..armed() };
    Bench::new(view).harness().get_by_label(&words::phase_name(words::NOT_FOUND, words::PHASE_DONE));
}

#[test]
fn without_a_session_one_is_begun_for_the_ball_in_the_field() {
    let bench = Bench { session: None, ..Bench::new(connected(Readiness::Ready)) };
    let asked = bench.asked_by(&words::next_button(words::NEW_SESSION));
    assert_eq!(asked, [Command::NewSession(Target::ball(15.0))]);
}

#[test]
fn an_address_is_entered_and_connected_to() {
    let mut harness = Bench::new(CellView::default()).harness();
    harness.get_by_label(words::ROBOT_HOST).focus();
    harness.run_steps(2);
    harness.get_by_label(words::ROBOT_HOST).type_text("192.168.0.10");
    harness.run_steps(2);
    harness.key_press(Key::Enter);
    harness.run_steps(2);
    let expected = cell(CellCommand::ConnectRobot(robot_setup(RobotKind::FanucMappdk)));
    assert_eq!(harness.state().commands, expected);
    harness.get_by_label(words::CONNECT_ROBOT).click();
    harness.run_steps(2);
    assert_eq!(harness.state().commands.len(), 2, "the button does the same");
}

#[test]
fn without_an_address_the_primary_button_asks_for_one() {
    let mut harness = Bench::new(CellView::default()).harness();
    harness.get_by_label(&words::next_button(words::CONNECT_ROBOT)).click();
    harness.run_steps(3);
    assert!(harness.get_by_label(words::ROBOT_HOST).is_focused());
    harness.get_by_label(words::ROBOT_HOST).type_text("192.168.0.10");
    harness.run_steps(2);
    harness.get_by_label(&words::next_button(words::CONNECT_ROBOT)).click();
    harness.run_steps(2);
    let expected = cell(CellCommand::ConnectRobot(robot_setup(RobotKind::FanucMappdk)));
    assert_eq!(harness.state().commands, expected);
}

#[test]
fn a_replay_ends_by_escape() {
    for is_over in [false, true] {
        let replay = Some(ReplayView { station_idx: 0, capture_idx: 2, is_over });
        let mut harness =
            Bench { session: Some(sample()), ..Bench::new(CellView { replay, ..CellView::default() }) }.harness();
        harness.get_by_label(&words::next_button(words::END_REPLAY));
        harness.key_press(Key::Escape);
        harness.run_steps(1);
        assert_eq!(harness.state().commands, cell(CellCommand::EndReplay));
    }
}

#[test]
fn a_mounting_of_another_robot_is_marked_until_somebody_says_that_it_fits() {
    let mut bench = Bench::new(armed());
    bench.memory.mounting_of = Some(robot_setup(RobotKind::UniversalRobots));
    let mut harness = bench.harness();
    harness.get_by_label(&words::next_button(words::KEEP_MOUNTING)).click();
    harness.run_steps(3);
    assert_eq!(harness.state().memory.mounting_of, Some(robot_setup(RobotKind::FanucMappdk)));
    harness.get_by_label(&words::next_button(words::START_RUN));
    assert_eq!(harness.state().commands, []);
}

#[test]
fn a_number_out_of_range_is_not_taken_and_the_field_says_why() {
    let mut harness = Bench::new(armed()).harness();
    harness.get_by_label(setting_words::SEARCH).click();
    harness.run_steps(4);
    for (text, is_told) in [("0", true), ("much", true), ("0.5", false)] {
        harness.get_by_role_and_label(egui::accesskit::Role::SpinButton, setting_words::STEP).focus();
        harness.run_steps(2);
        harness.event(egui::Event::Text(text.to_owned()));
        harness.run_steps(2);
        harness.key_press(Key::Enter);
        harness.run_steps(3);
        let start = format!("✖ {}: {text} is not taken, 0.75 mm stays", setting_words::STEP);
        assert_eq!(harness.query_by_label_contains(&start).is_some(), is_told, "{text}");
        assert_eq!(harness.state().commands.is_empty(), is_told, "{text}");
    }
    assert!(harness.query_by_label_contains("is not taken").is_none(), "the last one was");
}

#[test]
fn settings_are_set_as_a_whole() {
    let mut harness = Bench::new(connected(Readiness::Ready)).harness();
    harness.get_by_label(setting_words::LIMITS).click();
    harness.run_steps(4);
    harness.get_by_label(setting_words::WORKSPACE).click();
    harness.run_steps(1);
    let Some(Command::Cell(command)) = harness.state().commands.first() else { panic!("settings") };
    let CellCommand::SetSettings(settings) = command.as_ref() else { panic!("{command:?}") };
    let workspace = settings.limits.workspace.expect("switched on");
    assert!(workspace.min_mm[0] < 459.0 && 459.0 < workspace.max_mm[0], "around the robot: {workspace:?}");
    let rest =
        CellSettings { limits: handeye::device::MotionLimits { workspace: None, ..settings.limits }, ..**settings };
    assert_eq!(rest, CellSettings::default(), "nothing else has changed");
}

#[test]
fn the_mounting_is_asked_for_once_it_is_needed() {
    let unmounted = CellView { settings: CellSettings::default(), ..armed() };
    let mut harness = Bench { session: Some(sample()), ..Bench::new(unmounted) }.harness();
    assert!(harness.query_by_label(setting_words::USE_MOUNTING).is_none(), "folded away");
    harness.get_by_label(&words::next_button(words::SET_MOUNTING)).click();
    harness.run_steps(4);
    harness.get_by_label(setting_words::USE_MOUNTING).click();
    harness.run_steps(2);
    assert_eq!(harness.state().commands, [], "nothing is given that was not typed");
    for (name, text) in [("x", "20"), ("y", "-10"), ("z", "250")] {
        let name = setting_words::mounting_number(name);
        harness.get_by_role_and_label(egui::accesskit::Role::TextInput, &name).focus();
        harness.run_steps(2);
        harness.event(egui::Event::Text(text.to_owned()));
        harness.run_steps(2);
    }
    harness.get_by_label(setting_words::USE_MOUNTING).click();
    harness.run_steps(1);
    let Some(Command::Cell(command)) = harness.state().commands.first() else { panic!("settings") };
    let CellCommand::SetSettings(settings) = command.as_ref() else { panic!("{command:?}") };
    let typed = RoughMounting { translation_mm: [20.0, -10.0, 250.0], quaternion_wxyz: [1.0, 0.0, 0.0, 0.0] };
    assert_eq!(settings.mounting, Some(typed));
}

#[test]
fn a_number_is_taken_when_it_is_entered() {
    let mut harness = Bench::new(armed()).harness();
    harness.get_by_label(setting_words::SEARCH).click();
    harness.run_steps(4);
    harness.get_by_role_and_label(egui::accesskit::Role::SpinButton, setting_words::MAX_TRAVEL).focus();
    harness.run_steps(2);
    // A travel of 1 mm would be less than two steps.
    for digit in ["1", "2"] {
        harness.event(egui::Event::Text(digit.to_owned()));
        harness.run_steps(2);
        assert_eq!(harness.state().commands, [], "still being typed");
    }
    harness.key_press(Key::Enter);
    harness.run_steps(1);
    let Some(Command::Cell(command)) = harness.state().commands.first() else { panic!("settings") };
    let CellCommand::SetSettings(settings) = command.as_ref() else { panic!("{command:?}") };
    assert!((settings.search.max_travel_mm - 12.0).abs() < 1e-9, "{settings:?}");
}

#[test]
fn every_state_fits_every_size_and_asks_for_nothing_by_itself() {
    let searching = CellView {
        search: Some(Arc::new(search(None))),
        activity: Activity::Settling,
        run: Some(RUN),
        is_practice: true,
        ..armed()
    };
    let proposed = CellView { proposal: Some(proposal(None)), ..armed() };
    for view in [CellView::default(), connected(Readiness::Unknown), searching, proposed] {
        for size in [[852.0, 660.0], [1244.0, 792.0], [1800.0, 1100.0]] {
            let harness = Bench::new(view.clone()).harness_of_size(size);
            assert!(harness.state().commands.is_empty() && harness.state().actions.is_empty());
            // Stop is in sight whatever else is.
            let stop = harness.get_by_label(words::STOP).rect();
            assert!(stop.max.x <= size[0] && stop.max.y <= 100.0, "{stop:?}");
        }
    }
}

/// A plate's surface over its table: a step.
fn live_of_step() -> LiveProfile {
    let x_mm: Vec<f64> = (-200..=200_i16).map(|idx| f64::from(idx) * 0.15).collect();
    let noisy = |(idx, x): (usize, &f64)| {
        let z_mm = if *x > 4.0 { 0.05 * x } else { 10.0 + 0.05 * x };
        // The camera does not see the table right behind the step.
        let is_in_shadow = *x <= 4.0 && *x > 1.0;
        (!is_in_shadow).then(|| z_mm + 0.004 * f64::from(u8::try_from(idx * 37 % 11).unwrap_or(0)))
    };
    let z_mm: Vec<_> = x_mm.iter().enumerate().map(noisy).collect();
    let profile = Arc::new(Profile::new(x_mm, &z_mm).expect("valid"));
    let found = sought(&Target::RightAnglePlate, None).expect("a plate has edges").find(&profile);
    assert!(found.is_ok(), "{found:?}");
    let reading = ProfileReading { profile, trigger_count: 7, received_at: Instant::now() };
    LiveProfile { reading, found, rate_hz: 30.0 }
}

/// A session with so many captures on each edge, p first.
fn plate_session(num_on_edges: [usize; 2]) -> Session {
    let live = live_of_step();
    let station = |edge: Edge, idx: usize| Station {
        label: format!("{}{}", edge.symbol(), idx + 1),
        enabled: true,
        side: SideChoice::Auto,
        edge: Some(edge),
        captures: vec![Capture {
            base_from_flange: Transform::identity(),
            written_angles: None,
            reading: Reading::Profile(Arc::clone(&live.reading.profile)),
            step_mm: None,
            unknown: UnknownFields::new(),
        }],
        unknown: UnknownFields::new(),
    };
    let [p, q] = num_on_edges;
    let stations = (0..p).map(|idx| station(Edge::P, idx)).chain((0..q).map(|idx| station(Edge::Q, idx)));
    Session { stations: stations.collect(), target: Target::RightAnglePlate, ..sample() }
}

fn at_plate(num_on_edges: [usize; 2], view: CellView) -> Bench {
    let live = view.live.is_some().then(live_of_step);
    Bench { session: Some(plate_session(num_on_edges)), ..Bench::new(CellView { live, ..view }) }
}

#[test]
fn a_plate_is_captured_by_its_edges() {
    // The edge is chosen by a click as well as by its key.
    let chosen = |commands: &[Command]| match commands {
        [Command::Cell(command)] => match command.as_ref() {
            CellCommand::SetSettings(settings) => Some(settings.edge),
            _ => None,
        },
        _ => None,
    };
    let commands = at_plate([2, 0], armed()).asked_by(&words_of_edges::choose("q", 0));
    assert_eq!(chosen(&commands), Some(Edge::Q), "{commands:?}");
    let mut harness = at_plate([2, 0], armed()).harness();
    harness.key_press(Key::Q);
    harness.run_steps(1);
    assert_eq!(chosen(&harness.state().commands), Some(Edge::Q));

    let name = words::capture_name(&Target::RightAnglePlate);
    let commands = at_plate([2, 1], armed()).asked_by(name);
    assert_eq!(commands, [Command::Cell(Box::new(CellCommand::CaptureStation))]);
    let practice = CellView { is_practice: true, ..armed() };
    let commands = at_plate([1, 0], practice).asked_by(words_of_edges::jog_to(Edge::Q));
    assert_eq!(commands, [Command::Cell(Box::new(CellCommand::JogToEdge(Edge::Q)))]);

    // What only a ball has is not offered, and what is still needed is told.
    let harness = at_plate([4, 6], armed()).harness();
    for absent in [words::FIND, words::LARGEST_ARC, words::SEARCH] {
        assert!(harness.query_by_label(absent).is_none(), "{absent}");
    }
    harness.get_by_label(&words_of_edges::needed_on_edges([2, 0]));
    harness.get_by_label(&words_of_edges::choose("p", 4));
}

#[test]
fn an_edge_that_is_not_seen_is_told_before_it_is_captured() {
    let refusal = sought(&Target::RightAnglePlate, None).expect("edges").find(&live(13.5).reading.profile);
    let unseen = LiveProfile { found: Err(refusal.expect_err("a ball has no edge")), ..live(13.5) };
    let mut bench = at_plate([2, 2], armed());
    bench.cell.live = Some(unseen);
    let harness = bench.harness();
    assert!(harness.query_by_label_contains(words_of_edges::NOT_SEEN).is_some());
}

#[test]
fn a_tip_is_searched() {
    let bench = Bench {
        session: Some(Session { stations: Vec::new(), target: Target::Point, ..sample() }),
        ..Bench::new(armed())
    };
    let commands = bench.asked_by(words_of_edges::FIND);
    assert_eq!(commands, [Command::Cell(Box::new(CellCommand::FindTip))]);
}

#[test]
fn a_plate_looks_as_it_did() {
    let bench = at_plate([4, 6], CellView { is_practice: true, ..armed() });
    pictured_bench(bench, [1268.0, 792.0], egui::Theme::Light).snapshot("capture_plate");
}

/// The window's own software renderer, so that pictures need no graphics driver and are the same on every machine.
#[derive(Default)]
struct Software(ui::software_renderer::SoftwareRenderer);

impl egui_kittest::TestRenderer for Software {
    fn handle_delta(&mut self, delta: &mut egui::TexturesDelta) {
        self.0.update_textures(delta);
    }

    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the size of a small picture")]
    fn render(&mut self, ctx: &egui::Context, output: &egui::FullOutput) -> Result<image::RgbaImage, String> {
        let scale = output.pixels_per_point;
        let size = ctx.content_rect().size() * scale;
        let primitives = ctx.tessellate(output.shapes.clone(), scale);
        Ok(self.0.paint(&primitives, scale, [size.x.round() as u32, size.y.round() as u32]))
    }
}

fn pictured(view: CellView, size: [f32; 2], theme: egui::Theme) -> Harness<'static, Bench> {
    pictured_bench(Bench::new(view), size, theme)
}

fn pictured_bench(bench: Bench, size: [f32; 2], theme: egui::Theme) -> Harness<'static, Bench> {
    let mut harness = Harness::builder()
        .with_size(size)
        .renderer(Software::default())
        .with_theme(theme)
        .with_context_setup(ui::theme::install)
        .build_ui_state(Bench::ui, bench);
    harness.run_steps(6);
    harness
}

#[test]
fn the_search_looks_as_it_did() {
    let view =
        CellView { search: Some(Arc::new(search(None))), activity: Activity::Settling, run: Some(RUN), ..armed() };
    pictured(view, [1268.0, 792.0], egui::Theme::Light).snapshot("capture_search");
}

#[test]
fn the_narrow_panel_looks_as_it_did() {
    let view = CellView { proposal: Some(proposal(None)), is_practice: true, ..armed() };
    pictured(view, [852.0, 660.0], egui::Theme::Dark).snapshot("capture_narrow");
}

/// The whole window.
fn window() -> Harness<'static, Window> {
    let mut harness = Harness::builder()
        .with_size([1440.0, 900.0])
        .with_os(egui::os::OperatingSystem::Nix)
        .build_eframe(|creation| Window::new(creation, Start::default()));
    harness.run_steps(4);
    harness
}

/// Runs until something is so; how long that takes is the machine's affair.
fn wait_until(harness: &mut Harness<'static, Window>, what: &str, is_so: impl Fn(&Window) -> bool) {
    const PATIENCE: Duration = Duration::from_mins(2);
    let start = Instant::now();
    while !is_so(harness.state()) {
        assert!(start.elapsed() < PATIENCE, "{what}: {:?}", harness.state().shell().workbench().notices());
        harness.step();
        std::thread::sleep(Duration::from_millis(2));
    }
    harness.run_steps(2);
}

fn view(window: &Window) -> &CellView {
    window.shell().workbench().cell()
}

fn is_connected(window: &Window) -> bool {
    let cell = view(window);
    cell.robot.state == LinkState::Ready && cell.live.as_ref().is_some_and(|live| live.found.is_ok())
}

fn click(harness: &mut Harness<'static, Window>, name: &str) {
    harness.get_by_label(name).click();
    harness.run_steps(2);
}

/// A window with a quick simulated cell, connected and in sight.
fn practising() -> Harness<'static, Window> {
    let mut harness = window();
    let options = SimOptions { time_scale: 20.0, ..SimOptions::default() };
    let shell = harness.state_mut().shell_mut();
    shell.workbench_mut().practise_with(&options);
    let mut settings = shell.workbench().cell().settings;
    settings.settle.settle_ms = 20;
    shell.workbench_mut().apply(Command::Cell(Box::new(CellCommand::SetSettings(Box::new(settings)))));
    shell.go_to(Step::Capture);
    wait_until(&mut harness, "connected", is_connected);
    harness
}

#[test]
fn practice_begins_with_one_click_and_leaves_the_settings_alone() {
    let mut harness = window();
    click(&mut harness, words::PRACTISE);
    assert_eq!(harness.state().shell().step(), Step::Capture);
    wait_until(&mut harness, "connected", is_connected);
    assert!(view(harness.state()).is_practice && view(harness.state()).settings.mounting.is_some());
    click(&mut harness, words::END_PRACTICE);
    wait_until(&mut harness, "ended", |window| !view(window).is_practice);
    assert_eq!(view(harness.state()).settings.mounting, None, "the mounting was the simulated cell's");
    assert_eq!(harness.state().shell().persisted().cell.settings, CellSettings::default());
    assert!(harness.state().shell().workbench().document().is_some(), "its session stays");
}

#[test]
fn three_more_clicks_lead_to_a_compared_result() {
    let mut harness = practising();
    harness.get_by_role_and_label(egui::accesskit::Role::SpinButton, words::RUN_STATIONS).focus();
    harness.run_steps(2);
    harness.event(egui::Event::Text("5".to_owned()));
    harness.run_steps(1);
    harness.key_press(Key::Enter);
    harness.run_steps(3);
    click(&mut harness, &words::next_button(words::ARM));
    click(&mut harness, &words::next_button(words::START_RUN));
    wait_until(&mut harness, "the run is over", |window| {
        let run = view(window).run;
        run.is_some_and(|run| run.num_done >= 5)
            && !view(window).is_busy()
            && window.shell().workbench().results_are_current()
    });
    click(&mut harness, &words::next_button(words::COMPARE));
    assert_eq!(harness.state().shell().step(), Step::Compare);
    let results = harness.state().shell().workbench().results().expect("solved");
    assert!(results.methods.iter().any(|method| method.outcome.is_ok()));
}

#[test]
fn space_and_escape_stop_the_robot_from_every_step() {
    let mut harness = practising();
    for (step, key) in [(Step::Compare, Key::Space), (Step::Capture, Key::Escape), (Step::Poses, Key::Escape)] {
        harness.state_mut().shell_mut().go_to(Step::Capture);
        harness.run_steps(2);
        if !view(harness.state()).is_armed {
            click(&mut harness, words::ARM);
        }
        click(&mut harness, words::FIND);
        assert!(view(harness.state()).is_busy());
        harness.state_mut().shell_mut().go_to(step);
        harness.run_steps(2);
        let elsewhere = harness.query_by_label(words::STOP_ROBOT).is_some();
        assert_eq!(elsewhere, step != Step::Capture, "a red button in every other step");
        harness.key_press(key);
        harness.run_steps(2);
        let cell = view(harness.state());
        assert!(!cell.is_busy() || cell.activity == Activity::Stopping, "{key:?} in {step:?}");
        wait_until(&mut harness, "stopped", |window| !view(window).is_busy());
        assert!(matches!(view(harness.state()).last_end, Some(RoutineEnd::Stopped { .. })));
    }
}

#[test]
fn the_stop_stands_above_every_question() {
    let mut harness = practising();
    let workbench = harness.state_mut().shell_mut().workbench_mut();
    // Something to be saved, and a search that is at it for as long as the question needs.
    let edit = session::Edit::Setup(session::SetupField::Notes("unsaved".to_owned()));
    workbench.apply(Command::Edit { edit, gesture: None });
    let mut settings = workbench.cell().settings;
    settings.settle.settle_ms = 5_000;
    workbench.apply(Command::Cell(Box::new(CellCommand::SetSettings(Box::new(settings)))));
    harness.run_steps(2);
    click(&mut harness, words::ARM);
    click(&mut harness, words::FIND);
    harness.state_mut().shell_mut().request(Command::CloseDocument);
    harness.run_steps(3);
    harness.get_by_label(words::STILL_AT_WORK);
    harness.get_by_label(shell_words::DISCARD);
    click(&mut harness, words::STOP_ROBOT);
    wait_until(&mut harness, "stopped", |window| !view(window).is_busy());
    assert!(matches!(view(harness.state()).last_end, Some(RoutineEnd::Stopped { .. })));
    harness.get_by_label(shell_words::DISCARD);
    assert!(harness.query_by_label(words::STOP_ROBOT).is_none(), "nothing is left to be stopped");
}

#[test]
fn the_capture_step_needs_no_session() {
    let mut harness = window();
    click(&mut harness, words::CONNECT_CELL);
    assert_eq!(harness.state().shell().step(), Step::Capture);
    assert!(harness.query_by_label(shell_words::EMPTY_TITLE).is_none());
    let shell = harness.state_mut().shell_mut();
    shell.request(Command::NewSession(Target::ball(12.5)));
    assert_eq!(shell.step(), Step::Capture, "a session begun here is for what is captured here");
}
