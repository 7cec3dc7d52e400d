//! Rotations: exponential, logarithm and their Jacobians, exact near 0 and near π.
//!
//! # Source
//! J. Solà, J. Deray, D. Atchuthan, "A micro Lie theory for state estimation in robotics", 2018, appendix B.

use nalgebra::{Quaternion, UnitQuaternion};

use super::{Mat3, Vec3};

/// Below this angle (rad) the series replace the closed forms; their truncation error is then below 1e-18.
const SMALL_ANGLE: f64 = 1e-4;

/// The skew matrix of `v`: `hat(v) * w == v × w`.
#[must_use]
pub fn hat(v: Vec3) -> Mat3 {
    Mat3::new(0.0, -v.z, v.y, v.z, 0.0, -v.x, -v.y, v.x, 0.0)
}

/// The rotation by the vector's length (rad) about its direction.
#[must_use]
pub fn exp(rotation_vector: Vec3) -> UnitQuaternion<f64> {
    let angle = rotation_vector.norm();
    let half_sinc = if angle < SMALL_ANGLE { 0.5 - angle * angle / 48.0 } else { (0.5 * angle).sin() / angle };
    let v = rotation_vector * half_sinc;
    UnitQuaternion::new_normalize(Quaternion::new((0.5 * angle).cos(), v.x, v.y, v.z))
}

/// The rotation vector (rad), of length at most π.
///
/// `atan2` of the quaternion's parts keeps full precision at every angle, half turns included, where a formula by
/// the arc cosine of the trace loses half of the digits.
#[must_use]
pub fn log(rotation: &UnitQuaternion<f64>) -> Vec3 {
    let q = rotation.quaternion();
    let sign = if q.w < 0.0 { -1.0 } else { 1.0 };
    let v = Vec3::new(q.i, q.j, q.k) * sign;
    let w = q.w * sign;
    let sin_half = v.norm();
    let scale = if sin_half < 0.5 * SMALL_ANGLE {
        // 2 atan(s / w) / s for small s.
        2.0 / w - 2.0 * sin_half * sin_half / (3.0 * w * w * w)
    } else {
        2.0 * sin_half.atan2(w) / sin_half
    };
    v * scale
}

/// The right Jacobian: `exp(v + d) ≈ exp(v) * exp(right_jacobian(v) * d)`.
#[must_use]
pub fn right_jacobian(rotation_vector: Vec3) -> Mat3 {
    left_jacobian(-rotation_vector)
}

/// The left Jacobian: `exp(v + d) ≈ exp(left_jacobian(v) * d) * exp(v)`.
#[must_use]
pub fn left_jacobian(rotation_vector: Vec3) -> Mat3 {
    let angle = rotation_vector.norm();
    let squared = angle * angle;
    let (a, b) = if angle < SMALL_ANGLE {
        (0.5 - squared / 24.0, 1.0 / 6.0 - squared / 120.0)
    } else {
        let half_sin = (0.5 * angle).sin();
        // 1 − cos θ as 2 sin²(θ/2): no cancellation.
        (2.0 * half_sin * half_sin / squared, (angle - angle.sin()) / (squared * angle))
    };
    let skew = hat(rotation_vector);
    Mat3::identity() + skew * a + skew * skew * b
}

/// The inverse of [`right_jacobian`], for angles below 2π.
#[must_use]
pub fn right_jacobian_inverse(rotation_vector: Vec3) -> Mat3 {
    left_jacobian_inverse(-rotation_vector)
}

/// The inverse of [`left_jacobian`], for angles below 2π.
#[must_use]
pub fn left_jacobian_inverse(rotation_vector: Vec3) -> Mat3 {
    let angle = rotation_vector.norm();
    let squared = angle * angle;
    let b = if angle < 1e-2 {
        1.0 / 12.0 + squared / 720.0 + squared * squared / 30240.0
    } else {
        (1.0 - 0.5 * angle / (0.5 * angle).tan()) / squared
    };
    let skew = hat(rotation_vector);
    Mat3::identity() - skew * 0.5 + skew * skew * b
}

/// The rotation nearest to `matrix` in the Frobenius norm, exact for half turns about any axis.
///
/// nalgebra's own conversion is iterative and stays at the identity for a rotation by exactly π, which is how a tool
/// that points straight down is mounted; hence the singular value decomposition and Shepperd's quaternion.
/// Returns `None` if the matrix is not finite or singular.
#[must_use]
pub fn nearest_rotation(matrix: &Mat3) -> Option<UnitQuaternion<f64>> {
    if !matrix.iter().all(|v| v.is_finite()) {
        return None;
    }
    let svd = matrix.svd(true, true);
    let (u, v_t) = (svd.u?, svd.v_t?);
    if svd.singular_values[1] <= f64::EPSILON * svd.singular_values[0] {
        return None;
    }
    let handedness = if (u * v_t).determinant() < 0.0 { -1.0 } else { 1.0 };
    // The smallest singular value comes last, so the flip costs least there.
    let rotation = u * Mat3::from_diagonal(&Vec3::new(1.0, 1.0, handedness)) * v_t;
    Some(quaternion_of(&rotation))
}

