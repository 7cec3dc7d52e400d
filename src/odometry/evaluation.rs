//! A trajectory against the true one: absolute error (ATE) and relative error (RPE).
//!
//! # Source
//! J. Sturm et al., "A benchmark for the evaluation of RGB-D SLAM systems", 2012; details as the Python package evo has
//! them, whose numbers these are (`tests/clients/evo_check.py`).

use crate::geometry::{Rigid, Sensor, Transform, Vec3, World};

use super::rigid_motion;

/// A pose and its time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimedPose {
    /// Time, s.
    pub time_s: f64,
    /// Where the camera was.
    pub world_from_sensor: Transform<World, Sensor>,
}

/// Poses farther apart in time are not of the same moment, s.
pub const MOST_TIME_OFF_S: f64 = 0.01;

/// How far a trajectory is off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Evaluation {
    /// Poses compared.
    pub num_poses: usize,
    /// Root mean square distance of the positions after the best rigid motion (no scale) of one trajectory onto the other,
    /// mm; NaN where they lie on a line, about which that motion is not fixed.
    pub ate_rmse_mm: f64,
    /// Root mean square error of the motion from a pose to the next, mm.
    pub rpe_translation_rmse_mm: f64,
    /// The same of its rotation, rad.
    pub rpe_rotation_rmse_rad: f64,
}

/// Compares a trajectory with the truth; `None` where fewer than three poses are of the same moments.
#[must_use]
pub fn evaluate(truth: &[TimedPose], estimate: &[TimedPose]) -> Option<Evaluation> {
    let pairs = associated(truth, estimate);
    if pairs.len() < 3 {
        return None;
    }
    let positions = |of: fn(&(Rigid, Rigid)) -> &Rigid| -> Vec<Vec3> {
        pairs.iter().map(|pair| of(pair).translation.vector).collect()
    };
    let (true_mm, found_mm) = (positions(|pair| &pair.0), positions(|pair| &pair.1));
    let ate_rmse_mm = rigid_motion::dst_from_src(&true_mm, &found_mm).map_or(f64::NAN, |truth_from_estimate| {
        rms(true_mm.iter().zip(&found_mm).map(|(truth, found)| {
            let moved = truth_from_estimate.rotation * found + truth_from_estimate.translation.vector;
            (moved - truth).norm()
        }))
    });
    let errors: Vec<Rigid> = pairs
        .windows(2)
        .map(|pair| {
            let step = |from: &Rigid, to: &Rigid| from.inverse() * to;
            step(&pair[0].0, &pair[1].0).inverse() * step(&pair[0].1, &pair[1].1)
        })
        .collect();
    Some(Evaluation {
        num_poses: pairs.len(),
        ate_rmse_mm,
        rpe_translation_rmse_mm: rms(errors.iter().map(|error| error.translation.vector.norm())),
        rpe_rotation_rmse_rad: rms(errors.iter().map(|error| error.rotation.angle())),
    })
}

fn rms(values: impl IntoIterator<Item = f64>) -> f64 {
    crate::geometry::stats::rms(values)
}

/// Poses of the same moment: to each of the shorter list the nearest in time of the longer, if it is near enough.
fn associated(truth: &[TimedPose], estimate: &[TimedPose]) -> Vec<(Rigid, Rigid)> {
    let rigid = |pose: &TimedPose| *pose.world_from_sensor.rigid();
    let near = |list: &[TimedPose], time_s: f64| nearest_in_time(list, time_s).map(rigid);
    if estimate.len() > truth.len() {
        truth.iter().filter_map(|pose| Some((rigid(pose), near(estimate, pose.time_s)?))).collect()
    } else {
        estimate.iter().filter_map(|pose| Some((near(truth, pose.time_s)?, rigid(pose)))).collect()
    }
}

