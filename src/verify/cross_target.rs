//! Any calibration on any target's data: what it makes of a ball, a tip, or a plate that it was not computed from.

use thiserror::Error;

use crate::calibrate::{BallProblem, Edge, PlateProblem, Problem, Station};
use crate::geometry::{Flange, Sensor, Transform, Vec3, stats};

use super::ball_centre::{Sighting, common_centre, sightings, station_centre};
use super::distances::distances;
use super::{Distances, Figures, Measurement, Stability};

/// Why a calibration says nothing about a target.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
pub enum NotEvaluated {
    /// Two stations contradict each other at least.
    #[error("found {found} usable stations, needed {needed}; enable or capture more of this target")]
    TooFewStations {
        /// Stations with something to be seen.
        found: usize,
        /// Stations needed.
        needed: usize,
    },
    /// A line through two points fits whatever they are.
    #[error("found {found} points on edge {}, needed {needed}; enable or capture more stations there", edge_name(*edge))]
    TooFewOnEdge {
        /// The edge.
        edge: Edge,
        /// Its points.
        found: usize,
        /// Points needed.
        needed: usize,
    },
}

const fn edge_name(edge: Edge) -> &'static str {
    match edge {
        Edge::P => "p",
        Edge::Q => "q",
    }
}

/// How far a station is off what the target's other data say.
#[derive(Clone, Debug, PartialEq)]
pub struct StationError {
    /// The caller's index.
    pub station_idx: usize,
    /// The user's name for it.
    pub label: String,
    /// Root mean square over its points where it has several, mm.
    pub error_mm: f64,
}

/// What the target looks like through the calibration.
#[derive(Clone, Debug, PartialEq)]
pub enum Seen {
    /// A ball's centre or a tip: one place, measured many times.
    Place {
        /// Where the data of all stations put it, in the base, mm.
        common_mm: Vec3,
        /// Where each station puts it, or each capture of a tip.
        measurements: Vec<Measurement>,
        /// Against the touched point or the mean; `None` with a single measurement.
        stability: Option<Stability>,
    },
    /// A plate's edges.
    Plate(Box<Distances>),
}

/// A calibration on a target's data.
#[derive(Clone, Debug, PartialEq)]
pub struct Evaluation {
    /// Distances of stations' balls or tips from the common one, or of points from their edges.
    pub figures: Figures,
    /// One entry a station that was seen.
    pub stations: Vec<StationError>,
    /// The picture behind the figures.
    pub seen: Seen,
}

impl Evaluation {
    /// The distances behind a plate's figures.
    #[must_use]
    pub fn distances(&self) -> Option<&Distances> {
        match &self.seen {
            Seen::Plate(distances) => Some(distances),
            Seen::Place { .. } => None,
        }
    }

    /// The repeated measurements of a ball's centre or a tip, and what they are held against.
    #[must_use]
    pub fn stability(&self) -> Option<(&[Measurement], &Stability)> {
        match &self.seen {
            Seen::Place { measurements, stability, .. } => Some((measurements, stability.as_ref()?)),
            Seen::Plate(_) => None,
        }
    }
}

/// Evaluates a calibration on a target. `touched_mm` is where the ball's centre or the tip is known to be, in the base.
///
/// # Errors
/// [`NotEvaluated`] if there are too few data to contradict anything.
pub fn evaluate(
    problem: &Problem,
    flange_from_sensor: &Transform<Flange, Sensor>,
    touched_mm: Option<Vec3>,
) -> Result<Evaluation, NotEvaluated> {
    match problem {
        Problem::Ball(ball) => on_ball(ball, flange_from_sensor, touched_mm),
        Problem::Point(point) => on_tip(&point.stations, flange_from_sensor, touched_mm),
        Problem::Motion(motion) => on_tip(&motion.stations, flange_from_sensor, touched_mm),
        Problem::Streams(streams) => on_tip(&streams.stations(), flange_from_sensor, touched_mm),
        Problem::Plate(plate) => on_plate(plate, flange_from_sensor),
    }
}

/// Stations without which nothing is contradicted.
const LEAST_STATIONS: usize = 2;

