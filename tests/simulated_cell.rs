//! The simulated cell: held against raw sockets byte by byte, against our drivers, and its truth against a calibration.
#![expect(clippy::expect_used, reason = "a test that gets no answer must fail")]

use std::io::{Read as _, Write as _};
use std::net::{TcpListener, TcpStream};
use std::process::Command;
use std::sync::Arc;
use std::thread::sleep;
use std::time::{Duration, Instant};

use handeye::calibrate::problem::{BallProblem, Capture, Mount, Noise, Reading, SideChoice, Station};
use handeye::calibrate::{Method, solve};
use handeye::device::sim::{Fault, FaultSpec, FaultStart, SimCell, SimDevice, SimOptions};
use handeye::device::{
    DeviceError, LinearMove, MoveState, ProfileReading, RobotDriver, RobotKind, SensorDriver, SensorKind, robot, sensor,
};
use handeye::fit::{ArcFit, ArcOptions, extract_arc};
use handeye::geometry::{Base, Flange, Rigid, Transform, Vec3, so3};
use handeye::scene::PartKind;

/// Far more than anything here takes: only a server that does not answer is told by it.
const PATIENCE: Duration = Duration::from_secs(20);

fn quick() -> SimOptions {
    SimOptions { time_scale: 50.0, ..SimOptions::default() }
}

/// A hundred profiles a second: few enough for a client to see all of them.
fn unhurried() -> SimOptions {
    SimOptions { time_scale: 0.1, ..SimOptions::default() }
}

fn connect(port: u16) -> TcpStream {
    let stream = TcpStream::connect(("127.0.0.1", port)).expect("a server");
    stream.set_read_timeout(Some(PATIENCE)).expect("a timeout");
    stream
}

fn ask_until(stream: &mut TcpStream, request: &[u8], end: impl Fn(&[u8]) -> bool) -> Vec<u8> {
    stream.write_all(request).expect("sent");
    let mut answer = Vec::new();
    while !end(&answer) {
        let mut chunk = [0; 4096];
        let num = stream.read(&mut chunk).expect("an answer in time");
        assert!(num > 0, "closed after {answer:?}");
        answer.extend_from_slice(&chunk[..num]);
    }
    answer
}

fn ask_line(stream: &mut TcpStream, line: &str, num: usize) -> String {
    let bytes = ask_until(stream, line.as_bytes(), |answer| answer.len() >= num);
    String::from_utf8(bytes).expect("text")
}

#[test]
fn mappdk_greets_answers_moves_and_refuses() {
    let cell = SimCell::start(&quick()).expect("free ports");
    let mut client = connect(cell.robot_setup.endpoint.port);
    assert_eq!(ask_line(&mut client, "", 9), "0:success");
    assert_eq!(ask_line(&mut client, "ver\n", 15), "1:wrong-command");
    let position = |client: &mut TcpStream| {
        let bytes = ask_until(client, b"curpos\n", |answer| {
            let text = String::from_utf8_lossy(answer);
            text.matches('=').count() == 6 && text.rsplit('.').next().is_some_and(|decimals| decimals.len() == 3)
        });
        String::from_utf8(bytes).expect("text")
    };
    let values = |text: &str| -> Vec<f64> {
        let fields = text.split(',').map(|field| field.split_once('=').expect("a field").1.trim());
        fields.map(|value| value.parse().expect("a number")).collect()
    };
    let before = position(&mut client);
    assert!(before.starts_with("0:x= "), "{before}");
    let mut target = values(&before);
    target[1] += 0.5;
    let move_to = |values: &[f64]| {
        let fields: Vec<String> = values.iter().map(|value| format!("{value:+014.6}")).collect();
        format!("movep:0020:0100:000:1:6:{}\n", fields.join(":"))
    };
    assert_eq!(ask_line(&mut client, &move_to(&target), 9), "0:success");
    let after = values(&position(&mut client));
    for (found, expected) in after.iter().zip(&target) {
        // Half of the last decimal, and the rounding of the target.
        assert!((found - expected).abs() < 0.0011, "{after:?} instead of {target:?}");
    }
    target[0] += 2000.0;
    let refusal = "1:position-is-not-reachable";
    assert_eq!(ask_line(&mut client, &move_to(&target), refusal.len()), refusal);
}

