//! Which motion is allowed. Pure: checked before anything is sent.
//!
//! These checks spare the cell a foolish command. They are no safety function: the controller's own limits, its fences and
//! the emergency stop protect people.

use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::driver::{LinearMove, Readiness};
use super::search::SearchSettings;
use crate::geometry::{Base, Flange, Transform, Vec3};

/// Where the flange may be, in the base, mm.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct WorkspaceBox {
    /// The least corner.
    pub min_mm: [f64; 3],
    /// The greatest corner.
    pub max_mm: [f64; 3],
}

/// What the robot may be asked to do.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct MotionLimits {
    /// Where the flange may be; `None`: a box about the pose at arming, as far as the longest move either way.
    pub workspace: Option<WorkspaceBox>,
    /// Greatest speed of the flange, mm/s.
    pub max_speed_mm_s: f64,
    /// Greatest speed of its turning, degrees a second.
    pub max_rotation_speed_deg_s: f64,
    /// Longest single move, mm.
    pub max_move_mm: f64,
    /// Greatest single turn, degrees.
    pub max_turn_deg: f64,
    /// Speed on the way to a station, mm/s.
    pub transit_speed_mm_s: f64,
    /// Speed of the steps of a search, mm/s.
    pub search_speed_mm_s: f64,
}

impl Default for MotionLimits {
    fn default() -> Self {
        Self {
            workspace: None,
            max_speed_mm_s: 100.0,
            max_rotation_speed_deg_s: 30.0,
            max_move_mm: 400.0,
            max_turn_deg: 100.0,
            transit_speed_mm_s: 50.0,
            search_speed_mm_s: 10.0,
        }
    }
}

/// Why a motion is not sent.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum MotionRefusal {
    /// The arm switch is off.
    #[error("motion is not armed; switch it on once nobody is in reach of the robot")]
    NotArmed,
    /// A target outside the box.
    #[error(
        "the target is at {axis} = {found_mm:.1} mm, needed {min_mm:.1} to {max_mm:.1} mm; widen the workspace box or choose another pose"
    )]
    OutsideWorkspace {
        /// x, y or z.
        axis: char,
        /// Where the target is, mm.
        found_mm: f64,
        /// The least, mm.
        min_mm: f64,
        /// The greatest, mm.
        max_mm: f64,
    },
    /// Too far in one move.
    #[error(
        "the move is {found_mm:.1} mm long, allowed are {max_mm:.1} mm; jog the robot nearer or allow longer moves"
    )]
    TooFar {
        /// Its length, mm.
        found_mm: f64,
        /// The most, mm.
        max_mm: f64,
    },
    /// Too great a turn in one move.
    #[error(
        "the move turns the flange by {found_deg:.1}°, allowed are {max_deg:.1}°; jog the robot nearer or allow greater turns"
    )]
    TurnsTooFar {
        /// The turn, degrees.
        found_deg: f64,
        /// The most, degrees.
        max_deg: f64,
    },
    /// Too fast, or not at all.
    #[error(
        "the move is to run at {found_mm_s:.1} mm/s, needed more than 0 and up to {max_mm_s:.1} mm/s; change the speeds set before motion"
    )]
    TooFast {
        /// Its speed, mm/s.
        found_mm_s: f64,
        /// The most, mm/s.
        max_mm_s: f64,
    },
    /// The turning too fast, or not at all.
    #[error(
        "the flange is to turn at {found_deg_s:.1}°/s, needed more than 0 and up to {max_deg_s:.0}°/s; change the speeds set before motion"
    )]
    TurnsTooFast {
        /// Its speed, degrees a second.
        found_deg_s: f64,
        /// The most, degrees a second.
        max_deg_s: f64,
    },
    /// A target with numbers that are none.
    #[error("the target of the move is no pose: found a number that is not finite; choose another target")]
    NotAPose,
    /// A search along the laser line sees the same section all the way.
    #[error(
        "the search would go {angle_deg:.0}° off the laser plane's normal, needed at most {max_deg:.0}°: it has to go across the laser line. Set its direction to {x:.2}, {y:.2}, {z:.2}, or correct the mounting",
        x = across[0], y = across[1], z = across[2]
    )]
    AlongLine {
        /// The angle between the travel and the normal of the laser plane, degrees.
        angle_deg: f64,
        /// The most, degrees.
        max_deg: f64,
        /// The normal, in the frame of the search's direction.
        across: [f64; 3],
    },
    /// The controller would refuse.
    #[error("the robot is not ready: found {found}; {remedy}")]
    NotReady {
        /// What it is in.
        found: String,
        /// What to do.
        remedy: &'static str,
    },
    /// The driver only reads.
    #[error("this connection can only read; jog the robot by hand, or connect with a driver that moves it")]
    ReadOnly,
}

