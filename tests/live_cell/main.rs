//! The live cell without a window: practice on the simulated cell, from the first connection to a compared result.
#![expect(clippy::expect_used, reason = "a test that finds nothing to check must fail")]

mod bench;
mod edges;

use std::time::Duration;

use handeye::app::cell::{Activity, CellCommand, StationRoutine};
use handeye::app::{Command, NoticeKind, Workbench};
use handeye::calibrate::verdict::GOOD_UP_TO_MM;
use handeye::device::sim::{Fault, FaultSpec, Head, SimCell, SimOptions};
use handeye::device::{LinkState, MotionRefusal, RobotKind, RoutineEnd, SearchPhase, SensorKind, WorkspaceBox};
use handeye::report::compare::distance_from_truth;
use handeye::session::{Edit, Row, SetupField, Target};
use handeye::ui::capture::model::Outlook;

use bench::{Bench, FAIR_STDS, FAST, SLOW, position_mm, recoverable_in};

/// A search that finds its peak has at least three sections on either side of it.
const FEWEST_IN_SEARCH: usize = 6;

#[test]
fn a_run_over_eight_stations_gives_a_result_within_its_stated_sigma() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut bench = recoverable_in(folder.path()).practise(1, FAST).armed();
    bench.cell(CellCommand::StartRun { num_stations: 8 });
    bench.wait_for_rest();
    let run = bench.workbench.cell().run.expect("a run");
    assert_eq!(run.num_done, 8, "{:?}", bench.workbench.notices());
    let done = bench.workbench.notices().iter().filter(|notice| notice.kind == NoticeKind::Done).count();
    assert_eq!(done, 1, "{:?}", bench.workbench.notices());

    // What the last search saw is in the session, profile by profile; the stations before are its like.
    let num_seen = bench.workbench.cell().search.as_ref().expect("searched").points.len();
    let num_kept: Vec<_> = bench.session().stations.iter().map(|station| station.captures.len()).collect();
    assert_eq!(num_kept.last(), Some(&num_seen), "{num_kept:?}");
    assert!(num_kept.iter().all(|num| *num >= FEWEST_IN_SEARCH), "{num_kept:?}");

    let truth = bench.session().truth.clone().expect("a simulated cell knows it");
    let solution = bench.solution();
    let stated_mm = solution.uncertainty.as_ref().expect("known").workspace_point_std_mm;
    let off_mm = distance_from_truth(solution, &truth).workspace_point_mm;
    println!("off by {off_mm:.4} mm, stated σ {stated_mm:.4} mm, {} captures", bench.session().num_captures());
    assert!(off_mm < FAIR_STDS * stated_mm, "off by {off_mm} mm, stated σ {stated_mm} mm");

    // One station, one step of undo; and a copy of the newest state is kept for a run that ends badly.
    let num_stations = bench.session().stations.len();
    assert_eq!(bench.num_undo_steps(), num_stations);
    for num_left in (0..num_stations).rev() {
        let label = bench.workbench.document().expect("open").history.undo_label().map(str::to_owned);
        assert_eq!(label, Some(format!("capture station {}", num_left + 1)));
        bench.workbench.apply(Command::Undo);
        assert_eq!(bench.session().stations.len(), num_left);
    }
    bench.workbench.apply(Command::StepHistory(isize::MAX));
    assert_eq!(bench.session().stations.len(), num_stations);
    bench.wait_for_rest();
    let num_captures = bench.session().num_captures();
    drop(bench);
    let mut after = recoverable_in(folder.path());
    after.wait("what was left behind", |workbench| !workbench.recoverable().is_empty());
    after.workbench.apply(Command::Recover(0));
    after.wait("the recovered session", |workbench| workbench.document().is_some());
    assert_eq!(after.session().num_captures(), num_captures);
}

