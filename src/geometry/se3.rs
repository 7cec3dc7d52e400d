//! Rigid motions: exponential, logarithm and Jacobian. Tangent: (rotation in rad, translation in mm).
//!
//! # Source
//! T. D. Barfoot, "State estimation for robotics", 2017, section 7.1 (with our order of the tangent).

use nalgebra::{Matrix6, Translation3, Vector6};

use super::so3::{self, hat};
use super::{Mat3, Rigid, Vec3};

/// The motion along the constant twist `tangent`.
#[must_use]
pub fn exp(tangent: &Vector6<f64>) -> Rigid {
    let (rotation_vector, translation) = split(tangent);
    Rigid::from_parts(Translation3::from(so3::left_jacobian(rotation_vector) * translation), so3::exp(rotation_vector))
}

/// The twist whose exponential is `motion`, with a rotation of at most π.
#[must_use]
pub fn log(motion: &Rigid) -> Vector6<f64> {
    let rotation_vector = so3::log(&motion.rotation);
    let translation = so3::left_jacobian_inverse(rotation_vector) * motion.translation.vector;
    join(rotation_vector, translation)
}

/// The right Jacobian: `exp(t + d) ≈ exp(t) * exp(right_jacobian(t) * d)`.
#[must_use]
pub fn right_jacobian(tangent: &Vector6<f64>) -> Matrix6<f64> {
    let (rotation_vector, translation) = split(&-tangent);
    let rotation_block = so3::left_jacobian(rotation_vector);
    let mut jacobian = Matrix6::zeros();
    jacobian.fixed_view_mut::<3, 3>(0, 0).copy_from(&rotation_block);
    jacobian.fixed_view_mut::<3, 3>(3, 3).copy_from(&rotation_block);
    jacobian.fixed_view_mut::<3, 3>(3, 0).copy_from(&coupling(rotation_vector, translation));
    jacobian
}

/// How a perturbation of `Src` looks in `Dst`: `dst_from_src * exp(t) == exp(adjoint * t) * dst_from_src`.
#[must_use]
pub fn adjoint(dst_from_src: &Rigid) -> Matrix6<f64> {
    let rotation = dst_from_src.rotation.to_rotation_matrix().into_inner();
    let mut adjoint = Matrix6::zeros();
    adjoint.fixed_view_mut::<3, 3>(0, 0).copy_from(&rotation);
    adjoint.fixed_view_mut::<3, 3>(3, 3).copy_from(&rotation);
    adjoint.fixed_view_mut::<3, 3>(3, 0).copy_from(&(hat(dst_from_src.translation.vector) * rotation));
    adjoint
}

/// Barfoot's Q: how a rotation changes the translation, eq. 7.86b.
fn coupling(rotation_vector: Vec3, translation: Vec3) -> Mat3 {
    let angle = rotation_vector.norm();
    let (p, v) = (hat(rotation_vector), hat(translation));
    let (a, b, c) = if angle < 1e-2 {
        let squared = angle * angle;
        (1.0 / 6.0 - squared / 120.0, 1.0 / 24.0 - squared / 720.0, 1.0 / 120.0 - squared / 2520.0)
    } else {
        let (sin, cos) = angle.sin_cos();
        let squared = angle * angle;
        (
            (angle - sin) / (squared * angle),
            (squared + 2.0 * cos - 2.0) / (2.0 * squared * squared),
            (2.0 * angle - 3.0 * sin + angle * cos) / (2.0 * squared * squared * angle),
        )
    };
    v * 0.5
        + (p * v + v * p + p * v * p) * a
        + (p * p * v + v * p * p - p * v * p * 3.0) * b
        + (p * v * p * p + p * p * v * p) * c
}

/// A tangent from its rotation (rad) and translation (mm).
#[must_use]
pub fn join(rotation_vector: Vec3, translation: Vec3) -> Vector6<f64> {
    Vector6::new(rotation_vector.x, rotation_vector.y, rotation_vector.z, translation.x, translation.y, translation.z)
}

/// The rotation (rad) and the translation (mm) of a tangent.
#[must_use]
pub fn split(tangent: &Vector6<f64>) -> (Vec3, Vec3) {
    (Vec3::new(tangent[0], tangent[1], tangent[2]), Vec3::new(tangent[3], tangent[4], tangent[5]))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    fn sample_tangents() -> Vec<Vector6<f64>> {
        let directions = [Vec3::x(), Vec3::new(0.2, -0.9, 0.4).normalize()];
        let angles = [0.0, 1e-8, 5e-3, 0.02, 1.3, PI - 1e-6];
        let translation = Vec3::new(12.0, -7.0, 3.0);
        directions.iter().flat_map(|axis| angles.iter().map(move |angle| join(axis * *angle, translation))).collect()
    }

    #[test]
    fn log_undoes_exp() {
        for tangent in sample_tangents() {
            // Translations of 14 mm hold 1e-14; near π the Jacobian's inverse amplifies a little.
            assert!((log(&exp(&tangent)) - tangent).norm() < 1e-12, "{tangent}");
        }
    }

    #[test]
    fn a_perturbation_may_be_made_on_either_side() {
        let (first, small) = (exp(&sample_tangents()[9]), sample_tangents()[2] * 0.1);
        let (right, left) = (first * exp(&small), exp(&(adjoint(&first) * small)) * first);
        assert!((log(&(left.inverse() * right))).norm() < 1e-12);
    }

    #[test]
    fn right_jacobian_agrees_with_differences() {
        let step = 1e-5;
        for tangent in sample_tangents() {
            let jacobian = right_jacobian(&tangent);
            for column in 0..6 {
                let mut delta = Vector6::zeros();
                delta[column] = step;
                let change = exp(&(tangent - delta)).inverse() * exp(&(tangent + delta));
                let numeric = log(&change) / (2.0 * step);
                // Truncation step² × 14 mm, rounding 1e-15 / step.
                assert!((jacobian.column(column) - numeric).norm() < 1e-7, "column {column} at {tangent}");
            }
        }
    }
}
