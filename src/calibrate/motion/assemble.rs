//! From a minimum to a solution: the target at each station, the closed forms beside it, validation, uncertainty and warnings.

use nalgebra::Vector6;

use crate::calibrate::plate::descent::inverse_of;
use crate::calibrate::rotation_start::{PoseGeometry, rotation_span};
use crate::calibrate::shared_warnings::{refused_captures, rotation_warnings, stands_out};
use crate::calibrate::uncertainty::{doubt_in_the_noise, of_sensor, point_by_sensor};
use crate::calibrate::{
    Method, MotionProblem, RmsMax, Side, Solution, SolveError, StationSolution, Uncertainty, Warning,
};
use crate::geometry::{Rigid, Transform, Vec3, stats};

use super::found::{Answered, ClosedFormAnswer, MotionData, MotionFound, MotionPose, RejectedPose};
use super::measured::{MIN_POSES, Measured};
use super::noise::MotionNoise;
use super::pose::{MotionState, NUM_UNKNOWNS, PosePair, sensor_block, sums_of};
use super::reduced::{MotionReduced, MotionRefit};
use super::rejection::{Agreed, fault_of};
use super::scale::scale;
use super::start::Answer;

/// Poses that make the figures trustworthy.
const RECOMMENDED_POSES: usize = 10;
/// With fewer than this a warning is due.
const FEW_BELOW: usize = 6;
/// A factor on the target's translations this many σ from 1 …
const SCALE_AT_STDS: f64 = 5.0;
/// … and this far is no chance: a print that shrank by less is within what boards are sold with.
const SCALE_OFF: f64 = 0.003;

/// Everything that a solution is made from.
pub(super) struct Found<'a> {
    pub problem: &'a MotionProblem,
    pub geometry: PoseGeometry,
    pub answers: Vec<Answer>,
    pub agreed: Agreed<'a>,
    pub warnings: Vec<Warning>,
}

