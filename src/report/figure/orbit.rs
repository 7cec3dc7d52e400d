//! From where something in space is seen: from all sides, without perspective, z up.

use crate::geometry::Vec3;

/// A direction of view that goes round what is looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orbit {
    /// Turn of the eye about z from the x axis on, rad.
    yaw: f64,
    /// Height of the eye over the horizon, rad.
    pitch: f64,
}

impl Default for Orbit {
    /// From the front, the right and above.
    fn default() -> Self {
        Self::new(-0.6, 0.45)
    }
}

impl Orbit {
    /// From above.
    pub const ABOVE: Self = Self::new(-std::f64::consts::FRAC_PI_2, std::f64::consts::FRAC_PI_2);
    /// Along y.
    pub const FRONT: Self = Self::new(-std::f64::consts::FRAC_PI_2, 0.0);
    /// Along −x.
    pub const RIGHT: Self = Self::new(0.0, 0.0);

    /// The eye's turn about z and its height, rad.
    #[must_use]
    pub const fn new(yaw: f64, pitch: f64) -> Self {
        Self { yaw, pitch }
    }

    /// Goes round as if what is seen were dragged by so many points on the screen.
    pub fn turn(&mut self, [right, down]: [f32; 2]) {
        /// Radians a point: a drag across a picture is about half a turn.
        const TURN: f64 = 0.01;
        self.yaw = (self.yaw - f64::from(right) * TURN).rem_euclid(std::f64::consts::TAU);
        let top = std::f64::consts::FRAC_PI_2;
        self.pitch = (self.pitch + f64::from(down) * TURN).clamp(-top, top);
    }

    /// The directions to the right, up, and towards the eye.
    #[must_use]
    pub fn axes(&self) -> [Vec3; 3] {
        let ((sin_yaw, cos_yaw), (sin_pitch, cos_pitch)) = (self.yaw.sin_cos(), self.pitch.sin_cos());
        [
            Vec3::new(-sin_yaw, cos_yaw, 0.0),
            Vec3::new(-sin_pitch * cos_yaw, -sin_pitch * sin_yaw, cos_pitch),
            Vec3::new(cos_pitch * cos_yaw, cos_pitch * sin_yaw, sin_pitch),
        ]
    }

    /// A vector as seen: to the right, up, and towards the eye.
    #[must_use]
    pub fn seen(&self, vector: Vec3) -> Vec3 {
        let [right, up, towards] = self.axes();
        Vec3::new(right.dot(&vector), up.dot(&vector), towards.dot(&vector))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_are_perpendicular_and_z_points_up() {
        let mut orbit = Orbit::new(-0.9, 0.55);
        for drag in [[0.0, 0.0], [33.0, 21.0], [-700.0, 900.0], [5.0, -2000.0]] {
            orbit.turn(drag);
            let [right, up, towards] = orbit.axes();
            assert!((right.cross(&up) - towards).norm() < 1e-12);
            assert!(up.z >= 0.0);
        }
        let [right, up, _] = Orbit::ABOVE.axes();
        assert!((right - Vec3::x()).norm() < 1e-12 && (up - Vec3::y()).norm() < 1e-12, "{right} {up}");
        assert!((Orbit::FRONT.seen(Vec3::y()) + Vec3::z()).norm() < 1e-12);
        assert!((Orbit::RIGHT.seen(Vec3::x()) - Vec3::z()).norm() < 1e-12);
    }
}
