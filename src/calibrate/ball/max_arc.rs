//! `ball-max-arc`: the whole radius-vs-step curve, with the real pose of every step.
//!
//! # Source
//! Ours, after Lin & Mu 2019, section 2. Near its top the curve is flat, so the published stop is off by about √(2 R `σ_l`);
//! its flanks tell where the top is: l² = R² − (y − y₀)². "Robot Y" is the laser's normal only once the calibration is
//! known, so the curves of all stations are fitted together with it: every step's (x, z, l) against what a ball at one
//! place in the base gives in the sensor frame of the step's real pose.

use crate::calibrate::observation::{CentreObservation, State};
use crate::calibrate::rotation_start::PoseGeometry;
use crate::calibrate::uncertainty::Spread;
use crate::calibrate::{BallProblem, Method, Solution, SolveError, Sweep, Warning};
use crate::geometry::{Rigid, stats};

use super::assemble::{Found, StationFacts};
use super::curve::{evaluated_sweep, fit_curve, radius_from_sweeps, section_observation, section_residual};
use super::passes::{Settled, settle};
use super::sweep::{StationSweep, step_warning, sweeps, travel_direction};
use super::{fixed_point, max_arc_step};

/// A radius this many standard deviations off ...
const RADIUS_AT_STDS: f64 = 4.0;
/// ... and by this part is worth a warning: 0.03 mm on a ball of 15 mm, several times the tolerance of a cheap one.
const RADIUS_PART: f64 = 0.002;
/// Travel may differ from the laser's normal by this, degrees, before the published method suffers visibly.
const OFF_NORMAL_DEG: f64 = 1.0;

/// Solves by the whole curves.
///
/// # Errors
/// [`SolveError`] with fewer than four usable sweeps, or if they leave a direction free.
pub fn solve(problem: &BallProblem) -> Result<Solution, SolveError> {
    find(problem)?.into_solution()
}

/// The minimum alone, for other methods to start from.
pub(super) fn state(problem: &BallProblem) -> Result<State, SolveError> {
    let sweeps = sweeps(problem, &mut Vec::new())?;
    Ok(settle_from_best_start(problem, &sweeps)?.minimum.state)
}

fn find(problem: &BallProblem) -> Result<Found<'_>, SolveError> {
    let mut warnings = Vec::new();
    let sweeps = sweeps(problem, &mut warnings)?;
    let direction = travel_direction(&sweeps);
    warnings.extend(step_warning(&sweeps, direction));
    let base_from_flange: Vec<Rigid> = sweeps.iter().map(|sweep| *sweep.first_pose).collect();
    let poses = PoseGeometry::new(&base_from_flange)?;
    let found = settle_from_best_start(problem, &sweeps)?;
    let state = found.minimum.state;
    let stations = sweeps
        .iter()
        .map(|sweep| {
            let curve =
                fit_curve(problem, sweep, &state, found.pose_noise.position_std_mm()).ok_or(SolveError::Diverged)?;
            Ok(StationFacts {
                station: sweep.station,
                side_cost_ratio: None,
                target_in_sensor_std_mm: Some(curve.covariance.diagonal().map(|v| v.max(0.0).sqrt())),
                sweep: Some(evaluated_sweep(problem, sweep, &curve, &state, direction)),
            })
        })
        .collect::<Result<Vec<_>, SolveError>>()?;
    add_sweep_warnings(&stations, &mut warnings);
    let evaluated: Vec<Sweep> = stations.iter().filter_map(|facts| facts.sweep.clone()).collect();
    warnings.extend(radius_warning(problem, &evaluated));
    Ok(Found {
        method: Method::BallMaxArc,
        problem,
        stations,
        spread: Some(Spread::Modelled(Box::new(found.spread))),
        noise: Some(found.pose_noise.model(found.above_stated)),
        radius: found.radius,
        by_radius: found.by_radius,
        observations: found.observations,
        common_covariance: found.common_covariance,
        minimum: found.minimum,
        // A station blind along y still knows that the ball is not further off than its radius.
        prior_information: 1.0 / (problem.radius_mm * problem.radius_mm),
        poses,
        warnings,
    })
}

