//! The script ports of a Universal Robots controller (primary, secondary, real-time): they take programs, answer nothing to
//! them, and push the state of the robot all the time.

use std::time::{Duration, Instant};

use crate::device::robot::ur::script::{Program, Statement};
use crate::device::sim::fault::Fault;
use crate::device::sim::motion::Speed;
use crate::device::sim::net::Connection;
use crate::device::sim::world::{ArmReport, Order, Step, World};
use crate::geometry::Rigid;

use super::ur_rtde::{JOINT_MODE_RUNNING, ROBOT_MODE_RUNNING, SAFETY_MODE_NORMAL, pose_m};

/// How fast the tool point turns where its position hardly moves, rad/s.
const TURNING_RAD_S: f64 = 1.0;
/// Between two messages of the primary and secondary ports, and of the real-time port.
const STATE_PERIOD: Duration = Duration::from_millis(100);
const REALTIME_PERIOD: Duration = Duration::from_millis(8);
/// Bytes of a message of the real-time port.
const REALTIME_LEN: usize = 1220;
/// Speeds below this stand for as long as one likes, mm/s and rad/s.
const LEAST_SPEED: f64 = 1e-9;

/// Talks to one client of the primary or the secondary port.
pub fn serve_state(world: &World, connection: &mut Connection) {
    serve(world, connection, STATE_PERIOD, state_message);
}

/// Talks to one client of the real-time port.
pub fn serve_realtime(world: &World, connection: &mut Connection) {
    serve(world, connection, REALTIME_PERIOD, realtime_message);
}

fn serve(world: &World, connection: &mut Connection, period: Duration, message: fn(&World) -> Vec<u8>) {
    let mut received = Vec::new();
    let mut next_push = Instant::now();
    loop {
        if Instant::now() >= next_push {
            if !connection.send(&message(world)) {
                return;
            }
            next_push = Instant::now() + period;
        }
        let patience = next_push.saturating_duration_since(Instant::now());
        let Some(bytes) = connection.take_arrived(patience) else { return };
        received.extend(bytes);
        loop {
            let Ok(len) = Program::len_of_first(&received) else { return };
            let Some(len) = len else { break };
            let rest = received.split_off(len);
            let program = std::mem::replace(&mut received, rest);
            run(world, &String::from_utf8_lossy(&program));
        }
    }
}

/// A program that holds anything else than we understand is not run, as one with a mistake in it: nobody is told.
fn run(world: &World, text: &str) {
    if world.has(Fault::NotRemote) {
        return;
    }
    let Ok(program) = Program::parse(text) else { return };
    let arm = world.arm();
    let mut steps = Vec::new();
    let [mut base_from_flange, mut flange_from_tcp] = [arm.base_from_flange, arm.flange_from_tcp];
    for statement in program.statements {
        match statement {
            Statement::MoveL { pose, speed_m_s, time_s, .. } => {
                let base_from_tcp = *pose.pose().rigid();
                let speed = speed_of(&(base_from_flange * flange_from_tcp), &base_from_tcp, speed_m_s, time_s);
                base_from_flange = base_from_tcp * flange_from_tcp.inverse();
                steps.push(Step::Go(Order::Straight { base_from_flange, flange_from_tcp, speed }));
            }
            Statement::MoveJ { joints_rad, speed_rad_s, .. } => {
                let shown_deg = joints_rad.map(f64::to_degrees);
                let speed_part = speed_rad_s / Speed::FULL.turning_rad_s;
                steps.push(Step::Go(Order::ToJoints { shown_deg, speed_part }));
            }
            Statement::SetTcp { offset } => {
                flange_from_tcp = *offset.pose().rigid();
                steps.push(Step::SetTcp { flange_from_tcp });
            }
            Statement::WriteOutputInteger { register, value } => steps.push(Step::SetRegister { register, value }),
            // To begin a program has stopped what ran before; inside of one each motion ends standing. There are no cycles.
            Statement::StopL { .. } | Statement::StopJ { .. } | Statement::Sync => {}
        }
    }
    world.run_program(steps);
}

fn speed_of(from: &Rigid, to: &Rigid, speed_m_s: f64, time_s: f64) -> Speed {
    if time_s > 0.0 {
        let length_mm = (to.translation.vector - from.translation.vector).norm();
        let turn_rad = from.rotation.angle_to(&to.rotation);
        let within = |way: f64| (way / time_s).max(LEAST_SPEED);
        Speed { linear_mm_s: within(length_mm), turning_rad_s: within(turn_rad) }
    } else {
        Speed { linear_mm_s: speed_m_s * 1000.0, turning_rad_s: TURNING_RAD_S }
    }
}

