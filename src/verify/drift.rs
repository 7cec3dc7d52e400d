//! Calibrations of one sensor over time: how far each is from the first and from the one before, whether they drift, and
//! where they jumped.

use std::ops::Range;

use crate::geometry::{Vec3, stats};

use super::difference::{Difference, PointShift, Stated, difference, point_shift};
use super::kendall::in_order;

/// A calibration at a time.
#[derive(Clone, Debug, PartialEq)]
pub struct Epoch {
    /// Days, or a number where no dates are known; ascending.
    pub at: f64,
    /// What it was.
    pub calibration: Stated,
}

/// How one calibration stands to another.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    /// In the flange.
    pub difference: Difference,
    /// At the reference point.
    pub shift: PointShift,
}

/// A straight line through the values of one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trend {
    /// Change a unit of time.
    pub slope: f64,
    /// Its σ: from the scatter about the line, and no less than what the calibrations state.
    pub std: f64,
    /// The value of the line at the time of the first calibration.
    pub at_first: f64,
    /// Whether it is more than chance: chance alone makes a drift of less than one in a hundred histories. `None` where there
    /// are too few calibrations to tell.
    pub is_significant: Option<bool>,
}

/// What became of a calibration over time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drift {
    /// One entry a calibration: against the first; the first stands against itself.
    pub from_first: Vec<Change>,
    /// One entry a calibration but the first: against the one before.
    pub from_previous: Vec<Change>,
    /// Places of calibrations that are further from the one before than chance and the others' steps explain.
    pub jumps: Vec<usize>,
    /// The way of the reference point along x, y, z of the flange, mm a unit of time, between the jumps; empty with fewer than
    /// [`MIN_FOR_TREND`] calibrations or where they have one time.
    pub point_trends: Vec<Trend>,
    /// The same along x, y, z of the flange, mm, and about them, rad.
    pub trends: Vec<Trend>,
}

/// With fewer a line says nothing: two values are left over to judge it by.
pub const MIN_FOR_TREND: usize = 4;
/// With fewer steps their own scatter is not known.
const MIN_STEPS_FOR_SCATTER: usize = 5;
/// Chance makes a jump in fewer histories than this.
const JUMP_P: f64 = 0.02;
/// The least number of stated σ that is a jump, as those of few calibrations are not known well.
const JUMP_STD: f64 = 4.0;
/// Chance makes a drift, of the point or along any axis, in fewer histories than this: half of it is the point's, whose three
/// axes are so tested less strictly than the six of the calibration.
const DRIFT_P: f64 = 0.01;
/// A slope within so many σ of none is none, in whatever order the values are.
const LEAST_SLOPE_STD: f64 = 2.0;
/// The median of slopes scatters by so much more than the best line through normal errors.
const THEIL_SEN_LOSS: f64 = 1.02;

/// Looks at calibrations in the order of time; `reference_in_sensor_mm` is the point at which jumps are looked for.
#[must_use]
pub fn drift(epochs: &[Epoch], reference_in_sensor_mm: Vec3) -> Drift {
    let change = |from: &Epoch, to: &Epoch| Change {
        difference: difference(&from.calibration, &to.calibration),
        shift: point_shift(&from.calibration, &to.calibration, reference_in_sensor_mm),
    };
    let Some(first) = epochs.first() else {
        return Drift::default();
    };
    let from_first: Vec<Change> = epochs.iter().map(|epoch| change(first, epoch)).collect();
    let from_previous: Vec<Change> = epochs.windows(2).map(|pair| change(&pair[0], &pair[1])).collect();
    let jumps = jumps(&from_previous);
    let times: Vec<f64> = epochs.iter().map(|epoch| epoch.at).collect();
    let of_point: Vec<_> = epochs.iter().map(|epoch| point_stds(&epoch.calibration, reference_in_sensor_mm)).collect();
    let of_axes: Vec<_> = epochs.iter().map(|epoch| axis_stds(&epoch.calibration)).collect();
    let point_trends = trends(&times, &jumps, &of_point, |idx, axis| from_first[idx].shift.shift_mm[axis]);
    let trends = trends(&times, &jumps, &of_axes, |idx, axis| value(&from_first[idx].difference, axis));
    Drift { from_first, from_previous, jumps, point_trends, trends }
}

