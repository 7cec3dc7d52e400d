//! What the panel draws, made once for as many frames as are tracked.

use crate::app::workbench::sequence::SequenceBench;
use crate::geometry::Vec3;
use crate::report::figure::model::Journey;
use crate::session::sequence::Sequence;

use super::trajectory::CameraPose;

/// The frames so far as curves and ways.
#[derive(Clone, Debug, Default)]
pub(super) struct Model {
    /// The run and the number of its frames that this was made of.
    made_of: (u64, usize),
    /// The camera's motion.
    pub journey: Journey,
}

impl Model {
    /// Of the frames so far.
    pub fn of(sequence: &Sequence, bench: &SequenceBench) -> Self {
        let seen = bench.seen();
        let journey = Journey::of(sequence, seen.iter().map(|frame| &frame.record));
        Self { made_of: (bench.run(), seen.len()), journey }
    }

    /// Whether it is of all the frames so far.
    pub fn is_of(&self, bench: &SequenceBench) -> bool {
        self.made_of == (bench.run(), bench.seen().len())
    }

    /// The camera at a frame, or at the last one before it that has a pose.
    pub fn camera_at(&self, bench: &SequenceBench, frame_idx: usize) -> Option<CameraPose> {
        let first_from_world = self.journey.first_from_world?;
        let before = bench.seen().get(..=frame_idx)?;
        let pose = before.iter().rev().find_map(|frame| frame.record.outcome.as_ref().ok()?.world_from_sensor)?;
        let first_from_sensor = first_from_world * pose;
        let axes = [Vec3::x(), Vec3::y(), Vec3::z()].map(|axis| first_from_sensor.rotation() * axis);
        Some(CameraPose { at_m: first_from_sensor.translation_mm() / 1000.0, axes })
    }
}
