//! Least squares for the nine unknowns, on SE(3) × R³: damped Gauss–Newton on a sum of quadratics in the ball's centre.

use nalgebra::{Matrix6, SMatrix, SVector};

use crate::geometry::so3::hat;
use crate::geometry::{Mat3, Vec3};

use super::SolveError;
use super::observation::{CentreObservation, NUM_UNKNOWNS, State};

/// The 9 × 9 matrix of the normal equations.
pub type Hessian = SMatrix<f64, NUM_UNKNOWNS, NUM_UNKNOWNS>;
/// A vector of the nine unknowns.
pub type Gradient = SVector<f64, NUM_UNKNOWNS>;

/// Gauss–Newton settles in four to six steps; more means a bad start.
const MAX_ITERATIONS: usize = 60;
/// A step that moves nothing by more than this (rad, mm/100) is the end: far below what any robot repeats.
const SETTLED: f64 = 1e-13;
/// Steps in mm count as rad at this lever: the distance from flange to ball, roughly.
const LEVER_MM: f64 = 100.0;
/// A scaled condition number beyond this leaves a direction free in double precision.
const MAX_CONDITION: f64 = 1e13;

/// A minimum.
#[derive(Clone, Debug)]
pub struct Minimum {
    /// The unknowns there.
    pub state: State,
    /// The matrix of the normal equations there.
    pub hessian: Hessian,
    /// Sum of squares there.
    pub cost: f64,
    /// Steps taken.
    pub num_iterations: usize,
    /// Whether the last step was negligible.
    pub converged: bool,
}

/// Minimises the sum of independent observations from a start.
///
/// # Errors
/// [`SolveError::Undetermined`] if a combination of the unknowns is free, [`SolveError::Diverged`] if numbers run away.
pub fn minimise<'a, I>(observations: &I, start: State) -> Result<Minimum, SolveError>
where
    I: Iterator<Item = &'a CentreObservation> + Clone,
{
    minimise_sums(|state| Normal::of(observations.clone(), state), start)
}

/// The same for sums that are made by the caller.
///
/// # Errors
/// As [`minimise`].
pub fn minimise_sums(sums_at: impl Fn(&State) -> Normal, start: State) -> Result<Minimum, SolveError> {
    let normal = sums_at(&start);
    minimise_from(sums_at, start, normal, SETTLED)
}

/// The same with the sums at the start known already, ending at a step below `settled` (rad, mm/100).
///
/// # Errors
/// As [`minimise`].
pub fn minimise_from(
    sums_at: impl Fn(&State) -> Normal,
    start: State,
    normal: Normal,
    settled: f64,
) -> Result<Minimum, SolveError> {
    let mut state = start;
    let mut normal = normal;
    let mut damping = 0.0;
    for iteration in 1..=MAX_ITERATIONS {
        let step = solve_scaled(&normal.hessian, &normal.gradient, damping)?;
        let trial = state.stepped(&step);
        let size = step_size(&step);
        if !size.is_finite() {
            return Err(SolveError::Diverged);
        }
        if size <= settled {
            return Ok(Minimum {
                state: trial,
                hessian: normal.hessian,
                cost: normal.cost,
                num_iterations: iteration,
                converged: true,
            });
        }
        let trial_normal = sums_at(&trial);
        // Costs are differences from the linearisation points; near the minimum they are equal to rounding.
        let rounding = 1e-12 * normal.cost.abs().max(trial_normal.cost.abs());
        if trial_normal.cost <= normal.cost + rounding || size < 1e-9 {
            (state, normal) = (trial, trial_normal);
            damping *= 0.1;
            if damping < 1e-9 {
                damping = 0.0;
            }
        } else {
            damping = (damping * 10.0).max(1e-6);
        }
    }
    Ok(Minimum { state, hessian: normal.hessian, cost: normal.cost, num_iterations: MAX_ITERATIONS, converged: false })
}

fn step_size(step: &Gradient) -> f64 {
    let rotation = step.fixed_rows::<3>(0).norm();
    let sensor_mm = step.fixed_rows::<3>(3).norm();
    let ball_mm = step.fixed_rows::<3>(6).norm();
    rotation + (sensor_mm + ball_mm) / LEVER_MM
}

/// The sums that a step is computed from.
#[derive(Clone, Copy, Debug)]
pub struct Normal {
    /// Σ `JᵀWJ`.
    pub hessian: Hessian,
    /// Half the negative gradient.
    pub gradient: Gradient,
    /// Sum of squares.
    pub cost: f64,
}

impl Normal {
    /// Nothing observed.
    #[must_use]
    pub fn zero() -> Self {
        Self { hessian: Hessian::zeros(), gradient: Gradient::zeros(), cost: 0.0 }
    }