/// The trend of each of so many axes; half of the error that is allowed is theirs together.
fn trends<const N: usize>(
    times: &[f64],
    jumps: &[usize],
    stds: &[Option<[f64; N]>],
    value: impl Fn(usize, usize) -> f64,
) -> Vec<Trend> {
    #[expect(clippy::cast_precision_loss, reason = "three or six")]
    let limit = DRIFT_P / 2.0 / N as f64;
    let of_axis = |axis: usize| {
        let values: Vec<f64> = (0..times.len()).map(|idx| value(idx, axis)).collect();
        let std = |stds: &Option<[f64; N]>| stds.map(|stds| stds[axis]).filter(|std| std.is_finite() && *std > 0.0);
        trend(times, &values, jumps, &stds.iter().map(std).collect::<Vec<_>>(), limit)
    };
    (0..N).map_while(of_axis).collect()
}

/// What a calibration states along the three axes of the flange, and about them; of the three about the sensor's the largest.
#[must_use]
pub fn axis_stds(calibration: &Stated) -> Option<[f64; 6]> {
    let covariance = calibration.covariance?;
    let about = (0..3).map(|idx| covariance[(idx, idx)]).fold(0.0, f64::max).sqrt();
    Some(std::array::from_fn(|axis| if axis < 3 { covariance[(axis + 3, axis + 3)].sqrt() } else { about }))
}

/// What a calibration states of where it puts a point, along the three axes of the flange.
#[must_use]
pub fn point_stds(calibration: &Stated, point_in_sensor_mm: Vec3) -> Option<[f64; 3]> {
    let exact = Stated { covariance: None, ..calibration.clone() };
    let std_mm = point_shift(&exact, calibration, point_in_sensor_mm).std_mm?;
    Some(std_mm.into())
}

/// Along x, y, z, then about them.
fn value(difference: &Difference, axis: usize) -> f64 {
    if axis < 3 { difference.translation_mm[axis] } else { difference.rotation_rad[axis - 3] }
}

/// The steps that stand out at the reference point, by the place of the later calibration.
fn jumps(steps: &[Change]) -> Vec<usize> {
    /// Equal calibrations scatter by nothing, and rounding is no jump.
    const LEAST_MM: f64 = 1e-6;
    let scatter = |axis: usize| {
        let mut sizes: Vec<f64> = steps.iter().map(|step| step.shift.shift_mm[axis]).collect();
        (sizes.len() >= MIN_STEPS_FOR_SCATTER).then(|| stats::robust_std_about_zero(&mut sizes))
    };
    let scatters = [0, 1, 2].map(scatter);
    let (limit_of_stated, limit_of_scatter) = jump_limits(steps.len());
    let stands_out = |step: &Change| {
        (0..3).any(|axis| {
            let by_stated = step.shift.std_mm.map(|std| limit_of_stated * std[axis].max(LEAST_MM));
            let by_scatter = scatters[axis].map(|scatter| limit_of_scatter * scatter.max(LEAST_MM));
            let limit = by_stated.into_iter().chain(by_scatter).reduce(f64::max);
            limit.is_some_and(|limit| step.shift.shift_mm[axis].abs() > limit)
        })
    };
    steps.iter().enumerate().filter(|(_, step)| stands_out(step)).map(|(idx, _)| idx + 1).collect()
}

/// How many stated σ, and how many of the scatter of so many steps, are a jump: along three axes chance reaches them in fewer
/// than [`JUMP_P`] of all histories.
fn jump_limits(num_steps: usize) -> (f64, f64) {
    // Found by simulation: a scatter from few steps is often too small, and steps that share a calibration make it less sure.
    const OF_SCATTER: f64 = 1.08;
    const OF_FEW: f64 = 20.0;
    #[expect(clippy::cast_precision_loss, reason = "files of a folder")]
    let count = num_steps.max(1) as f64;
    let of_normal = stats::normal_quantile(1.0 - JUMP_P / (2.0 * 3.0 * count));
    (of_normal.max(JUMP_STD), OF_SCATTER * of_normal + OF_FEW / count)
}

