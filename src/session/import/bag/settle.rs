//! Poses over time: the one between two, and the times at which the robot stood still.

use std::ops::Range;

use nalgebra::{Quaternion, UnitQuaternion};

use crate::geometry::{Vec3, stats};

use super::messages::TimedPose;

impl TimedPose {
    pub fn identity() -> Self {
        Self { time_ns: 0, translation: Vec3::zeros(), rotation: UnitQuaternion::identity() }
    }

    /// This one, then the other in it; the time stays.
    pub fn then(&self, other: &Self) -> Self {
        Self {
            time_ns: self.time_ns,
            translation: self.translation + self.rotation * other.translation,
            rotation: self.rotation * other.rotation,
        }
    }

    pub fn inverse(&self) -> Self {
        let rotation = self.rotation.inverse();
        Self { time_ns: self.time_ns, translation: rotation * -self.translation, rotation }
    }

    /// Between this one and a later one, or the nearer of them beyond their ends.
    pub fn towards(&self, later: &Self, time_ns: i64) -> Self {
        let span = later.time_ns.saturating_sub(self.time_ns);
        if span <= 0 {
            return Self { time_ns, ..*self };
        }
        #[expect(clippy::cast_precision_loss, reason = "a fraction of a span of time")]
        let part = (time_ns.saturating_sub(self.time_ns) as f64 / span as f64).clamp(0.0, 1.0);
        // Rotations half a turn apart have no middle.
        let between = self.rotation.try_slerp(&later.rotation, part, f64::EPSILON);
        let nearer = if part < 0.5 { self.rotation } else { later.rotation };
        Self {
            time_ns,
            translation: self.translation.lerp(&later.translation, part),
            rotation: between.unwrap_or(nearer),
        }
    }

    fn is_near(&self, other: &Self, within: f64, within_rad: f64) -> bool {
        (self.translation - other.translation).norm() <= within && self.rotation.angle_to(&other.rotation) <= within_rad
    }
}

/// What standing still is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stillness {
    pub for_ns: i64,
    /// In the unit of the poses.
    pub within: f64,
    pub within_rad: f64,
}

/// The stretches of poses, ascending in time, in which the robot stood still.
pub(super) fn still(poses: &[TimedPose], stillness: &Stillness) -> Vec<Range<usize>> {
    let Stillness { for_ns, within, within_rad } = *stillness;
    let mut stretches: Vec<Range<usize>> = Vec::new();
    let mut start = 0;
    while let Some(first) = poses.get(start) {
        let moved = poses[start..].iter().position(|pose| !pose.is_near(first, within, within_rad));
        let end = moved.map_or(poses.len(), |moved| start + moved);
        let lasted = poses[end - 1].time_ns.saturating_sub(first.time_ns);
        if lasted < for_ns || end - start < 2 {
            start += 1;
            continue;
        }
        // Noise, or the end of a slow approach, can part one stay in two.
        match stretches.last_mut() {
            Some(last)
                if last.end == start
                    && mean(&poses[last.clone()]).is_near(&mean(&poses[start..end]), within, within_rad) =>
            {
                last.end = end;
            }
            _ => stretches.push(start..end),
        }
        start = end;
    }
    stretches
}

/// The pose that several were readings of: medians of the position, the mean of the rotations.
pub(super) fn mean(poses: &[TimedPose]) -> TimedPose {
    let Some(first) = poses.first() else { return TimedPose::identity() };
    let median = |axis: usize| {
        let mut values: Vec<f64> = poses.iter().map(|pose| pose.translation[axis]).collect();
        stats::median(&mut values)
    };
    let mut sum = Quaternion::new(0.0, 0.0, 0.0, 0.0);
    for pose in poses {
        let sign = if pose.rotation.coords.dot(&first.rotation.coords) < 0.0 { -1.0 } else { 1.0 };
        sum += pose.rotation.into_inner() * sign;
    }
    TimedPose {
        time_ns: first.time_ns + (poses[poses.len() - 1].time_ns.saturating_sub(first.time_ns)) / 2,
        translation: Vec3::new(median(0), median(1), median(2)),
        rotation: UnitQuaternion::try_new(sum, f64::EPSILON).unwrap_or(first.rotation),
    }
}

