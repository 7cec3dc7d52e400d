//! The robot's noise from the data: how much each pose errs by itself, and how much all poses of a station err together.
//!
//! Restricted maximum likelihood for a linear model with variance components, by Fisher scoring. A component gives every
//! capture (or every station as a whole) a covariance of the ball's centre in the sensor frame, times its variance.
//!
//! # Source
//! Patterson & Thompson 1971 for the likelihood; the score of a component with matrix B is ½ (hᵀ B h − tr(P B)), where
//! h = P y is what the weighted residuals still pull with once the unknowns are fitted.

use nalgebra::{Matrix4, SMatrix, Vector4};

use crate::calibrate::SolveError;
use crate::calibrate::observation::{CentreObservation, NUM_UNKNOWNS, State};
use crate::calibrate::solver::{Gradient, Hessian, covariance_for_unit_noise};
use crate::geometry::so3::hat;
use crate::geometry::{Mat3, Vec3};

use super::pose_noise::{PoseNoise, lever_covariance};

/// Components: position and orientation of each pose (mm², rad²), then the same common to a station.
pub(super) const NUM_COMPONENTS: usize = 4;
/// Index of the first component that is common to a station.
const FIRST_COMMON: usize = 2;
/// Scoring settles in four to eight steps.
const MAX_ITERATIONS: usize = 20;
/// Relative change of the variances at which it ends: a hundredth of how well they can be known.
const SETTLED: f64 = 2e-3;
/// A variance falls or grows by no more than this factor a step.
const MAX_FACTOR: f64 = 10.0;
/// A component that adds less than this part to the variance of a centre is none.
const NEGLIGIBLE_PART: f64 = 1e-4;

type Jacobian = SMatrix<f64, 3, NUM_UNKNOWNS>;

/// What a fit of the components knows besides their values.
#[derive(Clone, Debug, PartialEq)]
pub struct VarianceSpread {
    /// How the information about the unknowns falls with each variance, −∂H/∂v.
    information_loss: [Hessian; NUM_COMPONENTS],
    /// Covariance of the estimated variances; zero for those that are stated or absent.
    covariance: Matrix4<f64>,
}

impl VarianceSpread {
    /// Of variances that are stated.
    #[must_use]
    pub fn known() -> Self {
        Self { information_loss: [Hessian::zeros(); NUM_COMPONENTS], covariance: Matrix4::zeros() }
    }

    /// Degrees of freedom (Satterthwaite's) of the variance tr(G C Gᵀ) for a covariance C of the unknowns.
    #[must_use]
    pub fn degrees_of_freedom(&self, covariance: &Hessian, by_unknowns: &Jacobian) -> f64 {
        let reach = by_unknowns * covariance;
        let variance = (reach * by_unknowns.transpose()).trace();
        let slope = Vector4::from_fn(|idx, _| (reach * self.information_loss[idx] * reach.transpose()).trace());
        let spread = slope.dot(&(self.covariance * slope));
        if spread > 0.0 { 2.0 * variance * variance / spread } else { f64::INFINITY }
    }
}

/// One capture: what it says by its points alone, and what it depends on.
struct Capture {
    information: Mat3,
    pull: Vec3,
    jacobian: Jacobian,
    lever: Mat3,
}

/// A capture with the noise of its pose integrated out.
struct Weighted {
    information: Mat3,
    pull: Vec3,
    /// Information times Jacobian.
    by_unknowns: Jacobian,
}

/// The sums of a station that couple its captures.
struct StationSums {
    information: Mat3,
    pull: Vec3,
    by_unknowns: Jacobian,
    /// Covariance of the shift common to the station, given its captures.
    reach: Mat3,
}

/// The model: captures by station, and which variances are to be found.
pub(super) struct Components<'a> {
    stations: Vec<Vec<Capture>>,
    is_estimated: &'a [bool; NUM_COMPONENTS],
}

/// Score and information of the components at some variances.
struct Scoring {
    score: Vector4<f64>,
    information: Matrix4<f64>,
    information_loss: [Hessian; NUM_COMPONENTS],
}

impl<'a> Components<'a> {
    /// From observations by points alone, linearised at a state and ordered by station.
    pub fn new(
        observations: &[CentreObservation],
        state: &State,
        noise: &PoseNoise,
        is_estimated: &'a [bool; NUM_COMPONENTS],
    ) -> Self {
        let stations = observations
            .chunk_by(|a, b| a.station == b.station)
            .map(|run| {
                run.iter()
                    .map(|observation| {
                        let (centre, sensor_from_base) =
                            state.ball_in_sensor_and_rotation(&observation.base_from_flange);
                        let mut jacobian = Jacobian::zeros();
                        jacobian.fixed_view_mut::<3, 3>(0, 0).copy_from(&hat(centre));
                        jacobian.fixed_view_mut::<3, 3>(0, 3).copy_from(&-Mat3::identity());
                        jacobian.fixed_view_mut::<3, 3>(0, 6).copy_from(&sensor_from_base);
                        Capture {
                            information: observation.information,
                            pull: observation.pull_at(state),
                            jacobian,
                            lever: lever_covariance(&observation.base_from_flange, state, noise.mount),
                        }
                    })
                    .collect()
            })
            .collect();
        Self { stations, is_estimated }
    }

