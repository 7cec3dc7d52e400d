//! The points that a plate's stations hold.

use nalgebra::Matrix2;

use crate::calibrate::rotation_start::PoseGeometry;
use crate::calibrate::{Capture, Edge, PlateProblem, PlateStation, Reading, SolveError};
use crate::fit::{EdgeFit, Feature};
use crate::geometry::{Rigid, Vec3};

use super::points::EdgePoint;

/// With three points an edge the unknowns are just as many as the equations.
pub const MIN_POINTS: usize = 3;

/// A point with where it is from: the mean of what a station read at one pose.
#[derive(Clone, Debug)]
pub(super) struct Measured<'a> {
    pub station: &'a PlateStation,
    /// The captures that it was read in, with what each read, in the sensor frame, mm.
    pub captures: Vec<(usize, Vec3)>,
    /// Its information is still that of a unit weight.
    pub point: EdgePoint,
    /// Covariance of (x, z) by its profiles, mm².
    pub covariance_mm2: Option<Matrix2<f64>>,
    /// How many readings it is the mean of; copies are one.
    pub num_readings: f64,
    /// How many points were taken at its pose.
    pub num_at_pose: f64,
}

/// All points that can be used, and what the poses say by themselves.
///
/// # Errors
/// [`SolveError::TooFewEdgePoints`], and those of [`PoseGeometry::new`].
pub(super) fn measured(problem: &PlateProblem) -> Result<(Vec<Measured<'_>>, PoseGeometry), SolveError> {
    let mut points: Vec<Measured<'_>> = Vec::new();
    let mut num_stations = 0;
    for station in &problem.stations {
        let read: Vec<Read> = station.station.captures.iter().enumerate().filter_map(Read::of).collect();
        let mut poses: Vec<Rigid> = Vec::new();
        for pose in read.iter().map(|read| read.base_from_flange) {
            if !poses.contains(&pose) {
                poses.push(pose);
            }
        }
        let before = points.len();
        for pose in poses {
            let here: Vec<&Read> = read.iter().filter(|read| read.base_from_flange == pose).collect();
            let found = merged(station, num_stations, &here);
            if !points.iter().any(|other| is_copy(other, &found)) {
                points.push(found);
            }
        }
        num_stations += usize::from(points.len() > before);
    }
    let count = |edge: Edge| points.iter().filter(|measured| measured.point.edge == edge).count();
    let (found_p, found_q) = (count(Edge::P), count(Edge::Q));
    if found_p < MIN_POINTS || found_q < MIN_POINTS {
        let refusal = problem.stations.iter().flat_map(|station| &station.station.captures).find_map(|capture| {
            match &capture.reading {
                Reading::Refused(refusal) => Some(refusal.clone()),
                Reading::Arc(_) | Reading::Edge(_) | Reading::Point(_) | Reading::Pose(_) => None,
            }
        });
        return Err(SolveError::TooFewEdgePoints { found_p, found_q, needed: MIN_POINTS, refusal });
    }
    let poses: Vec<Rigid> = points.iter().map(|measured| measured.point.base_from_flange).collect();
    for measured in &mut points {
        let same = poses.iter().filter(|pose| **pose == measured.point.base_from_flange).count();
        #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 points")]
        let num_at_pose = same as f64;
        measured.num_at_pose = num_at_pose;
    }
    let geometry = PoseGeometry::new(&poses)?;
    Ok((points, geometry))
}

/// What a capture says.
struct Read<'a> {
    capture_idx: usize,
    base_from_flange: Rigid,
    point: Vec3,
    edge: Option<&'a EdgeFit>,
}

impl<'a> Read<'a> {
    fn of((capture_idx, capture): (usize, &'a Capture)) -> Option<Self> {
        let point = capture.reading.point_in_sensor_mm()?;
        let edge = match &capture.reading {
            Reading::Edge(edge) => Some(edge.as_ref()),
            Reading::Arc(_) | Reading::Refused(_) | Reading::Point(_) | Reading::Pose(_) => None,
        };
        Some(Self { capture_idx, base_from_flange: *capture.base_from_flange.rigid(), point, edge })
    }

    /// How much is missing between the point and the surface behind its edge, mm.
    fn gap_mm(&self) -> f64 {
        self.edge.map_or(0.0, |edge| edge.gap_mm[0].hypot(edge.gap_mm[1]))
    }
}

/// What a station read at one pose as one point. The pose's error is common to all of it, and the sensor's noise that of
/// the mean; the pitch of the points, which blurs where a surface ends, is common to all as well.
fn merged<'a>(station: &'a PlateStation, station_idx: usize, here: &[&Read<'a>]) -> Measured<'a> {
    // A hole over the edge need not be in all profiles.
    let least_gap_mm = here.iter().map(|read| read.gap_mm()).fold(f64::INFINITY, f64::min);
    let mut distinct: Vec<&Read> = Vec::new();
    for read in here.iter().filter(|read| read.gap_mm() <= 2.0 * least_gap_mm) {
        if !distinct.iter().any(|other| other.point == read.point) {
            distinct.push(read);
        }
    }
    // Not a number is no distance: then the reading is passed on as it is, for the solver to refuse.
    let used = if distinct.is_empty() { here } else { distinct.as_slice() };
    #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 captures")]
    let num_readings = used.len() as f64;
    let covariance = |edge: &EdgeFit| {
        let is_of_pitch = matches!(edge.feature, Feature::Edge | Feature::Step);
        edge.covariance * (if is_of_pitch { 1.0 } else { 1.0 / num_readings })
    };
    let covariances: Option<Vec<Matrix2<f64>>> = used.iter().map(|read| read.edge.map(covariance)).collect();
    Measured {
        station,
        captures: here.iter().map(|read| (read.capture_idx, read.point)).collect(),
        point: EdgePoint {
            station: station_idx,
            edge: station.edge,
            base_from_flange: here.first().map_or_else(Rigid::identity, |read| read.base_from_flange),
            point_in_sensor: used.iter().map(|read| read.point).sum::<Vec3>() / num_readings,
            information: Matrix2::identity(),
        },
        covariance_mm2: covariances.map(|all| all.iter().sum::<Matrix2<f64>>() / num_readings),
        num_readings,
        num_at_pose: 1.0,
    }
}

/// Whether a point is another one entered once more.
fn is_copy(one: &Measured<'_>, other: &Measured<'_>) -> bool {
    let (one, other) = (&one.point, &other.point);
    one.edge == other.edge
        && one.base_from_flange == other.base_from_flange
        && one.point_in_sensor == other.point_in_sensor
}
