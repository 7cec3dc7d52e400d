//! The verdict on a solution in the light of the diagnosis.

use crate::calibrate::{Solution, Verdict, VerdictReason, verdict};

use super::{Diagnosis, Finding, Severity};

/// What the verdict rests on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reason<'a> {
    /// Figures and warnings of the solution.
    Solution(VerdictReason),
    /// A finding that weighs more than the figures.
    Finding(&'a Finding),
}

/// Judges a solution by its figures; a finding can only make the verdict worse. Small figures prove nothing while a
/// finding says why they would be small all the same.
#[must_use]
pub fn verdict_with<'a>(solution: &Solution, diagnosis: Option<&'a Diagnosis>) -> (Verdict, Reason<'a>) {
    let (by_figures, reason) = verdict::judge(solution);
    let findings = diagnosis.map_or(&[][..], |diagnosis| &diagnosis.findings);
    let worst = findings.iter().min_by_key(|finding| finding.severity);
    match worst.map(|finding| (finding, at_best(finding.severity))) {
        Some((finding, at_best)) if at_best > by_figures => (at_best, Reason::Finding(finding)),
        // Of two reasons for the same verdict, the finding says more.
        Some((finding, at_best)) if at_best == by_figures && by_figures != Verdict::Good => {
            (by_figures, Reason::Finding(finding))
        }
        _ => (by_figures, Reason::Solution(reason)),
    }
}

/// The best verdict that a finding leaves possible.
const fn at_best(severity: Severity) -> Verdict {
    match severity {
        Severity::Wrong => Verdict::NotUsable,
        Severity::Doubtful => Verdict::Usable,
        Severity::Note => Verdict::Good,
    }
}
