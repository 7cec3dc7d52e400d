//! Whether all targets are too near or too far by one factor: a board or marker whose printed size is another than stated.

use crate::calibrate::plate::descent::inverse_of;
use crate::geometry::{Vec3, so3::hat};

use super::pose::{Information, MotionState, NUM_UNKNOWNS, PosePair, sums_of};

/// The factor that the target's translations need, and its standard deviation: one more unknown, by one step from the
/// minimum; the problem is linear in it.
///
/// `None` if it cannot be told from the other unknowns.
pub(super) fn scale(poses: &[PosePair], state: &MotionState, spread: f64) -> Option<(f64, f64)> {
    let inverse = inverse_of(&sums_of(poses, state, |_| 1.0).hessian).ok()?;
    let (mut own, mut pull) = (0.0, 0.0);
    let mut mixed = nalgebra::SVector::<f64, NUM_UNKNOWNS>::zeros();
    for pose in poses {
        let errors = state.errors(pose);
        let along = pose.sensor_from_target.translation.vector;
        let Information { mixed: by_turn, translation, .. } = pose.information;
        let weighted = translation * along;
        own += along.dot(&weighted);
        pull -= along.dot(&(by_turn * errors.rotation)) + weighted.dot(&errors.translation);
        // JᵀΩ of a change of e alone.
        let on_rotation = by_turn.transpose() * along;
        let lever = hat(errors.translation - along);
        let base_from_sensor = errors.sensor_from_base.transpose();
        let parts: [Vec3; 4] = [
            on_rotation + lever.transpose() * weighted,
            weighted,
            -(base_from_sensor * on_rotation),
            -(base_from_sensor * weighted),
        ];
        for (place, part) in parts.iter().enumerate() {
            let mut rows = mixed.fixed_rows_mut::<3>(3 * place);
            rows += part;
        }
    }
    let left = own - mixed.dot(&(inverse * mixed));
    (left > 1e-9 * own).then(|| (1.0 + pull / left, spread * left.sqrt().recip()))
}