/// Whether the sweeps of a problem, seen with a calibration, show another radius than the session says.
pub(super) fn radius_warning_at(problem: &BallProblem, state: &State) -> Option<Warning> {
    let sweeps = sweeps(problem, &mut Vec::new()).ok()?;
    let direction = travel_direction(&sweeps);
    let evaluated: Vec<Sweep> = sweeps
        .iter()
        .filter_map(|sweep| {
            fit_curve(problem, sweep, state, 0.0).map(|curve| evaluated_sweep(problem, sweep, &curve, state, direction))
        })
        .collect();
    radius_warning(problem, &evaluated)
}

fn radius_warning(problem: &BallProblem, sweeps: &[Sweep]) -> Option<Warning> {
    if problem.radius_std_mm.is_some() {
        // It is estimated.
        return None;
    }
    let (found_mm, std_mm) = radius_from_sweeps(sweeps)?;
    let difference_mm = (found_mm - problem.radius_mm).abs();
    let is_wrong = difference_mm > RADIUS_AT_STDS * std_mm && difference_mm > RADIUS_PART * problem.radius_mm;
    is_wrong.then_some(Warning::RadiusDisagrees { found_mm, std_mm, ball_radius_mm: problem.radius_mm })
}

/// A published stop that went astray must not spoil the better method: the fixed-point answer is tried as well.
fn settle_from_best_start(problem: &BallProblem, sweeps: &[StationSweep<'_>]) -> Result<Settled, SolveError> {
    type Start = fn(&BallProblem) -> Result<State, SolveError>;
    /// A residual below this part of the radius is no minimum far off.
    const FITS_PART: f64 = 0.01;
    let mut best: Option<(f64, Settled)> = None;
    let mut failure = SolveError::Diverged;
    for start in [max_arc_step::state as Start, fixed_point::state] {
        let Ok(start) = start(problem) else { continue };
        match settle(|state, radius_mm| linearised(sweeps, state, radius_mm), problem, start) {
            Ok(settled) => {
                let residual_mm = rms_section_residual(problem, sweeps, &settled.minimum.state);
                let fits = residual_mm < FITS_PART * problem.radius_mm;
                if best.as_ref().is_none_or(|(least, _)| residual_mm < *least) {
                    best = Some((residual_mm, settled));
                }
                if fits {
                    break;
                }
            }
            Err(error) => failure = error,
        }
    }
    best.map(|(_, settled)| settled).ok_or(failure)
}

fn linearised(sweeps: &[StationSweep<'_>], state: &State, radius_mm: f64) -> Vec<CentreObservation> {
    sweeps
        .iter()
        .enumerate()
        .flat_map(|(station, sweep)| {
            sweep.steps.iter().filter_map(move |step| {
                let predicted = state.ball_in_sensor(step.base_from_flange);
                section_observation(station, step, radius_mm, predicted)
            })
        })
        .collect()
}

fn rms_section_residual(problem: &BallProblem, sweeps: &[StationSweep<'_>], state: &State) -> f64 {
    stats::rms(sweeps.iter().flat_map(|sweep| &sweep.steps).map(|step| {
        let predicted = state.ball_in_sensor(step.base_from_flange);
        section_residual(step.arc, problem.radius_mm, predicted).0.norm()
    }))
}

fn add_sweep_warnings(stations: &[StationFacts<'_>], warnings: &mut Vec<Warning>) {
    let mut most_off_normal: Option<(&str, f64)> = None;
    for facts in stations {
        let Some(sweep) = &facts.sweep else { continue };
        let angle_deg = sweep.travel_off_normal_rad.to_degrees();
        if angle_deg > OFF_NORMAL_DEG && most_off_normal.is_none_or(|(_, most)| angle_deg > most) {
            most_off_normal = Some((&facts.station.label, angle_deg));
        }
        if !sweep.covers_peak {
            let beyond_mm =
                sweep.points.iter().map(|point| (point.travel_mm - sweep.peak_mm).abs()).fold(f64::INFINITY, f64::min);
            warnings.push(Warning::PeakNotCovered { label: facts.station.label.clone(), beyond_mm });
        }
    }
    if let Some((label, angle_deg)) = most_off_normal {
        warnings.push(Warning::TravelOffNormal { label: label.to_owned(), angle_deg });
    }
}
