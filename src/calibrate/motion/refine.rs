//! Maximum likelihood: weigh by the noise at the minimum, minimise, and again until nothing moves.

use crate::calibrate::plate::descent::{Descent, descend_from};
use crate::calibrate::{AboveStated, SolveError};

use super::measured::{LEVER_MM, Measured};
use super::noise::MotionNoise;
use super::pose::{MotionState, NUM_UNKNOWNS, PosePair, sums_of};

/// A minimum over the poses.
pub(super) type Minimum = Descent<NUM_UNKNOWNS, MotionState>;

/// Weights and minimum settle in a few passes.
const MAX_PASSES: usize = 20;
/// Movements below this (rad, mm/100) are the end: a thousandth of what any robot repeats.
const SETTLED: f64 = 1e-9;
/// The noise is found once, at the first minimum: what the unknowns can still take up of the errors is counted there, so that
/// it hardly follows where exactly the minimum is.
const LAST_NOISE_ESTIMATE: usize = 1;
/// From a closed form hardly any damping is needed.
const FIRST_DAMPING: f64 = 1e-12;

/// Minimises over the given poses, each as often as `times` says of its station.
///
/// # Errors
/// [`SolveError::Diverged`] if numbers run away.
pub(super) fn minimise(
    poses: &[PosePair],
    start: MotionState,
    times: impl Fn(usize) -> f64 + Copy,
) -> Result<Minimum, SolveError> {
    descend_from(|state: &MotionState| sums_of(poses, state, times), start, FIRST_DAMPING, SETTLED)
}

/// Where the passes ended.
#[derive(Clone, Debug)]
pub(super) struct Settled {
    /// The poses with their weights.
    pub poses: Vec<PosePair>,
    pub minimum: Minimum,
    pub noise: MotionNoise,
}

/// # Errors
/// [`SolveError::Diverged`] if numbers run away, [`SolveError::Undetermined`] if an unknown is free.
pub(super) fn settle(measured: &[Measured<'_>], start: MotionState, noise: MotionNoise) -> Result<Settled, SolveError> {
    let mut settled = settle_with(measured, start, noise)?;
    if let Some(above) = settled.noise.above_stated.filter(AboveStated::is_contradicted) {
        // Weights by a noise that the data refute would take chance for knowledge.
        settled = settle_with(measured, settled.minimum.unknowns, settled.noise.reopened())?;
        settled.noise.above_stated = Some(above);
    }
    Ok(settled)
}

/// The same, whatever the data say of the noise that is stated.
///
/// # Errors
/// As [`settle`].
pub(super) fn settle_with(
    measured: &[Measured<'_>],
    start: MotionState,
    noise: MotionNoise,
) -> Result<Settled, SolveError> {
    let mut noise = noise;
    let mut state = start;
    let mut latest = None;
    for pass in 1..=MAX_PASSES {
        let poses = noise.weighed(measured, &state);
        let mut minimum = minimise(&poses, state, |_| 1.0)?;
        let moved = distance(&state, &minimum.unknowns);
        state = minimum.unknowns;
        minimum.num_iterations = pass;
        let was = noise;
        if pass <= LAST_NOISE_ESTIMATE {
            noise.estimate(measured, &state)?;
        }
        let is_noise_kept = noise == was || pass > LAST_NOISE_ESTIMATE;
        let done = moved < 1e-7 && is_noise_kept;
        minimum.converged &= moved < 1e-6;
        latest = Some(Settled { poses, minimum, noise });
        if done {
            break;
        }
    }
    latest.ok_or(SolveError::Diverged)
}

/// How far apart two states are: rad, and mm over the lever.
fn distance(before: &MotionState, after: &MotionState) -> f64 {
    let sensor = before.flange_from_sensor.inverse() * after.flange_from_sensor;
    let target = before.base_from_target.inverse() * after.base_from_target;
    [sensor, target].iter().map(|change| change.rotation.angle() + change.translation.vector.norm() / LEVER_MM).sum()
}
