//! Distances of points drawn at random from their plane (Chen et al. 2023, Fig. 7).

use crate::geometry::stats::SplitMix;

use super::{Cloud, Plane, PointSet};

/// As many as the paper draws from each plane.
pub const NUM_DRAWN: usize = 400;

/// Draws points of a region, each at most once, and measures their distances from a plane, mm, signed. All of them are drawn
/// where the region holds no more.
#[must_use]
pub fn random_distances(cloud: &Cloud, set: &PointSet, plane: &Plane, num: usize, seed: u64) -> Vec<f64> {
    let mut drawn = draw(set.len(), num, seed).into_iter().peekable();
    let mut distances = Vec::with_capacity(num.min(set.len()));
    let mut before = 0;
    for run in set.runs() {
        while let Some(place) = drawn.next_if(|place| *place < before + run.len()) {
            distances.push(plane.distance_mm(cloud.point_mm(run.start + place - before)));
        }
        before += run.len();
    }
    distances
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_drawn_once_each() {
        assert_eq!(draw(5, 9, 1), [0, 1, 2, 3, 4]);
        let drawn = draw(1000, 400, 7);
        assert_eq!(drawn.len(), 400);
        assert!(drawn.is_sorted_by(|a, b| a < b) && drawn[399] < 1000);
        assert_eq!(drawn, draw(1000, 400, 7));
    }
}