    /// Of some observations at a state.
    ///
    /// The Jacobian is `([s]×, −I, C)`, so the blocks are products of three small matrices; a general 3 × 9 product takes
    /// twice as long.
    #[must_use]
    pub fn of<'a>(observations: impl Iterator<Item = &'a CentreObservation>, state: &State) -> Self {
        let (mut rotation_rotation, mut rotation_shift, mut rotation_ball) =
            (Mat3::zeros(), Mat3::zeros(), Mat3::zeros());
        let (mut shift_shift, mut shift_ball, mut ball_ball) = (Mat3::zeros(), Mat3::zeros(), Mat3::zeros());
        let (mut by_rotation, mut by_shift, mut by_ball) = (Vec3::zeros(), Vec3::zeros(), Vec3::zeros());
        let mut cost = 0.0;
        for observation in observations {
            let (centre, sensor_from_base) = state.ball_in_sensor_and_rotation(&observation.base_from_flange);
            let offset = centre - observation.centre_in_sensor;
            let weighted_offset = observation.information * offset;
            let pull = observation.pull - weighted_offset;
            cost += observation.constant + offset.dot(&weighted_offset) - 2.0 * observation.pull.dot(&offset);
            // [s]ᵀ W and Cᵀ W once, the blocks from them.
            let turned = hat(centre).transpose() * observation.information;
            let in_base = sensor_from_base.transpose() * observation.information;
            rotation_rotation += turned * hat(centre);
            rotation_shift -= turned;
            rotation_ball += turned * sensor_from_base;
            shift_shift += observation.information;
            shift_ball -= in_base.transpose();
            ball_ball += in_base * sensor_from_base;
            by_rotation += pull.cross(&centre);
            by_shift -= pull;
            by_ball += sensor_from_base.transpose() * pull;
        }
        let mut hessian = Hessian::zeros();
        let blocks = [
            (0, 0, rotation_rotation),
            (0, 3, rotation_shift),
            (3, 0, rotation_shift.transpose()),
            (0, 6, rotation_ball),
            (6, 0, rotation_ball.transpose()),
            (3, 3, shift_shift),
            (3, 6, shift_ball),
            (6, 3, shift_ball.transpose()),
            (6, 6, ball_ball),
        ];
        for (row, column, block) in blocks {
            hessian.fixed_view_mut::<3, 3>(row, column).copy_from(&block);
        }
        let mut gradient = Gradient::zeros();
        for (row, part) in [(0, by_rotation), (3, by_shift), (6, by_ball)] {
            gradient.fixed_rows_mut::<3>(row).copy_from(&part);
        }
        Self { hessian, gradient, cost }
    }

    /// The sums of observations that share an unknown shift of the ball's centre in the sensor frame, with that shift
    /// integrated out; `covariance` is the shift's, mm².
    ///
    /// A shift acts as one of the sensor does with the other sign, so what couples it to the unknowns is at hand.
    #[must_use]
    pub fn with_common_shift(self, covariance: &Mat3) -> Self {
        let by_shift = self.hessian.fixed_view::<NUM_UNKNOWNS, 3>(0, 3).into_owned();
        let information = self.hessian.fixed_view::<3, 3>(3, 3).into_owned();
        let pull = self.gradient.fixed_rows::<3>(3).into_owned();
        let Some(damp) = (Mat3::identity() + information * covariance).try_inverse() else { return self };
        let reach = covariance * damp;
        Self {
            hessian: self.hessian - by_shift * reach * by_shift.transpose(),
            gradient: self.gradient - by_shift * (reach * pull),
            cost: self.cost - pull.dot(&(reach * pull)),
        }
    }
}

impl std::ops::Mul<f64> for Normal {
    type Output = Self;

    fn mul(self, times: f64) -> Self {
        Self { hessian: self.hessian * times, gradient: self.gradient * times, cost: self.cost * times }
    }
}

impl std::ops::AddAssign for Normal {
    fn add_assign(&mut self, other: Self) {
        self.hessian += other.hessian;
        self.gradient += other.gradient;
        self.cost += other.cost;
    }
}

/// The diagonal matrix that scales the diagonal of `scaling * hessian * scaling` to one, so that mm and rad compare.
fn unit_diagonal_scaling(hessian: &Hessian) -> Hessian {
    Hessian::from_diagonal(&hessian.diagonal().map(|d| if d > 0.0 { 1.0 / d.sqrt() } else { 0.0 }))
}

