//! Universal Robots by RTDE, scripts and the dashboard.

use std::io::{Read as _, Write as _};
use std::net::{TcpListener, TcpStream};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use handeye::device::robot::connect;
use handeye::device::robot::ur::dashboard::{GREETING, Question, encode_remote_control};
use handeye::device::robot::ur::rtde::{self, ClientPacket, NOT_FOUND, ServerPacket, TextMessage, Value};
use handeye::device::robot::ur::script::{Program, Statement, UrPose};
use handeye::device::{DeviceError, Endpoint, MoveState, Readiness, RobotDriver, RobotKind, RobotSetup};
use handeye::geometry::{Base, Flange, Tcp, Transform, Vec3};

use super::fake::{
    Act, assert_near, expect_error, expect_timeout, finish, line, linear, listen, pose, serve, soon, wait_until,
};

/// The tool point lies 100 mm ahead of the flange and is turned.
const OFFSET: UrPose = UrPose([0.01, -0.02, 0.1, 0.0, 0.3, 0.0]);

/// What a controller holds.
#[derive(Clone, Debug)]
#[expect(clippy::struct_excessive_bools, reason = "independent faults, any of which may be on")]
struct State {
    base_from_flange: Transform<Base, Flange>,
    /// The active tool point.
    offset: UrPose,
    knows_offset: bool,
    /// What the dashboard answers; `None`: it does not know the question.
    is_remote: Option<bool>,
    ignores_programs: bool,
    /// The interface for scripts closes the connection once it has a move.
    hangs_up_after_move: bool,
    /// Nothing but texts are streamed, as many as the connection takes.
    is_flooding: bool,
    is_dashboard_silent: bool,
    robot_mode: i32,
    safety_mode: i32,
    program: Option<Program>,
    mark: i32,
    heard: Vec<Program>,
}

impl State {
    fn flange_from_tcp(&self) -> Transform<Flange, Tcp> {
        Transform::from_rigid(*self.offset.pose().rigid())
    }

    fn perform(&mut self, statement: Statement) {
        match statement {
            Statement::MoveL { pose, .. } => self.base_from_flange = pose.pose() * self.flange_from_tcp().inverse(),
            Statement::SetTcp { offset } => self.offset = offset,
            Statement::WriteOutputInteger { register: 24, value } => self.mark = value,
            Statement::StopL { .. } | Statement::Sync => {}
            other => panic!("{other:?}"),
        }
    }
}

#[derive(Clone, Debug)]
struct Fake(Arc<Mutex<State>>);

