//! What the panel draws, made once for as many frames as are tracked.

use crate::app::workbench::sequence::{SeenFrame, SequenceBench};
use crate::geometry::{Sensor, Transform, Vec3, World};
use crate::odometry::Tracking;
use crate::odometry::trajectory::Odometer;
use crate::session::sequence::Sequence;

use super::trajectory::{CameraPose, Ways};

/// A value of a frame, with its time, s.
pub(super) type Values = Vec<(f64, Option<f64>)>;

/// The frames so far as curves and ways.
#[derive(Clone, Debug, Default)]
pub(super) struct Model {
    /// The run and the number of its frames that this was made of.
    made_of: (u64, usize),
    /// Times from the first frame on, s.
    pub times_s: Vec<f64>,
    /// Length of the way, m.
    pub distance_m: Values,
    /// Sum of the turns to the right, °.
    pub heading_deg: Values,
    /// The same of the ground truth.
    pub true_distance_m: Values,
    /// The same of the ground truth.
    pub true_heading_deg: Values,
    /// Corners seen.
    pub features: Values,
    /// Points seen in two frames.
    pub matches: Values,
    /// Those that agree with the motion.
    pub inliers: Values,
    /// Time that the motion took, ms.
    pub motion_ms: Values,
    /// Times between which the motion is not known, s.
    pub lost_s: Vec<[f64; 2]>,
    /// The ways, without the camera.
    pub ways: Ways,
    /// Where the first camera was, which all ways are seen from.
    first_from_world: Option<Transform<Sensor, World>>,
}

impl Model {
    /// Of the frames so far.
    pub fn of(sequence: &Sequence, bench: &SequenceBench) -> Self {
        let seen = bench.seen();
        let first_s = sequence.frames.first().map_or(0.0, |frame| frame.time_s);
        let mut model = Self { made_of: (bench.run(), seen.len()), ..Self::default() };
        for (idx, frame) in seen.iter().enumerate() {
            model.take(idx, frame, frame.record.time_s - first_s);
        }
        model.lost_s = lost(&model.times_s, seen);
        model.take_truth(sequence, first_s);
        model
    }

    /// Whether it is of all the frames so far.
    pub fn is_of(&self, bench: &SequenceBench) -> bool {
        self.made_of == (bench.run(), bench.seen().len())
    }

    fn take(&mut self, idx: usize, frame: &SeenFrame, time_s: f64) {
        self.times_s.push(time_s);
        let summary = frame.record.outcome.as_ref().ok();
        let pose = summary.and_then(|summary| summary.world_from_sensor);
        let travel = summary.filter(|_| pose.is_some()).map(|summary| summary.travel);
        let motion = summary.and_then(|summary| match &summary.tracking {
            Tracking::Tracked(motion) => Some(motion),
            _ => None,
        });
        let is_left_out = summary.is_some_and(|summary| summary.tracking == Tracking::LeftOut);
        let or_none = |value: Option<f64>| (time_s, value);
        self.distance_m.push(or_none(travel.map(|travel| travel.distance_mm / 1000.0)));
        self.heading_deg.push(or_none(travel.map(|travel| travel.turn_rad.to_degrees())));
        self.motion_ms.push(or_none(summary.filter(|_| !is_left_out).map(|_| frame.record.motion_ms)));
        let looked_at = summary.filter(|_| !is_left_out);
        self.features.push(or_none(looked_at.map(|summary| count(summary.num_features))));
        self.matches.push(or_none(motion.map(|motion| count(motion.num_matches))));
        self.inliers.push(or_none(motion.map(|motion| count(motion.num_inliers))));
        let Some(pose) = pose else { return };
        let first_from_world = *self.first_from_world.get_or_insert_with(|| pose.inverse());
        let at_m = (first_from_world * pose).translation_mm() / 1000.0;
        self.ways.frames.push((idx, at_m));
        let is_start = summary.is_some_and(|summary| matches!(summary.tracking, Tracking::Started { .. }));
        match self.ways.tracked.last_mut().filter(|_| !is_start) {
            Some(stretch) => stretch.push(at_m),
            None => self.ways.tracked.push(vec![at_m]),
        }
    }

    /// The truth over the frames' time, from the same first camera.
    fn take_truth(&mut self, sequence: &Sequence, first_s: f64) {
        let Some(truth) = &sequence.ground_truth else { return };
        let last_s = sequence.frames.last().map_or(first_s, |frame| frame.time_s);
        // The run begins at the true pose of the first frame, so that both ways begin in the same place.
        let Some(first_from_world) = self.first_from_world else { return };
        let mut odometer = Odometer::default();
        for pose in truth.iter().filter(|pose| (first_s - SLACK_S..=last_s + SLACK_S).contains(&pose.time_s)) {
            let travel = odometer.advance(&pose.world_from_sensor, false);
            let time_s = pose.time_s - first_s;
            self.true_distance_m.push((time_s, Some(travel.distance_mm / 1000.0)));
            self.true_heading_deg.push((time_s, Some(travel.turn_rad.to_degrees())));
            self.ways.truth.push((first_from_world * pose.world_from_sensor).translation_mm() / 1000.0);
        }
    }

    /// The camera at a frame, or at the last one before it that has a pose.
    pub fn camera_at(&self, bench: &SequenceBench, frame_idx: usize) -> Option<CameraPose> {
        let first_from_world = self.first_from_world?;
        let before = bench.seen().get(..=frame_idx)?;
        let pose = before.iter().rev().find_map(|frame| frame.record.outcome.as_ref().ok()?.world_from_sensor)?;
        let first_from_sensor = first_from_world * pose;
        let axes = [Vec3::x(), Vec3::y(), Vec3::z()].map(|axis| first_from_sensor.rotation() * axis);
        Some(CameraPose { at_m: first_from_sensor.translation_mm() / 1000.0, axes })
    }

    /// The frame nearest to a time, s from the first frame.
    pub fn frame_at(&self, time_s: f64) -> Option<usize> {
        let away = |idx: &usize| (self.times_s[*idx] - time_s).abs();
        (0..self.times_s.len()).min_by(|a, b| away(a).total_cmp(&away(b)))
    }
}

/// Truth this near to the first and last frame belongs to them, s.
const SLACK_S: f64 = 0.02;

#[expect(clippy::cast_precision_loss, reason = "counts of points")]
const fn count(number: usize) -> f64 {
    number as f64
}

/// The stretches from the last frame with a motion to the next, where some in between have none.
fn lost(times_s: &[f64], seen: &[SeenFrame]) -> Vec<[f64; 2]> {
    let is_lost = |frame: &SeenFrame| match &frame.record.outcome {
        Err(_) => true,
        Ok(summary) => {
            matches!(summary.tracking, Tracking::Lost(_) | Tracking::Started { is_after_gap: true })
        }
    };
    let mut stretches: Vec<[f64; 2]> = Vec::new();
    let mut was_lost = false;
    for (idx, frame) in seen.iter().enumerate() {
        let is_lost = is_lost(frame);
        if is_lost {
            match stretches.last_mut().filter(|_| was_lost) {
                Some(stretch) => stretch[1] = times_s[idx],
                None => stretches.push([times_s[idx.saturating_sub(1)], times_s[idx]]),
            }
        }
        was_lost = is_lost;
    }
    stretches
}