/// The pose of a list, rising in time, that is nearest to a moment, if it is near enough.
#[must_use]
pub fn nearest_in_time(list: &[TimedPose], time_s: f64) -> Option<&TimedPose> {
    let after = list.partition_point(|pose| pose.time_s < time_s);
    let off = |pose: &&TimedPose| (pose.time_s - time_s).abs();
    let before = after.checked_sub(1).and_then(|before| list.get(before));
    let nearest = before.into_iter().chain(list.get(after)).min_by(|a, b| off(a).total_cmp(&off(b)))?;
    (off(&nearest) <= MOST_TIME_OFF_S).then_some(nearest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::UnitQuaternion;

    /// A spiral, ten poses a second.
    fn spiral() -> Vec<TimedPose> {
        let pose = |idx: u32| {
            let time_s = f64::from(idx) / 10.0;
            let rotation = UnitQuaternion::from_euler_angles(0.1 * time_s, 0.2 * time_s, -0.3 * time_s);
            let position = Vec3::new(400.0 * time_s.cos(), 300.0 * time_s.sin(), 50.0 * time_s);
            TimedPose { time_s, world_from_sensor: Transform::from_parts(position, rotation) }
        };
        (0..60).map(pose).collect()
    }

    fn changed(change: impl Fn(usize, &mut Rigid)) -> Vec<TimedPose> {
        let mut poses = spiral();
        for (idx, pose) in poses.iter_mut().enumerate() {
            let mut rigid = *pose.world_from_sensor.rigid();
            change(idx, &mut rigid);
            pose.world_from_sensor = Transform::from_rigid(rigid);
        }
        poses
    }

    #[test]
    fn another_world_is_no_error() {
        let moved = Rigid::new(Vec3::new(1000.0, -200.0, 30.0), Vec3::new(0.4, 2.0, -0.3));
        let found = evaluate(&spiral(), &changed(|_, pose| *pose = moved * *pose)).expect("poses");
        assert_eq!(found.num_poses, 60);
        let errors = [found.ate_rmse_mm, found.rpe_translation_rmse_mm, found.rpe_rotation_rmse_rad];
        // Rounding of positions of a metre.
        assert!(errors.iter().all(|error| *error < 1e-6), "{found:?}");
    }

    #[test]
    fn errors_that_are_known_are_found() {
        // Every second pose is 1 mm off along the world's z: after alignment ± 0.5 mm, from pose to pose 1 mm.
        let found = evaluate(&spiral(), &changed(|idx, pose| pose.translation.z += f64::from(u8::from(idx % 2 == 0))));
        let found = found.expect("poses");
        assert!(
            (found.ate_rmse_mm - 0.5).abs() < 1e-3 && (found.rpe_translation_rmse_mm - 1.0).abs() < 1e-9,
            "{found:?}"
        );
        // Every second pose is turned by 0.01 rad about its own z.
        let found = evaluate(
            &spiral(),
            &changed(|idx, pose| {
                let angle = if idx % 2 == 0 { 0.01 } else { 0.0 };
                pose.rotation *= UnitQuaternion::from_axis_angle(&Vec3::z_axis(), angle);
            }),
        );
        let found = found.expect("poses");
        assert!((found.rpe_rotation_rmse_rad - 0.01).abs() < 1e-9 && found.ate_rmse_mm < 1e-6, "{found:?}");
    }

    #[test]
    fn poses_of_other_moments_are_left_out() {
        let truth = spiral();
        let mut later = spiral();
        for pose in &mut later {
            pose.time_s += 0.009;
        }
        assert_eq!(evaluate(&truth, &later).map(|found| found.num_poses), Some(60));
        for pose in &mut later {
            pose.time_s += 0.03;
        }
        assert_eq!(evaluate(&truth, &later), None);
        assert_eq!(evaluate(&truth, &truth[..2]), None);
        assert_eq!(evaluate(&truth, &truth[10..15]).map(|found| found.num_poses), Some(5));
        let line: Vec<TimedPose> = truth
            .iter()
            .map(|pose| TimedPose {
                world_from_sensor: Transform::from_parts(Vec3::x() * pose.time_s, UnitQuaternion::identity()),
                ..*pose
            })
            .collect();
        assert!(
            evaluate(&line, &line)
                .is_some_and(|found| found.ate_rmse_mm.is_nan() && found.rpe_rotation_rmse_rad < 1e-9)
        );
    }
}