/// No flange of a robot should turn faster under this program, whatever is set, degrees a second.
pub const MOST_ROTATION_SPEED_DEG_S: f64 = 90.0;

/// Permission to move, given by the arm switch at a pose. Without one nothing can be checked, and so nothing be sent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arming {
    /// Where the robot was.
    pub base_from_flange: Transform<Base, Flange>,
    /// What it may be asked to do.
    pub limits: MotionLimits,
}

impl Arming {
    /// The move, if it is allowed.
    ///
    /// # Errors
    /// [`MotionRefusal`].
    pub fn check(
        &self,
        readiness: &Readiness,
        from: &Transform<Base, Flange>,
        to: &Transform<Base, Flange>,
        speed_mm_s: f64,
    ) -> Result<LinearMove, MotionRefusal> {
        check_readiness(readiness)?;
        let limits = &self.limits;
        let numbers = to.translation_mm();
        if !numbers.iter().chain(to.rotation().coords.iter()).all(|number| number.is_finite()) {
            return Err(MotionRefusal::NotAPose);
        }
        self.check_is_inside(&numbers)?;
        // In each comparison a number that is none counts as beyond the limit.
        let length_mm = (numbers - from.translation_mm()).norm();
        if !(0.0..=limits.max_move_mm).contains(&length_mm) {
            return Err(MotionRefusal::TooFar { found_mm: length_mm, max_mm: limits.max_move_mm });
        }
        let turn_deg = from.rotation().angle_to(&to.rotation()).to_degrees();
        if !(0.0..=limits.max_turn_deg).contains(&turn_deg) {
            return Err(MotionRefusal::TurnsTooFar { found_deg: turn_deg, max_deg: limits.max_turn_deg });
        }
        if !is_speed_within(speed_mm_s, limits.max_speed_mm_s) {
            return Err(MotionRefusal::TooFast { found_mm_s: speed_mm_s, max_mm_s: limits.max_speed_mm_s });
        }
        let rotation_speed_deg_s = limits.max_rotation_speed_deg_s;
        if !is_speed_within(rotation_speed_deg_s, MOST_ROTATION_SPEED_DEG_S) {
            return Err(MotionRefusal::TurnsTooFast {
                found_deg_s: rotation_speed_deg_s,
                max_deg_s: MOST_ROTATION_SPEED_DEG_S,
            });
        }
        Ok(LinearMove { base_from_flange: *to, speed_mm_s, rotation_speed_deg_s })
    }

    /// The whole travel of a search from a pose, both ways: everything that it may ask for.
    ///
    /// # Errors
    /// [`MotionRefusal`] of the first part that is not allowed.
    pub fn check_search(
        &self,
        readiness: &Readiness,
        first: &Transform<Base, Flange>,
        search: &SearchSettings,
    ) -> Result<(), MotionRefusal> {
        let at = |travel_mm| Transform::from_rigid(search.pose_at(first.rigid(), travel_mm));
        let (ahead, behind) = (at(search.max_travel_mm), at(-search.max_travel_mm));
        // The box is convex, so what is between its points is in it as well. The longest single move is that from one end
        // to the other.
        for (from, to) in [(first, &ahead), (&ahead, &behind)] {
            self.check(readiness, from, to, self.limits.search_speed_mm_s)?;
        }
        Ok(())
    }

