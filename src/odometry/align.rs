//! Step 2 of the patent: the depth image as the colour camera would have taken it.
//!
//! With the depth camera as the world, a point M is seen by the depth camera at `m_D = K_D M` (eq. 4) and by the colour camera
//! at `m_C = K_C R (M − C)` (eq. 3), both by the pinhole model m = K R (M − C) (eq. 1 and 2). So a pixel of the depth image
//! falls on `m_C = K_C (R K_D⁻¹ m_D + t)`, t = −R C (eq. 5). R and t are our `color_from_depth`.

use super::camera::{DepthImage, Intrinsics, RgbdCamera};

/// A depth pixel covers a little more than its own size: on slanted surfaces neighbours fall farther apart.
const COVER: f32 = 1.15;
/// Adding it leaves a number's whole part in the lowest bits of the mantissa: rounding without a conversion.
const ROUNDER: f32 = 12_582_912.0;
/// Nothing was seen here yet: farther than everything.
const NOTHING: u16 = u16::MAX;

/// The depth image as seen by the colour camera, in the same units: of all that falls on a pixel the nearest; 0 where
/// nothing does. A depth pixel covers its footprint, so that no grid of holes appears where the colour camera has more
/// pixels.
#[must_use]
pub fn aligned(depth: &DepthImage, camera: &RgbdCamera) -> DepthImage {
    if camera.is_aligned() {
        return depth.clone();
    }
    let mut nearest = DepthImage::from_pixel(camera.color.width, camera.color.height, image::Luma([NOTHING]));
    let projection = Projection::of(camera);
    let mut spots = Spots::new(depth.width() as usize);
    let width = depth.width().max(1) as usize;
    for (row, line) in (0_u16..).zip(depth.as_raw().chunks_exact(width)) {
        projection.project(f32::from(row), line, &mut spots);
        spots.draw(&mut nearest);
    }
    for value in nearest.iter_mut() {
        *value = if *value == NOTHING { 0 } else { *value };
    }
    nearest
}

/// Equation (5) with what is the same for all pixels computed once.
struct Projection {
    /// `K_C R K_D⁻¹` without the part of the row: what a column adds for a unit of depth, column after column.
    of_column: [Vec<f32>; 3],
    /// `K_C R K_D⁻¹ (0, v, 1)` is `at_row_0 + v of_row`.
    at_row_0: [f32; 3],
    of_row: [f32; 3],
    /// `K_C t` in units of the depth image.
    shift: [f32; 3],
    /// Half the size of a depth pixel, in colour pixels, where both cameras are as far away.
    half_size: [f32; 2],
    color: Intrinsics,
}

impl Projection {
    fn of(camera: &RgbdCamera) -> Self {
        let RgbdCamera { color, depth, color_from_depth, .. } = camera;
        let rotation = color_from_depth.rotation();
        let by_color = |v: crate::geometry::Vec3| {
            #[expect(clippy::cast_possible_truncation, reason = "single precision is a ten-thousandth of a pixel")]
            [color.fx * v.x + color.cx * v.z, color.fy * v.y + color.cy * v.z, v.z].map(|value| value as f32)
        };
        let of_column = |column: u32| {
            by_color(rotation * crate::geometry::Vec3::new((f64::from(column) - depth.cx) / depth.fx, 0.0, 0.0))
        };
        let columns: Vec<[f32; 3]> = (0..depth.width).map(of_column).collect();
        #[expect(clippy::cast_possible_truncation, reason = "a size within a few pixels")]
        let half_size = [color.fx / depth.fx, color.fy / depth.fy].map(|ratio| (0.5 * ratio.abs()) as f32 * COVER);
        Self {
            of_column: [0, 1, 2].map(|axis| columns.iter().map(|column| column[axis]).collect()),
            at_row_0: by_color(rotation * crate::geometry::Vec3::new(0.0, -depth.cy / depth.fy, 1.0)),
            of_row: by_color(rotation * crate::geometry::Vec3::new(0.0, 1.0 / depth.fy, 0.0)),
            shift: by_color(color_from_depth.translation_mm() / camera.mm_per_unit()),
            half_size,
            color: *color,
        }
    }

