//! Step 5 of the patent, first half: points that are found again, at the corners of what is seen.
//!
//! A corner is where the picture changes in both directions: the smaller eigenvalue of the sum of g gᵀ over a window, g the
//! gradient (Shi & Tomasi 1994). It says as well how precisely the point can be tracked, which is why it is preferred to the
//! corners by comparison (FAST) that ready-made crates have.

use super::grey::Grey;

/// Half the window over which gradients are summed, px.
const HALF_WINDOW: usize = 2;
/// Nearer to the border than this there are no corners: what surrounds them is not seen, px.
pub const BORDER: usize = 16;

/// A corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corner {
    /// Where it is, px; finer than a pixel.
    pub pixel: [f32; 2],
    /// How strong it is: mean squared gradient along the direction in which the picture changes least, per px².
    pub strength: f32,
}

/// What corners to look for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CornerSearch {
    /// At most so many.
    pub most: usize,
    /// No two nearer than this, px.
    pub min_distance: f32,
    /// The least strength: below it there is only noise.
    pub min_strength: f32,
}

/// The strongest corners of a picture, strongest first, away from each other. `wanted` may refuse places.
#[must_use]
pub fn corners(grey: &Grey, search: &CornerSearch, wanted: impl Fn([f32; 2]) -> bool) -> Vec<Corner> {
    if grey.width() <= 2 * BORDER || grey.height() <= 2 * BORDER {
        return Vec::new();
    }
    let strengths = strengths(grey);
    let mut peaks = peaks(&strengths, search.min_strength);
    // Of the same strength the upper left one comes first, on every machine.
    peaks.sort_by(|a, b| b.strength.total_cmp(&a.strength).then(a.pixel[1].total_cmp(&b.pixel[1])));
    let mut taken = Taken::new(grey, search.min_distance);
    let mut chosen = Vec::with_capacity(search.most);
    for peak in peaks {
        if chosen.len() >= search.most {
            break;
        }
        if wanted(peak.pixel) && taken.take(peak.pixel) {
            chosen.push(peak);
        }
    }
    chosen
}

/// The smaller eigenvalue at every pixel; 0 at the border.
fn strengths(grey: &Grey) -> Grey {
    /// Rows of products kept for the sums over the window.
    const ROWS: usize = 2 * HALF_WINDOW + 1;
    let (width, height) = (grey.width(), grey.height());
    let mut values = vec![0.0; width * height];
    let mut products: [[Vec<f32>; 3]; ROWS] = std::array::from_fn(|_| std::array::from_fn(|_| vec![0.0; width]));
    let mut sums: [Vec<f32>; 3] = std::array::from_fn(|_| vec![0.0; width]);
    for row in 1..height - 1 {
        let [xx, xy, yy] = &mut products[row % ROWS];
        let (here, above, below) = (grey.row(row), grey.row(row - 1), grey.row(row + 1));
        let across = here.iter().zip(&here[2..]);
        let down = above[1..].iter().zip(&below[1..]);
        let out = xx[1..].iter_mut().zip(&mut xy[1..]).zip(&mut yy[1..]);
        for ((((left, right), (above, below)), xx), (xy, yy)) in
            across.zip(down).zip(out).map(|((across, down), ((xx, xy), yy))| (((across, down), xx), (xy, yy)))
        {
            let (gx, gy) = (0.5 * (right - left), 0.5 * (below - above));
            *xx = gx * gx;
            *xy = gx * gy;
            *yy = gy * gy;
        }
        if row < ROWS {
            continue;
        }
        for (channel, sum) in sums.iter_mut().enumerate() {
            let [a, b, c, d, e] = [0, 1, 2, 3, 4].map(|idx| &products[idx][channel]);
            for (((((sum, a), b), c), d), e) in sum.iter_mut().zip(a).zip(b).zip(c).zip(d).zip(e) {
                *sum = (a + b) + (c + d) + e;
            }
        }
        let out = &mut values[(row - HALF_WINDOW) * width + HALF_WINDOW..(row - HALF_WINDOW + 1) * width - HALF_WINDOW];
        let windows = |channel: usize| {
            let sum = &sums[channel];
            sum.iter().zip(&sum[1..]).zip(&sum[2..]).zip(&sum[3..]).zip(&sum[4..])
        };
        for (value, ((xx, xy), yy)) in out.iter_mut().zip(windows(0).zip(windows(1)).zip(windows(2))) {
            let [xx, xy, yy] = [xx, xy, yy].map(|((((a, b), c), d), e)| (a + b) + (c + d) + e);
            let (mean, half) = (0.5 * (xx + yy), 0.5 * (xx - yy));
            *value = (mean - (half * half + xy * xy).sqrt()) * 0.04;
        }
    }
    Grey::from_rows(width, values)
}

