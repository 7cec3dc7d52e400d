//! Poses that contradict all others: found by the errors that the noise allows, set aside, and named.

use crate::calibrate::{PoseFault, SolveError};
use crate::geometry::so3::exp;
use crate::geometry::{Rigid, Vec3, stats};

use super::measured::{MIN_POSES, Measured};
use super::noise::MotionNoise;
use super::pose::{MotionState, NUM_UNKNOWNS, PosePair};
use super::refine::{Settled, settle};
use super::start::{error_mm, typical_mm};

/// Squares of errors below this are never looked at: six degrees of freedom exceed it once in twenty million.
const NEVER_BELOW: f64 = 45.0;
/// The probability at which a pose counts as wrong where the noise itself is known badly.
const CERTAIN: f64 = 1.0 - 1e-7;
/// Errors this many times the median are set aside before anything is known of the noise.
const WRONG_RATIO: f64 = 6.0;
/// Which poses are wrong settles in a few rounds.
const MAX_ROUNDS: usize = 6;
/// With fewer poses there is no telling which of them is wrong.
const MIN_TO_REJECT: usize = 6;

/// The minimum over the poses that agree.
pub(super) struct Agreed<'a> {
    pub settled: Settled,
    pub used: Vec<Measured<'a>>,
    pub rejected: Vec<Measured<'a>>,
}

/// # Errors
/// As [`settle`].
pub(super) fn settle_on_agreeing(
    measured: Vec<Measured<'_>>,
    start: MotionState,
    noise: MotionNoise,
) -> Result<Agreed<'_>, SolveError> {
    let poses: Vec<PosePair> = measured.iter().map(|measured| measured.pose).collect();
    if measured.len() < MIN_TO_REJECT {
        return Ok(Agreed { settled: settle(&measured, start, noise)?, used: measured, rejected: Vec::new() });
    }
    let limit_mm = WRONG_RATIO * typical_mm(&start, &poses);
    let mut is_used: Vec<bool> = poses.iter().map(|pose| error_mm(&start, pose) <= limit_mm).collect();
    let mut start = start;
    for _ in 0..MAX_ROUNDS {
        let used = chosen(&measured, &is_used);
        if used.len() < measured.len().div_ceil(2).max(MIN_POSES + 1) {
            // There is no majority to believe.
            is_used.fill(true);
            break;
        }
        let settled = settle(&used, start, noise)?;
        start = settled.minimum.unknowns;
        let weighed = settled.noise.weighed(&measured, &start);
        let squares: Vec<f64> = weighed.iter().map(|pose| pose.information.square(&start.errors(pose))).collect();
        let limit = limit(used.len(), settled.noise.is_any_open(), stats::max(squares.iter().copied()));
        let now: Vec<bool> = squares.iter().map(|square| *square <= limit).collect();
        if now == is_used {
            let rejected =
                measured.iter().zip(&is_used).filter(|(_, used)| !**used).map(|(pose, _)| pose.clone()).collect();
            return Ok(Agreed { settled, used, rejected });
        }
        is_used = now;
    }
    let used = chosen(&measured, &is_used);
    let settled = settle(&used, start, noise)?;
    let rejected = measured.iter().zip(&is_used).filter(|(_, used)| !**used).map(|(pose, _)| pose.clone()).collect();
    Ok(Agreed { settled, used, rejected })
}

fn chosen<'a>(measured: &[Measured<'a>], is_used: &[bool]) -> Vec<Measured<'a>> {
    measured.iter().zip(is_used).filter(|(_, used)| **used).map(|(pose, _)| pose.clone()).collect()
}

/// The square from which on a pose is wrong; `most` is the largest there is.
fn limit(num_used: usize, is_noise_found: bool, most: f64) -> f64 {
    if most <= NEVER_BELOW || !is_noise_found {
        return NEVER_BELOW;
    }
    #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 poses")]
    let freedom = (6 * num_used).saturating_sub(NUM_UNKNOWNS) as f64;
    NEVER_BELOW.max(6.0 * stats::f_quantile(CERTAIN, 6.0, freedom))
}

/// What would explain a rejected pose, and how far off it is: mm, rad.
pub(super) fn fault_of(
    pose: &PosePair,
    state: &MotionState,
    typical_square: impl Fn(&PosePair) -> f64,
) -> (PoseFault, f64, f64) {
    let errors = state.errors(pose);
    let square = |sensor_from_target: Rigid| typical_square(&PosePair { sensor_from_target, ..*pose });
    // Another reading of a marker is not quite its true pose.
    let fits = |sensor_from_target: Rigid| square(sensor_from_target) < 4.0 * NEVER_BELOW;
    let seen = pose.sensor_from_target;
    let half_turns = [Vec3::x(), Vec3::y(), Vec3::z()].map(|axis| exp(axis * std::f64::consts::PI));
    let is_flipped = half_turns.iter().any(|turn| {
        fits(Rigid::from_parts(seen.translation, seen.rotation * turn))
            || fits(Rigid::from_parts(seen.translation, turn * seen.rotation * turn))
    });
    let is_mirrored = || fits(mirrored_tilt(&seen));
    let expected = state.flange_from_sensor.inverse() * pose.base_from_flange.inverse() * state.base_from_target;
    let turned = square(Rigid::from_parts(seen.translation, expected.rotation));
    let shifted = square(Rigid::from_parts(expected.translation, seen.rotation));
    let fault = if fits(seen.inverse()) {
        PoseFault::Inverted
    } else if is_flipped || is_mirrored() {
        PoseFault::Flipped
    } else if turned.min(shifted) < NEVER_BELOW {
        if turned < shifted { PoseFault::Orientation } else { PoseFault::Place }
    } else {
        PoseFault::Both
    };
    (fault, errors.translation.norm(), errors.rotation.norm())
}

/// The other reading of a flat marker seen from afar: its normal mirrored about the line of sight.
fn mirrored_tilt(seen: &Rigid) -> Rigid {
    let Some(sight) = seen.translation.vector.try_normalize(1e-9) else { return *seen };
    let normal = seen.rotation * Vec3::z();
    let half_turn = exp(sight * std::f64::consts::PI);
    // The mirrored normal, with the smallest turn that leads there.
    let mirrored = half_turn * normal;
    let turn = nalgebra::UnitQuaternion::rotation_between(&normal, &mirrored).unwrap_or(half_turn);
    Rigid::from_parts(seen.translation, turn * seen.rotation)
}
