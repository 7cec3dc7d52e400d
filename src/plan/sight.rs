//! Whether the ball is sure to be seen from a pose, as long as the mounting is only roughly known.

use nalgebra::SMatrix;

use crate::calibrate::observation::NUM_UNKNOWNS;
use crate::calibrate::solver::Hessian;
use crate::geometry::so3::hat;
use crate::geometry::{Mat3, Vec3};

/// So many standard deviations of where the ball will be have to lie within the view.
const SURE_AT_STDS: f64 = 2.0;

/// What is known of (rotation, translation; ball), and where the ball may be.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sight {
    pub covariance: Hessian,
    /// The middle of where the ball's centre may be in the sensor frame, mm, and ...
    pub middle: Vec3,
    /// ... how far it may be off.
    pub half: Vec3,
}

impl Sight {
    /// Whether a ball that is meant to be at a place is sure to be in view.
    ///
    /// From ds = s × ω − v + C db with C = `sensor_from_base`.
    pub fn sees(&self, ball_in_sensor: Vec3, sensor_from_base: &Mat3) -> bool {
        let mut by_unknowns = SMatrix::<f64, 3, NUM_UNKNOWNS>::zeros();
        by_unknowns.fixed_view_mut::<3, 3>(0, 0).copy_from(&hat(ball_in_sensor));
        by_unknowns.fixed_view_mut::<3, 3>(0, 3).copy_from(&-Mat3::identity());
        by_unknowns.fixed_view_mut::<3, 3>(0, 6).copy_from(sensor_from_base);
        let variance = (by_unknowns * self.covariance * by_unknowns.transpose()).diagonal();
        let std_mm = variance.map(|v| v.max(0.0).sqrt());
        let off = (ball_in_sensor - self.middle).abs() + std_mm * SURE_AT_STDS;
        (0..3).all(|axis| off[axis] <= self.half[axis])
    }
}
