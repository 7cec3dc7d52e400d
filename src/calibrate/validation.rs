//! Leave-one-station-out: the error that the residual hides.

use crate::geometry::{Mat3, Vec3};
use crate::watch::{Cancelled, Watch};

use super::Solution;
use super::observation::{CentreObservation, State};
use super::solver::{Normal, minimise_from};

/// What one station means for the result.
#[derive(Clone, Debug, PartialEq)]
pub struct Influence {
    /// The caller's index of the station.
    pub station_idx: usize,
    /// The user's name for it.
    pub label: String,
    /// Residual of the station as a whole over what its noise and its pull on the result let one expect.
    pub studentised_residual: f64,
    /// Probability of so large a residual by chance, in this one station.
    pub p_value: f64,
    /// How far the workspace point moves when the station is left out, mm.
    pub moves_workspace_point_mm: f64,
}

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

/// Whether the residuals are normally distributed (Anderson and Darling's test on whitened residuals).
#[derive(Clone, Debug, PartialEq)]
pub struct Normality {
    /// Probability of such residuals by chance.
    pub p_value: f64,
    /// `[quantile of the normal distribution, residual over its σ]`, rising.
    pub quantiles: Vec<[f64; 2]>,
}

/// How much a solution can be relied on, beyond its residual and its σ.
#[derive(Clone, Debug, PartialEq)]
pub struct Validation {
    /// One entry a station used, in order.
    pub influence: Vec<Influence>,
    /// `None` with fewer than eight stations: a half needs four.
    pub split_half: Option<SplitHalf>,
    /// `None` with too few residuals.
    pub normality: Option<Normality>,
}

/// The spread of the result over stations drawn with replacement.
#[derive(Clone, Debug, PartialEq)]
pub struct Bootstrap {
    /// Distance of the workspace point from that of the result, one entry a draw, mm, rising.
    pub distances_mm: Vec<f64>,
    /// Their root mean square: to be held against `workspace_point_std_mm`, mm.
    pub std_mm: f64,
    /// 95 % of the draws are within this, mm.
    pub within_95_mm: f64,
    /// Draws without a solution.
    pub num_failed: usize,
}

/// Validates a solution; `None` with too few stations for any of it.
#[must_use]
pub fn validate(_solution: &Solution) -> Option<Validation> {
    None
}

/// Solves `num_draws` times with stations drawn with replacement. The same seed gives the same draws.
///
/// # Errors
/// [`Cancelled`] if `watch` says so.
pub fn bootstrap(
    _solution: &Solution,
    num_draws: usize,
    _seed: u64,
    watch: &mut dyn Watch,
) -> Result<Bootstrap, Cancelled> {
    watch.report(0, num_draws)?;
    Ok(Bootstrap { distances_mm: Vec::new(), std_mm: 0.0, within_95_mm: 0.0, num_failed: num_draws })
}

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
