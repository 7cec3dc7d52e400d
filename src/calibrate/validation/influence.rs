//! What each station means for the result: its residual against what it may be, and what leaving it out moves.

use nalgebra::SMatrix;

use crate::calibrate::motion::{MotionRefit, MotionState};
use crate::calibrate::observation::{NUM_UNKNOWNS, State};
use crate::calibrate::plate::PlateRefit;
use crate::calibrate::reduced::Reduced;
use crate::calibrate::solver::{Hessian, covariance_for_unit_noise};
use crate::calibrate::{MotionFound, PlateFound, Solution};
use crate::geometry::so3::hat;
use crate::geometry::{Mat3, Vec3, stats};

use super::leave_one_out::{information_and_pull_in_base, minima_without_each};
use super::workspace_point;

/// What one station means for the result.
#[derive(Clone, Debug, PartialEq)]
pub struct Influence {
    /// The caller's index of the station.
    pub station_idx: usize,
    /// The user's name for it.
    pub label: String,
    /// Residual against the solution made without the station, over what its noise and that solution's uncertainty let one
    /// expect: a root mean square over the three directions, so about 1 for a good station.
    pub studentised_residual: f64,
    /// Probability of so large a residual by chance, in this one station.
    pub p_value: f64,
    /// How far the workspace point moves when the station is left out, mm.
    pub moves_workspace_point_mm: f64,
}

/// One entry a station; `None` where nothing can be left out.
pub(super) fn influence(solution: &Solution) -> Option<Vec<Influence>> {
    let reference_point = solution.uncertainty.as_ref()?.reference_point_in_sensor_mm;
    match (&solution.reduced, &solution.plate, &solution.motion) {
        (Some(reduced), _, _) => of_stations(solution, reduced, reference_point),
        (None, Some(plate), _) => of_plate(plate, reference_point),
        (None, None, Some(motion)) => of_motion(solution, motion, reference_point),
        (None, None, None) => None,
    }
}

fn of_stations(solution: &Solution, reduced: &Reduced, reference_point: Vec3) -> Option<Vec<Influence>> {
    let factor = reduced.variance_factor?;
    let here = workspace_point(&reduced.state.flange_from_sensor, reference_point);
    minima_without_each(reduced)
        .into_iter()
        .zip(&solution.stations)
        .enumerate()
        .map(|(idx, (minimum, station))| {
            let minimum = minimum?;
            let others = covariance_for_unit_noise(&minimum.hessian).ok()?;
            let chi_square = squared_residual(reduced, idx, &minimum.state, &others)? / factor;
            Some(Influence {
                station_idx: station.station_idx,
                label: station.label.clone(),
                studentised_residual: (chi_square / 3.0).sqrt(),
                p_value: stats::chi_squared_p_value(chi_square, 3.0),
                moves_workspace_point_mm: (workspace_point(&minimum.state.flange_from_sensor, reference_point) - here)
                    .norm(),
            })
        })
        .collect()
}

/// The same for a plate: each point of a station against the edge of the solution made without it.
fn of_plate(plate: &PlateFound, reference_point: Vec3) -> Option<Vec<Influence>> {
    let reduced = &plate.reduced;
    let here = workspace_point(&reduced.state.flange_from_sensor, reference_point);
    let of_station = |(station, refit): (usize, Option<PlateRefit>)| {
        let refit = refit?;
        let named = plate.points.iter().find(|point| point.station == station)?;
        let (mut chi_square, mut freedom) = (0.0, 0.0);
        for point in reduced.points.iter().filter(|point| point.station == station) {
            let by_unknowns = refit.state.by_unknowns(point);
            let predicted = by_unknowns * refit.covariance * by_unknowns.transpose();
            let expected = predicted + point.information.try_inverse()?;
            let off = refit.state.off_edge(point);
            chi_square += off.dot(&(expected.try_inverse()? * off));
            freedom += 2.0;
        }
        Some(Influence {
            station_idx: named.station_idx,
            label: named.label.clone(),
            studentised_residual: (chi_square / freedom).sqrt(),
            p_value: stats::chi_squared_p_value(chi_square, freedom),
            moves_workspace_point_mm: (workspace_point(&refit.state.flange_from_sensor, reference_point) - here).norm(),
        })
    };
    reduced.without_each().into_iter().enumerate().map(of_station).collect()
}