/// The median of the slopes between all pairs with no jump between them: a level that is fitted to each stretch takes nothing
/// from the slope, where a jump that is subtracted would bring the noise of two calibrations into all that follow.
///
/// Less likely than `limit` by chance alone, it is a drift. `None` with too few values, or at one time.
fn trend(times: &[f64], values: &[f64], jumps: &[usize], stds: &[Option<f64>], limit: f64) -> Option<Trend> {
    let mut ends: Vec<usize> = jumps.to_vec();
    ends.push(values.len());
    let mut start = 0;
    let stretches: Vec<Range<usize>> = ends
        .into_iter()
        .map(|end| {
            let stretch = start..end;
            start = end;
            stretch
        })
        .collect();
    let left_over = values.len().checked_sub(stretches.len() + 1).filter(|left_over| *left_over > 0)?;
    if values.len() < MIN_FOR_TREND {
        return None;
    }
    let mut slopes = Vec::new();
    for stretch in &stretches {
        for later in stretch.clone() {
            let pairs = (stretch.start..later).filter(|earlier| times[later] > times[*earlier]);
            slopes.extend(pairs.map(|earlier| (values[later] - values[earlier]) / (times[later] - times[earlier])));
        }
    }
    if slopes.is_empty() {
        return None;
    }
    let slope = stats::median(&mut slopes);
    let first = times.first().copied()?;
    let offsets: Vec<f64> = times.iter().zip(values).map(|(t, y)| y - slope * (t - first)).collect();
    let (mut residuals, mut squared_lever) = (Vec::with_capacity(values.len()), 0.0);
    let mut at_first = 0.0;
    for stretch in &stretches {
        let level = stats::median(&mut offsets[stretch.clone()].to_vec());
        if stretch.start == 0 {
            at_first = level;
        }
        residuals.extend(offsets[stretch.clone()].iter().map(|offset| offset - level));
        let mean = mean(&times[stretch.clone()]);
        squared_lever += times[stretch.clone()].iter().map(|t| (t - mean) * (t - mean)).sum::<f64>();
    }
    #[expect(clippy::cast_precision_loss, reason = "files of a folder")]
    let (count, left_over) = (values.len() as f64, left_over as f64);
    let scatter = stats::robust_std_about_zero(&mut residuals) * (count / left_over).sqrt();
    let lever = squared_lever.sqrt();
    let std = THEIL_SEN_LOSS * scatter.max(stats::rms(stds.iter().copied().flatten())) / lever;
    let is_slope = slope.abs() > LEAST_SLOPE_STD * std && slope.abs() * lever > f64::EPSILON * 1e3;
    let order = in_order(times, values, &stretches);
    let p_value = if order.least_p_value < limit {
        Some(order.p_value)
    } else {
        let stds: Option<Vec<f64>> = stds.iter().copied().collect();
        stds.map(|stds| slope_p_value(times, values, &stds, &stretches, left_over))
    };
    Some(Trend { slope, std, at_first, is_significant: p_value.map(|p_value| is_slope && p_value < limit) })
}

/// How often chance alone makes such a slope of the best parallel lines, by what the calibrations state, and by their scatter
/// where that is larger.
fn slope_p_value(times: &[f64], values: &[f64], stds: &[f64], stretches: &[Range<usize>], left_over: f64) -> f64 {
    let centred = |of: &[f64]| {
        let parts = stretches.iter().flat_map(|stretch| {
            let mean = mean(&of[stretch.clone()]);
            of[stretch.clone()].iter().map(move |value| value - mean)
        });
        parts.collect::<Vec<f64>>()
    };
    let (t, y) = (centred(times), centred(values));
    let squares: f64 = t.iter().map(|t| t * t).sum();
    let slope = t.iter().zip(&y).map(|(t, y)| t * y).sum::<f64>() / squares;
    let std = t.iter().zip(stds).map(|(t, std)| (t * std).powi(2)).sum::<f64>().sqrt() / squares;
    let residuals = t.iter().zip(&y).zip(stds).map(|((t, y), std)| ((y - slope * t) / std).powi(2));
    let inflation = (residuals.sum::<f64>() / left_over).sqrt().max(1.0);
    2.0 * stats::normal_cdf(-slope.abs() / (std * inflation))
}

