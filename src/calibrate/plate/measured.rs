//! The points that a plate's stations hold.

use nalgebra::{Matrix2, Vector2};

use crate::calibrate::rotation_start::PoseGeometry;
use crate::calibrate::{Edge, PlateProblem, PlateStation, Reading, SolveError};
use crate::fit::EdgeFit;
use crate::geometry::{Rigid, Vec3};

use super::points::EdgePoint;

/// With three points an edge the unknowns are just as many as the equations.
pub const MIN_POINTS: usize = 3;

/// A point with where it is from.
#[derive(Clone, Copy, Debug)]
pub(super) struct Measured<'a> {
    pub station: &'a PlateStation,
    pub capture_idx: usize,
    /// Its information is still that of a unit weight.
    pub point: EdgePoint,
    /// Covariance of (x, z) by its profile, mm².
    pub covariance_mm2: Option<Matrix2<f64>>,
    /// What is missing between it and the surface behind its edge, as its profile shows it, (x, z), mm.
    pub gap_mm: Vector2<f64>,
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
        let before = points.len();
        for (capture_idx, capture) in station.station.captures.iter().enumerate() {
            let Some(point_in_sensor) = capture.reading.point_in_sensor_mm() else { continue };
            points.push(Measured {
                station,
                capture_idx,
                point: EdgePoint {
                    station: num_stations,
                    edge: station.edge,
                    base_from_flange: *capture.base_from_flange.rigid(),
                    point_in_sensor,
                    information: Matrix2::identity(),
                },
                covariance_mm2: edge_of(&capture.reading).map(|edge| edge.covariance),
                gap_mm: edge_of(&capture.reading).map_or_else(Vector2::zeros, |edge| edge.gap_mm.into()),
                num_at_pose: 1.0,
            });
        }
        num_stations += usize::from(points.len() > before);
    }
    let count = |edge: Edge| points.iter().filter(|measured| measured.point.edge == edge).count();
    let (found_p, found_q) = (count(Edge::P), count(Edge::Q));
    if found_p < MIN_POINTS || found_q < MIN_POINTS {
        let refusal = problem.stations.iter().flat_map(|station| &station.station.captures).find_map(|capture| {
            match &capture.reading {
                Reading::Refused(refusal) => Some(refusal.clone()),
                Reading::Arc(_) | Reading::Edge(_) | Reading::Point(_) => None,
            }
        });
        return Err(SolveError::TooFewEdgePoints { found_p, found_q, needed: MIN_POINTS, refusal });
    }
    place_in_holes(&mut points);
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

fn edge_of(reading: &Reading) -> Option<&EdgeFit> {
    match reading {
        Reading::Edge(edge) => Some(edge),
        Reading::Arc(_) | Reading::Refused(_) | Reading::Point(_) => None,
    }
}

/// Where the points of an edge are missing up to the surface behind it, that surface is in the edge's shadow, and the edge is
/// where its own points end. But a shadow falls at most stations; where hardly another shows one, a hole in the
/// measurement hides the edge, which may be anywhere in it.
fn place_in_holes(points: &mut [Measured<'_>]) {
    /// One in so many of the other points of the edge with a gap of at least half the size make it a shadow.
    const SHADOW_ONE_IN: usize = 3;
    let gaps: Vec<(Edge, f64)> = points.iter().map(|measured| (measured.point.edge, measured.gap_mm.norm())).collect();
    for (idx, measured) in points.iter_mut().enumerate() {
        let (edge, size_mm) = gaps[idx];
        let others = || gaps.iter().enumerate().filter(|(other, gap)| *other != idx && gap.0 == edge);
        let alike = others().filter(|(_, gap)| gap.1 >= size_mm / 2.0).count();
        let Some(covariance) = measured.covariance_mm2.as_mut().filter(|_| size_mm > 0.0) else { continue };
        if SHADOW_ONE_IN * alike < others().count() {
            let gap = measured.gap_mm;
            measured.point.point_in_sensor += Vec3::new(gap.x, 0.0, gap.y) / 2.0;
            *covariance += gap * gap.transpose() / 12.0;
        }
    }
}