impl Fake {
    fn new(base_from_flange: Transform<Base, Flange>) -> Self {
        Self(Arc::new(Mutex::new(State {
            base_from_flange,
            offset: OFFSET,
            knows_offset: true,
            is_remote: Some(true),
            ignores_programs: false,
            hangs_up_after_move: false,
            is_flooding: false,
            is_dashboard_silent: false,
            robot_mode: 7,
            safety_mode: 1,
            program: None,
            mark: 41,
            heard: Vec::new(),
        })))
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn start(&self) -> Endpoint {
        let (listeners, endpoint) = listen(&[0, -2, -5]);
        let [stream, script, dashboard] = <[TcpListener; 3]>::try_from(listeners).expect("three ports");
        let fake = self.clone();
        thread::spawn(move || {
            for stream in stream.incoming().flatten() {
                let fake = fake.clone();
                thread::spawn(move || fake.serve_rtde(stream));
            }
        });
        let fake = self.clone();
        let len = |bytes: &[u8]| Program::len_of_first(bytes).expect("a program");
        // The interfaces for scripts tell their states to whoever connects.
        serve(script, Act::Send(vec![0; 2000]), len, move |text| fake.run(text));
        let fake = self.clone();
        let greeting = Act::Send(format!("{GREETING}\n").into_bytes());
        serve(dashboard, greeting, line, move |line| {
            assert_eq!(Question::parse(&String::from_utf8_lossy(line)), Question::IsInRemoteControl);
            if fake.state().is_dashboard_silent {
                return Act::Silence;
            }
            let unknown = "could not understand: 'is in remote control'\n".to_owned();
            Act::Send(fake.state().is_remote.map_or(unknown, encode_remote_control).into_bytes())
        });
        endpoint
    }

    fn run(&self, text: &[u8]) -> Act {
        let program = Program::parse(&String::from_utf8_lossy(text)).expect("a program");
        let mut state = self.state();
        state.heard.push(program.clone());
        if state.ignores_programs {
            return Act::Silence;
        }
        state.program = None;
        let mut statements = program.statements.into_iter();
        for statement in statements.by_ref() {
            if let Statement::MoveL { .. } = statement {
                let rest = [statement].into_iter().chain(statements).collect();
                state.program = Some(Program { name: program.name, statements: rest });
                break;
            }
            state.perform(statement);
        }
        if state.hangs_up_after_move && state.program.is_some() {
            return Act::SendAndClose(Vec::new());
        }
        Act::Silence
    }

    /// Ends the program under way: at its target, or where it is.
    fn end_program(&self, does_arrive: bool) {
        wait_until(|| self.state().program.is_some());
        let mut state = self.state();
        let program = state.program.take().expect("a program");
        program.statements.into_iter().filter(|_| does_arrive).for_each(|statement| state.perform(statement));
    }

    fn serve_rtde(&self, mut stream: TcpStream) {
        let mut received = Vec::new();
        let mut chunk = [0; 4096];
        let mut names = Vec::new();
        loop {
            while let Some(len) = rtde::packet_len(&received).expect("a packet") {
                let packet: Vec<u8> = received.drain(..len).collect();
                let answer = match ClientPacket::parse(&packet).expect("a packet") {
                    ClientPacket::RequestVersion(version) => ServerPacket::VersionAccepted(version == 2),
                    ClientPacket::SetupOutputs { names: asked, .. } => {
                        let types: Vec<String> =
                            asked.iter().map(|name| self.value(name).map_or(NOT_FOUND, type_name).to_owned()).collect();
                        let is_known = types.iter().all(|name| name != NOT_FOUND);
                        names = asked;
                        ServerPacket::OutputTypes { recipe_id: if is_known { 3 } else { 0 }, types }
                    }
                    ClientPacket::Start => ServerPacket::Started(true),
                    other => panic!("{other:?}"),
                };
                let has_started = answer == ServerPacket::Started(true);
                if stream.write_all(&answer.encode()).is_err() {
                    return;
                }
                if has_started {
                    return self.stream(stream, &names);
                }
            }
            match stream.read(&mut chunk) {
                Ok(num) if num > 0 => received.extend_from_slice(&chunk[..num]),
                _ => return,
            }
        }
    }

    fn stream(&self, mut stream: TcpStream, names: &[String]) {
        loop {
            let values: Vec<Value> = names.iter().filter_map(|name| self.value(name)).collect();
            let packet = ServerPacket::Data { recipe_id: 3, values: rtde::encode_values(&values) };
            let text = TextMessage { text: "hello".to_owned(), source: "test".to_owned(), level: 3 };
            let text = ServerPacket::Message(text).encode();
            let is_flooding = self.state().is_flooding;
            let bytes = if is_flooding { text.repeat(4096) } else { [packet.encode(), text].concat() };
            if stream.write_all(&bytes).is_err() {
                return;
            }
            if !is_flooding {
                thread::sleep(Duration::from_millis(1));
            }
        }
    }

    fn value(&self, name: &str) -> Option<Value> {
        let state = self.state();
        let has_program = state.program.is_some();
        // In a safeguard stop a program waits.
        let is_moving = has_program && state.safety_mode != 5;
        match name {
            "actual_TCP_pose" => {
                Some(Value::Vector6(UrPose::from_pose(&(state.base_from_flange * state.flange_from_tcp())).0))
            }
            "actual_TCP_speed" => Some(Value::Vector6([0.0, if is_moving { 0.01 } else { 0.0 }, 0.0, 0.0, 0.0, 0.0])),
            "robot_mode" => Some(Value::I32(state.robot_mode)),
            "safety_mode" => Some(Value::I32(state.safety_mode)),
            "runtime_state" => Some(Value::U32(match (has_program, is_moving) {
                (false, _) => 1,
                (true, true) => 2,
                (true, false) => 4,
            })),
            "output_int_register_24" => Some(Value::I32(state.mark)),
            "tcp_offset" if state.knows_offset => Some(Value::Vector6(state.offset.0)),
            _ => None,
        }
    }
}

fn type_name(value: Value) -> &'static str {
    match value {
        Value::Vector6(_) => "VECTOR6D",
        Value::I32(_) => "INT32",
        Value::U32(_) => "UINT32",
        other => panic!("{other:?}"),
    }
}

