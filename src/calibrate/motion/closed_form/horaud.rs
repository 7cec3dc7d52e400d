//! Quaternions, rotation first.
//!
//! # Source
//! R. Horaud, F. Dornaika, "Hand-eye calibration", Int. J. Robotics Research 14(3), 1995, section 4: a q = q b; the unit
//! quaternion q is the eigenvector to the least eigenvalue of a symmetric 4 × 4 matrix.

use nalgebra::{Matrix4, Quaternion, UnitQuaternion};

use crate::geometry::{Mat3, Vec3};

use super::Pair;

pub(super) fn rotation(pairs: &[Pair]) -> Option<UnitQuaternion<f64>> {
    // The sum of |a q − q b|² is a constant less twice qᵀ M q, with M made of Σ a bᵀ.
    let sum: Mat3 = pairs
        .iter()
        .map(|pair| {
            let (of_flange, of_sensor) = vector_parts(pair);
            of_flange * of_sensor.transpose()
        })
        .sum();
    let antisymmetric = Vec3::new(sum[(2, 1)] - sum[(1, 2)], sum[(0, 2)] - sum[(2, 0)], sum[(1, 0)] - sum[(0, 1)]);
    let mut matrix = Matrix4::zeros();
    matrix[(0, 0)] = sum.trace();
    matrix.fixed_view_mut::<3, 1>(1, 0).copy_from(&antisymmetric);
    matrix.fixed_view_mut::<1, 3>(0, 1).copy_from(&antisymmetric.transpose());
    let symmetric = sum + sum.transpose() - Mat3::identity() * sum.trace();
    matrix.fixed_view_mut::<3, 3>(1, 1).copy_from(&symmetric);
    let eigen = matrix.symmetric_eigen();
    let q = eigen.eigenvectors.column(eigen.eigenvalues.imax()).into_owned();
    q.iter()
        .all(|value| value.is_finite())
        .then(|| UnitQuaternion::new_normalize(Quaternion::new(q[0], q[1], q[2], q[3])))
}

/// The vector parts of both quaternions, with signs that belong together: the scalar parts of a and b are equal but for
/// noise, and a quaternion means the same rotation with either sign.
pub(super) fn vector_parts(pair: &Pair) -> (Vec3, Vec3) {
    let part = |rotation: &UnitQuaternion<f64>| {
        let sign = if rotation.w < 0.0 { -1.0 } else { 1.0 };
        Vec3::new(rotation.i, rotation.j, rotation.k) * sign
    };
    (part(&pair.flange.rotation), part(&pair.sensor.rotation))
}
