//! Where the camera sits on a robot, from its own motion against the flange's: no target is needed.

use nalgebra::Matrix6;

use crate::calibrate::motion::{CameraPose, StreamProblem, Weighing, solve_streams};
use crate::calibrate::{Method, MethodResult};
use crate::geometry::se3;
use crate::odometry::Tracking;

use super::super::Session;
use super::{FrameRecord, Sequence};

/// Poses nearer in time are passed over, s: the steps of neighbouring frames share the errors of their keyframe, so that many
/// of them would seem to know more than they do; and over a short step a robot turns hardly more than its noise.
const SPACING_S: f64 = 0.25;
/// Of a short sequence every pose is needed.
const FEW_POSES: usize = 12;
/// Over a gap nothing is known of the motion, rad² and mm².
const UNKNOWN: f64 = 1e9;

impl Sequence {
    /// The hand-eye calibration, where the robot's poses are known; the session says what the robot is like and where the
    /// camera is mounted.
    #[must_use]
    pub fn hand_eye(&self, records: &[FrameRecord], session: &Session) -> Option<MethodResult> {
        let flange = self.flange.as_ref()?;
        let mut camera = camera_poses(records, SPACING_S);
        if camera.len() < FEW_POSES {
            camera = camera_poses(records, 0.0);
        }
        let problem = StreamProblem {
            mount: session.mount,
            noise: session.robot.noise(),
            reference_distance_mm: session.sensor.reference_distance_mm,
            flange: flange.iter().map(|pose| (pose.time_s, pose.base_from_flange)).collect(),
            camera,
            weighing: Weighing::Drifting,
            find_offset: true,
        };
        Some(MethodResult { method: Method::Motion, outcome: solve_streams(&problem) })
    }
}

/// Poses at least so far apart in time, each with what the steps that lead to it may be off by.
fn camera_poses(records: &[FrameRecord], spacing_s: f64) -> Vec<CameraPose> {
    let mut poses: Vec<CameraPose> = Vec::new();
    let mut since = Matrix6::zeros();
    for record in records {
        let Ok(summary) = &record.outcome else { continue };
        let Some(world_from_sensor) = summary.world_from_sensor else { continue };
        match &summary.tracking {
            Tracking::Tracked(motion) => {
                let by_sensor = se3::adjoint(&motion.sensor_from_previous);
                since = by_sensor * since * by_sensor.transpose() + motion.covariance_in_sensor();
            }
            _ => since = Matrix6::identity() * UNKNOWN,
        }
        // A hair of patience, as times are rounded.
        if poses.last().is_none_or(|last| record.time_s - last.time_s > spacing_s - 1e-3) {
            let step_covariance = (!poses.is_empty()).then_some(since);
            poses.push(CameraPose { time_s: record.time_s, world_from_sensor, step_covariance });
            since = Matrix6::zeros();
        }
    }
    poses
}
