//! Two streams of poses with times: of the flange, and of a camera that tracks its own motion or sees a target.
//!
//! Data flows streams → their time offset, from the rotation speeds ([`super::time_offset`]) → the flange at the camera's times
//! → closed forms → least squares over the steps (`steps`), or over the poses as of a target → the offset refined along
//! with it → [`Solution`].

use nalgebra::{Matrix6, Vector6};

use crate::calibrate::plate::descent::inverse_of;
use crate::calibrate::rotation_start::{PoseGeometry, rotation_span};
use crate::calibrate::shared_warnings::rotation_warnings;
use crate::calibrate::uncertainty::{doubt_in_the_noise, of_sensor};
use crate::calibrate::{
    Capture, Method, MotionProblem, Mount, Noise, NoiseModel, Reading, RmsMax, Side, SideChoice, Solution, SolveError,
    Station, StationSolution, TargetNoise, Warning,
};
use crate::geometry::{Base, Flange, Rigid, Sensor, Transform, Vec3, World, stats};

use super::assemble::against;
use super::found::{MotionFound, MotionPose, TimeOffset, Tracked};
use super::measured::{LEVER_MM, MIN_POSES};
use super::pose::{Information, MotionState, PosePair};
use super::start;
use super::steps::{Track, TrackNoise, TrackPose, usual_covariance};
use super::time_offset::{self, Timed, at, coarse, interval_s, longest_gap_s};

/// A camera's pose with its time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraPose {
    /// When, s.
    pub time_s: f64,
    /// Where the camera was: in the frame of its first pose, or in that of a target.
    pub world_from_sensor: Transform<World, Sensor>,
    /// What the step from the pose before may be off by: covariance of (rotation, translation) along the camera's axes here,
    /// rad² and mm². `None` where nothing is known; it is found from the scatter then.
    pub step_covariance: Option<Matrix6<f64>>,
}

/// What the camera's poses are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weighing {
    /// They drift: each is the one before and a step.
    Drifting,
    /// Each is measured by itself, against a target that stands still.
    Independent,
}

/// A calibration from two streams.
#[derive(Clone, Debug, PartialEq)]
pub struct StreamProblem {
    /// Where the camera is.
    pub mount: Mount,
    /// Noise of the robot, where it is known.
    pub noise: Noise,
    /// The distance along z for which the headline accuracy is stated, mm; without it, half a metre.
    pub reference_distance_mm: Option<f64>,
    /// The flange's poses as the controller reports them, with times (s) that rise.
    pub flange: Vec<(f64, Transform<Base, Flange>)>,
    /// The camera's poses, with times that rise.
    pub camera: Vec<CameraPose>,
    /// What the camera's poses are.
    pub weighing: Weighing,
    /// Whether the two clocks may differ; if not, times are taken as they are.
    pub find_offset: bool,
}

/// The distance for which the headline is stated where nothing is known of the scene, mm.
const USUAL_DISTANCE_MM: f64 = 500.0;
/// A usual robot, where nothing is stated: position (mm), orientation (rad).
const USUAL_ROBOT: [f64; 2] = [0.05, 3e-4];
/// The square of a step's error beyond which the camera lost its way there; see [`super::rejection`].
const LOST: f64 = 45.0;
/// Noise and lost steps settle in a few rounds.
const MAX_ROUNDS: usize = 8;

/// Solves.
///
/// # Errors
/// [`SolveError`] if nothing can be computed from these streams.
pub fn solve_streams(problem: &StreamProblem) -> Result<Solution, SolveError> {
    let flange: Vec<Timed> = problem.flange.iter().map(|(time, pose)| (*time, *pose.rigid())).collect();
    let camera: Vec<Timed> = problem.camera.iter().map(|pose| (pose.time_s, *pose.world_from_sensor.rigid())).collect();
    let is_rising = |stream: &[Timed]| {
        stream.windows(2).all(|pair| pair[0].0 < pair[1].0) && stream.iter().all(|(time, _)| time.is_finite())
    };
    if !is_rising(&flange) || !is_rising(&camera) {
        return Err(SolveError::TimesNotRising);
    }
    let start_s = if problem.find_offset { coarse(&flange, &camera).unwrap_or(0.0) } else { 0.0 };
    let streams =
        Streams { problem, flange: &flange, longest_gap_s: longest_gap_s(&flange), interval_s: interval_s(&camera) };
    if !problem.find_offset {
        return streams.solve(None);
    }
    let step_s = 0.5 * interval_s(&camera).min(interval_s(&flange));
    let rough = streams.rough(start_s)?;
    let cost = |offset_s: f64| streams.cost(&rough, offset_s);
    match time_offset::refined(start_s, step_s, cost) {
        Some((offset_s, std_s)) => streams.solve(Some(TimeOffset { offset_s, std_s: Some(std_s) })),
        None => streams.solve(Some(TimeOffset { offset_s: start_s, std_s: None })),
    }
}

