//! The time by which one stream of poses lags behind the other: found where the curves of their rotation speeds match.
//!
//! A hand and an eye that are rigidly joined turn at the same speed at any moment, whatever lies between them, so the speeds
//! are compared before anything is known of the calibration.

use nalgebra::{UnitQuaternion, Vector6};

use crate::geometry::{Rigid, se3, stats};

/// A pose with its time, s.
pub type Timed = (f64, Rigid);

/// Speeds are those over about so long a time, s: a robot turns by more than its noise, and not much faster at its end.
const APART_S: f64 = 0.1;
/// Fewer speeds than this are no curve.
const MIN_SAMPLES: usize = 8;
/// Of the shorter stream at least this part must lie within the other one.
const LEAST_OVERLAP: f64 = 0.5;
/// Curves that correlate less do not match.
const LEAST_CORRELATION: f64 = 0.5;
/// Offsets tried; beyond that the step grows.
const MAX_TRIALS: usize = 20_000;

/// Over a shorter time a robot's way is as good as the twist between its ends, s.
const SHORT_INTERVAL_S: f64 = 0.04;

/// The pose of a stream at a time, between its neighbours; `None` outside of the stream or in a gap of more than `longest_gap_s`.
///
/// Neighbours that are near in time are joined by a twist. Along that a robot that speeds up or turns is off by an eighth of its
/// acceleration times the square of the interval, a millimetre where poses are logged ten times a second: there it is the cubic
/// curve through four poses, whose noise comes in more than that of two.
#[must_use]
pub fn at(stream: &[Timed], time_s: f64, longest_gap_s: f64) -> Option<Rigid> {
    let after = stream.partition_point(|(time, _)| *time < time_s);
    let (end_s, end) = stream.get(after)?;
    if *end_s <= time_s {
        return Some(*end);
    }
    let before = after.checked_sub(1)?;
    let (start_s, start) = stream.get(before)?;
    let interval_s = end_s - start_s;
    if interval_s > longest_gap_s {
        return None;
    }
    let whole = se3::log(&(start.inverse() * end));
    let share = (time_s - start_s) / interval_s;
    if interval_s < SHORT_INTERVAL_S {
        return Some(start * se3::exp(&(whole * share)));
    }
    let neighbour = |place: Option<usize>| {
        let (other_s, other) = stream.get(place?)?;
        let away_s = (other_s - start_s).abs().min((other_s - end_s).abs());
        (away_s <= longest_gap_s).then_some((*other_s, *other))
    };
    // Speeds along the body's axes, over one interval; at an end of the stream that of the interval itself.
    let speed = |(here_s, here): (f64, &Rigid), to_other: Vector6<f64>, other: Option<(f64, Rigid)>| {
        let Some((other_s, other)) = other else { return whole };
        let beyond = se3::log(&(here.inverse() * other)) / (other_s - here_s);
        let within = to_other / interval_s;
        // The speed at the middle one of three places on a parabola.
        let away_s = (other_s - here_s).abs();
        (within * away_s + beyond * interval_s) / (away_s + interval_s) * interval_s
    };
    let at_start = speed((*start_s, start), whole, neighbour(before.checked_sub(1)));
    let at_end = speed((*end_s, end), whole, neighbour(Some(after + 1)));
    let at_end = se3::right_jacobian(&whole).lu().solve(&at_end)?;
    let [square, cube] = [share.powi(2), share.powi(3)];
    let twist =
        at_start * (cube - 2.0 * square + share) + whole * (3.0 * square - 2.0 * cube) + at_end * (cube - square);
    Some(start * se3::exp(&twist))
}

/// A gap in a stream that is too long to interpolate over, s.
#[must_use]
pub fn longest_gap_s(stream: &[Timed]) -> f64 {
    /// Where some samples are missing the motion between is still smooth.
    const SAMPLES: f64 = 5.0;
    SAMPLES * interval_s(stream)
}

/// The usual time between samples, s.
pub(super) fn interval_s(stream: &[Timed]) -> f64 {
    stats::median(&mut stream.windows(2).map(|pair| pair[1].0 - pair[0].0).collect::<Vec<_>>())
}