fn mean(values: &[f64]) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "files of a folder")]
    let count = values.len().max(1) as f64;
    values.iter().sum::<f64>() / count
}

#[cfg(test)]
mod tests {
    use nalgebra::{Matrix6, Vector6};

    use super::*;
    use crate::geometry::stats::SplitMix;
    use crate::geometry::{Transform, so3};

    const STD_MM: f64 = 0.01;
    const STD_RAD: f64 = 5e-5;

    /// Calibrations a week apart, with noise, a drift along x and a jump along z.
    fn history(count: u32, drift_mm_a_day: f64, jump: Option<(u32, f64)>, is_stated: bool) -> Vec<Epoch> {
        history_of(11, count, drift_mm_a_day, jump, is_stated)
    }

    fn history_of(seed: u64, count: u32, drift_mm_a_day: f64, jump: Option<(u32, f64)>, is_stated: bool) -> Vec<Epoch> {
        let mut random = SplitMix::new(seed);
        // The sum of twelve uniform values is normal enough.
        #[expect(clippy::cast_precision_loss, reason = "below a thousand")]
        let mut noise = |std: f64| std * ((0..12).map(|_| random.below(1000) as f64 / 1000.0).sum::<f64>() - 6.0);
        (0..count)
            .map(|idx| {
                let at = f64::from(idx) * 7.0;
                let jumped = jump.map_or(0.0, |(from, mm)| if idx >= from { mm } else { 0.0 });
                let translation = Vec3::new(
                    10.0 + drift_mm_a_day * at + noise(STD_MM),
                    noise(STD_MM),
                    120.0 + jumped + noise(STD_MM),
                );
                let rotation = so3::exp(Vec3::new(noise(STD_RAD), 2.0 + noise(STD_RAD), noise(STD_RAD)));
                let stds = Vector6::new(STD_RAD, STD_RAD, STD_RAD, STD_MM, STD_MM, STD_MM);
                let covariance = is_stated.then(|| Matrix6::from_diagonal(&stds.map(|std| std * std)));
                Epoch {
                    at,
                    calibration: Stated {
                        flange_from_sensor: Transform::from_parts(translation, rotation),
                        covariance,
                    },
                }
            })
            .collect()
    }

    const POINT: Vec3 = Vec3::new(0.0, 0.0, 60.0);

    #[test]
    fn a_drift_and_a_jump_are_told_apart_with_and_without_stated_uncertainty() {
        for is_stated in [true, false] {
            let found = drift(&history(16, 0.003, Some((9, 0.3)), is_stated), POINT);
            assert_eq!(found.jumps, [9], "stated {is_stated}");
            let x = found.trends[0];
            assert!(x.is_significant == Some(true) && (x.slope - 0.003).abs() < 4.0 * x.std, "{x:?}");
            // What the best two parallel lines through 9 and 7 values would know, within the scatter of a σ from 16.
            let squares = |count: f64| count * (count * count - 1.0) / 12.0;
            let best = STD_MM / (7.0 * (squares(9.0) + squares(7.0)).sqrt());
            assert!(x.std > 0.5 * best && x.std < 2.5 * best, "{} and {best}", x.std);
            assert_eq!(
                found.trends[2].is_significant,
                Some(false),
                "without its jump z does not drift: {:?}",
                found.trends[2]
            );
        }
    }

    #[test]
    fn noise_alone_neither_drifts_nor_jumps() {
        let found = drift(&history(30, 0.0, None, true), POINT);
        assert_eq!(found.jumps, [0; 0]);
        assert!(found.trends.iter().all(|trend| trend.is_significant == Some(false)), "{:?}", found.trends);
    }

