//! A motion of the simulated arm: its way, checked before it starts, and where it is at which time.

use nalgebra::Translation3;

use crate::geometry::Rigid;

use super::chain::{Chain, Joints, Unreachable};

/// The way is checked at least every so many millimetres ...
const CHECK_MM: f64 = 2.0;
/// ... and every so many degrees.
const CHECK_DEG: f64 = 0.5;
/// A joint that turns further between two checks would have to be faster than arms are, rad.
const LEAP_RAD: f64 = 0.08;
/// Time to get up to speed, and to brake, s.
const RAMP_S: f64 = 0.1;
/// Full speed of a joint, rad/s.
const JOINT_SPEED_RAD_S: f64 = 3.5;

/// How fast a straight motion may be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Speed {
    /// Of the tool point's position, mm/s.
    pub linear_mm_s: f64,
    /// Of the orientation, rad/s.
    pub turning_rad_s: f64,
}

impl Speed {
    /// As fast as the arm goes.
    pub const FULL: Self = Self { linear_mm_s: 2000.0, turning_rad_s: JOINT_SPEED_RAD_S };
}

/// What goes straight: a point of the flange, its orientation turning evenly.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Line {
    /// Of the point.
    ends: [Rigid; 2],
    flange_from_tcp: Rigid,
}

impl Line {
    fn base_from_flange(&self, part: f64) -> Rigid {
        between(&self.ends, part) * self.flange_from_tcp.inverse()
    }
}

/// A way that the arm can go.
#[derive(Clone, Debug, PartialEq)]
pub struct Way {
    /// Where it is straight, what is; otherwise the joints are what moves evenly.
    straight: Option<Line>,
    /// The joints at even parts of it; at least the two ends.
    samples: Vec<Joints>,
}

impl Way {
    /// To a pose of the flange, a tool point going straight and the orientation turning evenly.
    ///
    /// # Errors
    /// [`Unreachable`] if some pose on the way is.
    pub fn straight(
        chain: &Chain,
        start: &Joints,
        base_from_flange: &Rigid,
        flange_from_tcp: &Rigid,
    ) -> Result<Self, Unreachable> {
        let ends = [chain.base_from_flange(start), *base_from_flange].map(|flange| flange * flange_from_tcp);
        let line = Line { ends, flange_from_tcp: *flange_from_tcp };
        let [length_mm, turn_rad] = length_and_turn(&ends);
        let num_parts = (length_mm / CHECK_MM).max(turn_rad.to_degrees() / CHECK_DEG).ceil().clamp(1.0, 1e5);
        let mut samples = vec![*start];
        let mut last = *start;
        let mut idx = 0.0;
        while idx < num_parts {
            idx += 1.0;
            let next = chain.joints_near(&last, &line.base_from_flange(idx / num_parts))?;
            chain.check_limits(&next)?;
            if let Some(leaping) = (next - last).iter().position(|turn| turn.abs() > LEAP_RAD) {
                return Err(Unreachable::Singular { joint: leaping + 1 });
            }
            samples.push(next);
            last = next;
        }
        Ok(Self { straight: Some(line), samples })
    }

    /// All joints evenly to their ends.
    ///
    /// # Errors
    /// [`Unreachable::JointLimit`].
    pub fn by_joints(chain: &Chain, start: &Joints, end: &Joints) -> Result<Self, Unreachable> {
        chain.check_limits(end)?;
        Ok(Self { straight: None, samples: vec![*start, *end] })
    }

    /// The least time at a speed, s; joint motions go by a part of the joints' full speed.
    #[must_use]
    pub fn cruise_s(&self, speed: Speed, joint_speed_part: f64) -> f64 {
        match &self.straight {
            Some(line) => {
                let [length_mm, turn_rad] = length_and_turn(&line.ends);
                (length_mm / speed.linear_mm_s).max(turn_rad / speed.turning_rad_s)
            }
            None => (self.end() - self.samples[0]).amax() / (JOINT_SPEED_RAD_S * joint_speed_part),
        }
    }

    /// The joints at its end.
    #[must_use]
    pub fn end(&self) -> Joints {
        self.joints_at(1.0)
    }

    /// The joints at a part of it, 0 to 1.
    #[expect(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "an index below 10^5, not negative"
    )]
    fn joints_at(&self, part: f64) -> Joints {
        let place = part.clamp(0.0, 1.0) * (self.samples.len() - 1) as f64;
        let idx = (place as usize).min(self.samples.len().saturating_sub(2));
        let rest = place - idx as f64;
        let next = self.samples.get(idx + 1).unwrap_or(&self.samples[idx]);
        self.samples[idx] * (1.0 - rest) + next * rest
    }

    fn pose_at(&self, chain: &Chain, part: f64) -> Rigid {
        match &self.straight {
            Some(line) => line.base_from_flange(part),
            None => chain.base_from_flange(&self.joints_at(part)),
        }
    }
}