#[test]
fn a_run_as_long_as_the_outlook_says_ends_good() {
    let mut bench = Bench::practising(1, FAST).armed();
    // So far from where the ball is seen it takes more stations than a run begins with.
    let far = Edit::Setup(SetupField::ReferenceDistanceMm(Some(200.0)));
    bench.workbench.apply(Command::Edit { edit: far, gesture: None });
    bench.cell(CellCommand::StartRun { num_stations: 8 });
    bench.wait_for_rest();
    let outlook = |workbench: &Workbench| workbench.current_plan().and_then(Outlook::new);
    let told = outlook(&bench.workbench).expect("eight stations of this cell are not good yet");
    let num_stations = u16::try_from(told.num_to_good.expect("within reach")).expect("not so many");
    bench.cell(CellCommand::StartRun { num_stations });
    // It begins with a proposal, as the robot stands at a station.
    bench.wait("the way to a further station", |workbench| workbench.cell().activity == Activity::Moving);
    bench.wait_for_rest();
    let std_mm = bench.solution().uncertainty.as_ref().expect("known").workspace_point_std_mm;
    println!("{:.3} mm, and {std_mm:.3} mm after {num_stations} more", told.std_mm);
    // What is planned is not quite what is measured.
    assert!(std_mm < 1.1 * GOOD_UP_TO_MM, "{std_mm} mm after {num_stations} more");
    assert!(num_stations > 2 && std_mm > 0.8 * GOOD_UP_TO_MM, "{std_mm} mm: it asks for too many, {num_stations}");
}

#[test]
fn every_robot_and_profiler_that_can_be_simulated_is_driven_to_a_result() {
    for (robot, sensor) in
        [(RobotKind::UniversalRobots, SensorKind::KeyenceLjv), (RobotKind::Bridge, SensorKind::Bridge)]
    {
        let options = SimOptions { seed: 8, time_scale: FAST, robot, sensor, ..SimOptions::default() };
        let mut bench = Bench::new().practise_with(&options).armed();
        bench.cell(CellCommand::StartRun { num_stations: 5 });
        bench.wait_for_rest();
        let run = bench.workbench.cell().run.expect("a run");
        assert_eq!(run.num_done, 5, "{robot:?}: {:?}", bench.workbench.notices());
        let truth = bench.session().truth.clone().expect("a simulated cell knows it");
        let stated_mm = bench.solution().uncertainty.as_ref().expect("known").workspace_point_std_mm;
        let off_mm = distance_from_truth(bench.solution(), &truth).workspace_point_mm;
        assert!(off_mm < FAIR_STDS * stated_mm, "{robot:?}: off by {off_mm} mm, stated σ {stated_mm} mm");
    }
}

#[test]
fn a_controller_that_is_not_in_remote_mode_is_not_armed() {
    let options = SimOptions {
        robot: RobotKind::UniversalRobots,
        time_scale: FAST,
        faults: vec![FaultSpec::now(Fault::NotRemote)],
        ..SimOptions::default()
    };
    let mut bench = Bench::new().practise_with(&options);
    bench.cell(CellCommand::Arm(true));
    assert!(!bench.workbench.cell().is_armed);
    assert!(bench.last_notice().contains("remote"), "{}", bench.last_notice());
}

