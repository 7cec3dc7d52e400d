//! The part as a curve, seen along its ridges, and what there is along it.

use nalgebra::Vector3;

use crate::geometry::Vec3;
use crate::geometry::stats::median;
use crate::scan::linear::pooled_scatter;

use super::axes::Axes;
use super::flanks::{Flank, flanks};
use super::outline::{NUM_BINS, crossings, levels};
use super::tips::{Tip, tips};

/// A point of the curve: (place along, height, place on the ridge), mm, with its profile.
pub(super) type CurvePoint = (Vector3<f64>, u32);

/// The part as a curve.
pub(super) struct Curve {
    /// In the order of their place along.
    points: Vec<CurvePoint>,
}

/// Flanks and tips, in their order along the part.
pub(super) struct Features {
    pub(super) flanks: Vec<Flank>,
    /// One between two flanks each.
    pub(super) tips: Vec<Tip>,
}

/// The height that flanks pass, and how far up and down they reach together, mm.
#[derive(Clone, Copy, Debug)]
pub(super) struct Levels {
    pub(super) middle: f64,
    pub(super) range: f64,
}

impl Curve {
    pub(super) fn of(points: &[(Vec3, u32)], axes: &Axes) -> Self {
        let place = |point: &Vec3| Vector3::new(axes.along.dot(point), axes.up.dot(point), axes.ridge.dot(point));
        let mut points: Vec<CurvePoint> = points.iter().map(|(point, profile)| (place(point), *profile)).collect();
        points.sort_by(|a, b| a.0.x.total_cmp(&b.0.x));
        Self { points }
    }

    /// The points between two places.
    pub(super) fn between(&self, from: f64, to: f64) -> &[CurvePoint] {
        let start = self.points.partition_point(|(point, _)| point.x < from);
        let end = self.points.partition_point(|(point, _)| point.x < to);
        &self.points[start.min(end)..end]
    }

    /// Heights at evenly spread places: the median of the points there.
    #[expect(clippy::cast_precision_loss, reason = "a count of bins")]
    fn outline(&self) -> Vec<[f64; 2]> {
        let (Some(first), Some(last)) = (self.points.first(), self.points.last()) else { return Vec::new() };
        let width = (last.0.x - first.0.x) / NUM_BINS as f64;
        let mut outline = Vec::new();
        for bin in 0..NUM_BINS {
            let from = first.0.x + width * bin as f64;
            let mut heights: Vec<f64> = self.between(from, from + width).iter().map(|(point, _)| point.y).collect();
            if !heights.is_empty() {
                outline.push([from + width / 2.0, median(&mut heights)]);
            }
        }
        outline
    }

    pub(super) fn features(&self) -> Features {
        let outline = self.outline();
        let Some(levels) = levels(&outline) else {
            return Features { flanks: Vec::new(), tips: Vec::new() };
        };
        let mut flanks = flanks(self, &crossings(&outline, levels), levels);
        let mut tips = tips(self, &flanks, levels);
        // A few profiles on a flank or tip do not tell how whole profiles scatter, but those of all flanks and tips do.
        let left_over = flanks.iter().map(|flank| &flank.left_over).chain(tips.iter().map(|tip| &tip.left_over));
        if let Some(profile_variance) = pooled_scatter(left_over.cloned()) {
            for flank in &mut flanks {
                flank.believe(profile_variance);
            }
            tips = self::tips(self, &flanks, levels);
            for tip in &mut tips {
                tip.believe(profile_variance);
            }
        }
        Features { flanks, tips }
    }
}
