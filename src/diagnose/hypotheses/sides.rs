//! Sides and axes: what the session says of the sensor's frame, against what the data show.

use crate::calibrate::{BallProblem, Method, Reading, Side, SideChoice, best_available, solution_of, solve};
use crate::diagnose::Case;
use crate::diagnose::finding::{Axis, Evidence, Fault, Finding, Severity};
use crate::diagnose::model::{Extension, Fit, Model};
use crate::diagnose::remedy::Remedy;

use super::{Solved, falls_by};

/// A ball's centre nearer to the laser plane than this part of the radius has no side worth speaking of.
const NO_SIDE_PART: f64 = 0.05;
/// The residual has to fall by this factor for the given sides to be called wrong.
const FALLS_BY: f64 = 2.0;
/// Fewer given sides than this that are all wrong are a slip of the hand, not a mirrored axis.
const MIN_MIRRORED: usize = 3;
/// A sensor nearer to the flange than this, mm and degrees, is the frame that the controller reports.
const IDENTITY_MM: f64 = 1.0;
const IDENTITY_DEG: f64 = 1.0;

/// The model solved from a solution that does not rely on the given sides; `None` where none is given.
pub(super) fn found_anew(case: Case<'_>, model: &Model) -> Option<Fit> {
    if case.problem.stations.iter().all(|station| station.side == SideChoice::Auto) {
        return None;
    }
    let open = with_sides(case.problem, |_, _| SideChoice::Auto);
    let found = solve(&open, Method::BallFixedPoint).ok()?;
    model.fit(Extension::Plain, model.as_given(found.reduced?.state))
}

fn with_sides(problem: &BallProblem, side: impl Fn(usize, SideChoice) -> SideChoice) -> BallProblem {
    let mut changed = problem.clone();
    for (idx, station) in changed.stations.iter_mut().enumerate() {
        station.side = side(idx, station.side);
    }
    changed
}

pub(super) fn examine(solved: &Solved<'_>) -> Option<Finding> {
    wrong_sides(solved).or_else(|| bulges_away(solved.case))
}

/// The given sides of stations (of the problem) with an arc that the data contradict, and how many sides are given.
fn contradicted(solved: &Solved<'_>) -> (Vec<(usize, Side)>, usize) {
    let state = solved.plain.unknowns.state;
    let given: Vec<(usize, Side, f64)> = solved
        .case
        .problem
        .stations
        .iter()
        .enumerate()
        .filter(|(_, station)| station.captures.iter().any(|capture| matches!(capture.reading, Reading::Arc(_))))
        .filter_map(|(idx, station)| match station.side {
            SideChoice::Given(side) => Some((idx, side, solved.model.first_centre(idx, &state)?.y)),
            SideChoice::Auto => None,
        })
        .filter(|(_, _, y)| y.abs() > NO_SIDE_PART * solved.case.problem.radius_mm)
        .collect();
    let wrong = given.iter().filter(|(_, side, y)| side.sign() * y < 0.0).map(|(idx, side, _)| (*idx, side.flipped()));
    (wrong.collect(), given.len())
}

fn wrong_sides(solved: &Solved<'_>) -> Option<Finding> {
    let (wrong, num_given) = contradicted(solved);
    if wrong.is_empty() {
        return None;
    }
    let mended_side = |idx: usize, side| {
        wrong.iter().find(|(wrong_idx, _)| *wrong_idx == idx).map_or(side, |(_, mended)| SideChoice::Given(*mended))
    };
    let scatter_mm = |problem: &BallProblem| Some(solve(problem, Method::BallFixedPoint).ok()?.scatter.rms_mm);
    let given_mm = match solution_of(solved.case.results, Method::BallFixedPoint) {
        Some(solution) => solution.scatter.rms_mm,
        None => scatter_mm(solved.case.problem)?,
    };
    let residual_mm = [given_mm, scatter_mm(&with_sides(solved.case.problem, mended_side))?];
    if falls_by(residual_mm) < FALLS_BY {
        return None;
    }
    let is_mirrored = wrong.len() == num_given && num_given >= MIN_MIRRORED;
    let (fault, remedy) = if is_mirrored {
        let axis = if arcs_bulge_away(solved.case.problem) { Axis::Z } else { Axis::X };
        (Fault::MirroredAxis { axis }, Remedy::MirrorProfiles(axis))
    } else {
        let station_idxs = wrong.iter().map(|(idx, _)| solved.session_idx(*idx)).collect();
        let sides = wrong.iter().map(|(idx, side)| (solved.session_idx(*idx), SideChoice::Given(*side))).collect();
        (Fault::WrongSides { station_idxs }, Remedy::SetSides(sides))
    };
    Some(Finding {
        fault,
        severity: severity(solved, &wrong),
        explains: falls_by(residual_mm),
        evidence: Evidence { residual_mm: Some(residual_mm), plot: None },
        remedy: Some(remedy),
    })
}

/// Sweeps show the sides by themselves, so the best answer may be right all the same.
fn severity(solved: &Solved<'_>, wrong: &[(usize, Side)]) -> Severity {
    let is_right = best_available(solved.case.results).is_some_and(|best| {
        wrong.iter().all(|(idx, side)| {
            best.stations.iter().any(|station| station.station_idx == solved.session_idx(*idx) && station.side == *side)
        })
    });
    if is_right { Severity::Doubtful } else { Severity::Wrong }
}

/// Seen from a sensor's origin a ball bulges towards it. Where it bulges away, z is a height instead of a distance; some
/// sensors do report that, and the calibration holds for whatever they report.
pub(super) fn bulges_away(case: Case<'_>) -> Option<Finding> {
    arcs_bulge_away(case.problem).then_some(Finding {
        fault: Fault::MirroredAxis { axis: Axis::Z },
        severity: Severity::Note,
        explains: 1.0,
        evidence: Evidence::default(),
        remedy: Some(Remedy::MirrorProfiles(Axis::Z)),
    })
}

/// Whether all arcs bulge towards larger z at positive z, as heights do, further from z = 0 than a ball's diameter: nearer,
/// the origin may well be in the middle of the range.
fn arcs_bulge_away(problem: &BallProblem) -> bool {
    let mut arcs = problem
        .stations
        .iter()
        .flat_map(|station| &station.captures)
        .filter_map(|capture| match &capture.reading {
            Reading::Arc(arc) => Some(arc),
            Reading::Edge(_) | Reading::Refused(_) | Reading::Point(_) | Reading::Pose(_) => None,
        })
        .peekable();
    arcs.peek().is_some()
        && arcs.all(|arc| {
            #[expect(clippy::cast_precision_loss, reason = "a profile has far fewer than 2^52 points")]
            let mean_z_mm = arc.inlier_z_mm.iter().sum::<f64>() / arc.num_inliers() as f64;
            let centre_z_mm = arc.circle.z_mm;
            mean_z_mm > centre_z_mm && centre_z_mm > 2.0 * problem.radius_mm
        })
}

/// A result that is the identity: the controller reports a TOOL that is the sensor's own frame.
pub(super) fn sensor_is_tool(case: Case<'_>) -> Option<Finding> {
    let found = best_available(case.results)?.flange_from_sensor.rigid();
    let distance_mm = found.translation.vector.norm();
    let angle_deg = found.rotation.angle().to_degrees();
    (distance_mm < IDENTITY_MM && angle_deg < IDENTITY_DEG).then_some(Finding {
        fault: Fault::SensorIsTool { distance_mm, angle_deg },
        severity: Severity::Doubtful,
        explains: 1.0,
        evidence: Evidence::default(),
        remedy: None,
    })
}
