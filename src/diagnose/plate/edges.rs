//! A station at a plate that saw the other edge than the session says, found by setting the stations to the other edge one
//! after the other. Nothing else of a station puts its points on a line that they were not meant for.

use crate::calibrate::plate::rough_fit_mm;
use crate::calibrate::{Edge, PlateProblem};
use crate::diagnose::finding::{Evidence, Fault, Finding, Severity};
use crate::diagnose::remedy::Remedy;
use crate::watch::{Cancelled, Watch};

/// The points must fit this many times better at least; with any other station turned they hardly fit better at all.
const MIN_RATIO: f64 = 4.0;
/// Below this (mm) residuals are rounding.
const ROUNDING_MM: f64 = 1e-3;

/// The finding, if the points fit far better with one station at the other edge.
///
/// # Errors
/// [`Cancelled`] if `watch` says so.
pub(super) fn examine(problem: &PlateProblem, watch: &mut dyn Watch) -> Result<Option<Finding>, Cancelled> {
    let Some(as_given_mm) = rough_fit_mm(problem) else { return Ok(None) };
    let mut best: Option<(usize, f64)> = None;
    let total = problem.stations.len();
    for place in 0..total {
        watch.report(place, total)?;
        let mut turned = problem.clone();
        turned.stations[place].edge = other(turned.stations[place].edge);
        if let Some(rms_mm) = rough_fit_mm(&turned)
            && best.is_none_or(|(_, least_mm)| rms_mm < least_mm)
        {
            best = Some((place, rms_mm));
        }
    }
    let fits = |mended_mm: f64| mended_mm < super::FAR_OFF_MM && as_given_mm > MIN_RATIO * mended_mm.max(ROUNDING_MM);
    Ok(best.filter(|(_, mended_mm)| fits(*mended_mm)).map(|(place, mended_mm)| {
        let at_plate = &problem.stations[place];
        let evidence = Evidence { residual_mm: Some([as_given_mm, mended_mm]), plot: None };
        finding(at_plate.station.idx, other(at_plate.edge), as_given_mm / mended_mm.max(ROUNDING_MM), evidence)
    }))
}

/// What is said of a station that saw `edge`, and not the one that it is set to.
pub(super) const fn finding(station_idx: usize, edge: Edge, explains: f64, evidence: Evidence) -> Finding {
    Finding {
        fault: Fault::WrongEdge { station_idx, edge },
        severity: Severity::Wrong,
        explains,
        evidence,
        remedy: Some(Remedy::SetEdge { station_idx, edge }),
    }
}

/// The plate's other edge.
pub(super) const fn other(edge: Edge) -> Edge {
    match edge {
        Edge::P => Edge::Q,
        Edge::Q => Edge::P,
    }
}