#[test]
fn ljv_answers_golden_bytes_and_whole_profiles() {
    let cell = SimCell::start(&quick()).expect("free ports");
    let mut client = connect(cell.sensor_setup.endpoint.port);
    let program = hex("14000000 0100f000 00000000 08000000 39000000 07000000");
    let reply = ask_until(&mut client, &program, |answer| answer.len() >= 28);
    assert_eq!(reply, hex("18000000 010000f0 00000000 0c000000 39000000 00000000 07000000"));
    // Another connection finds the same program, and gets a profile of 800 points.
    sleep(Duration::from_millis(5));
    let mut other = connect(cell.sensor_setup.endpoint.port);
    let golden = hex("20000000 0100f000 00000000 14000000 42000000 00000000 00000000 01000000 01010000");
    let reply = ask_until(&mut other, &golden, |answer| answer.len() >= 2092);
    assert_eq!(reply.len(), 2092);
    assert_eq!(&reply[..4], &2088_u32.to_le_bytes());
    assert_eq!((reply[24], reply[40]), (7, 1));
    let unknown = hex("10000000 0100f000 00000000 04000000 99000000");
    let reply = ask_until(&mut other, &unknown, |answer| answer.len() >= 28);
    assert_eq!((reply.len(), reply[17]), (28, 0x31));
}

#[test]
fn settings_are_told_as_they_are_and_not_taken() {
    let cell = SimCell::start(&quick()).expect("free ports");
    let mut client = connect(cell.sensor_setup.endpoint.port);
    let mut ask = |request: &str| {
        ask_until(&mut client, &hex(request), |bytes| {
            bytes.first_chunk().is_some_and(|prefix| bytes.len() >= 4 + u32::from_le_bytes(*prefix) as usize)
        })
    };
    // The trigger mode of program 5: continuous. Its sampling: 1 kHz. A client polls as often as this says.
    let trigger_mode = "20000000 0100f000 00000000 14000000 31000000 00000000 01000000 15000100 00000000";
    assert_eq!(ask(trigger_mode)[17..], [&[0; 7][..], &[0, 0, 0, 0], &[0; 4]].concat());
    let sampling = "20000000 0100f000 00000000 14000000 31000000 00000000 01000000 15000200 000000cd";
    assert_eq!(ask(sampling)[28..], [6, 0, 0, 0]);
    let write = "20000000 0100f000 00000000 14000000 32000000 01000000 15000100 00000000 01000000";
    assert_eq!(ask(write)[17], 0x41);
    assert_eq!(ask(trigger_mode)[28], 0, "what was refused is not set");
    // Begin and end of a batch.
    for command in ["22", "23"] {
        assert_eq!(ask(&format!("10000000 0100f000 00000000 04000000 {command}000000"))[17], 0x41);
    }
}

const START_STREAM: &str = "18000000 0100f000 00000000 0c000000 a0000000 47000000 01000000";
const STOP_STREAM: &str = "10000000 0100f000 00000000 04000000 48000000";
const STREAM_STOPPED: &str = "ffffffff 01000000";

/// A client of the high-speed port for which a stream was started and stopped. A stream is served to who was there when it
/// was started: until bytes come nobody knows that the server has seen him.
fn served_stream(stream_port: u16, client: &mut TcpStream) -> TcpStream {
    let mut stream = connect(stream_port);
    stream.set_nonblocking(true).expect("set");
    let mut is_served = false;
    while !is_served {
        ask_until(client, &hex(START_STREAM), |bytes| bytes.len() >= 28);
        sleep(Duration::from_millis(20));
        is_served = stream.read(&mut [0; 64]).is_ok();
    }
    stream.set_nonblocking(false).expect("set");
    ask_until(client, &hex(STOP_STREAM), |bytes| bytes.len() >= 28);
    // Streams that another start has ended leave their notes as well: nothing follows the last one.
    stream.set_read_timeout(Some(Duration::from_millis(500))).expect("a timeout");
    while stream.read(&mut [0; 4096]).is_ok_and(|num| num > 0) {}
    stream.set_read_timeout(Some(PATIENCE)).expect("a timeout");
    stream
}

