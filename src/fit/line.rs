//! Straight lines in the laser plane: total least squares, trimmed, and a seeded search where most points lie elsewhere.

use crate::geometry::stats::{STD_OVER_MAD, SplitMix, median};

use super::sums::sum_over;
use super::windows;

/// Hypotheses tried in a search. Pairs from neighbouring points are clean more often than not, so far fewer would do.
const HYPOTHESES: usize = 40;
/// Points that a hypothesis is scored on.
const SCORED_POINTS: usize = 128;
/// Widths of the two-point windows, as parts of the points.
const WINDOWS: [f64; 5] = [0.03, 0.06, 0.12, 0.24, 0.4];
/// Points beyond this many standard deviations are left out.
const TRIM_AT_STDS: f64 = 3.0;
/// Variance that remains of a normal distribution cut at ±3 σ.
const VARIANCE_LEFT_BY_TRIM: f64 = 0.973_3;
/// Residuals looked at for the first, coarse scale; a median of 200 is good to 7 %.
const MEDIAN_SAMPLE: usize = 200;
/// Distances below this part of the coordinates are rounding, not noise.
const ROUNDING: f64 = 1e-12;
/// Rounds of trimming; the set of inliers settles in two or three.
const ROUNDS: usize = 3;

/// A straight line in the laser plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// A point on it, (x, z), mm.
    pub centre_mm: [f64; 2],
    /// Its direction, of unit length.
    pub direction: [f64; 2],
}

impl Line {
    /// Through two points; `None` if they are the same.
    #[must_use]
    pub fn through(a_mm: [f64; 2], b_mm: [f64; 2]) -> Option<Self> {
        let (dx, dz) = (b_mm[0] - a_mm[0], b_mm[1] - a_mm[1]);
        let length = dx.hypot(dz);
        (length > 0.0).then(|| Self { centre_mm: a_mm, direction: [dx / length, dz / length] })
    }

    /// Signed distance of a point, mm.
    #[must_use]
    pub fn distance_mm(&self, [x, z]: [f64; 2]) -> f64 {
        (z - self.centre_mm[1]) * self.direction[0] - (x - self.centre_mm[0]) * self.direction[1]
    }

    /// Where along the line the foot of a point is, from its centre, mm.
    #[must_use]
    pub fn along_mm(&self, [x, z]: [f64; 2]) -> f64 {
        (x - self.centre_mm[0]) * self.direction[0] + (z - self.centre_mm[1]) * self.direction[1]
    }

    /// The point of the line nearest to another.
    #[must_use]
    pub fn foot_mm(&self, point_mm: [f64; 2]) -> [f64; 2] {
        let along = self.along_mm(point_mm);
        [0, 1].map(|axis| self.centre_mm[axis] + along * self.direction[axis])
    }

    /// Its point at a place across the line; `None` where it runs along the range axis.
    #[must_use]
    pub fn at_x_mm(&self, x_mm: f64) -> Option<[f64; 2]> {
        let slope = self.slope()?;
        Some([x_mm, self.centre_mm[1] + slope * (x_mm - self.centre_mm[0])])
    }

    /// Change of z with x; `None` where it runs along the range axis.
    #[must_use]
    pub fn slope(&self) -> Option<f64> {
        /// A line within a hundredth of a degree of the range axis has no place across it.
        const UPRIGHT: f64 = 1e-4;
        (self.direction[0].abs() > UPRIGHT).then(|| self.direction[1] / self.direction[0])
    }

    /// Angle between two lines, within 0 and a right angle, rad.
    #[must_use]
    pub fn angle_to_rad(&self, other: &Self) -> f64 {
        self.sine_to(other).abs().min(1.0).asin()
    }

    fn sine_to(&self, other: &Self) -> f64 {
        self.direction[0] * other.direction[1] - self.direction[1] * other.direction[0]
    }

    /// Where two lines cross; `None` if they are parallel.
    #[must_use]
    pub fn crossing_mm(&self, other: &Self) -> Option<[f64; 2]> {
        let sine = self.sine_to(other);
        let along = other.distance_mm(self.centre_mm) / sine;
        let crossing = [0, 1].map(|axis| self.centre_mm[axis] + along * self.direction[axis]);
        crossing.iter().all(|value| value.is_finite()).then_some(crossing)
    }
}

/// A line fitted to points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineFit {
    /// The line; its centre is that of the points.
    pub line: Line,
    /// Root mean square distance of its points, mm.
    pub rms_mm: f64,
    /// Points that it rests on.
    pub num_points: usize,
    /// Sum of the points' squared distances from the centre along the line, mm².
    pub spread_mm2: f64,
    /// Points beyond this distance were left out, mm.
    pub limit_mm: f64,
}

impl LineFit {
    /// Variance of the line across itself at a place, for points of unit variance: it fans out from its centre.
    #[must_use]
    pub fn variance_factor_at(&self, point_mm: [f64; 2]) -> f64 {
        let along = self.line.along_mm(point_mm);
        #[expect(clippy::cast_precision_loss, reason = "a profile has far fewer than 2^52 points")]
        let count = self.num_points as f64;
        1.0 / count + along * along / self.spread_mm2
    }

    /// Sum of the squared distances, corrected for what trimming cut off, mm².
    #[must_use]
    pub fn cost_mm2(&self) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "a profile has far fewer than 2^52 points")]
        let count = self.num_points as f64;
        self.rms_mm * self.rms_mm * count / VARIANCE_LEFT_BY_TRIM
    }
}

