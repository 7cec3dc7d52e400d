//! Distances of a plate's points to the lines and the plane fitted to them (Chen et al. 2023, Figs. 3 and 4).

use crate::calibrate::{Edge, PlateProblem};
use crate::geometry::{Flange, Scatter, Sensor, Transform, Vec3};
use crate::scan::Plane;

use super::{Figures, NotEvaluated};

/// Points without which a line says nothing about its points: two always lie on one.
const LEAST_A_LINE: usize = 3;

/// A line in space, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// A point on it: the centroid of what it was fitted to.
    pub point_mm: Vec3,
    /// Its direction, of length 1.
    pub direction: Vec3,
}

impl Line {
    /// The line with the least sum of squared distances.
    #[must_use]
    pub fn through(points: &[Vec3]) -> Self {
        let scatter = Scatter::of(points.iter().copied());
        scatter.map_or(Self { point_mm: Vec3::zeros(), direction: Vec3::x() }, |scatter| Self {
            point_mm: scatter.centroid_mm,
            direction: scatter.widest,
        })
    }

    /// From the nearest point of the line to a point, mm.
    #[must_use]
    pub fn offset_mm(&self, point_mm: Vec3) -> Vec3 {
        let from_centroid = point_mm - self.point_mm;
        from_centroid - self.direction * self.direction.dot(&from_centroid)
    }

    /// Least distance between two lines, mm.
    #[must_use]
    pub fn distance_mm(&self, other: &Self) -> f64 {
        let between = other.point_mm - self.point_mm;
        match self.direction.cross(&other.direction).try_normalize(1e-9) {
            Some(across) => across.dot(&between).abs(),
            None => self.offset_mm(other.point_mm).norm(),
        }
    }

    /// Angle between two lines, from 0 to a right angle, rad.
    #[must_use]
    pub fn angle_rad(&self, other: &Self) -> f64 {
        self.direction.cross(&other.direction).norm().atan2(self.direction.dot(&other.direction).abs())
    }
}

/// A point on an edge, through a calibration.
#[derive(Clone, Debug, PartialEq)]
pub struct EdgePoint {
    /// The caller's index of its station.
    pub station_idx: usize,
    /// Its capture in that station.
    pub capture_idx: usize,
    /// The station's name.
    pub label: String,
    /// The edge that it is on.
    pub edge: Edge,
    /// Where it is in the base, mm.
    pub point_in_base_mm: Vec3,
    /// Distance from the line of its edge, mm.
    pub to_line_mm: f64,
    /// Distance from the plane, mm.
    pub to_plane_mm: f64,
}

/// What a calibration makes of a plate's points.
#[derive(Clone, Debug, PartialEq)]
pub struct Distances {
    /// One entry a point, in the order of stations and captures.
    pub points: Vec<EdgePoint>,
    /// The lines of the edges p and q, each fitted to its points alone.
    pub lines: [Line; 2],
    /// The plane of all points.
    pub plane: Plane,
    /// The midst of all points, in the base, mm.
    pub centroid_mm: Vec3,
    /// Distances of the points from the line of their edge (Fig. 3).
    pub to_line: Figures,
    /// Distances of the points from the plane (Fig. 4).
    pub to_plane: Figures,
    /// Angle between the two lines, rad: a right angle on a true plate.
    pub angle_rad: f64,
    /// By how much the two lines miss each other, mm: nothing on a true plate.
    pub gap_mm: f64,
}

/// Fits lines and plane to a plate's points as a calibration places them. The lines are free: neither has to meet the other,
/// nor at a right angle, so nothing of what made the calibration is put into them.
///
/// # Errors
/// [`NotEvaluated::TooFewOnEdge`] if an edge has fewer than three points.
pub fn distances(
    problem: &PlateProblem,
    flange_from_sensor: &Transform<Flange, Sensor>,
) -> Result<Distances, NotEvaluated> {
    let mut points = edge_points(problem, flange_from_sensor);
    let of_edge = |edge: Edge| -> Result<Vec<Vec3>, NotEvaluated> {
        let on_edge: Vec<Vec3> =
            points.iter().filter(|point| point.edge == edge).map(|point| point.point_in_base_mm).collect();
        if on_edge.len() < LEAST_A_LINE {
            return Err(NotEvaluated::TooFewOnEdge { edge, found: on_edge.len(), needed: LEAST_A_LINE });
        }
        Ok(on_edge)
    };
    let mut all = of_edge(Edge::P)?;
    let on_q = of_edge(Edge::Q)?;
    let lines = [Line::through(&all), Line::through(&on_q)];
    all.extend(on_q);
    let (centroid_mm, normal) = Scatter::of(all.iter().copied())
        .map_or((Vec3::zeros(), Vec3::z()), |scatter| (scatter.centroid_mm, scatter.narrowest));
    let plane = Plane::through(centroid_mm, normal);
    for point in &mut points {
        let line = &lines[usize::from(point.edge == Edge::Q)];
        point.to_line_mm = line.offset_mm(point.point_in_base_mm).norm();
        point.to_plane_mm = plane.distance_mm(point.point_in_base_mm).abs();
    }
    let figures = |distance: fn(&EdgePoint) -> f64| Figures::of(&points.iter().map(distance).collect::<Vec<_>>());
    Ok(Distances {
        to_line: figures(|point| point.to_line_mm),
        to_plane: figures(|point| point.to_plane_mm),
        angle_rad: lines[0].angle_rad(&lines[1]),
        gap_mm: lines[0].distance_mm(&lines[1]),
        points,
        lines,
        plane,
        centroid_mm,
    })
}

fn edge_points(problem: &PlateProblem, flange_from_sensor: &Transform<Flange, Sensor>) -> Vec<EdgePoint> {
    let of_station = |edge: Edge, station: &crate::calibrate::Station| -> Vec<EdgePoint> {
        let seen = station.captures.iter().enumerate();
        seen.filter_map(|(capture_idx, capture)| {
            let base_from_sensor = capture.base_from_flange * *flange_from_sensor;
            Some(EdgePoint {
                station_idx: station.idx,
                capture_idx,
                label: station.label.clone(),
                edge,
                point_in_base_mm: base_from_sensor.map_point(capture.reading.point_in_sensor_mm()?),
                to_line_mm: 0.0,
                to_plane_mm: 0.0,
            })
        })
        .collect()
    };
    problem.stations.iter().flat_map(|at_plate| of_station(at_plate.edge, &at_plate.station)).collect()
}