#[test]
fn the_high_speed_port_pushes_one_profile_after_the_other() {
    const PROFILE: usize = 2028;
    let cell = SimCell::start(&unhurried()).expect("free ports");
    let port_of = |what: &str| cell.ports.iter().find(|(_, found)| found.contains(what)).expect("served").0;
    let mut client = connect(cell.sensor_setup.endpoint.port);
    let mut stream = served_stream(port_of("high-speed"), &mut client);
    let reply = ask_until(&mut client, &hex("14000000 0100f000 00000000 08000000 47000000 02000000"), |bytes| {
        bytes.len() >= 56
    });
    assert_eq!((reply.len(), reply[17]), (56, 0));
    // 800 points, 0.5 µm, from −40 mm on, 0.1 mm apart.
    assert_eq!(reply[44..], hex("2003 3200 00f7c2ff 10270000"));
    let mut start = hex("18000000 0100f000 00000000 0c000000 a0000000 47000000");
    start.extend(&reply[32..36]);
    assert_eq!(ask_until(&mut client, &start, |bytes| bytes.len() >= 28)[17], 0);
    let profiles = ask_until(&mut stream, b"", |bytes| bytes.len() >= 3 * PROFILE);
    let word = |at: usize| u32::from_le_bytes(*profiles[at..].first_chunk().expect("4 bytes"));
    for start in [0, PROFILE, 2 * PROFILE] {
        let sum = (start..start + PROFILE - 4).step_by(4).map(word).fold(0, u32::wrapping_add);
        assert_eq!(word(start + PROFILE - 4), sum);
        assert_eq!(word(start + 4), word(4) + u32::try_from(start / PROFILE).expect("few"));
    }
    assert_eq!(ask_until(&mut client, &hex(STOP_STREAM), |bytes| bytes.len() >= 28)[17], 0);
    // Whole profiles until then, and the note of the stop behind them.
    let note = hex(STREAM_STOPPED);
    let rest = ask_until(&mut stream, b"", |bytes| bytes.ends_with(&note));
    assert_eq!((profiles.len() + rest.len() - note.len()) % PROFILE, 0);
}

#[test]
fn a_stream_is_its_clients_own_and_ends_with_it() {
    let cell = SimCell::start(&quick()).expect("free ports");
    let stream_port = cell.ports.iter().find(|(_, what)| what.contains("high-speed")).expect("served").0;
    let mut client = connect(cell.sensor_setup.endpoint.port);
    let [start, stop, note] = [START_STREAM, STOP_STREAM, STREAM_STOPPED].map(hex);
    let mut first = served_stream(stream_port, &mut client);
    ask_until(&mut client, &start, |bytes| bytes.len() >= 28);
    // The server has seen this start before the stop comes.
    ask_until(&mut first, b"", |bytes| !bytes.is_empty());
    // Stopped and started at once: the note of the stop stands between the two.
    ask_until(&mut client, &stop, |bytes| bytes.len() >= 28);
    ask_until(&mut client, &start, |bytes| bytes.len() >= 28);
    ask_until(&mut first, b"", |bytes| bytes.windows(note.len()).any(|window| window == note));
    // The next client comes while that one runs and after it has gone without a stop: nothing of it is his.
    let mut second = connect(stream_port);
    sleep(Duration::from_millis(50));
    drop(first);
    sleep(Duration::from_millis(50));
    second.set_read_timeout(Some(Duration::from_millis(100))).expect("a timeout");
    assert!(second.read(&mut [0; 64]).is_err(), "profiles of another's stream");
}

#[test]
fn a_dropped_cell_ends_its_clients_and_frees_its_ports() {
    for kind in RobotKind::ALL {
        let cell = SimCell::start(&SimOptions { robot: kind, ..quick() }).expect("free ports");
        let ports: Vec<u16> = cell.ports.iter().map(|(port, _)| *port).collect();
        let mut clients: Vec<TcpStream> = ports.iter().map(|port| connect(*port)).collect();
        drop(cell);
        for client in &mut clients {
            let mut rest = Vec::new();
            // Closed one way or the other, not silent.
            client.read_to_end(&mut rest).ok();
        }
        for port in ports {
            TcpListener::bind(("127.0.0.1", port)).expect("the port is free again");
        }
    }
}

#[test]
fn ports_keep_their_distances_and_a_taken_one_is_named() {
    let cell = SimCell::start(&SimOptions { robot: RobotKind::UniversalRobots, ..quick() }).expect("free ports");
    let expected = [30004, 30001, 30002, 30003, 29999].map(|port| port - 30004);
    let main = i32::from(cell.robot_setup.endpoint.port);
    let distances: Vec<i32> = cell.ports[..5].iter().map(|(port, _)| i32::from(*port) - main).collect();
    assert_eq!(distances, expected);
    // Any free ports lie above those of a FANUC.
    let cell = SimCell::start(&quick()).expect("free ports");
    let taken = cell.robot_setup.endpoint.port;
    let same = SimOptions { port_offset: Some(taken - 18735), ..quick() };
    let refusal = SimCell::start(&same).expect_err("taken").to_string();
    assert!(refusal.contains(&taken.to_string()) && refusal.contains("--port-offset"), "{refusal}");
    drop(cell);
    // All but the page of a robot that is not read by it. Ports that were found free may be taken by somebody quick.
    let pageless = (0..20).find_map(|_| {
        let offset = SimCell::start(&quick()).ok()?.robot_setup.endpoint.port - 18735;
        let _page = TcpListener::bind(("127.0.0.1", 80 + offset)).ok()?;
        let cell = SimCell::start(&SimOptions { port_offset: Some(offset), ..quick() }).ok()?;
        Some(cell.ports.iter().all(|(port, _)| *port != 80 + offset))
    });
    assert_eq!(pageless, Some(true));
    let folder = SimOptions { sensor: SensorKind::Folder, ..quick() };
    assert!(SimCell::start(&folder).expect_err("no protocol").to_string().contains("watched folder"));
}

