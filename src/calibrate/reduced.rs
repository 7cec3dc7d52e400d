//! What is left of the data once a method has settled: enough to solve again without some stations, or with others.

use super::SolveError;
use super::observation::{CentreObservation, State};
use super::solver::{Hessian, Minimum, minimise};
use super::validation::station_ball;

/// The data at the minimum, each capture reduced to what it says about the ball's centre, pose noise integrated out.
#[derive(Clone, Debug, PartialEq)]
pub struct Reduced {
    /// By station; the station's index is its place in [`super::Solution::stations`].
    pub observations: Vec<CentreObservation>,
    /// Number of stations.
    pub num_stations: usize,
    /// The unknowns at the minimum.
    pub state: State,
    /// The matrix of the normal equations there: the information about (rotation, translation; ball).
    pub hessian: Hessian,
    /// Information (1/mm²) about a station's ball in every direction besides what its observations say.
    pub prior_information: f64,
    /// By how much the covariance is larger than the inverse of the information.
    pub variance_factor: Option<f64>,
}

impl Reduced {
    /// Solves again with the stations that `is_used` names, from this minimum.
    ///
    /// # Errors
    /// As [`minimise`].
    pub fn solve_with(&self, is_used: impl Fn(usize) -> bool + Clone) -> Result<Minimum, SolveError> {
        let used = self.observations.iter().filter(move |observation| is_used(observation.station));
        minimise(&used, self.state)
    }

    /// Where a station's own observations put the ball, in the base, for a given state, mm.
    #[must_use]
    pub fn station_ball(&self, station: usize, state: &State) -> crate::geometry::Vec3 {
        let own = self.observations.iter().filter(|observation| observation.station == station);
        station_ball(own, state, self.prior_information)
    }
}
