//! What is wrong with a session of a target's poses: lists that are inverted, poses that contradict the rest, and what the
//! method itself says.

use crate::calibrate::validation::validate;
use crate::calibrate::{MethodResult, Warning, best_available};
use crate::watch::{Cancelled, Watch};

use super::finding::{Finding, Severity};
use super::plate::{of_error, of_warning, plain};
use super::{Diagnosis, Remedy, weighing};

/// Examines the results of such a session.
///
/// # Errors
/// [`Cancelled`] if `watch` says so.
pub(super) fn examine(results: &[MethodResult], watch: &mut dyn Watch) -> Result<Diagnosis, Cancelled> {
    watch.report(0, 1)?;
    let best = best_available(results);
    let validation = best.and_then(validate);
    let mut findings: Vec<Finding> = Vec::new();
    match best {
        Some(solution) => {
            let rejected = solution.motion.iter().flat_map(|motion| &motion.rejected);
            let station_of =
                |label: &str| rejected.clone().find(|pose| pose.label == label).map(|pose| pose.station_idx);
            findings.extend(solution.warnings.iter().map(|warning| {
                let finding = of_warning(warning);
                match warning {
                    Warning::StreamInverted { ratio } => Finding {
                        severity: Severity::Wrong,
                        explains: *ratio,
                        remedy: Some(Remedy::ToOtherMount),
                        ..finding
                    },
                    Warning::PoseRejected { label, .. } => Finding {
                        severity: Severity::Doubtful,
                        remedy: station_of(label).map(|station_idx| Remedy::LeaveOut(vec![station_idx])),
                        ..finding
                    },
                    Warning::TargetScale { factor, .. } => {
                        Finding { severity: Severity::Wrong, remedy: Some(Remedy::ScaleTargets(*factor)), ..finding }
                    }
                    _ => finding,
                }
            }));
            let is_wrong = findings.iter().any(|finding| finding.severity == Severity::Wrong);
            if !is_wrong && let Some(validation) = &validation {
                findings.extend(weighing::from_validation(validation).map(|(fault, severity)| plain(fault, severity)));
            }
        }
        None => findings.extend(results.iter().find_map(|result| result.outcome.as_ref().err()).map(of_error)),
    }
    findings.sort_by(Finding::more_serious_first);
    Ok(Diagnosis { findings, readings: Vec::new(), validation })
}
