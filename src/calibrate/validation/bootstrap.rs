//! The spread of the result over stations drawn with replacement: a σ that rests on no model of the noise.

use crate::calibrate::Solution;
use crate::calibrate::uncertainty::distance_quantile;
use crate::geometry::stats::{self, SplitMix};
use crate::watch::{Cancelled, Watch};

use super::{Data, workspace_point};

/// Fewer draws than this show no spread.
const MIN_DRAWS: usize = 20;

/// The spread of the result over stations drawn with replacement.
#[derive(Clone, Debug, PartialEq)]
pub struct Bootstrap {
    /// Distance of the workspace point from that of the result, one entry a draw, mm, rising; empty where too few draws could
    /// be solved, and then the figures are NaN.
    pub distances_mm: Vec<f64>,
    /// Standard deviation by their median, which a few draws of hardly any stations do not move: to be held against
    /// `workspace_point_std_mm`, mm.
    pub std_mm: f64,
    /// 95 % of the draws are within this, mm.
    pub within_95_mm: f64,
    /// Draws without a solution, as they had too few stations of their own.
    pub num_failed: usize,
}

/// Solves `num_draws` times with stations drawn with replacement. The same seed gives the same draws.
///
/// # Errors
/// [`Cancelled`] if `watch` says so.
pub fn bootstrap(
    solution: &Solution,
    num_draws: usize,
    seed: u64,
    watch: &mut dyn Watch,
) -> Result<Bootstrap, Cancelled> {
    let data = Data::of(solution);
    let num_stations = data.map_or(0, Data::num_stations);
    let reference_point =
        solution.uncertainty.as_ref().map(|uncertainty| uncertainty.reference_point_in_sensor_mm).unwrap_or_default();
    let here = workspace_point(solution.flange_from_sensor.rigid(), reference_point);
    let mut random = SplitMix::new(seed);
    let mut distances_mm = Vec::with_capacity(num_draws);
    for draw in 0..num_draws {
        watch.report(draw, num_draws)?;
        let mut times = vec![0.0; num_stations];
        for _ in 0..num_stations {
            times[random.below(num_stations)] += 1.0;
        }
        if let Some(again) = data.and_then(|data| data.solve_with_times(|station| times[station])) {
            distances_mm.push((workspace_point(&again.flange_from_sensor, reference_point) - here).norm());
        }
    }
    distances_mm.sort_by(f64::total_cmp);
    if distances_mm.len() < MIN_DRAWS {
        distances_mm.clear();
    }
    Ok(Bootstrap {
        std_mm: std_by_median(solution, &distances_mm),
        within_95_mm: distances_mm.get(distances_mm.len() * 95 / 100).copied().unwrap_or(f64::NAN),
        num_failed: num_draws - distances_mm.len(),
        distances_mm,
    })
}

/// The stated σ times how much larger the median distance is than that σ lets one expect.
fn std_by_median(solution: &Solution, distances_mm: &[f64]) -> f64 {
    let Some(known) = &solution.uncertainty else { return f64::NAN };
    let expected_mm = distance_quantile(0.5, &known.workspace_point_covariance, f64::INFINITY);
    known.workspace_point_std_mm * stats::median(&mut distances_mm.to_vec()) / expected_mm
}
