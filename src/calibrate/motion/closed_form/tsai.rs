//! Modified Rodrigues vectors, rotation first.
//!
//! # Source
//! R. Y. Tsai, R. K. Lenz, "A new technique for fully autonomous and efficient 3D robotics hand/eye calibration", IEEE Trans.
//! Robotics and Automation 5(3), 1989, eq. 9–15: skew(`P_A` + `P_B`) P' = `P_B` − `P_A` with P = 2 sin(θ/2) n, and P' = tan(θ/2) n
//! of the rotation sought. That grows without bounds near a half turn, which is the method's singular place.

use nalgebra::{Quaternion, UnitQuaternion};

use crate::geometry::so3::hat;
use crate::geometry::{Mat3, Vec3};

use super::Pair;

pub(super) fn rotation(pairs: &[Pair]) -> Option<UnitQuaternion<f64>> {
    let mut matrix = Mat3::zeros();
    let mut right = Vec3::zeros();
    for pair in pairs {
        let (of_flange, of_sensor) = super::horaud::vector_parts(pair);
        let skew = hat((of_flange + of_sensor) * 2.0);
        matrix += skew.transpose() * skew;
        right += skew.transpose() * ((of_sensor - of_flange) * 2.0);
    }
    let tangent = matrix.cholesky()?.solve(&right);
    Some(UnitQuaternion::new_normalize(Quaternion::new(1.0, tangent.x, tangent.y, tangent.z)))
}
