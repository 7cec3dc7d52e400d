//! Where to measure next: among the orientations that the robot may take, those that make the result better known most.
//!
//! Every station adds its information about the nine unknowns; how much follows from its orientation, from where the ball
//! is in the profile, and from what a station of this kind says about the ball. So the effect of a station is known before
//! it is measured. Stations are chosen one after the other, each for the least σ of the workspace point.
//!
//! A session with a solution is planned from it ([`next_stations`]); an empty one as a whole from a guess ([`from_nothing`]),
//! where the operator brings the ball into view at every station; a live cell station by station from a guess and what was
//! measured since ([`next_rough`]), such that the ball stays in view by itself.
//!
//! As everywhere in [`crate::calibrate`], poses are inverted inside for [`Mount::Fixed`], and inverted back at the end.

mod information;
mod nominal;
mod orientation;
mod rough;
mod search;
mod sight;
mod typical;

use thiserror::Error;

use crate::calibrate::ball::MIN_STATIONS;
use crate::calibrate::{BallProblem, Mount, Noise, Solution};
use crate::geometry::{Base, Flange, Rigid, Transform, Vec3};

pub use rough::{MeasuredStation, View, next_rough, refined};

use information::Information;
use orientation::Orientations;
use search::{Cell, Search};

/// What the robot and the sensor allow. Angles are relative to the mean orientation of the session's stations, or to
/// looking along the given direction where there are none.
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
    #[error("nothing lies within the limits; allow more tilt or spin, a wider range of stand-off, or more width")]
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
    /// The sensor on the flange within 10° and 20 mm or so; in the base for [`Mount::Fixed`]. Its z points away from the
    /// sensor.
    pub flange_from_sensor: Rigid,
    /// The ball in the base; in the flange for [`Mount::Fixed`]. mm.
    pub target_in_base_mm: Vec3,
    /// The ball's radius, mm.
    pub radius_mm: f64,
    /// The robot's noise as far as it is stated; that of a good arm otherwise.
    pub noise: Noise,
    /// The direction in the base along which the sensor looks at the ball in the middle of all stations; in the flange for
    /// [`Mount::Fixed`].
    pub looks_along_in_base: Vec3,
}

/// The `num` stations that help a solution most, one after the other.
///
/// # Errors
/// [`PlanRefusal`].
pub fn next_stations(
    problem: &BallProblem,
    solution: &Solution,
    limits: &Limits,
    num: usize,
) -> Result<Plan, PlanRefusal> {
    let reduced = solution.reduced.as_ref().ok_or(PlanRefusal::Undetermined)?;
    let orientations = Orientations::about_mean_of(reduced, limits)?;
    let reference_point = solution
        .uncertainty
        .as_ref()
        .map_or_else(|| typical::middle_of_balls(solution), |known| known.reference_point_in_sensor_mm);
    let cell = Cell { mount: problem.mount, state: reduced.state, models: typical::models(reduced, limits)? };
    let known = Information::new(&reduced.hessian, reference_point);
    let before = known.point_std().ok_or(PlanRefusal::Undetermined)?;
    let mut search = Search::new(cell, orientations, &known, typical::orientations(reduced));
    // The stated σ knows more about the noise than the information does, so the information gives the ratio only.
    let stated = solution.uncertainty.as_ref().map(|known| known.workspace_point_std_mm);
    let stations = (0..num)
        .map(|_| {
            search
                .next(|information| stated.zip(information.point_std()).map(|(stated, after)| stated * after / before))
                .ok_or(PlanRefusal::NothingWithinLimits)
        })
        .collect::<Result<_, _>>()?;
    Ok(Plan { workspace_point_std_mm: stated, stations })
}

/// `num` stations for a cell in which nothing is measured yet. The first one looks along the given direction; the rest are
/// chosen as in [`next_stations`], for sweeps across the ball with a sensor and a robot of usual noise.
///
/// # Errors
/// [`PlanRefusal`].
pub fn from_nothing(cell: &RoughCell, limits: &Limits, num: usize) -> Result<Plan, PlanRefusal> {
    let nominal = nominal::Nominal::new(cell, limits)?;
    let orientations = Orientations::new(nominal.reference, limits)?;
    let prior = Information::new(&nominal::prior(), nominal.reference_point_in_sensor);
    let mut search = Search::new(nominal.cell, orientations, &prior, Vec::new());
    let mut stations = Vec::with_capacity(num);
    for idx in 0..num {
        let point_std = |information: &Information| {
            // What is known of the mounting by guess is no measurement.
            (idx + 1 >= MIN_STATIONS).then(|| information.without(&nominal::prior()).point_std()).flatten()
        };
        let station = if idx == 0 { Some(search.reference(point_std)) } else { search.next(point_std) };
        stations.push(station.ok_or(PlanRefusal::NothingWithinLimits)?);
    }
    Ok(Plan { workspace_point_std_mm: None, stations })
}