/// The line of least squared distances; `None` below two different points.
#[must_use]
pub fn fit(x_mm: &[f64], z_mm: &[f64]) -> Option<LineFit> {
    let num_points = x_mm.len().min(z_mm.len());
    if num_points < 2 {
        return None;
    }
    #[expect(clippy::cast_precision_loss, reason = "a profile has far fewer than 2^52 points")]
    let count = num_points as f64;
    let [sum_x, sum_z] = sum_over(x_mm, z_mm, |x, z| [x, z]);
    let centre_mm = [sum_x / count, sum_z / count];
    let [xx, xz, zz] = sum_over(x_mm, z_mm, |x, z| {
        let (x, z) = (x - centre_mm[0], z - centre_mm[1]);
        [x * x, x * z, z * z]
    });
    // The long axis of the points' ellipse, in closed form.
    let half_gap = ((xx - zz) / 2.0).hypot(xz);
    let spread_mm2 = f64::midpoint(xx, zz) + half_gap;
    let angle = 0.5 * (2.0 * xz).atan2(xx - zz);
    let (sine, cosine) = angle.sin_cos();
    // The short axis directly, not as a small difference of large numbers.
    let cost = (xx * sine * sine - 2.0 * xz * sine * cosine + zz * cosine * cosine).max(0.0);
    let line = Line { centre_mm, direction: [cosine, sine] };
    (spread_mm2 > 0.0 && spread_mm2.is_finite()).then(|| LineFit {
        line,
        rms_mm: (cost / count).sqrt(),
        num_points,
        spread_mm2,
        limit_mm: f64::INFINITY,
    })
}

/// The same without the points beyond three standard deviations, taken from the data; `None` if hardly any are left.
///
/// `start` decides which points count at first: those within `tolerance_mm`.
#[must_use]
pub fn fit_trimmed(x_mm: &[f64], z_mm: &[f64], start: &Line, tolerance_mm: f64) -> Option<LineFit> {
    let size = start.centre_mm[0].abs() + start.centre_mm[1].abs();
    let (mut near_x, mut near_z) = (Vec::with_capacity(x_mm.len()), Vec::with_capacity(x_mm.len()));
    keep_within(x_mm, z_mm, start, tolerance_mm, &mut near_x, &mut near_z);
    let mut found = fit(&near_x, &near_z)?;
    let mut std_mm = coarse_std(&near_x, &near_z, &found.line);
    for _ in 0..ROUNDS {
        let limit_mm = (TRIM_AT_STDS * std_mm).max(ROUNDING * size).min(tolerance_mm);
        keep_within(x_mm, z_mm, &found.line, limit_mm, &mut near_x, &mut near_z);
        found = LineFit { limit_mm, ..fit(&near_x, &near_z)? };
        #[expect(clippy::cast_precision_loss, reason = "a profile has far fewer than 2^52 points")]
        let freedom = near_x.len().saturating_sub(2).max(1) as f64;
        std_mm = (found.cost_mm2() / freedom).sqrt();
    }
    Some(found)
}

/// The scaled median distance from the line, over evenly spread points.
fn coarse_std(x_mm: &[f64], z_mm: &[f64], line: &Line) -> f64 {
    let stride = x_mm.len().div_ceil(MEDIAN_SAMPLE).max(1);
    let points = x_mm.iter().zip(z_mm).step_by(stride);
    let mut distances: Vec<f64> = points.map(|(x, z)| line.distance_mm([*x, *z]).abs()).collect();
    STD_OVER_MAD * median(&mut distances)
}

fn keep_within(x_mm: &[f64], z_mm: &[f64], line: &Line, limit_mm: f64, near_x: &mut Vec<f64>, near_z: &mut Vec<f64>) {
    near_x.clear();
    near_z.clear();
    for (x, z) in x_mm.iter().zip(z_mm) {
        if line.distance_mm([*x, *z]).abs() <= limit_mm {
            near_x.push(*x);
            near_z.push(*z);
        }
    }
}

/// The line that most points agree on within `tolerance_mm`; `None` below two points.
///
/// The two points of a hypothesis are neighbours along the profile, as neighbours mostly lie on the same thing. The random
/// numbers are seeded: the same points give the same line.
#[must_use]
pub fn search(x_mm: &[f64], z_mm: &[f64], tolerance_mm: f64) -> Option<Line> {
    let num_points = x_mm.len().min(z_mm.len());
    if num_points < 2 {
        return None;
    }
    let [scored_x, scored_z] = [x_mm, z_mm].map(|values| windows::thinned(values, num_points, SCORED_POINTS));
    let mut random = SplitMix::new(0x0011_4e5e_a2c4);
    let mut best: Option<(Line, u32)> = None;
    for hypothesis in 0..HYPOTHESES {
        let width = windows::width(num_points, WINDOWS[hypothesis % WINDOWS.len()], num_points - 1);
        let first = random.below(num_points - width);
        let ends = [first, first + width].map(|idx| [x_mm[idx], z_mm[idx]]);
        let Some(line) = Line::through(ends[0], ends[1]) else { continue };
        let mut score = 0;
        for (x, z) in scored_x.iter().zip(&scored_z) {
            score += u32::from(line.distance_mm([*x, *z]).abs() <= tolerance_mm);
        }
        if best.is_none_or(|(_, most)| score > most) {
            best = Some((line, score));
        }
    }
    best.map(|(line, _)| line)
}
