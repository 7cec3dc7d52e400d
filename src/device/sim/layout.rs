//! Where things stand in a simulated cell: the arm's first pose, the sensor on its flange, the ball or part before it.

use std::f64::consts::FRAC_PI_4;

use nalgebra::Translation3;

use crate::calibrate::Edge;
use crate::device::setup::RobotKind;
use crate::geometry::{Rigid, Vec3, so3};
use crate::scene::PartKind;

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

/// Where the line crosses the plate's edge p at first, from the corner, mm.
const PLATE_AIM_MM: f64 = 60.0;

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
                (Chain::lr_mate(), [9.0, -2.0, -20.0, 0.0, -70.0, 9.0])
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

    /// Where the flange is with the line on an edge of a plate, as far from the corner as at first.
    #[must_use]
    pub fn base_from_flange_at_edge(&self, edge: Edge) -> Rigid {
        let home = self.chain.base_from_flange(&self.home);
        let along = match edge {
            Edge::P => Vec3::x(),
            Edge::Q => Vec3::y(),
        };
        let way = self.base_from_part(PartKind::Plate).rotation * ((along - Vec3::x()) * PLATE_AIM_MM);
        Translation3::from(way) * home
    }

    /// Where a part stands in place of the ball: level, and so that the line is on it at the first pose. A plate's edges are
    /// both within reach of its corner, and the line crosses them alike.
    #[must_use]
    pub fn base_from_part(&self, kind: PartKind) -> Rigid {
        let base_from_sensor = self.chain.base_from_flange(&self.home) * self.flange_from_sensor;
        let line = base_from_sensor.rotation * Vec3::x();
        let (halfway, aim) = match kind {
            PartKind::Plate => (FRAC_PI_4, Vec3::x() * PLATE_AIM_MM),
            PartKind::Pin | PartKind::Square | PartKind::Teeth | PartKind::Cylinder => (0.0, Vec3::zeros()),
        };
        let rotation = so3::exp(Vec3::z() * (line.y.atan2(line.x) - halfway));
        let aim_in_base = base_from_sensor.translation.vector;
        Rigid::from_parts((aim_in_base - rotation * aim).into(), rotation)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use nalgebra::UnitQuaternion;

    use super::super::chain::Unreachable;
    use super::super::motion::Way;
    use super::*;

    /// The widest stations that a plan asks for, 30° of tilt all around and 90° of turn either way, with what a rough
    /// mounting adds.
    const TILT_DEG: f64 = 33.0;
    const SPINS_DEG: [f64; 5] = [-90.0, -45.0, 0.0, 45.0, 90.0];
    const NUM_AZIMUTHS: u8 = 8;

    fn check(layout: &Layout, radius_mm: f64, orientation: UnitQuaternion<f64>) -> Result<(), Unreachable> {
        let home = layout.chain.base_from_flange(&layout.home);
        let rotation = home.rotation * layout.flange_from_sensor.rotation * orientation;
        let mut joints = layout.home;
        // There from home, then along the sweep from 0.6 R before the ball's middle to 0.6 R behind it.
        for offset in [0.6, -0.6] {
            let origin = layout.ball_in_base - rotation * (Vec3::new(0.0, offset, 0.6) * radius_mm);
            let base_from_sensor = Rigid::from_parts(Translation3::from(origin), rotation);
            let target = base_from_sensor * layout.flange_from_sensor.inverse();
            joints = Way::straight(&layout.chain, &joints, &target, &Rigid::identity())?.end();
        }
        Ok(())
    }

    #[test]
    fn stations_all_around_the_ball_are_reachable_on_straight_ways() {
        for (robot, head) in [RobotKind::FanucMappdk, RobotKind::UniversalRobots]
            .into_iter()
            .flat_map(|robot| Head::ALL.map(|head| (robot, head)))
        {
            let layout = Layout::new(robot, &head, 15.0);
            for azimuth in 0..NUM_AZIMUTHS {
                let (sin, cos) = (TAU * f64::from(azimuth) / f64::from(NUM_AZIMUTHS)).sin_cos();
                let tilt = so3::exp(Vec3::new(-sin, cos, 0.0) * TILT_DEG.to_radians());
                for spin_deg in SPINS_DEG {
                    let orientation = tilt * so3::exp(Vec3::z() * spin_deg.to_radians());
                    let outcome = check(&layout, 15.0, orientation);
                    assert_eq!(outcome, Ok(()), "{robot:?}, {}, azimuth {azimuth}, spin {spin_deg}°", head.id);
                }
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
