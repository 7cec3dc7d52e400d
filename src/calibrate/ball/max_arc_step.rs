//! `ball-max-arc-step`: step along Y until the section is the largest, as published.
//!
//! # Source
//! Lin & Mu 2019, section 2, fig. 3 and eq. 3: the ball's centre in the frame of the first profile is (x1, n·d, z1), with
//! x1 and z1 of the profile at which the search stopped.

use crate::calibrate::observation::{CentreObservation, State};
use crate::calibrate::rotation_start::PoseGeometry;
use crate::calibrate::solver::{Gradient, minimise};
use crate::calibrate::{BallProblem, Method, Solution, SolveError};
use crate::geometry::{Rigid, Vec3};

use super::assemble::{Found, StationFacts};
use super::fixed_point::scaled_spread;
use super::sweep::{StationSweep, step_warning, sweeps, travel_direction};

/// Where the published search stops: at the first section with l ≥ R, or, as with noise it may never come, at the largest.
pub(super) fn published_stop(sweep: &StationSweep<'_>, ball_radius_mm: f64) -> usize {
    let radius = |idx: usize| sweep.steps[idx].arc.circle.radius_mm;
    (0..sweep.steps.len())
        .find(|idx| radius(*idx) >= ball_radius_mm)
        .unwrap_or_else(|| (0..sweep.steps.len()).max_by(|a, b| radius(*a).total_cmp(&radius(*b))).unwrap_or(0))
}

/// n·d: the commanded travel to a step, or, where it is not recorded, the travel of the poses along the common direction.
pub(super) fn commanded_travel_mm(sweep: &StationSweep<'_>, step: usize, direction: Vec3) -> f64 {
    let step = &sweep.steps[step];
    step.commanded_mm.unwrap_or_else(|| direction.dot(&step.travel_in_flange))
}

/// Solves by the published stop.
///
/// # Errors
/// [`SolveError`] with fewer than four usable sweeps, or if they leave a direction free.
pub fn solve(problem: &BallProblem) -> Result<Solution, SolveError> {
    find(problem)?.into_solution()
}

/// The minimum alone, for other methods to start from.
pub(super) fn state(problem: &BallProblem) -> Result<State, SolveError> {
    Ok(find(problem)?.minimum.state)
}

fn find(problem: &BallProblem) -> Result<Found<'_>, SolveError> {
    let mut warnings = Vec::new();
    let sweeps = sweeps(problem, &mut warnings)?;
    let direction = travel_direction(&sweeps);
    warnings.extend(step_warning(&sweeps, direction));
    let base_from_flange: Vec<Rigid> = sweeps.iter().map(|sweep| *sweep.first_pose).collect();
    let poses = PoseGeometry::new(&base_from_flange)?;
    // Whether the robot's Y runs along the sensor's y or against it is one unknown sign for all stations.
    let (centres, rotation) = [1.0, -1.0]
        .map(|sign| {
            let centres: Vec<Vec3> = sweeps
                .iter()
                .map(|sweep| {
                    let stop = published_stop(sweep, problem.radius_mm);
                    let circle = sweep.steps[stop].arc.circle;
                    Vec3::new(circle.x_mm, sign * commanded_travel_mm(sweep, stop, direction), circle.z_mm)
                })
                .collect();
            let minimum = poses.reduced(&centres).best_minimum();
            (centres, minimum)
        })
        .into_iter()
        .min_by(|a, b| a.1.cost.total_cmp(&b.1.cost))
        .map(|(centres, minimum)| (centres, minimum.flange_from_sensor))
        .ok_or(SolveError::Diverged)?;
    let start = poses.reduced(&centres).state(rotation);
    let observations = CentreObservation::points(&base_from_flange, &centres);
    let minimum = minimise(&observations.iter(), start)?;
    let spread = scaled_spread(&observations, &minimum.state);
    let stations = sweeps
        .iter()
        .map(|sweep| StationFacts {
            station: sweep.station,
            side_cost_ratio: None,
            target_in_sensor_std_mm: None,
            sweep: None,
        })
        .collect();
    Ok(Found {
        method: Method::BallMaxArcStep,
        problem,
        stations,
        observations,
        common_covariance: Vec::new(),
        minimum,
        spread,
        noise: None,
        radius: None,
        // The radius enters by the rule to stop at only.
        by_radius: Gradient::zeros(),
        prior_information: 0.0,
        poses,
        warnings,
    })
}
