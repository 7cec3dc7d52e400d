//! A sequence that was gone through to its end: the camera's own motion, and beside it that of the robot, from which follows
//! where the camera sits on it. No target is needed.

use std::sync::Arc;

use nalgebra::Matrix6;

use crate::calibrate::motion::{CameraPose, StreamProblem, UNKNOWN_STEP, Weighing};
use crate::odometry::{Evaluation, OdometryOptions, Tracking, Travel};
use crate::watch::{Cancelled, Watch};

use super::super::Session;
use super::{FrameRecord, Sequence, SequenceRun};

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

    /// The hand-eye problem, where two poses of the robot or more are known; the session says what the robot is like and where the camera is
    /// mounted.
    #[must_use]
    pub fn streams(&self, session: &Session) -> Option<StreamProblem> {
        let flange = self.sequence.flange.as_ref().filter(|poses| poses.len() > 1)?;
        Some(StreamProblem {
            mount: session.mount,
            noise: session.robot.noise(),
            reference_distance_mm: session.sensor.reference_distance_mm,
            flange: flange.iter().map(|pose| (pose.time_s, pose.base_from_flange)).collect(),
            camera: camera_poses(&self.records),
            weighing: Weighing::Drifting,
            find_offset: true,
        })
    }
}

/// The poses, each with what the step that leads to it may be off by.
fn camera_poses(records: &[FrameRecord]) -> Vec<CameraPose> {
    let tracked = records.iter().filter_map(|record| Some((record, record.outcome.as_ref().ok()?)));
    let posed = tracked.filter_map(|(record, summary)| {
        let step_covariance = match &summary.tracking {
            Tracking::Tracked(motion) => Some(motion.covariance_in_sensor()),
            _ => None,
        };
        Some((record.time_s, summary.world_from_sensor?, step_covariance))
    });
    posed
        .enumerate()
        .map(|(place, (time_s, world_from_sensor, step_covariance))| {
            // Nothing is known of the motion over a gap; no step leads to the first pose.
            let over_gap = || Matrix6::identity() * UNKNOWN_STEP;
            let step_covariance = (place > 0).then(|| step_covariance.unwrap_or_else(over_gap));
            CameraPose { time_s, world_from_sensor, step_covariance }
        })
        .collect()
}
