//! A sequence, frame after frame, through the odometry: decoding, motion, and what is kept of each frame.

use std::time::Instant;

use crate::geometry::{Sensor, Transform, World};
use crate::odometry::evaluation::nearest_in_time;
use crate::odometry::{
    Evaluation, FrameOutcome, Odometry, OdometryOptions, RgbdFrame, TimedPose, Tracking, Travel, evaluate,
};

use super::{FrameError, Sequence};

/// What is kept of a frame: little, however long the sequence is.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameRecord {
    /// Its time, s.
    pub time_s: f64,
    /// What was found, or why its pictures could not be had.
    pub outcome: Result<FrameSummary, FrameError>,
    /// Time it took to read and decode the pictures, ms.
    pub decode_ms: f64,
    /// Time it took to find the motion, ms.
    pub motion_ms: f64,
}

/// What was found of a frame, without its points.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameSummary {
    /// Its motion, or why there is none.
    pub tracking: Tracking,
    /// Where the camera was.
    pub world_from_sensor: Option<Transform<World, Sensor>>,
    /// How far it has come.
    pub travel: Travel,
    /// Corners seen.
    pub num_features: usize,
}

/// A frame that was just looked at.
#[derive(Clone, Debug)]
pub struct Looked {
    /// Its pictures.
    pub frame: RgbdFrame,
    /// What was found, with all points.
    pub outcome: FrameOutcome,
}

/// Goes through a sequence.
#[derive(Clone, Debug)]
pub struct SequenceRun {
    odometry: Odometry,
    records: Vec<FrameRecord>,
}

impl SequenceRun {
    /// At the beginning. The first pose is that of the ground truth, where there is one.
    #[must_use]
    pub fn new(sequence: &Sequence, options: OdometryOptions) -> Self {
        let first = sequence.frames.first().map_or(0.0, |frame| frame.time_s);
        let truth = sequence.ground_truth.as_deref().and_then(|truth| nearest_in_time(truth, first));
        let world_from_first = truth.map_or(options.world_from_first, |pose| pose.world_from_sensor);
        let options = OdometryOptions { world_from_first, ..options };
        Self { odometry: Odometry::new(sequence.camera, options), records: Vec::new() }
    }

    /// Looks at the next frame; `None` after the last one. A frame without pictures is passed over, and its record says why.
    pub fn step(&mut self, sequence: &Sequence) -> Option<Result<Looked, FrameError>> {
        let entry = sequence.frames.get(self.records.len())?;
        let started = Instant::now();
        let decoded = sequence.frame(entry);
        let decode_ms = since_ms(started);
        let frame = match decoded {
            Ok(frame) => frame,
            Err(error) => {
                let outcome = Err(error.clone());
                self.records.push(FrameRecord { time_s: entry.time_s, outcome, decode_ms, motion_ms: 0.0 });
                return Some(Err(error));
            }
        };
        let started = Instant::now();
        let outcome = self.odometry.push(&frame);
        let motion_ms = since_ms(started);
        let summary = FrameSummary {
            tracking: outcome.tracking.clone(),
            world_from_sensor: outcome.world_from_sensor,
            travel: outcome.travel,
            num_features: outcome.features.len(),
        };
        self.records.push(FrameRecord { time_s: entry.time_s, outcome: Ok(summary), decode_ms, motion_ms });
        Some(Ok(Looked { frame, outcome }))
    }

    /// The odometry, with the last frame's aligned depth.
    #[must_use]
    pub const fn odometry(&self) -> &Odometry {
        &self.odometry
    }

    /// What is known of the frames so far.
    #[must_use]
    pub fn records(&self) -> &[FrameRecord] {
        &self.records
    }

    /// The poses known so far.
    #[must_use]
    pub fn trajectory(&self) -> Vec<TimedPose> {
        trajectory(&self.records)
    }
}

/// The poses of those frames that have one.
#[must_use]
pub fn trajectory(records: &[FrameRecord]) -> Vec<TimedPose> {
    let pose = |record: &FrameRecord| {
        let world_from_sensor = record.outcome.as_ref().ok()?.world_from_sensor?;
        Some(TimedPose { time_s: record.time_s, world_from_sensor })
    };
    records.iter().filter_map(pose).collect()
}

impl Sequence {
    /// How far a trajectory is off the true one, where that is known.
    #[must_use]
    pub fn evaluate(&self, trajectory: &[TimedPose]) -> Option<Evaluation> {
        evaluate(self.ground_truth.as_deref()?, trajectory)
    }
}

fn since_ms(started: Instant) -> f64 {
    1000.0 * started.elapsed().as_secs_f64()
}
