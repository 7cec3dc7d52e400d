//! What each station means for the result: its residual against what it may be, and what leaving it out moves.

use nalgebra::SMatrix;

use crate::calibrate::motion::{MotionRefit, TrackRefit};
use crate::calibrate::observation::{NUM_UNKNOWNS, State};
use crate::calibrate::plate::PlateRefit;
use crate::calibrate::plate::descent::{Sums, inverse_of};
use crate::calibrate::reduced::Reduced;
use crate::calibrate::solver::{Hessian, Minimum, covariance_for_unit_noise};
use crate::calibrate::{Solution, motion, plate};
use crate::geometry::so3::hat;
use crate::geometry::{Mat3, Rigid, stats};

use super::leave_one_out::{information_and_pull_in_base, minima_without_each};
use super::{Data, workspace_point};

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
    let data = Data::of(solution)?;
    let here = workspace_point(solution.flange_from_sensor.rigid(), reference_point);
    let entry = |station: usize, left_out: Option<LeftOut>| {
        let LeftOut { chi_square, freedom, flange_from_sensor } = left_out?;
        let (station_idx, label) = named(solution, station)?;
        Some(Influence {
            station_idx,
            label,
            studentised_residual: (chi_square / freedom).sqrt(),
            p_value: stats::chi_squared_p_value(chi_square, freedom),
            moves_workspace_point_mm: (workspace_point(&flange_from_sensor, reference_point) - here).norm(),
        })
    };
    without_each(data).into_iter().enumerate().map(|(station, left_out)| entry(station, left_out)).collect()
}

/// The caller's index and the user's name of a station used.
fn named(solution: &Solution, station: usize) -> Option<(usize, String)> {
    if let Some(plate) = &solution.plate {
        let point = plate.points.iter().find(|point| point.station == station)?;
        return Some((point.station_idx, point.label.clone()));
    }
    solution.stations.get(station).map(|named| (named.station_idx, named.label.clone()))
}

/// A station against the solution made without it.
struct LeftOut {
    /// Its residuals, squared in the metric of what may be expected of them.
    chi_square: f64,
    /// How many they are.
    freedom: f64,
    /// That solution.
    flange_from_sensor: Rigid,
}

/// One entry a station; `None` where the others do not do.
fn without_each(data: Data<'_>) -> Vec<Option<LeftOut>> {
    match data {
        Data::Points(reduced) => of_points(reduced),
        Data::Plate(reduced) => {
            let of_station = |(station, refit): (usize, Option<PlateRefit>)| {
                let PlateRefit { state, covariance } = refit?;
                let times = |of: usize| if of == station { 1.0 } else { 0.0 };
                let count = reduced.points.iter().filter(|point| point.station == station).count();
                let own = plate::points::sums_of(&reduced.points, &state, times);
                LeftOut::of(&own, &covariance, 2 * count, state.flange_from_sensor)
            };
            reduced.without_each().into_iter().enumerate().map(of_station).collect()
        }
        Data::Motion(reduced) => {
            let of_station = |(station, refit): (usize, Option<MotionRefit>)| {
                let MotionRefit { state, covariance } = refit?;
                let times = |of: usize| if of == station { 1.0 } else { 0.0 };
                let count = reduced.poses.iter().filter(|pose| pose.station == station).count();
                let own = motion::pose::sums_of(&reduced.poses, &state, times);
                LeftOut::of(&own, &covariance, 6 * count, state.flange_from_sensor)
            };
            reduced.without_each().into_iter().enumerate().map(of_station).collect()
        }
        Data::Track(reduced) => {
            let of_stretch = |(stretch, refit): (usize, Option<TrackRefit>)| {
                let TrackRefit { flange_from_sensor, covariance } = refit?;
                let own = reduced.sums_of_stretch(stretch, &flange_from_sensor);
                LeftOut::of(&own, &covariance, 6 * reduced.num_believed(stretch), flange_from_sensor)
            };
            reduced.without_each().into_iter().enumerate().map(of_stretch).collect()
        }
    }
}

impl LeftOut {
    /// From the station's own sums at the solution of the others, and the covariance P of that.
    ///
    /// With J how the residuals r follow the unknowns and W their weights, they have the covariance W⁻¹ + J P Jᵀ. Its inverse
    /// (Woodbury's) gives the square rᵀ W r − gᵀ (P⁻¹ + H)⁻¹ g with H = Jᵀ W J and g = Jᵀ W r: the sums suffice.
    fn of<const N: usize>(
        own: &Sums<N>,
        others: &SMatrix<f64, N, N>,
        num_residuals: usize,
        flange_from_sensor: Rigid,
    ) -> Option<Self> {
        let with_own = inverse_of(&(inverse_of(others).ok()? + own.hessian)).ok()?;
        let explained = own.gradient.dot(&(with_own * own.gradient));
        #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 residuals")]
        let freedom = num_residuals as f64;
        Some(Self { chi_square: (own.cost - explained).max(0.0), freedom, flange_from_sensor })
    }
}

fn of_points(reduced: &Reduced) -> Vec<Option<LeftOut>> {
    let of_station = |(station, minimum): (usize, Option<Minimum>)| {
        let minimum = minimum?;
        let others = covariance_for_unit_noise(&minimum.hessian).ok()?;
        let square = squared_residual(reduced, station, &minimum.state, &others)?;
        Some(LeftOut {
            chi_square: square / reduced.variance_factor?,
            freedom: 3.0,
            flange_from_sensor: minimum.state.flange_from_sensor,
        })
    };
    minima_without_each(reduced).into_iter().enumerate().map(of_station).collect()
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
