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

use nalgebra::Matrix6;

use crate::geometry::{Rigid, Vec3};

use super::solver::{covariance_for_unit_noise, sensor_block};
use super::{MotionData, MotionReduced, PlateReduced, Reduced, Solution, TrackReduced, motion, plate};

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
        normality: normality::normality(solution),
    })
}

/// The workspace point in the flange for a calibration, mm.
fn workspace_point(flange_from_sensor: &Rigid, reference_point_in_sensor_mm: Vec3) -> Vec3 {
    flange_from_sensor.transform_point(&reference_point_in_sensor_mm.into()).coords
}

/// What can be solved again with other stations, whatever the target is.
#[derive(Clone, Copy)]
enum Data<'a> {
    Points(&'a Reduced),
    Plate(&'a PlateReduced),
    Motion(&'a MotionReduced),
    Track(&'a TrackReduced),
}

/// A calibration from some of the stations, and the covariance of (rotation, translation), a right perturbation along the
/// sensor's axes.
struct Again {
    flange_from_sensor: Rigid,
    covariance: Matrix6<f64>,
}

impl<'a> Data<'a> {
    fn of(solution: &'a Solution) -> Option<Self> {
        let of_plate = || solution.plate.as_ref().map(|plate| Self::Plate(&plate.reduced));
        let of_motion = || {
            solution.motion.as_ref().map(|motion| match &motion.data {
                MotionData::Poses(reduced) => Self::Motion(reduced),
                MotionData::Track(reduced) => Self::Track(reduced),
            })
        };
        solution.reduced.as_ref().map(Self::Points).or_else(of_plate).or_else(of_motion)
    }

    const fn num_stations(self) -> usize {
        match self {
            Self::Points(reduced) => reduced.num_stations,
            Self::Plate(reduced) => reduced.num_stations,
            Self::Motion(reduced) => reduced.num_stations,
            Self::Track(reduced) => reduced.num_stretches(),
        }
    }

    /// `None` if what is left does not do.
    fn solve_with_times(self, times: impl Fn(usize) -> f64 + Copy) -> Option<Again> {
        match self {
            Self::Points(reduced) => {
                let minimum = reduced.solve_with_times(times).ok().filter(|minimum| minimum.converged)?;
                let covariance = covariance_for_unit_noise(&minimum.hessian).ok()? * reduced.variance_factor?;
                Some(Again {
                    flange_from_sensor: minimum.state.flange_from_sensor,
                    covariance: sensor_block(&covariance),
                })
            }
            Self::Plate(reduced) => {
                let refit = reduced.solve_with_times(times).ok()?;
                Some(Again {
                    flange_from_sensor: refit.state.flange_from_sensor,
                    covariance: plate::points::sensor_block(&refit.covariance),
                })
            }
            Self::Motion(reduced) => {
                let refit = reduced.solve_with_times(times).ok()?;
                Some(Again {
                    flange_from_sensor: refit.state.flange_from_sensor,
                    covariance: motion::pose::sensor_block(&refit.covariance),
                })
            }
            Self::Track(reduced) => {
                let refit = reduced.solve_with_times(times).ok()?;
                Some(Again { flange_from_sensor: refit.flange_from_sensor, covariance: refit.covariance })
            }
        }
    }
}
