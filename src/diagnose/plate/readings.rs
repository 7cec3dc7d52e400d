//! A plate's poses read in the ways that people get wrong. Each reading is a calibration of its own, so only readings with
//! one change are tried, and only where the poses as given do not fit.

use crate::calibrate::plate::{points::NUM_UNKNOWNS, rough_fit_mm};
use crate::calibrate::{Mount, PlateProblem};
use crate::diagnose::convention::{self, PoseReading, ReadingFit};
use crate::diagnose::finding::{Evidence, Fault, Finding, Plot, Severity};
use crate::diagnose::remedy::Remedy;
use crate::geometry::Transform;
use crate::session::Session;
use crate::watch::{Cancelled, Watch};

/// Another reading must fit this many times better at least.
const MIN_RATIO: f64 = 4.0;
/// The chance that one of the wrong readings fits as well as the best one by accident is to be below this.
const MAX_CHANCE: f64 = 1e-3;
/// Ways in the plot.
const NUM_PLOTTED: usize = 8;
/// Below this (mm) residuals are rounding.
const ROUNDING_MM: f64 = 1e-3;

/// The finding, if another way fits far better, and the ranking.
///
/// # Errors
/// [`Cancelled`] if `watch` says so.
pub(super) fn examine(
    session: &Session,
    problem: &PlateProblem,
    watch: &mut dyn Watch,
) -> Result<(Option<Finding>, Vec<ReadingFit>), Cancelled> {
    let station_idxs: Vec<usize> = problem.stations.iter().map(|station| station.station.idx).collect();
    let candidates = convention::of_one_change(session, &station_idxs);
    let total = candidates.len();
    let mut ranking: Vec<ReadingFit> = Vec::with_capacity(total);
    for (done, reading) in candidates.into_iter().enumerate() {
        watch.report(done, total)?;
        let is_as_given = reading.is_as_given();
        let rms_mm = rough_fit_mm(&read_as(session, problem, &reading)).unwrap_or(f64::INFINITY);
        if rms_mm.is_finite() || is_as_given {
            ranking.push(ReadingFit { reading, ties: Vec::new(), rms_mm, is_as_given });
        }
    }
    ranking.sort_by(|a, b| a.rms_mm.total_cmp(&b.rms_mm));
    let num_points: usize = problem.stations.iter().map(|station| station.station.captures.len()).sum();
    Ok((finding(&ranking, (2 * num_points).saturating_sub(NUM_UNKNOWNS)), ranking))
}

fn read_as(session: &Session, problem: &PlateProblem, reading: &PoseReading) -> PlateProblem {
    let mut read = problem.clone();
    for station in &mut read.stations {
        let station_idx = station.station.idx;
        for (capture_idx, capture) in station.station.captures.iter_mut().enumerate() {
            let pose = reading.pose(&session.stations[station_idx], station_idx, capture_idx);
            capture.base_from_flange = Transform::from_rigid(match session.mount {
                Mount::OnFlange => pose,
                Mount::Fixed => pose.inverse(),
            });
        }
    }
    read
}

fn finding(ranking: &[ReadingFit], freedom: usize) -> Option<Finding> {
    let best = ranking.first().filter(|best| !best.is_as_given)?;
    let as_given = ranking.iter().find(|fit| fit.is_as_given)?;
    let ratio = as_given.rms_mm / best.rms_mm.max(ROUNDING_MM);
    #[expect(clippy::cast_precision_loss, reason = "few readings, few points")]
    let (num_readings, freedom) = (ranking.len() as f64, freedom as f64);
    // A residual that is r times smaller by accident has a chance of about r to the power of minus the freedom.
    let needed = (num_readings / MAX_CHANCE).powf(1.0 / freedom);
    if !(freedom > 0.0 && ratio > needed.max(MIN_RATIO) && best.rms_mm < super::FAR_OFF_MM) {
        return None;
    }
    let mut plotted: Vec<ReadingFit> = ranking.iter().take(NUM_PLOTTED).cloned().collect();
    if !plotted.iter().any(|fit| fit.is_as_given) {
        plotted.push(as_given.clone());
    }
    Some(Finding {
        fault: Fault::PosesMisread { reading: best.reading.clone() },
        severity: Severity::Wrong,
        explains: ratio,
        evidence: Evidence { residual_mm: Some([as_given.rms_mm, best.rms_mm]), plot: Some(Plot::Readings(plotted)) },
        remedy: Some(Remedy::ReadPosesAs(best.reading.clone())),
    })
}
