//! How robot makers write an orientation as three numbers: the orders of the angles, and the makers' names for them.

use std::fmt;

use nalgebra::UnitQuaternion;

use super::{Mat3, Vec3, so3};

/// A coordinate axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// x.
    X = 0,
    /// y.
    Y = 1,
    /// z.
    Z = 2,
}

use Axis::{X, Y, Z};

/// How three numbers make a rotation.
///
/// Each order of axes has two readings, and they are different ones: about moving axes, R = `R_first(a)` `R_second(b)`
/// `R_third(c)`, and about fixed axes, R = `R_third(c)` `R_second(b)` `R_first(a)`. So "intrinsic ZYX" is "extrinsic XYZ"
/// with its numbers listed backwards.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AngleOrder {
    /// Rotations about these axes one after the other, the axes moving along.
    Intrinsic([Axis; 3]),
    /// Rotations about these axes one after the other, the axes standing still.
    Extrinsic([Axis; 3]),
    /// Axis times angle.
    RotationVector,
}

impl AngleOrder {
    /// All readings of three numbers that there are.
    pub const ALL: [Self; 25] = {
        let axes = [
            [Z, Y, X],
            [X, Y, Z],
            [X, Z, Y],
            [Y, X, Z],
            [Y, Z, X],
            [Z, X, Y],
            [Z, Y, Z],
            [Z, X, Z],
            [X, Y, X],
            [X, Z, X],
            [Y, X, Y],
            [Y, Z, Y],
        ];
        let mut all = [Self::RotationVector; 25];
        let mut idx = 0;
        while idx < axes.len() {
            all[2 * idx] = Self::Extrinsic(axes[idx]);
            all[2 * idx + 1] = Self::Intrinsic(axes[idx]);
            idx += 1;
        }
        all
    };

    /// The same rotations with the three numbers listed backwards; a rotation vector has no such twin.
    #[must_use]
    pub const fn backwards(self) -> Self {
        match self {
            Self::Intrinsic([i, j, k]) => Self::Extrinsic([k, j, i]),
            Self::Extrinsic([i, j, k]) => Self::Intrinsic([k, j, i]),
            Self::RotationVector => Self::RotationVector,
        }
    }

    /// Whether the first and the third rotation are about the same axis; the middle angle then runs from 0 to π, otherwise
    /// from −π/2 to π/2.
    #[must_use]
    pub const fn is_proper_euler(self) -> bool {
        match self {
            Self::Intrinsic([i, _, k]) | Self::Extrinsic([i, _, k]) => i as u8 == k as u8,
            Self::RotationVector => false,
        }
    }

    /// The rotation that three numbers (rad) stand for.
    #[must_use]
    pub fn rotation_from_angles(self, angles: [f64; 3]) -> UnitQuaternion<f64> {
        let [a, b, c] = angles;
        match self {
            Self::Intrinsic([i, j, k]) => about(i, a) * about(j, b) * about(k, c),
            Self::Extrinsic([i, j, k]) => about(k, c) * about(j, b) * about(i, a),
            Self::RotationVector => so3::exp(Vec3::from(angles)),
        }
    }

    /// The three numbers (rad) of a rotation. In gimbal lock the first factor of the product gets 0.
    #[must_use]
    pub fn angles_from_rotation(self, rotation: &UnitQuaternion<f64>) -> [f64; 3] {
        match self {
            Self::Intrinsic(axes) => euler_angles(axes, rotation),
            Self::Extrinsic([i, j, k]) => {
                let [c, b, a] = euler_angles([k, j, i], rotation);
                [a, b, c]
            }
            Self::RotationVector => so3::log(rotation).into(),
        }
    }

    /// The other three numbers (rad) that stand for the same rotation, the first and third angle within ±π. The other way
    /// round the same axis is longer than π; a rotation vector of no length has no axis, so it stays.
    #[must_use]
    pub fn second_angles(self, angles: [f64; 3]) -> [f64; 3] {
        use std::f64::consts::{PI, TAU};
        let [a, b, c] = angles;
        let turned = |angle: f64| if angle > 0.0 { angle - PI } else { angle + PI };
        match self {
            Self::RotationVector => {
                let angle = Vec3::from(angles).norm();
                if angle > 0.0 { angles.map(|v| v * (1.0 - TAU / angle)) } else { angles }
            }
            _ if self.is_proper_euler() => [turned(a), -b, turned(c)],
            _ => [turned(a), if b < 0.0 { -PI - b } else { PI - b }, turned(c)],
        }
    }
}

/// As engineers say it: "extrinsic XYZ", "rotation vector".
impl fmt::Display for AngleOrder {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (word, axes) = match self {
            Self::Intrinsic(axes) => ("intrinsic", axes),
            Self::Extrinsic(axes) => ("extrinsic", axes),
            Self::RotationVector => return formatter.write_str("rotation vector"),
        };
        let [i, j, k] = axes;
        write!(formatter, "{word} {i:?}{j:?}{k:?}")
    }
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
    /// How the three numbers make a rotation, in the maker's order.
    pub order: AngleOrder,
}

