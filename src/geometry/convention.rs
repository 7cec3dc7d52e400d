//! How robot makers write an orientation as three numbers; the table of them is in `makers.rs`.

use nalgebra::UnitQuaternion;

use super::notation::AngleUnit;
use super::{AngleOrder, Mat3, Vec3, so3};

/// A way to write an orientation as three numbers, a maker's or one without a maker's name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PoseConvention {
    /// The name in session files, e.g. `fanuc-wpr`.
    pub id: &'static str,
    /// The name people know it by.
    pub label: &'static str,
    /// The names of the three numbers on the teach pendant.
    pub angle_names: [&'static str; 3],
    /// The rotation spelt out.
    pub formula: &'static str,
    /// How the three numbers make a rotation, in the maker's order.
    pub order: AngleOrder,
    /// The unit in which the pendant shows them.
    pub usual_angle_unit: AngleUnit,
}

impl PoseConvention {
    /// Every convention there is: makers', disputed ones, then those without a maker's name.
    pub fn all() -> impl Iterator<Item = &'static Self> + Clone {
        Self::MAKERS.iter().chain(Self::DISPUTED).chain(Self::NEUTRAL)
    }

    /// The convention that a session file names.
    #[must_use]
    pub fn by_id(id: &str) -> Option<&'static Self> {
        Self::all().find(|convention| convention.id == id)
    }

    /// The convention used where none is named: FANUC W P R, the papers' robot.
    #[must_use]
    pub fn default_convention() -> &'static Self {
        &Self::MAKERS[0]
    }

    /// The makers that write an orientation in this order.
    pub fn of_order(order: AngleOrder) -> impl Iterator<Item = &'static Self> {
        Self::MAKERS.iter().filter(move |convention| convention.order == order)
    }

    /// The convention of this order that bears no maker's name.
    #[must_use]
    pub fn neutral(order: AngleOrder) -> &'static Self {
        Self::NEUTRAL.iter().find(|convention| convention.order == order).unwrap_or(Self::default_convention())
    }

    /// The rotation that the three numbers (degrees, in the maker's order) stand for.
    #[must_use]
    pub fn rotation_from_angles_deg(&self, angles_deg: [f64; 3]) -> UnitQuaternion<f64> {
        self.order.rotation_from_angles(angles_deg.map(f64::to_radians))
    }

    /// The three numbers (degrees, in the maker's order) of a rotation. In gimbal lock the first factor gets 0.
    #[must_use]
    pub fn angles_deg_from_rotation(&self, rotation: &UnitQuaternion<f64>) -> [f64; 3] {
        self.order.angles_from_rotation(rotation).map(|angle| angle.to_degrees() + 0.0)
    }

    /// Standard deviations (degrees) of the three numbers, from the covariance (rad²) of the rotation as a right
    /// perturbation. Near gimbal lock they grow without bound, as the numbers do say less and less there.
    #[must_use]
    pub fn angles_std_deg(&self, rotation: &UnitQuaternion<f64>, rotation_covariance: &Mat3) -> [f64; 3] {
        /// Central differences: truncation and rounding both stay below 1e-8.
        const STEP_RAD: f64 = 1e-5;
        let mut by_rotation = Mat3::zeros();
        for axis in 0..3 {
            let step = Vec3::ith(axis, STEP_RAD);
            let ahead = self.angles_deg_from_rotation(&(rotation * so3::exp(step)));
            let behind = self.angles_deg_from_rotation(&(rotation * so3::exp(-step)));
            for (angle, (ahead, behind)) in ahead.into_iter().zip(behind).enumerate() {
                // Across ±180° the numbers jump, the angle does not.
                let change = (ahead - behind + 540.0).rem_euclid(360.0) - 180.0;
                by_rotation[(angle, axis)] = change / (2.0 * STEP_RAD);
            }
        }
        let covariance = by_rotation * rotation_covariance * by_rotation.transpose();
        [0, 1, 2].map(|angle| covariance[(angle, angle)].max(0.0).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::super::angle_order::Axis::{X, Y, Z};
    use super::super::angle_order::about;
    use super::*;

    #[test]
    fn orders_have_the_names_that_engineers_use_and_makers_that_share_one_are_found() {
        let fanuc = PoseConvention::default_convention();
        assert_eq!(fanuc.order.to_string(), "extrinsic XYZ");
        assert_eq!(fanuc.order.backwards().to_string(), "intrinsic ZYX");
        let ids: Vec<&str> = PoseConvention::of_order(fanuc.order).map(|convention| convention.id).collect();
        assert_eq!(ids[..4], ["fanuc-wpr", "yaskawa-rxryrz", "mitsubishi-abc", "denso-rxryrz"]);
    }

    #[test]
    fn fanuc_and_kuka_list_the_same_angles_in_opposite_order() {
        let rotation = about(Z, 0.3) * about(Y, -0.2) * about(X, 1.1);
        let fanuc = PoseConvention::by_id("fanuc-wpr").expect("known").angles_deg_from_rotation(&rotation);
        let kuka = PoseConvention::by_id("kuka-abc").expect("known").angles_deg_from_rotation(&rotation);
        let expected = [1.1_f64, -0.2, 0.3].map(f64::to_degrees);
        for idx in 0..3 {
            assert!((fanuc[idx] - expected[idx]).abs() < 1e-12);
            assert!((kuka[idx] - expected[2 - idx]).abs() < 1e-12);
        }
    }

    #[test]
    fn standard_deviations_follow_the_angles_across_a_half_turn() {
        let kuka = PoseConvention::by_id("kuka-abc").expect("known");
        let rotation = kuka.rotation_from_angles_deg([180.0, 0.0, 0.0]);
        // About the third factor's own axis (x) with 1°, about z with 2°.
        let covariance = Mat3::from_diagonal(&Vec3::new(1.0, 0.0, 4.0)) * 1.0_f64.to_radians().powi(2);
        let [a, b, c] = kuka.angles_std_deg(&rotation, &covariance);
        assert!((a - 2.0).abs() < 1e-6 && b.abs() < 1e-6 && (c - 1.0).abs() < 1e-6, "{a} {b} {c}");
    }

    #[test]
    fn ids_and_labels_are_unique_and_every_order_has_a_neutral_name() {
        for (idx, convention) in PoseConvention::all().enumerate() {
            assert_eq!(PoseConvention::all().position(|other| other.id == convention.id), Some(idx));
            assert_eq!(PoseConvention::all().position(|other| other.label == convention.label), Some(idx));
        }
        let orders: Vec<AngleOrder> = PoseConvention::NEUTRAL.iter().map(|convention| convention.order).collect();
        assert_eq!(orders, AngleOrder::ALL);
    }
}