/// The offset to add to the times of `sensor` so that they become those of `flange`, s; `None` where the speeds show no match:
/// hardly any rotation, one at constant speed, or too little overlap.
#[must_use]
pub fn coarse(flange: &[Timed], sensor: &[Timed]) -> Option<f64> {
    let (of_flange, of_sensor) = (speeds(flange), speeds(sensor));
    if of_flange.len() < MIN_SAMPLES || of_sensor.len() < MIN_SAMPLES {
        return None;
    }
    let (first, last) =
        (of_flange[0].0 - of_sensor[of_sensor.len() - 1].0, of_flange[of_flange.len() - 1].0 - of_sensor[0].0);
    let finest_s = interval_s(flange).min(interval_s(sensor)).max(0.3 * APART_S);
    let step_s = (0.5 * finest_s).max((last - first) / as_float(MAX_TRIALS));
    if !(step_s > 0.0 && step_s.is_finite()) {
        return None;
    }
    let score = |offset_s: f64| correlation(&of_flange, &of_sensor, offset_s);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at most MAX_TRIALS, and not negative")]
    let num_trials = ((last - first) / step_s) as usize;
    let trials = (0..=num_trials).map(|idx| first + step_s * as_float(idx));
    let (best_s, best) =
        trials.filter_map(|offset| Some((offset, score(offset)?))).max_by(|a, b| a.1.total_cmp(&b.1))?;
    if best < LEAST_CORRELATION {
        return None;
    }
    // The top of a parabola through the neighbours.
    let (Some(before), Some(after)) = (score(best_s - step_s), score(best_s + step_s)) else { return Some(best_s) };
    let bend = before - 2.0 * best + after;
    Some(if bend < 0.0 { best_s + 0.5 * step_s * (before - after) / bend } else { best_s })
}

/// Rotation speed (rad/s) in the middle of pairs of samples that are about `APART_S` apart.
fn speeds(stream: &[Timed]) -> Vec<(f64, f64)> {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "of a positive number")]
    let apart = ((APART_S / interval_s(stream)).round() as usize).max(1);
    let speed = |(start_s, start): &Timed, (end_s, end): &Timed| {
        let rotation: UnitQuaternion<f64> = start.rotation.inverse() * end.rotation;
        (0.5 * (start_s + end_s), rotation.angle() / (end_s - start_s))
    };
    stream.iter().zip(stream.iter().skip(apart)).map(|(start, end)| speed(start, end)).collect()
}

/// Pearson's, over the samples of the sensor that lie within the flange's.
fn correlation(flange: &[(f64, f64)], sensor: &[(f64, f64)], offset_s: f64) -> Option<f64> {
    let (mut count, mut sum, mut sums, mut products) = (0.0, [0.0; 2], [0.0; 2], 0.0);
    let mut place = 1;
    for (time_s, of_sensor) in sensor {
        let time_s = time_s + offset_s;
        while place < flange.len() && flange[place].0 < time_s {
            place += 1;
        }
        let (Some(before), Some(after)) = (flange.get(place - 1), flange.get(place)) else { break };
        if time_s < before.0 {
            continue;
        }
        let share = (time_s - before.0) / (after.0 - before.0);
        let of_flange = before.1 + share * (after.1 - before.1);
        count += 1.0;
        sum = [sum[0] + of_flange, sum[1] + of_sensor];
        sums = [sums[0] + of_flange * of_flange, sums[1] + of_sensor * of_sensor];
        products += of_flange * of_sensor;
    }
    let shorter = as_float(flange.len().min(sensor.len()));
    if count < LEAST_OVERLAP * shorter || count < as_float(MIN_SAMPLES) {
        return None;
    }
    let variance = |idx: usize| sums[idx] / count - (sum[idx] / count) * (sum[idx] / count);
    let covariance = products / count - sum[0] / count * (sum[1] / count);
    let scale = (variance(0) * variance(1)).sqrt();
    (scale > 0.0).then(|| covariance / scale)
}

#[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 samples")]
fn as_float(count: usize) -> f64 {
    count as f64
}

/// Over how long to either side costs are compared, s: a whole number of the flange's intervals, where these are short.
///
/// Each of the flange's poses has noise of its own. Between two of them the noise of the interpolated pose is smaller than at
/// either, so that the cost ripples with the offset at the flange's interval; the least of it is pulled to between two samples,
/// by many times σ where both streams tick in step. Costs that are whole intervals apart have the same share of the ripple, be
/// the noise of neighbours independent or not. What is left of it is chance, and small where the reach is many σ of the offset.
pub(super) fn reach_s(flange: &[Timed]) -> f64 {
    /// Over this time a robot moves by far more than its noise, and its speed hardly changes.
    const WANTED_S: f64 = 0.03;
    let median_s = interval_s(flange);
    let is_usual = |interval_s: &f64| (interval_s / median_s - 1.0).abs() < 0.5;
    let usual = flange.windows(2).map(|pair| pair[1].0 - pair[0].0).filter(is_usual);
    // The mean, as times may be rounded.
    let (sum_s, count) = usual.fold((0.0, 0.0), |(sum_s, count), interval_s| (sum_s + interval_s, count + 1.0));
    let mean_s: f64 = sum_s / count;
    // Over a long interval the motion is far more than the ripple, and more than a parabola.
    if mean_s > 2.0 * WANTED_S { WANTED_S } else { mean_s * (WANTED_S / mean_s).ceil() }
}

