//! What is known about the nine unknowns, and what that means for a point in the workspace.

use nalgebra::{Matrix6, SMatrix};

use crate::calibrate::observation::NUM_UNKNOWNS;
use crate::calibrate::solver::{Hessian, Normal, covariance_for_unit_noise, unit_diagonal_scaling};
use crate::calibrate::uncertainty::point_by_sensor;
use crate::geometry::so3::hat;
use crate::geometry::{Mat3, Vec3};

/// Stations are chosen for the points about the workspace point, so far (mm) from it on average, not for that point alone:
/// a ball that is always seen there says nothing about a turn about it, and profiles are wider than a point.
const SPREAD_MM: f64 = 15.0;

/// The information about (rotation, translation; ball), and the point in the sensor frame that it is judged by.
#[derive(Clone, Copy, Debug)]
pub(super) struct Information {
    hessian: Hessian,
    /// Derivative of the point by the unknowns, transposed.
    point: SMatrix<f64, NUM_UNKNOWNS, 3>,
    /// The same with that of the points about it, whose mean variance is the sum over all columns.
    points: SMatrix<f64, NUM_UNKNOWNS, 6>,
}

impl Information {
    pub fn new(hessian: &Hessian, point_in_sensor: Vec3) -> Self {
        let mut point = SMatrix::<f64, NUM_UNKNOWNS, 3>::zeros();
        point.fixed_view_mut::<6, 3>(0, 0).copy_from(&point_by_sensor(point_in_sensor).transpose());
        let mut points = SMatrix::<f64, NUM_UNKNOWNS, 6>::zeros();
        points.fixed_view_mut::<NUM_UNKNOWNS, 3>(0, 0).copy_from(&point);
        // Over offsets r in all directions the mean of |ω × r|² is two thirds of |ω|² |r|².
        let turn = Mat3::identity() * (SPREAD_MM * (2.0_f64 / 3.0).sqrt());
        points.fixed_view_mut::<3, 3>(0, 3).copy_from(&turn);
        Self { hessian: *hessian, point, points }
    }

    /// With a station more.
    pub fn with(&self, station: &Hessian) -> Self {
        Self { hessian: self.hessian + station, ..*self }
    }

    /// Without what was only assumed.
    pub fn without(&self, assumed: &Hessian) -> Self {
        Self { hessian: self.hessian - assumed, ..*self }
    }

    /// σ of the point in three dimensions for unit noise; `None` if the information leaves a direction free.
    pub fn point_std(&self) -> Option<f64> {
        let covariance = covariance_for_unit_noise(&self.hessian).ok()?;
        let variance = (self.point.transpose() * covariance * self.point).trace();
        (variance.is_finite() && variance > 0.0).then(|| variance.sqrt())
    }

    /// The mean variance of the points about the workspace point with a station more.
    pub fn variance_with(&self, station: &Hessian) -> f64 {
        let hessian = self.hessian + station;
        let scaling = unit_diagonal_scaling(&hessian);
        (scaling * hessian * scaling)
            .cholesky()
            .and_then(|factor| factor.l().solve_lower_triangular(&(scaling * self.points)))
            .map_or(f64::INFINITY, |part| part.norm_squared())
    }
}

/// What a station's sums say about (rotation, translation).
pub(super) fn about_sensor(sums: &Normal) -> Matrix6<f64> {
    sums.hessian.fixed_view::<6, 6>(0, 0).into_owned()
}

/// What a station says about all unknowns, from what it says about (rotation, translation), at an orientation and with the
/// ball `shift` further off in the sensor frame.
///
/// From ds = s × ω − v + C db: a shifted ball is a shifted lever of the rotation, and the ball moves as the sensor does,
/// turned.
pub(super) fn information_at(about_sensor: &Matrix6<f64>, shift: Vec3, sensor_from_base: &Mat3) -> Hessian {
    let mut by_unknowns = SMatrix::<f64, 6, NUM_UNKNOWNS>::identity();
    by_unknowns.fixed_view_mut::<3, 3>(3, 0).copy_from(&-hat(shift));
    by_unknowns.fixed_view_mut::<3, 3>(3, 6).copy_from(&-sensor_from_base);
    by_unknowns.transpose() * about_sensor * by_unknowns
}

#[cfg(test)]
mod tests {
    use nalgebra::UnitQuaternion;

    use super::*;
    use crate::calibrate::observation::{CentreObservation, State};
    use crate::geometry::Rigid;

    #[test]
    fn a_station_brings_what_the_solver_would_sum_up() {
        let state = State {
            flange_from_sensor: Rigid::from_parts(
                Vec3::new(12.0, -3.0, 118.0).into(),
                UnitQuaternion::from_euler_angles(0.4, 0.1, -1.5),
            ),
            ball_in_base: Vec3::new(600.0, -40.0, 20.0),
        };
        let weights = [Mat3::new(2.0, 0.3, -0.2, 0.3, 1.0, 0.4, -0.2, 0.4, 3.0), Mat3::identity() * 7.0];
        let places = [Vec3::new(1.0, 9.0, 80.0), Vec3::new(1.5, -4.0, 81.0)];
        let shift = Vec3::new(3.0, 0.0, -6.0);
        let base_from_sensor = UnitQuaternion::from_euler_angles(3.0, 0.2, 0.7);
        let observations: Vec<CentreObservation> = places
            .iter()
            .zip(weights)
            .map(|(place, information)| {
                let origin = state.ball_in_base - base_from_sensor * (place + shift);
                let pose = Rigid::from_parts(origin.into(), base_from_sensor) * state.flange_from_sensor.inverse();
                CentreObservation { information, ..CentreObservation::point(0, pose, place + shift) }
            })
            .collect();
        let common = Mat3::identity() * 0.1;
        let summed = Normal::of(observations.iter(), &state).with_common_shift(&common).hessian;
        let still = observations.iter().zip(places).map(|(observation, place)| CentreObservation {
            base_from_flange: Rigid::translation(-place.x, -place.y, -place.z),
            ..observation.clone()
        });
        let at_origin = State { flange_from_sensor: Rigid::identity(), ball_in_base: Vec3::zeros() };
        let sums = Normal::of(still.collect::<Vec<_>>().iter(), &at_origin).with_common_shift(&common);
        let sensor_from_base = base_from_sensor.inverse().to_rotation_matrix().into_inner();
        let planned = information_at(&about_sensor(&sums), shift, &sensor_from_base);
        assert!((summed - planned).norm() < 1e-9 * summed.norm(), "{summed} {planned}");
    }
}
