//! Passes over the data until nothing moves: linearise, weigh by the noise of the poses, minimise, and again.

use crate::calibrate::observation::{CentreObservation, State};
use crate::calibrate::solver::{Minimum, minimise};
use crate::calibrate::{BallProblem, SolveError};

use super::pose_noise::{PoseNoise, marginalised};

/// The start is near, so a few passes settle it.
const MAX_PASSES: usize = 30;
/// Movements below this (mm, or mm at 100 mm of lever) between passes are the end.
const SETTLED_MM: f64 = 1e-11;
/// Movements below this at the last pass still are a solution.
const CONVERGED_MM: f64 = 1e-6;
/// The first pass sees the offsets of the start, so the noise is estimated from the second on, and kept from this one so
/// that the passes can settle.
const LAST_NOISE_ESTIMATE: usize = 4;

/// Where the passes ended.
#[derive(Clone, Debug)]
pub(super) struct Settled {
    /// The observations at the minimum, pose noise integrated out.
    pub observations: Vec<CentreObservation>,
    pub minimum: Minimum,
    /// The pose noise that the weights stand for.
    pub pose_noise: PoseNoise,
}

/// Minimises what `linearised` makes of the data at a state, from a start.
///
/// # Errors
/// [`SolveError::Undetermined`] or [`SolveError::Diverged`], as the solver finds.
pub(super) fn settle(
    linearised: impl Fn(&State) -> Vec<CentreObservation>,
    problem: &BallProblem,
    start: State,
) -> Result<Settled, SolveError> {
    let stated = PoseNoise::stated(&problem.noise, problem.mount);
    let mut pose_noise = stated.unwrap_or(PoseNoise::NONE);
    let mut state = start;
    let mut latest = None;
    for pass in 1..=MAX_PASSES {
        let by_data = linearised(&state);
        if stated.is_none() && (2..=LAST_NOISE_ESTIMATE).contains(&pass) {
            pose_noise = PoseNoise::estimated(&by_data, &state);
        }
        let observations: Vec<CentreObservation> = by_data
            .iter()
            .map(|observation| marginalised(observation, &state, &pose_noise))
            .collect::<Result<_, _>>()?;
        let mut minimum = minimise(&observations.iter(), state)?;
        let moved_mm = movement_mm(&state, &minimum.state);
        state = minimum.state;
        let settled = moved_mm < SETTLED_MM && (stated.is_some() || pass > LAST_NOISE_ESTIMATE);
        minimum.converged &= moved_mm < CONVERGED_MM;
        minimum.num_iterations = pass;
        latest = Some(Settled { observations, minimum, pose_noise });
        if settled {
            break;
        }
    }
    latest.ok_or(SolveError::Diverged)
}

fn movement_mm(before: &State, after: &State) -> f64 {
    let change = before.flange_from_sensor.inverse() * after.flange_from_sensor;
    change.translation.vector.norm()
        + 100.0 * change.rotation.angle()
        + (before.ball_in_base - after.ball_in_base).norm()
}
