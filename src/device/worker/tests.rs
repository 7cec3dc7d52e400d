//! Workers over drivers in memory: answers, stops, breaks, reconnects, ends.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use super::*;
use crate::device::driver::LinearMove;
use crate::device::fake::{FakeCell, Fault, RADIUS_MM, short_deadlines};
use crate::device::link::LinkState;
use crate::fit::{ArcOptions, Sought};
use crate::geometry::Vec3;

/// Long past anything that is waited for here, on a slow machine as well.
const PATIENCE: Duration = Duration::from_secs(20);

#[track_caller]
fn wait_until(what: &str, mut is_so: impl FnMut() -> bool) {
    let deadline = Instant::now() + PATIENCE;
    while !is_so() {
        assert!(Instant::now() < deadline, "waited in vain: {what}");
        std::thread::sleep(Duration::from_millis(2));
    }
}

fn is_ready(robot: &RobotWorker) -> bool {
    robot.client().link_state(Instant::now()) == LinkState::Ready
}

fn motion(cell: &FakeCell) -> LinearMove {
    let mut target = *cell.world().pose.rigid();
    target.translation.vector += Vec3::new(0.0, 5.0, 0.0);
    LinearMove {
        base_from_flange: crate::geometry::Transform::from_rigid(target),
        speed_mm_s: 10.0,
        rotation_speed_deg_s: 10.0,
    }
}

fn patient() -> Deadlines {
    Deadlines { request: PATIENCE, stop: PATIENCE, ..Deadlines::default() }
}

#[test]
fn a_move_ends_where_it_was_sent_and_the_pose_is_seen() {
    let cell = FakeCell::new(5.0);
    cell.world().polls_a_move = 5;
    let (robot, _sensor) = cell.start(patient());
    wait_until("the connection", || is_ready(&robot));
    let motion = motion(&cell);
    let target = motion.base_from_flange;
    robot.client().move_to(motion, PATIENCE).expect("moved");
    assert_eq!(robot.client().report().expect("a report").base_from_flange, target);
    assert_eq!(robot.client().latest().expect("seen").base_from_flange, target);
    assert!(robot.client().take_news());
}

#[test]
fn a_stop_does_not_wait_for_the_move() {
    let cell = FakeCell::new(5.0);
    cell.world().fault = Fault::MoveHangs;
    let (robot, _sensor) = cell.start(patient());
    wait_until("the connection", || is_ready(&robot));
    let client = robot.client().clone();
    let motion = motion(&cell);
    let mover = std::thread::spawn(move || client.move_to(motion, PATIENCE));
    wait_until("the move", || cell.world().target.is_some());
    assert_eq!(robot.client().stop_and_wait(), Some(true));
    assert_eq!(mover.join().expect("no panic"), Err(DeviceError::Stopped { device: "Robot" }));
    assert_eq!(cell.world().num_stops, 1);
    assert!(is_ready(&robot), "a stop breaks no connection");
}

#[test]
fn a_move_beyond_its_time_is_an_error_and_the_connection_stays() {
    let cell = FakeCell::new(5.0);
    cell.world().fault = Fault::MoveHangs;
    let (robot, _sensor) = cell.start(patient());
    wait_until("the connection", || is_ready(&robot));
    let outcome = robot.client().move_to(motion(&cell), Duration::from_millis(50));
    assert!(matches!(outcome, Err(DeviceError::Timeout { .. })), "{outcome:?}");
    assert!(is_ready(&robot));
    assert_eq!(robot.client().stop_and_wait(), Some(true));
}

#[test]
fn a_refusal_is_answered_and_breaks_nothing() {
    let cell = FakeCell::new(5.0);
    cell.world().fault = Fault::MoveRefused;
    let (robot, _sensor) = cell.start(patient());
    wait_until("the connection", || is_ready(&robot));
    let outcome = robot.client().move_to(motion(&cell), PATIENCE);
    assert!(matches!(outcome, Err(DeviceError::Refused { .. })), "{outcome:?}");
    assert!(is_ready(&robot));
}

