//! The translation for a known rotation, by linear least squares.

use nalgebra::UnitQuaternion;

use crate::geometry::{Mat3, Vec3};

use super::PosePair;

/// Over all pairs of poses, (`R_A` − 1) t = `R_X` `t_B` − `t_A`, as all papers of A X = X B have it. Their sum of squares is the
/// number of poses times that of `R_A` (`R_X` b + t) + a = z over the poses themselves, z the mean over them: no pair is ever
/// formed.
pub fn translation(poses: &[PosePair], rotation: &UnitQuaternion<f64>) -> Option<Vec3> {
    let mut squares = Mat3::zeros();
    let (mut sum, mut place, mut products) = (Mat3::zeros(), Vec3::zeros(), Vec3::zeros());
    let mut count = 0.0;
    for pose in poses {
        let turn = pose.base_from_flange.rotation.to_rotation_matrix().into_inner();
        let target =
            turn * (rotation * pose.sensor_from_target.translation.vector) + pose.base_from_flange.translation.vector;
        sum += turn;
        place += target;
        products += turn.transpose() * target;
        squares += Mat3::identity();
        count += 1.0;
    }
    let matrix = squares - sum.transpose() * sum / count;
    Some(solved(&matrix)? * (sum.transpose() * place / count - products))
}

/// The inverse of a sum of squares that is not singular.
fn solved(matrix: &Mat3) -> Option<Mat3> {
    /// Rotations of less than a thousandth of a degree leave a direction free.
    const LEAST: f64 = 1e-10;
    let inverse = matrix.try_inverse()?;
    (inverse.norm() * matrix.norm() < 1.0 / LEAST).then_some(inverse)
}
