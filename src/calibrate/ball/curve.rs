//! The radius-vs-step curve of one station: what a section says about the ball, and the fit over all steps.

use crate::calibrate::observation::{CentreObservation, State};
use crate::calibrate::{BallProblem, Sweep, SweepPoint};
use crate::fit::ArcFit;
use crate::geometry::{Mat3, Rigid, Vec3};

use super::max_arc_step::{commanded_travel_mm, published_stop};
use super::sweep::{StationSweep, SweepStep, travel_direction};

/// Steps of the fit of one curve; it is nearly linear.
const CURVE_ITERATIONS: usize = 12;
/// Below this (mm) the σ of a section is rounding; equal weights then.
const ROUNDING_STD_MM: f64 = 1e-7;

/// The ball's centre from one sweep.
#[derive(Clone, Copy, Debug)]
pub(super) struct CurveFit {
    /// In the sensor frame of the first capture, mm.
    pub ball_in_sensor: Vec3,
    pub covariance: Mat3,
}

/// Pose of the sensor at a step in the sensor frame of the first capture.
fn first_from_step(sweep: &StationSweep<'_>, step: usize, flange_from_sensor: &Rigid) -> Rigid {
    flange_from_sensor.inverse() * sweep.first_pose.inverse() * sweep.steps[step].base_from_flange * flange_from_sensor
}

/// What a section lacks to be explained by a ball at `predicted` (its own sensor frame), and the derivative by it.
///
/// The third residual is (l² − R² + y²)/(2 l): to first order l minus the curve, but finite beyond the ball as well.
pub(crate) fn section_residual(arc: &ArcFit, ball_radius_mm: f64, predicted: Vec3) -> (Vec3, Mat3) {
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
pub(super) fn fit_curve(
    problem: &BallProblem,
    sweep: &StationSweep<'_>,
    state: &State,
    position_std_mm: f64,
) -> Option<CurveFit> {
    let frames: Vec<Rigid> =
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
            let weight = residual_covariance(step.arc, &by_predicted, position_std_mm).try_inverse()?;
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
    ball_in_sensor.iter().all(|v| v.is_finite()).then_some(CurveFit { ball_in_sensor, covariance })
}

/// Covariance of (x, z, l) by the noise of the points and of the pose.
fn residual_covariance(arc: &ArcFit, by_predicted: &Mat3, position_std_mm: f64) -> Mat3 {
    arc.covariance
        + Mat3::identity() * (ROUNDING_STD_MM * ROUNDING_STD_MM)
        + by_predicted * by_predicted.transpose() * (position_std_mm * position_std_mm)
}

/// What one section says about the ball's centre, as a quadratic about `predicted`; pose noise is not yet in it.
pub(super) fn section_observation(
    station: usize,
    step: &SweepStep<'_>,
    ball_radius_mm: f64,
    predicted: Vec3,
) -> Option<CentreObservation> {
    let (residual, by_predicted) = section_residual(step.arc, ball_radius_mm, predicted);
    let weight = residual_covariance(step.arc, &by_predicted, 0.0).try_inverse()?;
    let information = by_predicted.transpose() * weight * by_predicted;
    Some(CentreObservation {
        station,
        base_from_flange: *step.base_from_flange,
        centre_in_sensor: predicted,
        information: (information + information.transpose()) * 0.5,
        pull: -(by_predicted.transpose() * weight * residual),
        constant: residual.dot(&(weight * residual)),
    })
}

/// The top of the parabola l² + m² = R² − y₀² + 2 y₀ m through all steps, m the travel along the normal.
fn curve_start(problem: &BallProblem, sweep: &StationSweep<'_>, frames: &[Rigid]) -> Vec3 {
    let travel: Vec<f64> = frames.iter().map(|frame| frame.translation.y).collect();
    #[expect(clippy::cast_precision_loss, reason = "a sweep has few steps")]
    let scale = 1.0 / travel.len() as f64;
    let mean = travel.iter().sum::<f64>() * scale;
    let squares: Vec<f64> =
        sweep.steps.iter().zip(&travel).map(|(step, m)| step.arc.circle.radius_mm.powi(2) + m * m).collect();
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

pub(super) fn evaluated_sweep(
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
            // From where the step sees the ball: the plain distance of the two sensors would carry the noise of the
            // orientation at the lever from robot to sensor.
            let frame = first_from_step(sweep, step, &state.flange_from_sensor);
            let travel_mm = peak_mm - frame.inverse_transform_point(&curve.ball_in_sensor.into()).y;
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

/// The ball's radius that the curve of a sweep shows by itself: l² + m² is a straight line over the travel m, whose height
/// above its top's place is R². Mean over the sweeps and its standard deviation by their scatter.
pub(super) fn radius_from_sweeps(sweeps: &[Sweep]) -> Option<(f64, f64)> {
    let radii: Vec<f64> = sweeps.iter().filter_map(radius_from_curve).collect();
    #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 sweeps")]
    let count = radii.len() as f64;
    let mean = radii.iter().sum::<f64>() / count;
    let scatter = radii.iter().map(|radius| (radius - mean).powi(2)).sum::<f64>();
    (radii.len() >= 3).then(|| (mean, (scatter / (count * (count - 1.0))).sqrt()))
}

fn radius_from_curve(sweep: &Sweep) -> Option<f64> {
    #[expect(clippy::cast_precision_loss, reason = "a sweep has few steps")]
    let scale = 1.0 / sweep.points.len() as f64;
    let squares = || {
        sweep.points.iter().map(|point| (point.travel_mm, point.section_radius_mm.powi(2) + point.travel_mm.powi(2)))
    };
    let mean_travel = squares().map(|(travel, _)| travel).sum::<f64>() * scale;
    let mean_square = squares().map(|(_, square)| square).sum::<f64>() * scale;
    let spread = squares().map(|(travel, _)| (travel - mean_travel).powi(2)).sum::<f64>();
    let slope = squares().map(|(travel, square)| (travel - mean_travel) * (square - mean_square)).sum::<f64>() / spread;
    let top = 0.5 * slope;
    let radius_squared = mean_square - slope * mean_travel + top * top;
    (radius_squared.is_finite() && radius_squared > 0.0).then(|| radius_squared.sqrt())
}
