//! Two halves of the stations against each other: on real data they differed by millimetres where the residual was tenths.

use crate::calibrate::Solution;
use crate::calibrate::uncertainty::{distance_quantile, point_by_sensor};
use crate::geometry::stats::{self, SplitMix};

use super::{Data, workspace_point};

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
    let data = Data::of(solution)?;
    let num_stations = data.num_stations();
    if num_stations < MIN_STATIONS {
        return None;
    }
    let reference_point = solution.uncertainty.as_ref()?.reference_point_in_sensor_mm;
    let by_sensor = point_by_sensor(reference_point);
    let mut random = SplitMix::new(1);
    let mut order: Vec<usize> = (0..num_stations).collect();
    let (mut disagreements_mm, mut expected_mm) = (Vec::new(), Vec::new());
    for _ in 0..NUM_SPLITS {
        for idx in (1..order.len()).rev() {
            order.swap(idx, random.below(idx + 1));
        }
        let first_half = &order[..num_stations / 2];
        let solved = |is_first: bool| {
            let is_used = |station: usize| first_half.contains(&station) == is_first;
            let half = data.solve_with_times(|station| if is_used(station) { 1.0 } else { 0.0 })?;
            let of_point = by_sensor * half.covariance * by_sensor.transpose();
            let rotation = half.flange_from_sensor.rotation.to_rotation_matrix();
            let in_flange = rotation.matrix() * of_point * rotation.matrix().transpose();
            Some((workspace_point(&half.flange_from_sensor, reference_point), in_flange))
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
