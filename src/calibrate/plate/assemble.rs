//! From a minimum to a solution: the points on the plate, validation, uncertainty and warnings.

use nalgebra::Vector6;

use crate::calibrate::rotation_start::{PoseGeometry, rotation_span};
use crate::calibrate::shared_warnings::{refused_captures, rotation_warnings, stands_out};
use crate::calibrate::uncertainty::{doubt_in_the_noise, of_sensor, point_by_sensor};
use crate::calibrate::{
    Edge, Method, PlateFound, PlatePoint, PlateProblem, PlateReduced, RmsMax, Solution, SolveError, Starts, Warning,
};
use crate::geometry::{Rigid, Transform, Vec3, stats};

use super::bundle::Minimum;
use super::descent::inverse_of;
use super::measured::Measured;
use super::noise::PlateNoise;
use super::points::{EdgePoint, NUM_UNKNOWNS, PlateState, sensor_block};
use super::refit::{PlateRefit, covariance_at, published};
use super::{Candidate, RECOMMENDED_POINTS};

/// Everything that a solution is made from.
pub(super) struct Found<'a> {
    pub method: Method,
    pub problem: &'a PlateProblem,
    pub measured: Vec<Measured<'a>>,
    /// The same points with the weights of the noise.
    pub points: Vec<EdgePoint>,
    pub poses: PoseGeometry,
    /// The bundle's minimum: the noise is found by it whatever the method.
    pub minimum: Minimum,
    pub noise: PlateNoise,
    /// Where the method's own starts led.
    pub best: Candidate,
    pub starts: Starts,
    pub warnings: Vec<Warning>,
}

impl Found<'_> {
    /// # Errors
    /// [`SolveError::Undetermined`] if a combination of the unknowns is free.
    pub fn into_solution(mut self) -> Result<Solution, SolveError> {
        let is_published = self.method == Method::PlateOrthogonal;
        let found = if is_published {
            let start = PlateState { flange_from_sensor: self.best.flange_from_sensor, ..self.minimum.unknowns };
            published(&self.points, &start, |_| 1.0)?
        } else {
            PlateRefit { state: self.minimum.unknowns, covariance: inverse_of(&self.minimum.sums.hessian)? }
        };
        let state = found.state.towards(&self.points);
        let reduced = PlateReduced {
            method: self.method,
            num_stations: self.points.iter().map(|point| point.station + 1).max().unwrap_or(0),
            points: std::mem::take(&mut self.points),
            state,
        };
        let left_out = reduced.without_each();
        let left_out_mm: Vec<Option<f64>> = reduced
            .points
            .iter()
            .map(|point| left_out[point.station].map(|refit| refit.state.off_edge(point).norm()))
            .collect();
        let in_sample: Vec<f64> = reduced.points.iter().map(|point| state.off_edge(point).norm()).collect();
        let poses: Vec<Rigid> = self.measured.iter().map(|measured| measured.point.base_from_flange).collect();
        let span = rotation_span(&poses);
        let converged = self.minimum.converged && (!is_published || self.best.converged);
        let num_iterations = if is_published { self.best.num_iterations } else { self.minimum.num_iterations };
        self.add_warnings(span, converged, num_iterations, &left_out_mm, &in_sample);
        let reference_point = self.reference_point();
        // Without equations left over, the noise is only what was stated or usual: nothing was seen of it.
        let uncertainty = if 2 * reduced.points.len() > NUM_UNKNOWNS {
            let by_sensor = point_by_sensor(reference_point);
            let degrees_of_freedom = self.noise.degrees_of_freedom(|noise| {
                let points = noise.weighed(&self.measured, &found.state);
                let covariance = sensor_block(&covariance_at(self.method, &points, &found.state)?);
                Ok((by_sensor * covariance * by_sensor.transpose()).trace())
            })?;
            Some(of_sensor(
                &(sensor_block(&found.covariance) * doubt_in_the_noise(degrees_of_freedom)),
                degrees_of_freedom,
                &state.flange_from_sensor,
                reference_point,
            ))
        } else {
            None
        };
        let points = self
            .measured
            .iter()
            .zip(&reduced.points)
            .flat_map(|(measured, point)| {
                let without = left_out[point.station];
                measured.captures.iter().map(move |(capture_idx, point_in_sensor)| {
                    let point = EdgePoint { point_in_sensor: *point_in_sensor, ..*point };
                    PlatePoint {
                        station: point.station,
                        station_idx: measured.station.station.idx,
                        capture_idx: *capture_idx,
                        label: measured.station.station.label.clone(),
                        edge: point.edge,
                        point_in_sensor_mm: *point_in_sensor,
                        point_in_base_mm: point.in_base(&state.flange_from_sensor),
                        off_edge_mm: state.off_edge_in_base(&point),
                        leave_one_out_mm: without.map(|refit| refit.state.off_edge(&point).norm()),
                    }
                })
            })
            .collect();
        let rms_max = |distances: &[f64]| RmsMax {
            rms_mm: stats::rms(distances.iter().copied()),
            max_mm: stats::max(distances.iter().copied()),
        };
        Ok(Solution {
            method: self.method,
            mount: self.problem.mount,
            flange_from_sensor: Transform::from_rigid(state.flange_from_sensor),
            target_in_base_mm: state.base_from_plate.translation.vector,
            scatter: rms_max(&in_sample),
            leave_one_out: left_out_mm.iter().copied().collect::<Option<Vec<f64>>>().map(|errors| rms_max(&errors)),
            uncertainty,
            stations: Vec::new(),
            plate: Some(PlateFound { base_from_plate: state.base_from_plate, points, starts: self.starts, reduced }),
            motion: None,
            rotation_span_rad: span,
            warnings: self.warnings,
            num_iterations,
            noise: (!is_published).then(|| self.noise.model()),
            radius: None,
            reduced: None,
            change_by_radius: Vector6::zeros(),
            workspace_point_by_radius: Vec3::zeros(),
        })
    }

    fn reference_point(&self) -> Vec3 {
        let points = || self.measured.iter().map(|measured| measured.point.point_in_sensor);
        self.problem.reference_distance_mm.map_or_else(
            || {
                #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 points")]
                let scale = 1.0 / self.measured.len() as f64;
                points().sum::<Vec3>() * scale
            },
            // A distance has no sign; the points tell on which side of its origin the sensor looks.
            |distance| Vec3::new(0.0, 0.0, distance.copysign(points().map(|point| point.z).sum())),
        )
    }

    fn add_warnings(
        &mut self,
        span_rad: f64,
        converged: bool,
        num_iterations: usize,
        left_out: &[Option<f64>],
        in_sample: &[f64],
    ) {
        let count = |edge: Edge| self.measured.iter().filter(|measured| measured.point.edge == edge).count();
        let (num_p, num_q) = (count(Edge::P), count(Edge::Q));
        if num_p.min(num_q) < RECOMMENDED_POINTS {
            self.warnings.push(Warning::FewEdgePoints { num_p, num_q, recommended: RECOMMENDED_POINTS });
        }
        self.warnings.extend(rotation_warnings(span_rad, &self.poses));
        if !converged {
            self.warnings.push(Warning::NotConverged { num_iterations });
        }
        if let Some((point, error_mm, typical_mm)) = stands_out(left_out, in_sample) {
            let label = self.measured[point].station.station.label.clone();
            self.warnings.push(Warning::StationStandsOut { label, error_mm, typical_mm });
        }
        self.warnings.extend(refused_captures(self.problem.stations.iter().map(|station| &station.station)));
    }
}
