//! Poses over time: the one between two, and the times at which the robot stood still.

use std::ops::Range;

use nalgebra::{Quaternion, UnitQuaternion};

use crate::geometry::{Vec3, stats};

use super::frames::MAX_GAP;
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
    /// Of a longer time without a pose nothing is known: the robot may have been anywhere.
    pub gap_ns: i64,
}

/// The longest time between two poses that is no gap: by what is allowed between a pose and a profile, or, of a robot that
/// seldom sends its pose, by how often it does.
pub(super) fn longest_gap_ns(poses: &[TimedPose], tolerance_ns: i64) -> i64 {
    /// Times between poses that are looked at.
    const MOST: usize = 10_000;
    let every = poses.len() / MOST + 1;
    let mut between: Vec<i64> =
        poses.windows(2).step_by(every).map(|pair| pair[1].time_ns.saturating_sub(pair[0].time_ns)).collect();
    between.sort_unstable();
    let usual_ns = between.get(between.len() / 2).copied().unwrap_or_default();
    // As in frames: a few poses may get lost.
    i64::from(MAX_GAP).saturating_mul(tolerance_ns.max(usual_ns))
}

/// A stay of the robot.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Standing {
    /// Which poses are within it.
    pub range: Range<usize>,
    /// Where it stood.
    pub pose: TimedPose,
}

/// The stays in poses ascending in time. `tick` is called every now and then and can end it.
pub(super) fn still<E>(
    poses: &[TimedPose],
    stillness: &Stillness,
    tick: &mut dyn FnMut() -> Result<(), E>,
) -> Result<Vec<Standing>, E> {
    /// A stay is found to a part of the least time that one takes: what densely sent poses cost is bounded by it.
    const PARTS: i64 = 256;
    /// Poses that are looked at until the next tick.
    const TICK_EVERY: usize = 1 << 20;
    let Stillness { for_ns, within, within_rad, gap_ns } = *stillness;
    let mut found: Vec<Standing> = Vec::new();
    let (mut start, mut looked_at) = (0, 0);
    while let Some(first) = poses.get(start) {
        let left_ns = poses[poses.len() - 1].time_ns.saturating_sub(first.time_ns);
        if left_ns < for_ns {
            break;
        }
        let is_behind_gap = |idx: usize| is_gap(&poses[idx - 1], &poses[idx], gap_ns);
        let end = (start + 1..poses.len())
            .find(|idx| !poses[*idx].is_near(first, within, within_rad) || is_behind_gap(*idx))
            .unwrap_or(poses.len());
        looked_at += end - start;
        if looked_at >= TICK_EVERY {
            tick()?;
            looked_at = 0;
        }
        let lasted = poses[end - 1].time_ns.saturating_sub(first.time_ns);
        if lasted < for_ns || end - start < 2 {
            let next_ns = first.time_ns.saturating_add(for_ns / PARTS);
            start += 1;
            while start < end && poses[start].time_ns < next_ns {
                start += 1;
            }
            continue;
        }
        let part = Standing { range: start..end, pose: mean(&poses[start..end]) };
        match found.last_mut() {
            Some(stay) if is_one_stay(poses, stay, &part, stillness) => {
                // The longer one tells better where it is.
                if part.range.len() > stay.range.len() {
                    stay.pose = part.pose;
                }
                stay.range.end = end;
            }
            _ => found.push(part),
        }
        start = end;
    }
    for stay in &mut found {
        // Poses of a stay are within the limit of its first, which is so of the mean; what is beyond is a glitch.
        let near = |pose: &&TimedPose| pose.is_near(&stay.pose, 2.0 * within, 2.0 * within_rad);
        let near: Vec<TimedPose> = poses[stay.range.clone()].iter().filter(near).copied().collect();
        stay.pose = mean(&near);
    }
    Ok(found)
}

fn is_gap(before: &TimedPose, after: &TimedPose, gap_ns: i64) -> bool {
    after.time_ns.saturating_sub(before.time_ns) > gap_ns
}

