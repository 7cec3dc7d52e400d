//! The spread of the result over stations drawn with replacement: a σ that rests on no model of the noise.

use crate::calibrate::Solution;
use crate::geometry::stats::{self, SplitMix};
use crate::watch::{Cancelled, Watch};

use super::workspace_point;

/// The spread of the result over stations drawn with replacement.
#[derive(Clone, Debug, PartialEq)]
pub struct Bootstrap {
    /// Distance of the workspace point from that of the result, one entry a draw, mm, rising.
    pub distances_mm: Vec<f64>,
    /// Their root mean square: to be held against `workspace_point_std_mm`, mm.
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
    let reduced = &solution.reduced;
    let reference_point =
        solution.uncertainty.as_ref().map(|uncertainty| uncertainty.reference_point_in_sensor_mm).unwrap_or_default();
    let here = workspace_point(&reduced.state, reference_point);
    let mut random = SplitMix::new(seed);
    let mut distances_mm = Vec::with_capacity(num_draws);
    for draw in 0..num_draws {
        watch.report(draw, num_draws)?;
        let mut times = vec![0.0; reduced.num_stations];
        for _ in 0..reduced.num_stations {
            times[random.below(reduced.num_stations)] += 1.0;
        }
        if let Ok(minimum) = reduced.solve_with_times(|station| times[station])
            && minimum.converged
        {
            distances_mm.push((workspace_point(&minimum.state, reference_point) - here).norm());
        }
    }
    distances_mm.sort_by(f64::total_cmp);
    Ok(Bootstrap {
        std_mm: stats::rms(distances_mm.iter().copied()),
        within_95_mm: distances_mm.get(distances_mm.len() * 95 / 100).copied().unwrap_or(f64::NAN),
        num_failed: num_draws - distances_mm.len(),
        distances_mm,
    })
}
