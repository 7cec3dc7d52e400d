//! Small patches of a surface: a thinned sample of its points, how far apart they are, and the planes of patches.

use crate::geometry::Vec3;
use crate::geometry::stats::{SplitMix, median};

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
