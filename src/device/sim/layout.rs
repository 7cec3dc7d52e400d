//! Where things stand in a simulated cell: the arm's first pose, the sensor on its flange, the ball before it.

use nalgebra::Translation3;

use crate::device::setup::RobotKind;
use crate::geometry::{Rigid, Vec3, so3};

use super::chain::{Chain, Joints};
use super::head::Head;

/// How far the sensor's housing stands off the flange's middle, and its front from the flange, mm.
const HOUSING_IN_FLANGE_MM: [f64; 3] = [21.0, -13.0, 58.0];
/// A mounting is never quite square, rad ...
const ODD_ANGLES: Vec3 = Vec3::new(0.047, -0.061, 0.034);
/// ... and the drawing is off by about 3° ...
const DRAWING_TURN: Vec3 = Vec3::new(-0.030, 0.038, 0.022);
/// ... and 5 mm.
const DRAWING_SHIFT_MM: [f64; 3] = [3.1, -2.6, 3.0];
/// Where the ball's middle lies in the laser plane at first, and how far off it, radii.
const FIRST_VIEW_RADII: [f64; 2] = [0.12, 0.4];

/// A cell before anything has moved.
#[derive(Clone, Debug)]
pub struct Layout {
    /// The arm.
    pub chain: Chain,
    /// Its joints at the first pose.
    pub home: Joints,
    /// The sensor on its flange: x across the line, z away from the sensor, 0 at the reference distance.
    pub flange_from_sensor: Rigid,
    /// The same by the drawing.
    pub rough_flange_from_sensor: Rigid,
    /// The ball's middle, mm.
    pub ball_in_base: Vec3,
}

impl Layout {
    /// A ball of this radius before a robot with this head.
    ///
    /// The arm looks down, half stretched, so that it can turn and tilt about the ball.
    #[must_use]
    pub fn new(robot: RobotKind, head: &Head, radius_mm: f64) -> Self {
        let (chain, home_shown_deg) = match robot {
            RobotKind::UniversalRobots => (Chain::ur5e(), [12.0, -82.0, -95.0, -93.0, 90.0, 12.0]),
            RobotKind::FanucMappdk | RobotKind::FanucPage | RobotKind::Bridge => {
                (Chain::lr_mate(), [9.0, 14.0, -12.0, 0.0, -78.0, 9.0])
            }
        };
        let home = chain.joints_from_shown_deg(home_shown_deg);
        let at_reference = Vec3::from(HOUSING_IN_FLANGE_MM) + Vec3::z() * head.reference_mm;
        let flange_from_sensor = Rigid::from_parts(Translation3::from(at_reference), so3::exp(ODD_ANGLES));
        let rough_flange_from_sensor = Rigid::from_parts(
            Translation3::from(at_reference + Vec3::from(DRAWING_SHIFT_MM)),
            so3::exp(ODD_ANGLES) * so3::exp(DRAWING_TURN),
        );
        let [across, off_plane] = FIRST_VIEW_RADII;
        // The middle of the range lies a little below the ball's top.
        let ball_in_sensor = Vec3::new(across, off_plane, 0.6) * radius_mm;
        let base_from_sensor = chain.base_from_flange(&home) * flange_from_sensor;
        let ball_in_base = (base_from_sensor * nalgebra::Point3::from(ball_in_sensor)).coords;
        Self { chain, home, flange_from_sensor, rough_flange_from_sensor, ball_in_base }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::super::motion::Way;
    use super::*;

    /// The stations that a session of hand-eye calibration wants: tilts of 30° all around, turns of 90° either way.
    fn orientations() -> Vec<nalgebra::UnitQuaternion<f64>> {
        let mut all = vec![so3::exp(Vec3::zeros())];
        for (idx, spin_deg) in [-90.0_f64, 60.0, -30.0, 90.0, 0.0, -60.0, 30.0, 75.0].into_iter().enumerate() {
            let azimuth = TAU / 8.0 * f64::from(u8::try_from(idx).expect("eight"));
            let tilt_axis = Vec3::new(-azimuth.sin(), azimuth.cos(), 0.0);
            all.push(so3::exp(tilt_axis * 30.0_f64.to_radians()) * so3::exp(Vec3::z() * spin_deg.to_radians()));
        }
        all
    }

    fn unreachable(robot: RobotKind, head: &Head) -> Vec<String> {
        let radius_mm = 15.0;
        let layout = Layout::new(robot, head, radius_mm);
        let home = layout.chain.base_from_flange(&layout.home);
        let reference = home.rotation * layout.flange_from_sensor.rotation;
        let mut joints = layout.home;
        let mut refused = Vec::new();
        for (station, orientation) in orientations().into_iter().enumerate() {
            let rotation = reference * orientation;
            // From 0.6 R before the ball's middle to 0.6 R behind it.
            for offset in [0.6, -0.6] {
                let ball_in_sensor = Vec3::new(0.0, offset, 0.6) * radius_mm;
                let origin = layout.ball_in_base - rotation * ball_in_sensor;
                let base_from_sensor = Rigid::from_parts(Translation3::from(origin), rotation);
                let target = base_from_sensor * layout.flange_from_sensor.inverse();
                let way = Way::straight(&layout.chain, &joints, &target);
                match way {
                    Ok(way) => joints = way.end(),
                    Err(error) => refused.push(format!("station {station}, {offset} R: {error}")),
                }
            }
        }
        refused
    }

    #[test]
    fn stations_all_around_the_ball_and_the_ways_between_them_are_reachable() {
        for robot in [RobotKind::FanucMappdk, RobotKind::UniversalRobots] {
            for head in Head::ALL.into_iter().take(3) {
                let refused = unreachable(robot, &head);
                assert!(refused.is_empty(), "{robot:?}, {}: {refused:#?}", head.id);
            }
        }
    }

    #[test]
    fn the_drawing_is_off_by_some_degrees_and_millimetres() {
        let layout = Layout::new(RobotKind::FanucMappdk, &Head::default(), 15.0);
        let off = layout.flange_from_sensor.inverse() * layout.rough_flange_from_sensor;
        assert!((4.0..6.0).contains(&off.translation.vector.norm()));
        assert!((2.0..4.0).contains(&off.rotation.angle().to_degrees()));
    }
}