fn setup(endpoint: Endpoint) -> RobotSetup {
    RobotSetup { kind: RobotKind::UniversalRobots, endpoint }
}

fn robot_at(endpoint: Endpoint) -> Box<dyn RobotDriver> {
    connect(&setup(endpoint), soon()).expect("a controller")
}

fn start_pose() -> Transform<Base, Flange> {
    pose([400.0, 100.0, 300.0], [180.0, 5.0, 20.0])
}

fn shifted(by_mm: f64) -> Transform<Base, Flange> {
    let start = start_pose();
    Transform::from_parts(start.translation_mm() + Vec3::new(0.0, by_mm, 0.0), start.rotation())
}

#[test]
fn the_flange_is_told_and_moved_whatever_tool_point_is_active() {
    for knows_offset in [true, false] {
        let fake = Fake::new(start_pose());
        fake.state().knows_offset = knows_offset;
        let mut robot = robot_at(fake.start());
        let report = robot.report(soon()).expect("a state");
        let flange_from_tcp = Transform::<Flange, Tcp>::from_rigid(*OFFSET.pose().rigid());
        let expected =
            if knows_offset { start_pose() } else { Transform::from_rigid(*(start_pose() * flange_from_tcp).rigid()) };
        assert_near(&report.base_from_flange, &expected, 1e-6);
        assert_eq!(report.tool.contains("active TCP;"), !knows_offset);
        assert_eq!((report.readiness, report.is_moving), (Readiness::Ready, Some(false)));

        let target = Transform::from_parts(expected.translation_mm() + Vec3::new(0.0, 0.75, 0.0), expected.rotation());
        robot.start_move(&linear(target, 10.0), soon()).expect("taken");
        assert_eq!(robot.move_state(soon()), Ok(MoveState::Moving));
        fake.end_program(true);
        finish(&mut *robot).expect("it arrives");
        assert_near(&robot.report(soon()).expect("a state").base_from_flange, &target, 1e-5);
        assert_offset(&fake, OFFSET);
        // Where the tool point is known it is the flange that goes straight, and the tool point is given back.
        let moves = fake.state().heard.clone();
        let is_set = matches!(moves[0].statements[0], Statement::SetTcp { offset: UrPose::AT_FLANGE });
        assert_eq!((is_set, moves[0].statements.len()), (knows_offset, if knows_offset { 5 } else { 2 }));
    }
}

#[track_caller]
fn assert_offset(fake: &Fake, expected: UrPose) {
    let UrPose(found) = fake.state().offset;
    // Nine decimals, in m and radians.
    assert!(found.iter().zip(expected.0).all(|(found, expected)| (found - expected).abs() < 1e-8), "{found:?}");
}

