//! Stations at a plate that contradict the rest, found by leaving them out one after the other. Whether a pose or a profile
//! is to blame cannot be told from one station; that it saw the other edge can.

use crate::calibrate::plate::PlateRefit;
use crate::calibrate::plate::points::{EdgePoint, NUM_UNKNOWNS};
use crate::calibrate::{Edge, PlateFound, PlateProblem, PlateReduced, Solution};
use crate::diagnose::finding::{Evidence, Fault, Finding, Plot, Severity, StationBar};
use crate::diagnose::remedy::Remedy;
use crate::geometry::{Rigid, stats};

use super::edges;

/// Below this nobody need look, mm: the resolution of a good arm.
const WORTH_NAMING_MM: f64 = 0.05;
/// So far off by chance once in ten thousand sessions.
const MAX_CHANCE: f64 = 1e-4;
/// Of more stations than this part being wrong, nobody can tell which ones.
const MOST_WRONG_PART: f64 = 0.34;
/// Points this many times nearer to the other edge than to their own, ...
const FITS_OTHER_EDGE_RATIO: f64 = 4.0;
/// ... and no further off it than this many times what the others are off theirs, are of that edge. An edge found without
/// some of its points is less well known than they are.
const FITS_OTHER_EDGE_TYPICAL: f64 = 10.0;
/// Poses that differ by less were not measured anew: far below the noise of any arm (mm, rad).
const SAME_POSE: f64 = 1e-5;

/// A station against the solution of the rest.
struct LeftOut {
    station: usize,
    refit: PlateRefit,
    /// Its squared residual a degree of freedom, over that of the rest.
    ratio: f64,
    freedom: f64,
    freedom_of_rest: f64,
}

/// One finding a station that contradicts the rest; `None` if that cannot be told.
pub(super) fn examine(problem: &PlateProblem, solution: &Solution) -> Option<Vec<Finding>> {
    let plate = solution.plate.as_ref()?;
    let reduced = &plate.reduced;
    let mut accused: Vec<usize> = Vec::new();
    let mut rest: Option<PlateRefit> = None;
    // The worst one first: what it bends of the others' residuals is gone once it is out.
    while let Some(worst) = worst(reduced, &accused) {
        #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 stations")]
        let chance = MAX_CHANCE / reduced.num_stations as f64;
        let limit = stats::f_quantile(1.0 - chance, worst.freedom, worst.freedom_of_rest);
        let off_mm = off_edge_mm(reduced, &worst.refit, worst.station);
        if !(worst.ratio > limit && off_mm > WORTH_NAMING_MM) {
            break;
        }
        accused.push(worst.station);
        rest = Some(worst.refit);
        #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 stations")]
        if accused.len() as f64 > MOST_WRONG_PART * reduced.num_stations as f64 {
            return None;
        }
    }
    let rest = rest?;
    let distances: Vec<f64> = (0..reduced.num_stations).map(|station| off_edge_mm(reduced, &rest, station)).collect();
    let mut others: Vec<f64> =
        (0..reduced.num_stations).filter(|station| !accused.contains(station)).map(|idx| distances[idx]).collect();
    let after_mm = stats::rms(others.iter().copied());
    let typical_mm = stats::median(&mut others);
    let before_mm = solution.scatter.rms_mm;
    let findings = accused.iter().filter_map(|station| {
        let (station_idx, _) = named(plate, *station)?;
        let off_mm = distances[*station];
        let explains = before_mm / after_mm.max(1e-9);
        let evidence =
            Evidence { residual_mm: Some([before_mm, after_mm]), plot: Some(bars(plate, &distances, *station)) };
        let (edge, off_other_mm) = off_other_edge(reduced, &rest, *station)?;
        let is_of_other = off_other_mm * FITS_OTHER_EDGE_RATIO < off_mm
            && off_other_mm < (FITS_OTHER_EDGE_TYPICAL * typical_mm).max(WORTH_NAMING_MM);
        if is_of_other {
            return Some(edges::finding(station_idx, edge, explains, evidence));
        }
        let fault = match stale_from(problem, station_idx) {
            Some(pose_of_idx) => Fault::StalePose { station_idx, pose_of_idx, off_mm },
            None => Fault::WrongStation { station_idx, off_mm, typical_mm },
        };
        let remedy = Some(Remedy::LeaveOut(vec![station_idx]));
        Some(Finding { fault, severity: Severity::Wrong, explains, evidence, remedy })
    });
    Some(findings.collect())
}