fn length_and_turn(ends: &[Rigid; 2]) -> [f64; 2] {
    let [from, to] = ends;
    [(to.translation.vector - from.translation.vector).norm(), from.rotation.angle_to(&to.rotation)]
}

fn between([from, to]: &[Rigid; 2], part: f64) -> Rigid {
    // The ends are met to the last bit, and a half turn has no one shortest way: it stays where it is.
    if part >= 1.0 {
        return *to;
    }
    let translation = from.translation.vector.lerp(&to.translation.vector, part);
    let rotation = from.rotation.try_slerp(&to.rotation, part, 1e-9).unwrap_or(from.rotation);
    Rigid::from_parts(Translation3::from(translation), rotation)
}

/// A way with its times, in seconds of the cell's own clock.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    way: Way,
    start_s: f64,
    cruise_s: f64,
    /// When it was stopped, if it was.
    stopped_s: Option<f64>,
}

impl Motion {
    /// Along a way from a time on.
    #[must_use]
    pub const fn new(way: Way, start_s: f64, cruise_s: f64) -> Self {
        Self { way, start_s, cruise_s, stopped_s: None }
    }

    /// Standing at some joints.
    #[must_use]
    pub fn standing(joints: Joints) -> Self {
        Self::new(Way { straight: None, samples: vec![joints, joints] }, 0.0, 0.0)
    }

    /// When it began, s.
    #[must_use]
    pub const fn start_s(&self) -> f64 {
        self.start_s
    }

    /// When it is over, s.
    #[must_use]
    pub fn end_s(&self) -> f64 {
        let planned = self.start_s + self.cruise_s + self.ramp_s();
        self.stopped_s.map_or(planned, |stopped_s| stopped_s.min(planned))
    }

    /// Ends it where it is at a time.
    pub fn stop_at(&mut self, time_s: f64) {
        if time_s < self.end_s() {
            self.stopped_s = Some(time_s.max(self.start_s));
        }
    }

    /// Which part of its way is done: speed up, even speed, brake.
    #[must_use]
    pub fn part_at(&self, time_s: f64) -> f64 {
        let ramp_s = self.ramp_s();
        let all_s = self.cruise_s + ramp_s;
        let since_s = self.stopped_s.map_or(time_s, |stopped_s| time_s.min(stopped_s)) - self.start_s;
        if since_s <= 0.0 && all_s > 0.0 {
            0.0
        } else if since_s >= all_s {
            1.0
        } else if since_s < ramp_s {
            since_s * since_s / (2.0 * ramp_s * self.cruise_s)
        } else if since_s > self.cruise_s {
            1.0 - (all_s - since_s).powi(2) / (2.0 * ramp_s * self.cruise_s)
        } else {
            (since_s - 0.5 * ramp_s) / self.cruise_s
        }
    }

    /// The joints at a time.
    #[must_use]
    pub fn joints_at(&self, time_s: f64) -> Joints {
        self.way.joints_at(self.part_at(time_s))
    }

    /// The flange at a time, as commanded.
    #[must_use]
    pub fn pose_at(&self, chain: &Chain, time_s: f64) -> Rigid {
        self.way.pose_at(chain, self.part_at(time_s))
    }

