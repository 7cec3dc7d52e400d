//! What is wrong with a plate's session: a station that saw the other edge or contradicts the rest, poses read in another way, and what the
//! methods themselves say.

mod edges;
mod readings;
mod stations;

use crate::calibrate::validation::validate;
use crate::calibrate::{MethodResult, PlateProblem, SolveError, Warning, best_available};
use crate::geometry::Vec3;
use crate::session::Session;
use crate::watch::{Cancelled, Watch};

use super::finding::{Fault, Finding, Severity};
use super::{Diagnosis, Evidence, weighing};

/// Points that scatter by more than this about their edges, mm, are not those of one calibration: no robot and no profiler
/// is that poor.
const FAR_OFF_MM: f64 = 1.0;

/// Examines a plate's session and its results.
///
/// # Errors
/// [`Cancelled`] if `watch` says so.
pub(super) fn examine(
    session: &Session,
    problem: &PlateProblem,
    results: &[MethodResult],
    watch: &mut dyn Watch,
) -> Result<Diagnosis, Cancelled> {
    watch.report(0, 2)?;
    let best = best_available(results);
    let mut ranking = Vec::new();
    let scatter_mm = best.map_or(f64::INFINITY, |solution| solution.scatter.rms_mm);
    // First, as a station at the wrong edge bends the solution so much that others seem to be off.
    let at_wrong_edge = if scatter_mm > FAR_OFF_MM { edges::examine(problem, watch)? } else { None };
    let mut findings = match at_wrong_edge {
        Some(finding) => vec![finding],
        None => best.and_then(|solution| stations::examine(problem, solution)).unwrap_or_default(),
    };
    let is_named = !findings.is_empty();
    if !is_named && scatter_mm > FAR_OFF_MM {
        let (misread, ranked) = readings::examine(session, problem, watch)?;
        ranking = ranked;
        match misread {
            Some(misread) => findings.push(misread),
            None if best.is_some() => findings.push(plain(Fault::DoesNotFit { scatter_mm }, Severity::Wrong)),
            None => {}
        }
    }
    watch.report(1, 2)?;
    let validation = best.and_then(validate);
    match best {
        Some(solution) => {
            let is_wrong = !findings.is_empty();
            let said = |warning: &&Warning| !(is_wrong && matches!(warning, Warning::StationStandsOut { .. }));
            findings.extend(solution.warnings.iter().filter(said).map(of_warning));
            if !is_wrong && let Some(validation) = &validation {
                findings.extend(weighing::from_validation(validation).map(|(fault, severity)| plain(fault, severity)));
            }
        }
        None => findings.extend(results.iter().find_map(|result| result.outcome.as_ref().err()).map(of_error)),
    }
    findings.sort_by(Finding::more_serious_first);
    Ok(Diagnosis { findings, readings: ranking, validation })
}

pub(super) fn plain(fault: Fault, severity: Severity) -> Finding {
    Finding { fault, severity, explains: 1.0, evidence: Evidence::default(), remedy: None }
}

pub(super) fn of_warning(warning: &Warning) -> Finding {
    let severity = if warning.casts_doubt() { Severity::Doubtful } else { Severity::Note };
    let fault = match warning {
        Warning::LittleRotation { span_deg, recommended_deg } => {
            Fault::LittleRotation { span_deg: *span_deg, recommended_deg: *recommended_deg, weakest: None }
        }
        Warning::NearlyOneAxis { ratio, axis_in_flange } => {
            Fault::OneAxis { axis_in_flange: Vec3::from(*axis_in_flange), ratio: Some(*ratio) }
        }
        other => Fault::Method(other.clone()),
    };
    plain(fault, severity)
}

pub(super) fn of_error(error: &SolveError) -> Finding {
    let fault = match error {
        SolveError::NoRotation { span_deg } => Fault::NoRotation { span_deg: *span_deg },
        SolveError::RotationsAboutOneAxis { axis_x, axis_y, axis_z } => {
            Fault::OneAxis { axis_in_flange: Vec3::new(*axis_x, *axis_y, *axis_z), ratio: None }
        }
        other => Fault::NotSolved(other.clone()),
    };
    plain(fault, Severity::Wrong)
}
