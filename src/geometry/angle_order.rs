//! How three numbers make a rotation: every order of axes, about moving and about fixed ones, and the rotation vector.

use std::fmt;

use nalgebra::UnitQuaternion;

use super::{Vec3, so3};

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

pub(super) fn about(axis: Axis, angle: f64) -> UnitQuaternion<f64> {
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
    use super::*;

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
}
