//! The words of the session format: fields at every level, and the values that are words.

use crate::geometry::notation::{AngleUnit, LengthUnit, OrientationForm};
use crate::session::model::Target;

pub(super) const FORMAT: &str = "handeye-session";

pub(super) const BALL: &str = "ball";
pub(super) const RIGHT_ANGLE_PLATE: &str = "right-angle-plate";
pub(super) const POINT: &str = "point";
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
    &["format", "version", "name", "notes", "robot", "sensor", "target", "mount", "stations", "published"];
pub(super) const ROBOT: &[&str] =
    &["model", "pose_convention", "pose_notation", "position_std_mm", "orientation_std_deg"];
pub(super) const NOTATION: &[&str] = &["orientation", "angle_unit", "length_unit", "flange_from_tcp", "inverse"];
pub(super) const SENSOR: &[&str] = &["model", "profile_std_mm", "reference_distance_mm"];
pub(super) const STATION: &[&str] = &["label", "enabled", "side", "edge", "captures"];
pub(super) const CAPTURE: &[&str] = &["base_from_flange", "profile", "point_mm", "step"];
pub(super) const PROFILE: &[&str] = &["x_mm", "z_mm"];
pub(super) const POSE: &[&str] = &["translation_mm", "quaternion_wxyz", "euler_deg", "convention", "written"];
pub(super) const WRITTEN: &[&str] = &["euler_deg", "convention"];
pub(super) const PUBLISHED: &[&str] = &["ball_in_base_mm", "error_from_first_mm", "caption"];
pub(super) const TRUTH: &[&str] = &["flange_from_sensor", "base_from_sensor", "ball_in_base_mm", "ball_in_flange_mm"];

/// Fields of the top level that are ours for this target; any others are kept as they are.
pub(super) fn session(target: &Target) -> Vec<&'static str> {
    let of_target: &[&str] = match target {
        Target::Ball { .. } => &["truth"],
        Target::Rgbd { .. } => &["sequence"],
        Target::RightAnglePlate | Target::Point | Target::Workpiece => &[],
    };
    [SESSION, of_target].concat()
}

/// Fields of the target itself.
pub(super) const fn target(target: &Target) -> &'static [&'static str] {
    match target {
        Target::Ball { .. } => &["kind", "radius_mm", "radius_std_mm"],
        _ => &["kind"],
    }
}
