//! Serial arms of six turning joints: where the flange is, which joint angles bring it there, and what the joints allow.

use nalgebra::{Isometry3, Matrix6, Translation3, UnitQuaternion, Vector6};
use thiserror::Error;

use crate::geometry::{Rigid, Vec3, se3, so3};

/// Joint angles of the mechanism, rad: each relative to the link before.
pub type Joints = Vector6<f64>;

/// Newton steps of the inverse; from nearby joints it takes three or four.
const MAX_STEPS: usize = 60;
/// What is left of the way when the inverse is done, mm (and mm at [`LENGTH_OF_RAD_MM`] for the orientation).
const TOLERANCE_MM: f64 = 1e-7;
/// A turn by one radian counts as much as this length: the size of an arm.
const LENGTH_OF_RAD_MM: f64 = 300.0;
/// Damping of the Newton step, as part of [`LENGTH_OF_RAD_MM`]: small enough to leave the convergence alone.
const DAMPING: f64 = 1e-4;
/// Most that a joint turns in one Newton step, rad: keeps the arm in its configuration.
const MAX_STEP_RAD: f64 = 0.3;

/// Why the arm cannot be somewhere.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum Unreachable {
    /// Nothing brings the flange there.
    #[error("out of reach")]
    OutOfReach,
    /// A joint would have to turn further than it can.
    #[error("J{joint} would be at {found_deg:.1}°, its limits are {min_deg:.0}° and {max_deg:.0}°")]
    JointLimit {
        /// The joint's number, from 1.
        joint: usize,
        /// Where it would be, degrees.
        found_deg: f64,
        /// The least, degrees.
        min_deg: f64,
        /// The most, degrees.
        max_deg: f64,
    },
    /// A joint would have to turn faster than it can, near a pose where two axes line up.
    #[error("J{joint} would leap near a singular pose")]
    Singular {
        /// The joint's number, from 1.
        joint: usize,
    },
}

/// A joint where all angles are zero, in the base.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Joint {
    axis: Vec3,
    /// A point on the axis, mm.
    point_mm: Vec3,
    min_deg: f64,
    max_deg: f64,
}

/// An arm.
#[derive(Clone, Debug, PartialEq)]
pub struct Chain {
    joints: [Joint; 6],
    base_from_flange_at_zero: Rigid,
    /// Whether the controller shows the third angle relative to the horizontal instead of the upper arm, as FANUC does:
    /// shown J3 = J3 − J2.
    is_third_shown_to_horizontal: bool,
}

const fn joint(axis: [f64; 3], point_mm: [f64; 3], [min_deg, max_deg]: [f64; 2]) -> Joint {
    Joint {
        axis: Vec3::new(axis[0], axis[1], axis[2]),
        point_mm: Vec3::new(point_mm[0], point_mm[1], point_mm[2]),
        min_deg,
        max_deg,
    }
}

impl Chain {
    /// An arm of the size of a FANUC LR Mate 200iD: 717 mm to the wrist. Its base is where the axes of J1 and J2 meet.
    ///
    /// At zero the upper arm is upright, the forearm and the flange point along +x.
    #[must_use]
    pub fn lr_mate() -> Self {
        let joints = [
            joint([0.0, 0.0, 1.0], [0.0, 0.0, 0.0], [-170.0, 170.0]),
            joint([0.0, 1.0, 0.0], [50.0, 0.0, 0.0], [-100.0, 145.0]),
            // The stops are those between the upper arm and the forearm.
            joint([0.0, -1.0, 0.0], [50.0, 0.0, 330.0], [-70.0, 205.0]),
            joint([-1.0, 0.0, 0.0], [50.0, 0.0, 365.0], [-190.0, 190.0]),
            joint([0.0, -1.0, 0.0], [385.0, 0.0, 365.0], [-125.0, 125.0]),
            joint([-1.0, 0.0, 0.0], [385.0, 0.0, 365.0], [-360.0, 360.0]),
        ];
        // W 180, P −90, R 0: the flange's z points forward, its x up.
        let rotation = so3::exp(Vec3::y() * -std::f64::consts::FRAC_PI_2) * half_turn_about_x();
        Self {
            joints,
            base_from_flange_at_zero: Isometry3::from_parts(Translation3::new(465.0, 0.0, 365.0), rotation),
            is_third_shown_to_horizontal: true,
        }
    }

    /// An arm of the size of a `UR5e`, by the published Denavit-Hartenberg parameters.
    #[must_use]
    pub fn ur5e() -> Self {
        const FULL: [f64; 2] = [-360.0, 360.0];
        let joints = [
            joint([0.0, 0.0, 1.0], [0.0, 0.0, 0.0], FULL),
            joint([0.0, -1.0, 0.0], [0.0, 0.0, 162.5], FULL),
            joint([0.0, -1.0, 0.0], [-425.0, 0.0, 162.5], FULL),
            joint([0.0, -1.0, 0.0], [-817.2, 0.0, 162.5], FULL),
            joint([0.0, 0.0, -1.0], [-817.2, -133.3, 62.8], FULL),
            joint([0.0, -1.0, 0.0], [-817.2, -133.3, 62.8], FULL),
        ];
        Self {
            joints,
            base_from_flange_at_zero: Isometry3::from_parts(
                Translation3::new(-817.2, -232.9, 62.8),
                so3::exp(Vec3::x() * std::f64::consts::FRAC_PI_2),
            ),
            is_third_shown_to_horizontal: false,
        }
    }

