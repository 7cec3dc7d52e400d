//! `ball-max-arc`: the whole radius-vs-step curve, with the real pose of every step.
//!
//! # Source
//! Ours, after Lin & Mu 2019, section 2. Near its top the curve is flat, so the published stop is off by about √(2 R σ_l);
//! its flanks tell where the top is: l² = R² − (y − y₀)². "Robot Y" is the laser's normal only once the calibration is
//! known, so travel is projected with the rotation found, and the fit repeated until the rotation stands still.

use nalgebra::Isometry3;

use crate::calibrate::observation::{CentreObservation, State};
use crate::calibrate::rotation_start::PoseGeometry;
use crate::calibrate::solver::{Minimum, minimise};
use crate::calibrate::{BallProblem, Method, Solution, SolveError, Sweep, SweepPoint, Warning};
use crate::fit::ArcFit;
use crate::geometry::{Mat3, Rigid, Vec3};

use super::assemble::{Found, StationFacts};
use super::fixed_point::mean_square_residual;
use super::max_arc_step::{self, commanded_travel_mm, published_stop};
use super::sweep::{StationSweep, step_warning, sweeps, travel_direction};

/// Alternations between curve and calibration. The error falls tenfold each; this is for hopeless starts.
const MAX_ALTERNATIONS: usize = 80;
/// Movements below this (mm, or mm at 100 mm of lever) between alternations are the end.
const SETTLED_MM: f64 = 1e-11;
/// Steps of the fit of one curve; it is nearly linear.
const CURVE_ITERATIONS: usize = 12;
/// Travel may differ from the laser's normal by this, degrees, before the published method suffers visibly.
const OFF_NORMAL_DEG: f64 = 1.0;

/// The ball's centre from one sweep.
#[derive(Clone, Debug)]
struct CurveFit {
    /// In the sensor frame of the first capture, mm.
    ball_in_sensor: Vec3,
    covariance: Mat3,
}

/// Solves by the whole curves.
///
/// # Errors
/// [`SolveError`] with fewer than four usable sweeps, or if they leave a direction free.
pub fn solve(problem: &BallProblem) -> Result<Solution, SolveError> {
    let mut warnings = Vec::new();
    let sweeps = sweeps(problem, &mut warnings)?;
    let direction = travel_direction(&sweeps);
    warnings.extend(step_warning(&sweeps, direction));
    let base_from_flange: Vec<Rigid> = sweeps.iter().map(|sweep| *sweep.first_pose).collect();
    let poses = PoseGeometry::new(&base_from_flange)?;
    let mut best: Option<(f64, Alternated)> = None;
    // A published stop that went astray must not spoil the better method: the fixed-point answer is tried as well.
    for start in [max_arc_step::solve(problem), super::fixed_point::solve(problem)] {
        let Ok(start) = start else { continue };
        let start = State {
            flange_from_sensor: *start.flange_from_sensor.rigid(),
            ball_in_base: start.ball_in_base_mm,
        };
        let Ok(alternated) = alternate(problem, &sweeps, start) else {
            continue;
        };
        let cost = mean_square_residual(&alternated.observations, &alternated.minimum.state).unwrap_or(0.0);
        // A second start is only worth its time if the first did not settle on something that fits.
        let fits = alternated.minimum.converged && cost < problem.radius_mm * problem.radius_mm * 1e-4;
        if best.as_ref().is_none_or(|(least, _)| cost < *least) {
            best = Some((cost, alternated));
        }
        if fits {
            break;
        }
    }
    let (_, found) = best.ok_or(SolveError::Diverged)?;
    let stations = sweeps
        .iter()
        .zip(&found.curves)
        .map(|(sweep, curve)| StationFacts {
            station: sweep.station,
            side_cost_ratio: None,
            ball_in_sensor_std_mm: Some(curve.covariance.diagonal().map(|v| v.max(0.0).sqrt())),
            sweep: Some(evaluated_sweep(problem, sweep, curve, &found.minimum.state, direction)),
        })
        .collect::<Vec<_>>();
    add_sweep_warnings(&stations, &mut warnings);
    let variance_factor = mean_square_residual(&found.observations, &found.minimum.state);
    Found {
        method: Method::BallMaxArc,
        problem,
        stations,
        observations: found.observations,
        minimum: found.minimum,
        variance_factor,
        prior_information: 0.0,
        poses,
        warnings,
    }
    .into_solution()
}

