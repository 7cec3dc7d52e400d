//! What the panel decides and draws: the one next action, refusals, lamps, boxes, curve.

use std::sync::Arc;
use std::time::{Duration, Instant};

use super::*;
use crate::app::cell::Activity;
use crate::app::cell::{LinkView, LiveProfile, Proposal, ReplayView, RoughMounting, RunView};
use crate::device::search::CurveEstimate;
use crate::device::{
    DeviceError, Endpoint, ProfileReading, RobotKind, RobotSetup, RoutineEnd, SearchEnd, SensorKind, SensorSetup,
    WorkspaceBox,
};
use crate::fit::{ArcOptions, ArcRefusal, Found, extract_arc};
use crate::geometry::{PoseConvention, Profile, Vec3};
use crate::plan::PlannedStation;
use crate::session::{self, samples};
use crate::ui::capture::memory::CellMemory;
use crate::ui::capture::next::{Deed, next};

fn report(readiness: Readiness) -> RobotReport {
    RobotReport {
        base_from_flange: Transform::from_parts(
            Vec3::new(560.0, -110.25, -139.394),
            nalgebra::UnitQuaternion::identity(),
        ),
        joints_deg: Vec::new(),
        is_moving: Some(false),
        readiness,
        tool: "tool 1".to_owned(),
        resolution_mm: 0.001,
        received_at: Instant::now(),
    }
}

/// A ball's section and its profile.
fn live(has_arc: bool) -> LiveProfile {
    let x_mm: Vec<f64> = (-60..=60_i16).map(|idx| f64::from(idx) * 0.1).collect();
    let z_mm: Vec<_> = x_mm.iter().map(|x| Some(80.0 - (144.0 - x * x).sqrt())).collect();
    let profile = Arc::new(Profile::new(x_mm, &z_mm).expect("valid"));
    let arc = extract_arc(&profile, &ArcOptions { ball_radius_mm: 15.0, profile_std_mm: None }).expect("an arc");
    let refusal = ArcRefusal::TooFewPoints { found: 2, needed: 20 };
    let found = if has_arc { Ok(Found::Arc(Arc::new(arc))) } else { Err(refusal.into()) };
    let reading = ProfileReading { profile, trigger_count: 1, received_at: Instant::now() };
    LiveProfile { reading, found, rate_hz: 30.0 }
}

fn connected(readiness: Readiness) -> CellView {
    let robot = LinkView { setup: None, state: LinkState::Ready, latest: Some(report(readiness)) };
    let sensor = LinkView { setup: None, state: LinkState::Ready, latest: None };
    CellView { robot, sensor, live: Some(live(true)), ..CellView::default() }
}

fn mounted(mut cell: CellView) -> CellView {
    cell.settings.mounting = Some(RoughMounting { translation_mm: [0.0; 3], quaternion_wxyz: [1.0, 0.0, 0.0, 0.0] });
    cell
}

fn armed(cell: CellView) -> CellView {
    CellView { is_armed: true, ..cell }
}

fn sample() -> Session {
    let sample = samples::ALL.iter().find(|sample| sample.file_name == "clean-sweeps.json").expect("a sample");
    session::parse(sample.json.as_bytes(), sample.file_name).expect("a session")
}

fn empty_session() -> Session {
    Session { stations: Vec::new(), ..sample() }
}

fn with_addresses() -> CellMemory {
    let mut memory = CellMemory::default();
    memory.robot().endpoint.host = "robot".to_owned();
    memory.sensor().endpoint.host = "profiler".to_owned();
    memory
}

fn proposal(refusal: Option<crate::device::MotionRefusal>) -> Proposal {
    let station = PlannedStation {
        base_from_flange: Transform::identity(),
        edge: None,
        tilt_deg: 20.0,
        azimuth_deg: 90.0,
        spin_deg: 0.0,
        workspace_point_std_mm: None,
    };
    Proposal { station, reason: "tells most".to_owned(), distance_mm: 80.0, turn_deg: 20.0, refusal }
}

const RUN: RunView = RunView { num_done: 2, num_failed: 0, num_stations: 8, is_paused: false, is_asking: false };

/// What the primary button does at a moment.
fn deed(cell: &CellView, session: Option<&Session>, memory: &CellMemory) -> Option<Deed> {
    next(&View { cell, session, has_solution: false, outlook: None, has_other_mounting: false, results: None }, memory)
        .button
        .map(|(_, deed)| deed)
}

