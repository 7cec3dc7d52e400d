//! How far a solution can be relied on: stations left out, halves against each other, stations drawn anew, and whether the
//! residuals are those of noise. The residual alone says little.

mod bootstrap;
mod influence;
mod leave_one_out;
mod normality;
mod split_half;

pub use bootstrap::{Bootstrap, bootstrap};
pub use influence::Influence;
pub use leave_one_out::{MIN_STATIONS, leave_one_out, station_ball};
pub use normality::Normality;
pub use split_half::SplitHalf;

use crate::geometry::Vec3;

use super::Solution;
use super::observation::State;

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

/// Validates a solution; `None` with too few stations for any of it.
#[must_use]
pub fn validate(solution: &Solution) -> Option<Validation> {
    Some(Validation {
        influence: influence::influence(solution)?,
        split_half: split_half::split_half(solution),
        normality: normality::normality(solution.reduced.as_ref()?),
    })
}

/// The workspace point in the flange for some unknowns, mm.
fn workspace_point(state: &State, reference_point_in_sensor_mm: Vec3) -> Vec3 {
    state.flange_from_sensor.transform_point(&reference_point_in_sensor_mm.into()).coords
}
