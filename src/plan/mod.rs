//! Where to measure next: among the orientations that the robot may take, those that make the result better known most.
//!
//! Every station adds its information about the unknowns: nine with a ball or a tip (the sensor and the centre), twelve with
//! a plate (the sensor and the plate). How much follows from its orientation, from where the target is in the profile, and
//! from what a station of this kind says about it. So the effect of a station is known before it is measured. Stations are
//! chosen one after the other, each for the least σ of the workspace point; at a plate also which edge, and where along it.
//!
//! A session with a solution is planned from it ([`next_stations`]); an empty one as a whole from a guess ([`from_nothing`]),
//! where the operator brings the ball into view at every station; a live cell station by station from a guess and what was
//! measured since ([`next_rough`], [`next_rough_edge`]), such that the target stays in view by itself.
//!
//! What stations are planned at is a `search::Subject`: a ball (`ball`) or a plate's edges (`plate`).
//!
//! As everywhere in [`crate::calibrate`], poses are inverted inside for [`Mount::Fixed`], and inverted back at the end.

mod ball;
mod information;
mod nominal;
mod orientation;
mod plate;
mod rough;
mod rough_plate;
mod search;
mod sight;

use thiserror::Error;

use crate::calibrate::ball::MIN_STATIONS;
use crate::calibrate::observation::{CentreObservation, NUM_UNKNOWNS};
use crate::calibrate::{Edge, Mount, Noise, PlateFound, Reduced, Solution};
use crate::geometry::{Base, Flange, Rigid, Transform, Vec3};

pub use rough::{MeasuredStation, View, next_rough, refined};
pub use rough_plate::{RoughPlate, SeenEdge, next_rough_edge, refined_plate};

use ball::Ball;
use information::Information;
use nominal::Nominal;
use orientation::Orientations;
use plate::Plate;
use search::{Search, Subject};

/// What the robot and the sensor allow. Angles are relative to the mean orientation of the session's stations, or to
/// looking along the given direction where there are none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Most tilt of the range axis, degrees.
    pub max_tilt_deg: f64,
    /// Most turn about the range axis, either way, degrees.
    pub max_spin_deg: f64,
    /// Least and greatest distance of the ball's centre, tip or edge along the range axis; `None`: as the stations had it,
    /// mm.
    pub standoff_mm: Option<[f64; 2]>,
    /// How far from the middle of the profile it may be; `None`: as the stations had it, mm.
    pub half_width_mm: Option<f64>,
    /// How far a plate's edges are taken to go on beyond where they were crossed, mm.
    pub beyond_mm: f64,
    /// The edge of a plate that stations are wanted on; `None`: either.
    pub only_edge: Option<Edge>,
}

impl Limits {
    fn allows(&self, edge: Edge) -> bool {
        self.only_edge.is_none_or(|only| only == edge)
    }
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            max_tilt_deg: 30.0,
            max_spin_deg: 90.0,
            standoff_mm: None,
            half_width_mm: None,
            beyond_mm: 0.0,
            only_edge: None,
        }
    }
}

/// A station to be measured.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedStation {
    /// The pose of its first capture, as the controller takes it.
    pub base_from_flange: Transform<Base, Flange>,
    /// The edge that the line is to cross, of a plate.
    pub edge: Option<Edge>,
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
    /// Nothing is planned for targets whose whole pose is seen: any turn shows all of it.
    #[error(
        "stations are planned for balls, tips and plates; with a board or a sequence, turn the flange by 20° to 60° about \
         at least two axes"
    )]
    AnyTurnHelps,
    /// The solution's information is not that of a calibration.
    #[error("the solution is too poor to plan from")]
    Undetermined,
    /// Too little of a plate was seen.
    #[error(
        "where the plate lies is not known yet; bring the line across one edge at two places and across the other at one"
    )]
    PlateUnseen,
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
    /// The ball's radius, mm; 0 of a tip.
    pub radius_mm: f64,
    /// The robot's noise as far as it is stated; that of a good arm otherwise.
    pub noise: Noise,
    /// The direction in the base along which the sensor looks at the ball in the middle of all stations; in the flange for
    /// [`Mount::Fixed`].
    pub looks_along_in_base: Vec3,
}

/// The `num` stations that help a solution most, one after the other; of a plate's the edge is said as well.
///
/// Angles are relative to the mean orientation of the stations; of a plate to that of the stations at the same edge.
///
/// # Errors
/// [`PlanRefusal`].
pub fn next_stations(solution: &Solution, limits: &Limits, num: usize) -> Result<Plan, PlanRefusal> {
    match (&solution.plate, &solution.reduced) {
        (Some(found), _) => next_at_plate(solution, found, limits, num),
        (None, Some(reduced)) => next_at_ball(solution, reduced, limits, num),
        (None, None) if solution.motion.is_some() => Err(PlanRefusal::AnyTurnHelps),
        (None, None) => Err(PlanRefusal::Undetermined),
    }
}

fn next_at_ball(solution: &Solution, reduced: &Reduced, limits: &Limits, num: usize) -> Result<Plan, PlanRefusal> {
    let mounting = reduced.state.flange_from_sensor;
    let base_from_sensor = |seen: &CentreObservation| seen.base_from_flange.rotation * mounting.rotation;
    let ball = Ball {
        state: reduced.state,
        orientations: Orientations::about_mean_of(reduced.observations.iter().map(base_from_sensor), limits)?,
        models: ball::models(reduced, limits)?,
        sight: None,
    };
    let known = Information::new(&reduced.hessian, reference_point(solution, || ball::middle_of_balls(solution)));
    let search = Search::new(solution.mount, mounting, ball, known, ball::taken(reduced));
    planned_from(solution, &known, search, num)
}

fn next_at_plate(solution: &Solution, found: &PlateFound, limits: &Limits, num: usize) -> Result<Plan, PlanRefusal> {
    let reduced = &found.reduced;
    let plate = Plate::of(reduced, solution, limits)?;
    let known =
        Information::new(&plate::information(reduced), reference_point(solution, || plate::middle_of_points(reduced)));
    let mounting = reduced.state.flange_from_sensor;
    let search = Search::new(solution.mount, mounting, plate, known, plate::taken(reduced));
    planned_from(solution, &known, search, num)
}

fn reference_point(solution: &Solution, otherwise: impl FnOnce() -> Vec3) -> Vec3 {
    solution.uncertainty.as_ref().map_or_else(otherwise, |known| known.reference_point_in_sensor_mm)
}

fn planned_from<S: Subject<N>, const N: usize>(
    solution: &Solution,
    known: &Information<N>,
    mut search: Search<S, N>,
    num: usize,
) -> Result<Plan, PlanRefusal> {
    let before = known.point_std().ok_or(PlanRefusal::Undetermined)?;
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
    let Nominal { ball, reference_point_in_sensor } = Nominal::new(cell, limits)?;
    let prior = Information::new(&nominal::prior(), reference_point_in_sensor);
    let mut search = Search::new(cell.mount, cell.flange_from_sensor, ball, prior, Vec::new());
    let mut stations = Vec::with_capacity(num);
    for idx in 0..num {
        let point_std = |information: &Information<NUM_UNKNOWNS>| {
            // What is known of the mounting by guess is no measurement.
            (idx + 1 >= MIN_STATIONS).then(|| information.without(&nominal::prior()).point_std()).flatten()
        };
        let station = if idx == 0 { search.reference(point_std) } else { search.next(point_std) };
        stations.push(station.ok_or(PlanRefusal::NothingWithinLimits)?);
    }
    Ok(Plan { workspace_point_std_mm: None, stations })
}