/// Where the strength is greater than all around, finer than a pixel by the parabola through the neighbours.
fn peaks(strengths: &Grey, min_strength: f32) -> Vec<Corner> {
    let mut found = Vec::new();
    for row in BORDER..strengths.height() - BORDER {
        let (above, here, below) = (strengths.row(row - 1), strengths.row(row), strengths.row(row + 1));
        for column in BORDER..strengths.width() - BORDER {
            let strength = here[column];
            if strength < min_strength {
                continue;
            }
            let before = [above[column - 1], above[column], above[column + 1], here[column - 1]];
            let after = [here[column + 1], below[column - 1], below[column], below[column + 1]];
            // One of several equal neighbours is taken.
            if before.iter().any(|other| *other >= strength) || after.iter().any(|other| *other > strength) {
                continue;
            }
            let x = parabola_peak([here[column - 1], strength, here[column + 1]]);
            let y = parabola_peak([above[column], strength, below[column]]);
            #[expect(clippy::cast_precision_loss, reason = "sides are below 8192 pixels")]
            found.push(Corner { pixel: [column as f32 + x, row as f32 + y], strength });
        }
    }
    found
}

/// Where the parabola through three values at −1, 0 and 1 is greatest, if the middle one is.
fn parabola_peak([left, middle, right]: [f32; 3]) -> f32 {
    let curvature = left - 2.0 * middle + right;
    if curvature < 0.0 { (0.5 * (left - right) / curvature).clamp(-0.5, 0.5) } else { 0.0 }
}

/// Places taken, in a grid of cells as wide as the distance that is kept.
struct Taken {
    min_distance: f32,
    columns: usize,
    cells: Vec<Vec<[f32; 2]>>,
}

impl Taken {
    fn new(grey: &Grey, min_distance: f32) -> Self {
        let min_distance = min_distance.max(1.0);
        #[expect(clippy::cast_precision_loss, reason = "sides are below 8192 pixels")]
        let cells = |side: usize| super::grey::whole(side as f32 / min_distance).unwrap_or(0) + 1;
        let columns = cells(grey.width());
        Self { min_distance, columns, cells: vec![Vec::new(); columns * cells(grey.height())] }
    }

    fn take(&mut self, [x, y]: [f32; 2]) -> bool {
        let cell = |value: f32| super::grey::whole(value / self.min_distance).unwrap_or(0);
        let (column, row) = (cell(x), cell(y));
        let rows = row.saturating_sub(1)..=row + 1;
        let is_near = |other: &[f32; 2]| {
            let (dx, dy) = (other[0] - x, other[1] - y);
            dx * dx + dy * dy < self.min_distance * self.min_distance
        };
        let is_taken = rows.flat_map(|row| {
            (column.saturating_sub(1)..=(column + 1).min(self.columns - 1)).map(move |column| (row, column))
        });
        if is_taken
            .filter_map(|(row, column)| self.cells.get(row * self.columns + column))
            .any(|cell| cell.iter().any(is_near))
        {
            return false;
        }
        if let Some(cell) = self.cells.get_mut(row * self.columns + column) {
            cell.push([x, y]);
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bright squares on black, 9 px wide, their centres where given.
    fn squares(centres: &[[u8; 2]]) -> Grey {
        let is_in = |x: u8, y: u8| centres.iter().any(|c| x.abs_diff(c[0]) <= 4 && y.abs_diff(c[1]) <= 4);
        let values = (0..100_u8).flat_map(|y| (0..120_u8).map(move |x| if is_in(x, y) { 200.0 } else { 0.0 }));
        super::super::smooth::smoothed(&Grey::from_rows(120, values.collect()))
    }

    #[test]
    fn the_corners_of_squares_are_found() {
        let search = CornerSearch { most: 100, min_distance: 5.0, min_strength: 10.0 };
        let found = corners(&squares(&[[40, 40], [80, 60]]), &search, |_| true);
        assert_eq!(found.len(), 8, "{found:?}");
        for corner in [[36.0, 36.0], [44.0, 36.0], [84.0, 64.0]] {
            let near = |found: &Corner| (found.pixel[0] - corner[0]).hypot(found.pixel[1] - corner[1]);
            // The window's greatest sum lies a little inside of the corner.
            assert!(found.iter().any(|found| near(found) < 2.0), "{corner:?} {found:?}");
        }
        assert_eq!(corners(&squares(&[[40, 40]]), &search, |pixel| pixel[0] < 40.0).len(), 2);
        assert!(corners(&squares(&[]), &search, |_| true).is_empty());
        assert!(corners(&Grey::from_rows(3, vec![0.0; 9]), &search, |_| true).is_empty());
    }

    #[test]
    fn corners_keep_their_distance() {
        let search = CornerSearch { most: 100, min_distance: 30.0, min_strength: 10.0 };
        assert_eq!(corners(&squares(&[[40, 40]]), &search, |_| true).len(), 1);
    }
}
