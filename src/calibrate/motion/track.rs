//! From the poses of a camera that tracks its own motion to a solution: steps in which it lost its way are set aside, noise and
//! minimum settle, and stretches of the track stand where other targets have stations.

use nalgebra::{Matrix6, Vector6};

use crate::calibrate::plate::descent::inverse_of;
use crate::calibrate::rotation_start::{PoseGeometry, rotation_span};
use crate::calibrate::shared_warnings::{rotation_warnings, stands_out};
use crate::calibrate::uncertainty::{doubt_in_the_noise, of_sensor};
use crate::calibrate::{
    Method, MotionData, Mount, Noise, NoiseModel, RmsMax, Side, Solution, SolveError, StationSolution, Warning,
};
use crate::geometry::{Rigid, Transform, Vec3, stats};

use super::assemble::against;
use super::found::{MotionFound, MotionPose, Tracked};
use super::measured::{LEVER_MM, MIN_POSES};
use super::pose::{Information, MotionState, PosePair};
use super::start;
use super::steps::{Track, TrackNoise, TrackPose, is_known};
use super::stretches::TrackReduced;

/// The distance for which the headline is stated where nothing is known of the scene, mm.
const USUAL_DISTANCE_MM: f64 = 500.0;
/// A usual robot, where nothing is stated: position (mm), orientation (rad).
const USUAL_ROBOT: [f64; 2] = [0.05, 3e-4];
/// The square of a step's error beyond which the camera lost its way there; see [`super::rejection`].
const LOST: f64 = 45.0;
/// Noise and lost steps settle in a few rounds.
const MAX_ROUNDS: usize = 8;

/// A track once its noise has settled.
pub(super) struct Settled {
    pub poses: Vec<TrackPose>,
    pub noise: TrackNoise,
    pub sensor: Rigid,
    mount: Mount,
    hessian: Matrix6<f64>,
    num_iterations: usize,
    converged: bool,
    start: start::Start,
}

impl Settled {
    /// # Errors
    /// [`SolveError`] if nothing can be computed from these poses.
    pub fn of(mut poses: Vec<TrackPose>, mount: Mount, stated: Noise) -> Result<Self, SolveError> {
        if poses.len() < MIN_POSES {
            return Err(SolveError::TooFewStations { found: poses.len(), needed: MIN_POSES, refusal: None });
        }
        PoseGeometry::new(&of_flange(&poses))?;
        let start = start::start(&pairs(&poses))?;
        let variance = |stated: Option<f64>, usual: f64| stated.unwrap_or(usual).powi(2);
        let mut noise = TrackNoise {
            position: variance(stated.position_std_mm, USUAL_ROBOT[0]),
            orientation: variance(stated.orientation_std_rad, USUAL_ROBOT[1]),
            rotation_factor: 1.0,
            translation_factor: 1.0,
        };
        let mut sensor = start.state.flange_from_sensor;
        let mut latest = None;
        for round in 1..=MAX_ROUNDS {
            let track = Track { poses: &poses, noise, mount };
            let found = track.minimise(sensor, |_| 1.0)?;
            let moved = sensor.inverse() * found.unknowns.0;
            sensor = found.unknowns.0;
            latest = Some((found, round));
            let was = std::mem::replace(&mut noise, track.noise_seen(&sensor));
            let changed = (noise.rotation_factor / was.rotation_factor - 1.0).abs()
                + (noise.translation_factor / was.translation_factor - 1.0).abs();
            let squares = Track { poses: &poses, noise, mount }.squares(&sensor);
            let mut is_other = false;
            for (pose, (_, error)) in poses[1..].iter_mut().zip(&squares) {
                let is_believed = is_known(&pose.covariance) && square_alone(pose, error, &noise) <= LOST;
                is_other |= pose.is_believed != is_believed;
                pose.is_believed = is_believed;
            }
            let shift = moved.rotation.angle() + moved.translation.vector.norm() / LEVER_MM;
            if !is_other && changed < 1e-3 && shift < 1e-7 {
                break;
            }
        }
        let (found, num_iterations) = latest.ok_or(SolveError::Diverged)?;
        let hessian = Track { poses: &poses, noise, mount }.sums(&sensor, |_| 1.0).hessian;
        Ok(Self { poses, noise, sensor, mount, hessian, num_iterations, converged: found.converged, start })
    }

