//! Kronecker products: the nine entries of the rotation as linear unknowns.
//!
//! # Source
//! N. Andreff, R. Horaud, B. Espiau, "Robot hand-eye calibration using structure-from-motion", Int. J. Robotics Research
//! 20(3), 2001, eq. 15: (1 − `R_A` ⊗ `R_B`) vec `R_X` = 0, the general case with the rotation solved first.

use nalgebra::{SMatrix, UnitQuaternion};

use crate::geometry::Mat3;
use crate::geometry::so3::nearest_rotation;

use super::Pair;

pub(super) fn rotation(pairs: &[Pair]) -> Option<UnitQuaternion<f64>> {
    // With K = R_B ⊗ R_A a rotation, |vec − K vec|² is 2 |vec|² − 2 vecᵀ K vec: the greatest eigenvalue of Σ K + Kᵀ is sought.
    let mut sum = SMatrix::<f64, 9, 9>::zeros();
    for pair in pairs {
        let of_flange = pair.flange.rotation.to_rotation_matrix();
        let of_sensor = pair.sensor.rotation.to_rotation_matrix();
        add_kronecker(&mut sum, of_sensor.matrix(), of_flange.matrix());
    }
    let eigen = (sum + sum.transpose()).symmetric_eigen();
    rotation_of(eigen.eigenvectors.column(eigen.eigenvalues.imax()).as_slice())
}

/// Adds left ⊗ right: with entries by column, vec(`right` M `leftᵀ`) is this times vec(M).
pub(super) fn add_kronecker(sum: &mut SMatrix<f64, 9, 9>, left: &Mat3, right: &Mat3) {
    for row in 0..3 {
        for column in 0..3 {
            let mut block = sum.fixed_view_mut::<3, 3>(3 * row, 3 * column);
            block += right * left[(row, column)];
        }
    }
}

/// The rotation nearest to nine entries (by column) that are known up to a factor of either sign.
pub(super) fn rotation_of(entries: &[f64]) -> Option<UnitQuaternion<f64>> {
    let matrix = Mat3::from_column_slice(entries);
    let sign = if matrix.determinant() < 0.0 { -1.0 } else { 1.0 };
    nearest_rotation(&(matrix * sign))
}
