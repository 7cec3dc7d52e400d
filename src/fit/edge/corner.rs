//! Where two flanks meet at an angle.

use nalgebra::{Matrix2, Vector2};

use crate::fit::line::LineFit;
use crate::geometry::stats::rms;

use super::pieces::{self, End, MIN_FLANK_POINTS, Piece};
use super::points::Points;
use super::{EdgeFit, EdgeOptions, Feature};

/// Flatter than this, no corner is called one: where it is would follow every bump of the flanks.
pub(super) const MIN_CORNER_DEG: f64 = 10.0;
/// Points left out on either side of the corner, which is never quite sharp, …
const GUARD_POINTS: usize = 3;
/// … as long as they are no more than one in so many of the flank.
const GUARD_ONE_IN: usize = 10;
/// Rounds of dividing the points at the crossing and fitting again.
const ROUNDS: usize = 2;

/// The crossing of two neighbouring pieces with the covariance that both lines give it.
///
/// The points are divided at the crossing, so that those of one flank next to the corner do not bend the other.
pub(super) fn fit(points: &Points, before: &Piece, after: &Piece, options: &EdgeOptions) -> Option<EdgeFit> {
    let mut flanks = [before.clone(), after.clone()];
    let mut point_mm = before.fit.line.crossing_mm(&after.fit.line)?;
    for _ in 0..ROUNDS {
        let divide = divide_at(points, point_mm[0], before.first, after.last);
        let last = divide.checked_sub(1 + guard(divide - before.first))?;
        let first = divide + guard((after.last + 1).saturating_sub(divide));
        flanks = [
            refitted(points, before.first, last, &flanks[0].fit)?,
            refitted(points, first, after.last, &flanks[1].fit)?,
        ];
        point_mm = flanks[0].fit.line.crossing_mm(&flanks[1].fit.line)?;
    }
    let [before, after] = &flanks;
    let stds_mm = [before, after].map(|flank| flank.point_std_mm(options.profile_std_mm));
    let covariance = covariance([&before.fit, &after.fit], point_mm, stds_mm)?;
    Some(EdgeFit {
        feature: Feature::Corner,
        point_mm,
        covariance,
        gap_mm: [0.0; 2],
        flanks: vec![before.flank(points, End::Last), after.flank(points, End::First)],
        point_std_mm: rms(stds_mm),
        classes: pieces::classes(points, &flanks),
    })
}

/// Each line holds its crossing within its own uncertainty across itself: N·p = c with independent errors of c.
pub(super) fn covariance(fits: [&LineFit; 2], point_mm: [f64; 2], stds_mm: [f64; 2]) -> Option<Matrix2<f64>> {
    let normals = fits.map(|fit| [-fit.line.direction[1], fit.line.direction[0]]);
    let inverse = Matrix2::new(normals[0][0], normals[0][1], normals[1][0], normals[1][1]).try_inverse()?;
    let variances = [0, 1].map(|idx| fits[idx].variance_factor_at(point_mm) * stds_mm[idx] * stds_mm[idx]);
    Some(inverse * Matrix2::from_diagonal(&Vector2::from(variances)) * inverse.transpose())
}

/// The first of the points between two places that lies beyond `x_mm`.
fn divide_at(points: &Points, x_mm: f64, first: usize, last: usize) -> usize {
    let order = points.order();
    first + points.x_mm[first..=last].partition_point(|x| (x - x_mm) * order < 0.0)
}

fn guard(num_points: usize) -> usize {
    GUARD_POINTS.min(num_points / GUARD_ONE_IN)
}

fn refitted(points: &Points, first: usize, last: usize, start: &LineFit) -> Option<Piece> {
    let fit = pieces::refit(points, first, last, start)?;
    (fit.num_points >= MIN_FLANK_POINTS).then_some(Piece { fit, first, last })
}
