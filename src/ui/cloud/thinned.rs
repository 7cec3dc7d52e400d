//! Fewer points for the same picture.

use egui::Color32;

use crate::scan::Cloud;

/// Points drawn while the cloud is turned.
pub const IN_MOTION: usize = 60_000;
/// Points drawn once it stands still.
pub const AT_REST: usize = 500_000;

/// A part of a cloud's points, evenly spread, with their colours.
#[derive(Clone, Debug, Default)]
pub struct Thinned {
    /// The points' indices in the cloud, rising.
    pub idx: Vec<u32>,
    /// Offsets from the cloud's origin, mm.
    pub points: Vec<[f32; 3]>,
    /// Their colours.
    pub colors: Vec<Color32>,
}

impl Thinned {
    /// At most so many points: one of each group of neighbours in the file, not always the same one, as that would leave
    /// whole columns of the profiles out.
    #[must_use]
    pub fn new(cloud: &Cloud, most: usize, color_of: impl Fn(usize) -> Color32) -> Self {
        let group = cloud.len().div_ceil(most.max(1)).max(1);
        let [x, y, z] = cloud.offsets_mm();
        let mut thinned = Self::default();
        for (number, start) in (0..cloud.len()).step_by(group).enumerate() {
            let idx = start + scrambled(number) % group.min(cloud.len() - start);
            thinned.idx.push(u32::try_from(idx).unwrap_or(u32::MAX));
            thinned.points.push([x[idx], y[idx], z[idx]]);
            thinned.colors.push(color_of(idx));
        }
        thinned
    }
}

/// A number without any pattern, the same every time.
const fn scrambled(number: usize) -> usize {
    let mixed = (number as u64 ^ 0x5bd1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    ((mixed ^ (mixed >> 29)) >> 16) as usize
}

#[cfg(test)]
mod tests {
    use crate::geometry::Vec3;

    use super::*;

    #[test]
    fn no_column_is_left_out() {
        let mut cloud = Cloud::about(Vec3::zeros());
        for row in 0..200_u32 {
            for column in 0..50_u32 {
                cloud.push(Vec3::new(f64::from(column), f64::from(row), 0.0), row).expect("room");
            }
        }
        let thinned = Thinned::new(&cloud, 1000, |_| Color32::WHITE);
        assert_eq!(thinned.points.len(), 1000);
        for column in 0..50_u8 {
            let count = thinned.points.iter().filter(|[x, ..]| (x - f32::from(column)).abs() < 0.5).count();
            assert!((5..=40).contains(&count), "column {column}: {count}");
        }
        assert_eq!(Thinned::new(&cloud, 20_000, |_| Color32::WHITE).points.len(), 10_000);
    }
}
