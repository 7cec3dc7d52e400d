//! Routines over drivers in memory: what they capture, how they end, and that they end.

use std::sync::Arc;
use std::time::{Duration, Instant};

use super::*;
use crate::device::driver::Readiness;
use crate::device::fake::{FakeCell, Fault, RADIUS_MM, short_deadlines};
use crate::device::link::LinkState;
use crate::device::safety::MotionLimits;
use crate::device::worker::{Deadlines, RobotWorker, SensorWorker};
use crate::geometry::Vec3;

/// Long past anything that is waited for here, on a slow machine as well.
const PATIENCE: Duration = Duration::from_secs(30);

fn task(cell: &FakeCell, measurement: Measurement) -> Task {
    let settle = SettleSettings { settle_ms: 1, ..SettleSettings::default() };
    let arming = Arming { base_from_flange: cell.world().pose, limits: MotionLimits::default() };
    Task { go_to: None, measurement: Some(measurement), settle, arming: Some(arming) }
}

fn search() -> Measurement {
    let ball = ArcOptions { ball_radius_mm: RADIUS_MM, profile_std_mm: None };
    Measurement::LargestArc(SearchSettings::default(), ball)
}

struct Running {
    routine: Routine,
    robot: RobotWorker,
    _sensor: SensorWorker,
}

fn start_workers(cell: &FakeCell, deadlines: Deadlines) -> (RobotWorker, SensorWorker) {
    let (robot, sensor) = cell.start(deadlines);
    let deadline = Instant::now() + PATIENCE;
    let is_ready = || {
        let now = Instant::now();
        robot.client().link_state(now) == LinkState::Ready && sensor.client().link_state(now) == LinkState::Ready
    };
    while !is_ready() {
        assert!(Instant::now() < deadline, "connects");
        std::thread::sleep(Duration::from_millis(1));
    }
    (robot, sensor)
}

fn start(cell: &FakeCell, task: &Task, deadlines: Deadlines) -> Running {
    let fault = std::mem::take(&mut cell.world().fault);
    let (robot, sensor) = start_workers(cell, deadlines);
    let clients = (robot.client().of_this_connection(), sensor.client().of_this_connection());
    cell.world().fault = fault;
    let routine = Routine::start(*task, clients.0, clients.1, Arc::new(|| {}));
    Running { routine, robot, _sensor: sensor }
}

