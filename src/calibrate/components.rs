//! The sizes of several noises from the scatter that they leave together.
//!
//! Restricted maximum likelihood for variance components by Fisher scoring (Patterson & Thompson 1971), on the logarithms of
//! the variances. A few points do not tell the noises apart, so their proportions have a prior: about those that they begin
//! with. Their common scale has none.

use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

use super::SolveError;
use super::plate::descent::inverse_of;

/// As many noises as a plate's point or a target's pose has.
pub(super) const NUM_COMPONENTS: usize = 3;
/// How far the variances are usually off their proportions: a factor of about three in the standard deviation.
const PROPORTION_STD: f64 = 2.2;
/// Scoring settles in four to ten steps, more where a component vanishes.
const MAX_ITERATIONS: usize = 40;
/// Changes below this are the end: far below how well variances can be known.
const SETTLED: f64 = 1e-6;
/// Step (of a variance's logarithm) over which differences are taken.
const DIFFERENCE: f64 = 1e-3;
/// A variance falls or grows by no more than a factor of ten a step, …
const MAX_STEP: f64 = 2.3;
/// … and ends at 1e-12 or 1e12 times what it began with: the data have no noise, or no bounds.
const MAX_LOG_FACTOR: f64 = 27.6;

/// The `R` residuals of one datum (a point's distances from its edge, a pose's errors), and what they may be off by; `U` is
/// the number of unknowns.
#[derive(Clone, Copy, Debug)]
pub(super) struct PointModel<const R: usize, const U: usize> {
    /// The residuals.
    pub residual: SVector<f64, R>,
    /// How they follow the unknowns.
    pub by_unknowns: SMatrix<f64, R, U>,
    /// Their covariance as far as it is known.
    pub known: SMatrix<f64, R, R>,
    /// What each component adds where its factor is one.
    pub open: [SMatrix<f64, R, R>; NUM_COMPONENTS],
}

impl<const R: usize, const U: usize> PointModel<R, U> {
    /// The covariance with the components' factors.
    pub fn covariance(&self, log_factors: &Vector3<f64>) -> SMatrix<f64, R, R> {
        let open: SMatrix<f64, R, R> = self.open.iter().zip(log_factors).map(|(part, log)| part * log.exp()).sum();
        self.known + open
    }
}

/// What was found of the components.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Found {
    /// Logarithms of the factors on the variances; zero where a component is not open.
    pub log_factors: Vector3<f64>,
    /// Their covariance.
    pub covariance: Matrix3<f64>,
}

impl Found {
    /// Nothing found yet: the factors are one.
    pub fn nothing() -> Self {
        Self { log_factors: Vector3::zeros(), covariance: Matrix3::zeros() }
    }

    /// Degrees of freedom (Satterthwaite's) of a variance that follows the components.
    ///
    /// # Errors
    /// Those of `variance_by`.
    pub fn degrees_of_freedom(
        &self,
        variance_by: impl Fn(&Self) -> Result<f64, SolveError>,
    ) -> Result<f64, SolveError> {
        if self.covariance == Matrix3::zeros() {
            return Ok(f64::INFINITY);
        }
        let mut slope = Vector3::zeros();
        for idx in 0..NUM_COMPONENTS {
            let at = |step: f64| {
                let mut found = *self;
                found.log_factors[idx] += step;
                variance_by(&found)
            };
            slope[idx] = (at(DIFFERENCE)? - at(-DIFFERENCE)?) / (2.0 * DIFFERENCE);
        }
        let variance = variance_by(self)?;
        let spread = slope.dot(&(self.covariance * slope));
        Ok(if spread > 0.0 { 2.0 * variance * variance / spread } else { f64::INFINITY })
    }
}

/// The points, and the components that are open.
pub(super) struct Components<const R: usize, const U: usize> {
    points: Vec<PointModel<R, U>>,
    is_open: [bool; NUM_COMPONENTS],
}

impl<const R: usize, const U: usize> Components<R, U> {
    pub fn new(points: Vec<PointModel<R, U>>) -> Self {
        let is_open = [0, 1, 2].map(|idx| points.iter().any(|point| point.open[idx].trace() > 0.0));
        Self { points, is_open }
    }

    pub fn is_any_open(&self) -> bool {
        self.is_open.contains(&true)
    }

    /// Sum of the squared residuals over their covariances.
    pub fn chi_square(&self, log_factors: &Vector3<f64>) -> f64 {
        let of_point = |point: &PointModel<R, U>| {
            let weight = point.covariance(log_factors).try_inverse().unwrap_or_else(SMatrix::zeros);
            point.residual.dot(&(weight * point.residual))
        };
        self.points.iter().map(of_point).sum()
    }

    /// The factors of greatest likelihood, from a start, and what is known of them.
    ///
    /// # Errors
    /// [`SolveError::Undetermined`] if the points leave an unknown free.
    pub fn fit(&self, start: Vector3<f64>) -> Result<Found, SolveError> {
        let mut log_factors = start;
        for _ in 0..MAX_ITERATIONS {
            let (score, information) = self.scoring(&log_factors)?;
            let step = inverse_of_open(&information) * score;
            let before = log_factors;
            for idx in (0..NUM_COMPONENTS).filter(|idx| self.is_open[*idx]) {
                let stepped = before[idx] + step[idx].clamp(-MAX_STEP, MAX_STEP);
                log_factors[idx] = stepped.clamp(-MAX_LOG_FACTOR, MAX_LOG_FACTOR);
            }
            if (log_factors - before).amax() < SETTLED {
                break;
            }
        }
        // Where a component vanishes the last step still changes what is known of it.
        let (_, information) = self.scoring(&log_factors)?;
        Ok(Found { log_factors, covariance: inverse_of_open(&information) })
    }

