//! Are the residuals those of noise? Anderson and Darling's test on the whitened residuals of all captures.
//!
//! # Source
//! M. A. Stephens in D'Agostino & Stephens, "Goodness-of-fit techniques", 1986, section 4.8: the percentage points for a known
//! mean and an estimated variance; those above 15 % are from a simulation of our own.

use crate::calibrate::observation::CentreObservation;
use crate::calibrate::reduced::Reduced;
use crate::calibrate::{MotionReduced, PlateReduced, Solution};
use crate::geometry::{Mat3, Vec3, stats};

use super::Data;

/// With fewer residuals a test says nothing.
const MIN_RESIDUALS: usize = 20;

/// Whether the residuals are normally distributed (Anderson and Darling's test on whitened residuals).
#[derive(Clone, Debug, PartialEq)]
pub struct Normality {
    /// Probability of such residuals by chance.
    pub p_value: f64,
    /// `[quantile of the normal distribution, residual over its σ]`, rising.
    pub quantiles: Vec<[f64; 2]>,
}

/// `None` with too few residuals, or if they are exactly zero.
pub(super) fn normality(solution: &Solution) -> Option<Normality> {
    let mut residuals = match Data::of(solution)? {
        Data::Points(reduced) => whitened_residuals(reduced),
        Data::Plate(reduced) => whitened_distances(reduced),
        Data::Motion(reduced) => whitened_errors(reduced),
        Data::Track(reduced) => reduced.whitened_errors(),
    };
    if residuals.len() < MIN_RESIDUALS {
        return None;
    }
    let std = stats::rms(residuals.iter().copied());
    if !(std.is_finite() && std > 0.0) {
        return None;
    }
    for residual in &mut residuals {
        *residual /= std;
    }
    residuals.sort_by(f64::total_cmp);
    #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 residuals")]
    let count = residuals.len() as f64;
    #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 residuals")]
    let quantiles = residuals
        .iter()
        .enumerate()
        .map(|(idx, residual)| [stats::normal_quantile((idx as f64 + 0.5) / count), *residual])
        .collect();
    Some(Normality { p_value: anderson_darling_p_value(&residuals), quantiles })
}

/// The residuals of all captures along the directions that they know about, each over its σ. What is common to a station is
/// taken off first.
fn whitened_residuals(reduced: &Reduced) -> Vec<f64> {
    let mut residuals = Vec::with_capacity(3 * reduced.observations.len());
    for run in reduced.stations() {
        let pulls: Vec<Vec3> = run.iter().map(|observation| observation.pull_at(&reduced.state)).collect();
        let shift = common_shift(reduced, run, &pulls);
        for (observation, pull) in run.iter().zip(pulls) {
            let pull = pull - observation.information * shift;
            residuals.extend(observation.whitened(pull));
        }
    }
    residuals
}

/// The distances of a plate's points from their edges, along two axes each, over their σ.
fn whitened_distances(reduced: &PlateReduced) -> Vec<f64> {
    let whitened = reduced.points.iter().filter_map(|point| {
        let factor = point.information.cholesky()?;
        let whitened = factor.l().transpose() * reduced.state.off_edge(point);
        Some([whitened.x, whitened.y])
    });
    whitened.flatten().collect()
}

/// The errors of a target's poses, along six directions each, over their σ.
fn whitened_errors(reduced: &MotionReduced) -> Vec<f64> {
    let whitened = reduced.poses.iter().filter_map(|pose| {
        let factor = pose.information.matrix().cholesky()?;
        Some(factor.l().transpose() * reduced.state.errors(pose).vector())
    });
    whitened.flat_map(<[f64; 6]>::from).collect()
}

/// The likeliest shift that all captures of a station share.
fn common_shift(reduced: &Reduced, run: &[CentreObservation], pulls: &[Vec3]) -> Vec3 {
    let covariance = run.first().and_then(|first| reduced.common_covariance.get(first.station));
    let Some(covariance) = covariance else { return Vec3::zeros() };
    let information: Mat3 = run.iter().map(|observation| observation.information).sum();
    let pull: Vec3 = pulls.iter().sum();
    (Mat3::identity() + information * covariance)
        .try_inverse()
        .map_or_else(Vec3::zeros, |damp| covariance * (damp * pull))
}

/// Probability of a statistic as large for normal values of mean 0 and estimated variance. `sorted`: scaled to unit variance.
fn anderson_darling_p_value(sorted: &[f64]) -> f64 {
    /// Keeps the logarithms finite for wild values.
    const LEAST: f64 = 1e-300;
    #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 residuals")]
    let count = sorted.len() as f64;
    let mut sum = 0.0;
    for (idx, value) in sorted.iter().enumerate() {
        let opposite = sorted[sorted.len() - 1 - idx];
        let below = stats::normal_cdf(*value).max(LEAST).ln();
        let above = stats::normal_cdf(-opposite).max(LEAST).ln();
        #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 residuals")]
        let weight = 2.0 * idx as f64 + 1.0;
        sum += weight * (below + above);
    }
    let statistic = -count - sum / count;
    p_value_of(statistic)
}

/// Between the percentage points the logarithm of the probability is nearly straight, and beyond them as well.
fn p_value_of(statistic: f64) -> f64 {
    const POINTS: [[f64; 2]; 8] = [
        [0.0, 1.0],
        [0.644, 0.5],
        [1.072, 0.25],
        [1.430, 0.15],
        [1.743, 0.10],
        [2.308, 0.05],
        [2.898, 0.025],
        [3.702, 0.01],
    ];
    let segment = POINTS.windows(2).find(|pair| statistic < pair[1][0]).unwrap_or(&POINTS[6..8]);
    let [[x0, p0], [x1, p1]] = [segment[0], segment[1]];
    let slope = (p1.ln() - p0.ln()) / (x1 - x0);
    (p0.ln() + slope * (statistic - x0)).exp().clamp(0.0, 1.0)
}