#[test]
fn a_stop_a_disarming_a_disconnection_and_a_closed_document_each_stop_the_robot() {
    type Way = (&'static str, fn(&mut Bench));
    let ways: [Way; 4] = [
        ("stop", |bench| bench.cell(CellCommand::Stop)),
        ("disarm", |bench| bench.cell(CellCommand::Arm(false))),
        ("close", |bench| bench.workbench.apply(Command::CloseDocument)),
        ("another session", |bench| bench.workbench.apply(Command::NewSession(Target::ball(10.0)))),
    ];
    for (what, way) in ways {
        // A head that sees a large ball from far away: another view of it is a long way off.
        let head = Head::by_id("lj-v7300").expect("there is one");
        let robot = RobotKind::UniversalRobots;
        let options = SimOptions { seed: 2, time_scale: SLOW, robot, head, radius_mm: 30.0, ..SimOptions::default() };
        // Practice ends with its document; a cell of its own goes on.
        let sim = SimCell::start(&options).expect("ports are free");
        let mut bench = Bench::connected_to(&sim).armed();
        bench.cell(CellCommand::CaptureStation);
        bench.wait_for_rest();
        let num_captures = bench.session().num_captures();
        bench.change_settings(|settings| settings.limits.transit_speed_mm_s = 5.0);
        bench.cell(CellCommand::ProposeStation);
        bench.wait("a proposal", |workbench| workbench.cell().proposal.is_some());
        let proposal = bench.workbench.cell().proposal.clone().expect("proposed");
        assert!(proposal.distance_mm > 100.0, "{proposal:?}");
        let from_mm = position_mm(&bench.workbench);
        bench.cell(CellCommand::AcceptProposal);
        bench.wait("the robot to set out", |workbench| (position_mm(workbench) - from_mm).norm() > 3.0);
        way(&mut bench);
        bench.wait_for_rest();
        let end = bench.workbench.cell().last_end.clone();
        let is_past = matches!(what, "close" | "another session");
        match end {
            None => assert!(is_past, "{what}: nothing is told of how it ended"),
            Some(RoutineEnd::Stopped { robot_stopped: Some(true) }) => assert!(!is_past, "{what}"),
            end => panic!("{what}: {end:?}"),
        }
        assert_eq!(bench.num_errors(), 0, "{what}: {:?}", bench.workbench.notices());
        bench.check_robot_stands();
        // What is left would take some seconds.
        let left_mm = (position_mm(&bench.workbench) - proposal.station.base_from_flange.translation_mm()).norm();
        assert!(left_mm > 40.0, "{what}: {left_mm} mm before the target");
        match what {
            "close" => assert!(bench.workbench.document().is_none()),
            "another session" => assert_eq!(bench.session().num_captures(), 0),
            _ => assert!(bench.session().num_captures() >= num_captures && num_captures > 0),
        }
        if what == "disarm" {
            assert!(!bench.workbench.cell().is_armed);
            bench.cell(CellCommand::FindLargestArc);
            bench.wait_for_rest();
            assert_eq!(bench.last_end(), &RoutineEnd::NotAllowed(MotionRefusal::NotArmed));
        }
        bench.cell(CellCommand::DisconnectRobot);
        assert_eq!(bench.workbench.cell().robot.state, LinkState::Off);
        assert!(!bench.workbench.cell().is_armed);
    }
}

#[test]
fn what_is_not_allowed_is_not_begun_and_says_why() {
    let mut bench = Bench::new();
    for (command, reason) in [
        (CellCommand::CaptureStation, "no session is open"),
        (CellCommand::Arm(true), "not armed"),
        (CellCommand::AcceptProposal, "no proposed pose"),
        (CellCommand::StartRun { num_stations: 3 }, "not armed"),
        (CellCommand::StartReplay, "nothing to replay"),
    ] {
        bench.cell(command);
        assert!(bench.last_notice().contains(reason), "{}", bench.last_notice());
    }
    bench.workbench.apply(Command::NewSession(Target::Workpiece));
    bench.cell(CellCommand::FindLargestArc);
    assert!(bench.last_notice().contains("no ball"), "{}", bench.last_notice());
    bench.workbench.apply(Command::NewSession(Target::ball(15.0)));
    bench.cell(CellCommand::FindLargestArc);
    assert!(bench.last_notice().contains("no robot is connected"), "{}", bench.last_notice());

    // The box excludes a part of the search's travel: nothing is captured and nothing moves.
    let mut bench = Bench::practising(3, FAST).armed();
    let here = bench.workbench.cell().robot.latest.clone().expect("reports").base_from_flange.translation_mm();
    let workspace = WorkspaceBox { min_mm: (here.add_scalar(-5.0)).into(), max_mm: (here.add_scalar(5.0)).into() };
    bench.change_settings(|settings| settings.limits.workspace = Some(workspace));
    bench.cell(CellCommand::FindLargestArc);
    bench.wait_for_rest();
    assert!(
        matches!(bench.last_end(), RoutineEnd::NotAllowed(MotionRefusal::OutsideWorkspace { .. })),
        "{:?}",
        bench.last_end()
    );
    assert_eq!(bench.session().num_captures(), 0);
}

#[test]
fn a_single_profile_is_a_station_without_arming() {
    let mut bench = Bench::practising(4, FAST);
    bench.change_settings(|settings| settings.settle.num_profiles = 8);
    for num_stations in 1..=2 {
        bench.cell(CellCommand::CaptureStation);
        bench.wait_for_rest();
        assert_eq!(bench.last_end(), &RoutineEnd::Done);
        assert_eq!(bench.session().stations.len(), num_stations);
        assert_eq!(bench.num_undo_steps(), num_stations);
    }
    let repeat_std_mm = bench.workbench.cell().repeat_std_mm.expect("of eight profiles");
    let stated_mm = bench.session().sensor.profile_std_mm.expect("stated");
    // 800 columns and 7 degrees of freedom each: known to about 1 %; the wire's steps and the ball's flanks add a little.
    assert!((0.8..1.5).contains(&(repeat_std_mm / stated_mm)), "{repeat_std_mm} against {stated_mm}");
}

#[test]
fn a_run_pauses_goes_on_and_asks_before_each_motion() {
    let mut bench = Bench::practising(5, FAST).armed();
    bench.change_settings(|settings| settings.asks_before_motion = true);
    bench.cell(CellCommand::StartRun { num_stations: 3 });
    bench.cell(CellCommand::PauseRun);
    bench.wait("the first capture", |workbench| workbench.cell().search.is_some());
    let num_captures = bench.session().num_captures();
    std::thread::sleep(Duration::from_millis(100));
    bench.workbench.poll();
    assert!(bench.session().num_captures() <= num_captures + 1, "a paused search makes no further step");
    assert!(bench.workbench.cell().run.expect("a run").is_paused);
    bench.cell(CellCommand::ResumeRun);
    let is_asking = |workbench: &Workbench| workbench.cell().run.is_some_and(|run| run.is_asking);
    bench.wait("the first question", is_asking);
    assert_eq!(bench.session().stations.len(), 1);
    let first = bench.workbench.cell().proposal.clone().expect("proposed");
    assert!(first.refusal.is_none() && first.turn_deg > 1.0 && !first.reason.is_empty(), "{first:?}");
    bench.cell(CellCommand::SkipProposal);
    bench.wait("another proposal", |workbench| {
        workbench.cell().proposal.as_ref().is_some_and(|proposal| proposal.station != first.station)
            && is_asking(workbench)
    });
    bench.cell(CellCommand::AcceptProposal);
    bench.wait("the second question", |workbench| is_asking(workbench) && !workbench.cell().is_busy());
    assert_eq!(bench.session().stations.len(), 2);
    bench.cell(CellCommand::DropProposal);
    assert!(bench.workbench.cell().run.expect("a run").is_paused);
    assert!(bench.workbench.cell().proposal.is_none());
    bench.cell(CellCommand::ResumeRun);
    bench.wait("the question again", is_asking);
    bench.cell(CellCommand::Stop);
    bench.wait_for_rest();
    assert!(bench.last_notice().contains("after 2 of 3"), "{}", bench.last_notice());
}

#[test]
fn taking_a_station_back_while_it_is_measured_stops_the_robot_and_the_run() {
    let mut bench = Bench::practising(6, SLOW).armed();
    bench.cell(CellCommand::StartRun { num_stations: 3 });
    bench.wait("some captures", |workbench| {
        workbench.document().is_some_and(|document| document.session.num_captures() >= 3)
    });
    // Another edit in between does no harm: the captures go on under the station, whatever it is called.
    let rename = handeye::session::edit::CellValue::Label("first".to_owned());
    let place = handeye::session::Place { station_idx: 0, capture_idx: 0 };
    bench.workbench.apply(Command::Edit { edit: Edit::SetCells(vec![(place, rename)]), gesture: None });
    let num_captures = bench.session().num_captures();
    bench.wait("a further capture", |workbench| {
        workbench.document().is_some_and(|document| document.session.num_captures() > num_captures)
    });
    assert_eq!(bench.session().stations.len(), 1);
    bench.workbench.apply(Command::Edit { edit: Edit::Remove(vec![Row::Station(0)]), gesture: None });
    bench.wait_for_rest();
    assert!(matches!(bench.last_end(), RoutineEnd::Stopped { .. }), "{:?}", bench.last_end());
    assert_eq!(bench.session().stations.len(), 0, "nothing comes after it was taken back");
    assert!(bench.workbench.notices().iter().any(|notice| notice.message.contains("taken back")));
    bench.check_robot_stands();
    // It can be brought back.
    bench.workbench.apply(Command::Undo);
    assert!(bench.session().num_captures() > num_captures);
}

/// A slow search with some captures.
fn searching(seed: u64, num_captures: usize) -> Bench {
    let mut bench = Bench::practising(seed, SLOW).armed();
    bench.cell(CellCommand::FindLargestArc);
    bench.wait("some captures", |workbench| {
        workbench.document().is_some_and(|document| document.session.num_captures() >= num_captures)
    });
    bench
}

#[test]
fn a_part_of_a_station_taken_back_stops_the_robot_and_stays_in_the_history() {
    let mut bench = searching(16, 2);
    let rename = handeye::session::edit::CellValue::Label("first".to_owned());
    let place = handeye::session::Place { station_idx: 0, capture_idx: 0 };
    bench.workbench.apply(Command::Edit { edit: Edit::SetCells(vec![(place, rename)]), gesture: None });
    let num_before = bench.session().num_captures();
    bench.wait("two further captures", |workbench| {
        workbench.document().is_some_and(|document| document.session.num_captures() >= num_before + 2)
    });
    let num_captures = bench.session().num_captures();
    // The rename began another step, which the captures since are in.
    bench.workbench.apply(Command::Undo);
    assert!(bench.session().num_captures() < num_captures && bench.session().num_captures() > 0);
    bench.wait_for_rest();
    assert!(matches!(bench.last_end(), RoutineEnd::Stopped { .. }), "{:?}", bench.last_end());
    bench.workbench.apply(Command::StepHistory(isize::MAX));
    assert!(bench.session().num_captures() >= num_captures, "nothing is lost");
}

#[test]
fn what_a_routine_was_begun_with_holds_to_its_end() {
    let mut bench = searching(17, 2);
    let before = bench.workbench.cell().settings;
    bench.change_settings(|settings| {
        settings.limits.max_speed_mm_s = 1.0;
        settings.asks_before_motion = true;
    });
    assert!(bench.last_notice().contains("while the robot is at work"), "{}", bench.last_notice());
    let after = bench.workbench.cell().settings;
    assert_eq!(after.limits, before.limits);
    assert!(after.asks_before_motion, "that concerns the next station");
    bench.cell(CellCommand::Stop);
    bench.wait_for_rest();
    bench.change_settings(|settings| settings.limits.max_speed_mm_s = 1.0);
    assert!((bench.workbench.cell().settings.limits.max_speed_mm_s - 1.0).abs() < f64::EPSILON);
}

#[test]
fn practice_ends_with_its_document_and_tells_of_no_danger() {
    let mut bench = searching(18, 2);
    bench.workbench.apply(Command::NewSession(Target::ball(10.0)));
    bench.wait_for_rest();
    let cell = bench.workbench.cell();
    assert!(!cell.is_armed && !cell.is_practice && cell.robot.state == LinkState::Off && cell.last_end.is_none());
    assert!(cell.sensor.state == LinkState::Off && cell.search.is_none() && !cell.is_stop_unconfirmed());
    assert_eq!(bench.session().num_captures(), 0);
    assert_eq!(bench.num_errors(), 0, "{:?}", bench.workbench.notices());

    let mut bench = Bench::practising(18, SLOW).armed();
    bench.cell(CellCommand::StartRun { num_stations: 3 });
    bench.wait("a move", |workbench| workbench.cell().activity == Activity::Moving);
    bench.cell(CellCommand::EndPractice);
    bench.wait_for_rest();
    assert!(bench.workbench.cell().last_end.is_none());
    assert_eq!(bench.num_errors(), 0, "{:?}", bench.workbench.notices());
    assert_eq!(bench.workbench.notices().len(), 1, "{:?}", bench.workbench.notices());
}

#[test]
fn a_stop_gives_one_line_and_a_run_belongs_to_itself() {
    let mut bench = Bench::practising(20, SLOW).armed();
    for _ in 0..2 {
        bench.cell(CellCommand::StartRun { num_stations: 3 });
        bench.wait("a move", |workbench| workbench.cell().activity == Activity::Moving);
        bench.cell(CellCommand::Stop);
        bench.wait_for_rest();
        assert_eq!(bench.workbench.notices().len(), 1, "{:?}", bench.workbench.notices());
        assert_eq!(bench.num_errors(), 0);
        assert!(bench.workbench.cell().run.is_some());
    }
    bench.cell(CellCommand::CaptureStation);
    assert_eq!(bench.workbench.cell().run, None);
    bench.wait_for_rest();
    // The second run goes elsewhere first: where it stands there is a station.
    let num_stations = bench.session().stations.len();
    bench.change_settings(|settings| settings.asks_before_motion = true);
    bench.cell(CellCommand::StartRun { num_stations: 2 });
    bench.wait("a proposal", |workbench| workbench.cell().run.is_some_and(|run| run.is_asking));
    assert_eq!(bench.session().stations.len(), num_stations);
    bench.workbench.apply(Command::NewSession(Target::ball(10.0)));
    assert_eq!(bench.workbench.cell().run, None);
}

#[test]
fn a_run_that_could_not_go_on_is_not_begun() {
    let mut bench = Bench::practising(21, FAST).armed();
    bench.change_settings(|settings| settings.mounting = None);
    bench.cell(CellCommand::StartRun { num_stations: 2 });
    assert!(bench.last_notice().contains("how the sensor is mounted"), "{}", bench.last_notice());
    assert!(bench.workbench.cell().run.is_none() && !bench.workbench.cell().is_busy());
}

#[test]
fn a_proposal_is_refused_where_its_search_would_leave_the_box() {
    let mut bench = Bench::practising(19, FAST).armed();
    bench.cell(CellCommand::FindLargestArc);
    bench.wait_for_rest();
    bench.cell(CellCommand::ProposeStation);
    bench.wait("a proposal", |workbench| workbench.cell().proposal.is_some());
    let proposal = bench.workbench.cell().proposal.clone().expect("waited for");
    assert_eq!(proposal.refusal, None);
    let ends = [
        bench.workbench.cell().robot.latest.as_ref().expect("reports").base_from_flange.translation_mm(),
        proposal.station.base_from_flange.translation_mm(),
    ];
    // Both ends of the way, and a step about them.
    let min_mm = ends[0].inf(&ends[1]).add_scalar(-1.0).into();
    let max_mm = ends[0].sup(&ends[1]).add_scalar(1.0).into();
    bench.change_settings(|settings| settings.limits.workspace = Some(WorkspaceBox { min_mm, max_mm }));
    bench.workbench.poll();
    let refusal = |bench: &Bench| bench.workbench.cell().proposal.as_ref().expect("stays").refusal.clone();
    assert!(matches!(refusal(&bench), Some(MotionRefusal::OutsideWorkspace { .. })), "{:?}", refusal(&bench));
    bench.change_settings(|settings| settings.routine = StationRoutine::FixedPoint);
    bench.workbench.poll();
    assert_eq!(refusal(&bench), None, "a single profile needs no travel");
    bench.cell(CellCommand::StartReplay);
    assert_eq!(bench.workbench.cell().proposal, None, "the poses of a replay are not where the robot is");
}

#[test]
fn the_last_search_stays_in_sight_on_the_way_to_the_next_station() {
    let mut bench = Bench::practising(20, FAST).armed();
    bench.cell(CellCommand::StartRun { num_stations: 2 });
    bench.wait("the way to the second station", |workbench| {
        let cell = workbench.cell();
        cell.run.is_some_and(|run| run.num_done == 1) && cell.activity == Activity::Moving && cell.is_search_past()
    });
    bench.wait("its search", |workbench| {
        let cell = workbench.cell();
        cell.run.is_some_and(|run| run.num_done == 1) && cell.is_busy() && !cell.is_search_past()
    });
    bench.wait_for_rest();
    assert!(!bench.workbench.cell().is_search_past());
}

#[test]
fn a_recorded_session_plays_through_the_panel_and_changes_nothing() {
    let mut bench = Bench::practising(7, FAST).armed();
    bench.change_settings(|settings| settings.routine = StationRoutine::LargestArc);
    bench.cell(CellCommand::FindLargestArc);
    bench.wait_for_rest();
    assert!(bench.last_end().is_success(), "{:?}", bench.last_end());
    let found = bench.workbench.cell().search.clone().expect("searched");
    bench.cell(CellCommand::EndPractice);
    let before = bench.session().clone();
    bench.cell(CellCommand::StartReplay);
    bench.wait("the end of the replay", |workbench| workbench.cell().replay.is_some_and(|replay| replay.is_over));
    let cell = bench.workbench.cell();
    let report = cell.search.clone().expect("played");
    assert_eq!(report.points.len(), before.stations[0].captures.len());
    assert_eq!(report.phase, SearchPhase::Ended);
    let peak_mm = |report: &handeye::device::SearchReport| report.curve.expect("a curve").peak_mm;
    // The same captures; only the zero of the travel is the first reported pose, not the one before it.
    assert!((peak_mm(&report) - peak_mm(&found)).abs() < 0.2, "{} {}", peak_mm(&report), peak_mm(&found));
    let last = before.stations[0].captures.last().expect("captures");
    assert_eq!(cell.robot.latest.as_ref().expect("played").base_from_flange, last.base_from_flange);
    assert!(cell.live.as_ref().expect("played").found.is_ok());
    assert_eq!(bench.session(), &before);
    bench.cell(CellCommand::EndReplay);
    let cell = bench.workbench.cell();
    assert!(cell.replay.is_none() && cell.live.is_none() && cell.robot.latest.is_none());
}

#[test]
fn a_search_along_the_laser_line_is_refused_before_anything_moves() {
    let mut bench = Bench::practising(22, FAST).armed();
    bench.change_settings(|settings| settings.search.direction = [1.0, 0.0, 0.0]);
    for command in [CellCommand::FindLargestArc, CellCommand::StartRun { num_stations: 3 }] {
        bench.cell(command);
        assert!(bench.last_notice().contains("across the laser line"), "{}", bench.last_notice());
        assert!(bench.workbench.cell().run.is_none() && !bench.workbench.cell().is_busy());
    }
    bench.change_settings(|settings| settings.search.direction = [0.6, 1.0, 0.0]);
    bench.cell(CellCommand::FindLargestArc);
    assert!(bench.workbench.cell().is_busy());
    assert!(bench.last_notice().contains("off the laser plane's normal"), "{}", bench.last_notice());
    bench.cell(CellCommand::Stop);
    bench.wait_for_rest();
}

#[test]
fn captures_record_what_is_connected_and_another_robot_is_remarked_once() {
    let options = SimOptions { seed: 23, time_scale: FAST, ..SimOptions::default() };
    let sim = SimCell::start(&options).expect("ports are free");
    let mut bench = Bench::connected_to(&sim);
    bench.cell(CellCommand::CaptureStation);
    bench.wait_for_rest();
    assert_eq!(
        (bench.session().robot.model.as_str(), bench.session().sensor.model.as_str()),
        ("FANUC", "Keyence LJ-V7000")
    );
    assert_eq!(bench.num_undo_steps(), 1);
    let other = SetupField::RobotModel("UR5e".to_owned());
    bench.workbench.apply(Command::Edit { edit: Edit::Setup(other), gesture: None });
    for _ in 0..2 {
        bench.cell(CellCommand::CaptureStation);
        bench.wait_for_rest();
    }
    let remarks = bench.workbench.notices().iter().filter(|notice| notice.message.contains("Universal Robots"));
    assert_eq!(remarks.count(), 1, "{:?}", bench.workbench.notices());
    assert_eq!(bench.session().robot.model, "UR5e");
}