#[test]
fn a_move_that_does_not_end_well_gives_the_tool_point_back_too() {
    let fake = Fake::new(start_pose());
    let mut robot = robot_at(fake.start());
    robot.start_move(&linear(shifted(50.0), 10.0), soon()).expect("taken");
    wait_until(|| fake.state().program.is_some());
    assert_offset(&fake, UrPose::AT_FLANGE);
    robot.stop(soon()).expect("it stops");
    assert_offset(&fake, OFFSET);
    // Ended by the controller, which runs nothing of it any more: by what is sent next.
    robot.start_move(&linear(shifted(50.0), 10.0), soon()).expect("taken");
    wait_until(|| robot.report(soon()).expect("a state").is_moving == Some(true));
    assert_eq!(robot.move_state(soon()), Ok(MoveState::Moving));
    fake.end_program(false);
    finish(&mut *robot).expect_err("it did not arrive");
    assert_offset(&fake, UrPose::AT_FLANGE);
    robot.start_move(&linear(shifted(1.0), 10.0), soon()).expect("taken");
    fake.end_program(true);
    finish(&mut *robot).expect("it arrives");
    assert_offset(&fake, OFFSET);
}

#[test]
fn a_stop_finds_another_way_where_the_connection_of_the_move_was_closed() {
    for drops in [false, true] {
        let fake = Fake::new(start_pose());
        fake.state().hangs_up_after_move = true;
        let mut robot = robot_at(fake.start());
        robot.start_move(&linear(shifted(50.0), 10.0), soon()).expect("taken");
        wait_until(|| fake.state().program.is_some());
        // The end of the connection is on its way behind the program.
        thread::sleep(Duration::from_millis(50));
        if drops {
            drop(robot);
        } else {
            robot.stop(soon()).expect("it stops");
        }
        wait_until(|| fake.state().program.is_none());
    }
}

#[test]
fn a_straight_move_has_a_speed_and_a_turn_has_a_time() {
    let fake = Fake::new(start_pose());
    let mut robot = robot_at(fake.start());
    let turned = pose([400.0, 100.0, 300.0], [180.0, 5.0, 50.0]);
    for target in [shifted(20.0), shifted(0.0), turned] {
        robot.start_move(&linear(target, 10.0), soon()).expect("taken");
        fake.end_program(true);
        finish(&mut *robot).expect("it arrives");
    }
    let heard = fake.state().heard.clone();
    let [Program { statements, name }, _, turn] = &heard[..] else { panic!("{heard:?}") };
    let [_, Statement::MoveL { speed_m_s, time_s, .. }, .., Statement::WriteOutputInteger { register, value }] =
        statements[..]
    else {
        panic!("{statements:?}");
    };
    assert_eq!((name.as_str(), register, value), ("handeye_move", 24, 42));
    assert!((speed_m_s - 0.01).abs() < 1e-12 && time_s == 0.0, "{speed_m_s} m/s in {time_s} s");
    // 30° at 30 degrees a second, and twice that for the ramps.
    let Statement::MoveL { time_s, .. } = turn.statements[1] else { panic!("{turn:?}") };
    assert!((time_s - 2.0).abs() < 1e-5, "{time_s} s");
}

#[test]
fn a_stop_replaces_the_move_and_waits_for_the_stand() {
    let fake = Fake::new(start_pose());
    let mut robot = robot_at(fake.start());
    robot.start_move(&linear(shifted(50.0), 10.0), soon()).expect("taken");
    assert_eq!(robot.move_state(soon()), Ok(MoveState::Moving));
    robot.stop(soon()).expect("it stops");
    assert_eq!(robot.move_state(soon()), Ok(MoveState::Done));
    assert!(fake.state().program.is_none());
    let last = fake.state().heard.last().cloned().expect("a program");
    assert!(matches!(last.statements[0], Statement::StopL { .. }), "{last:?}");
    robot.stop(soon()).expect("standing already");

    // A robot that nobody looks after any more stops too.
    robot.start_move(&linear(shifted(50.0), 10.0), soon()).expect("taken");
    assert_eq!(robot.move_state(soon()), Ok(MoveState::Moving));
    wait_until(|| fake.state().program.is_some());
    drop(robot);
    wait_until(|| fake.state().program.is_none());
}

