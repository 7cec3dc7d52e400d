//! Seeded randomness for simulation: the same seed gives the same session everywhere.

use std::f64::consts::TAU;

use rand_core::{RngCore, SeedableRng};
use rand_pcg::Pcg64;

use crate::geometry::Vec3;

/// A generator of uniform and normal numbers.
#[derive(Clone, Debug)]
pub struct Random(Pcg64);

impl Random {
    /// A stream of its own for each purpose, so that switching one kind of noise on leaves the others as they were.
    #[must_use]
    pub fn new(seed: u64, stream: u64) -> Self {
        /// The golden ratio in 64 bits: spreads neighbouring streams over all seeds.
        const SPREAD: u64 = 0x9e37_79b9_7f4a_7c15;
        Self(Pcg64::seed_from_u64(seed ^ stream.wrapping_mul(SPREAD)))
    }

    /// Uniform in [0, 1).
    #[expect(clippy::cast_precision_loss, reason = "53 bits are exact")]
    pub fn unit(&mut self) -> f64 {
        const SCALE: f64 = 1.0 / 9_007_199_254_740_992.0;
        (self.0.next_u64() >> 11) as f64 * SCALE
    }

    /// Any 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0.next_u64()
    }

    /// Any byte.
    pub fn byte(&mut self) -> u8 {
        self.bits().to_le_bytes()[0]
    }

    /// Uniform in [-1, 1).
    pub fn signed_unit(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }

    /// A normal number of unit variance, by Box and Muller.
    pub fn normal(&mut self) -> f64 {
        // 1 − u is never 0, so the logarithm is finite.
        let radius = (-2.0 * (1.0 - self.unit()).ln()).sqrt();
        radius * (TAU * self.unit()).cos()
    }

    /// Three independent normal numbers of unit variance.
    pub fn normal3(&mut self) -> Vec3 {
        let x = self.normal();
        let y = self.normal();
        Vec3::new(x, y, self.normal())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normal_numbers_have_zero_mean_and_unit_variance() {
        const NUM: u32 = 40_000;
        let mut random = Random::new(3, 1);
        let values: Vec<f64> = (0..NUM).map(|_| random.normal()).collect();
        let mean = values.iter().sum::<f64>() / f64::from(NUM);
        let variance = values.iter().map(|v| v * v).sum::<f64>() / f64::from(NUM);
        // Five standard deviations of the estimates: 1/√n and √(2/n).
        assert!(mean.abs() < 0.025, "{mean}");
        assert!((variance - 1.0).abs() < 0.036, "{variance}");
    }

    #[test]
    fn streams_of_one_seed_differ() {
        assert!((Random::new(1, 0).unit() - Random::new(1, 1).unit()).abs() > f64::EPSILON);
        assert!((Random::new(1, 1).unit() - Random::new(1, 1).unit()).abs() < f64::EPSILON);
    }
}
