//! A sequence that was gone through to its end: the camera's own motion, and beside it that of the robot, from which follows
//! where the camera sits on it. No target is needed.

use std::sync::Arc;

use nalgebra::Matrix6;

use crate::calibrate::motion::{CameraPose, StreamProblem, Weighing};
use crate::geometry::se3;
use crate::odometry::{Evaluation, OdometryOptions, Tracking, Travel};
use crate::watch::{Cancelled, Watch};

use super::super::Session;
use super::{FrameRecord, Sequence, SequenceRun};

/// Poses nearer in time are passed over, s: the steps of neighbouring frames share the errors of their keyframe, so that many
/// of them would seem to know more than they do; and over a short step a robot turns hardly more than its noise.
const SPACING_S: f64 = 0.25;
/// Of a short sequence every pose is needed.
const FEW_POSES: usize = 12;
/// Over a gap nothing is known of the motion, rad² and mm².
const UNKNOWN: f64 = 1e9;

/// A sequence with what is known of each of its frames.
#[derive(Clone, Debug, PartialEq)]
pub struct TrackedSequence {
    /// The sequence.
    pub sequence: Arc<Sequence>,
    /// One entry a frame.
    pub records: Vec<FrameRecord>,
    /// How far the trajectory is off the true one, where that is known.
    pub evaluation: Option<Evaluation>,
}

/// Frames by what became of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FrameCounts {
    /// With a pose.
    pub tracked: usize,
    /// Without, as nothing could be followed.
    pub lost: usize,
    /// Left out by the period.
    pub left_out: usize,
    /// Without pictures.
    pub unreadable: usize,
}

impl TrackedSequence {
    /// What a run has found.
    #[must_use]
    pub fn of(sequence: Arc<Sequence>, run: &SequenceRun) -> Self {
        let evaluation = sequence.evaluate(&run.trajectory());
        Self { sequence, records: run.records().to_vec(), evaluation }
    }

    /// Goes through a sequence.
    ///
    /// # Errors
    /// [`Cancelled`] if `watch` says so between two frames.
    pub fn track(sequence: Arc<Sequence>, options: OdometryOptions, watch: &mut dyn Watch) -> Result<Self, Cancelled> {
        let mut run = SequenceRun::new(&sequence, options);
        loop {
            watch.report(run.records().len(), sequence.frames.len())?;
            if run.step(&sequence).is_none() {
                return Ok(Self::of(sequence, &run));
            }
        }
    }

    /// How many frames became what.
    #[must_use]
    pub fn counts(&self) -> FrameCounts {
        let mut counts = FrameCounts::default();
        for record in &self.records {
            let count = match record.outcome.as_ref().map(|summary| &summary.tracking) {
                Ok(Tracking::Started { .. } | Tracking::Tracked(_)) => &mut counts.tracked,
                Ok(Tracking::Lost(_)) => &mut counts.lost,
                Ok(Tracking::LeftOut) => &mut counts.left_out,
                Err(_) => &mut counts.unreadable,
            };
            *count += 1;
        }
        counts
    }

    /// How far the camera has come in the end.
    #[must_use]
    pub fn travel(&self) -> Travel {
        let last = self.records.iter().rev().find_map(|record| record.outcome.as_ref().ok());
        last.map_or_else(Travel::default, |summary| summary.travel)
    }

    /// The hand-eye problem, where the robot's poses are known; the session says what the robot is like and where the camera is
    /// mounted.
    #[must_use]
    pub fn streams(&self, session: &Session) -> Option<StreamProblem> {
        let flange = self.sequence.flange.as_ref()?;
        let mut camera = camera_poses(&self.records, SPACING_S);
        if camera.len() < FEW_POSES {
            camera = camera_poses(&self.records, 0.0);
        }
        Some(StreamProblem {
            mount: session.mount,
            noise: session.robot.noise(),
            reference_distance_mm: session.sensor.reference_distance_mm,
            flange: flange.iter().map(|pose| (pose.time_s, pose.base_from_flange)).collect(),
            camera,
            weighing: Weighing::Drifting,
            find_offset: true,
        })
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
