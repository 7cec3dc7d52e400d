//! Where a point of one picture is in another, to a few hundredths of a pixel.
//!
//! # Source
//! S. Baker, I. Matthews, "Lucas-Kanade 20 years on", 2004: inverse compositional, so that gradients are those of the
//! reference and taken once. The patch is warped beforehand to how it must look now, and only its place is sought. Brightness
//! and contrast of the patch may change.

use super::grey::{Grey, as_float, whole};

/// Side of the patch, px of each level.
const SIDE: usize = 16;
/// With a border for the gradients.
const WIDE: usize = SIDE + 2;
const NUM_PIXELS: f32 = 256.0;
/// Steps at a level; most points need three.
const MOST_STEPS: usize = 12;
/// A shorter step ends the search at the finest level, px.
const LAST_STEP_PX: f32 = 0.01;
/// On coarser levels less does.
const LAST_COARSE_STEP_PX: f32 = 0.05;
/// Patches that correlate less are not the same thing.
const LEAST_CORRELATION: f32 = 0.8;
/// Mean squared gradient below which a patch has nothing to hold on to.
const LEAST_STRENGTH: f32 = 0.5;

/// What is sought.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sought {
    /// The point in the reference picture.
    pub reference: [f32; 2],
    /// Where it should be in the other.
    pub guess: [f32; 2],
    /// By how much the place in the reference changes with that in the other: columns per pixel right and down.
    pub reference_per_px: [[f32; 2]; 2],
}

/// Finds a point again, from the level `coarsest` of both pyramids down; `None` where it cannot be seen or does not look
/// alike.
#[must_use]
pub fn find(reference: &[Grey], other: &[Grey], sought: &Sought, coarsest: usize) -> Option<[f32; 2]> {
    let mut found = sought.guess;
    let last = coarsest.min(reference.len() - 1).min(other.len() - 1);
    let mut scale = (0..last).fold(1.0, |scale: f32, _| 0.5 * scale);
    for level in (0..=last).rev() {
        let place = sought.reference.map(|value| value * scale);
        let start = found.map(|value| value * scale);
        let limit = if level == 0 { LAST_STEP_PX } else { LAST_COARSE_STEP_PX };
        let at_level = Template::of(&reference[level], place, &sought.reference_per_px)
            .and_then(|template| template.find(&other[level], start, limit));
        match at_level {
            Some((place, correlation)) if level > 0 || correlation >= LEAST_CORRELATION => {
                found = place.map(|value| value / scale);
            }
            // What leaves the picture of a coarse level may still be within the finer one.
            _ if level > 0 => {}
            _ => return None,
        }
        scale *= 2.0;
    }
    Some(found)
}

/// A patch of the reference, its gradients, all about their mean, and their sums.
struct Template {
    values: [[f32; SIDE]; SIDE],
    right: [[f32; SIDE]; SIDE],
    down: [[f32; SIDE]; SIDE],
    squares: f32,
    with_right: f32,
    with_down: f32,
    inverse: [f32; 3],
}

impl Template {
    fn of(grey: &Grey, [x, y]: [f32; 2], per_px: &[[f32; 2]; 2]) -> Option<Self> {
        let patch = warped_patch(grey, [x, y], per_px)?;
        let mut values = [[0.0; SIDE]; SIDE];
        let mut right = [[0.0; SIDE]; SIDE];
        let mut down = [[0.0; SIDE]; SIDE];
        for row in 0..SIDE {
            for column in 0..SIDE {
                values[row][column] = patch[row + 1][column + 1];
                right[row][column] = 0.5 * (patch[row + 1][column + 2] - patch[row + 1][column]);
                down[row][column] = 0.5 * (patch[row + 2][column + 1] - patch[row][column + 1]);
            }
        }
        for plane in [&mut values, &mut right, &mut down] {
            let mean = sum_of(plane, plane, |value, _| value) / NUM_PIXELS;
            plane.iter_mut().flatten().for_each(|value| *value -= mean);
        }
        let product = |a, b| sum_of(a, b, |a, b| a * b);
        let (xx, xy, yy) = (product(&right, &right), product(&right, &down), product(&down, &down));
        let least = 0.5 * (xx + yy) - (0.25 * (xx - yy) * (xx - yy) + xy * xy).sqrt();
        let determinant = xx * yy - xy * xy;
        if least.is_nan() || least < LEAST_STRENGTH * NUM_PIXELS || determinant <= 0.0 {
            return None;
        }
        Some(Self {
            squares: product(&values, &values),
            with_right: product(&values, &right),
            with_down: product(&values, &down),
            inverse: [yy / determinant, -xy / determinant, xx / determinant],
            values,
            right,
            down,
        })
    }

