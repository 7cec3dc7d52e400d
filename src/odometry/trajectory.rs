//! Distance and direction of a vehicle: how far the camera has come, and how it has turned.
//!
//! The vertical is the y axis of the camera at the first frame, which is mounted level: y points down. The heading is the
//! direction of the optical axis in the plane across it, against that at the first frame; positive to the right, as a compass
//! counts. The turn is the sum of its changes: after a full circle 360°, where the heading is 0 again.

use std::f64::consts::{PI, TAU};

use crate::geometry::{Sensor, Transform, Vec3, World};

/// How far a camera has come.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Travel {
    /// Length of its path, mm.
    pub distance_mm: f64,
    /// Direction in which it looks, against the first; positive to the right, from −π to π.
    pub heading_rad: f64,
    /// Sum of the changes of the heading.
    pub turn_rad: f64,
}

/// Adds up the way from pose to pose.
#[derive(Clone, Debug, Default)]
pub struct Odometer {
    first: Option<Transform<World, Sensor>>,
    last_position_mm: Vec3,
    travel: Travel,
}

impl Odometer {
    /// Takes the next pose. A step over a gap is no way that was travelled: it is not known.
    pub fn advance(&mut self, world_from_sensor: &Transform<World, Sensor>, is_after_gap: bool) -> Travel {
        let position_mm = world_from_sensor.translation_mm();
        let first = *self.first.get_or_insert_with(|| {
            self.last_position_mm = position_mm;
            *world_from_sensor
        });
        if !is_after_gap {
            self.travel.distance_mm += (position_mm - self.last_position_mm).norm();
        }
        self.last_position_mm = position_mm;
        let forward = first.rotation().inverse() * (world_from_sensor.rotation() * Vec3::z());
        // Looking straight up or down there is no heading: the last one stays.
        if forward.x.hypot(forward.z) > 1e-6 {
            let heading_rad = forward.x.atan2(forward.z);
            self.travel.turn_rad += wrapped(heading_rad - self.travel.heading_rad);
            self.travel.heading_rad = heading_rad;
        }
        self.travel
    }

    /// How far it has come.
    #[must_use]
    pub const fn travel(&self) -> Travel {
        self.travel
    }
}

/// An angle within −π to π.
fn wrapped(angle: f64) -> f64 {
    (angle + PI).rem_euclid(TAU) - PI
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::UnitQuaternion;

    #[test]
    fn once_around_a_square_to_the_right() {
        let mut odometer = Odometer::default();
        let start = UnitQuaternion::from_euler_angles(0.2, 0.1, -0.3);
        let mut position = Vec3::new(100.0, 50.0, -20.0);
        let mut heading: f64 = 0.0;
        let pose = |position, heading: f64| {
            let turn = UnitQuaternion::from_axis_angle(&Vec3::y_axis(), heading);
            Transform::from_parts(position, start * turn)
        };
        odometer.advance(&pose(position, heading), false);
        for _ in 0..4 {
            position +=
                start * (UnitQuaternion::from_axis_angle(&Vec3::y_axis(), heading) * Vec3::new(0.0, 0.0, 500.0));
            odometer.advance(&pose(position, heading), false);
            heading += 30_f64.to_radians();
            for _ in 0..2 {
                odometer.advance(&pose(position, heading), false);
                heading += 30_f64.to_radians();
            }
            odometer.advance(&pose(position, heading), false);
        }
        let travel = odometer.travel();
        assert!((travel.distance_mm - 2000.0).abs() < 1e-9, "{travel:?}");
        assert!((travel.turn_rad - TAU).abs() < 1e-9 && travel.heading_rad.abs() < 1e-9, "{travel:?}");
        let far = pose(position + Vec3::new(1e3, 0.0, 0.0), heading);
        assert!((odometer.advance(&far, true).distance_mm - 2000.0).abs() < 1e-9);
    }
}