struct Streams<'a> {
    problem: &'a StreamProblem,
    flange: &'a [Timed],
    longest_gap_s: f64,
    /// Usual time between the camera's poses, s.
    interval_s: f64,
}

/// What is kept while the offset is sought: the weights, and which poses take part.
enum Rough {
    Drifting(Box<Settled>),
    Independent { noise: Noise, target_noise: TargetNoise, places: Vec<usize> },
}

/// The drifting track at one offset, once its noise has settled.
struct Settled {
    poses: Vec<TrackPose>,
    /// Places of the poses in the camera's stream.
    places: Vec<usize>,
    noise: TrackNoise,
    sensor: Rigid,
    hessian: Matrix6<f64>,
    num_iterations: usize,
    converged: bool,
    start: start::Start,
}

impl Streams<'_> {
    /// The camera's poses for which the flange's is known, the flange inverted for a fixed sensor.
    ///
    /// None within `margin_s` of an end of the flange's stream are taken.
    fn poses(&self, offset_s: f64, margin_s: f64) -> (Vec<TrackPose>, Vec<usize>) {
        let (mut poses, mut places) = (Vec::new(), Vec::new());
        // What was lost between poses that were left out is summed over them.
        let mut since = Matrix6::zeros();
        for (place, camera) in self.problem.camera.iter().enumerate() {
            since += camera.step_covariance.unwrap_or_else(usual_covariance);
            let time_s = camera.time_s + offset_s;
            let is_inside = |shift_s: f64| at(self.flange, time_s + shift_s, self.longest_gap_s).is_some();
            let Some(flange) = at(self.flange, time_s, self.longest_gap_s) else { continue };
            if margin_s > 0.0 && !(is_inside(margin_s) && is_inside(-margin_s)) {
                continue;
            }
            poses.push(TrackPose {
                base_from_flange: match self.problem.mount {
                    Mount::OnFlange => flange,
                    Mount::Fixed => flange.inverse(),
                },
                world_from_sensor: *camera.world_from_sensor.rigid(),
                covariance: std::mem::replace(&mut since, Matrix6::zeros()),
                is_believed: true,
            });
            places.push(place);
        }
        (poses, places)
    }

    fn settled(&self, mut poses: Vec<TrackPose>, places: Vec<usize>) -> Result<Settled, SolveError> {
        if poses.len() < MIN_POSES {
            return Err(SolveError::TooFewStations { found: poses.len(), needed: MIN_POSES, refusal: None });
        }
        let of_flange: Vec<Rigid> = poses.iter().map(|pose| pose.base_from_flange).collect();
        PoseGeometry::new(&of_flange)?;
        let start = start::start(&pairs(&poses))?;
        let std = |stated: Option<f64>, usual: f64| stated.unwrap_or(usual).powi(2);
        let mut noise = TrackNoise {
            position: std(self.problem.noise.position_std_mm, USUAL_ROBOT[0]),
            orientation: std(self.problem.noise.orientation_std_rad, USUAL_ROBOT[1]),
            rotation_factor: 1.0,
            translation_factor: 1.0,
        };
        let mut sensor = start.state.flange_from_sensor;
        let mount = self.problem.mount;
        let mut latest = None;
        for round in 1..=MAX_ROUNDS {
            let track = Track { poses: &poses, noise, mount };
            let found = track.minimise(sensor)?;
            let moved = sensor.inverse() * found.unknowns.0;
            sensor = found.unknowns.0;
            latest = Some((found, round));
            let [rotation_factor, translation_factor] = track.factors(&sensor);
            let changed = (rotation_factor / noise.rotation_factor - 1.0).abs()
                + (translation_factor / noise.translation_factor - 1.0).abs();
            noise = TrackNoise { rotation_factor, translation_factor, ..noise };
            let squares = Track { poses: &poses, noise, mount }.squares(&sensor);
            let mut is_other = false;
            for (pose, (_, error)) in poses[1..].iter_mut().zip(&squares) {
                // A step that is not believed now is looked at as if it were.
                let as_believed = TrackPose { is_believed: true, ..*pose };
                let square = square_alone(&as_believed, error, &noise);
                is_other |= pose.is_believed == (square > LOST);
                pose.is_believed = square <= LOST;
            }
            let shift = moved.rotation.angle() + moved.translation.vector.norm() / LEVER_MM;
            if !is_other && changed < 1e-3 && shift < 1e-7 {
                break;
            }
        }
        let (found, num_iterations) = latest.ok_or(SolveError::Diverged)?;
        let hessian = Track { poses: &poses, noise, mount }.sums(&sensor).hessian;
        Ok(Settled { poses, places, noise, sensor, hessian, num_iterations, converged: found.converged, start })
    }

    fn rough(&self, offset_s: f64) -> Result<Rough, SolveError> {
        // At the ends of the streams a shift must not lose poses, or costs could not be compared.
        let margin_s = 2.0 * interval_s(self.flange).max(self.interval_s);
        let (poses, places) = self.poses(offset_s, margin_s);
        Ok(match self.problem.weighing {
            Weighing::Drifting => Rough::Drifting(Box::new(self.settled(poses, places)?)),
            Weighing::Independent => {
                let solution = super::solve(&self.as_targets(&poses, &places))?;
                let of_robot = solution.noise.ok_or(SolveError::Diverged)?;
                let motion = solution.motion.ok_or(SolveError::Diverged)?;
                let is_used = |place: &usize| motion.poses.iter().any(|pose| pose.station_idx == *place);
                Rough::Independent {
                    noise: Noise {
                        position_std_mm: Some(of_robot.position_std_mm),
                        orientation_std_rad: Some(of_robot.orientation_std_rad),
                    },
                    target_noise: TargetNoise {
                        translation_std_mm: Some(motion.target_translation_std_mm),
                        rotation_std_rad: Some(motion.target_rotation_std_rad),
                    },
                    places: places.into_iter().filter(is_used).collect(),
                }
            }
        })
    }

    /// The least sum of squares at another offset, with the same weights and the same poses.
    fn cost(&self, rough: &Rough, offset_s: f64) -> Option<f64> {
        let (poses, places) = self.poses(offset_s, 0.0);
        let of_place = |wanted: &usize| places.binary_search(wanted).ok().map(|idx| poses[idx]);
        match rough {
            Rough::Drifting(settled) => {
                let kept = settled.places.iter().zip(&settled.poses).map(|(place, as_settled)| {
                    let moved = of_place(place)?;
                    Some(TrackPose { base_from_flange: moved.base_from_flange, ..*as_settled })
                });
                let poses: Vec<TrackPose> = kept.collect::<Option<_>>()?;
                let track = Track { poses: &poses, noise: settled.noise, mount: self.problem.mount };
                Some(track.minimise(settled.sensor).ok()?.sums.cost)
            }
            Rough::Independent { noise, target_noise, places: wanted } => {
                let poses: Vec<TrackPose> = wanted.iter().map(of_place).collect::<Option<_>>()?;
                let problem =
                    MotionProblem { noise: *noise, target_noise: *target_noise, ..self.as_targets(&poses, wanted) };
                super::least_squares(&problem).ok()
            }
        }
    }

    fn solve(&self, offset: Option<TimeOffset>) -> Result<Solution, SolveError> {
        let offset_s = offset.map_or(0.0, |offset| offset.offset_s);
        let (poses, places) = self.poses(offset_s, 0.0);
        let mut solution = match self.problem.weighing {
            Weighing::Drifting => self.of_track(self.settled(poses, places)?)?,
            Weighing::Independent => super::solve(&self.as_targets(&poses, &places))?,
        };
        if let Some(motion) = &mut solution.motion {
            motion.time_offset = offset;
        }
        if offset.is_some_and(|offset| offset.std_s.is_none()) {
            solution.warnings.push(Warning::TimeOffsetUnknown);
        }
        Ok(solution)
    }

    /// The same as stations that see a target.
    fn as_targets(&self, poses: &[TrackPose], places: &[usize]) -> MotionProblem {
        let station = |(pose, place): (&TrackPose, &usize)| Station {
            idx: *place,
            label: (place + 1).to_string(),
            side: SideChoice::Auto,
            captures: vec![Capture {
                base_from_flange: Transform::from_rigid(pose.base_from_flange),
                commanded_travel_mm: None,
                reading: Reading::Pose(Transform::from_rigid(pose.world_from_sensor.inverse())),
            }],
        };
        MotionProblem {
            mount: self.problem.mount,
            noise: self.problem.noise,
            target_noise: TargetNoise::default(),
            reference_distance_mm: self.problem.reference_distance_mm,
            stations: poses.iter().zip(places).map(station).collect(),
        }
    }

    fn of_track(&self, settled: Settled) -> Result<Solution, SolveError> {
        let Settled { poses, places, noise, sensor, hessian, num_iterations, converged, start } = settled;
        let all = pairs(&poses);
        let state = MotionState::with_mean_target(sensor, &all);
        let track = Track { poses: &poses, noise, mount: self.problem.mount };
        let of_flange: Vec<Rigid> = poses.iter().map(|pose| pose.base_from_flange).collect();
        let span = rotation_span(&of_flange);
        let num_believed = poses[1..].iter().filter(|pose| pose.is_believed).count();
        #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 steps")]
        let degrees_of_freedom = (3 * num_believed).saturating_sub(6) as f64;
        let reference_point = Vec3::new(0.0, 0.0, self.problem.reference_distance_mm.unwrap_or(USUAL_DISTANCE_MM));
        let covariance = inverse_of(&hessian)? * doubt_in_the_noise(degrees_of_freedom);
        let uncertainty = of_sensor(&covariance, degrees_of_freedom, &sensor, reference_point);
        let squares = track.squares(&sensor);
        let believed = || squares.iter().zip(&poses[1..]).filter(|(_, pose)| pose.is_believed).map(|(step, _)| step);
        let step_mm = |(_, error): &(f64, Vector6<f64>)| error.fixed_rows::<3>(3).norm();
        let step_rad = |(_, error): &(f64, Vector6<f64>)| error.fixed_rows::<3>(0).norm();
        let tracked = Tracked {
            num_steps: squares.len(),
            num_lost: squares.len() - num_believed,
            step_mm: RmsMax {
                rms_mm: stats::rms(believed().map(step_mm)),
                max_mm: stats::max(believed().map(step_mm)),
            },
            step_rms_rad: stats::rms(believed().map(step_rad)),
            rotation_std_factor: noise.rotation_factor.sqrt(),
            translation_std_factor: noise.translation_factor.sqrt(),
        };
        let mut warnings = Vec::new();
        if let Some(ratio) = start::inverted(&all, start::typical_mm(&start.state, &all)) {
            warnings.push(Warning::StreamInverted { ratio });
        }
        warnings.extend(rotation_warnings(span, &PoseGeometry::new(&of_flange)?));
        if !converged {
            warnings.push(Warning::NotConverged { num_iterations });
        }
        let motion_poses = wandering(&state, &all, &places, &squares);
        let target = state.base_from_target.translation.vector;
        let stations = stations_of(&motion_poses, &all, target);
        let step_std = |idx: usize| stats::rms(poses[1..].iter().map(|pose| noise_std(pose, &noise, idx)));
        Ok(Solution {
            method: Method::Motion,
            mount: self.problem.mount,
            flange_from_sensor: Transform::from_rigid(sensor),
            target_in_base_mm: target,
            scatter: RmsMax {
                rms_mm: stats::rms(motion_poses.iter().map(|pose| pose.off_mm.norm())),
                max_mm: stats::max(motion_poses.iter().map(|pose| pose.off_mm.norm())),
            },
            leave_one_out: None,
            uncertainty: Some(uncertainty),
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
                is_stated: self.problem.noise.position_std_mm.is_some()
                    && self.problem.noise.orientation_std_rad.is_some(),
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
                target_translation_std_mm: step_std(3),
                target_rotation_std_rad: step_std(0),
                tracked: Some(tracked),
                time_offset: None,
                reduced: None,
            }),
        })
    }
}