    fn ramp_s(&self) -> f64 {
        RAMP_S.min(self.cruise_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Vec3, so3};

    const SPEED: Speed = Speed { linear_mm_s: 50.0, turning_rad_s: 0.5 };

    fn start() -> (Chain, Joints) {
        let chain = Chain::lr_mate();
        let joints = chain.joints_from_shown_deg([8.0, 13.0, -10.0, 3.0, -78.0, 5.0]);
        (chain, joints)
    }

    #[test]
    fn a_straight_way_is_straight_evenly_turned_and_ends_where_it_was_sent() {
        let (chain, joints) = start();
        let from = chain.base_from_flange(&joints);
        let turn = Rigid::from_parts(Translation3::new(40.0, -30.0, 25.0), so3::exp(Vec3::new(0.3, -0.2, 0.4)));
        let to = from * turn;
        let motion = Motion::new(Way::straight(&chain, &joints, &to, &Rigid::identity()).expect("reachable"), 2.0, 1.5);
        assert!((motion.end_s() - 3.6).abs() < 1e-12);
        for step in 0..=20 {
            let time_s = 2.0 + 0.08 * f64::from(step);
            let part = motion.part_at(time_s);
            let pose = motion.pose_at(&chain, time_s);
            let way = to.translation.vector - from.translation.vector;
            assert!((pose.translation.vector - from.translation.vector - way * part).norm() < 1e-9);
            assert!(
                (from.rotation.angle_to(&pose.rotation) - part * from.rotation.angle_to(&to.rotation)).abs() < 1e-9
            );
            // The joints are interpolated between checks: off by the arc's sagitta.
            let by_joints = chain.base_from_flange(&motion.joints_at(time_s));
            assert!((by_joints.translation.vector - pose.translation.vector).norm() < 0.02);
        }
        assert_eq!(motion.pose_at(&chain, 10.0), to);
    }

    #[test]
    fn a_tool_point_goes_straight_while_the_flange_swings_about_it() {
        let (chain, joints) = start();
        let flange_from_tcp = Rigid::translation(0.0, 0.0, 100.0);
        let from = chain.base_from_flange(&joints);
        let turn = Rigid::from_parts(Translation3::identity(), so3::exp(Vec3::x() * 0.3));
        let to = from * flange_from_tcp * turn * flange_from_tcp.inverse();
        let way = Way::straight(&chain, &joints, &to, &flange_from_tcp).expect("reachable");
        // The turn is all that takes time.
        assert!((way.cruise_s(SPEED, 1.0) - 0.6).abs() < 1e-9);
        let tcp = |flange: Rigid| (flange * flange_from_tcp).translation.vector;
        for part in [0.0, 0.3, 0.7, 1.0] {
            assert!((tcp(way.pose_at(&chain, part)) - tcp(from)).norm() < 1e-9);
        }
        assert!((way.pose_at(&chain, 1.0).translation.vector - to.translation.vector).norm() < 1e-9);
    }

    #[test]
    fn the_part_done_grows_evenly_and_ends_at_one() {
        let (chain, joints) = start();
        for target_mm in [0.0, 0.5, 3.0, 60.0] {
            let to = chain.base_from_flange(&joints) * Translation3::new(target_mm, 0.0, 0.0);
            let way = Way::straight(&chain, &joints, &to, &Rigid::identity()).expect("reachable");
            let cruise_s = way.cruise_s(SPEED, 1.0);
            assert!((cruise_s - target_mm / 50.0).abs() < 1e-9);
            let motion = Motion::new(way, 1.0, cruise_s);
            let parts: Vec<f64> = (0..=200).map(|step| motion.part_at(1.0 + 0.01 * f64::from(step))).collect();
            assert!(
                parts.windows(2).all(|pair| (0.0..0.5).contains(&(pair[1] - pair[0])) || target_mm < 1.0),
                "{parts:?}"
            );
            assert_eq!(parts.last(), Some(&1.0));
        }
    }

    #[test]
    fn a_stopped_motion_stays() {
        let (chain, joints) = start();
        let to = chain.base_from_flange(&joints) * Translation3::new(50.0, 0.0, 0.0);
        let mut motion =
            Motion::new(Way::straight(&chain, &joints, &to, &Rigid::identity()).expect("reachable"), 0.0, 1.0);
        let at_stop = motion.pose_at(&chain, 0.4);
        motion.stop_at(0.4);
        assert!((motion.end_s() - 0.4).abs() < 1e-12);
        assert_eq!(motion.pose_at(&chain, 5.0), at_stop);
    }

    #[test]
    fn ways_through_limits_reach_and_singular_poses_are_refused() {
        let (chain, joints) = start();
        let home = chain.base_from_flange(&joints);
        let refusal = |pose: Rigid| Way::straight(&chain, &joints, &pose, &Rigid::identity()).err();
        let far = Rigid::translation(400.0, 0.0, 0.0) * home;
        // Before the arm is stretched its elbow would have to leap.
        assert!(matches!(refusal(far), Some(Unreachable::OutOfReach | Unreachable::Singular { .. })));
        let tilted = home * Rigid::from_parts(Translation3::identity(), so3::exp(Vec3::y() * 1.4));
        let other = home * Rigid::from_parts(Translation3::identity(), so3::exp(Vec3::y() * -1.6));
        assert!(matches!(refusal(tilted), Some(Unreachable::Singular { .. })), "{:?}", refusal(tilted));
        assert!(matches!(refusal(other), Some(Unreachable::JointLimit { joint: 5, .. })), "{:?}", refusal(other));
        assert!(matches!(
            Way::by_joints(&chain, &joints, &chain.joints_from_shown_deg([180.0, 0.0, 0.0, 0.0, 0.0, 0.0])),
            Err(Unreachable::JointLimit { joint: 1, .. })
        ));
    }
}
