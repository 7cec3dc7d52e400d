//! Distances of points drawn at random from their plane (Chen et al. 2023, Fig. 7).

use crate::geometry::stats::{SplitMix, rms};

use super::{Cloud, Plane, PointSet};

/// As many as the paper draws from each plane.
pub const NUM_DRAWN: usize = 400;

/// What the distances of points from a plane come to.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Distances {
    /// The distances, signed, mm, in the order of drawing.
    pub signed_mm: Vec<f64>,
    /// Mean of their sizes, mm.
    pub mean_mm: f64,
    /// Standard deviation of their sizes, mm.
    pub std_mm: f64,
    /// The greatest size, mm.
    pub max_mm: f64,
    /// Root mean square, mm.
    pub rms_mm: f64,
}

impl Distances {
    /// The figures of some distances.
    #[must_use]
    #[expect(clippy::cast_precision_loss, reason = "counts of points")]
    pub fn of(signed_mm: Vec<f64>) -> Self {
        if signed_mm.is_empty() {
            return Self::default();
        }
        let count = signed_mm.len() as f64;
        let sizes = || signed_mm.iter().map(|distance| distance.abs());
        let mean_mm = sizes().sum::<f64>() / count;
        let squares: f64 = sizes().map(|size| (size - mean_mm).powi(2)).sum();
        Self {
            mean_mm,
            std_mm: (squares / (count - 1.0).max(1.0)).sqrt(),
            max_mm: sizes().fold(0.0, f64::max),
            rms_mm: rms(signed_mm.iter().copied()),
            signed_mm,
        }
    }

    /// How many sizes fall into each of so many bins of equal width, from 0 to [`Self::max_mm`].
    #[must_use]
    #[expect(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "bins, and places among them"
    )]
    pub fn histogram(&self, num_bins: usize) -> Vec<usize> {
        let mut counts = vec![0; num_bins];
        let width_mm = self.max_mm / num_bins as f64;
        for size in self.signed_mm.iter().map(|distance| distance.abs()) {
            let bin = if width_mm > 0.0 { (size / width_mm) as usize } else { 0 };
            if let Some(count) = counts.get_mut(bin.min(num_bins - 1)) {
                *count += 1;
            }
        }
        counts
    }
}

/// Draws points of a region, each at most once, and measures their distances from a plane. All of them are drawn where the
/// region holds no more.
#[must_use]
pub fn random_distances(cloud: &Cloud, set: &PointSet, plane: &Plane, num: usize, seed: u64) -> Distances {
    let drawn = draw(set.len(), num, seed);
    let mut drawn = drawn.into_iter().peekable();
    let mut distances = Vec::with_capacity(num.min(set.len()));
    let mut before = 0;
    for run in set.runs() {
        while let Some(place) = drawn.next_if(|place| *place < before + run.len()) {
            distances.push(plane.distance_mm(cloud.point_mm(run.start + place - before)));
        }
        before += run.len();
    }
    Distances::of(distances)
}

/// So many different numbers below a limit, rising.
fn draw(limit: usize, num: usize, seed: u64) -> Vec<usize> {
    if num >= limit {
        return (0..limit).collect();
    }
    let mut random = SplitMix::new(seed);
    let mut drawn = std::collections::BTreeSet::new();
    // Floyd's way: one number a turn, and no repeats.
    for last in limit - num..limit {
        let candidate = random.below(last + 1);
        if !drawn.insert(candidate) {
            drawn.insert(last);
        }
    }
    drawn.into_iter().collect()
}