impl Running {
    fn next(&mut self) -> RoutineEvent {
        let deadline = Instant::now() + PATIENCE;
        loop {
            if let Some(event) = self.routine.poll() {
                return event;
            }
            assert!(Instant::now() < deadline, "the routine ends");
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    fn run(mut self) -> (Vec<StepCapture>, RoutineEnd) {
        let mut captures = Vec::new();
        loop {
            match self.next() {
                RoutineEvent::Captured(capture) => captures.push(capture),
                RoutineEvent::Ended(end) => {
                    assert_eq!(self.routine.poll(), None, "nothing comes after the end");
                    return (captures, end);
                }
                _ => {}
            }
        }
    }
}

#[test]
fn a_search_finds_the_largest_arc_and_tells_each_step() {
    for off_centre_mm in [8.0, -8.0] {
        let cell = FakeCell::new(off_centre_mm);
        let (captures, end) = start(&cell, &task(&cell, search()), Deadlines::default()).run();
        assert!(end.is_success(), "{end:?}");
        let RoutineEnd::Searched(SearchEnd::Found { peak_mm, .. }) = end else { panic!("{end:?}") };
        // The tool points down, so its Y is the base's −Y; the wanted σ is 0.02 mm.
        assert!((peak_mm - off_centre_mm).abs() < 0.1, "{peak_mm}");
        assert_eq!(captures[0].step_mm, None);
        let mut commanded_mm = 0.0;
        for capture in &captures[1..] {
            commanded_mm += capture.step_mm.expect("a step");
            let y_mm = capture.base_from_flange.translation_mm().y;
            assert!((off_centre_mm - y_mm - commanded_mm).abs() < 1e-9, "the steps lead to the poses");
        }
    }
}

#[test]
fn a_single_profile_needs_no_permission_to_move() {
    let cell = FakeCell::new(5.0);
    let task = Task { arming: None, ..task(&cell, Measurement::Profile(None)) };
    let (captures, end) = start(&cell, &task, Deadlines::default()).run();
    assert_eq!((captures.len(), end), (1, RoutineEnd::Done));
    assert_eq!(cell.world().num_moves, 0);
}

#[test]
fn nothing_moves_without_permission_or_beyond_the_limits() {
    let cell = FakeCell::new(5.0);
    let allowed = task(&cell, search());
    let arming = allowed.arming.expect("armed");
    let beyond = MotionLimits { max_move_mm: 10.0, ..arming.limits };
    let fast = MotionLimits { search_speed_mm_s: 200.0, ..arming.limits };
    let far = cell.world().pose.rigid().translation.vector + Vec3::new(500.0, 0.0, 0.0);
    let far = Transform::from_parts(far, cell.world().pose.rotation());
    for refused in [
        Task { arming: None, ..allowed },
        Task { arming: Some(Arming { limits: beyond, ..arming }), ..allowed },
        Task { arming: Some(Arming { limits: fast, ..arming }), ..allowed },
        Task { go_to: Some(far), ..allowed },
    ] {
        let (captures, end) = start(&cell, &refused, Deadlines::default()).run();
        assert!(matches!(end, RoutineEnd::NotAllowed(_)), "{end:?}");
        assert!(captures.is_empty());
    }
    cell.world().readiness = Readiness::NotReady { found: "local mode".to_owned(), remedy: "switch to remote" };
    let (_, end) = start(&cell, &allowed, Deadlines::default()).run();
    assert!(matches!(end, RoutineEnd::NotAllowed(MotionRefusal::NotReady { .. })), "{end:?}");
    assert_eq!(cell.world().num_moves, 0);
}

#[test]
fn it_goes_there_first_and_says_so_where_it_does_not_arrive() {
    let cell = FakeCell::new(5.0);
    let target = Transform::from_parts(Vec3::new(410.0, 5.0, 200.0), cell.world().pose.rotation());
    let going = Task { go_to: Some(target), ..task(&cell, Measurement::Profile(None)) };
    let (captures, end) = start(&cell, &going, Deadlines::default()).run();
    assert_eq!(end, RoutineEnd::Done);
    assert_eq!(captures[0].base_from_flange, target);
    let cell = FakeCell::new(5.0);
    cell.world().fault = Fault::RobotStuck;
    let (captures, end) = start(&cell, &going, Deadlines::default()).run();
    assert!(
        matches!(end, RoutineEnd::Failed { error: DeviceError::NotArrived { .. }, robot_stopped: Some(true) }),
        "{end:?}"
    );
    assert!(captures.is_empty());
}

#[test]
fn each_fault_ends_a_search_in_its_name_with_the_captures_kept_and_the_robot_stopped() {
    let is_failed = |end: &RoutineEnd| matches!(end, RoutineEnd::Failed { .. });
    let check = |fault: Fault, is_expected: &dyn Fn(&RoutineEnd) -> bool, is_told: bool| {
        for num_moves_before_fault in [0, 1, 2, 4] {
            let cell = FakeCell::new(8.0);
            {
                let mut world = cell.world();
                (world.fault, world.num_moves_before_fault) = (fault, num_moves_before_fault);
            }
            let (captures, end) = start(&cell, &task(&cell, search()), short_deadlines()).run();
            let what = format!("{fault:?} from move {num_moves_before_fault} on: {end:?}");
            assert!(is_expected(&end), "{what}");
            // Each move but the last one led to a capture.
            assert!(captures.len() >= num_moves_before_fault as usize, "{what}: {}", captures.len());
            // Where it was sent nowhere, it may be at somebody else's program.
            let world = cell.world();
            assert_eq!(world.num_stops > 0, is_told && world.num_moves > 0, "{what}");
        }
    };
    check(Fault::RobotClosed, &is_failed, false);
    check(Fault::RobotSilent, &is_failed, false);
    check(Fault::RobotPanics, &is_failed, false);
    check(Fault::MoveRefused, &is_failed, true);
    check(Fault::MoveHangs, &is_failed, true);
    check(Fault::SensorClosed, &is_failed, true);
    check(Fault::SensorSilent, &is_failed, true);
    check(Fault::SensorStale, &|end| matches!(end, RoutineEnd::StaleProfiles { .. }), true);
    check(Fault::RobotDrifts, &|end| matches!(end, RoutineEnd::NeverStill { .. }), true);
}

#[test]
fn a_controller_that_says_it_moves_is_believed() {
    let cell = FakeCell::new(5.0);
    cell.world().says_it_moves = true;
    let (captures, end) = start(&cell, &task(&cell, Measurement::Profile(None)), Deadlines::default()).run();
    assert_eq!((captures.len(), end), (0, RoutineEnd::NeverStill { moved_mm: None }));
}

#[test]
fn a_stop_ends_it_at_once_in_the_middle_of_a_move() {
    let cell = FakeCell::new(8.0);
    (cell.world().fault, cell.world().num_moves_before_fault) = (Fault::MoveHangs, 2);
    let mut running = start(&cell, &task(&cell, search()), Deadlines::default());
    while !matches!(running.next(), RoutineEvent::Moving { .. }) || cell.world().num_moves < 2 {}
    running.robot.client().stop();
    running.routine.control().stop();
    let (_, end) = running.run();
    assert_eq!(end, RoutineEnd::Stopped { robot_stopped: Some(true) });
    assert!(cell.world().num_stops > 0);
}

#[test]
fn after_a_stop_nothing_moves_although_the_pose_was_just_asked_for() {
    let cell = FakeCell::new(8.0);
    let target = Transform::from_parts(Vec3::new(410.0, 5.0, 200.0), cell.world().pose.rotation());
    let going = Task { go_to: Some(target), ..task(&cell, search()) };
    let (robot, sensor) = start_workers(&cell, Deadlines::default());
    let clients = (robot.client().of_this_connection(), sensor.client().of_this_connection());
    // The first report after this, asked by whomever: no move goes without one.
    let stopped = robot.client().clone();
    cell.world().during_report = Some(Box::new(move || stopped.stop()));
    let routine = Routine::start(going, clients.0, clients.1, Arc::new(|| {}));
    let (captures, end) = Running { routine, robot, _sensor: sensor }.run();
    assert_eq!(end, RoutineEnd::Stopped { robot_stopped: Some(true) });
    assert_eq!((captures.len(), cell.world().num_moves), (0, 0));
}

#[test]
fn a_pause_holds_the_next_motion_and_a_stop_ends_the_pause() {
    let cell = FakeCell::new(8.0);
    let mut running = start(&cell, &task(&cell, search()), Deadlines::default());
    running.routine.control().pause(true);
    while !matches!(running.next(), RoutineEvent::Searched(_)) {}
    let num_moves = cell.world().num_moves;
    assert!(num_moves <= 1, "at most the one that was checked before the pause: {num_moves}");
    running.routine.control().pause(false);
    while !matches!(running.next(), RoutineEvent::Moving { .. }) {}
    running.routine.control().pause(true);
    running.routine.control().stop();
    let (_, end) = running.run();
    assert!(matches!(end, RoutineEnd::Stopped { .. }), "{end:?}");
}

#[test]
fn what_began_over_one_connection_does_not_go_on_over_the_next() {
    let cell = FakeCell::new(8.0);
    let mut slow = task(&cell, search());
    slow.settle.settle_ms = 1500;
    let running = start(&cell, &slow, short_deadlines());
    // The connection breaks and is made anew while the routine lets the robot settle.
    cell.world().fault = Fault::RobotClosed;
    let deadline = Instant::now() + PATIENCE;
    while running.robot.client().link_state(Instant::now()) == LinkState::Ready {
        assert!(Instant::now() < deadline, "the break is noticed");
    }
    cell.world().fault = Fault::None;
    let (_, end) = running.run();
    assert!(matches!(end, RoutineEnd::Failed { error: DeviceError::Closed { .. }, .. }), "{end:?}");
    assert_eq!(cell.world().num_moves, 0);
}
