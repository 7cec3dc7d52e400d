//! Step 2 of the patent: the depth image as the colour camera would have taken it.
//!
//! With the depth camera as the world, a point M is seen by the depth camera at `m_D = K_D M` (eq. 4) and by the colour camera
//! at `m_C = K_C R (M − C)` (eq. 3), both by the pinhole model m = K R (M − C) (eq. 1 and 2). So a pixel of the depth image
//! falls on `m_C = K_C (R K_D⁻¹ m_D + t)`, t = −R C (eq. 5). R and t are our `color_from_depth`.

use pulp::{Arch, WithSimd};

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
    let arch = Arch::new();
    for (row, depths) in (0_u16..).zip(depth.as_raw().chunks_exact(width)) {
        arch.dispatch(Line { projection: &projection, row: f32::from(row), depths, spots: &mut spots });
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
}

/// A row of the depth image, to be projected: compiled for the wide registers of newer processors as well and the better
/// version picked at run time, with the same bits.
struct Line<'a> {
    projection: &'a Projection,
    row: f32,
    depths: &'a [u16],
    spots: &'a mut Spots,
}

impl WithSimd for Line<'_> {
    type Output = ();

    #[expect(clippy::inline_always, reason = "must be compiled inside the function for the wide registers")]
    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _simd: S) {
        let Projection { of_column, at_row_0, of_row, shift, half_size, color } = self.projection;
        let [bx, by, bz] = [0, 1, 2].map(|axis| at_row_0[axis] + self.row * of_row[axis]);
        let [sx, sy, sz] = *shift;
        let [hx, hy] = *half_size;
        let (width, height) = (color.width.cast_signed(), color.height.cast_signed());
        #[expect(clippy::cast_precision_loss, reason = "sides are below 8192 pixels")]
        let [last_x, last_y] = [color.width as f32, color.height as f32];
        // What falls outside is kept just outside, where no pixel is covered and the rounding still holds.
        let within = |value: f32, last: f32| {
            let value = if value < last + 1.0 { value } else { last + 1.0 };
            if value > -2.0 { value } else { -2.0 }
        };
        // Slices of one length, so that several pixels are computed at once.
        let num = self.depths.len();
        let [ax, ay, az] = [0, 1, 2].map(|axis| &of_column[axis][..num]);
        let Spots { z: spot_z, first, across, down } = self.spots;
        let (spot_z, first) = (&mut spot_z[..num], &mut first[..num]);
        let (across, down) = (&mut across[..num], &mut down[..num]);
        for idx in 0..num {
            let d = f32::from(self.depths[idx]);
            let (x, y, z) = (d * (ax[idx] + bx) + sx, d * (ay[idx] + by) + sy, d * (az[idx] + bz) + sz);
            let per_z = 1.0 / z;
            let (u, v, scale) = (x * per_z, y * per_z, d * per_z);
            let (half_u, half_v) = (hx * scale, hy * scale);
            let left = rounded(within(u - half_u, last_x) + 0.499_99).max(0);
            let right = rounded(within(u + half_u, last_x) - 0.499_99).min(width - 1);
            let top = rounded(within(v - half_v, last_y) + 0.499_99).max(0);
            let bottom = rounded(within(v + half_v, last_y) - 0.499_99).min(height - 1);
            let units = rounded(within(z, 65_535.0));
            // Of no depth, behind the camera, or beyond every camera's range, no pixel is covered.
            let is_seen = d > 0.0 && units > 0 && units < i32::from(NOTHING);
            spot_z[idx] = units;
            first[idx] = top * width + left;
            across[idx] = if is_seen { right - left } else { -1 };
            down[idx] = bottom - top;
        }
    }
}

/// A number from −4 million to 4 million, rounded.
fn rounded(value: f32) -> i32 {
    (value + ROUNDER).to_bits().cast_signed() - ROUNDER.to_bits().cast_signed()
}

/// The colour pixels that the depth pixels of a row cover, and their depth there.
struct Spots {
    z: Vec<i32>,
    /// The upper left pixel, counted row by row.
    first: Vec<i32>,
    /// Columns to the last one; negative where no pixel is covered.
    across: Vec<i32>,
    /// Rows to the last one; negative where no pixel is covered.
    down: Vec<i32>,
}

impl Spots {
    fn new(width: usize) -> Self {
        let none = || vec![0; width];
        Self { z: none(), first: none(), across: none(), down: none() }
    }

    /// Keeps the nearest at every pixel.
    fn draw(&self, nearest: &mut DepthImage) {
        let width = nearest.width() as usize;
        let pixels: &mut [u16] = nearest;
        let sizes = self.across.iter().zip(&self.down);
        for ((z, first), (across, down)) in self.z.iter().zip(&self.first).zip(sizes) {
            #[expect(clippy::cast_possible_truncation, reason = "of what is covered it is below 65535")]
            let (z, first) = (z.cast_unsigned() as u16, first.cast_unsigned() as usize);
            let mut keep = |at: usize| {
                if let Some(pixel) = pixels.get_mut(at) {
                    *pixel = z.min(*pixel);
                }
            };
            // Mostly it is one pixel, where both cameras have about the same.
            if across | down == 0 {
                keep(first);
                continue;
            }
            let (Ok(across), Ok(down)) = (usize::try_from(*across), usize::try_from(*down)) else { continue };
            for row in 0..=down {
                (0..=across).for_each(|column| keep(first + row * width + column));
            }
        }
    }
}
