//! Two streams of poses with times: of the flange, and of a camera that tracks its own motion or sees a target.
//!
//! Data flows streams → their time offset, from the rotation speeds ([`super::time_offset`]) → the flange at the camera's times
//! → closed forms → least squares over the steps (`track`), or over the poses as of a target → the offset refined along
//! with it → [`Solution`].

use nalgebra::{Matrix6, Vector6};

use crate::calibrate::{
    Capture, MotionProblem, Mount, Noise, Reading, SideChoice, Solution, SolveError, Station, TargetNoise, Uncertainty,
    Warning,
};
use crate::geometry::{Base, Flange, Rigid, Sensor, Transform, World, se3};

use super::found::TimeOffset;
use super::steps::{Track, TrackPose, is_known, usual_covariance};
use super::time_offset::{self, Timed, at, coarse, interval_s, longest_gap_s};
use super::track::Settled;

/// A camera's pose with its time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraPose {
    /// When, s.
    pub time_s: f64,
    /// Where the camera was: in the frame of its first pose, or in that of a target.
    pub world_from_sensor: Transform<World, Sensor>,
    /// What the step from the pose before may be off by: covariance of (rotation, translation) along the camera's axes here,
    /// rad² and mm², [`super::UNKNOWN_STEP`] over a gap. `None` where nothing is stated; it is found from the scatter then.
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

/// The offset is moved at most so often.
const MAX_ROUNDS: usize = 6;
/// Offsets this many σ apart are compared, where the motion is not too fast for that.
const REACH_STDS: f64 = 20.0;
/// A longer reach is not made longer still, s.
const LONGEST_REACH_S: f64 = 0.1;

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
    let streams = Streams {
        problem,
        flange: &flange,
        longest_gap_s: longest_gap_s(&flange),
        interval_s: interval_s(&flange).max(interval_s(&camera)),
    };
    if !problem.find_offset {
        return streams.solve(None);
    }
    let start_s = coarse(&flange, &camera).unwrap_or(0.0);
    let unknown = Offset { clocks: TimeOffset { offset_s: start_s, std_s: None }, change: Vector6::zeros() };
    streams.solve(Some(streams.offset(start_s).unwrap_or(unknown)))
}

/// By how much the clocks differ, and what hangs on it.
#[derive(Clone, Copy)]
struct Offset {
    clocks: TimeOffset,
    /// How the calibration follows it: a right perturbation (rotation, translation) a second.
    change: Vector6<f64>,
}

struct Streams<'a> {
    problem: &'a StreamProblem,
    flange: &'a [Timed],
    longest_gap_s: f64,
    /// The longer one of the usual times between poses, s.
    interval_s: f64,
}

/// What is kept while the offset is sought: the weights, and which poses take part.
enum Rough {
    Drifting { settled: Box<Settled>, places: Vec<usize> },
    Independent { noise: Noise, target_noise: TargetNoise, places: Vec<usize> },
}

