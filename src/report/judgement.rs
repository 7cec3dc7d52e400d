//! The verdict on a result, as the window and a report begin with it.

use crate::calibrate::{Method, MethodResult, Solution, Verdict, VerdictReason, best_available, verdict};
use crate::diagnose::{Diagnosis, Reason, verdict_with};
use crate::session::Session;
use crate::text;

/// The point that the headline is about.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorkspacePoint {
    /// Where it is along the range axis, mm.
    pub z_mm: f64,
    /// Whether the session states that distance; otherwise the point is amid what was seen.
    pub is_stated: bool,
    /// Its standard deviation, mm.
    pub std_mm: f64,
}

/// A verdict with what it rests on.
#[derive(Clone, Debug, PartialEq)]
pub struct Judgement {
    /// The method that is judged.
    pub method: Method,
    /// The verdict.
    pub verdict: Verdict,
    /// Its reason in a sentence.
    pub reason: String,
    /// The verdict by the figures alone and the code of the warning or finding that lowered it; `None` where none did.
    pub lowered: Option<(Verdict, &'static str)>,
    /// How well a point is known.
    pub workspace_point: Option<WorkspacePoint>,
    /// Sentence and remedy of each warning.
    pub warnings: Vec<(String, &'static str)>,
}

impl Judgement {
    /// On the best available solution; `None` without one.
    #[must_use]
    pub fn new(session: &Session, results: &[MethodResult], diagnosis: Option<&Diagnosis>) -> Option<Self> {
        best_available(results).map(|solution| Self::on(session, solution, diagnosis))
    }

    /// On a solution.
    #[must_use]
    pub fn on(session: &Session, solution: &Solution, diagnosis: Option<&Diagnosis>) -> Self {
        let (verdict, reason) = verdict_with(solution, diagnosis);
        let lowered = match reason {
            // A warning decides only where the figures are good.
            Reason::Solution(VerdictReason::Warning(idx)) => {
                solution.warnings.get(idx).map(|warning| (Verdict::Good, warning.code()))
            }
            Reason::Solution(_) => None,
            Reason::Finding(finding) => {
                let (by_figures, why) = verdict::judge(solution);
                let by_figures = if matches!(why, VerdictReason::Warning(_)) { Verdict::Good } else { by_figures };
                (by_figures < verdict).then(|| (by_figures, finding.fault.code()))
            }
        };
        Self {
            method: solution.method,
            verdict,
            lowered,
            reason: match reason {
                Reason::Solution(reason) => text::compare::verdict_reason(solution, reason),
                Reason::Finding(finding) => text::diagnosis::fault_message(&finding.fault, session),
            },
            workspace_point: solution.uncertainty.as_ref().map(|uncertainty| WorkspacePoint {
                z_mm: uncertainty.reference_point_in_sensor_mm.z,
                is_stated: session.sensor.reference_distance_mm.is_some(),
                std_mm: uncertainty.workspace_point_std_mm,
            }),
            warnings: solution
                .warnings
                .iter()
                .map(|warning| (text::warnings::warning_message(warning), text::warnings::warning_remedy(warning)))
                .collect(),
        }
    }
}
