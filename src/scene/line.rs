//! A laser line: the grid of a profile, its noise, and what goes wrong with single points.

use crate::geometry::Profile;

use super::{Dirt, Random, rounded};

/// Width of the line on a part, mm.
pub const LINE_WIDTH_MM: f64 = 40.0;
/// The part of the points that are spikes.
const SPIKE_RATIO: f64 = 0.015;
/// Sizes of the spikes, mm.
const SPIKE_MM: [f64; 2] = [0.5, 6.0];
/// The part of single missing points.
const MISSING_RATIO: f64 = 0.02;
/// Runs of missing points, and the part of the profile that each takes at most.
const NUM_HOLES: usize = 2;
const HOLE_RATIO: f64 = 0.06;

/// How a line is measured.
#[derive(Clone, Copy, Debug)]
pub struct Line {
    /// Points of a profile.
    pub num_points: usize,
    /// From the first to the last, mm.
    pub width_mm: f64,
    /// Noise of a point along the range axis, mm.
    pub profile_std_mm: f64,
    /// What else the profiles hold.
    pub dirt: Dirt,
    /// Decimals that coordinates are rounded to.
    pub decimals: Option<u8>,
}

impl Line {
    /// The profile of what is seen at each place across the line.
    #[must_use]
    pub fn profile(&self, noise: &mut Random, dirt: &mut Random, seen_z_mm: impl Fn(f64) -> Option<f64>) -> Profile {
        let x_mm: Vec<f64> = (0..self.num_points).map(|idx| rounded(self.grid_x_mm(idx), self.decimals)).collect();
        let mut z_mm: Vec<Option<f64>> = x_mm
            .iter()
            .map(|x| {
                // Drawn for every point, so that what one point hits does not shift the noise of the next.
                let error_mm = self.profile_std_mm * noise.normal();
                Some(seen_z_mm(*x)? + error_mm)
            })
            .collect();
        if self.dirt.has_spikes {
            add_spikes(&mut z_mm, dirt);
        }
        if self.dirt.has_holes {
            add_holes(&mut z_mm, dirt);
        }
        for z in z_mm.iter_mut().flatten() {
            *z = rounded(*z, self.decimals);
        }
        checked_profile(x_mm, &z_mm)
    }

    #[expect(clippy::cast_precision_loss, reason = "a profile has far fewer than 2^52 points")]
    fn grid_x_mm(&self, idx: usize) -> f64 {
        let part = idx as f64 / (self.num_points - 1) as f64;
        (part - 0.5) * self.width_mm
    }
}

fn add_spikes(z_mm: &mut [Option<f64>], dirt: &mut Random) {
    for z in z_mm.iter_mut().flatten() {
        if dirt.unit() < SPIKE_RATIO {
            let size_mm = SPIKE_MM[0] + (SPIKE_MM[1] - SPIKE_MM[0]) * dirt.unit();
            *z += size_mm * dirt.signed_unit().signum();
        }
    }
}

#[expect(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "positions in a profile: small, and not negative"
)]
fn add_holes(z_mm: &mut [Option<f64>], dirt: &mut Random) {
    let len = z_mm.len() as f64;
    for _ in 0..NUM_HOLES {
        let start = (dirt.unit() * len) as usize;
        let end = start + (dirt.unit() * HOLE_RATIO * len) as usize;
        for z in z_mm.iter_mut().take(end).skip(start) {
            *z = None;
        }
    }
    for z in z_mm {
        if dirt.unit() < MISSING_RATIO {
            *z = None;
        }
    }
}

#[expect(clippy::expect_used, reason = "the options' limits keep every point within a profile's")]
fn checked_profile(x_mm: Vec<f64>, z_mm: &[Option<f64>]) -> Profile {
    Profile::new(x_mm, z_mm).expect("simulated points are finite and within reach")
}
