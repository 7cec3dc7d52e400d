//! From the covariance of the unknowns to the figures that people read.

use nalgebra::{Matrix6, SMatrix};

use crate::geometry::so3::hat;
use crate::geometry::{Mat3, Rigid, Vec3};

use super::solution::Uncertainty;

/// The figures for a covariance of (rotation, translation), both as a right perturbation (along the sensor's axes).
///
/// `reference_point_in_sensor_mm` is the point whose standard deviation is the headline.
#[must_use]
pub fn uncertainty(
    right_covariance: &Matrix6<f64>,
    flange_from_sensor: &Rigid,
    reference_point_in_sensor_mm: Vec3,
) -> Uncertainty {
    let rotation = flange_from_sensor.rotation.to_rotation_matrix();
    let mut to_flange_axes = Matrix6::identity();
    to_flange_axes.fixed_view_mut::<3, 3>(3, 3).copy_from(rotation.matrix());
    let covariance = to_flange_axes * right_covariance * to_flange_axes.transpose();
    let in_sensor = point_covariance(right_covariance, reference_point_in_sensor_mm);
    let std = |idx: usize| covariance[(idx, idx)].max(0.0).sqrt();
    Uncertainty {
        covariance,
        translation_std_mm: Vec3::new(std(3), std(4), std(5)),
        rotation_std_rad: Vec3::new(std(0), std(1), std(2)),
        workspace_point_std_mm: in_sensor.trace().max(0.0).sqrt(),
        reference_point_in_sensor_mm,
        workspace_point_covariance: rotation.matrix() * in_sensor * rotation.matrix().transpose(),
        degrees_of_freedom: f64::INFINITY,
        workspace_point_95_mm: 2.8 * in_sensor.trace().max(0.0).sqrt(),
    }
}

/// Covariance of a point given in the sensor frame, along the sensor's axes.
pub(crate) fn point_covariance(right_covariance: &Matrix6<f64>, point_in_sensor: Vec3) -> Mat3 {
    let jacobian = point_jacobian(point_in_sensor);
    jacobian * right_covariance * jacobian.transpose()
}

/// How a point given in the sensor frame follows (rotation, translation): dp = v − p × ω.
pub(crate) fn point_jacobian(point_in_sensor: Vec3) -> SMatrix<f64, 3, 6> {
    let mut jacobian = SMatrix::<f64, 3, 6>::zeros();
    jacobian.fixed_view_mut::<3, 3>(0, 0).copy_from(&-hat(point_in_sensor));
    jacobian.fixed_view_mut::<3, 3>(0, 3).copy_from(&Mat3::identity());
    jacobian
}
