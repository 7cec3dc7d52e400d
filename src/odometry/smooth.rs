//! Step 3 of the patent: the picture is smoothed; and made smaller, for tracking from coarse to fine.

use super::grey::Grey;

/// Pictures smaller than this show nothing to track, px.
const LEAST_SIDE_PX: usize = 24;

/// The picture smoothed with the binomial weights ¼, ½, ¼ across and down: σ = 0.7 px, enough against the noise of single
/// pixels, little enough for corners to stay where they are.
#[must_use]
pub fn smoothed(grey: &Grey) -> Grey {
    let (width, height) = (grey.width(), grey.height());
    if width < 2 || height < 2 {
        return grey.clone();
    }
    let mut values = vec![0.0; width * height];
    // A value beyond each end saves the question whether there is a neighbour.
    let mut column = vec![0.0; width + 2];
    for (row, out) in values.chunks_exact_mut(width).enumerate() {
        let here = grey.row(row);
        let above = grey.row(row.saturating_sub(1));
        let below = grey.row((row + 1).min(height - 1));
        for (((sum, above), here), below) in column[1..=width].iter_mut().zip(above).zip(here).zip(below) {
            *sum = 0.25 * (above + below) + 0.5 * here;
        }
        column[0] = column[1];
        column[width + 1] = column[width];
        for (((value, left), middle), right) in out.iter_mut().zip(&column).zip(&column[1..]).zip(&column[2..]) {
            *value = 0.25 * (left + right) + 0.5 * middle;
        }
    }
    Grey::from_rows(width, values)
}

/// The picture at half the size, smoothed with the binomial weights of five before; its pixel (i, j) lies on (2i, 2j).
#[must_use]
pub fn halved(grey: &Grey) -> Grey {
    const WEIGHTS: [f32; 5] = [0.0625, 0.25, 0.375, 0.25, 0.0625];
    let (width, height) = (grey.width(), grey.height());
    let (half_width, half_height) = (width.div_ceil(2), height.div_ceil(2));
    let mut values = vec![0.0; half_width * half_height];
    let mut column = vec![0.0; width + 4];
    for (row, out) in values.chunks_exact_mut(half_width.max(1)).enumerate() {
        let middle = (2 * row).cast_signed();
        let rows: [&[f32]; 5] = [-2, -1, 0, 1, 2].map(|offset| grey.row_clamped(middle + offset));
        for (idx, sum) in column[2..width + 2].iter_mut().enumerate() {
            *sum = (rows[0][idx] + rows[4][idx]) * WEIGHTS[0]
                + (rows[1][idx] + rows[3][idx]) * WEIGHTS[1]
                + rows[2][idx] * WEIGHTS[2];
        }
        for side in [0, 1] {
            column[side] = column[2];
            column[width + 2 + side] = column[width + 1];
        }
        for (value, window) in out.iter_mut().zip(column.windows(5).step_by(2)) {
            *value =
                (window[0] + window[4]) * WEIGHTS[0] + (window[1] + window[3]) * WEIGHTS[1] + window[2] * WEIGHTS[2];
        }
    }
    Grey::from_rows(half_width, values)
}

/// The picture and its halves, finest first: as many as asked for, as long as there is something left to see.
#[must_use]
pub fn pyramid(finest: Grey, num_levels: usize) -> Vec<Grey> {
    let mut levels = vec![finest];
    while let Some(last) = levels.last()
        && levels.len() < num_levels
        && last.width().min(last.height()) >= 2 * LEAST_SIDE_PX
    {
        levels.push(halved(last));
    }
    levels
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp(width: u8, height: u8) -> Grey {
        let value = |x, y| 2.0 * f32::from(x) + 3.0 * f32::from(y);
        Grey::from_rows(usize::from(width), (0..height).flat_map(|y| (0..width).map(move |x| value(x, y))).collect())
    }

    #[test]
    fn a_slope_keeps_its_values_away_from_the_border() {
        let slope = ramp(61, 51);
        let smooth = smoothed(&slope);
        let half = halved(&slope);
        assert_eq!((half.width(), half.height()), (31, 26));
        for (x, y) in [(4, 4), (20, 10), (25, 22)] {
            assert!((smooth.row(y)[x] - slope.row(y)[x]).abs() < 1e-4);
            assert!((half.row(y)[x] - slope.row(2 * y)[2 * x]).abs() < 1e-4);
        }
    }

    #[test]
    fn small_pictures_have_few_levels() {
        assert_eq!(pyramid(ramp(200, 150), 4).len(), 3);
        assert_eq!(pyramid(ramp(1, 1), 4).len(), 1);
        assert_eq!(smoothed(&ramp(1, 5)), ramp(1, 5));
    }
}
