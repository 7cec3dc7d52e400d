//! Two halves of the stations against each other: on real data they differed by millimetres where the residual was tenths.

use crate::calibrate::Solution;
use crate::calibrate::solver::{covariance_for_unit_noise, sensor_block};
use crate::calibrate::uncertainty::{distance_quantile, point_by_sensor};
use crate::geometry::stats::{self, SplitMix};

use super::workspace_point;

/// A half needs four stations.
const MIN_STATIONS: usize = 8;
/// Enough for a median; they take a few milliseconds.
const NUM_SPLITS: usize = 60;
/// With fewer than this the median is chance.
const MIN_SPLITS: usize = 10;

/// Calibrations from two halves of the stations, for many ways to halve them.
#[derive(Clone, Debug, PartialEq)]
pub struct SplitHalf {
    /// How far apart the two halves put the workspace point, mm, rising.
    pub disagreements_mm: Vec<f64>,
    /// Their median, mm.
    pub median_mm: f64,
    /// The largest, mm.
    pub max_mm: f64,
    /// The median that the stated σ lets one expect, mm.
    pub expected_mm: f64,
}

/// `None` with too few stations, or if hardly any half can be solved.
pub(super) fn split_half(solution: &Solution) -> Option<SplitHalf> {
    let reduced = solution.reduced.as_ref()?;
    if reduced.num_stations < MIN_STATIONS {
        return None;
    }
    let reference_point = solution.uncertainty.as_ref()?.reference_point_in_sensor_mm;
    let factor = reduced.variance_factor?;
    let by_sensor = point_by_sensor(reference_point);
    let mut random = SplitMix::new(1);
    let mut order: Vec<usize> = (0..reduced.num_stations).collect();
    let (mut disagreements_mm, mut expected_mm) = (Vec::new(), Vec::new());
    for _ in 0..NUM_SPLITS {
        for idx in (1..order.len()).rev() {
            order.swap(idx, random.below(idx + 1));
        }
        let first_half = &order[..reduced.num_stations / 2];
        let solved = |is_first: bool| {
            let minimum = reduced.solve_with(|station| first_half.contains(&station) == is_first).ok()?;
            let covariance = covariance_for_unit_noise(&minimum.hessian).ok()?;
            let of_point = by_sensor * sensor_block(&covariance) * by_sensor.transpose() * factor;
            let rotation = minimum.state.flange_from_sensor.rotation.to_rotation_matrix();
            let in_flange = rotation.matrix() * of_point * rotation.matrix().transpose();
            Some((workspace_point(&minimum.state, reference_point), in_flange))
        };
        let Some(((point, covariance), (other_point, other_covariance))) = solved(true).zip(solved(false)) else {
            continue;
        };
        disagreements_mm.push((point - other_point).norm());
        expected_mm.push(distance_quantile(0.5, &(covariance + other_covariance), f64::INFINITY));
    }
    if disagreements_mm.len() < MIN_SPLITS {
        return None;
    }
    disagreements_mm.sort_by(f64::total_cmp);
    Some(SplitHalf {
        median_mm: stats::median(&mut disagreements_mm.clone()),
        max_mm: stats::max(disagreements_mm.iter().copied()),
        expected_mm: stats::median(&mut expected_mm),
        disagreements_mm,
    })
}