fn command(command: impl Into<Option<CellCommand>>) -> Option<Deed> {
    command.into().map(Deed::Cell)
}

#[test]
fn from_nothing_to_a_compared_result_there_is_one_way() {
    let (nothing, known) = (CellMemory::default(), with_addresses());
    let empty = empty_session();
    let off = CellView::default();
    assert_eq!(deed(&off, None, &nothing), Some(Deed::Enter(words::ROBOT_HOST)));
    let robot = known.robot_to_connect().expect("given");
    assert_eq!(deed(&off, None, &known), command(CellCommand::ConnectRobot(robot)));
    let robot_only = CellView { sensor: LinkView::default(), ..connected(Readiness::Ready) };
    let sensor = known.sensor_to_connect().expect("given");
    assert_eq!(deed(&robot_only, None, &known), command(CellCommand::ConnectSensor(sensor)));
    let ready = connected(Readiness::Ready);
    assert_eq!(deed(&ready, None, &known), Some(Deed::NewSession));
    assert_eq!(deed(&ready, Some(&empty), &known), command(CellCommand::Arm(true)));
    assert_eq!(deed(&armed(ready.clone()), Some(&empty), &known), command(CellCommand::FindLargestArc));
    assert_eq!(deed(&armed(ready.clone()), Some(&sample()), &known), Some(Deed::ShowMounting));
    let start = CellCommand::StartRun { num_stations: 8 };
    assert_eq!(deed(&armed(mounted(ready.clone())), Some(&empty), &known), command(start));
    let given_up = CellView { run: Some(RunView { num_failed: 3, ..RUN }), ..armed(mounted(ready.clone())) };
    assert_eq!(deed(&given_up, Some(&empty), &known), command(CellCommand::StartRun { num_stations: 8 }));
    let running = CellView { run: Some(RUN), activity: Activity::Moving, ..armed(mounted(ready.clone())) };
    assert_eq!(deed(&running, Some(&empty), &known), None);
    let over = CellView { run: Some(RunView { num_done: 8, num_failed: 1, ..RUN }), ..armed(mounted(ready)) };
    assert_eq!(deed(&over, Some(&sample()), &known), Some(Deed::Compare));
}

#[test]
fn what_only_a_person_can_do_has_no_button_but_words() {
    let memory = with_addresses();
    let empty = empty_session();
    let not_remote = Readiness::NotReady { found: "T1 mode".to_owned(), remedy: "turn the key to AUTO" };
    let no_arc = CellView { live: Some(live(false)), ..connected(Readiness::Ready) };
    let no_profile = CellView { live: None, ..connected(Readiness::Ready) };
    for (cell, part) in [
        (connected(not_remote), "Turn the key to AUTO"),
        (no_arc, words::now::jog(&Target::ball(15.0))),
        (no_profile, words::now::PROFILE),
    ] {
        let next = next(
            &View {
                cell: &cell,
                session: Some(&empty),
                has_solution: false,
                outlook: None,
                has_other_mounting: false,
                results: None,
            },
            &memory,
        );
        assert_eq!(next.button, None, "{}", next.sentence);
        assert!(next.sentence.contains(part), "{}", next.sentence);
    }
}

#[test]
fn a_robot_that_only_reads_is_jogged_and_captured() {
    let cell = connected(Readiness::ReadOnly);
    let empty = empty_session();
    assert_eq!(deed(&cell, Some(&empty), &with_addresses()), command(CellCommand::CaptureStation));
    let view = View {
        cell: &cell,
        session: Some(&empty),
        has_solution: false,
        outlook: None,
        has_other_mounting: false,
        results: None,
    };
    assert_eq!(refusal(&view, &CellCommand::CaptureStation), None);
    assert_eq!(refusal(&view, &CellCommand::Arm(true)), Some(words::ROBOT_ONLY_READS));
    assert_eq!(refusal(&view, &CellCommand::FindLargestArc), Some(words::ROBOT_ONLY_READS));
}