    /// The variances of greatest likelihood, from a start, and what is known of them.
    ///
    /// # Errors
    /// [`SolveError::Undetermined`] if the captures leave an unknown free at variances that were tried.
    pub fn fit(&self, start: [f64; NUM_COMPONENTS]) -> Result<([f64; NUM_COMPONENTS], VarianceSpread), SolveError> {
        let mut variances = start;
        let mut scoring = self.scoring(&variances)?;
        for _ in 0..MAX_ITERATIONS {
            let before = variances;
            let is_active = |idx: usize| self.is_estimated[idx] && (before[idx] > 0.0 || scoring.score[idx] > 0.0);
            let step = solve_active(&scoring, &is_active);
            for idx in 0..NUM_COMPONENTS {
                if is_active(idx) {
                    variances[idx] = self.stepped(idx, &before, step[idx]);
                }
            }
            scoring = self.scoring(&variances)?;
            if (0..NUM_COMPONENTS).all(|idx| (variances[idx] - before[idx]).abs() <= SETTLED * before[idx]) {
                break;
            }
        }
        let is_active = |idx: usize| self.is_estimated[idx] && variances[idx] > 0.0;
        let covariance = inverse_of_active(&scoring.information, &is_active);
        Ok((variances, VarianceSpread { information_loss: scoring.information_loss, covariance }))
    }

    fn stepped(&self, idx: usize, before: &[f64; NUM_COMPONENTS], step: f64) -> f64 {
        let variance = before[idx];
        let stepped = variance + step;
        let bounded =
            if variance > 0.0 { stepped.clamp(variance / MAX_FACTOR, variance * MAX_FACTOR) } else { stepped.max(0.0) };
        let part = bounded * self.size(idx);
        let others: f64 =
            (0..NUM_COMPONENTS).filter(|other| *other != idx).map(|other| before[other] * self.size(other)).sum();
        if step < 0.0 && part < NEGLIGIBLE_PART * (others + self.typical_variance()) { 0.0 } else { bounded }
    }

    /// What a unit of a component adds to the variance of a centre, about.
    fn size(&self, idx: usize) -> f64 {
        if idx.is_multiple_of(2) {
            return 3.0;
        }
        self.stations.first().and_then(|station| station.first()).map_or(0.0, |capture| capture.lever.trace())
    }

    /// Variance of a centre by the points alone, of a typical capture.
    fn typical_variance(&self) -> f64 {
        self.stations
            .first()
            .and_then(|station| station.first())
            .map_or(0.0, |capture| 3.0 / capture.information.diagonal().max().max(f64::MIN_POSITIVE))
    }

    fn scoring(&self, variances: &[f64; NUM_COMPONENTS]) -> Result<Scoring, SolveError> {
        let mut hessian = Hessian::zeros();
        let mut gradient = Gradient::zeros();
        let mut weighted: Vec<(Vec<Weighted>, StationSums)> = Vec::with_capacity(self.stations.len());
        for station in &self.stations {
            let (captures, sums) = weigh(station, variances);
            for (capture, weighted) in station.iter().zip(&captures) {
                hessian += capture.jacobian.transpose() * weighted.by_unknowns;
                gradient += capture.jacobian.transpose() * weighted.pull;
            }
            let reached = sums.reach * sums.by_unknowns;
            hessian -= sums.by_unknowns.transpose() * reached;
            gradient -= reached.transpose() * sums.pull;
            weighted.push((captures, sums));
        }
        let covariance = covariance_for_unit_noise(&hessian)?;
        let step = covariance * gradient;
        let mut scoring = Scoring {
            score: Vector4::zeros(),
            information: Matrix4::zeros(),
            information_loss: [Hessian::zeros(); NUM_COMPONENTS],
        };
        let mut num_captures = 0;
        for (station, (captures, sums)) in self.stations.iter().zip(&weighted) {
            num_captures += station.len();
            scoring.add_station(station, captures, sums, &step, &covariance);
        }
        // The nine unknowns cost freedom, which the blockwise information does not know.
        let left_over = |count: usize| {
            let equations = 3.0 * f64::from(u32::try_from(count).unwrap_or(u32::MAX));
            ((equations - 9.0) / equations).max(0.05)
        };
        let parts = [left_over(num_captures), left_over(self.stations.len())].map(f64::sqrt);
        for row in 0..NUM_COMPONENTS {
            for column in 0..NUM_COMPONENTS {
                scoring.information[(row, column)] *= parts[row / FIRST_COMMON] * parts[column / FIRST_COMMON];
            }
        }
        Ok(scoring)
    }
}

