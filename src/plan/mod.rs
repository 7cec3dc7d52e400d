//! Where to measure next: among the orientations that the robot may take, those that make the result better known most.

use thiserror::Error;

use crate::calibrate::{BallProblem, Mount, Solution};
use crate::geometry::{Base, Flange, Rigid, Transform, Vec3};

/// What the robot and the sensor allow. Angles are relative to the mean orientation of the session's stations, or to
/// looking straight down where there are none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Most tilt of the range axis, degrees.
    pub max_tilt_deg: f64,
    /// Most turn about the range axis, either way, degrees.
    pub max_spin_deg: f64,
    /// Least and greatest distance of the ball's centre along the range axis; `None`: as the stations had it, mm.
    pub standoff_mm: Option<[f64; 2]>,
    /// How far from the middle of the profile the ball's centre may be; `None`: as the stations had it, mm.
    pub half_width_mm: Option<f64>,
}

impl Default for Limits {
    fn default() -> Self {
        Self { max_tilt_deg: 30.0, max_spin_deg: 90.0, standoff_mm: None, half_width_mm: None }
    }
}

/// A station to be measured.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedStation {
    /// The pose of its first capture, as the controller takes it.
    pub base_from_flange: Transform<Base, Flange>,
    /// Tilt of the range axis from the reference orientation, degrees.
    pub tilt_deg: f64,
    /// Direction of the tilt, degrees from the reference orientation's x.
    pub azimuth_deg: f64,
    /// Turn about the range axis, degrees.
    pub spin_deg: f64,
    /// σ of the workspace point once this station and those before it are measured, mm; `None` while it cannot be found.
    pub workspace_point_std_mm: Option<f64>,
}

/// Stations to be measured, the most useful first.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// σ of the workspace point before, mm; `None` while it cannot be found.
    pub workspace_point_std_mm: Option<f64>,
    /// The stations.
    pub stations: Vec<PlannedStation>,
}

/// Why there is no plan.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum PlanRefusal {
    /// The limits exclude everything.
    #[error("no orientation lies within the limits; allow more tilt or spin")]
    NothingWithinLimits,
    /// The solution's information is not that of a calibration.
    #[error("the solution is too poor to plan from")]
    Undetermined,
}

/// A cell before anything is measured, roughly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoughCell {
    /// Where the sensor is mounted.
    pub mount: Mount,
    /// The sensor on the flange within 10° and 20 mm or so; in the base for [`Mount::Fixed`].
    pub flange_from_sensor: Rigid,
    /// The ball in the base; in the flange for [`Mount::Fixed`]. mm.
    pub ball_in_base_mm: Vec3,
    /// The ball's radius, mm.
    pub radius_mm: f64,
    /// The direction in the base from which the sensor looks at the ball in the middle of all stations.
    pub looks_along_in_base: Vec3,
}

/// The `num` stations that help a solution most, one after the other.
///
/// # Errors
/// [`PlanRefusal`].
pub fn next_stations(
    _problem: &BallProblem,
    _solution: &Solution,
    _limits: &Limits,
    _num: usize,
) -> Result<Plan, PlanRefusal> {
    Err(PlanRefusal::Undetermined)
}