#[test]
fn a_broken_connection_is_told_made_anew_and_is_another_one() {
    for fault in [Fault::RobotClosed, Fault::RobotSilent, Fault::RobotPanics] {
        let cell = FakeCell::new(5.0);
        let (robot, _sensor) = cell.start(short_deadlines());
        wait_until("the connection", || is_ready(&robot));
        let of_first = robot.client().of_this_connection();
        cell.world().fault = fault;
        wait_until("the break", || matches!(robot.client().link_state(Instant::now()), LinkState::Failed { .. }));
        assert!(robot.client().report().is_err(), "{fault:?}");
        cell.world().fault = Fault::None;
        wait_until("the reconnection", || is_ready(&robot));
        assert!(robot.client().report().is_ok());
        let outcome = of_first.report();
        assert!(matches!(outcome, Err(DeviceError::Closed { .. })), "{fault:?}: {outcome:?}");
    }
}

#[test]
fn a_move_that_broke_off_is_stopped_first_over_the_next_connection() {
    let cell = FakeCell::new(5.0);
    let (robot, _sensor) = cell.start(short_deadlines());
    wait_until("the connection", || is_ready(&robot));
    cell.world().fault = Fault::RobotClosed;
    let outcome = robot.client().move_to(motion(&cell), PATIENCE);
    assert!(outcome.is_err());
    assert_eq!(robot.client().stop_and_wait(), None, "nobody could be told");
    assert_eq!(cell.world().num_stops, 0);
    cell.world().fault = Fault::None;
    wait_until("the stop", || cell.world().num_stops == 1);
}

#[test]
fn without_a_connection_requests_are_refused_at_once_and_attempts_go_on() {
    let cell = FakeCell::new(5.0);
    cell.world().fault = Fault::NoConnection;
    let (robot, _sensor) = cell.start(short_deadlines());
    let failed = || matches!(robot.client().link_state(Instant::now()), LinkState::Failed { retry_in: Some(_), .. });
    wait_until("the failure", failed);
    assert!(matches!(robot.client().report(), Err(DeviceError::NotConnected { .. } | DeviceError::NotReady { .. })));
    // Both workers try, and try again.
    wait_until("further attempts", || cell.world().num_connections > 3);
}

#[test]
fn a_dropped_worker_ends_without_hanging_and_stops_what_moves() {
    for (fault, deadlines) in
        [(Fault::None, patient()), (Fault::NoConnection, patient()), (Fault::RobotSilent, short_deadlines())]
    {
        let cell = FakeCell::new(5.0);
        cell.world().fault = fault;
        let workers = cell.start(deadlines);
        wait_until("an attempt", || cell.world().num_connections >= 2);
        let start = Instant::now();
        drop(workers);
        assert!(start.elapsed() < PATIENCE, "{fault:?}");
    }
    let cell = FakeCell::new(5.0);
    cell.world().fault = Fault::MoveHangs;
    let (robot, sensor) = cell.start(patient());
    wait_until("the connection", || is_ready(&robot));
    let (client, motion) = (robot.client().clone(), motion(&cell));
    let stopped = client.clone();
    let mover = std::thread::spawn(move || client.move_to(motion, PATIENCE));
    wait_until("the move", || cell.world().target.is_some());
    // The driver takes its time as the end comes.
    let (sender, is_at_it) = std::sync::mpsc::channel();
    cell.world().during_report = Some(Box::new(move || {
        sender.send(()).ok();
        std::thread::sleep(Duration::from_millis(800));
    }));
    is_at_it.recv_timeout(PATIENCE).expect("a look within the move");
    drop((robot, sensor));
    assert_eq!(cell.world().num_stops, 1, "the program may end now");
    assert!(mover.join().expect("no panic").is_err());
    let start = Instant::now();
    assert_eq!(stopped.stop_and_wait(), Some(true));
    assert!(start.elapsed() < PATIENCE, "there is nobody to wait for");
}

#[test]
fn a_stop_that_is_refused_stays_owed_and_is_told() {
    let cell = FakeCell::new(5.0);
    cell.world().fault = Fault::MoveHangs;
    let (robot, _sensor) = cell.start(patient());
    wait_until("the connection", || is_ready(&robot));
    let (client, motion) = (robot.client().clone(), motion(&cell));
    let mover = std::thread::spawn(move || client.move_to(motion, PATIENCE));
    wait_until("the move", || cell.world().target.is_some());
    cell.world().takes_stop = false;
    assert_eq!(robot.client().stop_and_wait(), Some(false));
    assert_eq!(mover.join().expect("no panic"), Err(DeviceError::Stopped { device: "Robot" }));
    let is_refused = |error: &DeviceError| matches!(error, DeviceError::Refused { .. });
    wait_until("the reason", || match robot.client().link_state(Instant::now()) {
        LinkState::Failed { error, .. } => is_refused(&error),
        _ => false,
    });
    let outcome = robot.client().move_to(self::motion(&cell), PATIENCE);
    assert!(outcome.as_ref().is_err_and(is_refused), "nothing moves before the stop is taken: {outcome:?}");
    cell.world().takes_stop = true;
    wait_until("the stop", || is_ready(&robot));
    let world = cell.world();
    assert_eq!((world.num_stops, world.num_moves, world.target), (1, 1, None));
}

