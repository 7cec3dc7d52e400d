//! Small patches of a surface: a thinned sample of its points, how far apart they are, and the planes of patches.

use crate::geometry::stats::{SplitMix, median};
use crate::geometry::{Mat3, Vec3};

use super::plane::plane_of;
use super::{Cloud, Plane, PointSet};

/// Points of a patch.
const NUM_NEIGHBOURS: usize = 24;
/// Patches that tell the size of all.
const NUM_PROBES: usize = 60;
/// The same patches every time.
const SEED: u64 = 0x9a7c;

/// Points of a region, thinned, about the cloud's origin.
pub(super) struct Sample {
    pub(super) points: Vec<Vec3>,
    /// A ball of this radius about a point holds about two dozen of them, mm.
    pub(super) radius_mm: f64,
}

/// A patch of the surface.
pub(super) struct Patch {
    pub(super) plane: Plane,
    pub(super) rms_mm: f64,
}

impl Sample {
    pub(super) fn of(cloud: &Cloud, set: &PointSet, most: usize) -> Self {
        let points: Vec<Vec3> = set.thinned(most).into_iter().map(|idx| cloud.offset_mm(idx)).collect();
        let mut random = SplitMix::new(SEED);
        let mut radii: Vec<f64> = Vec::new();
        let mut distances = Vec::new();
        if points.len() > NUM_NEIGHBOURS {
            for _ in 0..NUM_PROBES {
                let centre = points[random.below(points.len())];
                distances.clear();
                distances.extend(points.iter().map(|point| (point - centre).norm_squared()));
                radii.push(distances.select_nth_unstable_by(NUM_NEIGHBOURS, f64::total_cmp).1.sqrt());
            }
        }
        let radius_mm = if radii.is_empty() { f64::INFINITY } else { median(&mut radii) };
        Self { points, radius_mm }
    }

    /// The plane of the points near a place; `None` where there are too few.
    pub(super) fn patch(&self, centre: Vec3) -> Option<Patch> {
        let limit = self.radius_mm * self.radius_mm;
        let near: Vec<Vec3> =
            self.points.iter().filter(|point| (*point - centre).norm_squared() <= limit).copied().collect();
        if near.len() < NUM_NEIGHBOURS / 2 {
            return None;
        }
        plane_of(near.into_iter()).map(|(plane, rms_mm)| Patch { plane, rms_mm })
    }

    /// Patches about points drawn at random.
    pub(super) fn patches(&self, num: usize) -> Vec<Patch> {
        let mut random = SplitMix::new(SEED);
        if self.points.is_empty() {
            return Vec::new();
        }
        (0..num).filter_map(|_| self.patch(self.points[random.below(self.points.len())])).collect()
    }

    /// How far points stand from the planes of their patches, as a rule, mm.
    pub(super) fn roughness_mm(&self) -> f64 {
        let mut rms: Vec<f64> = self.patches(NUM_PROBES).into_iter().map(|patch| patch.rms_mm).collect();
        if rms.is_empty() { 0.0 } else { median(&mut rms) }
    }
}

/// The direction that all normals are perpendicular to, as far as they are: that along which a part stays the same. With it
/// the angle by which the middle one of the normals is off, rad.
pub(super) fn common_direction(normals: &[Vec3]) -> Option<(Vec3, f64)> {
    /// Normals that are off by more are of something else, and count less and less, rad.
    const OFF: f64 = 0.05;
    const NUM_PASSES: usize = 12;
    let mut direction = None;
    for _ in 0..NUM_PASSES {
        let scatter = normals.iter().fold(Mat3::zeros(), |sum, normal| {
            let off = direction.map_or(0.0, |direction: Vec3| direction.dot(normal) / OFF);
            sum + normal * normal.transpose() / (1.0 + off * off)
        });
        let eigen = scatter.symmetric_eigen();
        direction = Some(eigen.eigenvectors.column(eigen.eigenvalues.imin()).into_owned());
    }
    let direction = direction?;
    let mut off: Vec<f64> = normals.iter().map(|normal| normal.dot(&direction).abs().asin()).collect();
    (off.len() >= 3).then(|| (direction, median(&mut off)))
}