    /// Where the flange is.
    #[must_use]
    pub fn base_from_flange(&self, joints: &Joints) -> Rigid {
        let turned = self.joints.iter().zip(joints.iter()).map(|(joint, angle)| joint.turned_by(*angle));
        turned.fold(Rigid::identity(), |sum, turn| sum * turn) * self.base_from_flange_at_zero
    }

    /// The joint angles near `start` that bring the flange to a pose, whatever the joints' limits.
    ///
    /// Damped Newton steps on SE(3) from `start`, each of at most a few degrees, so the arm keeps its configuration.
    ///
    /// # Errors
    /// [`Unreachable::OutOfReach`].
    pub fn joints_near(&self, start: &Joints, base_from_flange: &Rigid) -> Result<Joints, Unreachable> {
        let weights = Vector6::new(LENGTH_OF_RAD_MM, LENGTH_OF_RAD_MM, LENGTH_OF_RAD_MM, 1.0, 1.0, 1.0);
        let damping = Matrix6::identity() * (DAMPING * LENGTH_OF_RAD_MM).powi(2);
        let mut joints = *start;
        for _ in 0..MAX_STEPS {
            let (found, mut jacobian) = self.flange_and_jacobian(&joints);
            let error = se3::log(&(found.inverse() * base_from_flange)).component_mul(&weights);
            if error.norm() < TOLERANCE_MM {
                return Ok(joints);
            }
            for (mut row, weight) in jacobian.row_iter_mut().zip(weights.iter()) {
                row *= *weight;
            }
            let normal = jacobian.transpose() * jacobian + damping;
            let step = normal.try_inverse().ok_or(Unreachable::OutOfReach)? * (jacobian.transpose() * error);
            joints += step * (MAX_STEP_RAD / step.amax()).min(1.0);
        }
        Err(Unreachable::OutOfReach)
    }

    /// Whether the joints can be there.
    ///
    /// # Errors
    /// [`Unreachable::JointLimit`] for the first that cannot.
    pub fn check_limits(&self, joints: &Joints) -> Result<(), Unreachable> {
        for (idx, (joint, angle)) in self.joints.iter().zip(joints.iter()).enumerate() {
            let found_deg = angle.to_degrees();
            if !(joint.min_deg..=joint.max_deg).contains(&found_deg) {
                let (min_deg, max_deg) = (joint.min_deg, joint.max_deg);
                return Err(Unreachable::JointLimit { joint: idx + 1, found_deg, min_deg, max_deg });
            }
        }
        Ok(())
    }

    /// The angles as the controller shows them, degrees.
    #[must_use]
    pub fn shown_deg(&self, joints: &Joints) -> [f64; 6] {
        let mut shown: [f64; 6] = joints.map(f64::to_degrees).into();
        if self.is_third_shown_to_horizontal {
            shown[2] -= shown[1];
        }
        shown
    }

    /// The angles of the mechanism from those that the controller shows.
    #[must_use]
    pub fn joints_from_shown_deg(&self, shown_deg: [f64; 6]) -> Joints {
        let mut joints = Joints::from(shown_deg.map(f64::to_radians));
        if self.is_third_shown_to_horizontal {
            joints[2] += joints[1];
        }
        joints
    }

    /// The flange, and how its tangent (rotation, translation; in the flange) follows the joints.
    fn flange_and_jacobian(&self, joints: &Joints) -> (Rigid, Matrix6<f64>) {
        let base_from_flange = self.base_from_flange(joints);
        let to_flange = base_from_flange.rotation.inverse();
        let mut jacobian = Matrix6::zeros();
        let mut turned = Rigid::identity();
        for (idx, (joint, angle)) in self.joints.iter().zip(joints.iter()).enumerate() {
            let axis = turned.rotation * joint.axis;
            let point = turned * nalgebra::Point3::from(joint.point_mm);
            let velocity = axis.cross(&(base_from_flange.translation.vector - point.coords));
            jacobian.set_column(idx, &se3::join(to_flange * axis, to_flange * velocity));
            turned *= joint.turned_by(*angle);
        }
        (base_from_flange, jacobian)
    }
}

impl Joint {
    /// The motion of all that follows the joint.
    fn turned_by(&self, angle: f64) -> Rigid {
        let rotation = so3::exp(self.axis * angle);
        Isometry3::from_parts(Translation3::from(self.point_mm - rotation * self.point_mm), rotation)
    }
}

