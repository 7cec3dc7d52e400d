//! What each section says.

pub(super) mod calibration;
pub(super) mod closing;
pub(super) mod diagnosis;
pub(super) mod methods;
mod paper_table;
mod parts;
pub(super) mod sequence;
pub(super) mod setup;
pub(super) mod stations;
pub(super) mod tool_frames;
pub(super) mod validation;
pub(super) mod verdict;
pub(super) mod verification;

use crate::report::evidence::{Evidence, TargetEvidence};

use super::Block;

/// The blocks on every target from which a calibration is to be computed, each under its name where there are several. A
/// table's id gets the target's place, so that no two tables have one file.
fn of_each_target(evidence: &Evidence, blocks: impl Fn(&TargetEvidence, &str) -> Vec<Block>) -> Vec<Block> {
    let targets: Vec<&TargetEvidence> = evidence.targets.iter().filter(|target| target.outcome.is_ok()).collect();
    let of_target = |(idx, target): (usize, &&TargetEvidence)| {
        let suffix = if idx == 0 { String::new() } else { format!("-target-{}", idx + 1) };
        let mut of_target = blocks(target, &suffix);
        if targets.len() > 1 && !of_target.is_empty() {
            of_target.insert(0, Block::Heading(target.name.clone()));
        }
        of_target
    };
    targets.iter().enumerate().flat_map(of_target).collect()
}
