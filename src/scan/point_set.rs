//! A choice of points: a box, a polygon in a view, or whatever a test says.

use std::collections::HashMap;
use std::ops::Range;

use crate::geometry::Vec3;

use super::lanes::for_pieces;
use super::{Cloud, ScanError};

/// Points of a cloud, as runs of neighbouring indices: points that lie together in space mostly follow each other in their
/// profiles, so the runs are few and the loops over them quick.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PointSet {
    /// In rising order, none empty, none touching the next.
    runs: Vec<Range<u32>>,
    num_points: usize,
}

impl PointSet {
    /// All points.
    #[must_use]
    pub fn all(cloud: &Cloud) -> Self {
        let mut set = Self::default();
        set.push_run(0..cloud.len());
        set
    }

    /// From runs in rising order.
    fn from_runs(runs: impl IntoIterator<Item = Range<usize>>) -> Self {
        let mut set = Self::default();
        for run in runs {
            set.push_run(run);
        }
        set
    }

    fn push_run(&mut self, run: Range<usize>) {
        if run.is_empty() {
            return;
        }
        self.num_points += run.len();
        let narrow = |idx: usize| u32::try_from(idx).unwrap_or(u32::MAX);
        match self.runs.last_mut() {
            Some(last) if last.end as usize == run.start => last.end = narrow(run.end),
            _ => self.runs.push(narrow(run.start)..narrow(run.end)),
        }
    }

    /// Number of points.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.num_points
    }

    /// Whether there are none.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.num_points == 0
    }

    /// The runs of indices, rising.
    pub fn runs(&self) -> impl Iterator<Item = Range<usize>> + '_ {
        self.runs.iter().map(|run| run.start as usize..run.end as usize)
    }

    /// The indices, rising.
    pub fn indices(&self) -> impl Iterator<Item = usize> + '_ {
        self.runs().flatten()
    }

    /// Whether a point is among them.
    #[must_use]
    pub fn contains(&self, idx: usize) -> bool {
        let after = self.runs.partition_point(|run| run.start as usize <= idx);
        after.checked_sub(1).is_some_and(|run| idx < self.runs[run].end as usize)
    }

    /// At most `most` of the indices, evenly spread.
    #[must_use]
    pub fn thinned(&self, most: usize) -> Vec<usize> {
        let step = self.num_points.div_ceil(most.max(1)).max(1);
        self.indices().step_by(step).collect()
    }

    /// Those of the points that pass a test of their offsets from the cloud's origin, mm.
    #[must_use]
    pub fn filter(&self, cloud: &Cloud, test: impl Fn(Vec3) -> bool + Sync) -> Self {
        let found = for_pieces(self, |piece| {
            let mut runs: Vec<Range<usize>> = Vec::new();
            for idx in piece.iter().cloned().flatten() {
                if test(cloud.offset_mm(idx)) {
                    match runs.last_mut() {
                        Some(last) if last.end == idx => last.end = idx + 1,
                        _ => runs.push(idx..idx + 1),
                    }
                }
            }
            runs
        });
        Self::from_runs(found.into_iter().flatten())
    }

    /// The points that are not in another set.
    #[must_use]
    pub fn without(&self, other: &Self) -> Self {
        let mut left = Vec::new();
        let mut others = other.runs().peekable();
        for run in self.runs() {
            let mut start = run.start;
            while let Some(taken) = others.peek() {
                if taken.start >= run.end {
                    break;
                }
                left.push(start..taken.start.max(start));
                start = start.max(taken.end.min(run.end));
                if taken.end > run.end {
                    break;
                }
                others.next();
            }
            left.push(start..run.end);
        }
        Self::from_runs(left)
    }

    /// The points of the cloud within a box along the base's axes, mm.
    #[must_use]
    pub fn in_box(cloud: &Cloud, low_mm: Vec3, high_mm: Vec3) -> Self {
        let (low, high) = (low_mm - cloud.origin_mm(), high_mm - cloud.origin_mm());
        Self::all(cloud).filter(cloud, |point| (0..3).all(|axis| (low[axis]..=high[axis]).contains(&point[axis])))
    }

    /// The points within a polygon drawn over a view: `right` and `down` are the view's axes in the base, corners are along
    /// them from the cloud's origin, mm. Only what can be seen is taken, not what stands behind it.
    ///
    /// # Errors
    /// [`ScanError::NotAPolygon`].
    pub fn in_polygon(cloud: &Cloud, right: Vec3, down: Vec3, corners_mm: &[[f64; 2]]) -> Result<Self, ScanError> {
        if corners_mm.len() < 3 {
            return Err(ScanError::NotAPolygon { found: corners_mm.len() });
        }
        let inside =
            Self::all(cloud).filter(cloud, |point| is_inside(corners_mm, [point.dot(&right), point.dot(&down)]));
        Ok(inside.in_front(cloud, right, down))
    }

    /// The points that are not hidden from a view by others. The view is laid out in cells, each some points wide; in a cell the
    /// front surface ends where the next point is a cell's width farther away.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_precision_loss,
        reason = "places among cells, which are few enough"
    )]
    fn in_front(&self, cloud: &Cloud, right: Vec3, down: Vec3) -> Self {
        /// Points in a cell where they are spread evenly: scans are dense along the line and sparse along the path.
        const IN_CELL: f64 = 16.0;
        /// Fewer are no surface.
        const LEAST: usize = 3;
        let away = right.cross(&down);
        let bounds =
            self.indices().map(|idx| cloud.offset_mm(idx)).fold([f64::MAX, f64::MIN, f64::MAX, f64::MIN], |b, p| {
                let (x, y) = (p.dot(&right), p.dot(&down));
                [b[0].min(x), b[1].max(x), b[2].min(y), b[3].max(y)]
            });
        let area = (bounds[1] - bounds[0]) * (bounds[3] - bounds[2]);
        if self.len() < 2 * LEAST || area.is_nan() || area <= 0.0 {
            return self.clone();
        }
        let size = (area * IN_CELL / self.len() as f64).sqrt();
        let cell = |point: Vec3| [right, down].map(|axis| (point.dot(&axis) / size).floor() as i64);
        let mut depths: HashMap<[i64; 2], Vec<f64>> = HashMap::new();
        for point in self.indices().map(|idx| cloud.offset_mm(idx)) {
            depths.entry(cell(point)).or_default().push(point.dot(&away));
        }
        let ends: HashMap<[i64; 2], f64> = depths
            .into_iter()
            .map(|(cell, mut depths)| {
                depths.sort_by(f64::total_cmp);
                let mut surfaces = depths.chunk_by(|near, far| far - near <= size);
                let front = surfaces.find(|surface| surface.len() >= LEAST).unwrap_or(&depths);
                (cell, front.last().copied().unwrap_or(f64::INFINITY))
            })
            .collect();
        self.filter(cloud, |point| ends.get(&cell(point)).is_none_or(|end| point.dot(&away) <= *end))
    }

    /// The part of the points of both sets that is in each of them: 1 for the same points.
    #[must_use]
    #[expect(clippy::cast_precision_loss, reason = "counts of points")]
    pub fn shared_with(&self, other: &Self) -> f64 {
        let shared = self.len() - self.without(other).len();
        shared as f64 / (self.len() + other.len() - shared).max(1) as f64
    }
}

