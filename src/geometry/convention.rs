//! How robot makers write an orientation as three numbers. Degrees appear here and nowhere below.
//!
//! Every convention of three angles is a product of rotations about moving axes, written in the order of the product;
//! fixed-axis XYZ (a, b, c) is moving-axis ZYX (c, b, a), so it needs no form of its own.

use nalgebra::UnitQuaternion;

use super::{Mat3, Vec3, so3};

/// A coordinate axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Axis {
    X = 0,
    Y = 1,
    Z = 2,
}

/// How the three numbers make a rotation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Form {
    /// `R = R_first(a) R_second(b) R_third(c)`; the maker lists (a, b, c), or (c, b, a) where `reversed`.
    Euler { axes: [Axis; 3], reversed: bool },
    /// Axis times angle.
    RotationVector,
}

/// A maker's way to write an orientation.
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
    form: Form,
}

use Axis::{X, Y, Z};

const fn euler(
    id: &'static str,
    label: &'static str,
    angle_names: [&'static str; 3],
    formula: &'static str,
    axes: [Axis; 3],
    reversed: bool,
) -> PoseConvention {
    PoseConvention { id, label, angle_names, formula, form: Form::Euler { axes, reversed } }
}

impl PoseConvention {
    /// All conventions known, the default first.
    pub const ALL: &'static [Self] = &[
        euler("fanuc-wpr", "FANUC W P R", ["W", "P", "R"], "Rz(R) Ry(P) Rx(W)", [Z, Y, X], true),
        euler("abb-ezeyex", "ABB EZ EY EX", ["EZ", "EY", "EX"], "Rz(EZ) Ry(EY) Rx(EX)", [Z, Y, X], false),
        euler("kuka-abc", "KUKA A B C", ["A", "B", "C"], "Rz(A) Ry(B) Rx(C)", [Z, Y, X], false),
        PoseConvention {
            id: "ur-rotvec",
            label: "UR RX RY RZ",
            angle_names: ["RX", "RY", "RZ"],
            formula: "rotation vector",
            form: Form::RotationVector,
        },
        euler("yaskawa-rxryrz", "Yaskawa Rx Ry Rz", ["Rx", "Ry", "Rz"], "Rz(Rz) Ry(Ry) Rx(Rx)", [Z, Y, X], true),
        euler("staubli-rxryrz", "Stäubli Rx Ry Rz", ["Rx", "Ry", "Rz"], "Rx(Rx) Ry(Ry) Rz(Rz)", [X, Y, Z], false),
        euler("kawasaki-oat", "Kawasaki O A T", ["O", "A", "T"], "Rz(O) Ry(A) Rz(T)", [Z, Y, Z], false),
        euler("mitsubishi-abc", "Mitsubishi A B C", ["A", "B", "C"], "Rz(C) Ry(B) Rx(A)", [Z, Y, X], true),
        euler("comau-aer", "Comau A E R", ["A", "E", "R"], "Rz(A) Ry(E) Rz(R)", [Z, Y, Z], false),
        euler("denso-rxryrz", "Denso RX RY RZ", ["RX", "RY", "RZ"], "Rz(RZ) Ry(RY) Rx(RX)", [Z, Y, X], true),
        euler("nachi-rpy", "Nachi r p y", ["r", "p", "y"], "Rz(r) Ry(p) Rx(y)", [Z, Y, X], false),
        euler("epson-uvw", "Epson U V W", ["U", "V", "W"], "Rz(U) Ry(V) Rx(W)", [Z, Y, X], false),
    ];

    /// The convention that a session file names.
    #[must_use]
    pub fn by_id(id: &str) -> Option<&'static Self> {
        Self::ALL.iter().find(|convention| convention.id == id)
    }

    /// The convention used where none is named: FANUC W P R, the papers' robot.
    #[must_use]
    pub fn default_convention() -> &'static Self {
        &Self::ALL[0]
    }

    /// The rotation that the three numbers (degrees, in the maker's order) stand for.
    #[must_use]
    pub fn rotation_from_angles_deg(&self, angles_deg: [f64; 3]) -> UnitQuaternion<f64> {
        let angles = angles_deg.map(f64::to_radians);
        match self.form {
            Form::RotationVector => so3::exp(Vec3::from(angles)),
            Form::Euler { axes, reversed } => {
                let [a, b, c] = in_product_order(angles, reversed);
                about(axes[0], a) * about(axes[1], b) * about(axes[2], c)
            }
        }
    }

    /// The three numbers (degrees, in the maker's order) of a rotation. In gimbal lock the first factor gets 0.
    #[must_use]
    pub fn angles_deg_from_rotation(&self, rotation: &UnitQuaternion<f64>) -> [f64; 3] {
        let angles = match self.form {
            Form::RotationVector => so3::log(rotation).into(),
            Form::Euler { axes, reversed } => in_product_order(euler_angles(axes, rotation), reversed),
        };
        angles.map(|angle: f64| angle.to_degrees() + 0.0)
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

fn in_product_order(angles: [f64; 3], reversed: bool) -> [f64; 3] {
    let [a, b, c] = angles;
    if reversed { [c, b, a] } else { angles }
}

fn about(axis: Axis, angle: f64) -> UnitQuaternion<f64> {
    let mut rotation_vector = Vec3::zeros();
    rotation_vector[axis as usize] = angle;
    so3::exp(rotation_vector)
}

/// The angles of a product of three rotations about moving axes (rad).
///
/// The first angle comes from the matrix, the other two from what remains after undoing it. So an ill-defined first
/// angle near gimbal lock is made up for by the third, and the product is right to rounding everywhere.
fn euler_angles(axes: [Axis; 3], rotation: &UnitQuaternion<f64>) -> [f64; 3] {
    /// Below this the first and third axes coincide to rounding, and any split of their sum will do.
    const LOCKED: f64 = 1e-14;
    let [i, j, third] = axes.map(|axis| axis as usize);
    let k = 3 - i - j;
    let parity = if (i + 1) % 3 == j { 1.0 } else { -1.0 };
    let matrix = rotation.to_rotation_matrix();
    let m = matrix.matrix();
    let (sin_part, cos_part) =
        if third == k { (-parity * m[(j, k)], m[(k, k)]) } else { (m[(j, i)], -parity * m[(k, i)]) };
    let locked = sin_part.hypot(cos_part) < LOCKED;
    let first = if locked { 0.0 } else { sin_part.atan2(cos_part) };
    let rest = (about(axes[0], first).inverse() * rotation).to_rotation_matrix();
    let n = rest.matrix();
    let (second, last) = if third == k {
        ((parity * n[(i, k)]).atan2(n[(k, k)]), (parity * n[(j, i)]).atan2(n[(j, j)]))
    } else {
        ((-parity * n[(k, i)]).atan2(n[(i, i)]), (-parity * n[(j, k)]).atan2(n[(j, j)]))
    };
    [first, second, last]
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    #[track_caller]
    fn check_round_trip(rotation: &UnitQuaternion<f64>) {
        for convention in PoseConvention::ALL {
            let angles = convention.angles_deg_from_rotation(rotation);
            let back = convention.rotation_from_angles_deg(angles);
            // 1e-9° is what the project promises.
            assert!(
                rotation.angle_to(&back).to_degrees() < 1e-9,
                "{}: {rotation} became {angles:?} and came back as {back}",
                convention.id
            );
        }
    }

    #[test]
    fn every_convention_round_trips_gimbal_lock_and_half_turns_included() {
        for a in [-PI, -2.0, -1e-7, 0.0, 0.4, 1.0, PI - 1e-9, PI] {
            for b in [-PI / 2.0, -PI / 2.0 + 1e-8, -0.7, 0.0, 1e-9, 1e-15, PI / 2.0, PI / 2.0 - 1e-7, PI] {
                for c in [-3.0, 0.0, 0.9, PI] {
                    check_round_trip(&(about(Z, a) * about(Y, b) * about(X, c)));
                    check_round_trip(&(about(Z, a) * about(Y, b) * about(Z, c)));
                    check_round_trip(&(about(X, a) * about(Y, b) * about(Z, c)));
                }
            }
        }
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
    fn ids_are_unique() {
        for (idx, convention) in PoseConvention::ALL.iter().enumerate() {
            assert_eq!(PoseConvention::ALL.iter().position(|other| other.id == convention.id), Some(idx));
        }
    }
}
