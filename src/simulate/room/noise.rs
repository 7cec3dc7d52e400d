//! What becomes of light and range on the way to an image: exposure, noise, disparity, holes.
//!
//! # Source
//! The depth follows K. Khoshelham, S. Oude Elberink, "Accuracy and resolution of Kinect depth data for indoor mapping
//! applications", Sensors 12 (2012) 1437–1454: the distance is the inverse of a disparity that is measured with an error of half
//! a unit and counted in whole units, where a unit is 2.85e-5 of an inverse centimetre. So the error grows with the square of
//! the distance: 1.4 mm at 1 m, 36 mm at 5 m.

use crate::scene::Random;

use super::render::{Light, Range};
use super::texture::narrow;

/// The noise of both cameras. Everything zero is a perfect camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraNoise {
    /// Standard deviation of a colour in the dark, levels of 255.
    pub color_std: f64,
    /// What each level of brightness adds to its variance.
    pub color_variance_per_level: f64,
    /// How far the exposure wanders either way, as a part of it.
    pub exposure_change: f64,
    /// How bright the bands are that roll through the image under lamps on alternating current, as a part of it.
    pub rolling_bands: f64,
    /// The depth camera's.
    pub depth: DepthNoise,
}

/// The noise of a depth camera that sees a projected pattern.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthNoise {
    /// One unit of the disparity, 1/mm; 0 for depth without noise and rounding.
    pub disparity_unit_per_mm: f64,
    /// Standard deviation of the disparity, units, the rounding to whole units included.
    pub disparity_std: f64,
    /// How far beside its pixel a depth may be measured, pixels: shapes get ragged edges.
    pub beside_std_px: f64,
    /// How far left of the camera the projector is, mm: next to near shapes its shadow has no depth. 0 for none.
    pub projector_mm: f64,
    /// Steeper than this cosine, more and more pixels have no depth.
    pub grazing_cos: f64,
    /// Share of pixels without depth anywhere.
    pub lost_share: f64,
    /// Nearest and farthest depth, mm.
    pub range_mm: [f64; 2],
}

impl CameraNoise {
    /// That of a Kinect of 2010.
    pub const KINECT: Self = Self {
        color_std: 1.0,
        color_variance_per_level: 0.015,
        exposure_change: 0.05,
        rolling_bands: 0.01,
        depth: DepthNoise {
            disparity_unit_per_mm: 2.85e-6,
            disparity_std: 0.5,
            beside_std_px: 0.4,
            projector_mm: 75.0,
            grazing_cos: 0.25,
            lost_share: 0.002,
            range_mm: [400.0, 8000.0],
        },
    };
    /// Perfect cameras.
    pub const NONE: Self = Self {
        color_std: 0.0,
        color_variance_per_level: 0.0,
        exposure_change: 0.0,
        rolling_bands: 0.0,
        depth: DepthNoise {
            disparity_unit_per_mm: 0.0,
            disparity_std: 0.0,
            beside_std_px: 0.0,
            projector_mm: 0.0,
            grazing_cos: 0.0,
            lost_share: 0.0,
            range_mm: [0.0, f64::INFINITY],
        },
    };

    /// The same with another colour noise in the dark, and in the light in proportion.
    #[must_use]
    pub fn with_color_std(self, color_std: f64) -> Self {
        let ratio = color_std / Self::KINECT.color_std;
        let color_variance_per_level = Self::KINECT.color_variance_per_level * ratio * ratio;
        Self { color_std, color_variance_per_level, ..self }
    }

    /// Exposes the light of an image with so many columns. `exposure` is 1 where it is right, `phase` where the bands begin.
    pub(super) fn expose(
        &self,
        Light(light): &mut Light,
        columns: usize,
        exposure: f64,
        phase: f64,
        random: &mut Random,
    ) {
        let [floor, per_level] = [self.color_std * self.color_std, self.color_variance_per_level].map(narrow);
        let is_noisy = floor > 0.0 || per_level > 0.0;
        let num_rows = light.len() / columns;
        for (row, line) in light.chunks_exact_mut(columns).enumerate() {
            let gain = narrow(exposure * (1.0 + self.rolling_bands * zigzag(phase + portion(row, num_rows))));
            for pixel in line {
                for value in pixel {
                    let exact = *value * gain;
                    *value =
                        if is_noisy { exact + (floor + per_level * exact).sqrt() * bell(random.bits()) } else { exact };
                }
            }
        }
    }
}