#[test]
fn the_command_serves_for_a_while_and_names_a_port_that_is_taken() {
    let run = |offset: u16| {
        let offset = offset.to_string();
        let arguments = ["cell", "--port-offset", &offset, "--seconds", "0", "--truth"];
        Command::new(env!("CARGO_BIN_EXE_handeye")).args(arguments).output().expect("it runs")
    };
    // Found free by a cell, and free again once that has ended, unless somebody else is quick.
    let found = (0..5).find_map(|_| {
        let cell = SimCell::start(&quick()).expect("free ports");
        let offset = cell.robot_setup.endpoint.port - 18735;
        drop(cell);
        let output = run(offset);
        output.status.success().then_some((offset, output))
    });
    let (offset, output) = found.expect("free ports");
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(text.starts_with(&format!("127.0.0.1:{} FANUC MAPPDK server\n", 18735 + offset)), "{text}");
    assert!(text.contains("truth: ball_in_base") && text.ends_with("ready\n"), "{text}");
    let _taken = TcpListener::bind(("127.0.0.1", 18736 + offset)).expect("free");
    let output = run(offset);
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2));
    assert!(message.contains(&(18736 + offset).to_string()) && message.contains("--port-offset"), "{message}");
    assert_eq!(message.lines().count(), 1, "{message}");
}

#[test]
fn rtde_sets_recipes_up_and_streams_packets_of_their_size() {
    let cell = SimCell::start(&SimOptions { robot: RobotKind::UniversalRobots, ..quick() }).expect("free ports");
    let mut client = connect(cell.robot_setup.endpoint.port);
    let packet = |kind: u8, payload: &[u8]| {
        let len = u16::try_from(3 + payload.len()).expect("short");
        [&len.to_be_bytes()[..], &[kind], payload].concat()
    };
    assert_eq!(ask_until(&mut client, &packet(b'V', &[0, 2]), |bytes| bytes.len() >= 4), [0, 4, b'V', 1]);
    // Some clients ask twice.
    for _ in 0..2 {
        assert_eq!(
            ask_until(&mut client, &packet(b'v', &[]), |bytes| bytes.len() >= 19)[..7],
            [0, 19, b'v', 0, 0, 0, 5]
        );
    }
    // A comma behind the last name is no name.
    let outputs = [&125.0_f64.to_be_bytes()[..], b"timestamp,actual_TCP_pose,"].concat();
    let reply = ask_until(&mut client, &packet(b'O', &outputs), |bytes| bytes.len() >= 19);
    assert_eq!(reply, [&[0, 19, b'O', 1][..], b"DOUBLE,VECTOR6D"].concat());
    let unknown = [&125.0_f64.to_be_bytes()[..], b"timestamp,actual_mood"].concat();
    let reply = ask_until(&mut client, &packet(b'O', &unknown), |bytes| bytes.len() >= 20);
    assert_eq!(reply, [&[0, 20, b'O', 0][..], b"DOUBLE,NOT_FOUND"].concat());
    let stream = ask_until(&mut client, &packet(b'S', &[]), |bytes| bytes.len() >= 4 + 2 * 60);
    assert_eq!(stream[..4], [0, 4, b'S', 1]);
    assert_eq!((&stream[4..8], &stream[64..68]), (&[0, 0x3c, b'U', 1][..], &[0, 0x3c, b'U', 1][..]));
    let port_of = |what: &str| cell.ports.iter().find(|(_, found)| found.contains(what)).expect("served").0;
    let state = ask_until(&mut connect(port_of("real-time")), b"", |bytes| bytes.len() >= 2440);
    assert_eq!((&state[..4], &state[1220..1224]), (&[0, 0, 4, 196][..], &[0, 0, 4, 196][..]));
    let mut dashboard = connect(port_of("dashboard"));
    let greeting = "Connected: Universal Robots Dashboard Server\n";
    assert_eq!(ask_line(&mut dashboard, "", greeting.len()), greeting);
    assert_eq!(ask_line(&mut dashboard, "is in remote control\n", 5), "true\n");
    cell.inject(FaultSpec::now(Fault::NotRemote));
    assert_eq!(ask_line(&mut dashboard, "is in remote control\n", 6), "false\n");
}