fn enough_stations(found: usize) -> Result<(), NotEvaluated> {
    if found < LEAST_STATIONS {
        return Err(NotEvaluated::TooFewStations { found, needed: LEAST_STATIONS });
    }
    Ok(())
}

fn on_ball(
    problem: &BallProblem,
    flange_from_sensor: &Transform<Flange, Sensor>,
    touched_mm: Option<Vec3>,
) -> Result<Evaluation, NotEvaluated> {
    let seen = problem.stations.iter().map(|station| (station, sightings(station, flange_from_sensor)));
    let seen: Vec<_> = seen.filter(|(_, sightings)| !sightings.is_empty()).collect();
    enough_stations(seen.len())?;
    let all: Vec<Sighting> = seen.iter().flat_map(|(_, sightings)| sightings.iter().copied()).collect();
    let common_mm = common_centre(&all, problem.radius_mm)
        .ok_or(NotEvaluated::TooFewStations { found: 0, needed: LEAST_STATIONS })?;
    let measurements: Vec<Measurement> = seen
        .iter()
        .map(|(station, sightings)| Measurement {
            station_idx: station.idx,
            label: station.label.clone(),
            capture_idx: None,
            point_in_base_mm: station_centre(sightings, problem.radius_mm, common_mm),
        })
        .collect();
    Ok(of_place(common_mm, measurements, touched_mm))
}

fn on_tip(
    stations: &[Station],
    flange_from_sensor: &Transform<Flange, Sensor>,
    touched_mm: Option<Vec3>,
) -> Result<Evaluation, NotEvaluated> {
    let mut measurements = Vec::new();
    for station in stations {
        let has_several = station.captures.len() > 1;
        for (capture_idx, capture) in station.captures.iter().enumerate() {
            let Some(tip_in_sensor) = capture.reading.point_in_sensor_mm() else { continue };
            measurements.push(Measurement {
                station_idx: station.idx,
                label: station.label.clone(),
                capture_idx: has_several.then_some(capture_idx),
                point_in_base_mm: (capture.base_from_flange * *flange_from_sensor).map_point(tip_in_sensor),
            });
        }
    }
    enough_stations(measurements.chunk_by(|a, b| a.station_idx == b.station_idx).count())?;
    #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 captures")]
    let count = measurements.len() as f64;
    let common_mm = measurements.iter().map(|measured| measured.point_in_base_mm).sum::<Vec3>() / count;
    Ok(of_place(common_mm, measurements, touched_mm))
}

fn of_place(common_mm: Vec3, measurements: Vec<Measurement>, touched_mm: Option<Vec3>) -> Evaluation {
    let off = |measured: &Measurement| (measured.point_in_base_mm - common_mm).norm();
    let distances: Vec<f64> = measurements.iter().map(off).collect();
    let labelled = measurements.iter().map(|measured| (measured.station_idx, measured.label.as_str()));
    Evaluation {
        figures: Figures::of(&distances),
        stations: by_station(labelled.zip(distances.iter().copied())),
        seen: Seen::Place { common_mm, stability: Stability::of(&measurements, touched_mm), measurements },
    }
}

fn on_plate(
    problem: &PlateProblem,
    flange_from_sensor: &Transform<Flange, Sensor>,
) -> Result<Evaluation, NotEvaluated> {
    let found = distances(problem, flange_from_sensor)?;
    let labelled = found.points.iter().map(|point| ((point.station_idx, point.label.as_str()), point.to_line_mm));
    Ok(Evaluation { figures: found.to_line, stations: by_station(labelled), seen: Seen::Plate(Box::new(found)) })
}

/// The root mean square of each run of distances of one station.
fn by_station<'a>(distances: impl Iterator<Item = ((usize, &'a str), f64)>) -> Vec<StationError> {
    let distances: Vec<_> = distances.collect();
    distances
        .chunk_by(|(a, _), (b, _)| a.0 == b.0)
        .map(|run| StationError {
            station_idx: run[0].0.0,
            label: run[0].0.1.to_owned(),
            error_mm: stats::rms(run.iter().map(|(_, distance)| *distance)),
        })
        .collect()
}
