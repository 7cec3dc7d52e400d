//! Leave-one-station-out: the error that the residual hides.

use crate::geometry::{Mat3, Vec3};

use super::observation::{CentreObservation, State};
use super::solver::{Normal, minimise_from};

/// With fewer stations than this nothing is left over once one is taken away.
pub const MIN_STATIONS: usize = 5;

/// Where the station's own observations put the ball, in the base, for a given sensor on the flange, mm.
///
/// `prior_information` (1/mm²) holds directions that the station is blind in at `state.ball_in_base`.
#[must_use]
pub fn station_ball<'a>(
    observations: impl Iterator<Item = &'a CentreObservation>,
    state: &State,
    prior_information: f64,
) -> Vec3 {
    let mut information = Mat3::identity() * prior_information;
    let mut pull = Vec3::zeros();
    for observation in observations {
        let rotation = (observation.base_from_flange.rotation * state.flange_from_sensor.rotation).to_rotation_matrix();
        let centre = state.ball_in_sensor(&observation.base_from_flange);
        information += rotation.matrix() * observation.information * rotation.matrix().transpose();
        pull += rotation * (observation.information * (observation.centre_in_sensor - centre) + observation.pull);
    }
    let shift = information.cholesky().map_or_else(Vec3::zeros, |factor| factor.solve(&pull));
    state.ball_in_base + shift
}

/// For each station: how far its ball lies from the ball of the solution made without it, mm. `None` where that
/// solution does not exist.
///
/// The sums of a station are taken from those of all, which gives the first step for nothing; one or two more settle it.
#[must_use]
pub fn leave_one_out(
    observations: &[CentreObservation],
    num_stations: usize,
    full: &State,
    prior_information: f64,
) -> Vec<Option<f64>> {
    /// 1e-6 mm: far below what the error is shown to.
    const SETTLED: f64 = 1e-8;
    if num_stations < MIN_STATIONS {
        return vec![None; num_stations];
    }
    let of_station = |station: usize| observations.iter().filter(move |observation| observation.station == station);
    let sums: Vec<Normal> = (0..num_stations).map(|station| Normal::of(of_station(station), full)).collect();
    (0..num_stations)
        .map(|left_out| {
            let mut normal = Normal::zero();
            for (_, station) in sums.iter().enumerate().filter(|(station, _)| *station != left_out) {
                normal.hessian += station.hessian;
                normal.gradient += station.gradient;
                normal.cost += station.cost;
            }
            let others = observations.iter().filter(|observation| observation.station != left_out);
            let minimum = minimise_from(&others, *full, normal, SETTLED).ok()?;
            let ball_in_base = station_ball(of_station(left_out), &minimum.state, prior_information);
            Some((ball_in_base - minimum.state.ball_in_base).norm())
        })
        .collect()
}
