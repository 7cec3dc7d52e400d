//! A grey picture in floating point, as smoothing, corners and tracking need it.

use image::RgbImage;

/// Parts of red, green and blue in a grey value (ITU-R BT.601), of 256.
const RED_GREEN_BLUE: [u16; 3] = [77, 150, 29];

/// A grey picture; values from 0 to 255.
#[derive(Clone, Debug, PartialEq)]
pub struct Grey {
    width: usize,
    height: usize,
    values: Vec<f32>,
}

impl Grey {
    /// Of a colour picture.
    #[must_use]
    pub fn of(color: &RgbImage) -> Self {
        let (width, height) = (color.width() as usize, color.height() as usize);
        let (pixels, _) = color.as_raw().as_chunks::<3>();
        let mut values = vec![0.0; width * height];
        for (value, rgb) in values.iter_mut().zip(pixels) {
            let sum: u16 = (0..3).map(|channel| RED_GREEN_BLUE[channel] * u16::from(rgb[channel])).sum();
            *value = f32::from(sum) / 256.0;
        }
        Self { width, height, values }
    }

    /// Of so many rows of values.
    ///
    /// A last row that is not complete is left out.
    #[must_use]
    pub fn from_rows(width: usize, mut values: Vec<f32>) -> Self {
        let height = values.len().checked_div(width).unwrap_or(0);
        values.truncate(width * height);
        Self { width, height, values }
    }

    /// Pixels across.
    #[must_use]
    pub const fn width(&self) -> usize {
        self.width
    }

    /// Pixels down.
    #[must_use]
    pub const fn height(&self) -> usize {
        self.height
    }

    /// A row, from the top.
    #[must_use]
    pub fn row(&self, row: usize) -> &[f32] {
        &self.values[row * self.width..(row + 1) * self.width]
    }

    /// The row nearest to one that may lie outside.
    #[must_use]
    pub fn row_clamped(&self, row: isize) -> &[f32] {
        self.row(row.max(0).unsigned_abs().min(self.height - 1))
    }

    /// All values, row by row.
    #[must_use]
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// The value between pixels; `None` outside the picture.
    #[must_use]
    pub fn sample(&self, x: f32, y: f32) -> Option<f32> {
        let (column, row) = (whole(x)?, whole(y)?);
        if column + 1 >= self.width || row + 1 >= self.height {
            return None;
        }
        let at = row * self.width + column;
        let (upper, lower) = (self.values.get(at..at + 2)?, self.values.get(at + self.width..at + self.width + 2)?);
        let (right, down) = (x - as_float(column), y - as_float(row));
        let above = upper[0] + right * (upper[1] - upper[0]);
        let below = lower[0] + right * (lower[1] - lower[0]);
        Some(above + down * (below - above))
    }
}

/// The whole part of a coordinate; `None` below 0, beyond every image, and of what is no number.
#[must_use]
pub fn whole(value: f32) -> Option<usize> {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within the range of u16")]
    (0.0..65_536.0).contains(&value).then(|| usize::from(value as u16))
}

/// A coordinate that [`whole`] gave, as a number again.
#[must_use]
pub fn as_float(whole: usize) -> f32 {
    u16::try_from(whole).map_or(0.0, f32::from)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ramp_is_sampled_as_one() {
        let ramp = Grey::from_rows(4, (0..3_u8).flat_map(|y| (0..4_u8).map(move |x| f32::from(10 * y + x))).collect());
        assert_eq!(ramp.sample(1.25, 0.5), Some(6.25));
        for (x, y) in [(-0.1, 0.0), (3.0, 0.0), (0.0, 2.0), (f32::NAN, 0.0), (f32::INFINITY, 1.0)] {
            assert_eq!(ramp.sample(x, y), None, "{x} {y}");
        }
    }

    #[test]
    fn grey_weighs_green_most() {
        let color = RgbImage::from_raw(2, 1, vec![255, 255, 255, 0, 128, 0]).unwrap_or_default();
        assert_eq!(Grey::of(&color).values(), [255.0, 75.0]);
    }
}