#[test]
fn web_pages_are_served_and_others_are_not_found() {
    let cell = SimCell::start(&SimOptions { robot: RobotKind::FanucPage, ..quick() }).expect("free ports");
    let get = |path: &str| {
        let mut client = connect(cell.robot_setup.endpoint.port);
        client.write_all(format!("GET {path} HTTP/1.0\r\n\r\n").as_bytes()).expect("sent");
        let mut page = String::new();
        client.read_to_string(&mut page).expect("a page");
        page
    };
    let position = get("/MD/CURPOS.DG");
    assert!(position.starts_with("HTTP/1.0 200") && position.contains("CURRENT WORLD POSITION"), "{position}");
    assert!(get("/md/prgstate.dg").contains("MAPPDK_SERVER RUNNING"));
    assert!(get("/").starts_with("HTTP/1.0 404"));
    cell.inject(FaultSpec::now(Fault::NotRemote));
    assert!(get("/MD/PRGSTATE.DG").contains("MAPPDK_SERVER ABORTED"));
}

fn soon() -> Instant {
    Instant::now() + PATIENCE
}

fn drivers(cell: &SimCell) -> (Box<dyn RobotDriver>, Box<dyn SensorDriver>) {
    let robot = robot::connect(&cell.robot_setup, soon()).expect("a robot");
    (robot, sensor::connect(&cell.sensor_setup, soon()).expect("a profiler"))
}

fn pose_of(robot: &mut dyn RobotDriver) -> Rigid {
    *robot.report(soon()).expect("a pose").base_from_flange.rigid()
}

fn motion_to(base_from_flange: &Rigid) -> LinearMove {
    let base_from_flange = Transform::<Base, Flange>::from_rigid(*base_from_flange);
    LinearMove { base_from_flange, speed_mm_s: 200.0, rotation_speed_deg_s: 60.0 }
}

fn go(robot: &mut dyn RobotDriver, base_from_flange: &Rigid) -> Result<(), DeviceError> {
    robot.start_move(&motion_to(base_from_flange), soon())?;
    while robot.move_state(soon())? == MoveState::Moving {
        sleep(Duration::from_millis(1));
    }
    Ok(())
}

/// The first profile that was taken after this call.
fn fresh_profile(sensor: &mut dyn SensorDriver) -> ProfileReading {
    let newest = |sensor: &mut dyn SensorDriver| loop {
        if let Some(reading) = sensor.newest(soon()).expect("an answer") {
            return reading;
        }
        sleep(Duration::from_micros(200));
    };
    let before = newest(sensor).trigger_count;
    loop {
        let reading = newest(sensor);
        if reading.trigger_count > before {
            return reading;
        }
    }
}

fn arc_in(cell: &SimCell, reading: &ProfileReading) -> ArcFit {
    let options = ArcOptions { ball_radius_mm: cell.truth.radius_mm, profile_std_mm: None };
    extract_arc(&reading.profile, &options).expect("an arc")
}

/// The radius and the middle of the section that the truth has at a pose, in the laser plane.
fn true_section(cell: &SimCell, base_from_flange: &Rigid) -> [f64; 3] {
    let base_from_sensor = base_from_flange * cell.truth.flange_from_sensor;
    let ball = base_from_sensor.inverse_transform_point(&cell.truth.ball_in_base.into());
    [ball.x, ball.z, (cell.truth.radius_mm.powi(2) - ball.y * ball.y).sqrt()]
}

/// Rounding of the pose to 0.001 mm and 0.001° with a lever of 300 mm, and of the range to 0.0005 mm.
const WIRE_ERROR_MM: f64 = 0.01;

#[test]
fn each_robot_and_profiler_moves_sees_and_stops_by_its_driver() {
    for (robot_kind, sensor_kind) in [
        (RobotKind::FanucMappdk, SensorKind::KeyenceLjv),
        (RobotKind::UniversalRobots, SensorKind::KeyenceLjv),
        (RobotKind::Bridge, SensorKind::Bridge),
    ] {
        let options = SimOptions { robot: robot_kind, sensor: sensor_kind, is_noisy: false, ..quick() };
        let cell = SimCell::start(&options).expect("free ports");
        let (mut robot, mut sensor) = drivers(&cell);
        let home = pose_of(robot.as_mut());
        let there = home * Rigid::translation(0.0, -4.0, 0.0);
        for target in [there, home] {
            go(robot.as_mut(), &target).expect("reachable");
            let reached = pose_of(robot.as_mut());
            assert!((reached.translation.vector - target.translation.vector).norm() < 0.002, "{robot_kind:?}");
            let arc = arc_in(&cell, &fresh_profile(sensor.as_mut()));
            let expected = true_section(&cell, &reached);
            let found = [arc.circle.x_mm, arc.circle.z_mm, arc.circle.radius_mm];
            for (found, expected) in found.into_iter().zip(expected) {
                assert!((found - expected).abs() < WIRE_ERROR_MM, "{robot_kind:?}: {found} instead of {expected}");
            }
        }
        // Out of reach: refused, though a way that is cut into pieces may have been begun.
        let far = Rigid::translation(3000.0, 0.0, 0.0) * home;
        let refusal = go(robot.as_mut(), &far).expect_err("out of reach");
        assert!(
            matches!(
                refusal,
                DeviceError::Refused { .. } | DeviceError::OutOfReach { .. } | DeviceError::NotArrived { .. }
            ),
            "{refusal}"
        );
        // Stopped on its way; a server of MAPPDK has one client.
        drop(robot);
        let mut robot = robot::connect(&cell.robot_setup, soon()).expect("a robot");
        let start = pose_of(robot.as_mut());
        let slow = LinearMove { speed_mm_s: 1.0, ..motion_to(&(start * Rigid::translation(0.0, 0.0, -60.0))) };
        robot.start_move(&slow, soon()).expect("reachable");
        robot.move_state(soon()).expect("on its way");
        robot.stop(soon()).expect("stopped");
        let stopped = pose_of(robot.as_mut());
        sleep(Duration::from_millis(20));
        assert!((pose_of(robot.as_mut()).translation.vector - stopped.translation.vector).norm() < 1e-9);
        assert!((stopped.translation.vector - start.translation.vector).norm() < 59.0, "{robot_kind:?}");
    }
}