#[test]
fn a_program_that_ends_early_is_refused_with_a_reason() {
    let fake = Fake::new(start_pose());
    let mut robot = robot_at(fake.start());
    robot.start_move(&linear(shifted(50.0), 10.0), soon()).expect("taken");
    wait_until(|| robot.report(soon()).expect("a state").is_moving == Some(true));
    assert_eq!(robot.move_state(soon()), Ok(MoveState::Moving));
    fake.end_program(false);
    let text = finish(&mut *robot).expect_err("it did not arrive").to_string();
    assert!(text.contains("ended before the target"), "{text}");
    robot.report(soon()).expect("still connected");
}

#[test]
fn states_without_motion_are_named_with_a_remedy() {
    type Case = (fn(&mut State), &'static str, &'static str);
    let cases: [Case; 6] = [
        (|state| state.is_remote = Some(false), "local control", "remote control"),
        (|state| state.robot_mode = 3, "power off", "switch the arm on"),
        (|state| state.robot_mode = 5, "idle", "brakes"),
        (|state| state.safety_mode = 3, "protective stop", "unlock"),
        (|state| state.safety_mode = 7, "emergency stop", "release"),
        (|state| state.safety_mode = 99, "99", "pendant"),
    ];
    for (change, found, remedy) in cases {
        let fake = Fake::new(start_pose());
        change(&mut fake.state());
        let mut robot = robot_at(fake.start());
        let readiness = robot.report(soon()).expect("a state").readiness;
        assert!(matches!(&readiness, Readiness::NotReady { found: text, .. } if text.contains(found)), "{readiness:?}");
        let error = robot.start_move(&linear(shifted(1.0), 10.0), soon()).expect_err("not ready");
        assert!(matches!(error, DeviceError::NotReady { .. }), "{error:?}");
        let text = error.to_string();
        assert!(text.contains(found) && text.contains(remedy), "{text}");
    }
    let fake = Fake::new(start_pose());
    fake.state().is_remote = None;
    let mut robot = robot_at(fake.start());
    assert_eq!(robot.report(soon()).expect("a state").readiness, Readiness::Unknown);
}

#[test]
fn a_flood_of_texts_has_an_end_too() {
    let fake = Fake::new(start_pose());
    let mut robot = robot_at(fake.start());
    fake.state().is_flooding = true;
    // The last states from before it may still come.
    while robot.report(Instant::now() + Duration::from_millis(200)).is_ok() {}
    expect_timeout(|deadline| robot.report(deadline));
}

#[test]
fn a_program_of_somebody_else_is_not_ended_by_a_move() {
    let fake = Fake::new(start_pose());
    let mut robot = robot_at(fake.start());
    let others = Statement::MoveL { pose: OFFSET, acceleration_m_s2: 1.0, speed_m_s: 0.1, time_s: 0.0 };
    fake.state().program = Some(Program::single(others));
    let error = robot.start_move(&linear(shifted(1.0), 10.0), soon()).expect_err("busy");
    assert!(matches!(&error, DeviceError::NotReady { found, .. } if found.contains("program")), "{error:?}");
    fake.state().program = None;
    robot.start_move(&linear(shifted(1.0), 10.0), soon()).expect("taken");
}

#[test]
fn in_local_control_a_stop_is_no_more_than_a_look() {
    let fake = Fake::new(start_pose());
    fake.state().is_remote = Some(false);
    fake.state().ignores_programs = true;
    robot_at(fake.start()).stop(soon()).expect("it stands");
}

