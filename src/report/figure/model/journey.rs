//! The motion of a camera through a sequence, as curves over time and as ways in space.

use crate::geometry::{Sensor, Transform, Vec3, World};
use crate::odometry::Tracking;
use crate::odometry::evaluation::nearest_in_time;
use crate::odometry::trajectory::Odometer;
use crate::session::sequence::{FrameRecord, Sequence};

/// A value of a frame, with its time, s.
pub type Values = Vec<(f64, Option<f64>)>;

/// Ways in space, seen from the camera at its first pose: x to the right, y down, z along its optical axis, m.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ways {
    /// Frames with a pose: their place in the sequence, and where the camera was.
    pub frames: Vec<(usize, Vec3)>,
    /// The stretches that were tracked without a gap.
    pub tracked: Vec<Vec<Vec3>>,
    /// The true way; empty where it is not known.
    pub truth: Vec<Vec3>,
}

/// The frames so far as curves and ways.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Journey {
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
    /// Where the first camera was, which all ways are seen from; `None` where no frame has a pose.
    pub first_from_world: Option<Transform<Sensor, World>>,
}

impl Journey {
    /// Of the frames that were looked at so far.
    #[must_use]
    pub fn of<'a>(sequence: &Sequence, records: impl Iterator<Item = &'a FrameRecord>) -> Self {
        let first_s = sequence.frames.first().map_or(0.0, |frame| frame.time_s);
        let mut journey = Self::default();
        let mut lost = Lost::default();
        for (idx, record) in records.enumerate() {
            let time_s = record.time_s - first_s;
            journey.take(idx, record, time_s);
            lost.take(record, time_s);
        }
        journey.lost_s = lost.stretches_s;
        journey.take_truth(sequence, first_s);
        journey
    }

    fn take(&mut self, idx: usize, record: &FrameRecord, time_s: f64) {
        self.times_s.push(time_s);
        let summary = record.outcome.as_ref().ok();
        // A frame that the period leaves out is no gap.
        if summary.is_some_and(|summary| summary.tracking == Tracking::LeftOut) {
            return;
        }
        let pose = summary.and_then(|summary| summary.world_from_sensor);
        let travel = summary.filter(|_| pose.is_some()).map(|summary| summary.travel);
        let motion = summary.and_then(|summary| match &summary.tracking {
            Tracking::Tracked(motion) => Some(motion),
            _ => None,
        });
        let or_none = |value: Option<f64>| (time_s, value);
        self.distance_m.push(or_none(travel.map(|travel| travel.distance_mm / 1000.0)));
        self.heading_deg.push(or_none(travel.map(|travel| travel.turn_rad.to_degrees())));
        self.motion_ms.push(or_none(summary.map(|_| record.motion_ms)));
        self.features.push(or_none(summary.map(|summary| count(summary.num_features))));
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
        // Both ways are seen from the camera at the first frame with a pose, each from its own.
        let Some((first_idx, _)) = self.ways.frames.first() else { return };
        let Some(first_true) = nearest_in_time(truth, first_s + self.times_s[*first_idx]) else { return };
        let first_from_world = first_true.world_from_sensor.inverse();
        let mut odometer = Odometer::default();
        for pose in truth.iter().filter(|pose| (first_s - SLACK_S..=last_s + SLACK_S).contains(&pose.time_s)) {
            let travel = odometer.advance(&pose.world_from_sensor, false);
            let time_s = pose.time_s - first_s;
            self.true_distance_m.push((time_s, Some(travel.distance_mm / 1000.0)));
            self.true_heading_deg.push((time_s, Some(travel.turn_rad.to_degrees())));
            self.ways.truth.push((first_from_world * pose.world_from_sensor).translation_mm() / 1000.0);
        }
    }

    /// The frame nearest to a time, s from the first frame.
    #[must_use]
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
#[derive(Debug, Default)]
struct Lost {
    stretches_s: Vec<[f64; 2]>,
    before_s: Option<f64>,
    is_open: bool,
}

impl Lost {
    fn take(&mut self, record: &FrameRecord, time_s: f64) {
        if record.outcome.as_ref().is_ok_and(|summary| summary.tracking == Tracking::LeftOut) {
            return;
        }
        let is_lost = record.outcome.as_ref().map_or(true, |summary| {
            matches!(summary.tracking, Tracking::Lost(_) | Tracking::Started { is_after_gap: true })
        });
        if is_lost {
            match self.stretches_s.last_mut().filter(|_| self.is_open) {
                Some(stretch) => stretch[1] = time_s,
                None => self.stretches_s.push([self.before_s.unwrap_or(time_s), time_s]),
            }
        }
        self.is_open = is_lost;
        self.before_s = Some(time_s);
    }
}