#[test]
fn parts_are_seen_where_they_stand() {
    for kind in [PartKind::Plate, PartKind::Pin, PartKind::Square, PartKind::Teeth] {
        let cell = SimCell::start(&SimOptions { part: Some(kind), is_noisy: false, ..quick() }).expect("free ports");
        let (mut robot, mut sensor) = drivers(&cell);
        let base_from_part = cell.truth.base_from_part.expect("there is a part");
        let mounting = cell.truth.flange_from_sensor;
        let home = pose_of(robot.as_mut());
        for away_mm in [0.0, 12.0] {
            // Straight back in the sensor, so that the line stays where it is on the part.
            let away = mounting * Rigid::translation(0.0, 0.0, -away_mm) * mounting.inverse();
            go(robot.as_mut(), &(home * away)).expect("reachable");
            let base_from_sensor = pose_of(robot.as_mut()) * mounting;
            let part_from_sensor = base_from_part.inverse() * base_from_sensor;
            let reading = fresh_profile(sensor.as_mut());
            let heights: Vec<f64> = reading
                .profile
                .valid_points()
                .map(|(_, x, z)| (part_from_sensor * nalgebra::Point3::new(x, 0.0, z)).z)
                .collect();
            let highest = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            // A pin's point lies between two points of the grid, and the line passes it by the rounding of the pose.
            let grid_mm = if kind == PartKind::Pin { 0.2 } else { 0.05 };
            assert!(heights.len() > 100 && highest.abs() < grid_mm, "{kind:?}: {} points to {highest}", heights.len());
            if kind == PartKind::Plate {
                let is_at = |height: f64, z_mm: f64| (height - z_mm).abs() < 2.0 * WIRE_ERROR_MM;
                let [top, table] = [0.0, -10.0].map(|z_mm| heights.iter().filter(|z| is_at(**z, z_mm)).count());
                assert!(top > 100 && table > 100, "{top} points of the plate and {table} of the table");
            }
        }
    }
}

#[test]
fn a_part_is_pushed_like_a_ball() {
    let cell =
        SimCell::start(&SimOptions { part: Some(PartKind::Pin), is_noisy: false, ..quick() }).expect("free ports");
    let (_robot, mut sensor) = drivers(&cell);
    let nearest = |sensor: &mut dyn SensorDriver| {
        let profile = fresh_profile(sensor).profile;
        profile.valid_points().map(|(_, _, z)| z).fold(f64::INFINITY, f64::min)
    };
    let before = nearest(sensor.as_mut());
    cell.inject(FaultSpec::now(Fault::BallMoved));
    assert!(nearest(sensor.as_mut()) > before + 0.5, "the line passes the point by");
}