#[test]
fn a_proposal_is_accepted_only_where_it_can_be_gone_to() {
    let (memory, empty) = (with_addresses(), empty_session());
    let cell = |refusal, is_armed| CellView {
        proposal: Some(proposal(refusal)),
        is_armed,
        ..mounted(connected(Readiness::Ready))
    };
    let too_far = crate::device::MotionRefusal::TooFar { found_mm: 500.0, max_mm: 400.0 };
    assert_eq!(deed(&cell(None, false), Some(&empty), &memory), command(CellCommand::Arm(true)));
    assert_eq!(deed(&cell(None, true), Some(&empty), &memory), command(CellCommand::AcceptProposal));
    assert_eq!(deed(&cell(Some(too_far), true), Some(&empty), &memory), command(CellCommand::SkipProposal));
    let asking = CellView { run: Some(RunView { is_asking: true, ..RUN }), ..cell(None, true) };
    assert_eq!(deed(&asking, Some(&empty), &memory), command(CellCommand::AcceptProposal));
    let view = View {
        cell: &asking,
        session: Some(&empty),
        has_solution: false,
        outlook: None,
        has_other_mounting: false,
        results: None,
    };
    assert_eq!(refusal(&view, &CellCommand::AcceptProposal), None, "the run waits for it");
    assert_eq!(refusal(&view, &CellCommand::FindLargestArc), Some(words::ROUTINE_RUNS));
    assert!(is_running(&asking), "stop ends a run that asks");
}

#[test]
fn a_replay_goes_on_or_is_ended() {
    let session = sample();
    let replay = ReplayView { station_idx: 1, capture_idx: 4, is_over: false };
    let cell = CellView { replay: Some(replay), activity: Activity::Thinking, ..CellView::default() };
    assert_eq!(deed(&cell, Some(&session), &CellMemory::default()), command(CellCommand::EndReplay));
    let cell = CellView { replay: Some(ReplayView { is_over: true, ..replay }), ..CellView::default() };
    assert_eq!(deed(&cell, Some(&session), &CellMemory::default()), command(CellCommand::EndReplay));
    let view = View {
        cell: &CellView::default(),
        session: Some(&session),
        has_solution: false,
        outlook: None,
        has_other_mounting: false,
        results: None,
    };
    assert_eq!(refusal(&view, &CellCommand::StartReplay), None);
    let empty = empty_session();
    let view = View { session: Some(&empty), ..view };
    assert_eq!(refusal(&view, &CellCommand::StartReplay), Some(words::NO_PROFILES));
}

#[test]
fn a_broken_link_is_tried_again_at_once_and_told_of_in_one_place() {
    let error = DeviceError::Stopped { device: "Robot" };
    let failed = LinkState::Failed { error: error.clone(), retry_in: Some(Duration::from_secs(4)) };
    let ready = connected(Readiness::Ready);
    let setup = with_addresses().robot_to_connect();
    let robot = LinkView { state: failed.clone(), setup: setup.clone(), ..LinkView::default() };
    let sensor_setup = with_addresses().sensor_to_connect();
    let sensor = LinkView { state: failed, setup: sensor_setup.clone(), ..LinkView::default() };
    for (cell, expected) in [
        (CellView { robot: robot.clone(), ..ready.clone() }, setup.map(CellCommand::ConnectRobot)),
        (CellView { sensor, ..ready.clone() }, sensor_setup.map(CellCommand::ConnectSensor)),
        (CellView { robot, is_practice: true, ..ready }, None),
    ] {
        let view = View {
            cell: &cell,
            session: None,
            has_solution: false,
            outlook: None,
            has_other_mounting: false,
            results: None,
        };
        let next = next(&view, &with_addresses());
        assert_eq!(next.button.map(|(_, deed)| deed), expected.map(Deed::Cell));
        assert!(!next.sentence.contains(&error.to_string()), "{}", next.sentence);
    }
}

