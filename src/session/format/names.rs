//! The words of the session format: fields at every level, and the values that are words.

use crate::calibrate::Mount;
use crate::geometry::notation::{AngleUnit, LengthUnit, OrientationForm};
use crate::session::model::Target;

pub(super) const FORMAT: &str = "handeye-session";

pub(super) const BALL: &str = "ball";
pub(super) const RIGHT_ANGLE_PLATE: &str = "right-angle-plate";
pub(super) const POINT: &str = "point";
pub(super) const POSE_TARGET: &str = "pose";
pub(super) const WORKPIECE: &str = "workpiece";
pub(super) const RGBD: &str = "rgbd";
pub(super) const ON_FLANGE: &str = "on-flange";
pub(super) const FIXED: &str = "fixed";
pub(super) const AUTO: &str = "auto";

pub(super) const ORIENTATIONS: &[(&str, OrientationForm)] = &[
    ("angles", OrientationForm::Angles),
    ("quaternion-wxyz", OrientationForm::QuaternionWxyz),
    ("quaternion-xyzw", OrientationForm::QuaternionXyzw),
];
pub(super) const ANGLE_UNITS: &[(&str, AngleUnit)] = &[("deg", AngleUnit::Degrees), ("rad", AngleUnit::Radians)];
pub(super) const LENGTH_UNITS: &[(&str, LengthUnit)] = &[("mm", LengthUnit::Millimetres), ("m", LengthUnit::Metres)];

/// The word for a value.
pub(super) fn word_of<T: Copy + PartialEq>(choices: &[(&'static str, T)], value: T) -> &'static str {
    choices.iter().find(|(_, choice)| *choice == value).map_or("", |(word, _)| word)
}

const SESSION: &[&str] =
    &["format", "version", "name", "notes", "robot", "sensor", "target", "mount", "stations", "further", "published"];
pub(super) const FURTHER: &[&str] = &["name", "target", "profile_std_mm", "stations"];
pub(super) const ROBOT: &[&str] =
    &["model", "pose_convention", "pose_notation", "position_std_mm", "orientation_std_deg"];
pub(super) const NOTATION: &[&str] = &["orientation", "angle_unit", "length_unit", "flange_from_tcp", "inverse"];
pub(super) const SENSOR: &[&str] = &["model", "profile_std_mm", "reference_distance_mm", "rough_flange_from_sensor"];
pub(super) const STATION: &[&str] = &["label", "enabled", "side", "edge", "captures"];
pub(super) const CAPTURE: &[&str] = &["base_from_flange", "profile", "point_mm", "sensor_from_target", "step"];
pub(super) const PROFILE: &[&str] = &["x_mm", "z_mm"];
pub(super) const POSE: &[&str] = &["translation_mm", "quaternion_wxyz", "euler_deg", "convention", "written"];
pub(super) const WRITTEN: &[&str] = &["euler_deg", "convention"];
pub(super) const PUBLISHED: &[&str] = &["ball_in_base_mm", "error_from_first_mm", "caption"];

/// A name with the sensor on the flange, and the same with a fixed sensor: the frames are others there.
#[derive(Clone, Copy, Debug)]
pub(super) struct ByMount {
    pub on_flange: &'static str,
    pub fixed: &'static str,
}

impl ByMount {
    pub const fn name(self, mount: Mount) -> &'static str {
        match mount {
            Mount::OnFlange => self.on_flange,
            Mount::Fixed => self.fixed,
        }
    }
}

pub(super) const TRUE_SENSOR: ByMount = ByMount { on_flange: "flange_from_sensor", fixed: "base_from_sensor" };
pub(super) const TRUE_BALL: ByMount = ByMount { on_flange: "ball_in_base_mm", fixed: "ball_in_flange_mm" };
pub(super) const TRUE_POINT: ByMount = ByMount { on_flange: "point_in_base_mm", fixed: "point_in_flange_mm" };
pub(super) const TRUE_TARGET: ByMount = ByMount { on_flange: "base_from_target", fixed: "flange_from_target" };
pub(super) const TRUE_WORLD: ByMount = ByMount { on_flange: "base_from_world", fixed: "flange_from_world" };
pub(super) const TRUE_PLATE: ByMount = ByMount { on_flange: "base_from_plate", fixed: "flange_from_plate" };

/// Fields of the top level that are ours for this target; any others are kept as they are. The truth of a sequence may be that
/// of another program, as of a vehicle.
pub(super) fn session(target: &Target, is_truth_ours: bool) -> Vec<&'static str> {
    let of_target: &[&str] = match target {
        Target::Rgbd { .. } if is_truth_ours => &["sequence", "truth"],
        Target::Rgbd { .. } => &["sequence"],
        Target::Ball { .. } | Target::RightAnglePlate | Target::Point | Target::Pose { .. } | Target::Workpiece => {
            &["truth"]
        }
    };
    [SESSION, of_target].concat()
}

/// Fields of the target itself, with what is known of it.
pub(super) const fn target(target: &Target) -> &'static [&'static str] {
    match target {
        Target::Ball { .. } => &["kind", "radius_mm", "radius_std_mm"],
        Target::Point => &["kind", "touched_in_base_mm"],
        Target::Pose { .. } => &["kind", "translation_std_mm", "rotation_std_deg"],
        Target::Workpiece => &["kind", "angle_deg", "pitch_mm", "height_mm", "diameter_mm"],
        Target::RightAnglePlate | Target::Rgbd { .. } => &["kind"],
    }
}

/// Fields of the truth.
pub(super) fn truth(target: &Target) -> Vec<&'static str> {
    let of_target = match target {
        Target::Ball { .. } => Some(TRUE_BALL),
        Target::Point => Some(TRUE_POINT),
        Target::RightAnglePlate => Some(TRUE_PLATE),
        Target::Pose { .. } => Some(TRUE_TARGET),
        Target::Rgbd { .. } => Some(TRUE_WORLD),
        Target::Workpiece => None,
    };
    [Some(TRUE_SENSOR), of_target].into_iter().flatten().flat_map(|names| [names.on_flange, names.fixed]).collect()
}