/// The pose at a time: between its two neighbours where both are within the tolerance, else the one that is.
///
/// # Errors
/// How far the nearest pose is away, ns; `None` if there is no pose at all.
pub(super) fn pose_at(poses: &[TimedPose], time_ns: i64, tolerance_ns: i64) -> Result<TimedPose, Option<i64>> {
    let next = poses.partition_point(|pose| pose.time_ns < time_ns);
    let away = |pose: &TimedPose| pose.time_ns.abs_diff(time_ns);
    let near = |pose: &&TimedPose| away(pose) <= tolerance_ns.unsigned_abs();
    let (before, after) = (next.checked_sub(1).and_then(|idx| poses.get(idx)), poses.get(next));
    match (before.filter(near), after.filter(near)) {
        (Some(before), Some(after)) => Ok(before.towards(after, time_ns)),
        (Some(only), None) | (None, Some(only)) => Ok(*only),
        (None, None) => {
            let nearest = before.into_iter().chain(after).map(away).min();
            Err(nearest.map(|away| i64::try_from(away).unwrap_or(i64::MAX)))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::so3;

    const MS: i64 = 1_000_000;

    fn pose(time_ms: i32, x_mm: f64, about_z: f64) -> TimedPose {
        TimedPose {
            time_ns: i64::from(time_ms) * MS,
            translation: Vec3::new(x_mm, 0.0, 0.0),
            rotation: so3::exp(Vec3::new(0.0, 0.0, about_z)),
        }
    }

    const STILL: Stillness = Stillness { for_ns: 500 * MS, within: 0.05, within_rad: 0.001 };

    #[test]
    fn stays_are_found_between_moves_and_their_noise_is_averaged() {
        // 1 s at 0 mm, 1 s on the way, 1 s at 10 mm, 100 Hz; ±10 µm of noise.
        let x_mm = |idx: i32| f64::from((idx - 100).clamp(0, 100)) * 0.1;
        let poses: Vec<TimedPose> =
            (0..300).map(|idx| pose(idx * 10, x_mm(idx) + if idx % 2 == 0 { 0.01 } else { -0.01 }, 0.0)).collect();
        let stretches = still(&poses, &STILL);
        assert_eq!(stretches.len(), 2, "{stretches:?}");
        for (stretch, expected) in stretches.iter().zip([0.0, 10.0]) {
            let found = mean(&poses[stretch.clone()]).translation.x;
            // The noise's own size: medians of two values are one of them, or their middle.
            assert!((found - expected).abs() < 0.011, "{found}");
        }
    }

    #[test]
    fn a_turn_on_the_spot_and_a_single_pose_are_no_stay() {
        let turning: Vec<TimedPose> = (0..300).map(|idx| pose(idx * 10, 0.0, f64::from(idx) * 0.01)).collect();
        assert_eq!(still(&turning, &STILL), []);
        assert_eq!(still(&[pose(0, 0.0, 0.0)], &STILL), []);
        assert_eq!(still(&[], &STILL), []);
    }

    #[test]
    fn a_slow_creep_is_parted_but_a_stay_with_an_approach_is_one() {
        // 1 mm/s: 0.05 mm in 50 ms, never still for 500 ms.
        let creep: Vec<TimedPose> = (0..300).map(|idx| pose(idx * 10, f64::from(idx) * 0.01, 0.0)).collect();
        assert_eq!(still(&creep, &STILL), []);
        // The last 40 µm of an approach, then 2 s of standing.
        let approach: Vec<TimedPose> =
            (0..260).map(|idx| pose(idx * 10, 0.04 * (1.0 - (f64::from(idx) / 60.0).min(1.0)), 0.0)).collect();
        assert_eq!(still(&approach, &STILL), vec![0..260; 1]);
    }

    #[test]
    fn a_pose_is_paired_between_its_neighbours_or_with_the_one_in_reach() {
        let poses = [pose(0, 0.0, 0.0), pose(10, 1.0, 0.0), pose(1000, 2.0, 0.0)];
        let at = |time_ms: i64| pose_at(&poses, time_ms * MS, 50 * MS);
        assert!((at(5).expect("between").translation.x - 0.5).abs() < 1e-12);
        assert!((at(40).expect("near the second").translation.x - 1.0).abs() < 1e-12);
        assert_eq!(at(500), Err(Some(490 * MS)));
        assert_eq!(pose_at(&[], 0, MS), Err(None));
        assert!(pose_at(&poses, i64::MIN, MS).is_err() && pose_at(&poses, i64::MAX, MS).is_err());
    }
}
