//! Step 3 of the patent: depth that is invalid or not stable is left out.
//!
//! Invalid are 0 and what lies outside the camera's range. Not stable are pixels at an edge, where the depth jumps and a
//! fraction of a pixel decides between front and back; and pixels whose depth flickers from frame to frame. The former are seen in
//! one image. The latter are told by [`DepthNoise::agree`], where a point of an earlier frame is seen again: only there the
//! camera's motion is known, and only there depth is used.

use super::camera::DepthImage;

/// How noisy depth is: σ = `at_zero_mm` + `per_mm` z². For a triangulating camera the noise grows with the square of the
/// distance, as the disparity is what is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthNoise {
    /// σ close by, mm.
    pub at_zero_mm: f64,
    /// How fast it grows, 1/mm.
    pub per_mm: f64,
}

impl DepthNoise {
    /// A Kinect of the first kind: 6 mm at 2 m, 23 mm at 4 m (Khoshelham & Elberink 2012).
    pub const KINECT: Self = Self { at_zero_mm: 0.5, per_mm: 1.425e-6 };

    /// Standard deviation of a depth, mm.
    #[must_use]
    pub fn std_mm(&self, z_mm: f64) -> f64 {
        self.at_zero_mm + self.per_mm * z_mm * z_mm
    }

    /// Whether a depth can be the expected one, which itself is known with a variance (mm²).
    #[must_use]
    pub fn agree(&self, z_mm: f64, expected_mm: f64, expected_variance: f64) -> bool {
        /// Of depth that is only noisy, one in 15,000 lies farther off.
        const LIMIT_STDS: f64 = 4.0;
        let std = self.std_mm(z_mm);
        let off = z_mm - expected_mm;
        off * off <= LIMIT_STDS * LIMIT_STDS * (std * std + expected_variance)
    }
}

/// What depth is used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthFilter {
    /// Nearer is invalid, mm.
    pub min_mm: f64,
    /// Farther is invalid, mm.
    pub max_mm: f64,
    /// A greater step between neighbours, for the distance, is an edge: 0.03 is 60 mm at 2 m.
    pub jump_ratio: f64,
}

impl Default for DepthFilter {
    fn default() -> Self {
        Self { min_mm: 200.0, max_mm: 8000.0, jump_ratio: 0.03 }
    }
}