#[test]
fn sweeps_captured_by_the_drivers_give_the_truth() {
    let cell = SimCell::start(&SimOptions { is_noisy: false, ..quick() }).expect("free ports");
    let (mut robot, mut sensor) = drivers(&cell);
    let home = pose_of(robot.as_mut());
    let truth = cell.truth;
    let reference = home.rotation * truth.flange_from_sensor.rotation;
    let tilts = [[0.0, 0.0, 0.0], [25.0, 0.0, 40.0], [-20.0, 15.0, -50.0], [0.0, -25.0, 80.0], [15.0, 20.0, -80.0]];
    let stations = tilts.iter().enumerate().map(|(idx, tilt)| {
        let [x, y, spin] = tilt.map(f64::to_radians);
        let rotation = reference * so3::exp(Vec3::new(x, y, 0.0)) * so3::exp(Vec3::z() * spin);
        // The ball elsewhere in the laser plane each time: else a turn of the sensor about the ball's line is not seen.
        let place = f64::from(u8::try_from(idx).expect("few")) - 2.0;
        let captures = (0..9_u8).map(|step| {
            // From 0.6 R before the ball's middle to 0.4 R behind it.
            let offset = truth.radius_mm * (0.6 - 0.125 * f64::from(step));
            let origin = truth.ball_in_base - rotation * Vec3::new(3.0 * place, offset, 9.0 - 4.0 * place * place);
            let target = Rigid::from_parts(origin.into(), rotation) * truth.flange_from_sensor.inverse();
            go(robot.as_mut(), &target).expect("reachable");
            let arc = arc_in(&cell, &fresh_profile(sensor.as_mut()));
            let base_from_flange = Transform::from_rigid(pose_of(robot.as_mut()));
            Capture { base_from_flange, commanded_travel_mm: None, reading: Reading::Arc(Arc::new(arc)) }
        });
        Station { idx, label: idx.to_string(), side: SideChoice::Auto, captures: captures.collect() }
    });
    let problem = BallProblem {
        radius_mm: truth.radius_mm,
        radius_std_mm: None,
        mount: Mount::OnFlange,
        noise: Noise::default(),
        reference_distance_mm: None,
        stations: stations.collect(),
    };
    let solution = solve(&problem, Method::BallBundle).expect("a solution");
    let off = truth.flange_from_sensor.inverse() * solution.flange_from_sensor.rigid();
    assert!(off.translation.vector.norm() < WIRE_ERROR_MM, "{} mm", off.translation.vector.norm());
    // 0.001° in each of five poses.
    assert!(off.rotation.angle().to_degrees() < 0.005, "{}°", off.rotation.angle().to_degrees());
    let ball_off = solution.target_in_base_mm - truth.ball_in_base;
    assert!(ball_off.norm() < WIRE_ERROR_MM, "{} mm", ball_off.norm());
}

#[test]
fn the_reported_pose_hides_the_arms_noise_and_one_stop_keeps_one_error() {
    let cell = SimCell::start(&quick()).expect("free ports");
    let (mut robot, mut sensor) = drivers(&cell);
    let home = pose_of(robot.as_mut());
    let mut middles = Vec::new();
    for step in 0..6 {
        let target = home * Rigid::translation(0.0, f64::from(step % 2), 0.0);
        go(robot.as_mut(), &target).expect("reachable");
        let pose = pose_of(robot.as_mut());
        assert!((pose.translation.vector - target.translation.vector).norm() < 0.002);
        let expected = true_section(&cell, &pose);
        let z_off = [(); 3].map(|()| arc_in(&cell, &fresh_profile(sensor.as_mut())).circle.z_mm - expected[1]);
        // At one stop only the profile's noise differs, averaged over the arc; ten times its σ.
        assert!((z_off[0] - z_off[1]).abs() < 0.02 && (z_off[0] - z_off[2]).abs() < 0.02, "{z_off:?}");
        middles.push(z_off[0]);
    }
    let spread = middles.iter().fold(0.0_f64, |most, off| most.max(off.abs()));
    // 0.02 mm, and 0.005° with a lever of 300 mm: more than the wire, less than five σ.
    assert!((0.004..0.2).contains(&spread), "{middles:?}");
}

/// One request of the device that a fault befalls.
fn ask(robot: &mut dyn RobotDriver, sensor: &mut dyn SensorDriver, device: SimDevice) -> Result<(), DeviceError> {
    // Short: silence is waited for until then.
    let deadline = Instant::now() + Duration::from_millis(1500);
    match device {
        SimDevice::Robot => robot.report(deadline).map(|_| ()),
        SimDevice::Sensor => sensor.newest(deadline).map(|_| ()),
    }
}

#[test]
fn faults_of_the_wire_reach_the_drivers_as_named_errors() {
    for device in [SimDevice::Robot, SimDevice::Sensor] {
        for fault in [Fault::SplitFrames, Fault::Slow, Fault::Silent, Fault::Garbage, Fault::Disconnect] {
            let cell = SimCell::start(&quick()).expect("free ports");
            let (mut robot, mut sensor) = drivers(&cell);
            cell.inject(FaultSpec::now(fault).on(device));
            let outcome = ask(robot.as_mut(), sensor.as_mut(), device);
            let is_as_expected = match fault {
                Fault::SplitFrames | Fault::Slow => outcome.is_ok(),
                Fault::Silent => matches!(outcome, Err(DeviceError::Timeout { .. })),
                Fault::Disconnect => matches!(outcome, Err(DeviceError::Closed { .. })),
                // Whether garbage looks like the head of a longer message is chance.
                _ => matches!(outcome, Err(DeviceError::Unexpected { .. } | DeviceError::Timeout { .. })),
            };
            assert!(is_as_expected, "{device:?} {fault:?}: {outcome:?}");
            cell.clear_faults();
            drop((robot, sensor));
            let (mut robot, mut sensor) = drivers(&cell);
            ask(robot.as_mut(), sensor.as_mut(), device).expect("after the fault it answers again");
        }
    }
}

