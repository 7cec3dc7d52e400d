//! Leave-one-station-out: the error that the residual hides.

use crate::calibrate::observation::{CentreObservation, State};
use crate::calibrate::reduced::Reduced;
use crate::calibrate::solver::{Minimum, Normal, minimise_from};
use crate::geometry::{Mat3, Vec3};

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
    let prior = Mat3::identity() * prior_information;
    let (information, pull) = information_and_pull_in_base(observations, state, prior);
    let shift = information.cholesky().map_or_else(Vec3::zeros, |factor| factor.solve(&pull));
    state.ball_in_base + shift
}

/// What observations say about the ball in the base on top of `prior`: their information (1/mm²), and what they pull with
/// (1/mm).
pub(super) fn information_and_pull_in_base<'a>(
    observations: impl Iterator<Item = &'a CentreObservation>,
    state: &State,
    prior: Mat3,
) -> (Mat3, Vec3) {
    let (mut information, mut pull) = (prior, Vec3::zeros());
    for observation in observations {
        let rotation = (observation.base_from_flange.rotation * state.flange_from_sensor.rotation).to_rotation_matrix();
        information += rotation.matrix() * observation.information * rotation.matrix().transpose();
        pull += rotation * observation.pull_at(state);
    }
    (information, pull)
}

/// For each station: how far its ball lies from the ball of the solution made without it, mm. `None` where that
/// solution does not exist.
#[must_use]
pub fn leave_one_out(reduced: &Reduced) -> Vec<Option<f64>> {
    minima_without_each(reduced)
        .into_iter()
        .enumerate()
        .map(|(left_out, minimum)| {
            let state = minimum?.state;
            Some((reduced.station_ball(left_out, &state) - state.ball_in_base).norm())
        })
        .collect()
}

/// The solutions made without each station in turn.
///
/// The sums of a station are taken from those of all, which gives the first step for nothing; one or two more settle it.
pub(super) fn minima_without_each(reduced: &Reduced) -> Vec<Option<Minimum>> {
    /// 1e-6 mm: far below what the error is shown to.
    const SETTLED: f64 = 1e-8;
    let num_stations = reduced.num_stations;
    if num_stations < MIN_STATIONS {
        return vec![None; num_stations];
    }
    let sums: Vec<Normal> = (0..num_stations).map(|station| reduced.sums_of_station(station, &reduced.state)).collect();
    (0..num_stations)
        .map(|left_out| {
            let mut normal = Normal::zero();
            for (_, station) in sums.iter().enumerate().filter(|(station, _)| *station != left_out) {
                normal += *station;
            }
            let sums_without = |state: &State| reduced.sums_with(state, |station| station != left_out);
            minimise_from(sums_without, reduced.state, normal, SETTLED).ok()
        })
        .collect()
}
