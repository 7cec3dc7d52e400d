//! A run without a cell: what it makes of each ending.

use std::sync::Arc;
use std::time::Duration;

use super::super::links::Armed;
use super::*;
use crate::device::{Readiness, RobotReport};
use crate::geometry::Vec3;

fn pose(x_mm: f64) -> Transform<Base, Flange> {
    Transform::from_parts(Vec3::new(x_mm, 0.0, 300.0), nalgebra::UnitQuaternion::identity())
}

/// Armed, and at a station of a run over three.
fn bench(stage: Stage) -> Workbench {
    let mut workbench = Workbench::new(Arc::new(|| {}));
    workbench.cell.armed = Some(Armed { base_from_flange: pose(0.0), connection: 1 });
    workbench.cell.view.is_armed = true;
    let run = Run { num_stations: 3, num_done: 2, num_failed: 0, num_failed_in_a_row: 0, is_paused: false, stage };
    workbench.cell.run = Some(run);
    workbench.show_run();
    workbench
}

fn stand_at(workbench: &mut Workbench, x_mm: f64, received_at: Instant) {
    workbench.cell.view.robot.latest = Some(RobotReport {
        base_from_flange: pose(x_mm),
        joints_deg: Vec::new(),
        is_moving: Some(false),
        readiness: Readiness::Ready,
        tool: String::new(),
        resolution_mm: 0.001,
        received_at,
    });
}

fn refused() -> DeviceError {
    let (request, found, remedy) = ("move".to_owned(), "an alarm".to_owned(), "look at it".to_owned());
    DeviceError::Refused { device: "Robot", request, found, remedy }
}

fn out_of_reach() -> DeviceError {
    let (request, found, remedy) = ("move".to_owned(), "not reachable".to_owned(), "another".to_owned());
    DeviceError::OutOfReach { device: "Robot", request, found, remedy }
}

#[test]
fn only_what_is_of_the_pose_lets_a_run_go_on() {
    let lost = SearchEnd::ArcLost { travelled_mm: 1.0, reason: String::new() };
    let no_arc = SearchEnd::NoArcAtStart { reason: String::new() };
    let stuck = SearchEnd::Stuck { commanded_mm: 1.0, travelled_mm: 0.0 };
    let moved = SearchEnd::ResidualGrew { travelled_mm: 1.0, residual_mm: 1.0, expected_mm: 0.1 };
    let failed = |error, robot_stopped| RoutineEnd::Failed { error, robot_stopped };
    for (end, goes_on) in [
        (RoutineEnd::Searched(lost), true),
        (RoutineEnd::Searched(no_arc), true),
        (RoutineEnd::Searched(SearchEnd::TravelExhausted { max_travel_mm: 20.0 }), true),
        (RoutineEnd::Searched(SearchEnd::CapturesExhausted { max_captures: 40 }), true),
        (failed(out_of_reach(), Some(true)), true),
        (failed(out_of_reach(), None), false),
        (failed(refused(), Some(true)), false),
        (RoutineEnd::Searched(stuck), false),
        (RoutineEnd::Searched(moved), false),
        (RoutineEnd::NeverStill { moved_mm: Some(0.3) }, false),
        (RoutineEnd::StaleProfiles { trigger_count: 7 }, false),
    ] {
        let mut workbench = bench(Stage::Measuring);
        workbench.go_on_after(&end);
        assert_eq!(workbench.cell.run.is_some(), goes_on, "{end:?}");
        assert_eq!(workbench.cell.view.is_armed, goes_on, "{end:?}");
    }
}

#[test]
fn a_refused_pose_is_passed_over_only_if_the_robot_still_stands_where_it_stood() {
    for (stood_at_mm, stands_at_mm, goes_on) in
        [(Some(0.0), 0.05, true), (Some(0.0), 5.0, false), (Some(100.0), 100.0, true), (None, 5.0, true)]
    {
        let mut workbench = bench(Stage::Measuring);
        let at = Instant::now();
        let refused =
            RefusedPose { pose: pose(50.0), stood_at: stood_at_mm.map(pose), reason: "an alarm".to_owned(), at };
        stand_at(&mut workbench, stood_at_mm.unwrap_or_default(), at);
        assert!(workbench.look_elsewhere(refused.clone()));
        if stood_at_mm.is_some() {
            assert!(!workbench.look_after_refusal(&refused), "the report is older than the refusal");
        }
        stand_at(&mut workbench, stands_at_mm, at + Duration::from_millis(50));
        assert!(workbench.look_after_refusal(&refused));
        let is_between = workbench.cell.run.as_ref().is_some_and(|run| matches!(run.stage, Stage::Between));
        assert_eq!(is_between, goes_on, "{stood_at_mm:?} {stands_at_mm}");
        assert_eq!(workbench.cell.view.is_armed, goes_on);
    }
}

#[test]
fn a_run_that_is_over_waits_for_nothing() {
    let mut workbench = bench(Stage::Measuring);
    workbench.pause_run(true);
    assert!(workbench.cell.view.run.is_some_and(|run| run.is_paused));
    workbench.go_on_after(&RoutineEnd::Done);
    let run = workbench.cell.view.run.expect("the last one stays in sight");
    assert!(workbench.cell.run.is_none() && run.num_done == 3 && !run.is_paused && !run.is_asking, "{run:?}");
}

#[test]
fn a_forgotten_proposal_is_asked_about_no_more_and_an_accepted_one_ends_the_pause() {
    let mut workbench = bench(Stage::Asking);
    workbench.show_run();
    assert!(workbench.cell.view.run.is_some_and(|run| run.is_asking));
    workbench.drop_proposal();
    assert!(workbench.cell.view.run.is_some_and(|run| run.is_paused && !run.is_asking));
    workbench.run_is_measuring();
    assert!(workbench.cell.view.run.is_some_and(|run| !run.is_paused && !run.is_asking));
}
