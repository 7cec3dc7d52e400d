//! Step 5 of the patent, second half: what a corner's surroundings look like, in 256 bits.
//!
//! Each bit says which of two places nearby is brighter (BRIEF, Calonder et al. 2010). The places turn with the picture,
//! whose direction at a corner is that from the corner to its centre of brightness (Rublee et al. 2011).

use std::f32::consts::TAU;

use crate::geometry::stats::SplitMix;

use super::grey::Grey;

/// Comparisons.
const NUM_BITS: usize = 256;
/// Places of comparisons lie within this of the corner, px of the picture they are taken from.
const RADIUS: f32 = 9.0;
/// Directions told apart.
const NUM_DIRECTIONS: usize = 30;
/// Whatever the seed, all pictures must be compared at the same places.
const SEED: u64 = 0x0b21_ef00;

/// What a corner looks like.
pub type Descriptor = [u64; NUM_BITS / 64];

/// In how many comparisons two differ.
#[must_use]
pub fn distance(a: &Descriptor, b: &Descriptor) -> u32 {
    a.iter().zip(b).map(|(a, b)| (a ^ b).count_ones()).sum()
}

/// The places that are compared, for every direction.
#[derive(Clone, Debug)]
pub struct Pattern {
    of_direction: Vec<Vec<[[f32; 2]; 2]>>,
}

impl Default for Pattern {
    fn default() -> Self {
        let mut random = SplitMix::new(SEED);
        let mut place = || {
            loop {
                // The mean of several even draws lies mostly near the middle, where the surroundings tell most.
                let mut draw = || {
                    let sum: usize = (0..3).map(|_| random.below(1000)).sum();
                    (u16::try_from(sum).map_or(0.0, f32::from) / 1498.5 - 1.0) * 1.4 * RADIUS
                };
                let place = [draw(), draw()];
                if place[0].hypot(place[1]) <= RADIUS {
                    return place;
                }
            }
        };
        let upright: Vec<[[f32; 2]; 2]> = (0..NUM_BITS).map(|_| [place(), place()]).collect();
        #[expect(clippy::cast_precision_loss, reason = "a few directions")]
        let turned = |direction: usize| {
            let (sin, cos) = (direction as f32 * TAU / NUM_DIRECTIONS as f32).sin_cos();
            let turn = |[x, y]: [f32; 2]| [cos * x - sin * y, sin * x + cos * y];
            upright.iter().map(|pair| pair.map(turn)).collect()
        };
        Self { of_direction: (0..NUM_DIRECTIONS).map(turned).collect() }
    }
}

impl Pattern {
    /// Describes a place of a picture; `None` too near to its border. The picture should be smooth: the half-size one is.
    #[must_use]
    pub fn describe(&self, grey: &Grey, [x, y]: [f32; 2]) -> Option<Descriptor> {
        let direction = direction(grey, [x, y])?;
        let mut bits = [0; NUM_BITS / 64];
        for (idx, [a, b]) in self.of_direction[direction].iter().enumerate() {
            let is_brighter = grey.sample(x + a[0], y + a[1])? > grey.sample(x + b[0], y + b[1])?;
            bits[idx / 64] |= u64::from(is_brighter) << (idx % 64);
        }
        Some(bits)
    }
}

/// The direction from a place to the centre of brightness around it, in steps.
fn direction(grey: &Grey, [x, y]: [f32; 2]) -> Option<usize> {
    const REACH: i8 = 7;
    let (mut sum_x, mut sum_y) = (0.0, 0.0);
    for dy in -REACH..=REACH {
        for dx in -REACH..=REACH {
            if i16::from(dx) * i16::from(dx) + i16::from(dy) * i16::from(dy) > i16::from(REACH) * i16::from(REACH) {
                continue;
            }
            let (dx, dy) = (f32::from(dx), f32::from(dy));
            let value = grey.sample(x + dx, y + dy)?;
            sum_x += dx * value;
            sum_y += dy * value;
        }
    }
    #[expect(clippy::cast_precision_loss, reason = "a few directions")]
    let steps = (sum_y.atan2(sum_x).rem_euclid(TAU) / TAU * NUM_DIRECTIONS as f32).round();
    Some(super::grey::whole(steps)? % NUM_DIRECTIONS)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A pattern without symmetry, turned about (40, 40).
    fn picture(angle: f32) -> Grey {
        let (sin, cos) = angle.sin_cos();
        let value = |x: f32, y: f32| {
            let (x, y) = (x - 40.0, y - 40.0);
            let (x, y) = (cos * x + sin * y, cos * y - sin * x);
            128.0 + 60.0 * (0.5 * x).sin() * (0.37 * y).cos() + 3.0 * x
        };
        let values = (0..80_u8).flat_map(|y| (0..80_u8).map(move |x| value(f32::from(x), f32::from(y))));
        Grey::from_rows(80, values.collect())
    }

    #[test]
    fn a_place_is_known_again_when_it_is_turned_and_from_others() {
        let pattern = Pattern::default();
        let known = pattern.describe(&picture(0.0), [40.0, 40.0]).expect("inside");
        for angle in [0.0, 0.7, 2.0, -2.9] {
            let turned = pattern.describe(&picture(angle), [40.0, 40.0]).expect("inside");
            // Directions are told apart to 12°, and half of that moves some places to the other side.
            assert!(distance(&known, &turned) < 50, "{angle}: {}", distance(&known, &turned));
        }
        let other = pattern.describe(&picture(0.0), [44.0, 36.0]).expect("inside");
        assert!(distance(&known, &other) > 64, "{}", distance(&known, &other));
        assert_eq!(pattern.describe(&picture(0.0), [5.0, 40.0]), None);
    }
}
