//! Where the camera sits on a robot, from its own motion against the flange's: no target is needed.

use nalgebra::Matrix6;

use crate::calibrate::motion::{CameraPose, StreamProblem, Weighing, solve_streams};
use crate::calibrate::{Method, MethodResult};
use crate::odometry::Tracking;

use super::super::Session;
use super::{FrameRecord, Sequence};

/// Over a gap nothing is known of the motion, rad² and mm².
const UNKNOWN: f64 = 1e9;

impl Sequence {
    /// The hand-eye calibration, where the robot's poses are known; the session says what the robot is like and where the
    /// camera is mounted.
    #[must_use]
    pub fn hand_eye(&self, records: &[FrameRecord], session: &Session) -> Option<MethodResult> {
        let flange = self.flange.as_ref()?;
        let problem = StreamProblem {
            mount: session.mount,
            noise: session.robot.noise(),
            reference_distance_mm: session.sensor.reference_distance_mm,
            flange: flange.iter().map(|pose| (pose.time_s, pose.base_from_flange)).collect(),
            camera: records.iter().filter_map(camera_pose).collect(),
            weighing: Weighing::Drifting,
            find_offset: true,
        };
        Some(MethodResult { method: Method::Motion, outcome: solve_streams(&problem) })
    }
}

/// A pose with what the step that leads to it may be off by.
fn camera_pose(record: &FrameRecord) -> Option<CameraPose> {
    let summary = record.outcome.as_ref().ok()?;
    let step_covariance = match &summary.tracking {
        Tracking::Tracked(motion) => Some(motion.covariance_in_sensor()),
        Tracking::Started { is_after_gap: true } => Some(Matrix6::identity() * UNKNOWN),
        _ => None,
    };
    Some(CameraPose { time_s: record.time_s, world_from_sensor: summary.world_from_sensor?, step_covariance })
}
