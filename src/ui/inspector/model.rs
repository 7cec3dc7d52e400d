//! Figures of the inspector, built without egui.

use nalgebra::{Matrix3, UnitQuaternion};

use crate::calibrate::Solution;
use crate::geometry::{PoseConvention, Vec3};
use crate::ui::widgets::fixed;

/// Step of the numeric derivative of the angles, rad: the angles are smooth, so the error is far below what is shown.
const ANGLE_STEP_RAD: f64 = 1e-6;

/// Standard deviations (°) of the angles in a convention, from the covariance of the rotation.
///
/// The covariance is of a right perturbation (about the sensor's axes), the angles are not linear in it, so they are
/// propagated through the derivative at the solution. `None` without uncertainty; infinite near gimbal lock.
#[must_use]
pub fn angle_std_deg(solution: &Solution, convention: &PoseConvention) -> Option<[f64; 3]> {
    let uncertainty = solution.uncertainty.as_ref()?;
    let rotation = solution.flange_from_sensor.rotation();
    let mut jacobian_deg = Matrix3::zeros();
    for axis in 0..3 {
        let mut step = Vec3::zeros();
        step[axis] = ANGLE_STEP_RAD;
        let angles = |sign: f64| {
            convention.angles_deg_from_rotation(&(rotation * UnitQuaternion::from_scaled_axis(step * sign)))
        };
        let (ahead, behind) = (angles(1.0), angles(-1.0));
        for row in 0..3 {
            jacobian_deg[(row, axis)] = wrapped_deg(ahead[row] - behind[row]) / (2.0 * ANGLE_STEP_RAD);
        }
    }
    let rotation_covariance = uncertainty.covariance.fixed_view::<3, 3>(0, 0);
    let covariance = jacobian_deg * rotation_covariance * jacobian_deg.transpose();
    Some([0, 1, 2].map(|idx| covariance[(idx, idx)].max(0.0).sqrt()))
}

/// A difference of angles without the jump at ±180°.
fn wrapped_deg(difference: f64) -> f64 {
    (difference + 180.0).rem_euclid(360.0) - 180.0
}

/// The homogeneous matrix as text, one row a line, tab-separated so that spreadsheets take it; all digits.
#[must_use]
pub fn matrix_text(solution: &Solution) -> String {
    let matrix = solution.flange_from_sensor.matrix();
    let rows = (0..4).map(|row| (0..4).map(|column| matrix[(row, column)].to_string()).collect::<Vec<_>>().join("\t"));
    rows.collect::<Vec<_>>().join("\n")
}

/// Position (mm) and angles (°) as text, in the convention's order, named.
#[must_use]
pub fn pose_text(solution: &Solution, convention: &PoseConvention) -> String {
    let position = solution.flange_from_sensor.translation_mm();
    let angles = convention.angles_deg_from_rotation(&solution.flange_from_sensor.rotation());
    let names = ["X", "Y", "Z"].into_iter().chain(convention.angle_names);
    let values = position.iter().copied().chain(angles);
    names.zip(values).map(|(name, value)| format!("{name} {value:.6}")).collect::<Vec<_>>().join("  ")
}

/// Position (mm) and quaternion (w x y z) as text.
#[must_use]
pub fn quaternion_text(solution: &Solution) -> String {
    let position = solution.flange_from_sensor.translation_mm();
    let quaternion = solution.flange_from_sensor.quaternion_wxyz();
    let names = ["x", "y", "z", "qw", "qx", "qy", "qz"];
    let values = position.iter().copied().chain(quaternion);
    names.into_iter().zip(values).map(|(name, value)| format!("{name} {value:.9}")).collect::<Vec<_>>().join("  ")
}

/// The matrix's cells as shown: rotation with four decimals, translation with three, the last row bare.
#[must_use]
pub fn matrix_cells(solution: &Solution) -> [[String; 4]; 4] {
    let matrix = solution.flange_from_sensor.matrix();
    std::array::from_fn(|row| {
        std::array::from_fn(|column| match (row, column) {
            (3, _) => fixed(matrix[(row, column)], 0),
            (_, 3) => fixed(matrix[(row, column)], 3),
            _ => fixed(matrix[(row, column)], 4),
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_difference_of_angles_does_not_jump() {
        assert!((wrapped_deg(359.9) + 0.1).abs() < 1e-9);
    }
}
