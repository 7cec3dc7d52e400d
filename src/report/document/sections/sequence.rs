//! A camera's sequence: its frames, its way, and how the clocks stand to each other.

use crate::report::document::{Block, Fact};
use crate::report::evidence::TargetEvidence;
use crate::text::odometry::{self as words, evaluation_line};
use crate::text::report as report_words;

/// None of a target that is no sequence.
pub(in crate::report::document) fn blocks(target: &TargetEvidence) -> Vec<Block> {
    let Some(tracked) = target.measured.sequence() else { return Vec::new() };
    let counts = tracked.counts();
    let color = &tracked.sequence.camera.color;
    let mut facts = vec![
        Fact::new(
            report_words::FRAMES,
            words::tracked_line(counts.tracked, counts.lost, counts.left_out, counts.unreadable),
        ),
        Fact::new(report_words::PICTURE_SIZE, format!("{} × {} px", color.width, color.height)),
        Fact::new(report_words::CAMERA_TRAVEL, words::travel_line(&tracked.travel())),
    ];
    if let Some(evaluation) = &tracked.evaluation {
        facts.push(Fact::new(report_words::AGAINST_TRUTH, evaluation_line(evaluation)));
    }
    let motion = target.best().and_then(|best| best.motion.as_ref());
    if let Some(offset) = motion.and_then(|motion| motion.time_offset) {
        facts.push(Fact::new(report_words::CLOCKS, words::time_offset(offset.offset_s, offset.std_s)));
    }
    vec![Block::Facts(facts)]
}