    /// # Errors
    /// [`SolveError::Undetermined`] if a combination of the unknowns is free.
    pub fn into_solution(self, reference_distance_mm: Option<f64>, places: &[usize]) -> Result<Solution, SolveError> {
        let Self { poses, noise, sensor, mount, hessian, num_iterations, converged, start } = self;
        let all = pairs(&poses);
        let state = MotionState::with_mean_target(sensor, &all);
        let of_flange = of_flange(&poses);
        let span = rotation_span(&of_flange);
        let squares = Track { poses: &poses, noise, mount }.squares(&sensor);
        let num_independent = squares.len() / Track { poses: &poses, noise, mount }.steps_in_row();
        let tracked = tracked(&poses, &noise, &squares);
        let believed = || poses[1..].iter().filter(|pose| pose.is_believed);
        let step_std = |part: usize| stats::rms(believed().map(|pose| noise_std(pose, &noise, part)));
        let (target_rotation_std_rad, target_translation_std_mm) = (step_std(0), step_std(3));
        // The noise is judged by rows of steps.
        #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 steps")]
        let degrees_of_freedom = (3 * num_independent).saturating_sub(6) as f64;
        let reference_point = Vec3::new(0.0, 0.0, reference_distance_mm.unwrap_or(USUAL_DISTANCE_MM));
        let covariance = inverse_of(&hessian)? * doubt_in_the_noise(degrees_of_freedom);
        let reduced = TrackReduced::new(poses, noise, mount, sensor);
        let left_out_mm: Vec<Option<f64>> = reduced
            .without_each()
            .iter()
            .enumerate()
            .map(|(stretch, refit)| refit.map(|refit| reduced.off_mm(stretch, &refit.flange_from_sensor)))
            .collect();
        let in_sample: Vec<f64> =
            (0..reduced.num_stretches()).map(|stretch| reduced.off_mm(stretch, &sensor)).collect();
        let motion_poses = wandering(&state, &all, &reduced, places, &squares);
        let stations = stations(&motion_poses, &all, &reduced, &state, &left_out_mm);
        let mut warnings = Vec::new();
        if let Some(ratio) = start::inverted(&all, start::typical_mm(&start.state, &all)) {
            warnings.push(Warning::StreamInverted { ratio });
        }
        warnings.extend(rotation_warnings(span, &PoseGeometry::new(&of_flange)?));
        if !converged {
            warnings.push(Warning::NotConverged { num_iterations });
        }
        if let Some((stretch, error_mm, typical_mm)) = stands_out(&left_out_mm, &in_sample) {
            let label = reduced.label(stretch);
            warnings.push(Warning::StationStandsOut { label, error_mm, typical_mm });
        }
        let rms_max = |distances: &[f64]| RmsMax {
            rms_mm: stats::rms(distances.iter().copied()),
            max_mm: stats::max(distances.iter().copied()),
        };
        Ok(Solution {
            method: Method::Motion,
            mount,
            flange_from_sensor: Transform::from_rigid(sensor),
            target_in_base_mm: state.base_from_target.translation.vector,
            scatter: rms_max(&in_sample),
            leave_one_out: left_out_mm.iter().copied().collect::<Option<Vec<f64>>>().map(|errors| rms_max(&errors)),
            uncertainty: Some(of_sensor(&covariance, degrees_of_freedom, &sensor, reference_point)),
            stations,
            plate: None,
            rotation_span_rad: span,
            warnings,
            num_iterations,
            noise: Some(NoiseModel {
                position_std_mm: noise.position.sqrt(),
                orientation_std_rad: noise.orientation.sqrt(),
                station_position_std_mm: 0.0,
                station_orientation_std_rad: 0.0,
                is_stated: false,
                above_stated: None,
            }),
            radius: None,
            reduced: None,
            change_by_radius: Vector6::zeros(),
            workspace_point_by_radius: Vec3::zeros(),
            motion: Some(MotionFound {
                base_from_target: Transform::from_rigid(state.base_from_target),
                closed_forms: start.answers.iter().map(|answer| against(answer, &all, &state)).collect(),
                rotation_scatter_rad: stats::rms(motion_poses.iter().map(|pose| pose.off_rad.norm())),
                poses: motion_poses,
                rejected: Vec::new(),
                target_translation_std_mm,
                target_rotation_std_rad,
                tracked: Some(tracked),
                time_offset: None,
                data: MotionData::Track(reduced),
            }),
        })
    }
}

fn tracked(poses: &[TrackPose], noise: &TrackNoise, squares: &[(f64, Vector6<f64>)]) -> Tracked {
    let believed = || squares.iter().zip(&poses[1..]).filter(|(_, pose)| pose.is_believed).map(|(step, _)| step);
    let step_mm = |(_, error): &(f64, Vector6<f64>)| error.fixed_rows::<3>(3).norm();
    let step_rad = |(_, error): &(f64, Vector6<f64>)| error.fixed_rows::<3>(0).norm();
    Tracked {
        num_steps: squares.len(),
        num_lost: squares.len() - believed().count(),
        step_mm: RmsMax { rms_mm: stats::rms(believed().map(step_mm)), max_mm: stats::max(believed().map(step_mm)) },
        step_rms_rad: stats::rms(believed().map(step_rad)),
        rotation_std_factor: noise.rotation_factor.sqrt(),
        translation_std_factor: noise.translation_factor.sqrt(),
    }
}