    fn check_is_inside(&self, target_mm: &Vec3) -> Result<(), MotionRefusal> {
        let middle = self.base_from_flange.translation_mm();
        let reach = Vec3::repeat(self.limits.max_move_mm);
        let [min_mm, max_mm] = self
            .limits
            .workspace
            .map_or([middle - reach, middle + reach], |within| [within.min_mm.into(), within.max_mm.into()]);
        for (axis, ((found_mm, min_mm), max_mm)) in
            ['x', 'y', 'z'].into_iter().zip(target_mm.iter().zip(min_mm.iter()).zip(max_mm.iter()))
        {
            if !(*min_mm..=*max_mm).contains(found_mm) {
                return Err(MotionRefusal::OutsideWorkspace {
                    axis,
                    found_mm: *found_mm,
                    min_mm: *min_mm,
                    max_mm: *max_mm,
                });
            }
        }
        Ok(())
    }
}

/// Whether the controller takes motion, as far as it says.
///
/// # Errors
/// [`MotionRefusal::NotReady`] and [`MotionRefusal::ReadOnly`].
pub fn check_readiness(readiness: &Readiness) -> Result<(), MotionRefusal> {
    match readiness {
        Readiness::Ready | Readiness::Unknown => Ok(()),
        Readiness::NotReady { found, remedy } => Err(MotionRefusal::NotReady { found: found.clone(), remedy }),
        Readiness::ReadOnly => Err(MotionRefusal::ReadOnly),
    }
}

