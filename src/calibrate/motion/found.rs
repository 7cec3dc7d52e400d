//! What the method found besides the calibration itself.

use crate::calibrate::{PoseFault, RmsMax};
use crate::geometry::{Base, Flange, Sensor, Target, Transform, Vec3};

use super::closed_form::ClosedForm;
use super::reduced::MotionReduced;
use super::stretches::TrackReduced;

/// A published closed form's answer, against the refined one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClosedFormAnswer {
    /// Which.
    pub form: ClosedForm,
    /// Its calibration and what it is worth; `None` where its equations are singular.
    pub answer: Option<Answered>,
}

/// A closed form's calibration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Answered {
    /// The sensor on the flange.
    pub flange_from_sensor: Transform<Flange, Sensor>,
    /// Distance from the refined one, mm.
    pub off_mm: f64,
    /// Angle to the refined one, rad.
    pub off_rad: f64,
    /// Root mean square distance of the target's origin from its mean place, mm.
    pub residual_mm: f64,
    /// Root mean square angle of the target's orientation from its mean, rad.
    pub residual_rad: f64,
}

/// What is left over at one pose.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionPose {
    /// Its station's place in the list of those used.
    pub station: usize,
    /// The caller's index of its station, as in [`crate::calibrate::Station::idx`].
    pub station_idx: usize,
    /// Its capture in that station.
    pub capture_idx: usize,
    /// The station's name.
    pub label: String,
    /// From the target's place to where this pose puts its origin, in the base, mm.
    pub off_mm: Vec3,
    /// The turn left over, about the base's axes, rad.
    pub off_rad: Vec3,
    /// Both over what the noise allows: a root mean square, so about 1.
    pub normalised: f64,
}

/// A pose that contradicts the others and was left out.
#[derive(Clone, Debug, PartialEq)]
pub struct RejectedPose {
    /// The caller's index of its station.
    pub station_idx: usize,
    /// Its capture in that station.
    pub capture_idx: usize,
    /// The station's name.
    pub label: String,
    /// How far off it puts the target's origin, mm.
    pub off_mm: f64,
    /// By how much it turns the target, rad.
    pub off_rad: f64,
    /// What would explain it.
    pub fault: PoseFault,
}

/// The target and what belongs to it.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionFound {
    /// Where the target is.
    pub base_from_target: Transform<Base, Target>,
    /// The published closed forms beside the refined answer.
    pub closed_forms: Vec<ClosedFormAnswer>,
    /// One entry a pose used, in the order of stations and captures. A stretch of a tracked motion counts as a station, and the
    /// place of a pose in the camera's stream as its capture.
    pub poses: Vec<MotionPose>,
    /// Poses that were left out.
    pub rejected: Vec<RejectedPose>,
    /// Root mean square angle of the target's orientation from its mean, rad.
    pub rotation_scatter_rad: f64,
    /// Standard deviation of each coordinate of a target's origin that the weights stand for, mm.
    pub target_translation_std_mm: f64,
    /// The same of its orientation about each axis, rad.
    pub target_rotation_std_rad: f64,
    /// What is said of a camera that tracks its own motion; `None` of a target.
    pub tracked: Option<Tracked>,
    /// By how much the clocks differ, where that was looked for.
    pub time_offset: Option<TimeOffset>,
    /// The data at the minimum, for validation.
    pub data: MotionData,
}

/// What can be solved again with other stations.
#[derive(Clone, Debug, PartialEq)]
pub enum MotionData {
    /// The poses of a target.
    Poses(MotionReduced),
    /// The steps of a camera that tracks its own motion, in stretches.
    Track(TrackReduced),
}

/// How well the steps of a tracked motion agree with those of the flange.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tracked {
    /// Steps from pose to pose.
    pub num_steps: usize,
    /// Those in which the camera lost its way; they were not used.
    pub num_lost: usize,
    /// What the steps used are off by.
    pub step_mm: RmsMax,
    /// The same of their turns, root mean square, rad.
    pub step_rms_rad: f64,
    /// By how much larger than stated the standard deviation of a step's rotation is.
    pub rotation_std_factor: f64,
    /// The same of its translation.
    pub translation_std_factor: f64,
}

/// By how much two clocks differ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimeOffset {
    /// To be added to the camera's times, s.
    pub offset_s: f64,
    /// Its standard deviation, s; `None` where the data do not tell, and the offset is one by the rotation speeds or zero.
    pub std_s: Option<f64>,
}