    /// Its place in another picture, and how well it correlates there.
    fn find(&self, grey: &Grey, start: [f32; 2], last_step: f32) -> Option<([f32; 2], f32)> {
        /// Farther from where it should be, it is something else, px of the level.
        const MOST_MOVE_PX: f32 = 12.0;
        let [mut x, mut y] = start;
        let mut correlation = 0.0;
        for _ in 0..MOST_STEPS {
            let sums = self.sums_at(grey, [x, y])?;
            let variance = sums.square - sums.value * sums.value / NUM_PIXELS;
            if variance.is_nan() || variance <= 0.0 {
                return None;
            }
            let contrast = (self.squares / variance).sqrt().clamp(0.25, 4.0);
            correlation = sums.with_template / (self.squares * variance).sqrt();
            let b_x = contrast * sums.with_right - self.with_right;
            let b_y = contrast * sums.with_down - self.with_down;
            let [xx, xy, yy] = self.inverse;
            let (step_x, step_y) = (xx * b_x + xy * b_y, xy * b_x + yy * b_y);
            // A step of several pixels is beyond where the gradients hold.
            let shorten = 3.0 / step_x.hypot(step_y).max(3.0);
            x -= shorten * step_x;
            y -= shorten * step_y;
            if (x - start[0]).hypot(y - start[1]) > MOST_MOVE_PX {
                return None;
            }
            if step_x.hypot(step_y) < last_step {
                break;
            }
        }
        Some(([x, y], correlation))
    }

    fn sums_at(&self, grey: &Grey, [x, y]: [f32; 2]) -> Option<Sums> {
        const HALF: f32 = 7.5;
        let (column, row) = (whole(x - HALF)?, whole(y - HALF)?);
        if column + SIDE >= grey.width() || row + SIDE >= grey.height() {
            return None;
        }
        let (right, down) = (x - HALF - as_float(column), y - HALF - as_float(row));
        let weights = [(1.0 - right) * (1.0 - down), right * (1.0 - down), (1.0 - right) * down, right * down];
        // A sum for every column: all of them at once.
        let mut sums = [[0.0; SIDE]; 5];
        for line in 0..SIDE {
            let upper: &[f32; SIDE + 1] = grey.row(row + line)[column..].first_chunk()?;
            let lower: &[f32; SIDE + 1] = grey.row(row + line + 1)[column..].first_chunk()?;
            for at in 0..SIDE {
                let value = weights[0] * upper[at]
                    + weights[1] * upper[at + 1]
                    + weights[2] * lower[at]
                    + weights[3] * lower[at + 1];
                sums[0][at] += value;
                sums[1][at] += value * value;
                sums[2][at] += value * self.values[line][at];
                sums[3][at] += value * self.right[line][at];
                sums[4][at] += value * self.down[line][at];
            }
        }
        let [value, square, with_template, with_right, with_down] = sums.map(|columns| total(&columns));
        Some(Sums { value, square, with_template, with_right, with_down })
    }
}

struct Sums {
    value: f32,
    square: f32,
    with_template: f32,
    with_right: f32,
    with_down: f32,
}

