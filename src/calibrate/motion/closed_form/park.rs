//! Logarithms of the rotations, in the least-squares sense.
//!
//! # Source
//! F. C. Park, B. J. Martin, "Robot sensor calibration: solving AX = XB on the Euclidean group", IEEE Trans. Robotics and
//! Automation 10(5), 1994: with α = log `R_A` and β = log `R_B`, the rotation is that nearest to Σ α βᵀ.

use nalgebra::UnitQuaternion;

use crate::geometry::Mat3;
use crate::geometry::so3::{log, nearest_rotation};

use super::Pair;

pub(super) fn rotation(pairs: &[Pair]) -> Option<UnitQuaternion<f64>> {
    let sum: Mat3 = pairs.iter().map(|pair| log(&pair.flange.rotation) * log(&pair.sensor.rotation).transpose()).sum();
    nearest_rotation(&sum)
}
