//! What is left of a track once the method has settled: enough to solve again without some of its stretches.
//!
//! A stretch is a run of steps, one after the other; it stands where other targets have a station.

use std::ops::Range;

use nalgebra::{Matrix6, Vector6};

use crate::calibrate::plate::descent::{Sums, Unknowns, inverse_of};
use crate::calibrate::{Mount, SolveError};
use crate::geometry::{Rigid, se3, stats};

use super::steps::{SensorState, Track, TrackNoise, TrackPose, sums_of_rows};

/// More stretches than this tell little more, and a table of them is not read.
const MOST_STRETCHES: usize = 12;
/// Steps that a stretch has at least.
const MIN_STEPS: usize = 3;
/// With fewer stretches nothing is left over once one is taken away.
const MIN_TO_LEAVE_OUT: usize = 4;
/// A step shorter than this (rad, mm/100) needs no second one: what it leaves is its square.
const SHORT: f64 = 1e-3;

/// The track at the minimum, with its weights.
#[derive(Clone, Debug, PartialEq)]
pub struct TrackReduced {
    /// The poses; a step leads to each but the first.
    pub poses: Vec<TrackPose>,
    /// What the steps are weighed by.
    pub noise: TrackNoise,
    /// Where the camera is.
    pub mount: Mount,
    /// X at the minimum.
    pub flange_from_sensor: Rigid,
    /// The first step of each stretch, rising from 0.
    pub starts: Vec<usize>,
}

/// What solving again gave.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackRefit {
    /// X.
    pub flange_from_sensor: Rigid,
    /// Its covariance: (rotation, translation), a right perturbation along the sensor's axes.
    pub covariance: Matrix6<f64>,
}

impl TrackReduced {
    /// Cuts the track into stretches of about as many steps that are believed.
    pub(super) fn new(poses: Vec<TrackPose>, noise: TrackNoise, mount: Mount, flange_from_sensor: Rigid) -> Self {
        let believed: Vec<usize> =
            (1..poses.len()).filter(|place| poses[*place].is_believed).map(|place| place - 1).collect();
        let num_stretches = (believed.len() / MIN_STEPS).clamp(1, MOST_STRETCHES);
        let mut starts: Vec<usize> =
            (0..num_stretches).filter_map(|idx| believed.get(idx * believed.len() / num_stretches)).copied().collect();
        // Lost steps before the first that is believed belong to the first stretch.
        if let Some(first) = starts.first_mut() {
            *first = 0;
        } else {
            starts.push(0);
        }
        Self { poses, noise, mount, flange_from_sensor, starts }
    }

    /// Number of stretches.
    #[must_use]
    pub const fn num_stretches(&self) -> usize {
        self.starts.len()
    }

    /// The stretch that a step is in.
    #[must_use]
    pub fn stretch_of_step(&self, step: usize) -> usize {
        self.starts.partition_point(|start| *start <= step) - 1
    }

    /// When a stretch began and ended, in seconds from the first pose.
    #[must_use]
    pub fn label(&self, stretch: usize) -> String {
        let Range { start, end } = self.steps(stretch);
        let [start_s, end_s] = [start, end].map(|pose| self.poses[pose].time_s - self.poses[0].time_s);
        format!("{start_s:.1}–{end_s:.1} s")
    }

    /// Solves again with every stretch taken as often as `times` says, from this minimum.
    ///
    /// What the steps at a cut have in common, the robot's noise at the pose between them, is not given up: the later one is
    /// judged given the one before, whether that is taken or not. Stretches taken once each give the solution itself.
    ///
    /// # Errors
    /// [`SolveError::Diverged`] or [`SolveError::Undetermined`] if what is left does not do.
    pub fn solve_with_times(&self, times: impl Fn(usize) -> f64 + Copy) -> Result<TrackRefit, SolveError> {
        let found = self.track().minimise(self.flange_from_sensor, |step| times(self.stretch_of_step(step)))?;
        Ok(TrackRefit { flange_from_sensor: found.unknowns.0, covariance: inverse_of(&found.sums.hessian)? })
    }

    /// The solutions made without each stretch in turn; `None` where what is left does not do.
    #[must_use]
    pub fn without_each(&self) -> Vec<Option<TrackRefit>> {
        if self.num_stretches() < MIN_TO_LEAVE_OUT {
            return vec![None; self.num_stretches()];
        }
        let Some(rows) = self.track().rows(&self.flange_from_sensor) else { return vec![None; self.num_stretches()] };
        let all = sums_of_rows(rows.iter().map(|rows| (rows, 1.0)));
        (0..self.num_stretches())
            .map(|left_out| {
                let own = sums_of_rows(rows[self.steps(left_out)].iter().map(|rows| (rows, 1.0)));
                let covariance = inverse_of(&(all.hessian - own.hessian)).ok()?;
                let step: Vector6<f64> = covariance * (all.gradient - own.gradient);
                if SensorState::size(&step) < SHORT {
                    let flange_from_sensor = self.flange_from_sensor * se3::exp(&step);
                    return Some(TrackRefit { flange_from_sensor, covariance });
                }
                self.solve_with_times(|stretch| if stretch == left_out { 0.0 } else { 1.0 }).ok()
            })
            .collect()
    }

    /// The sums of a stretch's steps for a given X.
    #[must_use]
    pub fn sums_of_stretch(&self, stretch: usize, flange_from_sensor: &Rigid) -> Sums<6> {
        let steps = self.steps(stretch);
        self.track().sums(flange_from_sensor, |step| if steps.contains(&step) { 1.0 } else { 0.0 })
    }

    /// How many of a stretch's steps are believed.
    #[must_use]
    pub fn num_believed(&self, stretch: usize) -> usize {
        self.poses[1..][self.steps(stretch)].iter().filter(|here| here.is_believed).count()
    }

    /// What the steps of a stretch are off by with a given X, mm: root mean square, over those that are believed, of the distance
    /// between where the flange's step leads the camera to and where the camera says that it went.
    #[must_use]
    pub fn off_mm(&self, stretch: usize, flange_from_sensor: &Rigid) -> f64 {
        let steps = self.steps(stretch);
        let poses = &self.poses[steps.start..=steps.end];
        let squares = Track { poses, ..self.track() }.squares(flange_from_sensor);
        let believed = squares.iter().zip(&poses[1..]).filter(|(_, here)| here.is_believed);
        stats::rms(believed.map(|((_, error), _)| error.fixed_rows::<3>(3).norm()))
    }

    /// The errors of all steps that are believed, each over its σ, in six directions.
    #[must_use]
    pub fn whitened_errors(&self) -> Vec<f64> {
        let rows = self.track().rows(&self.flange_from_sensor).unwrap_or_default();
        let believed = rows.iter().zip(&self.poses[1..]).filter(|(_, here)| here.is_believed);
        believed.flat_map(|(rows, _)| rows.column(6).iter().copied().collect::<Vec<f64>>()).collect()
    }

    /// The steps of a stretch; step 0 leads from the first pose to the second.
    fn steps(&self, stretch: usize) -> Range<usize> {
        self.starts[stretch]..self.starts.get(stretch + 1).copied().unwrap_or(self.poses.len() - 1)
    }

    fn track(&self) -> Track<'_> {
        Track { poses: &self.poses, noise: self.noise, mount: self.mount }
    }
}
