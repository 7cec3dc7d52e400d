//! From a minimum to a solution: error tables, validation, uncertainty and the warnings that all methods share.

use crate::calibrate::observation::{CentreObservation, State};
use crate::calibrate::rotation_start::{PoseGeometry, rotation_span};
use crate::calibrate::shared_warnings::{rotation_warnings, stands_out};
use crate::calibrate::solver::{Gradient, Minimum, covariance_for_unit_noise};
use crate::calibrate::uncertainty::{Spread, change_by_radius, uncertainty};
use crate::calibrate::validation::leave_one_out;
use crate::calibrate::{
    BallProblem, EstimatedRadius, Method, NoiseModel, Reduced, RmsMax, Side, Solution, SolveError, Station,
    StationSolution, Sweep, Warning,
};
use crate::geometry::{Mat3, Rigid, Transform, Vec3, stats};

use super::RECOMMENDED_STATIONS;

/// With five stations six numbers judge nine unknowns; fewer stations than this are said to be few.
const FEW_BELOW: usize = 6;
/// What a method knows of a station besides its observations.
#[derive(Clone, Debug)]
pub(super) struct StationFacts<'a> {
    pub station: &'a Station,
    pub side_cost_ratio: Option<f64>,
    pub target_in_sensor_std_mm: Option<Vec3>,
    pub sweep: Option<Sweep>,
}

/// Everything that a solution is made from.
#[derive(Debug)]
pub(super) struct Found<'a> {
    pub method: Method,
    pub problem: &'a BallProblem,
    pub stations: Vec<StationFacts<'a>>,
    pub observations: Vec<CentreObservation>,
    /// Covariance of what is common to each station, in the sensor frame, mm²; empty where nothing is.
    pub common_covariance: Vec<Mat3>,
    pub minimum: Minimum,
    /// From the normal equations to a covariance; `None` if nothing is left over to judge by.
    pub spread: Option<Spread>,
    /// The noise that the weights stand for.
    pub noise: Option<NoiseModel>,
    /// The radius where it was estimated.
    pub radius: Option<EstimatedRadius>,
    /// Change of the unknowns with the radius, a mm.
    pub by_radius: Gradient,
    /// See [`station_ball`](crate::calibrate::validation::station_ball).
    pub prior_information: f64,
    pub poses: PoseGeometry,
    pub warnings: Vec<Warning>,
}

