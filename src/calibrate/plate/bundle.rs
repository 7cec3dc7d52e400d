//! `plate-bundle`: all points of p on one line, all of q on another, the two perpendicular and meeting.
//!
//! Twelve unknowns: the sensor on the flange and the plate in the base. Each point has two distances from its edge, weighed
//! by the noise of sensor and robot across the edge there.

use crate::calibrate::SolveError;
use crate::geometry::Rigid;

use super::descent::{Descent, descend};
use super::measured::Measured;
use super::noise::PlateNoise;
use super::points::{EdgePoint, NUM_UNKNOWNS, PlateState, sums_of};
use super::start::{plate_through, state_at};

/// A minimum of the bundle.
pub(super) type Minimum = Descent<NUM_UNKNOWNS, PlateState>;

/// Weights and minimum settle in a few passes.
const MAX_PASSES: usize = 30;
/// Movements below this between passes (rad, mm/100) are the end.
const SETTLED: f64 = 1e-11;
/// The noise is kept from this pass on, so that the passes can settle.
const LAST_NOISE_ESTIMATE: usize = 6;

/// Minimises over the given points, each as often as `times` says of its station.
///
/// # Errors
/// [`SolveError::Diverged`] if numbers run away.
pub(super) fn minimise(
    points: &[EdgePoint],
    start: PlateState,
    times: impl Fn(usize) -> f64 + Copy,
) -> Result<Minimum, SolveError> {
    descend(|state: &PlateState| sums_of(points, state, times), start)
}

/// The minimum near a sensor on the flange, all points weighed alike.
///
/// # Errors
/// [`SolveError::Diverged`] if there is none.
pub(super) fn from_start(points: &[EdgePoint], flange_from_sensor: &Rigid) -> Result<Minimum, SolveError> {
    let start = state_at(points, flange_from_sensor).ok_or(SolveError::Diverged)?;
    let found = minimise(points, start, |_| 1.0)?;
    // A plate that has gone astray is set anew through the points that the sensor found.
    match plate_through(points, &found.unknowns.flange_from_sensor) {
        Some(base_from_plate) if !found.converged => {
            minimise(points, PlateState { base_from_plate, ..found.unknowns }, |_| 1.0)
        }
        _ => Ok(found),
    }
}

/// Where the passes ended.
#[derive(Clone, Debug)]
pub(super) struct Settled {
    pub points: Vec<EdgePoint>,
    pub minimum: Minimum,
    pub noise: PlateNoise,
}

/// Weighs by the noise at the minimum, minimises, and again until nothing moves.
///
/// # Errors
/// [`SolveError::Diverged`] if numbers run away.
pub(super) fn settle(measured: &[Measured<'_>], start: PlateState, noise: PlateNoise) -> Result<Settled, SolveError> {
    let mut settled = settle_with(measured, start, noise)?;
    if let Some(above) = settled.noise.above_stated.filter(super::AboveStated::is_contradicted) {
        // Weights by a noise that the data refute would take chance for knowledge.
        settled = settle_with(measured, settled.minimum.unknowns, settled.noise.reopened())?;
        settled.noise.above_stated = Some(above);
    }
    Ok(settled)
}

fn settle_with(measured: &[Measured<'_>], start: PlateState, noise: PlateNoise) -> Result<Settled, SolveError> {
    let mut noise = noise;
    let mut state = start;
    let mut latest = None;
    for pass in 1..=MAX_PASSES {
        if pass <= LAST_NOISE_ESTIMATE {
            noise.estimate(measured, &state)?;
        }
        let points = noise.weighed(measured, &state);
        let mut minimum = minimise(&points, state, |_| 1.0)?;
        let moved = super::points::distance(&state, &minimum.unknowns);
        state = minimum.unknowns;
        minimum.num_iterations = pass;
        let done = moved < SETTLED && pass > LAST_NOISE_ESTIMATE;
        minimum.converged &= moved < 1e-6;
        latest = Some(Settled { points, minimum, noise });
        if done {
            break;
        }
    }
    latest.ok_or(SolveError::Diverged)
}