impl DepthNoise {
    /// The depth that is measured, mm, row by row; 0 where none is. `focal_px` is the camera's, along the rows.
    pub(super) fn measure(&self, range: &Range, columns: usize, focal_px: f64, random: &mut Random) -> Vec<f64> {
        // Rounding to whole units is a part of the error: a twelfth of a unit squared.
        let own_std = (self.disparity_std * self.disparity_std - 1.0 / 12.0).max(0.0).sqrt();
        let num_rows = range.z_mm.len() / columns;
        let mut measured = Vec::with_capacity(range.z_mm.len());
        let mut is_lit = vec![true; columns];
        for row in 0..num_rows {
            let line = &range.z_mm[row * columns..(row + 1) * columns];
            self.find_shadow(line, focal_px, &mut is_lit);
            for column in 0..columns {
                let bits = random.bits();
                let beside =
                    |shift: u32, at: usize, num: usize| moved(at, num, self.beside_std_px * two_bytes(bits >> shift));
                let source_column = beside(0, column, columns);
                let source = beside(16, row, num_rows) * columns + source_column;
                let chance = f64::from((bits >> 32) as u32) / f64::from(u32::MAX);
                let z_mm = range.z_mm[source];
                let is_seen = is_lit[source_column]
                    && chance >= self.lost_share + self.loss_by_grazing(f64::from(range.incidence_cos[source]))
                    && (self.range_mm[0]..=self.range_mm[1]).contains(&z_mm);
                measured.push(if is_seen { self.rounded(z_mm, own_std, random) } else { 0.0 });
            }
        }
        measured
    }

    fn rounded(&self, z_mm: f64, own_std: f64, random: &mut Random) -> f64 {
        if self.disparity_unit_per_mm <= 0.0 {
            return z_mm;
        }
        let disparity = 1.0 / (self.disparity_unit_per_mm * z_mm) + own_std * f64::from(bell(random.bits()));
        1.0 / (self.disparity_unit_per_mm * disparity.round().max(1.0))
    }

    fn loss_by_grazing(&self, incidence_cos: f64) -> f64 {
        if incidence_cos < self.grazing_cos { 1.0 - incidence_cos / self.grazing_cos } else { 0.0 }
    }

    /// Seen from the projector's place, the columns come in their order until a near shape covers those behind it.
    fn find_shadow(&self, z_mm: &[f64], focal_px: f64, is_lit: &mut [bool]) {
        let reach = focal_px.abs() * self.projector_mm;
        let mut covered = f64::NEG_INFINITY;
        for (column, (z_mm, is_lit)) in z_mm.iter().zip(is_lit).enumerate() {
            let seen_at = portion(column, 1) + reach / z_mm;
            // Half a pixel of tolerance, so that slopes do not cover themselves.
            *is_lit = seen_at > covered - 0.5;
            covered = covered.max(seen_at);
        }
    }
}

/// A whole number of places on or back, within the image.
#[expect(clippy::cast_possible_truncation, reason = "a cast of a float saturates, and the place is kept within")]
fn moved(at: usize, num: usize, by: f64) -> usize {
    at.saturating_add_signed(by.round() as isize).min(num - 1)
}

/// About a normal number of unit variance: the sum of two bytes.
fn two_bytes(bits: u64) -> f64 {
    const STD: f64 = 104.51;
    let [first, second, ..] = bits.to_le_bytes();
    (f64::from(first) + f64::from(second) - 255.0) / STD
}

/// Very nearly a normal number of unit variance: the sum of eight bytes, which is the same everywhere and quick.
#[expect(clippy::cast_precision_loss, reason = "a sum of bytes")]
fn bell(bits: u64) -> f32 {
    const PAIRS: u64 = 0x00ff_00ff_00ff_00ff;
    const STD: f32 = 209.02;
    let fours = (bits & PAIRS) + (bits >> 8 & PAIRS);
    let sum = fours.wrapping_mul(0x0001_0001_0001_0001) >> 48;
    (sum as f32 - 1020.0) / STD
}

/// −1 to 1 and back, once in a unit.
fn zigzag(phase: f64) -> f64 {
    4.0 * (phase - phase.floor() - 0.5).abs() - 1.0
}

#[expect(clippy::cast_precision_loss, reason = "pixels of an image")]
fn portion(at: usize, num: usize) -> f64 {
    at as f64 / num as f64
}
