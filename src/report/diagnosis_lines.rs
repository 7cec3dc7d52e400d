//! A diagnosis in lines, as the command line and reports list it: findings, not too many of a kind, and how far the result
//! can be relied on.

use crate::calibrate::{Method, Solution};
use crate::diagnose::{Diagnosis, Finding};
use crate::session::Session;
use crate::text::diagnosis as words;

use super::result_file::Examination;

/// Findings of a kind that are listed before the rest is only counted.
const MAX_OF_A_KIND: usize = 3;

/// An entry of the list.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Listed<'a> {
    /// A finding.
    Finding(&'a Finding),
    /// So many more of this code.
    More(usize, &'static str),
}

/// The findings in order; of a kind the first few, then how many more there are.
#[must_use]
pub fn listed(diagnosis: &Diagnosis) -> Vec<Listed<'_>> {
    let findings = &diagnosis.findings;
    let mut listed = Vec::new();
    for (idx, finding) in findings.iter().enumerate() {
        let code = finding.fault.code();
        let is_of_kind = |other: &&Finding| other.fault.code() == code;
        match findings[..idx].iter().filter(is_of_kind).count() {
            0..MAX_OF_A_KIND => listed.push(Listed::Finding(finding)),
            MAX_OF_A_KIND => {
                listed.push(Listed::More(findings.iter().filter(is_of_kind).count() - MAX_OF_A_KIND, code));
            }
            _ => {}
        }
    }
    listed
}

/// What is to be done first; `None` where nothing was found.
#[must_use]
pub fn next_step(session: &Session, diagnosis: &Diagnosis) -> Option<String> {
    let first = diagnosis.findings.first()?;
    Some(
        first
            .remedy
            .as_ref()
            .map_or_else(|| words::fault_remedy(&first.fault, session), |remedy| words::remedy_label(remedy, session)),
    )
}

/// How far a result can be relied on, a line each: what it is about, a colon, and the figures.
#[must_use]
pub fn accuracy_lines(session: &Session, solution: &Solution, examination: &Examination<'_>) -> Vec<String> {
    let validation = examination.diagnosis.validation.as_ref();
    let most_influential = validation.and_then(|validation| {
        let moves = |idx: usize| validation.influence[idx].moves_workspace_point_mm;
        (0..validation.influence.len())
            .max_by(|a, b| moves(*a).total_cmp(&moves(*b)))
            .map(|idx| &validation.influence[idx])
    });
    // What single poses on the way scatter by is the robot's and the camera's.
    let is_tracked = solution.motion.as_ref().is_some_and(|motion| motion.tracked.is_some());
    [
        validation.and_then(|validation| validation.split_half.as_ref()).map(words::split_half_line),
        validation.and_then(|validation| validation.normality.as_ref()).map(words::normality_line),
        most_influential.map(words::influence_line),
        examination.bootstrap.map(words::bootstrap_line),
        solution.uncertainty.as_ref().map(|uncertainty| words::accuracy_line(uncertainty, solution.mount)),
        // Nothing follows the radius where the readings are centres already.
        (Method::BALL.contains(&solution.method) && solution.change_by_radius.norm() > 0.0)
            .then(|| words::radius_line(solution)),
        solution.radius.as_ref().map(words::estimated_radius_line),
        solution.noise.as_ref().filter(|_| !is_tracked).map(|noise| words::noise_line(noise, &session.robot)),
    ]
    .into_iter()
    .flatten()
    .collect()
}
