//! Robot-world and hand-eye by Kronecker products and one singular value decomposition.
//!
//! # Source
//! M. Shah, "Solving the robot-world/hand-eye calibration problem using the Kronecker product", ASME J. Mechanisms and
//! Robotics 5(3), 2013: with K = Σ `R_Bᵀ` ⊗ `R_A`, vec `R_X` and vec `R_Z` are the singular vectors to the largest singular
//! value of K. The sum is over poses, so all pairs are in it at no cost.

use nalgebra::{SMatrix, UnitQuaternion};

use super::PosePair;
use super::andreff::{add_kronecker, rotation_of};

pub(super) fn rotation(poses: &[PosePair]) -> Option<UnitQuaternion<f64>> {
    let mut sum = SMatrix::<f64, 9, 9>::zeros();
    for pose in poses {
        let of_flange = pose.base_from_flange.rotation.to_rotation_matrix();
        let of_target = pose.sensor_from_target.rotation.to_rotation_matrix();
        add_kronecker(&mut sum, &of_target.matrix().transpose(), of_flange.matrix());
    }
    let eigen = (sum.transpose() * sum).symmetric_eigen();
    rotation_of(eigen.eigenvectors.column(eigen.eigenvalues.imax()).as_slice())
}
