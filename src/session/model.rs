//! The document: what a session file holds, checked and typed.

use std::sync::Arc;

use serde_json::{Map, Value};

pub use crate::calibrate::Edge;
use crate::calibrate::{Mount, Noise, SideChoice};
use crate::geometry::{
    Base, Flange, PoseConvention, PoseNotation, Profile, Rigid, Sensor as SensorFrame, Target as TargetFrame,
    Transform, Vec3,
};
use crate::scan::Wanted;

/// Fields of a JSON object that we do not know; they survive load and save.
///
/// Those of an object without a type of its own (a pose, a profile, the target) are kept by the type around it, as an
/// object under that field's name: a capture's `"base_from_flange"` holds what stood there beside the pose.
pub type UnknownFields = Map<String, Value>;

/// The robot as the file describes it.
#[derive(Clone, Debug, PartialEq)]
pub struct Robot {
    /// Make and type.
    pub model: String,
    /// How its controller writes poses: the numbers in which they are shown and edited.
    pub notation: PoseNotation,
    /// Standard deviation of a reported coordinate, mm, if known.
    pub position_std_mm: Option<f64>,
    /// Standard deviation of a reported orientation, degrees, if known.
    pub orientation_std_deg: Option<f64>,
    /// Fields unknown to us.
    pub unknown: UnknownFields,
}

impl Robot {
    /// The noise of its poses, where it is stated.
    #[must_use]
    pub fn noise(&self) -> Noise {
        Noise {
            position_std_mm: self.position_std_mm,
            orientation_std_rad: self.orientation_std_deg.map(f64::to_radians),
        }
    }
}

impl Default for Robot {
    fn default() -> Self {
        Self {
            model: String::new(),
            notation: PoseNotation::default(),
            position_std_mm: None,
            orientation_std_deg: None,
            unknown: UnknownFields::new(),
        }
    }
}

/// The profiler as the file describes it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sensor {
    /// Make and type.
    pub model: String,
    /// Standard deviation of a point along the range axis, mm, if known.
    pub profile_std_mm: Option<f64>,
    /// The distance for which accuracy is stated, mm.
    pub reference_distance_mm: Option<f64>,
    /// Roughly how the sensor is mounted, as the operator says: the start of methods that need one.
    pub rough_flange_from_sensor: Option<Transform<Flange, SensorFrame>>,
    /// Fields unknown to us.
    pub unknown: UnknownFields,
}

/// What was measured.
#[derive(Clone, Debug, PartialEq)]
pub enum Target {
    /// A ball.
    Ball {
        /// Its radius, mm.
        radius_mm: f64,
        /// How well it is known, mm; with that the radius is estimated along with the calibration.
        radius_std_mm: Option<f64>,
    },
    /// Two perpendicular edges.
    RightAnglePlate,
    /// A tip or pin.
    Point,
    /// A part that is scanned to see what a calibration is worth; nothing is calibrated from it. Its stations are scans: many
    /// captures along a path.
    Workpiece,
    /// A marker or board whose whole pose is seen.
    Pose {
        /// Standard deviation of each coordinate of its origin in the sensor frame, mm, if known.
        translation_std_mm: Option<f64>,
        /// Standard deviation of its orientation about each axis, degrees, if known.
        rotation_std_deg: Option<f64>,
    },
    /// A recorded sequence of an RGB-D camera in place of stations.
    Rgbd {
        /// The sequence's folder, relative to the session file.
        sequence: String,
    },
}

impl Target {
    /// A ball of a radius (mm) that is taken as exact.
    #[must_use]
    pub const fn ball(radius_mm: f64) -> Self {
        Self::Ball { radius_mm, radius_std_mm: None }
    }

    /// A marker or board of which nothing more is known.
    #[must_use]
    pub const fn pose() -> Self {
        Self::Pose { translation_std_mm: None, rotation_std_deg: None }
    }

    /// Whether captures of this target hold the whole pose of it, as no others do.
    #[must_use]
    pub const fn is_pose(&self) -> bool {
        matches!(self, Self::Pose { .. })
    }
}

/// What is known of a target from elsewhere: touched with a calibrated tip, or read from a certificate.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Known {
    /// Where a point is in the base, mm.
    pub point_in_base_mm: Option<Vec3>,
    /// Angle between two planes of a workpiece, degrees.
    pub angle_deg: Option<f64>,
    /// Distance from tooth to tooth, mm.
    pub pitch_mm: Option<f64>,
    /// Height of the teeth, mm.
    pub height_mm: Option<f64>,
    /// Diameter of a ball or cylinder, mm.
    pub diameter_mm: Option<f64>,
}

impl Known {
    /// What is looked for in the part's points where nobody asks for more.
    #[must_use]
    pub const fn wanted(&self) -> Wanted {
        let teeth = self.pitch_mm.is_some() || self.height_mm.is_some();
        Wanted { teeth, diameter: self.diameter_mm.is_some(), round: None }
    }
}

/// Another target that the same sensor measured, on the same robot: to verify a calibration with, or to solve along.
#[derive(Clone, Debug, PartialEq)]
pub struct FurtherTarget {
    /// The user's name for it.
    pub name: String,
    /// What was measured.
    pub target: Target,
    /// What is known of it.
    pub known: Known,
    /// Noise of its profiles, mm, where it was measured with another than the session states.
    pub profile_std_mm: Option<f64>,
    /// Its stations; their labels are unique among themselves.
    pub stations: Vec<Station>,
    /// Fields unknown to us.
    pub unknown: UnknownFields,
}