fn weigh(station: &[Capture], variances: &[f64; NUM_COMPONENTS]) -> (Vec<Weighted>, StationSums) {
    let mut sums = StationSums {
        information: Mat3::zeros(),
        pull: Vec3::zeros(),
        by_unknowns: Jacobian::zeros(),
        reach: Mat3::zeros(),
    };
    let captures: Vec<Weighted> = station
        .iter()
        .map(|capture| {
            let covariance = Mat3::identity() * variances[0] + capture.lever * variances[1];
            let damp = (Mat3::identity() + capture.information * covariance).try_inverse().unwrap_or_else(Mat3::zeros);
            let information = damp * capture.information;
            let pull = damp * capture.pull;
            let by_unknowns = information * capture.jacobian;
            sums.information += information;
            sums.pull += pull;
            sums.by_unknowns += by_unknowns;
            Weighted { information, pull, by_unknowns }
        })
        .collect();
    if let Some(first) = station.first() {
        let common = Mat3::identity() * variances[2] + first.lever * variances[3];
        let damp = (Mat3::identity() + sums.information * common).try_inverse().unwrap_or_else(Mat3::zeros);
        sums.reach = common * damp;
    }
    (captures, sums)
}

impl Scoring {
    fn add_station(
        &mut self,
        station: &[Capture],
        captures: &[Weighted],
        sums: &StationSums,
        step: &Gradient,
        covariance: &Hessian,
    ) {
        let Some(first) = station.first() else { return };
        let common_matrices = [Mat3::identity(), first.lever];
        let shift = sums.reach * (sums.pull - sums.by_unknowns * step);
        let reached = sums.reach * sums.by_unknowns;
        let reach_of_sum = sums.reach * sums.information;
        let mut station_pull = Vec3::zeros();
        for (capture, weighted) in station.iter().zip(captures) {
            let matrices = [Mat3::identity(), capture.lever];
            let pull = weighted.pull - weighted.by_unknowns * step - weighted.information * shift;
            station_pull += pull;
            // The capture's block of V⁻¹, and of V⁻¹ J.
            let own = weighted.information - weighted.information * sums.reach * weighted.information;
            let by_unknowns = weighted.by_unknowns - weighted.information * reached;
            let fitted = by_unknowns * covariance * by_unknowns.transpose();
            let to_common = weighted.information - weighted.information * reach_of_sum;
            for (row, matrix) in matrices.iter().enumerate() {
                self.score[row] += 0.5 * (pull.dot(&(matrix * pull)) - trace_of_product(matrix, &(own - fitted)));
                self.information_loss[row] += by_unknowns.transpose() * (matrix * by_unknowns);
                let weighted_matrix = own * matrix;
                for (column, other) in matrices.iter().enumerate() {
                    self.information[(row, column)] += 0.5 * trace_of_product(&weighted_matrix, &(own * other));
                }
                let carried = to_common.transpose() * matrix * to_common;
                for (column, other) in common_matrices.iter().enumerate() {
                    let cross = 0.5 * trace_of_product(&carried, other);
                    self.information[(row, FIRST_COMMON + column)] += cross;
                    self.information[(FIRST_COMMON + column, row)] += cross;
                }
            }
        }
        let of_sum = sums.information - sums.information * reach_of_sum;
        let by_unknowns = sums.by_unknowns - sums.information * reached;
        let fitted = by_unknowns * covariance * by_unknowns.transpose();
        for (row, matrix) in common_matrices.iter().enumerate() {
            self.score[FIRST_COMMON + row] +=
                0.5 * (station_pull.dot(&(matrix * station_pull)) - trace_of_product(matrix, &(of_sum - fitted)));
            self.information_loss[FIRST_COMMON + row] += by_unknowns.transpose() * (matrix * by_unknowns);
            for (column, other) in common_matrices.iter().enumerate() {
                self.information[(FIRST_COMMON + row, FIRST_COMMON + column)] +=
                    0.5 * trace_of_product(&(of_sum * matrix), &(of_sum * other));
            }
        }
    }
}

/// tr(A B) without the product.
fn trace_of_product(a: &Mat3, b: &Mat3) -> f64 {
    a.dot(&b.transpose())
}

/// The inverse of the rows and columns that are active; zero elsewhere.
fn inverse_of_active(information: &Matrix4<f64>, is_active: &impl Fn(usize) -> bool) -> Matrix4<f64> {
    // Scaled to a unit diagonal, as mm² and rad² differ by ten orders.
    let scale =
        Vector4::from_fn(
            |idx, _| if is_active(idx) { information[(idx, idx)].max(f64::MIN_POSITIVE).sqrt() } else { 1.0 },
        );
    let scaled = Matrix4::from_fn(|row, column| {
        if is_active(row) && is_active(column) {
            information[(row, column)] / (scale[row] * scale[column])
        } else if row == column {
            1.0
        } else {
            0.0
        }
    });
    // Position and orientation may be told apart hardly at all; a small ridge shares between them.
    let inverse = (scaled + Matrix4::identity() * 1e-9).try_inverse().unwrap_or_else(Matrix4::identity);
    Matrix4::from_fn(|row, column| {
        if is_active(row) && is_active(column) { inverse[(row, column)] / (scale[row] * scale[column]) } else { 0.0 }
    })
}

fn solve_active(scoring: &Scoring, is_active: &impl Fn(usize) -> bool) -> Vector4<f64> {
    inverse_of_active(&scoring.information, is_active) * scoring.score
}
