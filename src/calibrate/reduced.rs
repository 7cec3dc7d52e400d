//! What is left of the data once a method has settled: enough to solve again without some stations, or with others.

use crate::geometry::{Mat3, Vec3};

use super::SolveError;
use super::observation::{CentreObservation, State};
use super::solver::{Hessian, Minimum, Normal, minimise_sums};
use super::validation::station_ball;

/// The data at the minimum, each capture reduced to what it says about the ball's centre, pose noise integrated out.
#[derive(Clone, Debug, PartialEq)]
pub struct Reduced {
    /// By station; the station's index is its place in [`super::Solution::stations`].
    pub observations: Vec<CentreObservation>,
    /// Covariance (mm²) of the shift of the ball's centre in the sensor frame that all captures of a station share, one entry
    /// a station; empty if they share none.
    pub common_covariance: Vec<Mat3>,
    /// Number of stations.
    pub num_stations: usize,
    /// The unknowns at the minimum.
    pub state: State,
    /// The matrix of the normal equations there: the information about (rotation, translation; ball).
    pub hessian: Hessian,
    /// Information (1/mm²) about a station's ball in every direction besides what its observations say.
    pub prior_information: f64,
    /// By how much the covariance is larger than the inverse of the information; `None` if nothing is left over to judge by.
    pub variance_factor: Option<f64>,
}

/// The sums of observations ordered by station, with what is common to each station integrated out.
#[must_use]
pub fn sums_at(observations: &[CentreObservation], common_covariance: &[Mat3], state: &State) -> Normal {
    if common_covariance.is_empty() {
        return Normal::of(observations.iter(), state);
    }
    let mut sums = Normal::zero();
    for run in observations.chunk_by(|a, b| a.station == b.station) {
        sums += station_sums(run, common_covariance, state);
    }
    sums
}

/// The sums of one station's observations.
fn station_sums(run: &[CentreObservation], common_covariance: &[Mat3], state: &State) -> Normal {
    let sums = Normal::of(run.iter(), state);
    match run.first().and_then(|first| common_covariance.get(first.station)) {
        Some(covariance) => sums.with_common_shift(covariance),
        None => sums,
    }
}

impl Reduced {
    /// The observations of each station, in order.
    pub fn stations(&self) -> impl Iterator<Item = &[CentreObservation]> {
        self.observations.chunk_by(|a, b| a.station == b.station)
    }

    /// The sums of a station at a state, what is common to its captures integrated out.
    #[must_use]
    pub fn sums_of_station(&self, station: usize, state: &State) -> Normal {
        let start = self.observations.partition_point(|observation| observation.station < station);
        let end = self.observations.partition_point(|observation| observation.station <= station);
        station_sums(&self.observations[start..end], &self.common_covariance, state)
    }

    /// The sums of the stations that `is_used` names.
    #[must_use]
    pub fn sums_with(&self, state: &State, is_used: impl Fn(usize) -> bool) -> Normal {
        self.sums_with_times(state, |station| if is_used(station) { 1.0 } else { 0.0 })
    }

    fn sums_with_times(&self, state: &State, times: impl Fn(usize) -> f64) -> Normal {
        let mut sums = Normal::zero();
        for run in self.stations() {
            let times = times(run[0].station);
            if times > 0.0 {
                sums += station_sums(run, &self.common_covariance, state) * times;
            }
        }
        sums
    }

    /// Solves again with every station taken as often as `times` says, from this minimum.
    ///
    /// # Errors
    /// As [`minimise_sums`].
    pub fn solve_with_times(&self, times: impl Fn(usize) -> f64) -> Result<Minimum, SolveError> {
        minimise_sums(|state| self.sums_with_times(state, &times), self.state)
    }

    /// Solves again with the stations that `is_used` names, from this minimum.
    ///
    /// # Errors
    /// As [`minimise_sums`].
    pub fn solve_with(&self, is_used: impl Fn(usize) -> bool + Clone) -> Result<Minimum, SolveError> {
        self.solve_with_times(|station| if is_used(station) { 1.0 } else { 0.0 })
    }

    /// Where a station's own observations put the ball, in the base, for a given state, mm.
    #[must_use]
    pub fn station_ball(&self, station: usize, state: &State) -> Vec3 {
        let own = self.observations.iter().filter(|observation| observation.station == station);
        station_ball(own, state, self.prior_information)
    }
}