/// The patch as it must look in the other picture, with its border; `None` where it reaches beyond the picture.
fn warped_patch(grey: &Grey, [x, y]: [f32; 2], per_px: &[[f32; 2]; 2]) -> Option<[[f32; WIDE]; WIDE]> {
    const HALF: f32 = 8.5;
    let [right, down] = per_px;
    let place = |column: f32, row: f32| [x + right[0] * column + down[0] * row, y + right[1] * column + down[1] * row];
    for (column, row) in [(-HALF, -HALF), (HALF, -HALF), (-HALF, HALF), (HALF, HALF)] {
        let [x, y] = place(column, row);
        grey.sample(x, y)?;
    }
    let mut patch = [[0.0; WIDE]; WIDE];
    let mut row = -HALF;
    for line in &mut patch {
        let mut column = -HALF;
        for value in line.iter_mut() {
            let [x, y] = place(column, row);
            *value = grey.sample(x, y)?;
            column += 1.0;
        }
        row += 1.0;
    }
    Some(patch)
}

/// Sums a product over a patch, the columns side by side.
fn sum_of(a: &[[f32; SIDE]; SIDE], b: &[[f32; SIDE]; SIDE], product: impl Fn(f32, f32) -> f32) -> f32 {
    let mut columns = [0.0; SIDE];
    for (a, b) in a.iter().zip(b) {
        for at in 0..SIDE {
            columns[at] += product(a[at], b[at]);
        }
    }
    total(&columns)
}

fn total(columns: &[f32; SIDE]) -> f32 {
    let mut sums = [0.0; 4];
    for quarter in columns.as_chunks::<4>().0 {
        for lane in 0..4 {
            sums[lane] += quarter[lane];
        }
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A smooth picture that has no period within it.
    fn picture(shift: [f32; 2], gain: f32, offset: f32) -> Vec<Grey> {
        let value = |x: f32, y: f32| {
            let (x, y) = (x - shift[0], y - shift[1]);
            100.0
                + 40.0 * (0.31 * x + 0.05 * y).sin()
                + 30.0 * (0.27 * y - 0.11 * x).cos()
                + 20.0 * (0.013 * x * y).sin()
        };
        let values =
            (0..120_u8).flat_map(|y| (0..160_u8).map(move |x| gain * value(f32::from(x), f32::from(y)) + offset));
        super::super::smooth::pyramid(Grey::from_rows(160, values.collect()), 3)
    }

    const AS_IT_IS: [[f32; 2]; 2] = [[1.0, 0.0], [0.0, 1.0]];

    #[test]
    fn shifts_are_found_to_hundredths_of_a_pixel() {
        for (shift, gain, offset) in [([0.37, -0.81], 1.0, 0.0), ([6.3, 4.8], 0.8, 20.0), ([-2.5, 0.1], 1.2, -15.0)] {
            let (reference, other) = (picture([0.0, 0.0], 1.0, 0.0), picture(shift, gain, offset));
            for place in [[60.0, 50.0], [80.4, 63.7], [100.0, 70.0]] {
                let sought = Sought { reference: place, guess: place, reference_per_px: AS_IT_IS };
                let found = find(&reference, &other, &sought, 2).expect("seen");
                let off = (found[0] - place[0] - shift[0]).hypot(found[1] - place[1] - shift[1]);
                // Both pictures are read between pixels by straight lines.
                assert!(off < 0.04, "{shift:?} at {place:?}: off by {off}");
            }
        }
    }

    #[test]
    fn what_is_not_there_is_not_found() {
        let reference = picture([0.0, 0.0], 1.0, 0.0);
        let flat = super::super::smooth::pyramid(Grey::from_rows(160, vec![50.0; 160 * 120]), 3);
        let sought = |place| Sought { reference: place, guess: place, reference_per_px: AS_IT_IS };
        assert_eq!(find(&reference, &flat, &sought([60.0, 50.0]), 2), None);
        assert_eq!(find(&flat, &reference, &sought([60.0, 50.0]), 2), None);
        assert_eq!(find(&reference, &reference, &sought([3.0, 50.0]), 2), None);
        assert_eq!(find(&reference, &reference, &sought([f32::NAN, 50.0]), 2), None);
    }
}