    /// How often a thing is found in so many histories, and what is still explained by a promise with the luck of so many.
    fn share(count: u64, is_found: impl Fn(u64) -> bool) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "thousands")]
        let share = (0..count).filter(|seed| is_found(*seed)).count() as f64 / count as f64;
        share
    }

    #[test]
    fn of_driftless_histories_no_more_drift_or_jump_than_promised() {
        const HISTORIES: u64 = 1500;
        #[expect(clippy::cast_precision_loss, reason = "thousands")]
        let with_luck = |p: f64| p + 3.0 * (p * (1.0 - p) / HISTORIES as f64).sqrt();
        for (count, is_stated) in [(5, false), (5, true), (7, false), (8, false), (10, false), (20, false), (20, true)]
        {
            let found = |seed: u64| drift(&history_of(seed * 7919, count, 0.0, None, is_stated), POINT);
            let drifts = share(HISTORIES, |seed| {
                let found = found(seed);
                found.point_trends.iter().chain(&found.trends).any(|trend| trend.is_significant == Some(true))
            });
            let jumps = share(HISTORIES, |seed| !found(seed).jumps.is_empty());
            assert!(drifts <= with_luck(DRIFT_P), "{count}, stated {is_stated}: {drifts} drift");
            assert!(jumps <= with_luck(JUMP_P), "{count}, stated {is_stated}: {jumps} jump");
        }
    }

    #[test]
    fn a_clear_drift_is_found_and_too_few_calibrations_say_so() {
        // One σ a step for ten; three σ a step for five of a known σ.
        for (count, drift_mm_a_day, is_stated) in [(10, 0.0015, false), (20, 0.0007, false), (5, 0.004, true)] {
            let found = share(200, |seed| {
                let found = drift(&history_of(seed * 7919, count, drift_mm_a_day, None, is_stated), POINT);
                [found.point_trends[0], found.trends[0]].iter().any(|trend| trend.is_significant == Some(true))
            });
            assert!(found > 0.9, "{count}: {found}");
        }
        // The point shows a turn that is one σ of each angle a week, as it is three σ of its place.
        let turning = |seed: u64| {
            let mut epochs = history_of(seed * 7919, 9, 0.0, None, true);
            for epoch in &mut epochs {
                let calibration = &mut epoch.calibration.flange_from_sensor;
                let turn = so3::exp(Vec3::new(0.0, epoch.at / 7.0 * 0.8 * STD_RAD, 0.0));
                *calibration = Transform::from_parts(calibration.translation_mm(), turn * calibration.rotation());
            }
            drift(&epochs, Vec3::new(0.0, 0.0, 600.0))
        };
        let is_found = |trends: &[Trend]| trends.iter().any(|trend| trend.is_significant == Some(true));
        let by_point = share(200, |seed| is_found(&turning(seed).point_trends));
        let by_axes = share(200, |seed| is_found(&turning(seed).trends));
        assert!(by_point > by_axes && by_point > 0.5, "{by_point} and {by_axes}");
        let too_few = drift(&history(6, 0.004, None, false), POINT);
        assert!(too_few.trends.len() == 6 && too_few.trends.iter().all(|trend| trend.is_significant.is_none()));
    }

    #[test]
    fn few_equal_or_simultaneous_calibrations_are_no_trend() {
        assert_eq!(drift(&[], POINT).from_first.len(), 0);
        let one = drift(&history(1, 0.0, None, false), POINT);
        assert_eq!((one.from_first.len(), one.from_previous.len(), one.trends.len()), (1, 0, 0));
        assert!(drift(&history(3, 0.1, None, false), POINT).trends.is_empty());
        let mut at_once = history(6, 0.0, None, false);
        for epoch in &mut at_once {
            epoch.at = 5.0;
        }
        assert!(drift(&at_once, POINT).trends.is_empty());
        let same = vec![history(1, 0.0, None, false)[0].clone(); 8];
        let same: Vec<Epoch> = (0_u32..).zip(same).map(|(at, epoch)| Epoch { at: f64::from(at), ..epoch }).collect();
        let found = drift(&same, POINT);
        assert!(found.jumps.is_empty() && found.trends.iter().all(|trend| trend.is_significant == Some(false)));
    }
}