fn worst(reduced: &PlateReduced, accused: &[usize]) -> Option<LeftOut> {
    (0..reduced.num_stations)
        .filter(|station| !accused.contains(station))
        .filter_map(|station| left_out(reduced, accused, station))
        .max_by(|a, b| a.ratio.total_cmp(&b.ratio))
}

/// A station against the solution without it and without those accused already.
fn left_out(reduced: &PlateReduced, accused: &[usize], station: usize) -> Option<LeftOut> {
    let is_used = |other: usize| other != station && !accused.contains(&other);
    let refit = reduced.solve_with(is_used).ok()?;
    let squares = |chosen: &dyn Fn(usize) -> bool| {
        let points = reduced.points.iter().filter(|point| chosen(point.station));
        points.fold((0.0, 0_usize), |(sum, count), point| {
            let off = refit.state.off_edge(point);
            (sum + off.dot(&(point.information * off)), count + 1)
        })
    };
    let (sum_of_rest, num_rest) = squares(&is_used);
    #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 points")]
    let freedom_of_rest = (2 * num_rest).checked_sub(NUM_UNKNOWNS).filter(|freedom| *freedom > 0)? as f64;
    let scale = (sum_of_rest / freedom_of_rest).max(f64::MIN_POSITIVE);
    let (mut sum, mut freedom) = (0.0, 0.0);
    for point in reduced.points.iter().filter(|point| point.station == station) {
        let by_unknowns = refit.state.by_unknowns(point);
        let expected = by_unknowns * refit.covariance * by_unknowns.transpose() + point.information.try_inverse()?;
        let off = refit.state.off_edge(point);
        sum += off.dot(&(expected.try_inverse()? * off));
        freedom += 2.0;
    }
    Some(LeftOut { station, refit, ratio: sum / freedom / scale, freedom, freedom_of_rest })
}

/// RMS distance of a station's points from their edge, mm.
fn off_edge_mm(reduced: &PlateReduced, refit: &PlateRefit, station: usize) -> f64 {
    let own = reduced.points.iter().filter(|point| point.station == station);
    stats::rms(own.map(|point| refit.state.off_edge(point).norm()))
}

/// The edge that a station is not said to have seen, and the RMS distance of its points from that, mm.
fn off_other_edge(reduced: &PlateReduced, refit: &PlateRefit, station: usize) -> Option<(Edge, f64)> {
    let own = || reduced.points.iter().filter(|point| point.station == station);
    let edge = edges::other(own().next()?.edge);
    let turned = own().map(|point| EdgePoint { edge, ..*point });
    Some((edge, stats::rms(turned.map(|point| refit.state.off_edge(&point).norm()))))
}

/// The session's index of a station, and its name.
fn named(plate: &PlateFound, station: usize) -> Option<(usize, &str)> {
    let named = plate.points.iter().find(|point| point.station == station)?;
    Some((named.station_idx, &named.label))
}

fn bars(plate: &PlateFound, distances: &[f64], accused: usize) -> Plot {
    let bars = distances.iter().enumerate().filter_map(|(station, error_mm)| {
        let (station_idx, label) = named(plate, station)?;
        let label = label.to_owned();
        Some(StationBar { station_idx, label, error_mm: *error_mm, is_accused: station == accused })
    });
    Plot::Stations(bars.collect())
}

/// The station before whose pose this one still has.
fn stale_from(problem: &PlateProblem, station_idx: usize) -> Option<usize> {
    let pose = |place: usize| -> Option<&Rigid> {
        Some(problem.stations.get(place)?.station.captures.first()?.base_from_flange.rigid())
    };
    let place = problem.stations.iter().position(|station| station.station.idx == station_idx)?;
    let own = pose(place)?;
    let is_same = |other: &Rigid| {
        (own.translation.vector - other.translation.vector).norm() < SAME_POSE
            && own.rotation.angle_to(&other.rotation) < SAME_POSE
    };
    let before = place.checked_sub(1)?;
    pose(before).is_some_and(is_same).then(|| problem.stations[before].station.idx)
}