/// The minimum of a cost that is about a parabola over `reach_s` to either side, and the standard deviation of its place where
/// the cost is a sum of squares of unit variance; `None` if the cost has no minimum near the start.
///
/// The minimum is where costs at `reach_s` before and after it are the same.
pub(super) fn refined(start_s: f64, reach_s: f64, cost: impl Fn(f64) -> Option<f64>) -> Option<(f64, f64)> {
    const MAX_STEPS: usize = 6;
    let mut place_s = start_s;
    for _ in 0..MAX_STEPS {
        let (before, here, after) = (cost(place_s - reach_s)?, cost(place_s)?, cost(place_s + reach_s)?);
        let bend = before - 2.0 * here + after;
        if bend <= 0.0 {
            return None;
        }
        let std_s = reach_s * (2.0 / bend).sqrt();
        let move_s = (0.5 * reach_s * (before - after) / bend).clamp(-reach_s, reach_s);
        place_s += move_s;
        if move_s.abs() < 0.02 * std_s {
            return Some((place_s, std_s));
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Vec3, so3};

    fn turning(time_s: f64) -> Rigid {
        let angle = 0.4 * (2.1 * time_s).sin() + 0.25 * (3.7 * time_s + 0.4).cos();
        Rigid::from_parts(Vec3::new(100.0 * time_s, 5.0, -3.0).into(), so3::exp(Vec3::new(0.6, -0.8, 0.0) * angle))
    }

    #[test]
    fn a_known_lag_is_found() {
        for lag_s in [-0.73, 0.0, 0.021, 1.4] {
            let flange: Vec<Timed> =
                (0..1000).map(|idx| (f64::from(idx) * 0.008, turning(f64::from(idx) * 0.008))).collect();
            let sensor: Vec<Timed> = (0..150)
                .map(|idx| (f64::from(idx) * 0.033 + 1.5 - lag_s, turning(f64::from(idx) * 0.033 + 1.5).inverse()))
                .collect();
            let found = coarse(&flange, &sensor).expect("matching curves");
            // A quarter of the coarser stream's interval.
            assert!((found - lag_s).abs() < 0.008, "{found} for {lag_s}");
        }
    }

    #[test]
    fn constant_speed_matches_nowhere() {
        let steady: Vec<Timed> = (0..100)
            .map(|idx| {
                (
                    f64::from(idx) * 0.1,
                    Rigid::from_parts(Vec3::zeros().into(), so3::exp(Vec3::z() * (0.02 * f64::from(idx)))),
                )
            })
            .collect();
        assert!(coarse(&steady, &steady).is_none_or(|found| found.abs() < 10.0));
    }

    #[test]
    fn between_samples_the_pose_follows_a_motion_that_speeds_up() {
        let stream: Vec<Timed> = (0..40).map(|idx| (f64::from(idx) * 0.1, turning(f64::from(idx) * 0.1))).collect();
        let worst = |found: &dyn Fn(f64) -> Rigid| {
            let off = |time_s: f64| se3::log(&(turning(time_s).inverse() * found(time_s))).norm();
            (5..200).map(|place| off(0.2 + f64::from(place) * 0.0171)).fold(0.0, f64::max)
        };
        let on_curve = worst(&|time_s| at(&stream, time_s, 0.5).expect("within"));
        let on_twist = worst(&|time_s| {
            let after = stream.partition_point(|(sample_s, _)| *sample_s < time_s);
            at(&stream[after - 1..=after], time_s, 0.5).expect("within")
        });
        // The error falls with the cube of the interval, not with its square.
        assert!(on_curve < 0.1 * on_twist, "{on_curve} against {on_twist}");
    }

    #[test]
    fn at_the_ends_the_pose_lies_on_the_twist_of_two_samples() {
        let stream: Vec<Timed> = vec![(0.0, turning(0.0)), (0.2, turning(0.2)), (9.0, turning(9.0))];
        let middle = at(&stream, 0.1, 1.0).expect("within");
        let halves = [(turning(0.0).inverse() * middle), (middle.inverse() * turning(0.2))].map(|half| se3::log(&half));
        assert!((halves[0] - halves[1]).norm() < 1e-9, "{halves:?}");
        assert_eq!(at(&stream, 0.2, 1.0), Some(turning(0.2)));
        assert_eq!(at(&stream, 5.0, 1.0), None, "a gap");
        assert_eq!(at(&stream, -0.1, 1.0), None);
        assert_eq!(at(&stream, 9.1, 1.0), None);
    }
}