#[derive(Clone, Debug)]
struct Alternated {
    curves: Vec<CurveFit>,
    observations: Vec<CentreObservation>,
    minimum: Minimum,
}

/// Fits the curves with the rotation at hand, solves for the rotation with the curves at hand, and so on.
fn alternate(problem: &BallProblem, sweeps: &[StationSweep<'_>], start: State) -> Result<Alternated, SolveError> {
    let mut state = start;
    let mut pose_variance = problem.noise.position_std_mm.map_or(0.0, |std| std * std);
    let mut latest = None;
    for alternation in 0..MAX_ALTERNATIONS {
        let curves: Vec<CurveFit> = sweeps
            .iter()
            .map(|sweep| fit_curve(problem, sweep, &state, pose_variance))
            .collect::<Option<_>>()
            .ok_or(SolveError::Diverged)?;
        if alternation == 1 && problem.noise.position_std_mm.is_none() {
            pose_variance = estimated_pose_variance(sweeps, &curves, &state);
        }
        let observations: Vec<CentreObservation> = sweeps
            .iter()
            .zip(&curves)
            .enumerate()
            .map(|(idx, (sweep, curve))| CentreObservation::point(idx, *sweep.first_pose, curve.ball_in_sensor))
            .collect();
        let mut minimum = minimise(observations.iter(), state)?;
        let moved = movement_mm(&state, &minimum.state);
        state = minimum.state;
        let settled = moved < SETTLED_MM && alternation > 2;
        minimum.converged &= settled || moved < 1e-6;
        minimum.num_iterations = alternation + 1;
        latest = Some(Alternated {
            curves,
            observations,
            minimum,
        });
        if settled {
            break;
        }
    }
    latest.ok_or(SolveError::Diverged)
}

fn movement_mm(before: &State, after: &State) -> f64 {
    let change = before.flange_from_sensor.inverse() * after.flange_from_sensor;
    change.translation.vector.norm()
        + 100.0 * change.rotation.angle()
        + (before.ball_in_base - after.ball_in_base).norm()
}

/// Pose of the sensor at a step in the sensor frame of the first capture.
fn first_from_step(sweep: &StationSweep<'_>, step: usize, flange_from_sensor: &Rigid) -> Isometry3<f64> {
    flange_from_sensor.inverse()
        * sweep.first_pose.inverse()
        * sweep.steps[step].base_from_flange
        * flange_from_sensor
}

/// What a section lacks to be explained by a ball at `predicted` (its own sensor frame), and the derivative by it.
///
/// The third residual is (l² − R² + y²)/(2 l): to first order l minus the curve, but finite beyond the ball as well.
fn section_residual(arc: &ArcFit, ball_radius_mm: f64, predicted: Vec3) -> (Vec3, Mat3) {
    let circle = arc.circle;
    let l = circle.radius_mm;
    let residual = Vec3::new(
        circle.x_mm - predicted.x,
        circle.z_mm - predicted.z,
        (l * l - ball_radius_mm * ball_radius_mm + predicted.y * predicted.y) / (2.0 * l),
    );
    let derivative = Mat3::new(-1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, predicted.y / l, 0.0);
    (residual, derivative)
}

/// Gauss–Newton for the ball's centre in the frame of the first capture, over x, z and l of all steps.
fn fit_curve(
    problem: &BallProblem,
    sweep: &StationSweep<'_>,
    state: &State,
    pose_variance: f64,
) -> Option<CurveFit> {
    let frames: Vec<Isometry3<f64>> =
        (0..sweep.steps.len()).map(|step| first_from_step(sweep, step, &state.flange_from_sensor)).collect();
    let mut ball_in_sensor = curve_start(problem, sweep, &frames);
    let mut covariance = Mat3::zeros();
    for _ in 0..CURVE_ITERATIONS {
        let mut information = Mat3::zeros();
        let mut gradient = Vec3::zeros();
        for (step, frame) in sweep.steps.iter().zip(&frames) {
            let step_from_first = frame.rotation.inverse();
            let predicted = step_from_first * (ball_in_sensor - frame.translation.vector);
            let (residual, by_predicted) = section_residual(step.arc, problem.radius_mm, predicted);
            let jacobian = by_predicted * step_from_first.to_rotation_matrix().matrix();
            let weight = residual_covariance(step.arc, &by_predicted, pose_variance).try_inverse()?;
            information += jacobian.transpose() * weight * jacobian;
            gradient -= jacobian.transpose() * weight * residual;
        }
        let factor = information.cholesky()?;
        let change = factor.solve(&gradient);
        covariance = factor.inverse();
        // The curve is a parabola in l²: a step beyond the ball means a start on the wrong flank.
        let length = change.norm();
        ball_in_sensor += change * (problem.radius_mm / length.max(problem.radius_mm));
        if length < 1e-13 * problem.radius_mm {
            break;
        }
    }
    ball_in_sensor.iter().all(|v| v.is_finite()).then_some(CurveFit {
        ball_in_sensor,
        covariance,
    })
}

/// Covariance of (x, z, l) by the noise of the points and of the pose.
fn residual_covariance(arc: &ArcFit, by_predicted: &Mat3, pose_variance: f64) -> Mat3 {
    /// Below this (mm) the fit's own σ is rounding; equal weights then.
    const ROUNDING_STD_MM: f64 = 1e-7;
    arc.covariance
        + Mat3::identity() * (ROUNDING_STD_MM * ROUNDING_STD_MM)
        + by_predicted * by_predicted.transpose() * pose_variance
}

/// The top of the parabola l² + m² = R² − y₀² + 2 y₀ m through all steps, m the travel along the normal.
fn curve_start(problem: &BallProblem, sweep: &StationSweep<'_>, frames: &[Isometry3<f64>]) -> Vec3 {
    let travel: Vec<f64> = frames.iter().map(|frame| frame.translation.y).collect();
    #[expect(clippy::cast_precision_loss, reason = "a sweep has few steps")]
    let scale = 1.0 / travel.len() as f64;
    let mean = travel.iter().sum::<f64>() * scale;
    let squares: Vec<f64> = sweep
        .steps
        .iter()
        .zip(&travel)
        .map(|(step, m)| step.arc.circle.radius_mm.powi(2) + m * m)
        .collect();
    let mean_square = squares.iter().sum::<f64>() * scale;
    let (mut cross, mut spread) = (0.0, 0.0);
    for (m, square) in travel.iter().zip(&squares) {
        cross += (m - mean) * (square - mean_square);
        spread += (m - mean) * (m - mean);
    }
    let top = if spread > 0.0 { 0.5 * cross / spread } else { 0.0 };
    let stop = published_stop(sweep, problem.radius_mm);
    let circle = sweep.steps[stop].arc.circle;
    let at_stop = frames[stop].translation.vector;
    Vec3::new(circle.x_mm + at_stop.x, top, circle.z_mm + at_stop.z)
}

/// Variance that x and z of the sections show beyond that of the points: the robot's, mm².
fn estimated_pose_variance(sweeps: &[StationSweep<'_>], curves: &[CurveFit], state: &State) -> f64 {
    let (mut excess, mut count) = (0.0, 0.0);
    for (sweep, curve) in sweeps.iter().zip(curves) {
        for (step, sweep_step) in sweep.steps.iter().enumerate() {
            let frame = first_from_step(sweep, step, &state.flange_from_sensor);
            let predicted = frame.inverse_transform_point(&curve.ball_in_sensor.into());
            let circle = sweep_step.arc.circle;
            let [std_x, std_z, _] = sweep_step.arc.std_mm();
            excess += (circle.x_mm - predicted.x).powi(2) - std_x * std_x;
            excess += (circle.z_mm - predicted.z).powi(2) - std_z * std_z;
            count += 2.0;
        }
    }
    (excess / count).max(0.0)
}

fn evaluated_sweep(
    problem: &BallProblem,
    sweep: &StationSweep<'_>,
    curve: &CurveFit,
    state: &State,
    direction: Vec3,
) -> Sweep {
    let radius_mm = problem.radius_mm;
    let peak_mm = curve.ball_in_sensor.y;
    let points: Vec<SweepPoint> = sweep
        .steps
        .iter()
        .enumerate()
        .map(|(step, sweep_step)| {
            let travel_mm = first_from_step(sweep, step, &state.flange_from_sensor).translation.y;
            let section_radius_mm = sweep_step.arc.circle.radius_mm;
            let on_curve = (radius_mm * radius_mm - (travel_mm - peak_mm).powi(2)).max(0.0).sqrt();
            SweepPoint {
                capture_idx: sweep_step.capture_idx,
                travel_mm,
                section_radius_mm,
                section_radius_std_mm: sweep_step.arc.std_mm()[2],
                residual_mm: section_radius_mm - on_curve,
            }
        })
        .collect();
    let stop = published_stop(sweep, radius_mm);
    let laser_normal_in_flange = state.flange_from_sensor.rotation * Vec3::y();
    let along = direction.dot(&laser_normal_in_flange);
    let extent = points.iter().map(|point| point.travel_mm);
    let (least, most) = (extent.clone().fold(f64::INFINITY, f64::min), extent.fold(f64::NEG_INFINITY, f64::max));
    #[expect(clippy::cast_precision_loss, reason = "a sweep has few steps")]
    let mean_step_mm = (most - least) / (points.len() - 1) as f64;
    Sweep {
        peak_mm,
        peak_std_mm: curve.covariance[(1, 1)].max(0.0).sqrt(),
        published_stop_mm: along.signum() * commanded_travel_mm(sweep, stop, direction),
        published_stop_idx: sweep.steps[stop].capture_idx,
        // Uniform within a step: d/√12.
        published_stop_std_mm: (2.0 * radius_mm * points[stop].section_radius_std_mm)
            .sqrt()
            .hypot(mean_step_mm / 12.0_f64.sqrt()),
        travel_off_normal_rad: station_travel_angle(sweep, laser_normal_in_flange),
        covers_peak: least < peak_mm && peak_mm < most,
        points,
    }
}

/// Angle between the laser's normal and this station's travel, rad.
fn station_travel_angle(sweep: &StationSweep<'_>, laser_normal_in_flange: Vec3) -> f64 {
    let travel = travel_direction(std::slice::from_ref(sweep));
    travel.cross(&laser_normal_in_flange).norm().atan2(travel.dot(&laser_normal_in_flange).abs())
}

fn add_sweep_warnings(stations: &[StationFacts<'_>], warnings: &mut Vec<Warning>) {
    let mut most_off_normal: Option<(&str, f64)> = None;
    for facts in stations {
        let Some(sweep) = &facts.sweep else { continue };
        let angle_deg = sweep.travel_off_normal_rad.to_degrees();
        if angle_deg > OFF_NORMAL_DEG && most_off_normal.is_none_or(|(_, most)| angle_deg > most) {
            most_off_normal = Some((&facts.station.label, angle_deg));
        }
        if !sweep.covers_peak {
            let beyond_mm = sweep
                .points
                .iter()
                .map(|point| (point.travel_mm - sweep.peak_mm).abs())
                .fold(f64::INFINITY, f64::min);
            warnings.push(Warning::PeakNotCovered {
                label: facts.station.label.clone(),
                beyond_mm,
            });
        }
    }
    if let Some((label, angle_deg)) = most_off_normal {
        warnings.push(Warning::TravelOffNormal {
            label: label.to_owned(),
            angle_deg,
        });
    }
}