/// What every pose says of the world's place: it wanders by the camera's drift.
fn wandering(
    state: &MotionState,
    all: &[PosePair],
    reduced: &TrackReduced,
    places: &[usize],
    squares: &[(f64, Vector6<f64>)],
) -> Vec<MotionPose> {
    all.iter()
        .zip(places)
        .enumerate()
        .map(|(idx, (pair, place))| {
            let errors = state.errors(pair);
            let base_from_sensor = errors.sensor_from_base.transpose();
            let step = idx.checked_sub(1);
            let stretch = reduced.stretch_of_step(step.unwrap_or(0));
            MotionPose {
                station: stretch,
                station_idx: stretch,
                capture_idx: *place,
                label: reduced.label(stretch),
                off_mm: base_from_sensor * errors.translation,
                off_rad: base_from_sensor * errors.rotation,
                normalised: step.map_or(0.0, |step| (squares[step].0 / 6.0).sqrt()),
            }
        })
        .collect()
}

/// One entry a stretch: the means over its poses.
fn stations(
    motion_poses: &[MotionPose],
    all: &[PosePair],
    reduced: &TrackReduced,
    state: &MotionState,
    left_out_mm: &[Option<f64>],
) -> Vec<StationSolution> {
    let target = state.base_from_target.translation.vector;
    let means: Vec<(Vec3, Vec3)> = (0..reduced.num_stretches())
        .map(|stretch| {
            let own = motion_poses.iter().zip(all).filter(|(pose, _)| pose.station == stretch);
            let (off, seen, count) =
                own.fold((Vec3::zeros(), Vec3::zeros(), 0.0), |(off, seen, count), (pose, pair)| {
                    (off + pose.off_mm, seen + pair.sensor_from_target.translation.vector, count + 1.0)
                });
            (off / count, seen / count)
        })
        .collect();
    #[expect(clippy::cast_precision_loss, reason = "a dozen stretches at most")]
    let mean_off = means.iter().map(|(off, _)| off).sum::<Vec3>() / means.len() as f64;
    means
        .iter()
        .zip(left_out_mm)
        .enumerate()
        .map(|(stretch, ((off_mm, in_sensor), left_out_mm))| StationSolution {
            station_idx: stretch,
            label: reduced.label(stretch),
            side: if in_sensor.y < 0.0 { Side::Minus } else { Side::Plus },
            side_cost_ratio: None,
            target_in_sensor_mm: *in_sensor,
            target_in_sensor_std_mm: None,
            target_in_base_mm: target + off_mm,
            error_from_first_mm: off_mm - means[0].0,
            error_from_mean_mm: off_mm - mean_off,
            leave_one_out_mm: *left_out_mm,
            sweep: None,
        })
        .collect()
}

/// The square of a step's error by its own noise alone, believed or not: what a lost step exceeds by far.
fn square_alone(pose: &TrackPose, error: &Vector6<f64>, noise: &TrackNoise) -> f64 {
    let (rotation, translation) = (noise_std(pose, noise, 0), noise_std(pose, noise, 3));
    let robot = [noise.orientation, noise.position + noise.orientation * LEVER_MM * LEVER_MM];
    error.fixed_rows::<3>(0).norm_squared() / (rotation.powi(2) + 2.0 * robot[0])
        + error.fixed_rows::<3>(3).norm_squared() / (translation.powi(2) + 2.0 * robot[1])
}

/// Root mean variance of a step about (or along) the three axes from `first` on.
fn noise_std(pose: &TrackPose, noise: &TrackNoise, first: usize) -> f64 {
    let factor = if first == 0 { noise.rotation_factor } else { noise.translation_factor };
    (pose.covariance.fixed_view::<3, 3>(first, first).trace() / 3.0 * factor).sqrt()
}

fn of_flange(poses: &[TrackPose]) -> Vec<Rigid> {
    poses.iter().map(|pose| pose.base_from_flange).collect()
}

/// The same as poses of the world in the camera, for closed forms and tables.
fn pairs(poses: &[TrackPose]) -> Vec<PosePair> {
    poses
        .iter()
        .enumerate()
        .map(|(station, pose)| PosePair {
            station,
            base_from_flange: pose.base_from_flange,
            sensor_from_target: pose.world_from_sensor.inverse(),
            information: Information::by_lever(LEVER_MM),
        })
        .collect()
}
