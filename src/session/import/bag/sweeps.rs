//! Stays that are one sweep: the robot stepped along a line and kept its orientation.

use std::ops::Range;

use super::messages::TimedPose;

/// Any two places lie on a line.
const LEAST_STAYS: usize = 3;
/// A step that is so many times the mean of those before leads to another place.
const MAX_STEP_RATIO: f64 = 4.0;
/// No sweep is longer; looking through one takes time with its square.
const MOST_STAYS: usize = 1_000;

/// How exactly a robot keeps its orientation and its line.
#[derive(Clone, Copy, Debug)]
pub(super) struct Straightness {
    /// From the line, in the unit of the poses.
    pub within: f64,
    pub within_rad: f64,
}

/// Parts poses, which are in the order of time, into sweeps and single ones.
pub(super) fn sweeps(poses: &[TimedPose], straightness: &Straightness) -> Vec<Range<usize>> {
    let mut found = Vec::new();
    let mut start = 0;
    while start < poses.len() {
        let mut end = start + 1;
        while end < poses.len() && end - start < MOST_STAYS && is_sweep(&poses[start..=end], straightness) {
            end += 1;
        }
        // Two in line may be the last of nothing and the first of a sweep.
        if end - start < LEAST_STAYS {
            end = start + 1;
        }
        found.push(start..end);
        start = end;
    }
    found
}

/// Whether the last pose goes on with what the others began: a step ahead on their line.
fn is_sweep(poses: &[TimedPose], straightness: &Straightness) -> bool {
    let (Some(first), Some(last)) = (poses.first(), poses.last()) else { return false };
    if first.rotation.angle_to(&last.rotation) > straightness.within_rad {
        return false;
    }
    let Some(along) = (last.translation - first.translation).try_normalize(straightness.within) else { return false };
    let mut ahead = 0.0;
    let mut step = 0.0;
    for pose in &poses[1..] {
        let way = pose.translation - first.translation;
        let next = way.dot(&along);
        if (way - along * next).norm() > straightness.within || next <= ahead {
            return false;
        }
        (step, ahead) = (next - ahead, next);
    }
    #[expect(clippy::cast_precision_loss, reason = "at most a thousand")]
    let num_before = poses.len().saturating_sub(2) as f64;
    num_before == 0.0 || step <= MAX_STEP_RATIO * (ahead - step) / num_before
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Vec3, so3};

    const STRAIGHT: Straightness = Straightness { within: 0.2, within_rad: 0.002 };

    fn pose(x_mm: f64, y_mm: f64, about_z: f64) -> TimedPose {
        let rotation = so3::exp(Vec3::new(0.0, 0.0, about_z));
        TimedPose { time_ns: 0, translation: Vec3::new(x_mm, y_mm, 100.0), rotation }
    }

    #[test]
    fn steps_along_a_line_are_a_sweep_and_a_turn_a_bend_or_the_way_back_ends_it() {
        let steps = |from: i32, to: i32, y_mm: f64, about_z: f64| -> Vec<TimedPose> {
            let sign = if to < from { -1 } else { 1 };
            // 50 µm of noise, as controllers report it.
            (0..=(to - from).abs())
                .map(|step| pose(f64::from(from + sign * step), y_mm + 0.05 * f64::from(step % 2), about_z))
                .collect()
        };
        // Ten steps, ten in another orientation, the same line back, and one beside it.
        let poses = [steps(0, 9, 0.0, 0.0), steps(3, 12, 5.0, 0.4), steps(11, 2, 5.0, 0.4), steps(2, 11, 9.0, 0.4)];
        let found = sweeps(&poses.concat(), &STRAIGHT);
        assert_eq!(found, [0..10, 10..20, 20..30, 30..40]);
    }

    #[test]
    fn two_places_a_far_step_and_places_all_over_are_no_sweep() {
        let poses = [pose(0.0, 0.0, 0.0), pose(30.0, 0.0, 0.0), pose(0.0, 40.0, 0.3), pose(10.0, 70.0, 0.3)];
        assert_eq!(sweeps(&poses, &STRAIGHT), [0..1, 1..2, 2..3, 3..4]);
        let mut poses: Vec<TimedPose> = (0..4).map(|step| pose(f64::from(step), 0.0, 0.0)).collect();
        poses.extend((0..4).map(|step| pose(f64::from(100 + step), 0.0, 0.0)));
        assert_eq!(sweeps(&poses, &STRAIGHT), [0..4, 4..8]);
        // Standing still is no step.
        assert_eq!(sweeps(&[pose(0.0, 0.0, 0.0); 4], &STRAIGHT).len(), 4);
        assert_eq!(sweeps(&[], &STRAIGHT), []);
    }
}
