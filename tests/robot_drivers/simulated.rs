//! Every driver against the simulated cell, whose arm has joints, limits and a speed.

use std::time::Instant;

use handeye::device::robot::connect;
use handeye::device::sim::{SimCell, SimOptions};
use handeye::device::{DeviceError, LinearMove, MoveState, Readiness, RobotDriver, RobotKind};
use handeye::geometry::{Base, Flange, Rigid, Transform, Vec3, so3};

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
fn the_flange_goes_straight_and_no_faster_than_asked_whatever_tool_point_is_active() {
    const TIME_SCALE: f64 = 10.0;
    const SPEED_MM_S: f64 = 50.0;
    let flange_from_tcp = Rigid::translation(0.0, 0.0, 300.0);
    let options = SimOptions {
        robot: RobotKind::UniversalRobots,
        time_scale: TIME_SCALE,
        flange_from_tcp,
        ..SimOptions::default()
    };
    let cell = SimCell::start(&options).expect("free ports");
    let mut robot = connect(&cell.robot_setup, soon()).expect("a robot");
    let start = at(&mut *robot);
    // 30° about the tool point: that stays where it is, and the flange goes 155 mm.
    let turn = Rigid::from_parts(Vec3::zeros().into(), so3::exp(Vec3::new(30.0_f64.to_radians(), 0.0, 0.0)));
    let target = Transform::from_rigid(start.rigid() * flange_from_tcp * turn * flange_from_tcp.inverse());
    let way = target.translation_mm() - start.translation_mm();
    assert!((way.norm() - 155.3).abs() < 0.1, "{way}");
    let begin = Instant::now();
    let motion = LinearMove { base_from_flange: target, speed_mm_s: SPEED_MM_S, rotation_speed_deg_s: 30.0 };
    robot.start_move(&motion, soon()).expect("taken");
    let mut num_underway = 0;
    while robot.move_state(soon()).expect("on its way") == MoveState::Moving {
        let gone = at(&mut *robot).translation_mm() - start.translation_mm();
        let off_mm = (gone - way * (gone.dot(&way) / way.norm_squared())).norm();
        assert!(off_mm < NEAR_MM, "{off_mm} mm beside the straight line");
        num_underway +=
            u32::from(gone.norm() > 1.0 && (target.translation_mm() - start.translation_mm() - gone).norm() > 1.0);
    }
    let taken_s = begin.elapsed().as_secs_f64() * TIME_SCALE;
    // A slow machine takes longer, never less.
    assert!(taken_s > way.norm() / SPEED_MM_S, "{taken_s} s");
    assert!(num_underway > 0, "nobody has looked");
    assert_near(&at(&mut *robot), &target, NEAR_MM);
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
