//! The cameras and their images: intrinsics, how the two are mounted to each other, one frame of both.

use image::{ImageBuffer, Luma, RgbImage};
use thiserror::Error;

use crate::geometry::{DepthCamera, Sensor, Transform, Vec3};

/// Distances along the optical axis in units of [`RgbdCamera::depth_units_per_m`]; 0 where nothing was measured.
pub type DepthImage = ImageBuffer<Luma<u16>, Vec<u16>>;

/// Why numbers do not describe a camera.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum CameraError {
    /// A size that no image has.
    #[error("found an image of {width} × {height} pixels; 1 to {} each are needed", Intrinsics::MAX_SIDE_PX)]
    Size {
        /// Pixels across.
        width: u32,
        /// Pixels down.
        height: u32,
    },
    /// A focal length or centre that no camera has.
    #[error("found {name} = {value}; {needed}")]
    Value {
        /// `fx`, `fy`, `cx`, `cy` or `depth_scale`.
        name: &'static str,
        /// The value found.
        value: f64,
        /// What would do.
        needed: &'static str,
    },
}

/// A pinhole camera without distortion, px.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Intrinsics {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Focal length along x.
    pub fx: f64,
    /// Focal length along y; negative where the image's rows count against the camera's y axis.
    pub fy: f64,
    /// Column of the optical axis.
    pub cx: f64,
    /// Row of the optical axis.
    pub cy: f64,
}

impl Intrinsics {
    /// Longer sides are a broken file.
    pub const MAX_SIDE_PX: u32 = 8192;

    /// From a size and the camera matrix.
    ///
    /// # Errors
    /// [`CameraError`] for sizes and values that no camera has.
    pub fn new([width, height]: [u32; 2], [fx, fy]: [f64; 2], [cx, cy]: [f64; 2]) -> Result<Self, CameraError> {
        let is_side = |side: u32| (1..=Self::MAX_SIDE_PX).contains(&side);
        if !is_side(width) || !is_side(height) {
            return Err(CameraError::Size { width, height });
        }
        for (name, value) in [("fx", fx), ("fy", fy)] {
            if !(1e-3..=1e6).contains(&value.abs()) {
                return Err(CameraError::Value { name, value, needed: "a focal length in pixels, not 0, is needed" });
            }
        }
        for (name, value) in [("cx", cx), ("cy", cy)] {
            if !(-1e6..=1e6).contains(&value) {
                return Err(CameraError::Value { name, value, needed: "the column or row of the axis is needed" });
            }
        }
        Ok(Self { width, height, fx, fy, cx, cy })
    }

    /// The point at distance `z_mm` along the optical axis that is seen at a pixel.
    #[must_use]
    pub fn point_at(&self, [u, v]: [f64; 2], z_mm: f64) -> Vec3 {
        Vec3::new((u - self.cx) / self.fx * z_mm, (v - self.cy) / self.fy * z_mm, z_mm)
    }

    /// The pixel at which a point is seen; `None` behind the camera. The pixel may lie outside the image.
    #[must_use]
    pub fn pixel_of(&self, point_in_camera_mm: &Vec3) -> Option<[f64; 2]> {
        let [x, y, z] = [point_in_camera_mm.x, point_in_camera_mm.y, point_in_camera_mm.z];
        (z > 0.0).then(|| [self.fx * x / z + self.cx, self.fy * y / z + self.cy])
    }
}

/// A colour and a depth camera, rigidly joined.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RgbdCamera {
    /// The colour camera, whose frame is the sensor's.
    pub color: Intrinsics,
    /// The depth camera.
    pub depth: Intrinsics,
    /// How the depth camera is mounted beside the colour camera; the identity where depth comes aligned already.
    pub color_from_depth: Transform<Sensor, DepthCamera>,
    /// Units of a depth image in a metre: 5000 for the TUM format, 1000 where it counts millimetres.
    pub depth_units_per_m: f64,
}

impl RgbdCamera {
    /// Millimetres in one unit of a depth image.
    #[must_use]
    pub fn mm_per_unit(&self) -> f64 {
        1000.0 / self.depth_units_per_m
    }

    /// Whether depth pixels are colour pixels, so that nothing has to be aligned.
    #[must_use]
    pub fn is_aligned(&self) -> bool {
        self.color == self.depth && self.color_from_depth == Transform::identity()
    }
}

/// What both cameras saw at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct RgbdFrame {
    /// Time of the colour image, s.
    pub time_s: f64,
    /// The colour image.
    pub color: RgbImage,
    /// The depth image as the depth camera saw it.
    pub depth: DepthImage,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_is_seen_where_its_pixel_says() -> Result<(), CameraError> {
        // A negative fy is that of synthetic sequences whose y axis points up.
        for fy in [480.0, -480.0] {
            let camera = Intrinsics::new([640, 480], [481.2, fy], [319.5, 239.5])?;
            let point = camera.point_at([100.25, 77.5], 1234.0);
            let pixel = camera.pixel_of(&point).unwrap_or_default();
            // Rounding of a few operations on numbers of a hundred.
            assert!((pixel[0] - 100.25).abs() < 1e-10 && (pixel[1] - 77.5).abs() < 1e-10);
        }
        Ok(())
    }

    #[test]
    fn numbers_that_no_camera_has_are_refused() {
        let good = ([640, 480], [500.0, 500.0], [320.0, 240.0]);
        assert!(Intrinsics::new(good.0, good.1, good.2).is_ok());
        assert!(matches!(Intrinsics::new([0, 480], good.1, good.2), Err(CameraError::Size { .. })));
        assert!(matches!(Intrinsics::new([640, 1_000_000], good.1, good.2), Err(CameraError::Size { .. })));
        for focal in [0.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(
                Intrinsics::new(good.0, [focal, 1.0], good.2),
                Err(CameraError::Value { name: "fx", .. })
            ));
        }
        assert!(matches!(Intrinsics::new(good.0, good.1, [0.0, f64::NAN]), Err(CameraError::Value { name: "cy", .. })));
    }
}