#[test]
fn faults_of_the_cell_do_what_they_say() {
    let cell = SimCell::start(&SimOptions { is_noisy: false, ..quick() }).expect("free ports");
    let (mut robot, mut sensor) = drivers(&cell);
    let home = pose_of(robot.as_mut());
    let near = home * Rigid::translation(0.0, 0.0, -1.0);
    cell.inject(FaultSpec::now(Fault::RobotRefuses).starting(FaultStart::AfterMoves(1)));
    go(robot.as_mut(), &near).expect("the first move is done");
    let refusal = go(robot.as_mut(), &home).expect_err("the second is not");
    assert!(matches!(refusal, DeviceError::OutOfReach { .. }), "{refusal}");
    cell.clear_faults();
    let section = |sensor: &mut dyn SensorDriver| arc_in(&cell, &fresh_profile(sensor)).circle.radius_mm;
    let before = section(sensor.as_mut());
    cell.inject(FaultSpec::now(Fault::BallMoved));
    assert!((section(sensor.as_mut()) - before).abs() > 0.1, "the ball was pushed across the line");
    cell.clear_faults();
    assert!((section(sensor.as_mut()) - before).abs() < WIRE_ERROR_MM);
    cell.inject(FaultSpec::now(Fault::StaleProfile));
    let stale = sensor.newest(soon()).expect("an answer").map(|reading| reading.trigger_count);
    for _ in 0..20 {
        let again = sensor.newest(soon()).expect("an answer").map(|reading| reading.trigger_count);
        assert!(again.is_none() || again == stale, "{again:?} after {stale:?}");
        sleep(Duration::from_millis(1));
    }
    cell.clear_faults();
    fresh_profile(sensor.as_mut());
    cell.inject(FaultSpec::now(Fault::NotRemote));
    robot.report(soon()).expect_err("its server was aborted");
    drop(robot);
    robot::connect(&cell.robot_setup, soon()).map(|_| ()).expect_err("and does not greet");
}

#[test]
fn profiles_are_counted_remembered_and_forgotten() {
    let cell = SimCell::start(&unhurried()).expect("free ports");
    let mut client = connect(cell.sensor_setup.endpoint.port);
    let mut get = |position: u8, number: u32, count: u8, erase: u8| {
        let mut request = hex("20000000 0100f000 00000000 14000000 42000000 00000000");
        request.extend([0, position, 0, 0]);
        request.extend(number.to_le_bytes());
        request.extend([count, erase, 0, 0]);
        let reply = ask_until(&mut client, &request, |bytes| {
            bytes.first_chunk().is_some_and(|prefix| bytes.len() >= 4 + u32::from_le_bytes(*prefix) as usize)
        });
        let word = |at: usize| u32::from_le_bytes(*reply[at..].first_chunk().expect("4 bytes"));
        let counts: Vec<u32> = (0..usize::from(reply[40])).map(|idx| word(64 + idx * 2028 + 4)).collect();
        (word(28), word(32), word(36), counts)
    };
    sleep(Duration::from_millis(60));
    let (newest, _, first, counts) = get(0, 0, 3, 0);
    assert_eq!((first, counts.len()), (newest - 2, 3));
    // The first profile of all has number 0 and count 1.
    assert!(counts.iter().zip(first + 1..).all(|(count, expected)| *count == expected), "{counts:?} from {first}");
    let (.., again) = get(2, first, 2, 0);
    assert_eq!(again, counts[..2]);
    let (_, oldest, first, _) = get(1, 0, 1, 1);
    assert_eq!(oldest, first);
    assert_eq!(get(1, 0, 1, 0).1, oldest + 1, "what was read is forgotten where that was asked for");
    let (.., none) = get(0, 0, 0, 0);
    assert!(none.is_empty());
}

fn hex(text: &str) -> Vec<u8> {
    let digits: Vec<u8> = text.bytes().filter(u8::is_ascii_hexdigit).collect();
    let pair = |pair: &[u8]| u8::from_str_radix(std::str::from_utf8(pair).expect("digits"), 16).expect("a byte");
    digits.chunks(2).map(pair).collect()
}
