//! Kendall's test for a trend: how often chance alone orders values in time as well, whatever their distribution.

use std::ops::Range;

use crate::geometry::stats;

/// From here on the sum of the orders is as good as normal, and the exact distribution costs time.
const MAX_EXACT: usize = 40;

/// How likely chance is to order values as well.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct InOrder {
    /// With which probability chance makes as much order, rising or falling.
    pub p_value: f64,
    /// The same of values in perfect order: as many values as these show nothing less likely.
    pub least_p_value: f64,
}

/// Tests values at ascending times. Only pairs within a stretch count, and none of one time.
pub(super) fn in_order(times: &[f64], values: &[f64], stretches: &[Range<usize>]) -> InOrder {
    let (mut most, mut variance) = (0_usize, 0.0);
    let (mut rising, mut falling) = (0_usize, 0_usize);
    let is_exact = values.len() <= MAX_EXACT;
    // Of the number of pairs that rise.
    let mut distribution = vec![1.0];
    for stretch in stretches {
        for later in stretch.clone() {
            for earlier in (stretch.start..later).filter(|earlier| times[later] > times[*earlier]) {
                rising += usize::from(values[later] > values[earlier]);
                falling += usize::from(values[later] < values[earlier]);
            }
        }
        variance += variance_of(stretch.len());
        let mut before = 0;
        for at_once in times[stretch.clone()].chunk_by(|a, b| a >= b).map(<[f64]>::len) {
            variance -= variance_of(at_once);
            most += before * at_once;
            if is_exact {
                distribution = sum_of(&distribution, &rising_pairs(before, at_once));
            }
            before += at_once;
        }
    }
    let p_value = |score: usize| {
        let tail = if is_exact {
            distribution.iter().skip((most + score).div_ceil(2)).sum()
        } else {
            #[expect(clippy::cast_precision_loss, reason = "pairs of files of a folder")]
            let beyond = (score as f64 - 1.0).max(0.0) / variance.max(f64::MIN_POSITIVE).sqrt();
            stats::normal_cdf(-beyond)
        };
        f64::min(1.0, 2.0 * tail)
    };
    InOrder { p_value: p_value(rising.abs_diff(falling)), least_p_value: p_value(most) }
}

/// Of the rising less the falling pairs among so many values in a random order.
fn variance_of(count: usize) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "files of a folder")]
    let count = count as f64;
    count * (count - 1.0) * (2.0 * count + 5.0) / 18.0
}

/// How likely each number of pairs of an earlier and a later value is to rise (Mann and Whitney): the largest of all values
/// is a later one, and above all earlier ones, or an earlier one, and above none.
fn rising_pairs(num_earlier: usize, num_later: usize) -> Vec<f64> {
    // Of no later values, by the number of earlier ones.
    let mut by_earlier = vec![vec![1.0]; num_earlier + 1];
    for later in 1..=num_later {
        by_earlier[0] = vec![1.0];
        for earlier in 1..=num_earlier {
            #[expect(clippy::cast_precision_loss, reason = "at most forty")]
            let is_later = later as f64 / (earlier + later) as f64;
            let mut chances = vec![0.0; earlier * later + 1];
            for (rising, chance) in by_earlier[earlier].iter().enumerate() {
                chances[rising + earlier] += is_later * chance;
            }
            for (rising, chance) in by_earlier[earlier - 1].iter().enumerate() {
                chances[rising] += (1.0 - is_later) * chance;
            }
            by_earlier[earlier] = chances;
        }
    }
    by_earlier.pop().unwrap_or_default()
}

/// The distribution of the sum of two independent numbers.
fn sum_of(a: &[f64], b: &[f64]) -> Vec<f64> {
    let mut sums = vec![0.0; a.len() + b.len() - 1];
    for (at_a, chance_a) in a.iter().enumerate() {
        for (at_b, chance_b) in b.iter().enumerate() {
            sums[at_a + at_b] += chance_a * chance_b;
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn assert_near(found: f64, expected: f64) {
        assert!((found - expected).abs() < 1e-12, "{found}, expected {expected}");
    }

    #[test]
    fn the_exact_probabilities_are_those_of_counted_orders() {
        // Of 120 orders of five values one rises throughout and one falls; four each have one pair the other way.
        let times = [0.0, 1.0, 2.0, 3.0, 4.0];
        let whole = [Range { start: 0, end: 5 }];
        let found = in_order(&times, &[1.0, 2.0, 3.0, 4.0, 5.0], &whole);
        assert_near(found.p_value, 2.0 / 120.0);
        assert_near(found.least_p_value, 2.0 / 120.0);
        assert_near(in_order(&times, &[5.0, 4.0, 3.0, 1.0, 2.0], &whole).p_value, 10.0 / 120.0);
        // Two stretches of three and two: six orders times two.
        let found = in_order(&times, &[1.0, 2.0, 3.0, -8.0, -7.0], &[0..3, 3..5]);
        assert_near(found.p_value, 2.0 / 12.0);
        // Two at once, then three at once: of ten ways to choose the two, one puts both below.
        let found = in_order(&[0.0, 0.0, 1.0, 1.0, 1.0], &[1.0, 2.0, 5.0, 3.0, 4.0], &whole);
        assert_near(found.p_value, 2.0 / 10.0);
        assert_near(in_order(&[], &[], &[]).p_value, 1.0);
        assert_near(in_order(&times, &[0.0; 5], &whole).p_value, 1.0);
    }

    #[test]
    fn the_normal_distribution_goes_on_where_the_exact_one_ends() {
        // Rising values, the first 25 of them falling: 300 of 780 pairs.
        let times: Vec<f64> = (0..40).map(f64::from).collect();
        let mut values = times.clone();
        values[..25].reverse();
        let whole = Range { start: 0, end: times.len() };
        let exact = in_order(&times, &values, &[whole]).p_value;
        let normal = 2.0 * stats::normal_cdf(-(780.0 - 600.0 - 1.0) / variance_of(40).sqrt());
        assert!((exact / normal - 1.0).abs() < 0.03, "{exact} and {normal}");
        // Forty-one are no longer counted, and forty more pairs in order are less likely.
        let times: Vec<f64> = (0..41).map(f64::from).collect();
        let mut values = times.clone();
        values[..25].reverse();
        let whole = Range { start: 0, end: times.len() };
        let next = in_order(&times, &values, &[whole]).p_value;
        assert!(next < exact && next > 0.3 * exact, "{next} after {exact}");
    }
}