/// What every pose says of the world's place: it wanders by the camera's drift.
fn wandering(
    state: &MotionState,
    all: &[PosePair],
    places: &[usize],
    squares: &[(f64, Vector6<f64>)],
) -> Vec<MotionPose> {
    all.iter()
        .zip(places)
        .map(|(pair, place)| {
            let errors = state.errors(pair);
            let base_from_sensor = errors.sensor_from_base.transpose();
            MotionPose {
                station: pair.station,
                station_idx: *place,
                capture_idx: 0,
                label: (place + 1).to_string(),
                off_mm: base_from_sensor * errors.translation,
                off_rad: base_from_sensor * errors.rotation,
                normalised: match pair.station {
                    0 => 0.0,
                    step => (squares[step - 1].0 / 6.0).sqrt(),
                },
            }
        })
        .collect()
}

/// One entry a pose.
fn stations_of(motion_poses: &[MotionPose], all: &[PosePair], target: Vec3) -> Vec<StationSolution> {
    motion_poses
        .iter()
        .zip(all)
        .map(|(pose, pair)| {
            let in_sensor = pair.sensor_from_target.translation.vector;
            StationSolution {
                station_idx: pose.station_idx,
                label: pose.label.clone(),
                side: if in_sensor.y < 0.0 { Side::Minus } else { Side::Plus },
                side_cost_ratio: None,
                target_in_sensor_mm: in_sensor,
                target_in_sensor_std_mm: None,
                target_in_base_mm: target + pose.off_mm,
                error_from_first_mm: pose.off_mm - motion_poses[0].off_mm,
                // The target's place is the mean of all.
                error_from_mean_mm: pose.off_mm,
                leave_one_out_mm: None,
                sweep: None,
            }
        })
        .collect()
}

/// The square of a step's error by its own noise alone: what a lost step exceeds by far.
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
