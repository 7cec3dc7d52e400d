//! FANUC by MAPPDK.

use std::sync::{Arc, Mutex, PoisonError};

use handeye::device::robot::connect;
use handeye::device::robot::mappdk::messages::{Command, Reply, Xyzwpr, encode_position};
use handeye::device::{DeviceError, Endpoint, MoveState, Readiness, RobotDriver, RobotKind, RobotSetup};

use super::fake::{
    Act, Gate, assert_near, expect_error, expect_timeout, finish, line, linear, listen, pose, serve, soon,
};

/// Three decimals, times the square root of three.
const WIRE_MM: f64 = 0.001;

/// What a server holds, and what it heard.
#[derive(Clone, Debug)]
struct Fake {
    at: Arc<Mutex<Xyzwpr>>,
    heard: Arc<Mutex<Vec<String>>>,
    gate: Gate,
    /// What a move answers instead of success; it does not move then.
    refusal: Option<&'static str>,
    is_stuck: bool,
    is_dribbling: bool,
}

impl Fake {
    fn new(at: [f64; 6]) -> Self {
        Self {
            at: Arc::new(Mutex::new(Xyzwpr(at))),
            heard: Arc::default(),
            gate: Gate::default(),
            refusal: None,
            is_stuck: false,
            is_dribbling: false,
        }
    }

    fn respond(&self, line: &[u8]) -> Act {
        let line = String::from_utf8_lossy(line).into_owned();
        self.heard.lock().unwrap_or_else(PoisonError::into_inner).push(line.clone());
        let reply = match Command::parse(&line).expect("a command") {
            Command::CurPos => Reply::ok(encode_position(&self.at.lock().unwrap_or_else(PoisonError::into_inner))),
            Command::MoveP(_) if self.refusal.is_some() => Reply::error(self.refusal.unwrap_or_default()),
            Command::MoveP(motion) => {
                self.gate.pass();
                if !self.is_stuck {
                    let values = motion.values.try_into().expect("six values");
                    *self.at.lock().unwrap_or_else(PoisonError::into_inner) = Xyzwpr(values);
                }
                Reply::ok("success")
            }
            _ => Reply::error("wrong-command"),
        };
        let bytes = reply.encode().into_bytes();
        if self.is_dribbling { Act::Dribble(bytes) } else { Act::Send(bytes) }
    }

    /// Serves, with the second port or without it.
    fn start(&self, has_second: bool) -> Endpoint {
        let (listeners, endpoint) = listen(&[0, 1]);
        for (idx, listener) in listeners.into_iter().enumerate() {
            let fake = self.clone();
            // A port that is held and hangs up: left free, another test's server might take it.
            let greets = idx == 0 || has_second;
            let greeting = if greets { Act::Send(b"0:success".to_vec()) } else { Act::SendAndClose(Vec::new()) };
            serve(listener, greeting, line, move |line| fake.respond(line));
        }
        endpoint
    }

    fn moves_heard(&self) -> Vec<String> {
        let heard = self.heard.lock().unwrap_or_else(PoisonError::into_inner);
        heard.iter().filter(|line| line.starts_with("movep")).cloned().collect()
    }
}

fn setup(endpoint: Endpoint) -> RobotSetup {
    RobotSetup { kind: RobotKind::FanucMappdk, endpoint }
}

fn robot_at(endpoint: Endpoint) -> Box<dyn RobotDriver> {
    connect(&setup(endpoint), soon()).expect("a server")
}

/// Connects to a server that answers every command with this act.
fn connect_to(greeting: Act, act: Act) -> impl FnOnce(std::time::Instant) -> Result<(), DeviceError> {
    let (mut listeners, endpoint) = listen(&[0]);
    serve(listeners.remove(0), greeting, line, move |_| act.clone());
    move |deadline| connect(&setup(endpoint), deadline).map(drop)
}

#[test]
fn a_step_is_sent_in_the_servers_columns_and_read_back() {
    for is_dribbling in [false, true] {
        let fake = Fake { is_dribbling, ..Fake::new([560.0, -110.25, -140.5, 179.9, -0.06, 30.5]) };
        fake.gate.open(1);
        let mut robot = robot_at(fake.start(true));
        let target = pose([560.0, -109.75, -140.5], [179.9, -0.06, 30.5]);
        robot.start_move(&linear(target, 20.9), soon()).expect("taken");
        finish(&mut *robot).expect("it arrives");
        let golden = "movep:0020:0050:000:1:6:+000560.000000:-000109.750000:-000140.500000:+000179.900000:-000000.060000:+000030.500000\n";
        assert_eq!(fake.moves_heard(), [golden]);
        let report = robot.report(soon()).expect("a pose");
        assert_near(&report.base_from_flange, &target, WIRE_MM);
        assert_eq!((report.readiness, report.is_moving), (Readiness::Unknown, None));
        assert_eq!(report.tool, "UTOOL 8 in UFRAME 8");
    }
}