    /// How the likelihood rises with the logarithms, and the information about them.
    ///
    /// With V the covariance of all residuals, B a component's part of it, P = V⁻¹ − V⁻¹ J H⁻¹ Jᵀ V⁻¹ and y the residuals: the
    /// score is ½ (yᵀ P B P y − tr(P B)), the information ½ tr(P B P B'). V and B are small blocks, so sums over the points
    /// suffice.
    fn scoring(&self, log_factors: &Vector3<f64>) -> Result<(Vector3<f64>, Matrix3<f64>), SolveError> {
        let mut hessian = SMatrix::<f64, U, U>::zeros();
        let mut pull = SMatrix::<f64, U, 1>::zeros();
        let weights: Vec<SMatrix<f64, R, R>> = self
            .points
            .iter()
            .map(|point| {
                let weight = point.covariance(log_factors).try_inverse().unwrap_or_else(SMatrix::zeros);
                let weighted = product(&point.by_unknowns.transpose(), &weight);
                hessian += product(&weighted, &point.by_unknowns);
                pull += weighted * point.residual;
                weight
            })
            .collect();
        let inverse = inverse_of(&hessian)?;
        let fitted = inverse * pull;
        let (mut score, mut information) = self.prior(log_factors);
        let mut losses = [SMatrix::<f64, U, U>::zeros(); NUM_COMPONENTS];
        for (point, weight) in self.points.iter().zip(&weights) {
            let left = weight * (point.residual - point.by_unknowns * fitted);
            let by_unknowns = product(weight, &point.by_unknowns);
            let spread = product(&product(&by_unknowns, &inverse), &by_unknowns.transpose());
            let parts: [SMatrix<f64, R, R>; NUM_COMPONENTS] =
                std::array::from_fn(|idx| point.open[idx] * log_factors[idx].exp());
            let weighted = parts.each_ref().map(|part| product(weight, part));
            let spread_parts = parts.each_ref().map(|part| product(&spread, part));
            for (row, part) in parts.iter().enumerate() {
                score[row] += 0.5 * (left.dot(&(part * left)) - (weighted[row].trace() - spread_parts[row].trace()));
                losses[row] += product(&by_unknowns.transpose(), &product(part, &by_unknowns));
                for column in 0..NUM_COMPONENTS {
                    // Traces of W B W B' and W B (V⁻¹ J H⁻¹ Jᵀ V⁻¹) B'.
                    let own = trace_of_product(&weighted[row], &weighted[column]);
                    let shared = trace_of_product(&weighted[column], &spread_parts[row]);
                    information[(row, column)] += 0.5 * own - shared;
                }
            }
        }
        for (row, loss) in losses.iter().enumerate() {
            for (column, other) in losses.iter().enumerate() {
                information[(row, column)] += 0.5 * (inverse * loss * inverse * other).trace();
            }
        }
        // A component that is not open has no information; its row must not spoil the others'.
        for idx in (0..NUM_COMPONENTS).filter(|idx| !self.is_open[*idx]) {
            score[idx] = 0.0;
            information.row_mut(idx).fill(0.0);
            information.column_mut(idx).fill(0.0);
        }
        Ok((score, information))
    }

    /// The prior's: open components keep near each other.
    fn prior(&self, log_factors: &Vector3<f64>) -> (Vector3<f64>, Matrix3<f64>) {
        let is_open = Vector3::from(self.is_open.map(|is_open| if is_open { 1.0 } else { 0.0 }));
        let weight = PROPORTION_STD.powi(-2);
        let information = (Matrix3::from_diagonal(&is_open) - is_open * is_open.transpose() / is_open.sum()) * weight;
        (-information * log_factors, information)
    }
}

/// A product of small matrices: nalgebra packs those of more than five rows as if they were large ones.
pub(super) fn product<const R: usize, const K: usize, const C: usize>(
    left: &SMatrix<f64, R, K>,
    right: &SMatrix<f64, K, C>,
) -> SMatrix<f64, R, C> {
    let mut product = SMatrix::<f64, R, C>::zeros();
    for column in 0..C {
        for middle in 0..K {
            let factor = right[(middle, column)];
            for row in 0..R {
                product[(row, column)] += left[(row, middle)] * factor;
            }
        }
    }
    product
}

fn trace_of_product<const R: usize>(left: &SMatrix<f64, R, R>, right: &SMatrix<f64, R, R>) -> f64 {
    left.dot(&right.transpose())
}

/// The inverse over the components that have information; zero elsewhere.
fn inverse_of_open(information: &Matrix3<f64>) -> Matrix3<f64> {
    let eigen = information.symmetric_eigen();
    let least = 1e-9 * eigen.eigenvalues.amax();
    let inverted = eigen.eigenvalues.map(|value| if value > least { value.recip() } else { 0.0 });
    eigen.eigenvectors * Matrix3::from_diagonal(&inverted) * eigen.eigenvectors.transpose()
}
