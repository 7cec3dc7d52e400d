//! What a robot and a profiler can be asked, whatever their make.

use std::sync::Arc;
use std::time::Instant;

use crate::geometry::{Base, Flange, Profile, Transform};

use super::error::DeviceError;

/// Whether the robot may be moved from here.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Readiness {
    /// The controller takes commands of motion.
    Ready,
    /// The controller does not say; a move will tell.
    Unknown,
    /// The controller would refuse: not in remote mode, in an emergency stop, without power, ...
    NotReady {
        /// What it is in.
        found: String,
        /// What to do.
        remedy: &'static str,
    },
    /// This driver only reads.
    ReadOnly,
}

/// What a robot says of itself at one moment.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotReport {
    /// The pose of the flange, or of the tool point that is active in the controller: see [`Self::tool`].
    pub base_from_flange: Transform<Base, Flange>,
    /// Joint angles as the controller shows them, degrees; empty where it was not asked for them.
    pub joints_deg: Vec<f64>,
    /// Whether it moves; `None` where the controller does not say.
    pub is_moving: Option<bool>,
    /// Whether it may be moved from here.
    pub readiness: Readiness,
    /// Which tool and frame the pose is of, as the controller says; empty where it does not.
    pub tool: String,
    /// The least step of a reported coordinate, mm.
    pub resolution_mm: f64,
    /// When it arrived.
    pub received_at: Instant,
}

/// A straight move of the flange.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearMove {
    /// Where to.
    pub base_from_flange: Transform<Base, Flange>,
    /// How fast, mm/s.
    pub speed_mm_s: f64,
    /// How fast it may turn, degrees a second.
    pub rotation_speed_deg_s: f64,
}

/// How far a move has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MoveState {
    /// Under way.
    Moving,
    /// The controller says that it has ended.
    Done,
}

/// A robot's controller, connected. Dropping it closes the connection.
///
/// Every call returns by its deadline, with an error if need be. After an error that does not leave the connection usable
/// (see [`DeviceError::leaves_connection_usable`]) nothing is asked any more but to stop.
pub trait RobotDriver: Send {
    /// What messages call it.
    fn name(&self) -> &'static str;

    /// Pose and state now. Works while a move is under way.
    ///
    /// # Errors
    /// [`DeviceError`].
    fn report(&mut self, deadline: Instant) -> Result<RobotReport, DeviceError>;

    /// Starts a straight move; [`Self::move_state`] tells when it has ended.
    ///
    /// # Errors
    /// [`DeviceError`].
    fn start_move(&mut self, motion: &LinearMove, deadline: Instant) -> Result<(), DeviceError>;

    /// Whether the last move has ended.
    ///
    /// # Errors
    /// [`DeviceError`], `Refused` if the controller gave the move up.
    fn move_state(&mut self, deadline: Instant) -> Result<MoveState, DeviceError>;

    /// Stops the robot as fast as the protocol allows; the move under way is over then.
    ///
    /// # Errors
    /// [`DeviceError`].
    fn stop(&mut self, deadline: Instant) -> Result<(), DeviceError>;
}

/// A profile with what tells it from others.
#[derive(Clone, Debug, PartialEq)]
pub struct ProfileReading {
    /// The profile in the sensor's frame.
    pub profile: Arc<Profile>,
    /// Counts the profiles that were taken, modulo 2³²; a profile with a count past that read after a move was taken
    /// after the move.
    pub trigger_count: u32,
    /// When it arrived.
    pub received_at: Instant,
}

/// A profiler's controller, connected. Dropping it closes the connection.
pub trait SensorDriver: Send {
    /// What messages call it.
    fn name(&self) -> &'static str;

    /// The newest profile; `None` if there is none (yet).
    ///
    /// # Errors
    /// [`DeviceError`].
    fn newest(&mut self, deadline: Instant) -> Result<Option<ProfileReading>, DeviceError>;

    /// Forgets what was measured so far, where the device can; a profile that comes later was taken later.
    ///
    /// # Errors
    /// [`DeviceError`].
    fn forget(&mut self, deadline: Instant) -> Result<(), DeviceError>;
}