fn half_turn_about_x() -> UnitQuaternion<f64> {
    UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(0.0, 1.0, 0.0, 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::PoseConvention;
    use crate::scene::Random;

    /// Degrees within which random joints lie: well inside the limits of both arms, and off their singular poses.
    const RANGES_DEG: [[f64; 2]; 6] =
        [[-160.0, 160.0], [-60.0, 60.0], [20.0, 110.0], [-120.0, 120.0], [25.0, 100.0], [-170.0, 170.0]];

    fn random_joints(random: &mut Random) -> Joints {
        Joints::from(RANGES_DEG.map(|[min, max]| (min + (max - min) * random.unit()).to_radians()))
    }

    #[track_caller]
    fn check_position(chain: &Chain, shown_deg: [f64; 6], expected_mm: [f64; 3]) {
        let found = chain.base_from_flange(&chain.joints_from_shown_deg(shown_deg)).translation.vector;
        assert!((found - Vec3::from(expected_mm)).norm() < 1e-9, "{shown_deg:?}: {found}");
    }

    #[test]
    fn known_poses_are_met() {
        let lr_mate = Chain::lr_mate();
        check_position(&lr_mate, [0.0; 6], [465.0, 0.0, 365.0]);
        check_position(&lr_mate, [90.0, 0.0, 0.0, 0.0, 0.0, 0.0], [0.0, 465.0, 365.0]);
        // The forearm stays level while the upper arm leans forward: that is what the coupling means.
        check_position(&lr_mate, [0.0, 90.0, 0.0, 0.0, 0.0, 0.0], [50.0 + 330.0 + 335.0 + 80.0, 0.0, 35.0]);
        // The flange down.
        check_position(&lr_mate, [0.0, 0.0, 0.0, 0.0, -90.0, 0.0], [385.0, 0.0, 285.0]);
        check_position(&Chain::ur5e(), [0.0; 6], [-817.2, -232.9, 62.8]);
        // Both arms and the wrist upright.
        check_position(&Chain::ur5e(), [0.0, -90.0, 0.0, -90.0, 0.0, 0.0], [0.0, -232.9, 162.5 + 425.0 + 392.2 + 99.7]);
    }

    #[test]
    fn the_flange_at_zero_has_the_angles_of_a_fanuc() {
        let chain = Chain::lr_mate();
        let rotation = PoseConvention::default_convention().rotation_from_angles_deg([180.0, -90.0, 0.0]);
        assert!(chain.base_from_flange(&Joints::zeros()).rotation.angle_to(&rotation) < 1e-12);
    }

    #[test]
    fn the_inverse_undoes_the_forward_map() {
        let mut random = Random::new(5, 0);
        for chain in [Chain::lr_mate(), Chain::ur5e()] {
            for case in 0..300 {
                let joints = random_joints(&mut random);
                let start = joints + Joints::from_fn(|_, _| 0.08 * random.signed_unit());
                let pose = chain.base_from_flange(&joints);
                let found = chain.joints_near(&start, &pose).unwrap_or_else(|error| panic!("case {case}: {error}"));
                let again = chain.base_from_flange(&found);
                // What the inverse leaves.
                assert!((again.translation.vector - pose.translation.vector).norm() < 2.0 * TOLERANCE_MM);
                assert!(again.rotation.angle_to(&pose.rotation) < 1e-9);
                // From nearby it is the same configuration: 0.08 rad off, not another branch.
                assert!((found - joints).amax() < 0.5, "case {case}: {found} instead of {joints}");
            }
        }
    }

    #[test]
    fn beyond_the_reach_there_are_no_joints() {
        let chain = Chain::lr_mate();
        let start = chain.joints_from_shown_deg([0.0, 20.0, -20.0, 0.0, -60.0, 0.0]);
        let far =
            Rigid::translation(1000.0, 0.0, 200.0) * Rigid::from_parts(Translation3::identity(), half_turn_about_x());
        assert_eq!(chain.joints_near(&start, &far), Err(Unreachable::OutOfReach));
    }

    #[test]
    fn limits_are_those_of_the_mechanism() {
        let chain = Chain::lr_mate();
        let limit_of = |shown_deg| match chain.check_limits(&chain.joints_from_shown_deg(shown_deg)) {
            Err(Unreachable::JointLimit { joint, .. }) => Some(joint),
            _ => None,
        };
        assert_eq!(limit_of([0.0; 6]), None);
        assert_eq!(limit_of([171.0, 0.0, 0.0, 0.0, 0.0, 0.0]), Some(1));
        assert_eq!(limit_of([0.0, -101.0, 60.0, 0.0, 0.0, 0.0]), Some(2));
        // Level with the upper arm upright is allowed, level with the upper arm far back is not.
        assert_eq!(limit_of([0.0, -69.0, 0.0, 0.0, 0.0, 0.0]), None);
        assert_eq!(limit_of([0.0, -71.0, 0.0, 0.0, 0.0, 0.0]), Some(3));
        assert_eq!(limit_of([0.0, 0.0, 0.0, 0.0, 126.0, 0.0]), Some(5));
    }

    #[test]
    fn shown_angles_round_trip() {
        let shown_deg = [10.0, 20.0, -30.0, 40.0, -50.0, 60.0];
        for chain in [Chain::lr_mate(), Chain::ur5e()] {
            let again = chain.shown_deg(&chain.joints_from_shown_deg(shown_deg));
            assert!(again.iter().zip(shown_deg).all(|(found, expected)| (found - expected).abs() < 1e-12));
        }
    }
}
