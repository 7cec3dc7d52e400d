//! Any robot by the text bridge: against a small server, and against the example of the documentation.

use std::io::{BufRead as _, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use handeye::device::bridge::BridgeConnection;
use handeye::device::bridge::messages::{
    Answer, Ask, BridgePose, BridgedDevice, Hello, Reply, RobotState, VERSION, encode_line, parse_reply, parse_request,
};
use handeye::device::robot::connect;
use handeye::device::{DeviceError, Endpoint, MoveState, Readiness, RobotDriver, RobotKind, RobotSetup};
use handeye::geometry::PoseConvention;

use super::fake::{
    Act, assert_near, expect_error, expect_timeout, finish, line, linear, listen, pose, serve, soon, wait_until,
};

fn setup(endpoint: Endpoint) -> RobotSetup {
    RobotSetup { kind: RobotKind::Bridge, endpoint }
}

/// What a bridge holds.
#[derive(Clone, Debug)]
struct Fake {
    hello: Hello,
    state: Arc<Mutex<RobotState>>,
    heard: Arc<Mutex<Vec<Ask>>>,
    refusal: Option<&'static str>,
    is_dribbling: bool,
}

impl Fake {
    fn new(convention: Option<&str>) -> Self {
        let by_id = convention.and_then(PoseConvention::by_id);
        let mut at = BridgePose::from_pose(&pose([400.0, 10.0, 300.0], [180.0, 0.0, 30.0]), by_id);
        if by_id.is_some() {
            at.quaternion_wxyz = None;
        }
        Self {
            hello: Hello {
                device: BridgedDevice::Robot,
                name: "fake".to_owned(),
                can_move: true,
                resolution_mm: 0.01,
                tool: "TOOL 0".to_owned(),
                convention: convention.map(str::to_owned),
            },
            state: Arc::new(Mutex::new(RobotState {
                pose: at,
                joints_deg: vec![1.0, 2.0],
                is_moving: false,
                not_ready: None,
                move_failed: None,
            })),
            heard: Arc::default(),
            refusal: None,
            is_dribbling: false,
        }
    }

    fn with_state(&self, change: impl FnOnce(&mut RobotState)) {
        change(&mut self.state.lock().unwrap_or_else(PoisonError::into_inner));
    }

    fn respond(&self, line: &[u8]) -> Act {
        let request = parse_request(line).expect("a request");
        self.heard.lock().unwrap_or_else(PoisonError::into_inner).push(request.ask.clone());
        let answer = match request.ask {
            Ask::Hello { .. } => Answer::Hello(self.hello.clone()),
            Ask::State => Answer::State(self.state.lock().unwrap_or_else(PoisonError::into_inner).clone()),
            Ask::Move { .. } if self.refusal.is_some() => {
                Answer::Refused { found: self.refusal.unwrap_or_default().to_owned(), remedy: "do this".to_owned() }
            }
            Ask::Move { .. } => {
                self.with_state(|state| state.is_moving = true);
                Answer::Accepted
            }
            Ask::Stop => {
                self.with_state(|state| state.is_moving = false);
                Answer::Accepted
            }
            Ask::Newest | Ask::Forget => Answer::NoProfile,
        };
        let reply = encode_line(&Reply { bridge: VERSION, id: request.id, answer }).expect("a line").into_bytes();
        if self.is_dribbling { Act::Dribble(reply) } else { Act::Send(reply) }
    }

    fn start(&self) -> Endpoint {
        let (mut listeners, endpoint) = listen(&[0]);
        let fake = self.clone();
        serve(listeners.remove(0), Act::Silence, line, move |line| fake.respond(line));
        endpoint
    }

    fn connect(&self) -> Box<dyn RobotDriver> {
        connect(&setup(self.start()), soon()).expect("a bridge")
    }
}

#[test]
fn a_robot_is_told_and_moved_in_its_own_angles_or_in_quaternions() {
    for (convention, is_dribbling) in [(None, false), (Some("kuka-abc"), false), (Some("kawasaki-oat"), true)] {
        let fake = Fake { is_dribbling, ..Fake::new(convention) };
        let mut robot = fake.connect();
        let report = robot.report(soon()).expect("a state");
        assert_near(&report.base_from_flange, &pose([400.0, 10.0, 300.0], [180.0, 0.0, 30.0]), 1e-9);
        assert_eq!((report.readiness, report.is_moving), (Readiness::Ready, Some(false)));
        assert_eq!((report.tool.as_str(), report.resolution_mm), ("TOOL 0", 0.01));
        assert_eq!(report.joints_deg, [1.0, 2.0]);

        let target = pose([400.0, 10.75, 300.0], [180.0, 0.0, 30.0]);
        robot.start_move(&linear(target, 10.0), soon()).expect("taken");
        assert_eq!(robot.move_state(soon()), Ok(MoveState::Moving));
        let heard = fake.heard.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let Some(Ask::Move { pose: sent, speed_mm_s: 10.0, .. }) =
            heard.iter().find(|ask| matches!(ask, Ask::Move { .. }))
        else {
            panic!("{heard:?}");
        };
        assert!(sent.quaternion_wxyz.is_some());
        assert_eq!(sent.angles_deg.is_some(), convention.is_some());
        let by_angles = BridgePose { quaternion_wxyz: None, ..sent.clone() };
        if let Some(convention) = convention {
            let convention = PoseConvention::by_id(convention);
            assert_near(&by_angles.pose(convention).expect("angles"), &target, 1e-6);
        }
        let arrived = sent.clone();
        fake.with_state(|state| (state.pose, state.is_moving) = (arrived, false));
        finish(&mut *robot).expect("it arrives");
    }
}

#[test]
fn stops_failures_and_refusals_are_told() {
    let target = linear(pose([400.0, 20.0, 300.0], [180.0, 0.0, 30.0]), 10.0);
    let fake = Fake::new(None);
    let mut robot = fake.connect();
    robot.start_move(&target, soon()).expect("taken");
    robot.stop(soon()).expect("it stops");
    assert_eq!(robot.move_state(soon()), Ok(MoveState::Done));

    robot.start_move(&target, soon()).expect("taken");
    fake.with_state(|state| state.is_moving = false);
    let arrived = finish(&mut *robot);
    assert!(matches!(arrived, Err(DeviceError::NotArrived { distance_um: 10_000, .. })), "{arrived:?}");

    robot.start_move(&target, soon()).expect("taken");
    fake.with_state(|state| state.move_failed = Some("joint 5 at its limit".to_owned()));
    let text = finish(&mut *robot).expect_err("failed").to_string();
    assert!(text.contains("joint 5 at its limit"), "{text}");

    fake.with_state(|state| state.not_ready = Some("teach mode".to_owned()));
    let readiness = robot.report(soon()).expect("a state").readiness;
    assert!(matches!(&readiness, Readiness::NotReady { found, .. } if found == "teach mode"), "{readiness:?}");

    let fake = Fake { refusal: Some("out of reach"), ..Fake::new(None) };
    let mut robot = fake.connect();
    let text = robot.start_move(&target, soon()).expect_err("refused").to_string();
    assert!(text.contains("out of reach") && text.contains("do this"), "{text}");
    robot.report(soon()).expect("still connected");

    let mut fake = Fake::new(None);
    fake.hello.can_move = false;
    let mut robot = fake.connect();
    assert_eq!(robot.report(soon()).expect("a state").readiness, Readiness::ReadOnly);
    assert!(matches!(robot.start_move(&target, soon()), Err(DeviceError::CannotMove { .. })));
}

#[test]
fn broken_bridges_end_in_a_named_error_by_the_deadline() {
    let answered = |act: Act| {
        let (mut listeners, endpoint) = listen(&[0]);
        serve(listeners.remove(0), Act::Silence, line, move |_| act.clone());
        move |deadline: Instant| connect(&setup(endpoint), deadline).map(drop)
    };
    let is_unexpected = |error: &DeviceError| matches!(error, DeviceError::Unexpected { .. });
    let hello = "{\"bridge\":1,\"id\":1,\"reply\":\"hello\",\"device\":\"robot\",\"name\":\"x\"}\n";
    for (reply, words) in [
        (hello.replace("\"id\":1", "\"id\":2"), "id 2"),
        (hello.replace("\"bridge\":1", "\"bridge\":2"), "version 2"),
        (hello.replace("robot", "profiler"), "swapped"),
        (hello.replace("\"name\":\"x\"", "\"name\":\"x\",\"convention\":\"klingon\""), "klingon"),
        (hello.replace("\"name\":\"x\"", "\"nom\":\"x\""), "name"),
        ("{\"bridge\":1,\"id\":1,\"reply\":\"accepted\"}\n".to_owned(), "accepted"),
        ("0:success\n".to_owned(), "0:success"),
        ("[".repeat(10_000) + "\n", "text bridge"),
        ("x".repeat(2 * 1024 * 1024), "1048576"),
    ] {
        let text = expect_error(answered(Act::Send(reply.into_bytes())), is_unexpected);
        assert!(text.contains(words) && text.len() < 600, "{text}");
    }
    expect_error(answered(Act::Send(b"\xff\xfe\n".to_vec())), is_unexpected);
    let half = hello.as_bytes()[..20].to_vec();
    expect_timeout(answered(Act::Silence));
    expect_timeout(answered(Act::Send(half.clone())));
    expect_error(answered(Act::SendAndClose(half)), |error| matches!(error, DeviceError::Closed { .. }));
    let refused = "{\"bridge\":1,\"id\":1,\"reply\":\"refused\",\"found\":\"no\"}\n".as_bytes().to_vec();
    expect_error(answered(Act::Send(refused)), |error| matches!(error, DeviceError::Refused { .. }));
}

#[test]
fn poses_that_are_none_are_refused() {
    let good = BridgePose { position_mm: [1.0; 3], quaternion_wxyz: Some([1.0, 0.0, 0.0, 0.0]), angles_deg: None };
    assert!(good.pose(None).is_ok());
    for quaternion in [[0.0; 4], [2.0, 0.0, 0.0, 0.0], [f64::NAN; 4], [f64::INFINITY, 0.0, 0.0, 0.0]] {
        assert!(BridgePose { quaternion_wxyz: Some(quaternion), ..good.clone() }.pose(None).is_err());
    }
    assert!(BridgePose { position_mm: [1e9, 0.0, 0.0], ..good.clone() }.pose(None).is_err());
    let angles = BridgePose { quaternion_wxyz: None, angles_deg: Some([1.0; 3]), ..good };
    assert!(angles.pose(None).is_err(), "angles mean nothing without a convention");
    assert!(angles.pose(PoseConvention::by_id("kuka-abc")).is_ok());
}

#[test]
fn every_message_of_the_documentation_is_one() {
    let page = include_str!("../../docs/bridge.md");
    let mut num_messages = 0;
    for line in page.split("```json\n").skip(1).filter_map(|part| part.split("```").next()).flat_map(str::lines) {
        let again = if line.contains("\"request\"") {
            encode_line(&parse_request(line.as_bytes()).expect(line))
        } else {
            encode_line(&parse_reply(line.as_bytes()).expect(line))
        };
        let again: serde_json::Value = serde_json::from_str(&again.expect("short")).expect("JSON");
        let line: serde_json::Value = serde_json::from_str(line).expect("JSON");
        let (Some(line), Some(again)) = (line.as_object(), again.as_object()) else { panic!("{line}") };
        for (name, value) in line {
            assert_eq!(again.get(name), Some(value), "{name} is lost");
        }
        num_messages += 1;
    }
    assert!(num_messages >= 15, "{num_messages} messages");
}

/// The example as a process of its own; ends with the test.
struct Example {
    process: Child,
    endpoints: [Endpoint; 2],
}

impl Example {
    /// `None` where there is no Python.
    fn start() -> Option<Self> {
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/bridge_example.py");
        let started =
            Command::new("python3").arg(script).args(["0", "0"]).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn();
        let mut process = match started {
            Ok(process) => process,
            Err(error) => {
                println!("skipped: no python3 to run the example bridge with ({error})");
                return None;
            }
        };
        let mut lines = BufReader::new(process.stdout.take().expect("piped")).lines();
        let endpoints = ["robot", "profiler"].map(|device| {
            let line = lines.next().expect("a line for each device").expect("text");
            let port = line.strip_prefix(device).and_then(|rest| rest.rsplit(':').next());
            Endpoint { host: "127.0.0.1".to_owned(), port: port.and_then(|port| port.parse().ok()).expect("a port") }
        });
        Some(Self { process, endpoints })
    }
}

impl Drop for Example {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

#[test]
fn the_example_of_the_documentation_is_a_robot_and_a_profiler() {
    let Some(example) = Example::start() else { return };
    let [robot_at, profiler_at] = example.endpoints.clone();
    let mut robot = connect(&setup(robot_at.clone()), soon()).expect("the robot");
    let start = robot.report(soon()).expect("a state").base_from_flange;
    let moved = |by_mm: [f64; 3]| {
        let position = start.translation_mm() + handeye::geometry::Vec3::from(by_mm);
        handeye::geometry::Transform::from_parts(position, start.rotation())
    };
    robot.start_move(&linear(moved([0.0, 3.0, 0.0]), 1000.0), soon()).expect("taken");
    finish(&mut *robot).expect("it arrives");
    assert_near(&robot.report(soon()).expect("a state").base_from_flange, &moved([0.0, 3.0, 0.0]), 1e-9);

    // Slow enough not to end before it is stopped.
    robot.start_move(&linear(moved([0.0, 300.0, 0.0]), 1.0), soon()).expect("taken");
    assert_eq!(robot.move_state(soon()), Ok(MoveState::Moving));
    robot.stop(soon()).expect("it stops");
    robot.start_move(&linear(moved([0.0; 3]), 1000.0), soon()).expect("taken");
    finish(&mut *robot).expect("it arrives");
    let refused = robot.start_move(&linear(moved([2000.0, 0.0, 0.0]), 10.0), soon());
    assert!(matches!(refused, Err(DeviceError::Refused { .. })), "{refused:?}");

    // A robot whose connection ends has to stop by itself.
    robot.start_move(&linear(moved([0.0, 300.0, 0.0]), 1.0), soon()).expect("taken");
    drop(robot);
    let mut robot = connect(&setup(robot_at), soon()).expect("the robot");
    wait_until(|| robot.report(soon()).expect("a state").is_moving == Some(false));
    robot.start_move(&linear(moved([0.0; 3]), 1000.0), soon()).expect("taken");
    finish(&mut *robot).expect("it arrives");

    let (mut profiler, hello) =
        BridgeConnection::connect("Profiler", BridgedDevice::Profiler, &profiler_at, soon()).expect("the profiler");
    assert_eq!(hello.name, "pretend profiler");
    let mut counts = Vec::new();
    for _ in 0..2 {
        assert_eq!(profiler.ask(&Ask::Forget, soon()), Ok(Answer::Accepted));
        let Answer::Profile(profile) = profiler.ask(&Ask::Newest, soon()).expect("an answer") else {
            panic!("no profile")
        };
        counts.push(profile.trigger_count);
        // Right above the middle of the ball: the section is a great circle around the origin.
        let profile = profile.profile().expect("a profile");
        let off_mm = profile.valid_points().map(|(_, x, z)| (x.hypot(z) - 12.7).abs()).fold(0.0, f64::max);
        assert!(profile.valid_points().count() > 400 && off_mm < 1e-3, "{off_mm} mm");
    }
    assert_eq!(counts, [1, 2]);
}
