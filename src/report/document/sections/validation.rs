//! How far each target's result can be relied on: left-out errors, halves, influence, noise, and the truth where it is known.

use crate::calibrate::Solution;
use crate::report::compare::distance_from_truth;
use crate::report::diagnosis_lines::accuracy_lines;
use crate::report::document::{Block, Fact, typeset_numbers};
use crate::report::evidence::{Evidence, TargetEvidence};
use crate::text::digits::{self, fixed};
use crate::text::report as words;

use super::of_each_target;

pub(in crate::report::document) fn blocks(evidence: &Evidence) -> Vec<Block> {
    of_each_target(evidence, |target, _| of_target(target))
}

fn of_target(target: &TargetEvidence) -> Vec<Block> {
    let (Some(solution), Ok(solved)) = (target.best(), &target.outcome) else { return Vec::new() };
    let of = &target.session.target;
    let left_out = solution.leave_one_out.map_or_else(
        || words::NO_LEAVE_ONE_OUT.to_owned(),
        |left_out| words::distances_line(of, &size(left_out.rms_mm), &size(left_out.max_mm)),
    );
    let in_sample = words::distances_line(of, &size(solution.scatter.rms_mm), &size(solution.scatter.max_mm));
    let span = format!("{}°", fixed(solution.rotation_span_rad.to_degrees(), 1));
    let mut facts = vec![
        Fact::new(words::METHOD, words::method_and_id(solution.method)),
        Fact::new(words::LEAVE_ONE_OUT, left_out),
        Fact::new(words::IN_SAMPLE, in_sample),
        Fact::new(words::ROTATION_SPAN, span),
    ];
    facts.extend(truth(target, solution));
    for line in accuracy_lines(&target.session, solution, &solved.examined.examination()) {
        let (name, value) = line.split_once(": ").unwrap_or((words::IF_RADIUS, line.as_str()));
        facts.push(Fact::new(capitalised(name), typeset_numbers(value)));
    }
    vec![Block::Facts(facts)]
}

fn truth(target: &TargetEvidence, solution: &Solution) -> Option<Fact> {
    let distance = distance_from_truth(solution, target.session.truth.as_ref()?);
    let line = words::truth_line(&size(distance.workspace_point_mm), &size(distance.rotation_rad.to_degrees()));
    Some(Fact::new(words::TRUTH, line))
}

/// An error: two digits of it, and no more than a tenth of a micrometre.
fn size(value: f64) -> String {
    fixed(value, digits::decimals_for(Some(value.abs())).min(4))
}

fn capitalised(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}
