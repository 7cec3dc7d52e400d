//! What the methods themselves say of a session whose target is no ball.

use crate::calibrate::validation::validate;
use crate::calibrate::{MethodResult, best_available};

use super::finding::{Fault, Finding, Severity};
use super::{Diagnosis, Evidence};

/// The warnings of the best result as findings, or why there is none.
pub(super) fn examine(results: &[MethodResult]) -> Diagnosis {
    let best = best_available(results);
    let mut said: Vec<(Fault, Severity)> = Vec::new();
    match best {
        Some(solution) => said.extend(solution.warnings.iter().map(|warning| {
            let severity = if warning.casts_doubt() { Severity::Doubtful } else { Severity::Note };
            (Fault::Method(warning.clone()), severity)
        })),
        None => said.extend(
            results
                .iter()
                .find_map(|result| result.outcome.as_ref().err())
                .map(|error| (Fault::NotSolved(error.clone()), Severity::Wrong)),
        ),
    }
    let mut findings: Vec<Finding> = said
        .into_iter()
        .map(|(fault, severity)| Finding {
            fault,
            severity,
            explains: 1.0,
            evidence: Evidence::default(),
            remedy: None,
        })
        .collect();
    findings.sort_by(Finding::more_serious_first);
    Diagnosis { findings, readings: Vec::new(), validation: best.and_then(validate) }
}