/// What one capture holds.
#[derive(Clone, Debug, PartialEq)]
pub enum Reading {
    /// A reading of the laser line.
    Profile(Arc<Profile>),
    /// A point in the sensor frame, already reduced, mm.
    Point(Vec3),
    /// The whole pose of a marker or board: `sensor_from_target`.
    Pose(Transform<SensorFrame, TargetFrame>),
}

/// An orientation as the file has it in three numbers, before it became a quaternion: what it was meant to be can only be
/// asked of these.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WrittenAngles {
    /// The three numbers, in degrees as far as the file says.
    pub angles_deg: [f64; 3],
    /// How the file says that they are to be read.
    pub convention: &'static PoseConvention,
}

/// One pose of the robot with what was measured there.
#[derive(Clone, Debug, PartialEq)]
pub struct Capture {
    /// The pose that the controller reported.
    pub base_from_flange: Transform<Base, Flange>,
    /// The orientation as it was written, where it was in three numbers.
    pub written_angles: Option<WrittenAngles>,
    /// What was measured.
    pub reading: Reading,
    /// The commanded move from the capture before, signed, mm.
    pub step_mm: Option<f64>,
    /// Fields unknown to us.
    pub unknown: UnknownFields,
}

/// A place of the robot with its captures.
#[derive(Clone, Debug, PartialEq)]
pub struct Station {
    /// The user's name for it, unique in the session.
    pub label: String,
    /// Whether it takes part.
    pub enabled: bool,
    /// The side of the ball's centre.
    pub side: SideChoice,
    /// The edge seen, for the right-angle plate.
    pub edge: Option<Edge>,
    /// At least one.
    pub captures: Vec<Capture>,
    /// Fields unknown to us.
    pub unknown: UnknownFields,
}

/// What a paper printed for this session.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Published {
    /// Printed ball centres in the base, one a station, mm.
    pub target_in_base_mm: Vec<Vec3>,
    /// Printed error columns, one a station, mm, misprints included; empty if none were printed.
    pub error_from_first_mm: Vec<Vec3>,
    /// The table's title and source.
    pub caption: String,
    /// Fields unknown to us.
    pub unknown: UnknownFields,
}

/// The truth of a simulated session.
#[derive(Clone, Debug, PartialEq)]
pub struct Truth {
    /// The true calibration. For [`Mount::Fixed`] it is `base_from_sensor`.
    pub flange_from_sensor: Transform<Flange, SensorFrame>,
    /// The true ball centre, tip, plate's corner or origin of a marker, mm; zero for a workpiece, which has no such point.
    /// For [`Mount::Fixed`] it is in the flange.
    pub target_in_base_mm: Vec3,
    /// The true plate: origin in its corner, x along edge p, y along edge q. For [`Mount::Fixed`] it is in the flange.
    pub base_from_plate: Option<Rigid>,
    /// The true pose of a marker or board, or of the world of an RGB-D sequence. For [`Mount::Fixed`] it is in the flange.
    pub base_from_target: Option<Rigid>,
    /// Fields unknown to us.
    pub unknown: UnknownFields,
}

/// A session: the one document that the program edits, saves and solves.
#[derive(Clone, Debug, PartialEq)]
pub struct Session {
    /// Its name.
    pub name: String,
    /// The user's notes.
    pub notes: String,
    /// The robot.
    pub robot: Robot,
    /// The profiler.
    pub sensor: Sensor,
    /// What was measured.
    pub target: Target,
    /// What is known of it from elsewhere.
    pub known: Known,
    /// Where the sensor is.
    pub mount: Mount,
    /// The stations in the order of the file.
    pub stations: Vec<Station>,
    /// Other targets that the same sensor measured.
    pub further: Vec<FurtherTarget>,
    /// What a paper printed.
    pub published: Option<Published>,
    /// The truth, for simulated sessions.
    pub truth: Option<Truth>,
    /// Fields unknown to us.
    pub unknown: UnknownFields,
}

impl Session {
    /// An empty session for a target.
    #[must_use]
    pub fn new(target: Target) -> Self {
        Self {
            name: String::new(),
            notes: String::new(),
            robot: Robot::default(),
            sensor: Sensor::default(),
            target,
            known: Known::default(),
            mount: Mount::default(),
            stations: Vec::new(),
            further: Vec::new(),
            published: None,
            truth: None,
            unknown: UnknownFields::new(),
        }
    }

    /// Whether there is nothing yet that anything could be computed from.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.stations.is_empty() && self.further.is_empty() && !matches!(self.target, Target::Rgbd { .. })
    }

    /// Whether everything that is computed of the other session holds of this one: they differ in names and notes at most.
    #[must_use]
    pub fn gives_results_of(&self, other: &Self) -> bool {
        let robot =
            |session: &Self| (session.robot.notation, session.robot.position_std_mm, session.robot.orientation_std_deg);
        let sensor = |session: &Self| {
            let sensor = &session.sensor;
            (sensor.profile_std_mm, sensor.reference_distance_mm, sensor.rough_flange_from_sensor)
        };
        robot(self) == robot(other)
            && sensor(self) == sensor(other)
            && self.target == other.target
            && self.known == other.known
            && self.further == other.further
            && self.mount == other.mount
            && self.stations == other.stations
            && self.published == other.published
            && self.truth == other.truth
    }

    /// Number of captures over all stations.
    #[must_use]
    pub fn num_captures(&self) -> usize {
        self.stations.iter().map(|station| station.captures.len()).sum()
    }
}