/// Whether a point is inside a polygon: a ray from it crosses the border an odd number of times.
fn is_inside(corners: &[[f64; 2]], [x, y]: [f64; 2]) -> bool {
    let mut inside = false;
    let mut before = corners[corners.len() - 1];
    for &corner in corners {
        let crosses = (corner[1] > y) != (before[1] > y);
        if crosses && x < (before[0] - corner[0]) * (y - corner[1]) / (before[1] - corner[1]) + corner[0] {
            inside = !inside;
        }
        before = corner;
    }
    inside
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(num: u16) -> Cloud {
        let mut cloud = Cloud::about(Vec3::new(100.0, 0.0, 0.0));
        for idx in 0..num {
            cloud.push(Vec3::new(100.0 + f64::from(idx), 0.0, 0.0), 0).expect("room");
        }
        cloud
    }

    #[test]
    fn sets_are_told_apart() {
        let cloud = row(20);
        let all = PointSet::all(&cloud);
        let even = all.filter(&cloud, |point| point.x.rem_euclid(2.0) < 0.5);
        assert_eq!(even.len(), 10);
        assert_eq!(
            all.without(&even).indices().collect::<Vec<_>>(),
            (0..10).map(|idx| 2 * idx + 1).collect::<Vec<_>>()
        );
        let middle = PointSet::in_box(&cloud, Vec3::new(104.5, -1.0, -1.0), Vec3::new(110.5, 1.0, 1.0));
        assert!(middle.runs().eq(std::iter::once(5..11)));
        assert_eq!(all.without(&middle).runs().collect::<Vec<_>>(), [0..5, 11..20]);
        assert_eq!(middle.without(&all).len(), 0);
        assert_eq!(all.without(&PointSet::default()), all);
        assert_eq!(all.thinned(7).len(), 7);
        assert!(
            (0..20).all(|idx| middle.contains(idx) == (5..11).contains(&idx) && !PointSet::default().contains(idx))
        );
    }

    #[test]
    fn a_polygon_takes_what_is_inside_of_it() {
        let cloud = row(20);
        let triangle = [[2.5, -1.0], [8.5, -1.0], [5.0, 2.0]];
        let set = PointSet::in_polygon(&cloud, Vec3::x(), Vec3::y(), &triangle).expect("three corners");
        assert!(set.runs().eq(std::iter::once(4..8)));
        let refusal = PointSet::in_polygon(&cloud, Vec3::x(), Vec3::y(), &triangle[..2]);
        assert_eq!(refusal, Err(ScanError::NotAPolygon { found: 2 }));
    }
}