fn is_speed_within(speed: f64, max: f64) -> bool {
    speed > 0.0 && speed <= max
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::so3;

    fn pose(x: f64, y: f64, z: f64) -> Transform<Base, Flange> {
        Transform::from_parts(Vec3::new(x, y, z), so3::exp(Vec3::x() * std::f64::consts::PI))
    }

    fn arming(limits: MotionLimits) -> Arming {
        Arming { base_from_flange: pose(500.0, 0.0, 300.0), limits }
    }

    #[track_caller]
    fn check(
        limits: MotionLimits,
        to: &Transform<Base, Flange>,
        speed_mm_s: f64,
        is_expected: impl Fn(&MotionRefusal) -> bool,
    ) {
        let from = pose(500.0, 0.0, 300.0);
        let refusal = arming(limits).check(&Readiness::Ready, &from, to, speed_mm_s).expect_err("not allowed");
        assert!(is_expected(&refusal), "{refusal}");
    }

    #[test]
    fn a_move_within_all_limits_is_allowed_as_it_is() {
        let (from, to) = (pose(500.0, 0.0, 300.0), pose(520.0, 10.0, 290.0));
        for readiness in [Readiness::Ready, Readiness::Unknown] {
            let motion = arming(MotionLimits::default()).check(&readiness, &from, &to, 50.0).expect("allowed");
            assert_eq!(motion, LinearMove { base_from_flange: to, speed_mm_s: 50.0, rotation_speed_deg_s: 30.0 });
        }
    }

    #[test]
    fn each_limit_holds() {
        let limits = MotionLimits::default();
        let near = pose(510.0, 0.0, 300.0);
        let workspace = WorkspaceBox { min_mm: [400.0, -50.0, 250.0], max_mm: [600.0, 50.0, 350.0] };
        let boxed = MotionLimits { workspace: Some(workspace), ..limits };
        check(boxed, &pose(500.0, 60.0, 300.0), 50.0, |refusal| {
            matches!(refusal, MotionRefusal::OutsideWorkspace { axis: 'y', .. })
        });
        check(limits, &pose(901.0, 0.0, 300.0), 50.0, |refusal| {
            matches!(refusal, MotionRefusal::OutsideWorkspace { axis: 'x', .. })
        });
        check(limits, &pose(800.0, 300.0, 300.0), 50.0, |refusal| matches!(refusal, MotionRefusal::TooFar { .. }));
        let turned = Transform::from_parts(near.translation_mm(), so3::exp(Vec3::z() * 1.8) * near.rotation());
        check(limits, &turned, 50.0, |refusal| matches!(refusal, MotionRefusal::TurnsTooFar { .. }));
        for speed_mm_s in [100.1, 0.0, -5.0, f64::NAN, f64::INFINITY] {
            check(limits, &near, speed_mm_s, |refusal| matches!(refusal, MotionRefusal::TooFast { .. }));
        }
        for max_rotation_speed_deg_s in [0.0, -1.0, 91.0, f64::NAN] {
            let limits = MotionLimits { max_rotation_speed_deg_s, ..limits };
            check(limits, &near, 50.0, |refusal| matches!(refusal, MotionRefusal::TurnsTooFast { .. }));
        }
    }

    #[test]
    fn numbers_that_are_none_allow_nothing() {
        let limits = MotionLimits::default();
        let near = pose(510.0, 0.0, 300.0);
        check(limits, &pose(f64::NAN, 0.0, 300.0), 50.0, |refusal| *refusal == MotionRefusal::NotAPose);
        check(limits, &pose(f64::INFINITY, 0.0, 300.0), 50.0, |refusal| *refusal == MotionRefusal::NotAPose);
        check(MotionLimits { max_move_mm: f64::NAN, ..limits }, &near, 50.0, |_| true);
        check(MotionLimits { max_turn_deg: f64::NAN, ..limits }, &near, 50.0, |refusal| {
            matches!(refusal, MotionRefusal::TurnsTooFar { .. })
        });
        check(MotionLimits { max_speed_mm_s: f64::NAN, ..limits }, &near, 50.0, |refusal| {
            matches!(refusal, MotionRefusal::TooFast { .. })
        });
        let workspace = WorkspaceBox { min_mm: [f64::NAN; 3], max_mm: [f64::NAN; 3] };
        check(MotionLimits { workspace: Some(workspace), ..limits }, &near, 50.0, |refusal| {
            matches!(refusal, MotionRefusal::OutsideWorkspace { .. })
        });
    }

    #[test]
    fn a_controller_that_would_refuse_is_not_asked() {
        let (from, to) = (pose(500.0, 0.0, 300.0), pose(501.0, 0.0, 300.0));
        let not_ready = Readiness::NotReady { found: "local mode".to_owned(), remedy: "switch to remote" };
        for (readiness, expected) in [
            (not_ready, MotionRefusal::NotReady { found: "local mode".to_owned(), remedy: "switch to remote" }),
            (Readiness::ReadOnly, MotionRefusal::ReadOnly),
        ] {
            let refusal = arming(MotionLimits::default()).check(&readiness, &from, &to, 10.0);
            assert_eq!(refusal, Err(expected));
        }
    }

    #[test]
    fn a_search_is_checked_for_its_whole_travel_both_ways() {
        let workspace = WorkspaceBox { min_mm: [400.0, -20.0, 250.0], max_mm: [600.0, 100.0, 350.0] };
        let arming = arming(MotionLimits { workspace: Some(workspace), ..MotionLimits::default() });
        let start = pose(500.0, 0.0, 300.0);
        let travel = |max_travel_mm| {
            let search = SearchSettings { max_travel_mm, ..SearchSettings::default() };
            arming.check_search(&Readiness::Ready, &start, &search)
        };
        assert_eq!(travel(20.0), Ok(()));
        let refusal = travel(20.5).expect_err("leaves the box on one side");
        assert!(matches!(refusal, MotionRefusal::OutsideWorkspace { axis: 'y', .. }), "{refusal}");
        assert!(travel(f64::NAN).is_err());
        let short = Arming { limits: MotionLimits { max_move_mm: 30.0, ..MotionLimits::default() }, ..arming };
        let search = SearchSettings { max_travel_mm: 20.0, ..SearchSettings::default() };
        let refusal = short.check_search(&Readiness::Ready, &start, &search).expect_err("from end to end is too far");
        assert!(matches!(refusal, MotionRefusal::TooFar { .. }), "{refusal}");
    }
}