const fn maker(
    id: &'static str,
    label: &'static str,
    angle_names: [&'static str; 3],
    formula: &'static str,
    order: AngleOrder,
) -> PoseConvention {
    PoseConvention { id, label, angle_names, formula, order }
}

const EXTRINSIC_XYZ: AngleOrder = AngleOrder::Extrinsic([X, Y, Z]);
const INTRINSIC_ZYX: AngleOrder = AngleOrder::Intrinsic([Z, Y, X]);
const INTRINSIC_XYZ: AngleOrder = AngleOrder::Intrinsic([X, Y, Z]);
const INTRINSIC_ZYZ: AngleOrder = AngleOrder::Intrinsic([Z, Y, Z]);

impl PoseConvention {
    /// All conventions known, the default first.
    pub const ALL: &'static [Self] = &[
        maker("fanuc-wpr", "FANUC W P R", ["W", "P", "R"], "Rz(R) Ry(P) Rx(W)", EXTRINSIC_XYZ),
        maker("abb-ezeyex", "ABB EZ EY EX", ["EZ", "EY", "EX"], "Rz(EZ) Ry(EY) Rx(EX)", INTRINSIC_ZYX),
        maker("kuka-abc", "KUKA A B C", ["A", "B", "C"], "Rz(A) Ry(B) Rx(C)", INTRINSIC_ZYX),
        maker("ur-rotvec", "UR RX RY RZ", ["RX", "RY", "RZ"], "rotation vector", AngleOrder::RotationVector),
        maker("yaskawa-rxryrz", "Yaskawa Rx Ry Rz", ["Rx", "Ry", "Rz"], "Rz(Rz) Ry(Ry) Rx(Rx)", EXTRINSIC_XYZ),
        maker("staubli-rxryrz", "Stäubli Rx Ry Rz", ["Rx", "Ry", "Rz"], "Rx(Rx) Ry(Ry) Rz(Rz)", INTRINSIC_XYZ),
        maker("kawasaki-oat", "Kawasaki O A T", ["O", "A", "T"], "Rz(O) Ry(A) Rz(T)", INTRINSIC_ZYZ),
        maker("mitsubishi-abc", "Mitsubishi A B C", ["A", "B", "C"], "Rz(C) Ry(B) Rx(A)", EXTRINSIC_XYZ),
        maker("comau-aer", "Comau A E R", ["A", "E", "R"], "Rz(A) Ry(E) Rz(R)", INTRINSIC_ZYZ),
        maker("denso-rxryrz", "Denso RX RY RZ", ["RX", "RY", "RZ"], "Rz(RZ) Ry(RY) Rx(RX)", EXTRINSIC_XYZ),
        maker("nachi-rpy", "Nachi r p y", ["r", "p", "y"], "Rz(r) Ry(p) Rx(y)", INTRINSIC_ZYX),
        maker("epson-uvw", "Epson U V W", ["U", "V", "W"], "Rz(U) Ry(V) Rx(W)", INTRINSIC_ZYX),
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

    /// The makers that write an orientation in this order.
    pub fn of_order(order: AngleOrder) -> impl Iterator<Item = &'static Self> {
        Self::ALL.iter().filter(move |convention| convention.order == order)
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
    fn every_order_round_trips_by_both_of_its_triples() {
        for (idx, order) in AngleOrder::ALL.into_iter().enumerate() {
            assert_eq!(AngleOrder::ALL.iter().position(|other| *other == order), Some(idx), "{order} stands once");
            for angles in [[0.3, 0.8, -2.0], [-3.0, -0.4, 1.1], [2.0, 1.5, 0.0]] {
                let rotation = order.rotation_from_angles(angles);
                let first = order.angles_from_rotation(&rotation);
                let second = order.second_angles(first);
                assert!(first.iter().zip(second).any(|(first, second)| (first - second).abs() > 0.1));
                for again in [first, second, order.second_angles(second)] {
                    // Rounding of a few turns of the angles.
                    assert!(order.rotation_from_angles(again).angle_to(&rotation) < 1e-13, "{order}: {again:?}");
                }
                let backwards = order.backwards();
                let [a, b, c] = angles;
                if order != AngleOrder::RotationVector {
                    assert!(backwards.rotation_from_angles([c, b, a]).angle_to(&rotation) < 1e-14, "{order}");
                }
            }
        }
    }

    #[test]
    fn orders_have_the_names_that_engineers_use_and_makers_that_share_one_are_found() {
        let fanuc = PoseConvention::default_convention();
        assert_eq!(fanuc.order.to_string(), "extrinsic XYZ");
        assert_eq!(fanuc.order.backwards().to_string(), "intrinsic ZYX");
        let ids: Vec<&str> = PoseConvention::of_order(fanuc.order).map(|convention| convention.id).collect();
        assert_eq!(ids, ["fanuc-wpr", "yaskawa-rxryrz", "mitsubishi-abc", "denso-rxryrz"]);
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
