//! What is left of the poses once the method has settled: enough to solve again without some stations.

use nalgebra::SVector;

use crate::calibrate::SolveError;
use crate::calibrate::plate::descent::{Sums, Unknowns, inverse_of};

use super::measured::MIN_POSES;
use super::pose::{Hessian, MotionState, NUM_UNKNOWNS, PosePair, sums_of};
use super::refine::minimise;

/// With fewer poses nothing is left over once one is taken away.
const MIN_TO_LEAVE_OUT: usize = MIN_POSES + 1;
/// A step shorter than this (rad, mm/100) needs no second one: what it leaves is its square.
const SHORT: f64 = 1e-3;

/// The poses at the minimum, with their weights.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionReduced {
    /// In the order of stations and captures.
    pub poses: Vec<PosePair>,
    /// Number of stations that they are of.
    pub num_stations: usize,
    /// The unknowns at the minimum.
    pub state: MotionState,
}

/// What solving again gave.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionRefit {
    /// The unknowns.
    pub state: MotionState,
    /// Their covariance.
    pub covariance: Hessian,
}

impl MotionReduced {
    /// Solves again with every station taken as often as `times` says, from this minimum.
    ///
    /// # Errors
    /// [`SolveError::TooFewStations`] or [`SolveError::Undetermined`] if what is left does not do.
    pub fn solve_with_times(&self, times: impl Fn(usize) -> f64 + Copy) -> Result<MotionRefit, SolveError> {
        let found = self.poses.iter().filter(|pose| times(pose.station) > 0.0).count();
        if found < MIN_POSES {
            return Err(SolveError::TooFewStations { found, needed: MIN_POSES, refusal: None });
        }
        let found = minimise(&self.poses, self.state, times)?;
        Ok(MotionRefit { state: found.unknowns, covariance: inverse_of(&found.sums.hessian)? })
    }

    /// The solutions made without each station in turn; `None` where what is left does not do.
    ///
    /// The sums of a station are taken from those of all. That gives the first step for nothing, and hardly ever is a second
    /// one needed.
    #[must_use]
    pub fn without_each(&self) -> Vec<Option<MotionRefit>> {
        if self.num_stations < MIN_TO_LEAVE_OUT {
            return vec![None; self.num_stations];
        }
        let all = sums_of(&self.poses, &self.state, |_| 1.0);
        (0..self.num_stations)
            .map(|left_out| {
                let own: Vec<PosePair> = self.poses.iter().filter(|pose| pose.station == left_out).copied().collect();
                let own = sums_of(&own, &self.state, |_| 1.0);
                let others = Sums::<NUM_UNKNOWNS> {
                    hessian: all.hessian - own.hessian,
                    gradient: all.gradient - own.gradient,
                    cost: all.cost - own.cost,
                };
                let covariance = inverse_of(&others.hessian).ok()?;
                let step: SVector<f64, NUM_UNKNOWNS> = covariance * others.gradient;
                if MotionState::size(&step) < SHORT {
                    return Some(MotionRefit { state: self.state.stepped(&step), covariance });
                }
                self.solve_with_times(|station| if station == left_out { 0.0 } else { 1.0 }).ok()
            })
            .collect()
    }

    /// How far the poses of a station put the target from its place, mm: root mean square.
    #[must_use]
    pub fn off_mm(&self, station: usize, state: &MotionState) -> f64 {
        let own = self.poses.iter().filter(|pose| pose.station == station);
        crate::geometry::stats::rms(own.map(|pose| state.errors(pose).translation.norm()))
    }
}