impl Found<'_> {
    /// # Errors
    /// [`SolveError::Undetermined`] if a combination of the unknowns is free.
    pub fn into_solution(mut self) -> Result<Solution, SolveError> {
        let Agreed { settled, used, rejected } = &self.agreed;
        let state = settled.minimum.unknowns;
        let covariance = inverse_of(&settled.minimum.sums.hessian)?;
        let (poses, places) = renumbered(used, &settled.poses);
        let reduced = MotionReduced { poses, num_stations: places.len(), state };
        let left_out = reduced.without_each();
        let left_out_mm: Vec<Option<f64>> = left_out
            .iter()
            .enumerate()
            .map(|(station, refit)| refit.map(|MotionRefit { state, .. }| reduced.off_mm(station, &state)))
            .collect();
        let in_sample: Vec<f64> = (0..places.len()).map(|station| reduced.off_mm(station, &state)).collect();
        let robot_poses: Vec<Rigid> = reduced.poses.iter().map(|pose| pose.base_from_flange).collect();
        let span = rotation_span(&robot_poses);
        let reference_point = self.reference_point(&reduced.poses);
        let uncertainty = if 6 * reduced.poses.len() > NUM_UNKNOWNS {
            let by_sensor = point_by_sensor(reference_point);
            let degrees_of_freedom = settled.noise.degrees_of_freedom(|noise: &MotionNoise| {
                let weighed = noise.weighed(used, &state);
                let covariance = sensor_block(&inverse_of(&sums_of(&weighed, &state, |_| 1.0).hessian)?);
                Ok((by_sensor * covariance * by_sensor.transpose()).trace())
            })?;
            Some(of_sensor(
                &(sensor_block(&covariance) * doubt_in_the_noise(degrees_of_freedom)),
                degrees_of_freedom,
                &state.flange_from_sensor,
                reference_point,
            ))
        } else {
            None
        };
        let rejected: Vec<RejectedPose> = rejected
            .iter()
            .map(|measured| {
                let square = |pose: &PosePair| {
                    let measured = Measured { pose: *pose, ..measured.clone() };
                    let weighed = settled.noise.weighed(std::slice::from_ref(&measured), &state);
                    weighed.iter().map(|pose| pose.information.square(&state.errors(pose))).sum()
                };
                let (fault, off_mm, off_rad) = fault_of(&measured.pose, &state, square);
                RejectedPose {
                    station_idx: measured.station.idx,
                    capture_idx: measured.capture_idx,
                    label: measured.station.label.clone(),
                    off_mm,
                    off_rad,
                    fault,
                }
            })
            .collect();
        let motion_poses: Vec<MotionPose> =
            used.iter().zip(&reduced.poses).map(|(measured, pose)| motion_pose(measured, pose, &state)).collect();
        let all: Vec<PosePair> = used.iter().map(|measured| measured.pose).collect();
        let closed_forms = self.answers.iter().map(|answer| against(answer, &all, &state)).collect();
        let [target_translation_std_mm, target_rotation_std_rad] = settled.noise.of_target();
        let motion = MotionFound {
            base_from_target: Transform::from_rigid(state.base_from_target),
            closed_forms,
            rotation_scatter_rad: stats::rms(motion_poses.iter().map(|pose| pose.off_rad.norm())),
            poses: motion_poses,
            rejected,
            target_translation_std_mm,
            target_rotation_std_rad,
            tracked: None,
            time_offset: None,
            data: MotionData::Poses(reduced.clone()),
        };
        let stations = stations(used, &places, &motion, &left_out_mm);
        let (noise, converged, num_iterations) =
            (settled.noise.model(), settled.minimum.converged, settled.minimum.num_iterations);
        self.add_warnings(span, converged, num_iterations, &motion, &reduced, uncertainty.as_ref());
        if let Some((station, error_mm, typical_mm)) = stands_out(&left_out_mm, &in_sample) {
            let label = stations[station].label.clone();
            self.warnings.push(Warning::StationStandsOut { label, error_mm, typical_mm });
        }
        let rms_max = |distances: &[f64]| RmsMax {
            rms_mm: stats::rms(distances.iter().copied()),
            max_mm: stats::max(distances.iter().copied()),
        };
        Ok(Solution {
            method: Method::Motion,
            mount: self.problem.mount,
            flange_from_sensor: Transform::from_rigid(state.flange_from_sensor),
            target_in_base_mm: state.base_from_target.translation.vector,
            scatter: rms_max(&in_sample),
            leave_one_out: left_out_mm.iter().copied().collect::<Option<Vec<f64>>>().map(|errors| rms_max(&errors)),
            uncertainty,
            stations,
            plate: None,
            motion: Some(motion),
            rotation_span_rad: span,
            warnings: self.warnings,
            num_iterations,
            noise: Some(noise),
            radius: None,
            reduced: None,
            change_by_radius: Vector6::zeros(),
            workspace_point_by_radius: Vec3::zeros(),
        })
    }

    fn reference_point(&self, poses: &[PosePair]) -> Vec3 {
        let seen = || poses.iter().map(|pose| pose.sensor_from_target.translation.vector);
        self.problem.reference_distance_mm.map_or_else(
            || {
                #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 poses")]
                let scale = 1.0 / poses.len() as f64;
                seen().sum::<Vec3>() * scale
            },
            // A distance has no sign; the targets tell on which side of its origin the sensor looks.
            |distance| Vec3::new(0.0, 0.0, distance.copysign(seen().map(|place| place.z).sum())),
        )
    }

    fn add_warnings(
        &mut self,
        span_rad: f64,
        converged: bool,
        num_iterations: usize,
        motion: &MotionFound,
        reduced: &MotionReduced,
        uncertainty: Option<&Uncertainty>,
    ) {
        let num_stations = reduced.num_stations;
        if num_stations < FEW_BELOW {
            self.warnings.push(Warning::FewStations { num_stations, recommended: RECOMMENDED_POSES });
        }
        self.warnings.extend(rotation_warnings(span_rad, &self.geometry));
        if !converged {
            self.warnings.push(Warning::NotConverged { num_iterations });
        }
        for rejected in &motion.rejected {
            self.warnings.push(Warning::PoseRejected {
                label: rejected.label.clone(),
                capture_idx: rejected.capture_idx,
                off_mm: rejected.off_mm,
                off_deg: rejected.off_rad.to_degrees(),
                fault: rejected.fault,
            });
        }
        // Poses that are read the wrong way round have no size.
        let is_inverted = self.warnings.iter().any(|warning| matches!(warning, Warning::StreamInverted { .. }));
        let doubt = uncertainty.map_or(1.0, |known| doubt_in_the_noise(known.degrees_of_freedom).sqrt());
        if num_stations > MIN_POSES + 1
            && !is_inverted
            && let Some((factor, std)) = scale(&reduced.poses, &reduced.state, doubt)
            && (factor - 1.0).abs() > SCALE_OFF
            && (factor - 1.0).abs() > SCALE_AT_STDS * std
            // A size that may as well be none tells of another fault.
            && factor > SCALE_AT_STDS * std
        {
            self.warnings.push(Warning::TargetScale { factor, std });
        }
        self.warnings.extend(refused_captures(&self.problem.stations));
    }
}

