//! Small statistics: root mean square, median, robust spread, and a seeded generator.

/// A normal distribution's standard deviation over its median absolute deviation.
pub const STD_OVER_MAD: f64 = 1.482_602_218_505_602;

/// Root mean square; 0 for no values.
#[must_use]
pub fn rms(values: impl IntoIterator<Item = f64>) -> f64 {
    let (mut sum, mut count) = (0.0, 0_u32);
    for value in values {
        sum += value * value;
        count += 1;
    }
    if count == 0 { 0.0 } else { (sum / f64::from(count)).sqrt() }
}

/// The largest value; 0 for no values.
#[must_use]
pub fn max(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, f64::max)
}

/// The median, by partial ordering of `values` in place; NaN for no values.
#[must_use]
pub fn median(values: &mut [f64]) -> f64 {
    if values.is_empty() {
        return f64::NAN;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// A robust standard deviation about zero: the scaled median of the sizes. Orders `values` in place.
#[must_use]
pub fn robust_std_about_zero(values: &mut [f64]) -> f64 {
    for value in values.iter_mut() {
        *value = value.abs();
    }
    STD_OVER_MAD * median(values)
}

/// Vigna's `SplitMix64`: a few lines that give the same sequence on every machine.
#[derive(Clone, Debug)]
pub struct SplitMix(u64);

impl SplitMix {
    /// The sequence of a seed.
    #[must_use]
    pub const fn new(seed: u64) -> Self {
        Self(seed)
    }

    fn draw(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    /// A number below `limit`, which is above zero; the bias of the remainder is far below anything that matters here.
    pub fn below(&mut self, limit: usize) -> usize {
        #[expect(clippy::cast_possible_truncation, reason = "the remainder is below a usize")]
        let index = (self.draw() % limit as u64) as usize;
        index
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_of_a_short_list() {
        assert!((rms([3.0, 4.0]) - 12.5_f64.sqrt()).abs() < 1e-15);
        assert!(median(&mut [3.0, 1.0, 2.0]).total_cmp(&2.0).is_eq());
        assert!(max([1.0, 7.0, 2.0]).total_cmp(&7.0).is_eq());
        assert!(rms([]).abs() < f64::MIN_POSITIVE);
        assert!(median(&mut []).is_nan());
    }

    #[test]
    fn one_wild_value_does_not_move_the_robust_spread() {
        let mut values: Vec<f64> = (-50..=50).map(f64::from).collect();
        let clean = robust_std_about_zero(&mut values.clone());
        values[0] = 1e9;
        assert!((robust_std_about_zero(&mut values) - clean).abs() < 2.0);
    }
}