    /// Where the pixels of a row fall.
    fn project(&self, row: f32, line: &[u16], spots: &mut Spots) {
        let [bx, by, bz] = [0, 1, 2].map(|axis| self.at_row_0[axis] + row * self.of_row[axis]);
        let [sx, sy, sz] = self.shift;
        let [hx, hy] = self.half_size;
        #[expect(clippy::cast_precision_loss, reason = "sides are below 8192 pixels")]
        let [last_x, last_y] = [self.color.width as f32, self.color.height as f32];
        // What falls outside is kept just outside, where no pixel is covered and the rounding still holds.
        let within = |value: f32, last: f32| {
            let value = if value < last + 1.0 { value } else { last + 1.0 };
            if value > -2.0 { value } else { -2.0 }
        };
        // Slices of one length, so that several pixels are computed at once.
        let num = line.len();
        let [ax, ay, az] = [0, 1, 2].map(|axis| &self.of_column[axis][..num]);
        let Spots { z: spot_z, left, right, top, bottom } = spots;
        let (spot_z, left, right) = (&mut spot_z[..num], &mut left[..num], &mut right[..num]);
        let (top, bottom) = (&mut top[..num], &mut bottom[..num]);
        for idx in 0..num {
            let d = f32::from(line[idx]);
            let (x, y, z) = (d * (ax[idx] + bx) + sx, d * (ay[idx] + by) + sy, d * (az[idx] + bz) + sz);
            let per_z = 1.0 / z;
            let (u, v, scale) = (x * per_z, y * per_z, d * per_z);
            let (half_u, half_v) = (hx * scale, hy * scale);
            // Of no depth, or behind the camera, no pixel is covered.
            let is_seen = d > 0.0 && z > 0.0;
            spot_z[idx] = rounded(if is_seen { within(z, 65_535.0) } else { 0.0 });
            left[idx] = rounded(within(u - half_u, last_x) + 0.499_99);
            right[idx] = rounded(within(u + half_u, last_x) - 0.499_99);
            top[idx] = rounded(within(v - half_v, last_y) + 0.499_99);
            bottom[idx] = rounded(within(v + half_v, last_y) - 0.499_99);
        }
    }
}

/// A number from −4 million to 4 million, rounded.
fn rounded(value: f32) -> i32 {
    (value + ROUNDER).to_bits().cast_signed() - ROUNDER.to_bits().cast_signed()
}

/// The colour pixels that the depth pixels of a row cover, ends included, and their depth there.
struct Spots {
    z: Vec<i32>,
    left: Vec<i32>,
    right: Vec<i32>,
    top: Vec<i32>,
    bottom: Vec<i32>,
}

impl Spots {
    fn new(width: usize) -> Self {
        let none = || vec![0; width];
        Self { z: none(), left: none(), right: none(), top: none(), bottom: none() }
    }

    /// Keeps the nearest at every pixel.
    fn draw(&self, nearest: &mut DepthImage) {
        let (width, height) = (nearest.width().cast_signed(), nearest.height().cast_signed());
        let pixels: &mut [u16] = nearest;
        let columns = self.left.iter().zip(&self.right);
        let rows = self.top.iter().zip(&self.bottom);
        for ((z, (left, right)), (top, bottom)) in self.z.iter().zip(columns).zip(rows) {
            // 65535 stands for "nothing yet" and is beyond every camera's range.
            let Some(z) = u16::try_from(*z).ok().filter(|z| (1..NOTHING).contains(z)) else { continue };
            let (left, right) = ((*left).max(0), (*right).min(width - 1));
            for row in (*top).max(0)..=(*bottom).min(height - 1) {
                for column in left..=right {
                    let at = (row * width + column).unsigned_abs() as usize;
                    if let Some(pixel) = pixels.get_mut(at) {
                        *pixel = z.min(*pixel);
                    }
                }
            }
        }
    }
}
