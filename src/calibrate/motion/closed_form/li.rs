//! Robot-world and hand-eye by one linear system for all 24 entries.
//!
//! # Source
//! A. Li, L. Wang, D. Wu, "Simultaneous robot-world and hand-eye calibration using dual-quaternions and Kronecker product",
//! Int. J. Physical Sciences 5(10), 2010: A X = Z C with C = B⁻¹, both rotations and both translations at once. Nothing keeps
//! the rotations apart from the translations' noise, and both are made rotations afterwards.

use nalgebra::{SMatrix, SVector};

use crate::geometry::{Mat3, Rigid, Vec3};

use super::PosePair;
use super::andreff::rotation_of;

/// vec `R_X`, vec `R_Z`, `t_X`, `t_Z`.
const NUM_UNKNOWNS: usize = 24;

pub(super) fn motion(poses: &[PosePair]) -> Option<Rigid> {
    let scale_mm = typical_length_mm(poses);
    let mut matrix = SMatrix::<f64, NUM_UNKNOWNS, NUM_UNKNOWNS>::zeros();
    let mut right = SVector::<f64, NUM_UNKNOWNS>::zeros();
    for pose in poses {
        let base_from_flange = pose.base_from_flange;
        let target_from_sensor = pose.sensor_from_target.inverse();
        let a = base_from_flange.rotation.to_rotation_matrix();
        let c = target_from_sensor.rotation.to_rotation_matrix();
        let place = target_from_sensor.translation.vector / scale_mm;
        // R_A R_X − R_Z R_C = 0, column by column, then R_A t_X − R_Z t_C − t_Z = −t_A.
        let mut rows = SMatrix::<f64, 12, NUM_UNKNOWNS>::zeros();
        for column in 0..3 {
            rows.fixed_view_mut::<3, 3>(3 * column, 3 * column).copy_from(a.matrix());
            for other in 0..3 {
                let block = Mat3::identity() * -c.matrix()[(other, column)];
                rows.fixed_view_mut::<3, 3>(3 * column, 9 + 3 * other).copy_from(&block);
            }
            rows.fixed_view_mut::<3, 3>(9, 9 + 3 * column).copy_from(&(Mat3::identity() * -place[column]));
        }
        rows.fixed_view_mut::<3, 3>(9, 18).copy_from(a.matrix());
        rows.fixed_view_mut::<3, 3>(9, 21).copy_from(&-Mat3::identity());
        matrix += rows.transpose() * rows;
        let of_place = rows.fixed_view::<3, NUM_UNKNOWNS>(9, 0).transpose();
        right -= of_place * (base_from_flange.translation.vector / scale_mm);
    }
    let found = matrix.cholesky()?.solve(&right);
    let rotation = rotation_of(&found.as_slice()[..9])?;
    Some(Rigid::from_parts((Vec3::new(found[18], found[19], found[20]) * scale_mm).into(), rotation))
}

fn typical_length_mm(poses: &[PosePair]) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for pose in poses {
        sum += pose.base_from_flange.translation.vector.norm() + pose.sensor_from_target.translation.vector.norm();
        count += 2.0;
    }
    if sum > 0.0 { sum / count } else { 1.0 }
}
