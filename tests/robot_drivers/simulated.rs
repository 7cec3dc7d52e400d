//! Every driver against the simulated cell, whose arm has joints, limits and a speed.

use handeye::device::robot::connect;
use handeye::device::sim::{SimCell, SimOptions};
use handeye::device::{DeviceError, MoveState, Readiness, RobotDriver, RobotKind};
use handeye::geometry::{Base, Flange, Transform, Vec3, so3};

use super::fake::{assert_near, finish, linear, soon};

/// Steps of the wires, and what the simulated robot's pose is off by.
const NEAR_MM: f64 = 0.2;

fn cell_and_robot(kind: RobotKind, time_scale: f64) -> (SimCell, Box<dyn RobotDriver>) {
    let options = SimOptions { robot: kind, time_scale, ..SimOptions::default() };
    let cell = SimCell::start(&options).expect("free ports");
    let robot = connect(&cell.robot_setup, soon()).expect("a robot");
    (cell, robot)
}

fn at(robot: &mut dyn RobotDriver) -> Transform<Base, Flange> {
    robot.report(soon()).expect("a report").base_from_flange
}

/// Shifted in the base, and turned about the flange's own x.
fn shifted(from: &Transform<Base, Flange>, by_mm: [f64; 3], turned_deg: f64) -> Transform<Base, Flange> {
    let turn = so3::exp(Vec3::new(turned_deg.to_radians(), 0.0, 0.0));
    Transform::from_parts(from.translation_mm() + Vec3::from(by_mm), from.rotation() * turn)
}

#[test]
fn robots_that_move_go_where_they_are_sent() {
    for kind in [RobotKind::FanucMappdk, RobotKind::UniversalRobots, RobotKind::Bridge] {
        let (_cell, mut robot) = cell_and_robot(kind, 50.0);
        let start = at(&mut *robot);
        for target in [
            shifted(&start, [0.0, 0.75, 0.0], 0.0),
            shifted(&start, [0.0, 20.0, 15.0], 8.0),
            shifted(&start, [0.0, 20.0, 15.0], -4.0),
            start,
        ] {
            robot.start_move(&linear(target, 50.0), soon()).expect("taken");
            finish(&mut *robot).unwrap_or_else(|error| panic!("{kind:?}: {error}"));
            assert_near(&at(&mut *robot), &target, NEAR_MM);
        }
    }
}

#[test]
fn robots_that_move_can_be_stopped_on_the_way() {
    for kind in [RobotKind::FanucMappdk, RobotKind::UniversalRobots, RobotKind::Bridge] {
        let (_cell, mut robot) = cell_and_robot(kind, 1.0);
        let start = at(&mut *robot);
        // 40 mm at 4 mm/s: far longer than a stop takes.
        robot.start_move(&linear(shifted(&start, [0.0, 40.0, 0.0], 0.0), 4.0), soon()).expect("taken");
        assert_eq!(robot.move_state(soon()), Ok(MoveState::Moving), "{kind:?}");
        robot.stop(soon()).unwrap_or_else(|error| panic!("{kind:?}: {error}"));
        let stopped = at(&mut *robot);
        assert!((stopped.translation_mm() - start.translation_mm()).norm() < 35.0, "{kind:?}");
        assert_near(&at(&mut *robot), &stopped, NEAR_MM);
        assert_eq!(robot.move_state(soon()), Ok(MoveState::Done), "{kind:?}");
        robot.start_move(&linear(stopped, 50.0), soon()).expect("taken again");
        finish(&mut *robot).unwrap_or_else(|error| panic!("{kind:?}: {error}"));
    }
}

#[test]
fn poses_out_of_reach_are_refused_and_the_robot_stays() {
    for kind in [RobotKind::FanucMappdk, RobotKind::UniversalRobots, RobotKind::Bridge] {
        let (_cell, mut robot) = cell_and_robot(kind, 1000.0);
        let start = at(&mut *robot);
        let far = linear(shifted(&start, [3000.0, 0.0, 0.0], 0.0), 1000.0);
        let outcome = robot.start_move(&far, soon()).and_then(|()| finish(&mut *robot));
        // Only MAPPDK says that it is the target and nothing else.
        let is_of_target = matches!(outcome, Err(DeviceError::OutOfReach { .. }));
        let is_refused = is_of_target || matches!(outcome, Err(DeviceError::Refused { .. }));
        assert!(is_refused && is_of_target == (kind == RobotKind::FanucMappdk), "{kind:?}: {outcome:?}");
        let still = at(&mut *robot);
        robot.start_move(&linear(start, 1000.0), soon()).expect("still connected");
        finish(&mut *robot).unwrap_or_else(|error| panic!("{kind:?}: {error}, at {still:?}"));
    }
}

#[test]
fn the_page_tells_where_the_robot_is_until_the_cell_is_gone() {
    let (cell, mut page) = cell_and_robot(RobotKind::FanucPage, 1.0);
    let report = page.report(soon()).expect("a page");
    assert_eq!(report.readiness, Readiness::ReadOnly);
    assert_near(&report.base_from_flange, &at(&mut *page), NEAR_MM);
    drop(cell);
    assert!(page.report(soon()).is_err(), "nobody is there any more");
}
