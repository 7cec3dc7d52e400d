//! Where to begin: the closed forms, small samples where some poses are wrong, many orientations where the rotations alone
//! leave several.

use nalgebra::UnitQuaternion;

use crate::calibrate::SolveError;
use crate::calibrate::rotation_start::octahedral_rotations;
use crate::geometry::Rigid;
use crate::geometry::stats::{self, SplitMix};

use super::closed_form::{ClosedForm, translation};
use super::measured::LEVER_MM;
use super::pair::{Pair, chosen};
use super::pose::{Information, MotionState, PosePair};
use super::refine;

/// Errors this many times the median are no noise.
const WRONG_RATIO: f64 = 6.0;
/// Enough that one sample is free of wrong poses where almost half of them are wrong.
const NUM_SAMPLES: usize = 150;
/// Closed forms that differ by more than this (rad) are not sure of the rotation.
const UNSURE: f64 = 0.1;
/// With up to so many poses all orientations are tried in any case.
const TRY_ALL_UP_TO: usize = 4;
/// Another minimum within this factor of the residual fits about as well.
const ABOUT_EQUAL: f64 = 2.0;
/// Minima this near to each other (rad) are one.
const SAME: f64 = 1e-3;

/// A closed form's answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Answer {
    pub form: ClosedForm,
    pub flange_from_sensor: Option<Rigid>,
}

/// What there is to begin with.
pub(super) struct Start {
    pub answers: Vec<Answer>,
    pub state: MotionState,
    /// Another calibration that fits about as well: its residual over that of this one, and its distance, mm.
    pub other: Option<(f64, f64)>,
}

/// # Errors
/// [`SolveError::Diverged`] if nothing leads anywhere.
pub(super) fn start(poses: &[PosePair]) -> Result<Start, SolveError> {
    let pairs = chosen(poses);
    let answers: Vec<Answer> = ClosedForm::ALL
        .into_iter()
        .map(|form| Answer { form, flange_from_sensor: form.solve(poses, &pairs) })
        .collect();
    let given = || answers.iter().filter_map(|answer| answer.flange_from_sensor);
    let (mut state, mut typical_mm) =
        best(given().map(|sensor| MotionState::with_mean_target(sensor, poses)), poses).ok_or(SolveError::Diverged)?;
    let spread = given().map(|sensor| sensor.rotation.angle_to(&state.flange_from_sensor.rotation)).fold(0.0, f64::max);
    let mut other = None;
    if spread > UNSURE || poses.len() <= TRY_ALL_UP_TO {
        let minima = from_all_orientations(poses);
        if let Some((first, first_mm)) = minima.first().copied().filter(|(_, found_mm)| *found_mm < typical_mm) {
            (state, typical_mm) = (first, first_mm);
        }
        other = minima.iter().find_map(|(found, found_mm)| other_minimum(&state, typical_mm, found, *found_mm));
    }
    let most_mm = stats::max(poses.iter().map(|pose| error_mm(&state, pose)));
    if most_mm > WRONG_RATIO * typical_mm
        && let Some((found, found_mm)) = from_samples(poses)
        && found_mm < typical_mm
    {
        state = found;
    }
    Ok(Start { answers, state, other })
}

fn other_minimum(state: &MotionState, mm: f64, other: &MotionState, other_mm: f64) -> Option<(f64, f64)> {
    let is_other = other.flange_from_sensor.rotation.angle_to(&state.flange_from_sensor.rotation) > SAME;
    let ratio = other_mm / mm;
    let apart = other.flange_from_sensor.translation.vector - state.flange_from_sensor.translation.vector;
    (is_other && ratio < ABOUT_EQUAL).then(|| (ratio, apart.norm()))
}

/// How far off a pose is, rotations as mm at the lever.
pub(super) fn error_mm(state: &MotionState, pose: &PosePair) -> f64 {
    Information::by_lever(LEVER_MM).square(&state.errors(pose)).sqrt()
}

/// The median error of the poses, mm: wrong ones do not move it.
pub(super) fn typical_mm(state: &MotionState, poses: &[PosePair]) -> f64 {
    stats::median(&mut poses.iter().map(|pose| error_mm(state, pose)).collect::<Vec<_>>())
}

fn best(states: impl Iterator<Item = MotionState>, poses: &[PosePair]) -> Option<(MotionState, f64)> {
    states
        .map(|state| (state, typical_mm(&state, poses)))
        .filter(|(_, typical_mm)| typical_mm.is_finite())
        .min_by(|a, b| a.1.total_cmp(&b.1))
}

/// The minima from all orientations, the best first.
fn from_all_orientations(poses: &[PosePair]) -> Vec<(MotionState, f64)> {
    let found = octahedral_rotations().into_iter().filter_map(|rotation: UnitQuaternion<f64>| {
        let sensor = Rigid::from_parts(translation(poses, &rotation)?.into(), rotation);
        let minimum = refine::minimise(poses, MotionState::with_mean_target(sensor, poses), |_| 1.0).ok()?;
        #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 poses")]
        let rms_mm = (minimum.sums.cost / poses.len() as f64).sqrt();
        (minimum.converged && rms_mm.is_finite()).then_some((minimum.unknowns, rms_mm))
    });
    let mut found: Vec<(MotionState, f64)> = found.collect();
    found.sort_by(|a, b| a.1.total_cmp(&b.1));
    found
}

/// The best of many samples of three poses each, by the median error of all: Fischler and Bolles' consensus with the median
/// for its measure. Seeded, so that the same data give the same answer.
fn from_samples(poses: &[PosePair]) -> Option<(MotionState, f64)> {
    let mut random = SplitMix::new(1);
    let states = (0..NUM_SAMPLES).filter_map(|_| {
        let places = [0; 3].map(|_: usize| random.below(poses.len()));
        let [a, b, c] = places.map(|place| poses[place]);
        if places[0] == places[1] || places[1] == places[2] || places[0] == places[2] {
            return None;
        }
        let pairs = [Pair::between(&a, &b), Pair::between(&b, &c), Pair::between(&c, &a)];
        let sensor = ClosedForm::Park.solve(&[a, b, c], &pairs)?;
        Some(MotionState::with_mean_target(sensor, &[a, b, c]))
    });
    best(states, poses)
}

/// Whether the poses fit far better with one of the lists inverted: residual as given over residual with it inverted.
///
/// A X B = Z is the same as B⁻¹ X⁻¹ A⁻¹ = Z⁻¹, that is A⁻¹ Z B⁻¹ = X: inverting either list mends what inverting the other
/// does, so one of them is tried.
pub(super) fn inverted(poses: &[PosePair], as_given_mm: f64) -> Option<f64> {
    /// Far above what noise or a wrong pose does.
    const CLEARLY: f64 = 10.0;
    let poses: Vec<PosePair> =
        poses.iter().map(|pose| PosePair { base_from_flange: pose.base_from_flange.inverse(), ..*pose }).collect();
    let sensor = ClosedForm::Park.solve(&poses, &chosen(&poses))?;
    let ratio = as_given_mm / typical_mm(&MotionState::with_mean_target(sensor, &poses), &poses);
    (ratio > CLEARLY).then_some(ratio)
}