/// The quaternion of an orthonormal matrix, by the largest of its four components (Shepperd 1978).
fn quaternion_of(m: &Mat3) -> UnitQuaternion<f64> {
    let trace = m.trace();
    let candidates = [trace, m[(0, 0)], m[(1, 1)], m[(2, 2)]];
    let mut largest = 0;
    for (idx, value) in candidates.iter().enumerate() {
        if *value > candidates[largest] {
            largest = idx;
        }
    }
    let quaternion = match largest {
        0 => Quaternion::new(1.0 + trace, m[(2, 1)] - m[(1, 2)], m[(0, 2)] - m[(2, 0)], m[(1, 0)] - m[(0, 1)]),
        1 => Quaternion::new(
            m[(2, 1)] - m[(1, 2)],
            1.0 + 2.0 * m[(0, 0)] - trace,
            m[(0, 1)] + m[(1, 0)],
            m[(0, 2)] + m[(2, 0)],
        ),
        2 => Quaternion::new(
            m[(0, 2)] - m[(2, 0)],
            m[(0, 1)] + m[(1, 0)],
            1.0 + 2.0 * m[(1, 1)] - trace,
            m[(1, 2)] + m[(2, 1)],
        ),
        _ => Quaternion::new(
            m[(1, 0)] - m[(0, 1)],
            m[(0, 2)] + m[(2, 0)],
            m[(1, 2)] + m[(2, 1)],
            1.0 + 2.0 * m[(2, 2)] - trace,
        ),
    };
    UnitQuaternion::new_normalize(quaternion)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    fn sample_vectors() -> Vec<Vec3> {
        let axes = [
            Vec3::x(),
            Vec3::y(),
            Vec3::z(),
            Vec3::new(1.0, 1.0, 0.0).normalize(),
            Vec3::new(-0.3, 0.5, 0.8).normalize(),
        ];
        let angles = [0.0, 1e-12, 1e-8, 9e-5, 1.1e-4, 9e-3, 0.011, 0.7, 2.0, PI - 1e-3, PI - 1e-9];
        axes.iter().flat_map(|axis| angles.iter().map(move |angle| axis * *angle)).collect()
    }

    #[test]
    fn log_undoes_exp_near_zero_and_near_a_half_turn() {
        for v in sample_vectors() {
            // 1e-15 of the angle is what f64 can hold near π.
            assert!((log(&exp(v)) - v).norm() < 4e-15 * (1.0 + v.norm()), "{v}");
        }
    }

    #[test]
    fn half_turns_survive_the_way_through_a_matrix() {
        for axis in sample_vectors().iter().filter(|v| v.norm() > 1.9).map(Vec3::normalize) {
            let half_turn = exp(axis * PI);
            let back = nearest_rotation(&half_turn.to_rotation_matrix().into_inner()).expect("a rotation");
            assert!(half_turn.angle_to(&back) < 1e-15, "half turn about {axis}: {back}");
        }
    }

    #[test]
    fn half_turn_matrices_written_by_hand_are_exact() {
        for diagonal in [[1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]] {
            let matrix = Mat3::from_diagonal(&Vec3::from(diagonal));
            let rotation = nearest_rotation(&matrix).expect("a rotation");
            assert_eq!(rotation.to_rotation_matrix().into_inner(), matrix);
        }
    }

    #[test]
    fn a_scaled_or_mirrored_matrix_gives_a_proper_rotation() {
        let mirrored = Mat3::from_diagonal(&Vec3::new(2.0, 2.0, -2.0));
        let rotation = nearest_rotation(&mirrored).expect("a rotation").to_rotation_matrix();
        assert!((rotation.matrix().determinant() - 1.0).abs() < 1e-12);
        assert_eq!(nearest_rotation(&Mat3::zeros()), None);
        assert_eq!(nearest_rotation(&Mat3::from_element(f64::NAN)), None);
    }

    #[test]
    fn jacobians_agree_with_differences() {
        let step = 1e-6;
        for v in sample_vectors() {
            for axis in [Vec3::x(), Vec3::y(), Vec3::z()] {
                let numeric_left = log(&(exp(v + axis * step) * exp(v - axis * step).inverse())) / (2.0 * step);
                let numeric_right = log(&(exp(v - axis * step).inverse() * exp(v + axis * step))) / (2.0 * step);
                // Central differences: truncation step², rounding 1e-16/step.
                assert!((left_jacobian(v) * axis - numeric_left).norm() < 1e-9, "left at {v}");
                assert!((right_jacobian(v) * axis - numeric_right).norm() < 1e-9, "right at {v}");
            }
            let identity = right_jacobian(v) * right_jacobian_inverse(v);
            assert!((identity - Mat3::identity()).norm() < 1e-11, "inverse at {v}");
        }
    }
}