impl DepthFilter {
    /// The depth image with 0 for everything that is invalid or at an edge. A missing neighbour makes no edge.
    #[must_use]
    pub fn clean(&self, depth: &DepthImage, mm_per_unit: f64) -> DepthImage {
        let (width, height) = (depth.width() as usize, depth.height() as usize);
        let mut cleaned = DepthImage::new(depth.width(), depth.height());
        if width == 0 || height == 0 {
            return cleaned;
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to the range of u16")]
        let units = |mm: f64| (mm / mm_per_unit).clamp(1.0, 65_535.0) as u16;
        let (min, max) = (units(self.min_mm), units(self.max_mm));
        // In 65536ths, so that sixteen bits times sixteen bits say it all.
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to the range of u16")]
        let ratio = (self.jump_ratio * 65_536.0).clamp(0.0, 65_535.0) as u16;
        let row = |row: usize| &depth.as_raw()[row * width..(row + 1) * width];
        // The least and greatest depth of three rows; a missing one is neither.
        let (mut least, mut most) = (vec![u16::MAX; width + 2], vec![0; width + 2]);
        for (idx, out) in cleaned.chunks_exact_mut(width).enumerate() {
            let rows = [row(idx.saturating_sub(1)), row(idx), row((idx + 1).min(height - 1))];
            for column in 0..width {
                let [a, b, c] = [rows[0][column], rows[1][column], rows[2][column]];
                // 0 becomes the greatest number, and stays behind every other.
                let [fa, fb, fc] = [a, b, c].map(|value| value.wrapping_sub(1));
                least[column + 1] = fa.min(fb).min(fc);
                most[column + 1] = a.max(b).max(c);
            }
            for (column, (out, here)) in out.iter_mut().zip(rows[1]).enumerate() {
                let nearest = least[column].min(least[column + 1]).min(least[column + 2]).wrapping_add(1);
                let farthest = most[column].max(most[column + 1]).max(most[column + 2]);
                let allowed = (u32::from(*here) * u32::from(ratio)) >> 16;
                let is_stable = u32::from(farthest.saturating_sub(nearest)) <= allowed;
                *out = if is_stable && *here >= min && *here <= max { *here } else { 0 };
            }
        }
        cleaned
    }
}

/// The part of the pixels that have a depth.
#[must_use]
pub fn valid_ratio(depth: &DepthImage) -> f64 {
    let valid = depth.iter().filter(|value| **value != 0).count();
    #[expect(clippy::cast_precision_loss, reason = "a count of pixels")]
    let ratio = valid as f64 / depth.len().max(1) as f64;
    ratio
}

/// The depth between pixels, mm: between the four around it, or the one that is there.
#[must_use]
pub fn depth_at(depth: &DepthImage, [x, y]: [f64; 2], mm_per_unit: f64) -> Option<f64> {
    let is_inside = |value: f64, side: u32| value >= 0.0 && value <= f64::from(side) - 1.0;
    if !is_inside(x, depth.width()) || !is_inside(y, depth.height()) {
        return None;
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within the image")]
    let (column, row) = (x as u32, y as u32);
    let at = |column: u32, row: u32| depth.get_pixel_checked(column, row).map_or(0.0, |pixel| f64::from(pixel.0[0]));
    let (right, down) = (x.fract(), y.fract());
    // Where a neighbour has no depth, those that have share its weight.
    let corners = [
        (at(column, row), (1.0 - right) * (1.0 - down)),
        (at(column + 1, row), right * (1.0 - down)),
        (at(column, row + 1), (1.0 - right) * down),
        (at(column + 1, row + 1), right * down),
    ];
    let (sum, weight) = corners
        .into_iter()
        .filter(|(value, _)| *value > 0.0)
        .fold((0.0, 0.0), |(sum, total), (value, weight)| (sum + weight * value, total + weight));
    (weight > 0.25).then(|| sum / weight * mm_per_unit)
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Luma;

    /// A wall at 2 m with a box before it at 1.5 m, millimetres; one pixel has no depth.
    fn wall_with_box() -> DepthImage {
        DepthImage::from_fn(20, 16, |x, y| match (x, y) {
            (15, 12) => Luma([0]),
            (5..10, 4..9) => Luma([1500]),
            _ => Luma([2000]),
        })
    }

    #[test]
    fn edges_and_what_is_out_of_range_are_left_out() {
        let depth = wall_with_box();
        let cleaned = DepthFilter::default().clean(&depth, 1.0);
        // Away from the box, next to a hole, within the box: stable. On either side of its edge: not.
        for (x, y, expected) in
            [(0, 0, 2000), (14, 12, 2000), (7, 6, 1500), (5, 6, 0), (4, 6, 0), (10, 9, 0), (15, 12, 0)]
        {
            assert_eq!(cleaned.get_pixel(x, y).0[0], expected, "{x} {y}");
        }
        let near = DepthFilter { max_mm: 1800.0, ..DepthFilter::default() }.clean(&depth, 1.0);
        assert_eq!((near.get_pixel(0, 0).0[0], near.get_pixel(7, 6).0[0]), (0, 1500));
        let far = DepthFilter { min_mm: 1800.0, ..DepthFilter::default() }.clean(&depth, 1.0);
        assert_eq!((far.get_pixel(0, 0).0[0], far.get_pixel(7, 6).0[0]), (2000, 0));
        // In fifths of a millimetre the same wall is at 0.4 m.
        let fifths = DepthFilter { min_mm: 350.0, ..DepthFilter::default() }.clean(&depth, 0.2);
        assert_eq!((fifths.get_pixel(0, 0).0[0], fifths.get_pixel(7, 6).0[0]), (2000, 0));
        assert_eq!(DepthFilter::default().clean(&DepthImage::new(0, 0), 1.0), DepthImage::new(0, 0));
    }

    #[test]
    fn a_slanted_wall_is_stable() {
        // 20 mm a pixel at 2 m is a wall seen at 80° from its normal by a camera of 570 px.
        let slanted = DepthImage::from_fn(30, 4, |x, _| Luma([u16::try_from(2000 + 20 * x).unwrap_or(0)]));
        assert_eq!(DepthFilter::default().clean(&slanted, 1.0), slanted);
    }

    #[test]
    fn depth_is_read_between_pixels() {
        let depth = DepthImage::from_fn(3, 2, |x, y| {
            Luma([if x == 2 { 0 } else { u16::try_from(1000 + 10 * x + 4 * y).unwrap_or(0) }])
        });
        assert_eq!(depth_at(&depth, [0.5, 0.5], 2.0), Some(2014.0));
        // The one on the left alone, and nothing where it has hardly a say.
        assert_eq!(depth_at(&depth, [1.5, 0.0], 1.0), Some(1010.0));
        assert_eq!(depth_at(&depth, [1.9, 0.0], 1.0), None);
        assert_eq!(depth_at(&depth, [2.1, 0.0], 1.0), None);
        assert_eq!(depth_at(&depth, [f64::NAN, 0.0], 1.0), None);
    }

    #[test]
    fn flicker_is_told_from_noise() {
        let noise = DepthNoise::KINECT;
        assert!((noise.std_mm(2000.0) - 6.2).abs() < 0.1);
        assert!(noise.agree(2020.0, 2000.0, 0.0) && !noise.agree(2030.0, 2000.0, 0.0));
        assert!(noise.agree(2030.0, 2000.0, 100.0));
    }
}
