//! Dual quaternions: rotation and translation at once.
//!
//! # Source
//! K. Daniilidis, "Hand-eye calibration using dual quaternions", Int. J. Robotics Research 18(3), 1999, eq. 31–35. Two things
//! that implementations get wrong: both quaternions of a pair must have the same sign (their scalar parts are equal but for
//! noise), and of the quadratic in the ratio of the two singular vectors either root, or an infinite ratio, may be right.

use nalgebra::{Matrix2, Quaternion, SMatrix, SVector, UnitQuaternion, Vector2};

use crate::geometry::so3::hat;
use crate::geometry::{Rigid, Vec3};

use super::Pair;

/// The third least singular value must be this many times the second least, or the two vectors are not those sought.
const CLEAR: f64 = 1.5;

pub(super) fn motion(pairs: &[Pair]) -> Option<Rigid> {
    let scale_mm = typical_length_mm(pairs);
    let mut squares = SMatrix::<f64, 8, 8>::zeros();
    for pair in pairs {
        let (a, a_dual) = vectors(&pair.flange, scale_mm);
        let (b, b_dual) = vectors(&pair.sensor, scale_mm);
        let mut rows = SMatrix::<f64, 6, 8>::zeros();
        rows.fixed_view_mut::<3, 1>(0, 0).copy_from(&(a - b));
        rows.fixed_view_mut::<3, 3>(0, 1).copy_from(&hat(a + b));
        rows.fixed_view_mut::<3, 1>(3, 0).copy_from(&(a_dual - b_dual));
        rows.fixed_view_mut::<3, 3>(3, 1).copy_from(&hat(a_dual + b_dual));
        rows.fixed_view_mut::<3, 1>(3, 4).copy_from(&(a - b));
        rows.fixed_view_mut::<3, 3>(3, 5).copy_from(&hat(a + b));
        squares += rows.transpose() * rows;
    }
    let eigen = squares.symmetric_eigen();
    let mut order: [usize; 8] = std::array::from_fn(|idx| idx);
    order.sort_by(|a, b| eigen.eigenvalues[*a].total_cmp(&eigen.eigenvalues[*b]));
    let singular = order.map(|idx| eigen.eigenvalues[idx].max(0.0).sqrt());
    if singular[2] < CLEAR * singular[1] {
        return None;
    }
    let [first, second] = [order[0], order[1]].map(|idx| eigen.eigenvectors.column(idx).into_owned());
    let (real, dual) = combined(&first, &second)?;
    let quaternion = UnitQuaternion::new_normalize(real);
    // q' = ½ t q, with t as a quaternion without scalar part.
    let shift = (dual * quaternion.quaternion().conjugate()).imag() * (2.0 * scale_mm);
    Some(Rigid::from_parts(shift.into(), quaternion))
}

/// The combination that is a unit dual quaternion: |q| = 1 and q · q' = 0.
fn combined(first: &SVector<f64, 8>, second: &SVector<f64, 8>) -> Option<(Quaternion<f64>, Quaternion<f64>)> {
    let parts = |v: &SVector<f64, 8>| (v.fixed_rows::<4>(0).into_owned(), v.fixed_rows::<4>(4).into_owned());
    let ((u1, v1), (u2, v2)) = (parts(first), parts(second));
    let mixed = 0.5 * (u1.dot(&v2) + u2.dot(&v1));
    // λᵀ Q λ = 0 for both roots at once, with neither of them divided by.
    let eigen = Matrix2::new(u1.dot(&v1), mixed, mixed, u2.dot(&v2)).symmetric_eigen();
    let (plus, minus) = (eigen.eigenvalues.max().max(0.0).sqrt(), (-eigen.eigenvalues.min()).max(0.0).sqrt());
    let along = eigen.eigenvectors.column(eigen.eigenvalues.imax()).into_owned();
    let across = Vector2::new(-along.y, along.x);
    // Noise may leave the form definite; then the nearest to a root is taken.
    let roots = [1.0, -1.0].map(|sign| along * minus + across * (sign * plus));
    let length = |root: &Vector2<f64>| (u1 * root.x + u2 * root.y).norm();
    let root = if length(&roots[0]) >= length(&roots[1]) { roots[0] } else { roots[1] };
    let size = length(&root);
    let quaternion = |v: nalgebra::Vector4<f64>| Quaternion::new(v[0], v[1], v[2], v[3]);
    // A root without a real part is a translation without a rotation: singular vectors of no motion.
    (size > 1e-9)
        .then(|| (quaternion((u1 * root.x + u2 * root.y) / size), quaternion((v1 * root.x + v2 * root.y) / size)))
}

/// The vector parts of q and q' of a motion, with a scalar part of q that is not negative.
fn vectors(motion: &Rigid, scale_mm: f64) -> (Vec3, Vec3) {
    let sign = if motion.rotation.w < 0.0 { -1.0 } else { 1.0 };
    let q = motion.rotation.quaternion() * sign;
    let half_shift = Quaternion::from_imag(motion.translation.vector * (0.5 / scale_mm));
    (q.imag(), (half_shift * q).imag())
}

/// What translations are divided by, so that they weigh about as much as rotations, mm.
fn typical_length_mm(pairs: &[Pair]) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for pair in pairs {
        sum += pair.flange.translation.vector.norm();
        count += 1.0;
    }
    if sum > 0.0 { sum / count } else { 1.0 }
}