#[test]
fn the_pose_is_told_while_a_move_is_under_way() {
    for has_second in [true, false] {
        let fake = Fake::new([500.0, 0.0, 300.0, 180.0, 0.0, 0.0]);
        let mut robot = robot_at(fake.start(has_second));
        robot.start_move(&linear(pose([500.0, 30.0, 300.0], [180.0, 0.0, 0.0]), 20.0), soon()).expect("taken");
        assert_eq!(robot.move_state(soon()), Ok(MoveState::Moving));
        *fake.at.lock().unwrap_or_else(PoisonError::into_inner) = Xyzwpr([500.0, 5.0, 300.0, 180.0, 0.0, 0.0]);
        let report = robot.report(soon()).expect("a pose");
        assert_eq!(report.is_moving, Some(true));
        assert_eq!(report.tool.contains("no pose during moves"), !has_second);
        let y_mm = if has_second { 5.0 } else { 0.0 };
        assert_near(&report.base_from_flange, &pose([500.0, y_mm, 300.0], [180.0, 0.0, 0.0]), WIRE_MM);
        fake.gate.open(3);
        finish(&mut *robot).expect("it arrives");
        assert_eq!(fake.moves_heard().len(), 3, "30 mm at 20 mm/s in pieces of half a second");
        let arrived = robot.report(soon()).expect("a pose").base_from_flange;
        assert_near(&arrived, &pose([500.0, 30.0, 300.0], [180.0, 0.0, 0.0]), WIRE_MM);
    }
}

#[test]
fn after_a_stop_no_further_piece_is_sent() {
    let fake = Fake::new([500.0, 0.0, 300.0, 180.0, 0.0, 0.0]);
    let mut robot = robot_at(fake.start(true));
    robot.start_move(&linear(pose([500.0, 100.0, 300.0], [180.0, 0.0, 0.0]), 20.0), soon()).expect("taken");
    let busy = robot.start_move(&linear(pose([500.0, 1.0, 300.0], [180.0, 0.0, 0.0]), 20.0), soon());
    assert!(matches!(busy, Err(DeviceError::NotReady { .. })), "{busy:?}");
    expect_timeout(|deadline| robot.stop(deadline));
    fake.gate.open(1);
    robot.stop(soon()).expect("the piece ends");
    assert_eq!(robot.move_state(soon()), Ok(MoveState::Done));
    assert_eq!(fake.moves_heard().len(), 1);
    robot.stop(soon()).expect("standing already");
    let at = robot.report(soon()).expect("a pose").base_from_flange;
    assert_near(&at, &pose([500.0, 10.0, 300.0], [180.0, 0.0, 0.0]), WIRE_MM);
}

#[test]
fn a_robot_that_did_not_go_is_found_out() {
    let fake = Fake { is_stuck: true, ..Fake::new([500.0, 0.0, 300.0, 180.0, 0.0, 0.0]) };
    fake.gate.open(2);
    let mut robot = robot_at(fake.start(true));
    robot.start_move(&linear(pose([500.0, 2.0, 300.0], [180.0, 0.0, 0.0]), 20.0), soon()).expect("taken");
    let arrived = finish(&mut *robot);
    assert!(matches!(arrived, Err(DeviceError::NotArrived { distance_um: 2000, turn_mdeg: 0, .. })), "{arrived:?}");
    robot.start_move(&linear(pose([500.0, 0.0, 300.0], [180.0, 0.0, 2.0]), 20.0), soon()).expect("taken");
    let arrived = finish(&mut *robot);
    assert!(matches!(arrived, Err(DeviceError::NotArrived { distance_um: 0, turn_mdeg: 2000, .. })), "{arrived:?}");
}

#[test]
fn refusals_say_what_to_do_and_leave_the_connection_usable() {
    for (message, remedy) in [
        ("position-is-not-reachable", "nearer to the robot"),
        ("PR[81]-was-not-set", "position register 81"),
        ("R[82]-was-not-set", "registers 81 to 83"),
        ("cannot-convert-joint-vals", "axes"),
        ("something-new", "teach pendant"),
    ] {
        let fake = Fake { refusal: Some(message), ..Fake::new([500.0, 0.0, 300.0, 180.0, 0.0, 0.0]) };
        let mut robot = robot_at(fake.start(true));
        robot.start_move(&linear(pose([500.0, 2.0, 300.0], [180.0, 0.0, 0.0]), 20.0), soon()).expect("taken");
        let text = finish(&mut *robot).expect_err("refused").to_string();
        assert!(text.contains(message) && text.contains(remedy), "{text}");
        robot.report(soon()).expect("still connected");
        assert_eq!(robot.move_state(soon()), Ok(MoveState::Done));
    }
}

#[test]
fn broken_servers_end_in_a_named_error_by_the_deadline() {
    let success = || Act::Send(b"0:success".to_vec());
    let is_unexpected = |error: &DeviceError| matches!(error, DeviceError::Unexpected { .. });
    let is_closed = |error: &DeviceError| matches!(error, DeviceError::Closed { .. });
    expect_timeout(connect_to(Act::Silence, Act::Silence));
    expect_timeout(connect_to(Act::Send(b"0:succ".to_vec()), Act::Silence));
    expect_error(connect_to(Act::SendAndClose(Vec::new()), Act::Silence), is_closed);
    expect_error(connect_to(Act::SendAndClose(b"0:success".to_vec()), Act::Silence), is_closed);
    expect_error(connect_to(Act::Send(b"HTTP/1.0 400 Bad Request\r\n".to_vec()), Act::Silence), is_unexpected);
    expect_timeout(connect_to(success(), Act::Silence));
    expect_timeout(connect_to(success(), Act::Send(b"0:x=1.000,y=".to_vec())));
    expect_error(connect_to(success(), Act::SendAndClose(b"0:x=1.000,y=".to_vec())), is_closed);
    expect_error(connect_to(success(), Act::Send(b"\x00\x00\x01".to_vec())), is_unexpected);
    expect_error(connect_to(success(), Act::Send(vec![b'0'; 300])), is_unexpected);
    expect_error(connect_to(success(), Act::Send(b"0:a=1,b=1,c=1,d=1,e=1,f=1.000".to_vec())), is_unexpected);
    let refused = Act::Send(b"1:wrong-command".to_vec());
    expect_error(connect_to(success(), refused), |error| matches!(error, DeviceError::Refused { .. }));
}
