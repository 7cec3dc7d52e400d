//! The straight pieces of a profile: search, trimmed fit, what is left is searched again.

use crate::fit::PointClass;
use crate::fit::line::{self, LineFit};

use super::Flank;
use super::points::Points;

/// Fewer points than this make no flank.
pub(super) const MIN_FLANK_POINTS: usize = 8;
/// Pieces looked for. A plate on a table has two or three.
const MAX_PIECES: usize = 6;
/// A piece ends where so many valid points in a row are elsewhere.
const SPLIT_AFTER: usize = 5;
/// Of so many points at the end of a piece …
const END_POINTS: usize = 4;
/// … at least so many are on it; a stray that happens to lie in line is no end.
const END_POINTS_ON_LINE: usize = 2;
/// The noise that a session states counts as much as so many residuals.
const STATED_NOISE_WEIGHT: f64 = 10.0;

/// A straight piece.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    /// Its line.
    pub fit: LineFit,
    /// The first of its points, among the valid ones.
    pub first: usize,
    /// The last.
    pub last: usize,
}

impl Piece {
    /// Number of points from its first to its last, missing ones included.
    pub(super) fn grid_width(&self, points: &Points) -> usize {
        points.grid[self.last] - points.grid[self.first] + 1
    }

    /// Length along its line, mm.
    pub(super) fn length_mm(&self, points: &Points) -> f64 {
        let along = [self.first, self.last].map(|place| self.fit.line.along_mm(points.at(place)));
        (along[1] - along[0]).abs()
    }

    /// Noise of a point across it, mm: from its residuals, and from what the session states along the range axis.
    pub(super) fn point_std_mm(&self, stated_mm: Option<f64>) -> f64 {
        let stated = stated_mm.map(|std_mm| std_mm * self.fit.line.direction[0]);
        let [cost, weight] =
            stated.map_or([0.0; 2], |std_mm| [std_mm * std_mm, 1.0]).map(|part| part * STATED_NOISE_WEIGHT);
        #[expect(clippy::cast_precision_loss, reason = "a profile has far fewer than 2^52 points")]
        let freedom = self.fit.num_points.saturating_sub(2) as f64;
        ((cost + self.fit.cost_mm2()) / (weight + freedom).max(1.0)).sqrt()
    }

    /// Whether a point is on it.
    pub(super) fn holds(&self, points: &Points, place: usize) -> bool {
        (self.first..=self.last).contains(&place)
            && self.fit.line.distance_mm(points.at(place)).abs() <= self.fit.limit_mm
    }

    /// The place of its end next to a neighbour.
    pub(super) const fn end(&self, end: End) -> usize {
        match end {
            End::First => self.first,
            End::Last => self.last,
        }
    }

    /// As shown, with the end at `end` first.
    pub(super) fn flank(&self, points: &Points, end: End) -> Flank {
        let near_mm = self.fit.line.foot_mm(points.at(self.end(end)));
        let far_mm = self.fit.line.foot_mm(points.at(self.end(end.other())));
        Flank { ends_mm: [near_mm, far_mm], rms_mm: self.fit.rms_mm, num_points: self.fit.num_points }
    }
}

/// An end of a piece, in the order of the profile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum End {
    First,
    Last,
}

impl End {
    pub(super) const fn other(self) -> Self {
        match self {
            Self::First => Self::Last,
            Self::Last => Self::First,
        }
    }
}

/// All pieces, in the order of the profile.
pub(super) fn find(points: &Points) -> Vec<Piece> {
    let mut left: Vec<usize> = (0..points.len()).collect();
    let mut pieces: Vec<Piece> = Vec::new();
    while pieces.len() < MAX_PIECES && left.len() >= MIN_FLANK_POINTS {
        let Some(piece) = find_one(points, &left) else { break };
        left.retain(|place| !(piece.first..=piece.last).contains(place));
        pieces.push(piece);
    }
    pieces.sort_by_key(|piece| piece.first);
    pieces
}

/// The piece that most of the points left agree on.
fn find_one(points: &Points, left: &[usize]) -> Option<Piece> {
    let (x_mm, z_mm): (Vec<f64>, Vec<f64>) =
        left.iter().map(|place| (points.x_mm[*place], points.z_mm[*place])).unzip();
    let start = line::search(&x_mm, &z_mm, points.tolerance_mm)?;
    let fit = line::fit_trimmed(&x_mm, &z_mm, &start, 2.0 * points.tolerance_mm)?;
    // What else lies in line, a table beyond the plate, is another piece.
    let (first, last) = longest_stretch(points, left, &fit)?;
    let fit = fit_between(points, left, first, last, &fit)?;
    let (first, last) = longest_stretch(points, left, &fit)?;
    Some(Piece { fit, first, last })
}

/// The longest run of points on the line, without the strays at its ends; `None` if it is too short for a flank.
fn longest_stretch(points: &Points, left: &[usize], fit: &LineFit) -> Option<(usize, usize)> {
    let mut on_line: Vec<usize> = Vec::with_capacity(left.len());
    on_line.extend(left.iter().copied().filter(|place| fit.line.distance_mm(points.at(*place)).abs() <= fit.limit_mm));
    let runs = on_line.chunk_by(|before, after| after - before <= SPLIT_AFTER);
    let run = runs.max_by_key(|run| run.len())?;
    let is_end = |window: &[usize]| window[window.len() - 1] - window[0] < END_POINTS;
    let begins_at = run.windows(END_POINTS_ON_LINE).position(is_end)?;
    let ends_at = run.windows(END_POINTS_ON_LINE).rposition(is_end)? + END_POINTS_ON_LINE - 1;
    (ends_at + 1 >= begins_at + MIN_FLANK_POINTS).then(|| (run[begins_at], run[ends_at]))
}

/// The trimmed line through the points `left` between two of them.
fn fit_between(points: &Points, left: &[usize], first: usize, last: usize, start: &LineFit) -> Option<LineFit> {
    let between = left.iter().filter(|place| (first..=last).contains(*place));
    let (x_mm, z_mm): (Vec<f64>, Vec<f64>) = between.map(|place| (points.x_mm[*place], points.z_mm[*place])).unzip();
    line::fit_trimmed(&x_mm, &z_mm, &start.line, 2.0 * points.tolerance_mm)
}

/// The trimmed line through all points between two of them.
pub(super) fn refit(points: &Points, first: usize, last: usize, start: &LineFit) -> Option<LineFit> {
    let (x_mm, z_mm) = (points.x_mm.get(first..=last)?, points.z_mm.get(first..=last)?);
    line::fit_trimmed(x_mm, z_mm, &start.line, 2.0 * points.tolerance_mm)
}

/// One class a point of the profile, by the flanks that an edge was found from.
pub(super) fn classes<'a>(points: &Points, flanks: impl IntoIterator<Item = &'a Piece>) -> Vec<PointClass> {
    let mut classes = vec![PointClass::Missing; points.num_grid];
    for grid in &points.grid {
        classes[*grid] = PointClass::Unused;
    }
    for flank in flanks {
        for place in flank.first..=flank.last {
            classes[points.grid[place]] =
                if flank.holds(points, place) { PointClass::Inlier } else { PointClass::Outlier };
        }
    }
    classes
}