/// A state message of two parts: the robot's mode, and where its tool point is.
fn state_message(world: &World) -> Vec<u8> {
    const ROBOT_STATE: u8 = 16;
    let arm = world.arm();
    let mut mode = microseconds(&arm).to_be_bytes().to_vec();
    // Connected, enabled, powered; no emergency stop, no protective stop; whether a program runs; not paused.
    mode.extend([1, 1, 1, 0, 0, u8::from(arm.is_running), 0]);
    mode.extend([7, 0]);
    mode.extend([1.0_f64, 1.0, 1.0].map(f64::to_be_bytes).concat());
    mode.push(0);
    let cartesian =
        [arm.base_from_tcp(), arm.flange_from_tcp].map(|pose| pose_m(&pose).map(f64::to_be_bytes).concat()).concat();
    let parts = [part(0, &mode), part(4, &cartesian)].concat();
    part(ROBOT_STATE, &parts)
}

/// Length, type, content.
fn part(kind: u8, content: &[u8]) -> Vec<u8> {
    let len = i32::try_from(5 + content.len()).unwrap_or(i32::MAX);
    [&len.to_be_bytes()[..], &[kind], content].concat()
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a cast of a float saturates")]
fn microseconds(arm: &ArmReport) -> u64 {
    (arm.time_s * 1e6) as u64
}

/// The message of the real-time port: doubles at fixed places.
fn realtime_message(world: &World) -> Vec<u8> {
    let arm = world.arm();
    let joints: [f64; 6] = arm.joints.into();
    let pose = pose_m(&arm.base_from_tcp());
    let mut message = vec![0; REALTIME_LEN];
    let mut put = |at: usize, bytes: &[u8]| message[at..at + bytes.len()].copy_from_slice(bytes);
    put(0, &i32::try_from(REALTIME_LEN).unwrap_or(i32::MAX).to_be_bytes());
    put(4, &arm.time_s.to_be_bytes());
    // Target and actual joints, actual and target tool point, modes of joints and robot, speed scaling, state of the program.
    let joint_modes = [f64::from(JOINT_MODE_RUNNING); 6];
    for (at, values) in [(12, joints), (252, joints), (444, pose), (588, pose), (764, joint_modes)] {
        put(at, &values.map(f64::to_be_bytes).concat());
    }
    for (at, value) in [
        (756, f64::from(ROBOT_MODE_RUNNING)),
        (812, f64::from(SAFETY_MODE_NORMAL)),
        (940, 1.0),
        (1052, if arm.is_running { 2.0 } else { 1.0 }),
    ] {
        put(at, &value.to_be_bytes());
    }
    message
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::device::setup::RobotKind;
    use crate::device::sim::SimOptions;

    fn world() -> World {
        World::new(&SimOptions { robot: RobotKind::UniversalRobots, time_scale: 1000.0, ..SimOptions::default() })
    }

    #[test]
    fn messages_have_their_lengths_and_hold_the_pose() {
        let world = world();
        let realtime = realtime_message(&world);
        assert_eq!((realtime.len(), &realtime[..4]), (1220, &[0, 0, 4, 196][..]));
        let holds = |bytes: &[u8], at: usize, value: f64| bytes[at..at + 8] == value.to_be_bytes();
        let x_m = world.arm().base_from_flange.translation.vector.x / 1000.0;
        assert!(holds(&realtime, 444, x_m));
        assert!(holds(&realtime, 252, world.arm().joints[0]));
        // The first and the last joint run, between the modes of the robot and the accelerometer.
        assert!(holds(&realtime, 756, 7.0) && holds(&realtime, 764, 253.0) && holds(&realtime, 804, 253.0));
        let state = state_message(&world);
        // Header, the robot's mode of 47 bytes, its tool point of 101 bytes.
        assert_eq!((state.len(), &state[..5]), (153, &[0, 0, 0, 153, 16][..]));
        assert!(holds(&state, 5 + 47 + 5, x_m));
    }

    #[test]
    fn programs_move_set_registers_and_are_ended_by_the_next() {
        let world = world();
        let from = world.arm().base_from_flange;
        let [x, y, z, rx, ry, rz] = pose_m(&from);
        let step = format!("movel(p[{x},{y},{},{rx},{ry},{rz}], a=0.3, v=0.05)", z + 0.02);
        run(&world, &format!("def step():\n  {step}\n  write_output_integer_register(24, 7)\nend\n"));
        // One look for both: between two it may have ended.
        loop {
            let arm = world.arm();
            if !arm.is_running {
                break;
            }
            assert_eq!(arm.registers[24], 0);
        }
        assert_eq!(world.arm().registers[24], 7);
        let moved_mm = world.arm().base_from_flange.translation.vector.z - from.translation.vector.z;
        assert!((moved_mm - 20.0).abs() < 1e-6);
        // Slow enough to be on its way for long; then stopped.
        run(&world, &format!("movel(p[{x},{y},{z},{rx},{ry},{rz}], a=0.3, v=0.0000001)\n"));
        assert!(world.arm().is_running);
        run(&world, "stopl(2.0)\n");
        assert!(!world.arm().is_running);
        // Out of reach: it does not move, and the register stays.
        run(
            &world,
            &format!("def far():\n  movel(p[2,{y},{z},{rx},{ry},{rz}])\n  write_output_integer_register(24, 8)\nend\n"),
        );
        assert!(!world.arm().is_running);
        assert_eq!(world.arm().registers[24], 7);
    }
}