/// Whether the robot stood at one place and was away but for a moment: noise, a single wrong pose, or the end of a slow
/// approach part one stay in two.
fn is_one_stay(poses: &[TimedPose], stay: &Standing, later: &Standing, stillness: &Stillness) -> bool {
    /// Poses between, of a robot that sends few.
    const MAX_POSES: usize = 2;
    let away = stay.range.end..later.range.start;
    let away_ns = poses[away.end].time_ns.saturating_sub(poses[away.start - 1].time_ns);
    let mut between = poses[away.start - 1..=away.end].windows(2);
    (away_ns < stillness.for_ns || away.len() <= MAX_POSES)
        && !between.any(|pair| is_gap(&pair[0], &pair[1], stillness.gap_ns))
        && stay.pose.is_near(&later.pose, stillness.within, stillness.within_rad)
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

    const STILL: Stillness = Stillness { for_ns: 500 * MS, within: 0.05, within_rad: 0.001, gap_ns: 200 * MS };

    fn ranges(poses: &[TimedPose]) -> Vec<Range<usize>> {
        let mut tick = || Ok::<_, std::convert::Infallible>(());
        let found = still(poses, &STILL, &mut tick).unwrap_or_default();
        found.into_iter().map(|stay| stay.range).collect()
    }

    #[test]
    fn stays_are_found_between_moves_and_their_noise_is_averaged() {
        // 1 s at 0 mm, 1 s on the way, 1 s at 10 mm, 100 Hz; ±10 µm of noise.
        let x_mm = |idx: i32| f64::from((idx - 100).clamp(0, 100)) * 0.1;
        let poses: Vec<TimedPose> =
            (0..300).map(|idx| pose(idx * 10, x_mm(idx) + if idx % 2 == 0 { 0.01 } else { -0.01 }, 0.0)).collect();
        let stretches = ranges(&poses);
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
        assert_eq!(ranges(&turning), []);
        assert_eq!(ranges(&[pose(0, 0.0, 0.0)]), []);
        assert_eq!(ranges(&[]), []);
    }

    #[test]
    fn a_slow_creep_is_parted_but_a_stay_with_an_approach_is_one() {
        // 1 mm/s: 0.05 mm in 50 ms, never still for 500 ms.
        let creep: Vec<TimedPose> = (0..300).map(|idx| pose(idx * 10, f64::from(idx) * 0.01, 0.0)).collect();
        assert_eq!(ranges(&creep), []);
        // The last 40 µm of an approach, then 2 s of standing.
        let approach: Vec<TimedPose> =
            (0..260).map(|idx| pose(idx * 10, 0.04 * (1.0 - (f64::from(idx) / 60.0).min(1.0)), 0.0)).collect();
        assert_eq!(ranges(&approach), vec![0..260; 1]);
    }

    #[test]
    fn glitches_do_not_part_a_stay() {
        // 20 minutes at one place; every 12 s one pose is 5 mm and 0.1 rad away.
        let glitch = |idx: i32| if idx % 600 == 599 { 1.0 } else { 0.0 };
        let poses: Vec<TimedPose> =
            (0..60_000).map(|idx| pose(idx * 20, 5.0 * glitch(idx), 0.1 * glitch(idx))).collect();
        let found = still(&poses, &STILL, &mut || Ok::<_, ()>(())).expect("not ended");
        let [stay] = found.as_slice() else { panic!("one stay, not {}", found.len()) };
        assert_eq!(stay.range, 0..59_999);
        assert!(stay.pose.translation.norm() < 1e-12 && stay.pose.rotation.angle() < 1e-12, "{:?}", stay.pose);
        // A robot that goes away for 2 s and comes back was there twice.
        let away: Vec<TimedPose> =
            (0..300).map(|idx| pose(idx * 20, if (100..200).contains(&idx) { 5.0 } else { 0.0 }, 0.0)).collect();
        assert_eq!(ranges(&away), [0..100, 100..200, 200..300]);
    }

    #[test]
    fn a_time_without_poses_is_no_part_of_a_stay() {
        // A second at one place, four of which nothing is known, and a second at the same place.
        let poses: Vec<TimedPose> =
            (0..200).map(|idx| pose(idx * 10 + if idx < 100 { 0 } else { 4000 }, 0.0, 0.0)).collect();
        assert_eq!(ranges(&poses), [0..100, 100..200]);
        assert_eq!(longest_gap_ns(&poses, 50 * MS), 200 * MS);
        // Of a robot that sends its pose once a second a second says nothing.
        let seldom: Vec<TimedPose> = (0..20).map(|idx| pose(idx * 1000, 0.0, 0.0)).collect();
        assert_eq!(longest_gap_ns(&seldom, 50 * MS), 4000 * MS);
        assert_eq!(longest_gap_ns(&[], 50 * MS), 200 * MS);
    }

    #[test]
    fn dense_poses_are_looked_through_in_a_time_that_grows_with_their_number() {
        // Half a million poses in 0.4 s, a move, and again: nowhere long enough.
        let half_second: Vec<TimedPose> = (0..1_000_000)
            .map(|idx| {
                let (part, time_ns) = (idx / 500_000, i64::from(idx) * 800);
                TimedPose { time_ns, ..pose(0, f64::from(part), 0.0) }
            })
            .collect();
        let mut num_ticks = 0;
        let tick = &mut || {
            num_ticks += 1;
            // Each of the poses is looked at no more than 256 times.
            if num_ticks > 256 { Err("too often") } else { Ok(()) }
        };
        assert_eq!(still(&half_second, &STILL, tick), Ok(Vec::new()));
        assert!(num_ticks > 0);
        assert!(still(&half_second, &STILL, &mut || Err("cancelled")).is_err());
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