#[test]
fn a_mounting_of_another_robot_is_asked_about_before_anything_goes_by_it() {
    let mut memory = with_addresses();
    let robot = |kind, host: &str| RobotSetup { kind, endpoint: Endpoint { host: host.to_owned(), port: 1 } };
    assert!(!memory.has_mounting_of_other(&robot(RobotKind::Bridge, "a")), "nobody knows whose it is");
    memory.mounting_of = Some(robot(RobotKind::FanucMappdk, "a"));
    for (other, is_other) in [
        (robot(RobotKind::FanucMappdk, "a "), false),
        (robot(RobotKind::FanucPage, "a"), false),
        (robot(RobotKind::FanucMappdk, "b"), true),
        (robot(RobotKind::UniversalRobots, "a"), true),
    ] {
        assert_eq!(memory.has_mounting_of_other(&other), is_other, "{other:?}");
    }
    let (cell, empty) = (armed(mounted(connected(Readiness::Ready))), empty_session());
    let view = View {
        cell: &cell,
        session: Some(&empty),
        has_solution: false,
        outlook: None,
        has_other_mounting: true,
        results: None,
    };
    assert!(!view.knows_mounting());
    let next = next(&view, &memory);
    assert_eq!(next.button.map(|(_, deed)| deed), Some(Deed::KeepMounting));
    for asked in [CellCommand::FindLargestArc, CellCommand::StartRun { num_stations: 3 }, CellCommand::ProposeStation] {
        assert_eq!(refusal(&view, &asked), Some(words::OTHER_MOUNTING), "{asked:?}");
    }
    assert_eq!(refusal(&View { has_solution: true, ..view }, &CellCommand::ProposeStation), None);
}

#[test]
fn the_switch_is_remembered_after_a_run() {
    let empty = empty_session();
    let ready = armed(mounted(connected(Readiness::Ready)));
    let over = RunView { num_done: 8, ..RUN };
    for (run, is_armed, reminds) in
        [(Some(RUN), true, true), (Some(over), true, true), (Some(over), false, false), (None, true, false)]
    {
        let cell = CellView { is_armed, run, ..ready.clone() };
        let view = View {
            cell: &cell,
            session: Some(&empty),
            has_solution: false,
            outlook: None,
            has_other_mounting: false,
            results: None,
        };
        let next = next(&view, &with_addresses());
        let disarm = Deed::Cell(CellCommand::Arm(false));
        assert_eq!(next.other.is_some_and(|(_, deed)| deed == disarm), reminds, "{run:?}");
        assert_eq!(next.sentence.contains("armed."), reminds, "{}", next.sentence);
    }
}

#[test]
fn the_outlook_counts_the_planned_stations_up_to_good() {
    let station = |std_mm| PlannedStation { workspace_point_std_mm: Some(std_mm), ..proposal(None).station };
    let plan = |now_mm, then: &[f64]| Plan {
        workspace_point_std_mm: Some(now_mm),
        stations: then.iter().copied().map(station).collect(),
    };
    assert_eq!(Outlook::new(&plan(0.09, &[0.08])), None, "good already");
    let outlook = Outlook::new(&plan(0.13, &[0.12, 0.11, 0.1, 0.09])).expect("not good yet");
    assert_eq!(outlook.num_to_good, Some(3));
    // Four stations bring 25 per mm² to 50, so twelve bring them to the hundred that make 0.1 mm.
    let beyond = |then: &[f64]| Outlook::new(&plan(0.2, then)).expect("not good yet").num_to_good;
    assert_eq!(beyond(&[0.19, 0.17, 0.155, f64::sqrt(0.02)]), Some(12));
    for hopeless in [&[][..], &[0.2], &[0.21], &[0.1999]] {
        assert_eq!(beyond(hopeless), None, "{hopeless:?}");
    }
}

#[test]
fn wrong_settings_are_told_and_keep_the_robot_still() {
    let usual = CellSettings::default();
    assert!(problems(&usual, Some(15.0), None).is_empty());
    let mut wrong = usual;
    wrong.search.direction = [0.0; 3];
    wrong.search.step_mm = 20.0;
    wrong.search.max_travel_mm = 30.0;
    wrong.limits.max_move_mm = 5.0;
    wrong.limits.max_speed_mm_s = 5.0;
    wrong.limits.max_rotation_speed_deg_s = MOST_ROTATION_SPEED_DEG_S + 1.0;
    wrong.limits.workspace = Some(WorkspaceBox { min_mm: [0.0; 3], max_mm: [0.0, 1.0, 1.0] });
    let expected = [
        problem::NO_DIRECTION,
        problem::LITTLE_TRAVEL,
        problem::COARSE_IS_FINER,
        problem::STEP_BEYOND_BALL,
        problem::STEP_TOO_LONG,
        problem::SEARCH_TOO_FAST,
        problem::TRANSIT_TOO_FAST,
        problem::TURNS_TOO_FAST,
        problem::EMPTY_BOX,
    ];
    let told = |settings, robot| -> Vec<_> {
        problems(settings, Some(15.0), robot).into_iter().map(|problem| problem.sentence).collect()
    };
    assert_eq!(told(&wrong, None), expected);
    let mut boxed = usual;
    boxed.limits.workspace = Some(WorkspaceBox { min_mm: [0.0; 3], max_mm: [100.0; 3] });
    assert_eq!(told(&boxed, Some(&report(Readiness::Ready))), [problem::OUTSIDE_BOX]);
    let cell = CellView { settings: boxed, ..armed(connected(Readiness::Ready)) };
    let empty = empty_session();
    let view = View {
        cell: &cell,
        session: Some(&empty),
        has_solution: false,
        outlook: None,
        has_other_mounting: false,
        results: None,
    };
    assert_eq!(refusal(&view, &CellCommand::FindLargestArc), Some(words::SETTINGS_WRONG));
    assert_eq!(next(&view, &with_addresses()).button, None);
}

