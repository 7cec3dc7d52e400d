//! Regions that are planes: grown from a point, or all that a part has.

use nalgebra::Vector2;

use crate::geometry::Vec3;
use crate::geometry::stats::SplitMix;
use crate::watch::{Cancelled, Watch};

use super::neighbourhood::Sample;
use super::plane::plane_of;
use super::{Cloud, Plane, PlaneFit, PointSet, ScanError, fit_plane};

/// Points that planes are looked for among: enough for a plane of a hundredth of the part.
const NUM_SAMPLED: usize = 12_000;
/// Patches from which a plane is grown in search of the largest.
const NUM_SEEDS: usize = 80;
/// The same search, the same planes.
const SEED: u64 = 0x9142e;
/// Pieces of a plane smaller than this part of its largest are something else that the plane cuts.
const LEAST_PIECE: f64 = 0.05;
/// Cells along a plane at most.
const MOST_CELLS: f64 = 1024.0;
/// Planes at a lesser angle (its sine) have no edge.
const LEAST_CROSSING: f64 = 0.15;
/// Points this many tolerances from another plane are by its edge.
const EDGE_TOLERANCES: f64 = 4.0;
/// Surfaces are never flatter than this to a sensor on a robot, mm.
const LEAST_TOLERANCE_MM: f64 = 0.15;

/// What counts as a plane of the part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SegmentOptions {
    /// Greatest distance of a plane's points from it, mm; from the roughness of the surface if not given.
    pub tolerance_mm: Option<f64>,
    /// A plane holds at least this part of all points.
    pub least_share: f64,
    /// At most so many planes, the largest first.
    pub most: usize,
}

impl Default for SegmentOptions {
    fn default() -> Self {
        Self { tolerance_mm: None, least_share: 0.04, most: 8 }
    }
}

/// The tolerance that suits a region: five times the roughness of its patches, mm.
#[must_use]
pub fn suitable_tolerance_mm(cloud: &Cloud, set: &PointSet) -> f64 {
    (5.0 * Sample::of(cloud, set, NUM_SAMPLED).roughness_mm()).max(LEAST_TOLERANCE_MM)
}

/// The planes that a part has, the largest first, and no point in two of them.
///
/// Planes are grown from patches here and there over a sample; the one with most points is taken with all of its points that
/// hang together, and the search goes on among the others.
///
/// # Errors
/// [`Cancelled`].
pub fn find_planes(
    cloud: &Cloud,
    set: &PointSet,
    options: &SegmentOptions,
    watch: &mut dyn Watch,
) -> Result<Vec<PointSet>, Cancelled> {
    let tolerance_mm = options.tolerance_mm.unwrap_or_else(|| suitable_tolerance_mm(cloud, set));
    #[expect(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a part of a count"
    )]
    let least = (set.len() as f64 * options.least_share).ceil() as usize;
    let mut left = set.clone();
    let mut found: Vec<Found> = Vec::new();
    while found.len() < options.most && left.len() >= least.max(3) {
        watch.report(found.len(), options.most)?;
        let Some(next) = largest(cloud, &left, tolerance_mm).filter(|next| next.region.len() >= least) else { break };
        left = left.without(&next.taken);
        found.push(next);
    }
    let planes: Vec<Plane> = found.iter().map(|found| found.plane).collect();
    let mut regions: Vec<PointSet> = (found.iter().enumerate())
        .map(|(idx, found)| {
            // Points by an edge are of both planes, or of neither: a sensor sees edges badly.
            let crosses = |other: &Plane| other.normal.cross(&planes[idx].normal).norm() > LEAST_CROSSING;
            let others: Vec<&Plane> = planes.iter().filter(|other| crosses(other)).collect();
            found.region.filter(cloud, |point| {
                others.iter().all(|other| other.distance_mm(point).abs() > EDGE_TOLERANCES * tolerance_mm)
            })
        })
        .collect();
    regions.retain(|region| region.len() >= 3);
    regions.sort_by_key(|region| std::cmp::Reverse(region.len()));
    Ok(regions)
}

