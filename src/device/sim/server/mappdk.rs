//! FANUC's MAPPDK server: a line to ask, an answer without an end, one client.

use crate::device::robot::mappdk::messages::{self, Command, Motion, Reply, SUCCESS, Xyzwpr};
use crate::device::sim::fault::Fault;
use crate::device::sim::motion::Speed;
use crate::device::sim::net::Connection;
use crate::device::sim::world::{MotionError, Order, World};
use crate::geometry::{Rigid, Transform};

/// A flange that turns while its middle goes a little way may turn so fast, rad/s.
const TURNING_RAD_S: f64 = 1.5;

/// The server's own name for a pose that the arm cannot be at, or get to.
const NOT_REACHABLE: &str = "position-is-not-reachable";

/// Talks to one client.
pub fn serve(world: &World, connection: &mut Connection) {
    // In teach mode the server's program is aborted: somebody connects, and nobody answers.
    if world.has(Fault::NotRemote) || !connection.send(Reply::ok(SUCCESS).encode().as_bytes()) {
        return;
    }
    while let Some(line) = connection.receive_line() {
        if world.has(Fault::NotRemote) {
            return;
        }
        let command = Command::parse(&line);
        let is_last = command == Ok(Command::Exit);
        let reply = match command {
            Ok(command) => answer(world, connection, &command),
            Err(_) => Some(Reply::error(error_of_wrong_fields(&line))),
        };
        let Some(reply) = reply else { return };
        if !connection.send(reply.encode().as_bytes()) || is_last {
            return;
        }
    }
}

/// `None` once the cell is over.
fn answer(world: &World, connection: &Connection, command: &Command) -> Option<Reply> {
    Some(match command {
        Command::CurPos => {
            let pose = Transform::from_rigid(world.arm().base_from_flange);
            Reply::ok(messages::encode_position(&Xyzwpr::from_pose(&pose)))
        }
        Command::CurJPos => Reply::ok(messages::encode_joints(&world.arm().shown_deg)),
        Command::InsPwr => Reply::ok(if world.arm().is_moving { "0.412" } else { "0.105" }),
        Command::MoveJ(motion) => return go(world, connection, order_of_joints(world, motion)),
        Command::MoveP(motion) => return go(world, connection, order_of_pose(motion)),
        // There are no programs, outputs or variables in this controller: what is set is taken, and nothing is on.
        Command::MappdkCall(_)
        | Command::SetRdo(..)
        | Command::SetDout(..)
        | Command::SetSysVar(..)
        | Command::Exit => Reply::ok(SUCCESS),
        Command::GetRdo(_) | Command::GetDout(_) => Reply::ok("0"),
        Command::Other(_) => Reply::error("wrong-command"),
    })
}

/// Answers when the motion is over, as the server does.
fn go(world: &World, connection: &Connection, order: Result<Order, &'static str>) -> Option<Reply> {
    let started = match order {
        Ok(order) => world.start_motion(&order).map_err(|error| match error {
            MotionError::NoSpeed => "R[81]-was-not-set",
            MotionError::Unreachable(_) | MotionError::Refused | MotionError::NotRemote => NOT_REACHABLE,
        }),
        Err(refusal) => Err(refusal),
    };
    match started {
        Ok(duration) => connection.wait(duration).then(|| Reply::ok(SUCCESS)),
        Err(refusal) => Some(Reply::error(refusal)),
    }
}

fn order_of_pose(motion: &Motion) -> Result<Order, &'static str> {
    let values: [f64; 6] = motion.values.as_slice().try_into().map_err(|_| "PR[81]-was-not-set")?;
    let base_from_flange = *Xyzwpr(values).pose().rigid();
    Ok(if motion.is_linear {
        straight(base_from_flange, motion.speed)
    } else {
        Order::ByJoints { base_from_flange, speed_part: percent(motion.speed) }
    })
}

fn order_of_joints(world: &World, motion: &Motion) -> Result<Order, &'static str> {
    let shown_deg = motion.values.as_slice().try_into().map_err(|_| "error-in-joint-values")?;
    Ok(if motion.is_linear {
        straight(world.flange_at(shown_deg), motion.speed)
    } else {
        Order::ToJoints { shown_deg, speed_part: percent(motion.speed) }
    })
}

/// Where a move is straight its speed is one in mm/s.
fn straight(base_from_flange: Rigid, speed_mm_s: u16) -> Order {
    let speed = Speed { linear_mm_s: f64::from(speed_mm_s), turning_rad_s: TURNING_RAD_S };
    Order::Straight { base_from_flange, flange_from_tcp: Rigid::identity(), speed }
}

fn percent(speed: u16) -> f64 {
    f64::from(speed.min(100)) / 100.0
}

/// What the server says where it cannot cut a command into its fields.
fn error_of_wrong_fields(line: &str) -> &'static str {
    match line.split(':').next() {
        Some("movej") => "cannot-convert-joint-vals",
        Some("movep") => "PR[81]-was-not-set",
        Some("getrdo" | "setrdo") => "wrong-rdo-value",
        Some("getdout" | "setdout") => "wrong-dout-value",
        _ => "wrong-command",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::device::sim::SimOptions;

    #[test]
    fn joints_are_gone_to_straight_in_mm_a_second_where_that_is_asked_for() {
        let world = World::new(&SimOptions::default());
        let arm = world.arm();
        let motion = Motion {
            speed: 40,
            acceleration_percent: 100,
            corner: 0,
            is_linear: false,
            values: arm.shown_deg.to_vec(),
        };
        let by_joints = Order::ToJoints { shown_deg: arm.shown_deg, speed_part: 0.4 };
        assert_eq!(order_of_joints(&world, &motion), Ok(by_joints));
        let straight = order_of_joints(&world, &Motion { is_linear: true, ..motion });
        let Ok(Order::Straight { base_from_flange, speed, .. }) = straight else { panic!("{straight:?}") };
        assert!((speed.linear_mm_s - 40.0).abs() < 1e-12);
        assert!((base_from_flange.translation.vector - arm.base_from_flange.translation.vector).norm() < 1e-9);
    }
}
