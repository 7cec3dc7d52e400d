//! What a method is given: stations with their captures, already reduced from profiles to arcs or edge points.

use std::sync::Arc;

use crate::fit::{ArcFit, EdgeFit, Found, Refusal};
use crate::geometry::{Base, Flange, Sensor, Target, Transform, Vec3};
use crate::watch::{Cancelled, Watch};

use super::motion::StreamProblem;
use super::{Method, MethodResult, Solution, SolveError, ball, motion, plate};

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

/// Which edge of the right-angle plate a station saw.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Edge {
    /// The edge p.
    #[default]
    P,
    /// The edge q.
    Q,
}

impl Edge {
    /// As files and tables write it.
    #[must_use]
    pub const fn symbol(self) -> &'static str {
        match self {
            Self::P => "p",
            Self::Q => "q",
        }
    }
}

/// What one capture says about the target.
#[derive(Clone, Debug, PartialEq)]
pub enum Reading {
    /// The ball's section in the laser plane.
    Arc(Arc<ArcFit>),
    /// The point where the laser line crosses a plate's edge, or a tip.
    Edge(Arc<EdgeFit>),
    /// The profile was refused, and why.
    Refused(Refusal),
    /// Already reduced elsewhere, in the sensor frame, mm: the ball's centre, a point on an edge, or the tip.
    Point(Vec3),
    /// The target's whole pose, as a marker or a board gives it.
    Pose(Transform<Sensor, Target>),
}

impl Reading {
    /// The point of an edge or tip, or a target's origin, in the sensor frame, mm; none of a ball's arc.
    #[must_use]
    pub fn point_in_sensor_mm(&self) -> Option<Vec3> {
        match self {
            Self::Edge(edge) => Some(Vec3::new(edge.point_mm[0], 0.0, edge.point_mm[1])),
            Self::Point(point) => Some(*point),
            Self::Pose(sensor_from_target) => Some(sensor_from_target.translation_mm()),
            Self::Arc(_) | Self::Refused(_) => None,
        }
    }
}

impl From<Result<Found, Refusal>> for Reading {
    fn from(found: Result<Found, Refusal>) -> Self {
        match found {
            Ok(Found::Arc(arc)) => Self::Arc(arc),
            Ok(Found::Edge(edge)) => Self::Edge(edge),
            Err(refusal) => Self::Refused(refusal),
        }
    }
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

/// A place of the robot; with a ball, its first capture is where the line first struck it, the rest are the steps.
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

/// A station at the plate.
#[derive(Clone, Debug, PartialEq)]
pub struct PlateStation {
    /// The edge that the line crossed.
    pub edge: Edge,
    /// The captures, all of that edge.
    pub station: Station,
}

/// A calibration from the two edges of a right-angle plate.
#[derive(Clone, Debug, PartialEq)]
pub struct PlateProblem {
    /// Where the sensor is. For [`Mount::Fixed`] the captures hold the inverted poses.
    pub mount: Mount,
    /// Noise of the robot, where it is known.
    pub noise: Noise,
    /// Noise of a point of a profile, mm, where it is known.
    pub profile_std_mm: Option<f64>,
    /// The distance along z for which the headline accuracy is stated, mm; without it, that of the points seen.
    pub reference_distance_mm: Option<f64>,
    /// Roughly how the sensor is mounted, as the operator says; without it many starts are tried.
    pub rough_flange_from_sensor: Option<Transform<Flange, Sensor>>,
    /// The stations to be used.
    pub stations: Vec<PlateStation>,
}

/// Noise of a target's pose in the sensor frame, where it is known.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TargetNoise {
    /// Standard deviation of each coordinate of its origin, mm.
    pub translation_std_mm: Option<f64>,
    /// Standard deviation of its orientation about each axis, rad.
    pub rotation_std_rad: Option<f64>,
}

/// A calibration from the poses of a target: A X B = Z, the same as A X = X B for its motions.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionProblem {
    /// Where the sensor is. For [`Mount::Fixed`] the captures hold the inverted poses.
    pub mount: Mount,
    /// Noise of the robot, where it is known.
    pub noise: Noise,
    /// Noise of the target's poses, where it is known.
    pub target_noise: TargetNoise,
    /// The distance along z for which the headline accuracy is stated, mm; without it, that of the targets seen.
    pub reference_distance_mm: Option<f64>,
    /// The stations to be used.
    pub stations: Vec<Station>,
}

/// A calibration from whatever the target is.
#[derive(Clone, Debug, PartialEq)]
pub enum Problem {
    /// From a ball of known radius.
    Ball(BallProblem),
    /// From a tip or pin, which is a ball without size: every reading is a point, and the radius is zero.
    Point(BallProblem),
    /// From a right-angle plate.
    Plate(PlateProblem),
    /// From a target whose whole pose is seen.
    Motion(MotionProblem),
    /// From the motion that a camera saw itself make, beside that of the robot.
    Streams(StreamProblem),
}

impl Problem {
    /// The methods for this target, in the order in which they are shown.
    #[must_use]
    pub const fn methods(&self) -> &'static [Method] {
        match self {
            Self::Ball(_) => &Method::BALL,
            Self::Point(_) => &Method::POINT,
            Self::Plate(_) => &Method::PLATE,
            Self::Motion(_) | Self::Streams(_) => &Method::MOTION,
        }
    }

    /// The ball's problem, for what only balls have.
    #[must_use]
    pub const fn as_ball(&self) -> Option<&BallProblem> {
        match self {
            Self::Ball(ball) => Some(ball),
            Self::Point(_) | Self::Plate(_) | Self::Motion(_) | Self::Streams(_) => None,
        }
    }

    /// Runs one method.
    ///
    /// # Errors
    /// [`SolveError`] if nothing can be computed, or if the method is for another target.
    pub fn solve(&self, method: Method) -> Result<Solution, SolveError> {
        if !self.methods().contains(&method) {
            return Err(SolveError::OtherTarget { method, available: self.methods() });
        }
        match self {
            Self::Ball(ball) => super::solve(ball, method),
            Self::Point(point) => ball::fixed_point::solve(point).map(|found| Solution { method, ..found }),
            Self::Plate(plate) => plate::solve(plate, method),
            Self::Motion(motion) => motion::solve(motion),
            Self::Streams(streams) => motion::solve_streams(streams),
        }
    }

    /// Runs the given methods in their order.
    ///
    /// # Errors
    /// [`Cancelled`] if `watch` says so between two methods.
    pub fn solve_all(&self, methods: &[Method], watch: &mut dyn Watch) -> Result<Vec<MethodResult>, Cancelled> {
        super::method::each(methods, watch, |method| self.solve(method))
    }
}