/// A plane that was found, about the cloud's origin.
struct Found {
    plane: Plane,
    region: PointSet,
    /// Points that are not looked at again: they lie near it.
    taken: PointSet,
}

/// The largest plane among the points.
fn largest(cloud: &Cloud, left: &PointSet, tolerance_mm: f64) -> Option<Found> {
    let sample = Sample::of(cloud, left, NUM_SAMPLED);
    let mut random = SplitMix::new(SEED);
    let best = (0..NUM_SEEDS)
        .filter_map(|_| {
            let seed = sample.points[random.below(sample.points.len())];
            grown(&sample, seed, tolerance_mm)
        })
        .max_by_key(|(count, _)| *count)?;
    let region = near(cloud, left, &best.1, tolerance_mm);
    let fit = fit_plane(cloud, &region).ok()?;
    let pieces = Pieces::of(cloud, &near_fit(cloud, left, &fit, tolerance_mm), &fit, sample.radius_mm);
    let kept = pieces.large();
    let hangs_together = |set: &PointSet| pieces.keep(cloud, set, &kept);
    let region = hangs_together(&near_fit(cloud, left, &fit, tolerance_mm));
    let taken = hangs_together(&near_fit(cloud, left, &fit, 2.0 * tolerance_mm));
    Some(Found { plane: fit.plane.about(cloud.origin_mm()), region, taken })
}

/// The points that lie on one plane with a point and hang together with it.
///
/// # Errors
/// [`ScanError::TooFewPoints`] where the point stands alone, [`ScanError::NoPlane`] where the surface about it is not flat.
pub fn grow_plane(cloud: &Cloud, set: &PointSet, seed_mm: Vec3, tolerance_mm: f64) -> Result<PointSet, ScanError> {
    const NEEDED: usize = 12;
    let sample = Sample::of(cloud, set, NUM_SAMPLED);
    let seed = seed_mm - cloud.origin_mm();
    let no_plane = ScanError::NoPlane { needed: NEEDED, tolerance_mm };
    let (_, plane) = grown(&sample, seed, tolerance_mm).ok_or_else(|| no_plane.clone())?;
    let fit = fit_plane(cloud, &near(cloud, set, &plane, tolerance_mm))?;
    let candidates = near_fit(cloud, set, &fit, tolerance_mm);
    let pieces = Pieces::of(cloud, &candidates, &fit, sample.radius_mm);
    let region = match pieces.label_at(seed) {
        Some(label) => pieces.keep(cloud, &candidates, &[label]),
        None => PointSet::default(),
    };
    if region.len() < NEEDED { Err(no_plane) } else { Ok(region) }
}

/// A plane grown from the patch about a point over a sample: it is fitted again to what is near it, ever farther out. With
/// it the number of points that are on it.
fn grown(sample: &Sample, seed: Vec3, tolerance_mm: f64) -> Option<(usize, Plane)> {
    let mut plane = sample.patch(seed)?.plane;
    let farthest = sample.points.iter().map(|point| (point - seed).norm_squared()).fold(0.0, f64::max).sqrt();
    let mut reach = 2.0 * sample.radius_mm.min(farthest);
    loop {
        let on_plane = sample.points.iter().filter(|point| {
            (*point - seed).norm_squared() <= reach * reach && plane.distance_mm(**point).abs() <= tolerance_mm
        });
        plane = plane_of(on_plane.copied())?.0;
        if reach > farthest {
            break;
        }
        reach *= 1.7;
    }
    let count = sample.points.iter().filter(|point| plane.distance_mm(**point).abs() <= tolerance_mm).count();
    Some((count, plane))
}

/// Those within a distance of a plane that is about the cloud's origin.
fn near(cloud: &Cloud, set: &PointSet, plane: &Plane, tolerance_mm: f64) -> PointSet {
    set.filter(cloud, |point| plane.distance_mm(point).abs() <= tolerance_mm)
}

fn near_fit(cloud: &Cloud, set: &PointSet, fit: &PlaneFit, tolerance_mm: f64) -> PointSet {
    near(cloud, set, &fit.plane.about(cloud.origin_mm()), tolerance_mm)
}