impl Found<'_> {
    /// # Errors
    /// [`SolveError::Undetermined`] if a combination of the unknowns is free.
    pub fn into_solution(mut self) -> Result<Solution, SolveError> {
        let state = self.minimum.state;
        let num_stations = self.stations.len();
        let reduced = Reduced {
            observations: std::mem::take(&mut self.observations),
            common_covariance: std::mem::take(&mut self.common_covariance),
            num_stations,
            state,
            hessian: self.minimum.hessian,
            prior_information: self.prior_information,
            variance_factor: self.spread.as_ref().map(Spread::factor),
        };
        let balls_in_base: Vec<Vec3> = (0..num_stations).map(|idx| reduced.station_ball(idx, &state)).collect();
        #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 stations")]
        let mean = balls_in_base.iter().sum::<Vec3>() / num_stations as f64;
        let left_out = leave_one_out(&reduced);
        let first_poses: Vec<Rigid> = self.stations.iter().map(|facts| *first_pose(facts.station)).collect();
        let span = rotation_span(&first_poses);
        let unit_covariance = covariance_for_unit_noise(&self.minimum.hessian)?;
        let balls_in_sensor: Vec<Vec3> = first_poses
            .iter()
            .zip(&balls_in_base)
            .map(|(pose, ball_in_base)| State { ball_in_base: *ball_in_base, ..state }.ball_in_sensor(pose))
            .collect();
        let reference_point = self.reference_point(&balls_in_sensor);
        let radius_std_mm = self.radius.map_or(self.problem.radius_std_mm, |radius| Some(radius.std_mm));
        let uncertainty = self.spread.as_ref().map(|spread| {
            let by_radius = self.by_radius * radius_std_mm.unwrap_or(0.0);
            uncertainty(&unit_covariance, spread, &by_radius, &state.flange_from_sensor, reference_point)
        });
        let (change_by_radius, workspace_point_by_radius) =
            change_by_radius(&self.by_radius, &state.flange_from_sensor, reference_point);
        let in_sample: Vec<f64> = balls_in_base.iter().map(|ball| (ball - state.ball_in_base).norm()).collect();
        self.add_shared_warnings(span, &left_out, &in_sample);
        let stations = self
            .stations
            .into_iter()
            .enumerate()
            .map(|(idx, facts)| StationSolution {
                station_idx: facts.station.idx,
                label: facts.station.label.clone(),
                side: if balls_in_sensor[idx].y < 0.0 { Side::Minus } else { Side::Plus },
                side_cost_ratio: facts.side_cost_ratio,
                target_in_sensor_mm: balls_in_sensor[idx],
                target_in_sensor_std_mm: facts.target_in_sensor_std_mm,
                target_in_base_mm: balls_in_base[idx],
                error_from_first_mm: balls_in_base[idx] - balls_in_base[0],
                error_from_mean_mm: balls_in_base[idx] - mean,
                leave_one_out_mm: left_out[idx],
                sweep: facts.sweep,
            })
            .collect();
        Ok(Solution {
            method: self.method,
            mount: self.problem.mount,
            flange_from_sensor: Transform::from_rigid(state.flange_from_sensor),
            target_in_base_mm: state.ball_in_base,
            scatter: rms_max(balls_in_base.iter().map(|ball| (ball - state.ball_in_base).norm())),
            leave_one_out: left_out.iter().all(Option::is_some).then(|| rms_max(left_out.iter().copied().flatten())),
            uncertainty,
            stations,
            rotation_span_rad: span,
            warnings: self.warnings,
            num_iterations: self.minimum.num_iterations,
            noise: self.noise,
            radius: self.radius,
            reduced: Some(reduced),
            plate: None,
            motion: None,
            change_by_radius,
            workspace_point_by_radius,
        })
    }

    fn reference_point(&self, balls_in_sensor: &[Vec3]) -> Vec3 {
        self.problem.reference_distance_mm.map_or_else(
            || {
                #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 stations")]
                let scale = 1.0 / balls_in_sensor.len() as f64;
                balls_in_sensor.iter().sum::<Vec3>() * scale
            },
            // A distance has no sign; the balls tell on which side of its origin the sensor looks.
            |distance| Vec3::new(0.0, 0.0, distance.copysign(balls_in_sensor.iter().map(|ball| ball.z).sum())),
        )
    }

    fn add_shared_warnings(&mut self, span_rad: f64, left_out: &[Option<f64>], in_sample: &[f64]) {
        let num_stations = self.stations.len();
        if num_stations < FEW_BELOW {
            self.warnings.push(Warning::FewStations { num_stations, recommended: RECOMMENDED_STATIONS });
        }
        self.warnings.extend(rotation_warnings(span_rad, &self.poses));
        if !self.minimum.converged {
            self.warnings.push(Warning::NotConverged { num_iterations: self.minimum.num_iterations });
        }
        if let Some((station, error_mm, typical_mm)) = stands_out(left_out, in_sample) {
            self.warnings.push(Warning::StationStandsOut {
                label: self.stations[station].station.label.clone(),
                error_mm,
                typical_mm,
            });
        }
    }
}

/// The pose of a station's first capture; stations have at least one.
pub(super) fn first_pose(station: &Station) -> &Rigid {
    station.captures[0].base_from_flange.rigid()
}

fn rms_max(distances: impl Iterator<Item = f64> + Clone) -> RmsMax {
    RmsMax { rms_mm: stats::rms(distances.clone()), max_mm: stats::max(distances) }
}