#[test]
fn a_robot_that_did_not_say_that_it_stands_can_be_stopped_again() {
    let stopped = |robot_stopped| Some(RoutineEnd::Stopped { robot_stopped });
    for (last_end, readiness, may_be) in [
        (None, Readiness::Ready, false),
        (Some(RoutineEnd::Done), Readiness::Ready, false),
        (stopped(Some(true)), Readiness::Ready, false),
        (stopped(None), Readiness::Ready, true),
        (stopped(Some(false)), Readiness::Unknown, true),
        // It was never moved from here.
        (stopped(Some(false)), Readiness::ReadOnly, false),
    ] {
        let mut cell = CellView { last_end: last_end.clone(), ..connected(readiness) };
        assert_eq!(may_be_moving(&cell), may_be, "{last_end:?}");
        assert!(!is_running(&cell), "nothing else waits for that");
        cell.robot.state = LinkState::Off;
        assert!(!may_be_moving(&cell), "nobody is there to be stopped");
    }
}

#[test]
fn the_boxes_light_up_as_the_search_goes() {
    use BoxState::{Ahead, Done, Found, GaveUp, Now};
    let report = |phase, sign, end| SearchReport { phase, sign, end, ..SearchReport::default() };
    assert_eq!(boxes(None), [Ahead; 6]);
    assert_eq!(boxes(Some(&report(SearchPhase::First, 1.0, None))), [Now, Ahead, Ahead, Ahead, Ahead, Ahead]);
    assert_eq!(boxes(Some(&report(SearchPhase::Reverse, -1.0, None))), [Done, Done, Now, Ahead, Ahead, Ahead]);
    assert_eq!(boxes(Some(&report(SearchPhase::Climb, 1.0, None))), [Done, Done, Ahead, Now, Ahead, Ahead]);
    assert_eq!(boxes(Some(&report(SearchPhase::Pass, -1.0, None))), [Done, Done, Done, Done, Now, Ahead]);
    let found = SearchEnd::Found { peak_mm: 5.6, peak_std_mm: 0.01 };
    let over = boxes(Some(&report(SearchPhase::Ended, 1.0, Some(found))));
    assert_eq!(over, [Done, Done, Ahead, Done, Done, Found]);
    let nothing = SearchEnd::NoArcAtStart { reason: "no points".to_owned() };
    let over = boxes(Some(&report(SearchPhase::Ended, 1.0, Some(nothing))));
    assert_eq!(over, [Done, Ahead, Ahead, Ahead, Ahead, GaveUp]);
}

#[test]
fn the_curve_of_a_search_follows_its_factor() {
    let seen = |travelled_mm: f64, radius_mm: Option<f64>| SearchPoint {
        commanded_mm: travelled_mm,
        travelled_mm,
        radius_and_std_mm: radius_mm.map(|radius| [radius, 0.004]),
    };
    let search = SearchReport {
        points: vec![seen(0.0, Some(14.0)), seen(0.75, None), seen(1.5, Some(14.5))],
        curve: Some(CurveEstimate { peak_mm: 4.0, peak_std_mm: 0.1, curvature: 0.9 }),
        published_stop_idx: Some(2),
        ..SearchReport::default()
    };
    let curve = search_curve(&search, 15.0);
    assert_eq!(curve.points.iter().map(|point| point.capture_idx).collect::<Vec<_>>(), [0, 2]);
    assert_eq!(curve.published_stop_mm, Some(1.5));
    let expected = 14.5 - (225.0_f64 - 0.9 * 2.5 * 2.5).sqrt();
    assert!((curve.points[1].residual_mm - expected).abs() < 1e-12);
}

