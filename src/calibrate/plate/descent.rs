//! Damped Gauss–Newton (Levenberg–Marquardt) for a few unknowns of any kind: the plate's methods differ in their unknowns
//! only.

use nalgebra::{SMatrix, SVector};

use crate::calibrate::SolveError;

/// From a far start a few tens of steps; more means that it leads nowhere.
const MAX_ITERATIONS: usize = 100;
/// A step below this (rad, mm/100) is the end: far below what any robot repeats.
const SETTLED: f64 = 1e-13;
/// A step below this that lowers nothing is one in the rounding.
const IN_ROUNDING: f64 = 1e-8;
/// Steps in mm count as rad at this lever.
pub(crate) const LEVER_MM: f64 = 100.0;
/// Damping of the first step.
const FIRST_DAMPING: f64 = 1e-4;
/// With more damping than this no step is left.
const MAX_DAMPING: f64 = 1e10;
/// A scaled condition number beyond this leaves a direction free in double precision.
const MAX_CONDITION: f64 = 1e13;

/// The sums that a step is computed from.
#[derive(Clone, Copy, Debug)]
pub struct Sums<const N: usize> {
    /// Σ `JᵀWJ`.
    pub hessian: SMatrix<f64, N, N>,
    /// Half the negative gradient.
    pub gradient: SVector<f64, N>,
    /// Sum of squares.
    pub cost: f64,
}

impl<const N: usize> Sums<N> {
    /// Nothing observed.
    #[must_use]
    pub fn zero() -> Self {
        Self { hessian: SMatrix::zeros(), gradient: SVector::zeros(), cost: 0.0 }
    }
}

/// Unknowns that can take a step in their tangent.
pub trait Unknowns<const N: usize>: Copy {
    /// After a step.
    #[must_use]
    fn stepped(&self, step: &SVector<f64, N>) -> Self;

    /// The size of a step: rad, and mm over `LEVER_MM`.
    #[must_use]
    fn size(step: &SVector<f64, N>) -> f64;
}

/// Where a descent ended.
#[derive(Clone, Copy, Debug)]
pub struct Descent<const N: usize, U> {
    /// The unknowns there.
    pub unknowns: U,
    /// The sums there.
    pub sums: Sums<N>,
    /// Steps taken.
    pub num_iterations: usize,
    /// Whether the last step was negligible.
    pub converged: bool,
}

/// Descends from a start to the nearest minimum.
///
/// # Errors
/// [`SolveError::Diverged`] if numbers run away.
pub fn descend<const N: usize, U: Unknowns<N>>(
    sums_at: impl Fn(&U) -> Sums<N>,
    start: U,
) -> Result<Descent<N, U>, SolveError> {
    descend_from(sums_at, start, FIRST_DAMPING, SETTLED)
}

/// The same with the damping of the first step, which is above zero, and ending at a step below `settled` (rad, mm/100): near
/// the minimum hardly any damping saves steps.
///
/// # Errors
/// As [`descend`].
pub fn descend_from<const N: usize, U: Unknowns<N>>(
    sums_at: impl Fn(&U) -> Sums<N>,
    start: U,
    first_damping: f64,
    settled: f64,
) -> Result<Descent<N, U>, SolveError> {
    let mut unknowns = start;
    let mut sums = sums_at(&start);
    let mut damping = first_damping;
    for iteration in 1..=MAX_ITERATIONS {
        let Some(step) = damped_step(&sums, damping) else {
            damping *= 10.0;
            continue;
        };
        let size = U::size(&step);
        if !size.is_finite() {
            return Err(SolveError::Diverged);
        }
        let trial = unknowns.stepped(&step);
        let trial_sums = sums_at(&trial);
        let falls = trial_sums.cost <= sums.cost;
        if falls {
            (unknowns, sums) = (trial, trial_sums);
            damping *= 0.1;
        }
        if size <= settled || (!falls && size < IN_ROUNDING) || damping > MAX_DAMPING {
            return Ok(Descent { unknowns, sums, num_iterations: iteration, converged: size < IN_ROUNDING });
        }
        if !falls {
            damping = (damping * 10.0).max(FIRST_DAMPING);
        }
    }
    Ok(Descent { unknowns, sums, num_iterations: MAX_ITERATIONS, converged: false })
}

fn scaling<const N: usize>(hessian: &SMatrix<f64, N, N>) -> SVector<f64, N> {
    hessian.diagonal().map(|d| if d > 0.0 { d.sqrt().recip() } else { 1.0 })
}

/// The matrix with its diagonal scaled to one, so that mm and rad compare.
fn scaled<const N: usize>(hessian: &SMatrix<f64, N, N>, scaling: &SVector<f64, N>) -> SMatrix<f64, N, N> {
    SMatrix::from_fn(|row, column| hessian[(row, column)] * scaling[row] * scaling[column])
}

fn damped_step<const N: usize>(sums: &Sums<N>, damping: f64) -> Option<SVector<f64, N>> {
    let scaling = scaling(&sums.hessian);
    let damped = scaled(&sums.hessian, &scaling) + SMatrix::identity() * damping;
    let step = damped.cholesky()?.solve(&sums.gradient.component_mul(&scaling));
    Some(step.component_mul(&scaling))
}

/// The inverse of the normal equations: the covariance for weights that are those of the noise.
///
/// # Errors
/// [`SolveError::Undetermined`] if a combination of the unknowns is free.
pub fn inverse_of<const N: usize>(hessian: &SMatrix<f64, N, N>) -> Result<SMatrix<f64, N, N>, SolveError> {
    let scaling = scaling(hessian);
    let scaled = scaled(hessian, &scaling);
    let Some(factor) = scaled.cholesky() else {
        return Err(SolveError::Undetermined { condition: f64::INFINITY });
    };
    let inverse = factor.inverse();
    // Frobenius norms bound the condition number from above by no more than N.
    let condition = scaled.norm() * inverse.norm();
    if condition.is_nan() || condition >= MAX_CONDITION {
        return Err(SolveError::Undetermined { condition });
    }
    Ok(SMatrix::from_fn(|row, column| inverse[(row, column)] * scaling[row] * scaling[column]))
}
