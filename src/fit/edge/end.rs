//! Where a surface ends: between its last point and the next one that would have shown it.

use nalgebra::{Matrix2, Vector2};

use super::pieces::{self, End, Piece};
use super::points::Points;
use super::{EdgeFit, EdgeOptions, Feature};

/// Points beyond the last one of a surface that may still have been on it, but were missed or mismeasured.
const MAX_BEYOND: usize = 4;
/// Longer runs of missing points are holes, which say nothing about single points that drop out.
const MAX_DROPOUT: usize = 3;

/// The end of a piece, with the pitch of the points in its covariance.
///
/// `far` is the first point of the surface that follows.
pub(super) fn fit(
    points: &Points,
    piece: &Piece,
    end: End,
    far: Option<usize>,
    feature: Feature,
    options: &EdgeOptions,
) -> Option<EdgeFit> {
    let line = &piece.fit.line;
    let last = piece.end(end);
    let [beyond, variance] = beyond_last_point(points, piece, end, far);
    let outwards = match end {
        End::First => -points.order(),
        End::Last => points.order(),
    };
    let point_mm = line.at_x_mm(points.x_mm[last] + outwards * beyond * points.pitch_mm)?;
    let point_std_mm = piece.point_std_mm(options.profile_std_mm);
    // Across the laser line the grid decides, and the point slides along the surface with it; off the surface the fit does.
    let slide = Vector2::new(1.0, line.slope()?);
    let off = Vector2::new(-line.direction[1], line.direction[0]);
    let covariance = slide * slide.transpose() * (variance * points.pitch_mm * points.pitch_mm)
        + off * off.transpose() * (piece.fit.variance_factor_at(point_mm) * point_std_mm * point_std_mm);
    Some(EdgeFit {
        feature,
        point_mm,
        covariance: Matrix2::new(
            covariance[(0, 0)],
            f64::midpoint(covariance[(0, 1)], covariance[(1, 0)]),
            f64::midpoint(covariance[(0, 1)], covariance[(1, 0)]),
            covariance[(1, 1)],
        ),
        gap_mm: far.map_or([0.0; 2], |far| gap(points, last, far, point_mm[0], slide)),
        flanks: vec![piece.flank(points, end)],
        point_std_mm,
        classes: pieces::classes(points, [piece]),
    })
}

/// From the end to the place across the line where the next surface begins, along the surface, mm; none where no more is
/// missing than points that drop out one by one.
fn gap(points: &Points, last: usize, far: usize, end_x_mm: f64, slide: Vector2<f64>) -> [f64; 2] {
    if points.grid[far].abs_diff(points.grid[last]) <= MAX_BEYOND {
        return [0.0; 2];
    }
    (slide * (points.x_mm[far] - end_x_mm)).into()
}

/// How far beyond the last point the surface ends, in pitches: mean and variance.
///
/// Within the first pitch anywhere alike. Further out only if the points there were on the surface and missed: as likely as
/// points drop out elsewhere on it, or, for a point that is measured but lies nowhere, as likely as not.
fn beyond_last_point(points: &Points, piece: &Piece, end: End, far: Option<usize>) -> [f64; 2] {
    let last = piece.end(end);
    let dropout = dropout_rate(points, piece);
    let (mut weight, mut sums) = (1.0, [0.0; 3]);
    let mut place = last;
    let step = |place: usize| match end {
        End::First => place.checked_sub(1),
        End::Last => Some(place + 1).filter(|next| *next < points.len()),
    };
    let gap_to = |place: usize| points.grid[place].abs_diff(points.grid[last]);
    // With the next surface right behind the gap, its points may be the ones that are missing.
    let is_bounded = far.is_some_and(|far| gap_to(far) <= MAX_BEYOND);
    for cell in 0..MAX_BEYOND {
        #[expect(clippy::cast_precision_loss, reason = "up to four")]
        let middle = cell as f64 + 0.5;
        sums[0] += weight;
        sums[1] += weight * middle;
        sums[2] += weight * (middle * middle + 1.0 / 12.0);
        let next = step(place).filter(|next| gap_to(*next) == cell + 1);
        if let Some(next) = next {
            place = next;
        }
        if far.is_some_and(|far| gap_to(far) <= cell + 1) {
            break;
        }
        if next.is_none() && !is_bounded {
            weight *= dropout;
        }
    }
    let mean = sums[1] / sums[0];
    [mean, sums[2] / sums[0] - mean * mean]
}

/// The part of the surface's points that drop out one by one.
fn dropout_rate(points: &Points, piece: &Piece) -> f64 {
    let grid = &points.grid[piece.first..=piece.last];
    let missing = grid.windows(2).map(|pair| pair[1] - pair[0] - 1).filter(|run| *run <= MAX_DROPOUT);
    let num_missing: usize = missing.sum();
    #[expect(clippy::cast_precision_loss, reason = "a profile has far fewer than 2^52 points")]
    let rate = num_missing as f64 / (num_missing + grid.len()) as f64;
    rate
}