/// The same for a target's poses: each pose of a station against the solution made without it.
fn of_motion(solution: &Solution, motion: &MotionFound, reference_point: Vec3) -> Option<Vec<Influence>> {
    let reduced = motion.reduced.as_ref()?;
    let here = workspace_point(&reduced.state.flange_from_sensor, reference_point);
    let of_station = |(station, refit): (usize, Option<MotionRefit>)| {
        let refit = refit?;
        let named = solution.stations.get(station)?;
        let (mut chi_square, mut freedom) = (0.0, 0.0);
        for pose in reduced.poses.iter().filter(|pose| pose.station == station) {
            let errors = refit.state.errors(pose);
            let by_unknowns = MotionState::by_unknowns(pose, &errors);
            let expected =
                by_unknowns * refit.covariance * by_unknowns.transpose() + pose.information.matrix().try_inverse()?;
            let off = errors.vector();
            chi_square += off.dot(&(expected.try_inverse()? * off));
            freedom += 6.0;
        }
        Some(Influence {
            station_idx: named.station_idx,
            label: named.label.clone(),
            studentised_residual: (chi_square / freedom).sqrt(),
            p_value: stats::chi_squared_p_value(chi_square, freedom),
            moves_workspace_point_mm: (workspace_point(&refit.state.flange_from_sensor, reference_point) - here).norm(),
        })
    };
    reduced.without_each().into_iter().enumerate().map(of_station).collect()
}

/// The station's ball against that of the others, squared, in the metric of what may be expected of it.
///
/// With the station's information G about the ball (in the base), its pull p and the covariance P of what the others
/// predict, the difference d = G⁻¹ p has the covariance G⁻¹ + P: the square is pᵀ (I + P G)⁻¹ G⁻¹ p.
fn squared_residual(reduced: &Reduced, station: usize, state: &State, others: &Hessian) -> Option<f64> {
    let run = reduced.stations().find(|run| run[0].station == station)?;
    let first = run.first()?;
    let (centre, sensor_from_base) = state.ball_in_sensor_and_rotation(&first.base_from_flange);
    let base_from_sensor = sensor_from_base.transpose();
    let (mut information, mut pull) = information_and_pull_in_base(run.iter(), state, Mat3::zeros());
    if let Some(common) = reduced.common_covariance.get(station) {
        let in_base = base_from_sensor * common * sensor_from_base;
        let damp = (Mat3::identity() + information * in_base).try_inverse()?;
        information = damp * information;
        pull = damp * pull;
    }
    let mut by_unknowns = SMatrix::<f64, 3, NUM_UNKNOWNS>::zeros();
    by_unknowns.fixed_view_mut::<3, 3>(0, 0).copy_from(&(base_from_sensor * hat(centre)));
    by_unknowns.fixed_view_mut::<3, 3>(0, 3).copy_from(&-base_from_sensor);
    by_unknowns.fixed_view_mut::<3, 3>(0, 6).copy_from(&Mat3::identity());
    let predicted = by_unknowns * others * by_unknowns.transpose();
    // A direction that the station is blind in pulls with nothing, so a ridge far below the rest changes nothing.
    let ridge = Mat3::identity() * (1e-12 * information.trace());
    let difference = ((information + information.transpose()) * 0.5 + ridge).cholesky()?.solve(&pull);
    let expected = (Mat3::identity() + predicted * information).try_inverse()?;
    Some(pull.dot(&(expected * difference)).max(0.0))
}
