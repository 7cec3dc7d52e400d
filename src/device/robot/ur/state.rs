//! What the stream of a Universal Robots controller says at one moment; pure.

use crate::device::driver::Readiness;
use crate::device::error::MessageError;
use crate::geometry::{Base, Flange, Tcp, Transform, Vec3};

use super::rtde::Value;
use super::script::UrPose;

/// The register by which our programs say how far they have come.
pub(super) const MARK_REGISTER: u8 = 24;
/// What is streamed, in this order.
pub(super) const NAMES: [&str; 6] =
    ["actual_TCP_pose", "actual_TCP_speed", "robot_mode", "safety_mode", "runtime_state", "output_int_register_24"];
/// Streamed too where the software is new enough to know it.
pub(super) const OFFSET_NAME: &str = "tcp_offset";
/// The state of a program that does not run.
const STOPPED: u32 = 1;

/// Slower than this the tool point stands: a sensor of speed is never quite at 0.
const STANDING_M_S: f64 = 0.001;
/// The same for turning.
const STANDING_RAD_S: f64 = 0.005;

/// What was streamed at one moment.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct UrState {
    base_from_tcp: Transform<Base, Tcp>,
    /// `None` where the software does not tell it.
    pub flange_from_tcp: Option<Transform<Flange, Tcp>>,
    speed: [f64; 6],
    robot_mode: i32,
    safety_mode: i32,
    runtime_state: u32,
    /// What our last program wrote.
    pub mark: i32,
}

impl UrState {
    /// From the values of [`NAMES`], and of [`OFFSET_NAME`] if it is there.
    pub(super) fn parse(values: &[Value]) -> Result<Self, MessageError> {
        let wrong = || MessageError::new(format!("{values:?}"), "values of the types that were asked for");
        let finite =
            |values: &[f64; 6]| if values.iter().all(|value| value.is_finite()) { Ok(*values) } else { Err(wrong()) };
        let [
            Value::Vector6(pose),
            Value::Vector6(speed),
            Value::I32(robot_mode),
            Value::I32(safety_mode),
            Value::U32(runtime_state),
            Value::I32(mark),
            offset @ ..,
        ] = values
        else {
            return Err(wrong());
        };
        let flange_from_tcp = match offset {
            [] => None,
            [Value::Vector6(offset)] => Some(Transform::from_rigid(*UrPose(finite(offset)?).pose().rigid())),
            _ => return Err(wrong()),
        };
        Ok(Self {
            base_from_tcp: UrPose(finite(pose)?).pose(),
            flange_from_tcp,
            speed: finite(speed)?,
            robot_mode: *robot_mode,
            safety_mode: *safety_mode,
            runtime_state: *runtime_state,
            mark: *mark,
        })
    }

    /// The flange in the base; the tool point where nobody tells where on the flange that is.
    pub(super) fn base_from_flange(&self) -> Transform<Base, Flange> {
        self.base_from_tcp * self.tool_offset().inverse()
    }

    /// The active tool point as the controller writes it; `None` where it is the flange, or nobody tells.
    pub(super) fn tcp_offset(&self) -> Option<UrPose> {
        let offset = UrPose::from_pose(&Transform::from_rigid(*self.flange_from_tcp?.rigid()));
        (offset != UrPose::AT_FLANGE).then_some(offset)
    }

    fn tool_offset(&self) -> Transform<Flange, Tcp> {
        self.flange_from_tcp.unwrap_or_else(Transform::identity)
    }

    pub(super) fn is_standing(&self) -> bool {
        let [x, y, z, rx, ry, rz] = self.speed;
        Vec3::new(x, y, z).norm() < STANDING_M_S && Vec3::new(rx, ry, rz).norm() < STANDING_RAD_S
    }

    pub(super) const fn is_program_stopped(&self) -> bool {
        self.runtime_state == STOPPED
    }

    /// Whether it takes motion, as far as the stream tells; `is_remote` is what the dashboard tells.
    pub(super) fn readiness(&self, is_remote: Option<bool>) -> Readiness {
        let not_ready = |found: String, remedy| Readiness::NotReady { found, remedy };
        if let Some((name, remedy)) = safety_stop(self.safety_mode) {
            return not_ready(format!("safety mode {name}"), remedy);
        }
        if let Some((name, remedy)) = unready_mode(self.robot_mode) {
            return not_ready(format!("robot mode {name}"), remedy);
        }
        match is_remote {
            Some(true) => Readiness::Ready,
            Some(false) => not_ready("local control".to_owned(), "switch the pendant to remote control"),
            None => Readiness::Unknown,
        }
    }
}

/// The name of a safety mode in which nothing moves, and what to do.
fn safety_stop(mode: i32) -> Option<(String, &'static str)> {
    let (name, remedy) = match mode {
        // Reduced mode moves, slower.
        1 | 2 => return None,
        3 => ("protective stop", "clear what the robot ran against, then unlock the stop on the pendant"),
        4 => ("recovery", "jog the robot back within its limits on the pendant"),
        5 => ("safeguard stop", "close the safeguard and reset it"),
        6 | 7 => ("emergency stop", "release the emergency stop and switch the arm on again"),
        8 => ("violation", "restart the safety system on the pendant"),
        9 => ("fault", "restart the controller"),
        12 => ("automatic safeguard stop", "close the safeguard and reset it"),
        13 => ("enabling device released", "hold the enabling device, or switch to automatic mode"),
        _ => return Some((format!("{mode}"), "see what the pendant says")),
    };
    Some((name.to_owned(), remedy))
}

/// The name of a mode of the robot in which nothing moves, and what to do.
fn unready_mode(mode: i32) -> Option<(String, &'static str)> {
    let (name, remedy) = match mode {
        7 => return None,
        -1 | 0 => ("disconnected", "restart the controller"),
        1 => ("confirm safety", "confirm the safety configuration on the pendant"),
        2 => ("booting", "wait until it has started"),
        3 => ("power off", "switch the arm on and release its brakes on the pendant"),
        4 | 5 => ("idle", "release the brakes on the pendant"),
        6 => ("freedrive", "let go of freedrive"),
        8 => ("updating firmware", "wait until it is done"),
        _ => return Some((format!("{mode}"), "see what the pendant says")),
    };
    Some((name.to_owned(), remedy))
}