/// The pieces of a plane that hang together, over square cells.
struct Pieces {
    axes: [Vec3; 2],
    low: Vector2<f64>,
    cell_mm: f64,
    columns: usize,
    /// Per cell, its piece from 1; 0 where there is nothing.
    labels: Vec<u32>,
    /// Points of each piece.
    sizes: Vec<usize>,
}

impl Pieces {
    fn of(cloud: &Cloud, set: &PointSet, fit: &PlaneFit, spacing_mm: f64) -> Self {
        let axes = fit.axes;
        let place = |point: Vec3| Vector2::new(axes[0].dot(&point), axes[1].dot(&point));
        let places = || set.indices().map(|idx| place(cloud.offset_mm(idx)));
        let low = places().fold(Vector2::repeat(f64::INFINITY), |low, place| low.inf(&place));
        let high = places().fold(Vector2::repeat(f64::NEG_INFINITY), |high, place| high.sup(&place));
        let extent = (high - low).max().max(1e-6);
        let cell_mm = spacing_mm.min(extent).max(extent / MOST_CELLS);
        let (columns, rows) = (cells(high.x - low.x, cell_mm) + 1, cells(high.y - low.y, cell_mm) + 1);
        let mut pieces = Self { axes, low, cell_mm, columns, labels: vec![0; columns * rows], sizes: Vec::new() };
        let mut counts = vec![0_usize; columns * rows];
        for idx in set.indices() {
            if let Some(cell) = pieces.cell_at(cloud.offset_mm(idx)) {
                counts[cell] += 1;
            }
        }
        pieces.label(&counts, rows);
        pieces
    }

    fn cell_at(&self, point: Vec3) -> Option<usize> {
        let [x, y] = [self.axes[0].dot(&point) - self.low.x, self.axes[1].dot(&point) - self.low.y];
        let (column, row) = (cells(x, self.cell_mm), cells(y, self.cell_mm));
        (x >= 0.0 && y >= 0.0 && column < self.columns && row * self.columns < self.labels.len())
            .then_some(row * self.columns + column)
    }

    fn label(&mut self, counts: &[usize], rows: usize) {
        let mut open = Vec::new();
        for start in 0..counts.len() {
            if counts[start] == 0 || self.labels[start] != 0 {
                continue;
            }
            let label = u32::try_from(self.sizes.len() + 1).unwrap_or(u32::MAX);
            let mut size = 0;
            self.labels[start] = label;
            open.push(start);
            while let Some(cell) = open.pop() {
                size += counts[cell];
                let (row, column) = (cell / self.columns, cell % self.columns);
                for near_row in row.saturating_sub(1)..(row + 2).min(rows) {
                    for near_column in column.saturating_sub(1)..(column + 2).min(self.columns) {
                        let next = near_row * self.columns + near_column;
                        if counts[next] > 0 && self.labels[next] == 0 {
                            self.labels[next] = label;
                            open.push(next);
                        }
                    }
                }
            }
            self.sizes.push(size);
        }
    }

    fn label_at(&self, point: Vec3) -> Option<u32> {
        self.cell_at(point).map(|cell| self.labels[cell]).filter(|label| *label > 0)
    }

    /// The pieces that are of the plane and not merely cut by it.
    #[expect(clippy::cast_precision_loss, reason = "counts of points")]
    fn large(&self) -> Vec<u32> {
        let greatest = self.sizes.iter().copied().max().unwrap_or(0);
        let is_large = |size: usize| size as f64 >= LEAST_PIECE * greatest as f64;
        (1..).zip(&self.sizes).filter(|(_, size)| is_large(**size)).map(|(label, _)| label).collect()
    }

    fn keep(&self, cloud: &Cloud, set: &PointSet, labels: &[u32]) -> PointSet {
        let mut is_kept = vec![false; self.sizes.len() + 1];
        for label in labels {
            is_kept[*label as usize] = true;
        }
        set.filter(cloud, |point| self.label_at(point).is_some_and(|label| is_kept[label as usize]))
    }
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the conversion saturates")]
fn cells(length_mm: f64, cell_mm: f64) -> usize {
    (length_mm / cell_mm) as usize
}