#[test]
fn a_pose_has_no_more_digits_than_the_robot() {
    let convention = PoseConvention::by_id("fanuc-wpr").expect("known");
    let rotation = convention.rotation_from_angles_deg([179.9, -0.06, 30.5]);
    let pose = Transform::from_parts(Vec3::new(560.0, -110.25, -139.394), rotation);
    let of = |resolution_mm| {
        let rows = pose_rows(&PoseNotation::of(convention), &pose, resolution_mm);
        rows.into_iter().map(|(name, value)| format!("{name} {value}")).collect::<Vec<_>>()
    };
    assert_eq!(of(0.001)[..3], ["x 560.000 mm", "y −110.250 mm", "z −139.394 mm"]);
    assert_eq!(of(0.01)[2..4], ["z −139.39 mm", "W 179.90 °"]);
    let ur = PoseConvention::by_id("ur-rotvec").expect("known");
    let rows = pose_rows(&PoseNotation::usual(ur), &pose, 0.001);
    assert!(rows.iter().all(|(_, value)| !value.is_empty()), "{rows:?}");
}

#[test]
fn a_steady_view_does_not_follow_every_tremble() {
    let wanted = [[-10.0, 10.0], [60.0, 80.0]];
    let first = steady(None, wanted);
    assert!(first[0][0] < -10.0 && first[1][1] > 80.0);
    let trembling = [[-10.3, 10.2], [59.8, 80.4]];
    assert_eq!(steady(Some(first), trembling), first);
    let away = [[-30.0, 10.0], [60.0, 80.0]];
    assert_ne!(steady(Some(first), away), first);
    let smaller = [[-5.0, 5.0], [65.0, 75.0]];
    assert_ne!(steady(Some(first), smaller), first, "it does not stay far off for ever");
}

#[test]
fn lamps_say_what_happened_and_when_it_is_tried_again() {
    let error = DeviceError::CannotMove { device: "Robot" };
    let (shape, word, below) =
        lamp(&LinkState::Failed { error: error.clone(), retry_in: Some(Duration::from_secs(4)) });
    assert_eq!((shape, word), (Lamp::Bad, words::FAILED));
    assert!(below.expect("why").contains("4 s"));
    let (_, _, below) = lamp(&LinkState::Failed { error, retry_in: None });
    assert!(below.expect("why").contains(words::NOT_AGAIN));
    let silent = CellView { live: None, ..connected(Readiness::Ready) };
    assert_eq!(sensor_lamp(&silent).1, words::NO_PROFILE_YET);
    let not_ready = connected(Readiness::NotReady { found: "hold".to_owned(), remedy: "release it" });
    assert_eq!(robot_lamp(&not_ready).0, Lamp::Look);
}

#[test]
fn setups_need_an_address_or_a_folder() {
    let endpoint = Endpoint { host: "a".to_owned(), port: 1 };
    let robot = RobotSetup { kind: RobotKind::Bridge, endpoint: endpoint.clone() };
    let sensor = SensorSetup { kind: SensorKind::Folder, endpoint, folder: "f".into(), is_z_inverted: false };
    let cell = CellView {
        robot: LinkView { setup: Some(robot), ..LinkView::default() },
        sensor: LinkView { setup: Some(sensor), ..LinkView::default() },
        ..CellView::default()
    };
    // A link that was let go does not count as connected, whatever it was connected to.
    assert_eq!(deed(&cell, None, &CellMemory::default()), Some(Deed::Enter(words::ROBOT_HOST)));
}

#[test]
fn a_capture_from_a_watched_folder_asks_for_a_file() {
    let (memory, empty) = (with_addresses(), empty_session());
    for (watched_folder, expected) in
        [(None, words::SETTLING), (Some(std::path::PathBuf::from("scans")), words::SETTLING_BY_FOLDER)]
    {
        let cell = CellView { activity: Activity::Settling, watched_folder, ..connected(Readiness::Ready) };
        let next = next(
            &View {
                cell: &cell,
                session: Some(&empty),
                has_solution: false,
                outlook: None,
                has_other_mounting: false,
                results: None,
            },
            &memory,
        );
        assert_eq!(next.sentence, expected);
    }
}