/// Solves `(H + damping diag H) step = gradient` with the diagonal scaled to one, so that mm and rad compare.
fn solve_scaled(hessian: &Hessian, gradient: &Gradient, damping: f64) -> Result<Gradient, SolveError> {
    let scaling = unit_diagonal_scaling(hessian);
    let scaled = scaling * hessian * scaling + Hessian::identity() * damping;
    let Some(factor) = scaled.cholesky() else {
        return Err(undetermined(hessian));
    };
    Ok(scaling * factor.solve(&(scaling * gradient)))
}

/// The inverse of the normal equations: the covariance for unit noise.
///
/// # Errors
/// [`SolveError::Undetermined`] if a combination of the unknowns is free.
pub fn covariance_for_unit_noise(hessian: &Hessian) -> Result<Hessian, SolveError> {
    let scaling = unit_diagonal_scaling(hessian);
    let condition = scaled_condition(hessian);
    match (scaling * hessian * scaling).cholesky() {
        Some(factor) if condition < MAX_CONDITION => Ok(scaling * factor.inverse() * scaling),
        _ => Err(SolveError::Undetermined { condition }),
    }
}

fn undetermined(hessian: &Hessian) -> SolveError {
    if hessian.iter().all(|v| v.is_finite()) {
        SolveError::Undetermined { condition: scaled_condition(hessian) }
    } else {
        SolveError::Diverged
    }
}

/// Condition number of the normal equations after scaling their diagonal to one.
#[must_use]
pub fn scaled_condition(hessian: &Hessian) -> f64 {
    let scaling = unit_diagonal_scaling(hessian);
    let eigenvalues = (scaling * hessian * scaling).symmetric_eigenvalues();
    let least = eigenvalues.min();
    if least > 0.0 { eigenvalues.max() / least } else { f64::INFINITY }
}

/// The part of a covariance of all unknowns that belongs to the sensor on the flange.
#[must_use]
pub fn sensor_block(covariance: &Hessian) -> Matrix6<f64> {
    covariance.fixed_view::<6, 6>(0, 0).into_owned()
}

#[cfg(test)]
mod tests {
    use nalgebra::{Translation3, UnitQuaternion};

    use super::*;
    use crate::geometry::Rigid;

    fn unit_step(column: usize, size: f64) -> Gradient {
        let mut step = Gradient::zeros();
        step[column] = size;
        step
    }

    /// The sums that the solver steps by, against differences, near the identity and near a half turn.
    #[test]
    fn sums_agree_with_differences() {
        const STEP: f64 = 1e-5;
        let base_from_flange =
            Rigid::from_parts(Translation3::new(580.0, -60.0, 220.0), UnitQuaternion::from_euler_angles(3.1, 0.2, 0.7));
        for roll in [0.0, 0.4, std::f64::consts::PI - 1e-7] {
            let state = State {
                flange_from_sensor: Rigid::from_parts(
                    Translation3::new(12.0, -3.0, 118.0),
                    UnitQuaternion::from_euler_angles(roll, 0.1, -1.5),
                ),
                ball_in_base: Vec3::new(600.0, -40.0, 20.0),
            };
            let exact = CentreObservation {
                information: Mat3::new(2.0, 0.3, -0.2, 0.3, 1.0, 0.4, -0.2, 0.4, 3.0),
                ..CentreObservation::point(0, base_from_flange, state.ball_in_sensor(&base_from_flange))
            };
            let pulled = CentreObservation {
                centre_in_sensor: exact.centre_in_sensor + Vec3::new(0.5, -0.2, 0.1),
                pull: Vec3::new(0.3, 0.7, -0.4),
                ..exact.clone()
            };
            let sums = |observation, state: &State| Normal::of(std::iter::once(observation), state);
            let gradient = sums(&pulled, &state).gradient;
            let hessian = sums(&exact, &state).hessian;
            for column in 0..NUM_UNKNOWNS {
                let (ahead, behind) =
                    (state.stepped(&unit_step(column, STEP)), state.stepped(&unit_step(column, -STEP)));
                let by_cost = (sums(&pulled, &behind).cost - sums(&pulled, &ahead).cost) / (4.0 * STEP);
                // Rounding of 600 mm over the step, truncation step² of the terms.
                assert!((gradient[column] - by_cost).abs() < 1e-7 * (1.0 + by_cost.abs()), "gradient {column}, {roll}");
                // Where nothing pulls, the second derivative is JᵀWJ exactly.
                let by_gradient = (sums(&exact, &behind).gradient - sums(&exact, &ahead).gradient) / (2.0 * STEP);
                let difference = (hessian.column(column) - by_gradient).norm();
                assert!(difference < 1e-7 * (1.0 + by_gradient.norm()), "hessian {column}, {roll}: {difference}");
            }
        }
    }
}
