//! What a ball method is given: stations with their captures, already reduced from profiles to arcs.

use std::sync::Arc;

use crate::fit::{ArcFit, ArcRefusal};
use crate::geometry::{Base, Flange, Transform, Vec3};

/// Where the sensor is mounted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mount {
    /// On the flange, the target standing still in the base.
    #[default]
    OnFlange,
    /// Beside the robot, the target on the flange.
    Fixed,
}

/// On which side of the laser plane the ball's centre lies: the sign of its y in the sensor frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// y > 0.
    Plus,
    /// y < 0.
    Minus,
}

impl Side {
    /// +1 or −1.
    #[must_use]
    pub const fn sign(self) -> f64 {
        match self {
            Self::Plus => 1.0,
            Self::Minus => -1.0,
        }
    }

    /// The other side.
    #[must_use]
    pub const fn flipped(self) -> Self {
        match self {
            Self::Plus => Self::Minus,
            Self::Minus => Self::Plus,
        }
    }

    /// As files and tables write it.
    #[must_use]
    pub const fn symbol(self) -> &'static str {
        match self {
            Self::Plus => "+",
            Self::Minus => "-",
        }
    }
}

/// What the user says about the side of a station.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SideChoice {
    /// To be found out.
    #[default]
    Auto,
    /// Known.
    Given(Side),
}

/// What one capture says about the ball.
#[derive(Clone, Debug, PartialEq)]
pub enum Reading {
    /// The ball's section in the laser plane.
    Arc(Arc<ArcFit>),
    /// The profile was refused, and why.
    Refused(ArcRefusal),
    /// The ball's centre in the sensor frame, already reduced elsewhere, mm.
    Point(Vec3),
}

/// One pose of the robot with what was measured there.
#[derive(Clone, Debug, PartialEq)]
pub struct Capture {
    /// The pose that the controller reported.
    pub base_from_flange: Transform<Base, Flange>,
    /// Commanded travel from the station's first capture, signed, mm; `None` where it is not recorded.
    pub commanded_travel_mm: Option<f64>,
    /// What was measured.
    pub reading: Reading,
}

/// A place of the robot; its first capture is where the line first struck the ball, the rest are the steps.
#[derive(Clone, Debug, PartialEq)]
pub struct Station {
    /// The caller's index of this station, carried through to the solution.
    pub idx: usize,
    /// The user's name for it.
    pub label: String,
    /// Which side of the laser plane the ball's centre is on.
    pub side: SideChoice,
    /// At least one.
    pub captures: Vec<Capture>,
}

/// Noise of the robot, where it is known. That of the sensor is measured from the residuals of its profiles.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Noise {
    /// Standard deviation of each coordinate of a reported position, mm.
    pub position_std_mm: Option<f64>,
    /// Standard deviation of a reported orientation about each axis, rad.
    pub orientation_std_rad: Option<f64>,
}

/// A calibration from a ball of known radius.
#[derive(Clone, Debug, PartialEq)]
pub struct BallProblem {
    /// Radius of the ball, mm.
    pub radius_mm: f64,
    /// How well it is known, mm; with that the radius is estimated along with the calibration. `None`: it is taken as exact.
    pub radius_std_mm: Option<f64>,
    /// Where the sensor is. For [`Mount::Fixed`] the captures hold the inverted poses.
    pub mount: Mount,
    /// Noise of the robot, where it is known. That of the sensor is measured from the residuals of its profiles.
    pub noise: Noise,
    /// The distance along z for which the headline accuracy is stated, mm; without it, that of the balls seen.
    pub reference_distance_mm: Option<f64>,
    /// The stations to be used.
    pub stations: Vec<Station>,
}
