//! What the arm can be told, and what it tells.

use thiserror::Error;

use crate::device::sim::chain::{Joints, Unreachable};
use crate::device::sim::motion::Speed;
use crate::geometry::{Rigid, Vec3};

/// Why the robot does not go.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum MotionError {
    /// The way leads somewhere where the arm cannot be.
    #[error(transparent)]
    Unreachable(#[from] Unreachable),
    /// A speed that is none.
    #[error("a speed above 0 is needed")]
    NoSpeed,
    /// It was asked to refuse.
    #[error("a simulated fault")]
    Refused,
    /// It is not in its remote mode.
    #[error("the robot is not in its remote mode")]
    NotRemote,
}

/// Where to go, and how.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Order {
    /// Straight to a pose.
    Straight {
        /// Where to.
        base_from_flange: Rigid,
        /// The point that goes straight, and at the speed.
        flange_from_tcp: Rigid,
        /// How fast.
        speed: Speed,
    },
    /// By the joints to a pose.
    ByJoints {
        /// Where to.
        base_from_flange: Rigid,
        /// How fast, as a part of full speed.
        speed_part: f64,
    },
    /// To joint angles.
    ToJoints {
        /// As the controller shows them, degrees.
        shown_deg: [f64; 6],
        /// How fast, as a part of full speed.
        speed_part: f64,
    },
}

/// A step of a program that the controller runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Step {
    /// Goes somewhere, and waits until it is there.
    Go(Order),
    /// Makes another tool point the active one.
    SetTcp {
        /// Where it is.
        flange_from_tcp: Rigid,
    },
    /// Sets a register.
    SetRegister {
        /// Which.
        register: u8,
        /// To what.
        value: i32,
    },
}

/// Registers of whole numbers that programs set.
pub const NUM_REGISTERS: usize = 48;

/// What the controller says of the arm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArmReport {
    /// The flange as commanded: its noise is what the controller does not know.
    pub base_from_flange: Rigid,
    /// The tool point that is active.
    pub flange_from_tcp: Rigid,
    /// Joint angles of the mechanism, rad.
    pub joints: Joints,
    /// The same as the controller shows them, degrees.
    pub shown_deg: [f64; 6],
    /// How fast the tool point goes, in the base, mm/s.
    pub velocity_mm_s: Vec3,
    /// How fast it turns, in the base, rad/s.
    pub turning_rad_s: Vec3,
    /// Whether it moves.
    pub is_moving: bool,
    /// Whether a program runs.
    pub is_running: bool,
    /// What programs have set.
    pub registers: [i32; NUM_REGISTERS],
    /// Since the cell began, s of its own clock.
    pub time_s: f64,
}

impl ArmReport {
    /// Where the tool point is.
    #[must_use]
    pub fn base_from_tcp(&self) -> Rigid {
        self.base_from_flange * self.flange_from_tcp
    }
}