/// The poses with stations counted anew, without those of which nothing is used; and for each station its first pose.
fn renumbered(used: &[Measured<'_>], poses: &[PosePair]) -> (Vec<PosePair>, Vec<usize>) {
    let mut places: Vec<usize> = Vec::new();
    let mut renumbered: Vec<PosePair> = Vec::with_capacity(poses.len());
    for (idx, pose) in poses.iter().enumerate() {
        let is_new = places.last().is_none_or(|first| used[*first].pose.station != pose.station);
        if is_new {
            places.push(idx);
        }
        renumbered.push(PosePair { station: places.len() - 1, ..*pose });
    }
    (renumbered, places)
}

fn motion_pose(measured: &Measured<'_>, pose: &PosePair, state: &MotionState) -> MotionPose {
    let errors = state.errors(pose);
    let base_from_sensor = errors.sensor_from_base.transpose();
    MotionPose {
        station: pose.station,
        station_idx: measured.station.idx,
        capture_idx: measured.capture_idx,
        label: measured.station.label.clone(),
        off_mm: base_from_sensor * errors.translation,
        off_rad: base_from_sensor * errors.rotation,
        normalised: (pose.information.square(&errors) / 6.0).sqrt(),
    }
}

pub(super) fn against(answer: &Answer, poses: &[PosePair], refined: &MotionState) -> ClosedFormAnswer {
    let answered = answer.flange_from_sensor.map(|sensor| {
        let state = MotionState::with_mean_target(sensor, poses);
        Answered {
            flange_from_sensor: Transform::from_rigid(sensor),
            off_mm: (sensor.translation.vector - refined.flange_from_sensor.translation.vector).norm(),
            off_rad: sensor.rotation.angle_to(&refined.flange_from_sensor.rotation),
            residual_mm: stats::rms(poses.iter().map(|pose| state.errors(pose).translation.norm())),
            residual_rad: stats::rms(poses.iter().map(|pose| state.errors(pose).rotation.norm())),
        }
    });
    ClosedFormAnswer { form: answer.form, answer: answered }
}

/// One entry a station: the target's origin by its poses.
fn stations(
    used: &[Measured<'_>],
    places: &[usize],
    motion: &MotionFound,
    left_out_mm: &[Option<f64>],
) -> Vec<StationSolution> {
    let target = motion.base_from_target.translation_mm();
    let seen: Vec<Vec3> = (0..places.len())
        .map(|station| {
            let own = motion.poses.iter().filter(|pose| pose.station == station);
            let (sum, count) = own.fold((Vec3::zeros(), 0.0), |(sum, count), pose| (sum + pose.off_mm, count + 1.0));
            target + sum / count
        })
        .collect();
    #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 stations")]
    let mean = seen.iter().sum::<Vec3>() / seen.len() as f64;
    places
        .iter()
        .enumerate()
        .map(|(station, first)| {
            let measured = &used[*first];
            let in_sensor = measured.pose.sensor_from_target.translation.vector;
            StationSolution {
                station_idx: measured.station.idx,
                label: measured.station.label.clone(),
                side: if in_sensor.y < 0.0 { Side::Minus } else { Side::Plus },
                side_cost_ratio: None,
                target_in_sensor_mm: in_sensor,
                target_in_sensor_std_mm: None,
                target_in_base_mm: seen[station],
                error_from_first_mm: seen[station] - seen[0],
                error_from_mean_mm: seen[station] - mean,
                leave_one_out_mm: left_out_mm[station],
                sweep: None,
            }
        })
        .collect()
}
