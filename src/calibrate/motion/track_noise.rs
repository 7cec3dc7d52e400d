//! What the steps of a track scatter by: the camera's noise, which adds up from step to step, and the robot's at each pose,
//! which does not.
//!
//! Over one step and over many in a row, the errors of the camera grow with the steps' number while those of the robot's two
//! poses stay. So the scatter over both lengths tells the two apart. It is judged by medians, so that a few lost steps do not
//! count. What is stated of the robot is only where the search begins: it is about poses at which the robot stands still, while
//! on the way neighbouring poses may share nearly all of their error, and what was interpolated is a mean of two.

use nalgebra::Matrix6;

use crate::geometry::{Rigid, se3, stats};

use super::steps::{Step, Track, TrackNoise, TrackPose};

/// Many steps in a row are those of so long a time, s: errors that change faster are the robot's at single poses.
const LONG_S: f64 = 0.5;
/// So many such rows at least, one after the other, if need be shorter ones.
const MIN_ROWS: usize = 6;
/// A χ² with three degrees of freedom has this median.
const MEDIAN: f64 = 2.366;
/// A part of what is seen that is less than this cannot be told from the rest.
const LEAST_SHARE: f64 = 0.1;
/// The part of the scatter of translations that turns of the robot, through the lever, are taken to explain at most.
const MOST_BY_LEVER: f64 = 0.9;
/// Exact data keep a little noise, so that they can be weighed: of a step against what is stated, and mm² and rad² of the robot.
const LEAST: [f64; 3] = [1e-8, 1e-10, 1e-16];

/// The scatter of steps, or of rows of steps: errors over what is stated of the camera, and the robot's part of that.
struct Scatter {
    /// Of rotations and translations: squares over the camera's variance.
    seen: [f64; 2],
    /// What the robot's orientation would add to each for a variance of one, rad².
    by_orientation: [f64; 2],
    /// What its position would add to translations for a variance of one, mm².
    by_position: f64,
}

impl Track<'_> {
    /// How many steps make a long row.
    pub fn steps_in_row(&self) -> usize {
        let intervals = self.poses.windows(2).map(|pair| pair[1].time_s - pair[0].time_s);
        let interval_s = stats::median(&mut intervals.collect::<Vec<_>>());
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "positive, and cut off below")]
        let wanted = (LONG_S / interval_s).round() as usize;
        wanted.min((self.poses.len() - 1) / MIN_ROWS).max(2)
    }

    /// The noise that the errors at this sensor show.
    pub fn noise_seen(&self, sensor: &Rigid) -> TrackNoise {
        let (Some(short), Some(long)) = (self.scatter(sensor, 1), self.scatter(sensor, self.steps_in_row())) else {
            return self.noise;
        };
        // The robot's orientation, through the lever, cannot shift steps by more than is seen.
        let most = MOST_BY_LEVER * short.seen[1] / short.by_orientation[1];
        let by_orientation = |part: usize| [short.by_orientation[part], long.by_orientation[part]];
        let (rotation_factor, orientation) = told_apart([short.seen[0], long.seen[0]], by_orientation(0), most);
        let left = [&short, &long]
            .map(|of| (of.seen[1] - orientation * of.by_orientation[1]).max((1.0 - MOST_BY_LEVER) * of.seen[1]));
        let (translation_factor, position) = told_apart(left, [short.by_position, long.by_position], f64::INFINITY);
        TrackNoise {
            position: position.max(LEAST[1]),
            orientation: orientation.max(LEAST[2]),
            rotation_factor: rotation_factor.max(LEAST[0]),
            translation_factor: translation_factor.max(LEAST[0]),
        }
    }

    /// Over rows of `length` steps, every one overlapping the next by half; `None` where all hold a lost step.
    fn scatter(&self, sensor: &Rigid, length: usize) -> Option<Scatter> {
        let unit = |position: f64, orientation: f64| TrackNoise {
            position,
            orientation,
            rotation_factor: 1.0,
            translation_factor: 1.0,
        };
        let variance =
            |covariance: &Matrix6<f64>, part: usize| covariance.fixed_view::<3, 3>(3 * part, 3 * part).trace() / 3.0;
        let mut columns: [Vec<f64>; 5] = Default::default();
        for row in self.poses.windows(length + 1).step_by((length / 2).max(1)) {
            let (before, steps) = (&row[0], &row[1..]);
            if steps.iter().any(|pose| !pose.is_believed) {
                continue;
            }
            let here = TrackPose { covariance: summed_covariance(row), ..row[length] };
            let by_orientation = Step::of(before, &here, sensor, &unit(0.0, 1.0), self.mount);
            let by_position = Step::of(before, &here, sensor, &unit(1.0, 0.0), self.mount);
            let own = [0, 1].map(|part| variance(&by_orientation.own, part));
            let seen = [0, 1].map(|part| by_orientation.error.fixed_rows::<3>(3 * part).norm_squared() / own[part]);
            let of_orientation = by_orientation.of_robot();
            let values = [
                seen[0] / MEDIAN,
                seen[1] / MEDIAN,
                variance(&of_orientation, 0) / own[0],
                variance(&of_orientation, 1) / own[1],
                variance(&by_position.of_robot(), 1) / own[1],
            ];
            for (column, value) in columns.iter_mut().zip(values) {
                column.push(value);
            }
        }
        if columns[0].is_empty() {
            return None;
        }
        let [rotation, translation, turned, shifted, by_position] =
            columns.map(|mut column| stats::median(&mut column));
        Some(Scatter { seen: [rotation, translation], by_orientation: [turned, shifted], by_position })
    }
}

/// The covariance of a row of steps, as stated of each, along the camera's axes at its end.
fn summed_covariance(row: &[TrackPose]) -> Matrix6<f64> {
    row.windows(2).fold(Matrix6::zeros(), |sum, pair| {
        let here_from_before = pair[1].world_from_sensor.inverse() * pair[0].world_from_sensor;
        let by_before = se3::adjoint(&here_from_before);
        by_before * sum * by_before.transpose() + pair[1].covariance
    })
}

/// The factor on the camera's variance and the robot's variance from what is seen over short and long rows, which is the factor
/// and the robot's variance, which is at most `most`, times `by_robot`.
fn told_apart(seen: [f64; 2], by_robot: [f64; 2], most: f64) -> (f64, f64) {
    let of_robot = ((seen[0] - seen[1]) / (by_robot[0] - by_robot[1])).max(0.0).min(most);
    // Over long rows errors count that change slowly, as those of a calibration do.
    let factor = (seen[1] - of_robot * by_robot[1]).max(LEAST_SHARE * seen[1]);
    if factor.is_finite() && of_robot.is_finite() { (factor, of_robot) } else { (1.0, 0.0) }
}