#[test]
fn what_only_reads_needs_no_stop() {
    let cell = FakeCell::new(5.0);
    cell.world().is_read_only = true;
    let (robot, _sensor) = cell.start(patient());
    wait_until("the connection", || is_ready(&robot));
    assert_eq!(robot.client().stop_and_wait(), Some(true));
}

#[test]
fn a_device_that_refuses_to_show_itself_is_told_and_shows_nothing_old() {
    let cell = FakeCell::new(5.0);
    let (robot, sensor) = cell.start(patient());
    let (robot, sensor) = (robot.client(), sensor.client());
    let states = || [robot.link_state(Instant::now()), sensor.link_state(Instant::now())];
    let shown = || (robot.latest().is_some(), sensor.live().is_some());
    wait_until("both", || shown() == (true, true));
    cell.world().fault = Fault::LooksRefused;
    let is_refused = |state: &LinkState| matches!(state, LinkState::Failed { error: DeviceError::Refused { .. }, .. });
    wait_until("the reasons", || states().iter().all(is_refused));
    assert_eq!(shown(), (false, false));
    assert!(robot.has_connection(1), "it is no break");
    cell.world().fault = Fault::None;
    wait_until("both again", || shown() == (true, true) && states() == [LinkState::Ready, LinkState::Ready]);
    assert!(robot.has_connection(1));
}

#[test]
fn what_was_seen_over_one_connection_is_not_shown_over_the_next() {
    let cell = FakeCell::new(5.0);
    let (robot, _sensor) = cell.start(short_deadlines());
    wait_until("a pose", || robot.client().latest().is_some());
    cell.world().fault = Fault::RobotClosed;
    wait_until("the break", || !is_ready(&robot));
    let client = robot.client().clone();
    let (sender, seen) = std::sync::mpsc::channel();
    {
        let mut world = cell.world();
        world.during_report = Some(Box::new(move || {
            sender.send(client.latest()).ok();
        }));
        world.fault = Fault::None;
    }
    assert_eq!(seen.recv_timeout(PATIENCE), Ok(None), "as the first look over the next one begins");
}

#[test]
fn the_live_profile_comes_with_its_arc_and_its_rate() {
    let cell = FakeCell::new(5.0);
    let (_robot, sensor) = cell.start(patient());
    let ball = ArcOptions { ball_radius_mm: RADIUS_MM, profile_std_mm: None };
    sensor.client().look_for(Some(Sought::Arc(ball)));
    wait_until("profiles", || sensor.client().live().is_some_and(|live| live.rate_hz > 0.0 && live.found.is_ok()));
    let live = sensor.client().live().expect("live");
    let radius_mm = live.found.expect("an arc").arc().expect("of the ball").circle.radius_mm;
    // 5 mm off the centre of a ball of 15 mm, with noise of 0.005 mm.
    assert!((radius_mm - 200.0_f64.sqrt()).abs() < 0.05, "{radius_mm}");
    sensor.client().look_for(None);
    assert!(sensor.client().live().expect("live").found.is_err());
}

#[test]
fn who_does_not_look_is_not_woken_again_and_again() {
    let num_wakes = Arc::new(AtomicUsize::new(0));
    let counted = Arc::clone(&num_wakes);
    let wake: Wake = Arc::new(move || {
        counted.fetch_add(1, Ordering::Relaxed);
    });
    let post: Post<()> = Post::new("Test", Deadlines::default(), wake);
    for _ in 0..5 {
        post.tell();
    }
    assert_eq!(num_wakes.load(Ordering::Relaxed), 1);
    assert!(post.take_news());
    assert!(!post.take_news());
    post.tell();
    assert_eq!(num_wakes.load(Ordering::Relaxed), 2);
}