#[test]
fn where_nobody_tells_of_local_control_a_stop_is_obeyed_if_no_program_runs() {
    let fake = Fake::new(start_pose());
    fake.state().is_remote = None;
    fake.state().ignores_programs = true;
    robot_at(fake.start()).stop(Instant::now() + Duration::from_secs(2)).expect("it stands, and no program runs");
}

#[test]
fn a_program_that_is_held_up_is_not_stopped() {
    let fake = Fake::new(start_pose());
    let mut robot = robot_at(fake.start());
    robot.start_move(&linear(shifted(50.0), 10.0), soon()).expect("taken");
    wait_until(|| fake.state().program.is_some());
    {
        let mut state = fake.state();
        (state.safety_mode, state.ignores_programs) = (5, true);
    }
    let error = robot.stop(Instant::now() + Duration::from_secs(1)).expect_err("it would go on after a reset");
    assert!(matches!(error, DeviceError::NotReady { .. }) && error.leaves_connection_usable(), "{error:?}");
    let text = error.to_string();
    assert!(text.contains("safeguard stop") && text.contains("stop the program"), "{text}");
    fake.state().program = None;
    robot.stop(soon()).expect("somebody ended the program");
}

#[test]
fn a_dashboard_that_was_late_once_is_asked_again() {
    let fake = Fake::new(start_pose());
    let mut robot = robot_at(fake.start());
    let mut readiness =
        || robot.report(Instant::now() + Duration::from_millis(500)).ok().map(|report| report.readiness);
    fake.state().is_dashboard_silent = true;
    wait_until(|| readiness() == Some(Readiness::Unknown));
    fake.state().is_dashboard_silent = false;
    wait_until(|| readiness() == Some(Readiness::Ready));
}

#[test]
fn a_protective_stop_ends_the_move() {
    let fake = Fake::new(start_pose());
    let mut robot = robot_at(fake.start());
    robot.start_move(&linear(shifted(50.0), 10.0), soon()).expect("taken");
    fake.state().safety_mode = 3;
    let error = finish(&mut *robot).expect_err("stopped");
    assert!(matches!(error, DeviceError::NotReady { .. }), "{error:?}");
    fake.state().safety_mode = 1;
    robot.report(soon()).expect("still connected");
}

#[test]
fn broken_controllers_end_in_a_named_error_by_the_deadline() {
    let is_unexpected = |error: &DeviceError| matches!(error, DeviceError::Unexpected { .. });
    let is_closed = |error: &DeviceError| matches!(error, DeviceError::Closed { .. });
    let accepted = ServerPacket::VersionAccepted(true).encode();
    let answered = |act: Act| {
        let (mut listeners, endpoint) = listen(&[0]);
        let len = |bytes: &[u8]| rtde::packet_len(bytes).expect("a packet");
        serve(
            listeners.remove(0),
            Act::Silence,
            len,
            move |packet| {
                if packet[2] == b'V' { act.clone() } else { Act::Silence }
            },
        );
        move |deadline| connect(&setup(endpoint), deadline).map(drop)
    };
    expect_timeout(answered(Act::Silence));
    expect_timeout(answered(Act::Send(accepted[..2].to_vec())));
    expect_timeout(answered(Act::Send(accepted.clone())));
    expect_error(answered(Act::SendAndClose(accepted[..3].to_vec())), is_closed);
    expect_error(answered(Act::SendAndClose(accepted)), is_closed);
    expect_error(answered(Act::Send(b"\x00\x00\x00".to_vec())), is_unexpected);
    expect_error(answered(Act::Send(b"\xff\xffV".to_vec())), is_unexpected);
    expect_error(answered(Act::Send(b"\x00\x04X\x01".to_vec())), is_unexpected);
    expect_error(answered(Act::Send(ServerPacket::Started(true).encode())), is_unexpected);
    let refused = Act::Send(ServerPacket::VersionAccepted(false).encode());
    expect_error(answered(refused), |error| matches!(error, DeviceError::Refused { .. }));
}