impl Streams<'_> {
    /// The offset near a start, if the data tell it.
    fn offset(&self, start_s: f64) -> Option<Offset> {
        let mut start_s = start_s;
        let mut reach_s = time_offset::reach_s(self.flange);
        let mut latest = None;
        for _ in 0..MAX_ROUNDS {
            // Poses near the ends take no part here; without them there may be too few.
            let Ok(rough) = self.rough(start_s, reach_s) else { break };
            let minimum = |offset_s: f64| self.minimum(&rough, offset_s);
            let found = time_offset::refined(start_s, reach_s, |offset_s| Some(minimum(offset_s)?.0));
            let is_far = |std_s: f64| reach_s > REACH_STDS * std_s || reach_s > LONGEST_REACH_S;
            match found {
                Some((offset_s, std_s)) if is_far(std_s) => {
                    let around = [-reach_s, reach_s].map(|step_s| minimum(offset_s + step_s));
                    let [Some((_, before)), Some((_, after))] = around else { return None };
                    let change = se3::log(&(before.inverse() * after)) / (2.0 * reach_s);
                    latest = Some(Offset { clocks: TimeOffset { offset_s, std_s: Some(std_s) }, change });
                    // Weights and lost steps are those of the start.
                    if (offset_s - start_s).abs() < std_s {
                        break;
                    }
                    start_s = offset_s;
                }
                _ if reach_s > LONGEST_REACH_S => break,
                _ => {
                    start_s = found.map_or(start_s, |(offset_s, _)| offset_s);
                    reach_s *= 2.0;
                }
            }
        }
        latest
    }

    /// The camera's poses for which the flange's is known, the flange inverted for a fixed sensor; and their places in the
    /// camera's stream.
    ///
    /// None within `margin_s` of an end of the flange's stream are taken.
    fn poses(&self, offset_s: f64, margin_s: f64) -> (Vec<TrackPose>, Vec<usize>) {
        let (mut poses, mut places) = (Vec::new(), Vec::new());
        // What was lost between poses that were left out is summed over them, along the axes of the last.
        let mut since = Matrix6::zeros();
        let mut before: Option<Rigid> = None;
        for (place, camera) in self.problem.camera.iter().enumerate() {
            let here = *camera.world_from_sensor.rigid();
            if let Some(before) = before.replace(here) {
                let by_before = se3::adjoint(&(here.inverse() * before));
                since = by_before * since * by_before.transpose();
            }
            since += camera.step_covariance.unwrap_or_else(usual_covariance);
            let time_s = camera.time_s + offset_s;
            let is_inside = |shift_s: f64| at(self.flange, time_s + shift_s, self.longest_gap_s).is_some();
            let Some(flange) = at(self.flange, time_s, self.longest_gap_s) else { continue };
            if margin_s > 0.0 && !(is_inside(margin_s) && is_inside(-margin_s)) {
                continue;
            }
            let covariance = std::mem::replace(&mut since, Matrix6::zeros());
            poses.push(TrackPose {
                time_s: camera.time_s,
                base_from_flange: match self.problem.mount {
                    Mount::OnFlange => flange,
                    Mount::Fixed => flange.inverse(),
                },
                world_from_sensor: here,
                covariance,
                is_believed: is_known(&covariance),
            });
            places.push(place);
        }
        (poses, places)
    }

    fn rough(&self, offset_s: f64, reach_s: f64) -> Result<Rough, SolveError> {
        // At the ends of the streams a shift must not lose poses, or costs could not be compared.
        let (poses, places) = self.poses(offset_s, reach_s + 2.0 * self.interval_s);
        Ok(match self.problem.weighing {
            Weighing::Drifting => {
                let settled = Settled::of(poses, self.problem.mount, self.problem.noise)?;
                Rough::Drifting { settled: Box::new(settled), places }
            }
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

    /// The least sum of squares at another offset, with the same weights and the same poses, and the sensor on the flange there.
    fn minimum(&self, rough: &Rough, offset_s: f64) -> Option<(f64, Rigid)> {
        let (poses, places) = self.poses(offset_s, 0.0);
        let of_place = |wanted: &usize| places.binary_search(wanted).ok().map(|idx| poses[idx]);
        match rough {
            Rough::Drifting { settled, places: wanted } => {
                let kept = wanted.iter().zip(&settled.poses).map(|(place, as_settled)| {
                    let moved = of_place(place)?;
                    Some(TrackPose { base_from_flange: moved.base_from_flange, ..*as_settled })
                });
                let poses: Vec<TrackPose> = kept.collect::<Option<_>>()?;
                let track = Track { poses: &poses, noise: settled.noise, mount: self.problem.mount };
                let found = track.minimise(settled.sensor, |_| 1.0).ok()?;
                Some((found.sums.cost, found.unknowns.0))
            }
            Rough::Independent { noise, target_noise, places: wanted } => {
                let poses: Vec<TrackPose> = wanted.iter().map(of_place).collect::<Option<_>>()?;
                let problem =
                    MotionProblem { noise: *noise, target_noise: *target_noise, ..self.as_targets(&poses, wanted) };
                let found = super::least_squares(&problem).ok()?;
                Some((found.sums.cost, found.unknowns.flange_from_sensor))
            }
        }
    }

    fn solve(&self, offset: Option<Offset>) -> Result<Solution, SolveError> {
        let offset_s = offset.map_or(0.0, |offset| offset.clocks.offset_s);
        let (poses, places) = self.poses(offset_s, 0.0);
        let mut solution = match self.problem.weighing {
            Weighing::Drifting => Settled::of(poses, self.problem.mount, self.problem.noise)?
                .into_solution(self.problem.reference_distance_mm, &places)?,
            Weighing::Independent => super::solve(&self.as_targets(&poses, &places))?,
        };
        let Some(Offset { clocks, change }) = offset else { return Ok(solution) };
        if let Some(motion) = &mut solution.motion {
            motion.time_offset = Some(clocks);
        }
        match clocks.std_s {
            // What is not known of the offset is not known of the calibration.
            Some(std_s) => {
                let sensor = solution.flange_from_sensor.rigid();
                let with_offset = |known: &Uncertainty| known.with_change(&(change * std_s), sensor);
                solution.uncertainty = solution.uncertainty.as_ref().map(with_offset);
            }
            None => solution.warnings.push(Warning::TimeOffsetUnknown),
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
}
