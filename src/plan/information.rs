//! What is known about the unknowns, and what that means for a point in the workspace.

use nalgebra::{SMatrix, SVector};

use crate::calibrate::plate::descent::inverse_of;
use crate::calibrate::uncertainty::point_by_sensor;
use crate::geometry::{Mat3, Vec3};

/// Stations are chosen for the points about the workspace point, so far (mm) from it on average, not for that point alone:
/// a ball that is always seen there says nothing about a turn about it, and profiles are wider than a point.
const SPREAD_MM: f64 = 15.0;

/// The information about the unknowns, of which the sensor's rotation and translation come first, and the point in the
/// sensor frame that it is judged by.
#[derive(Clone, Copy, Debug)]
pub(super) struct Information<const N: usize> {
    hessian: SMatrix<f64, N, N>,
    /// Derivative of the point by the unknowns, transposed.
    point: SMatrix<f64, N, 3>,
    /// The same with that of the points about it, whose mean variance is the sum over all columns.
    points: SMatrix<f64, N, 6>,
}

impl<const N: usize> Information<N> {
    pub fn new(hessian: &SMatrix<f64, N, N>, point_in_sensor: Vec3) -> Self {
        let mut point = SMatrix::<f64, N, 3>::zeros();
        point.view_mut((0, 0), (6, 3)).copy_from(&point_by_sensor(point_in_sensor).transpose());
        let mut points = SMatrix::<f64, N, 6>::zeros();
        points.view_mut((0, 0), (N, 3)).copy_from(&point);
        // Over offsets r in all directions the mean of |ω × r|² is two thirds of |ω|² |r|².
        let turn = Mat3::identity() * (SPREAD_MM * (2.0_f64 / 3.0).sqrt());
        points.fixed_view_mut::<3, 3>(0, 3).copy_from(&turn);
        Self { hessian: *hessian, point, points }
    }

    /// With a station more.
    pub fn with(&self, station: &SMatrix<f64, N, N>) -> Self {
        Self { hessian: self.hessian + station, ..*self }
    }

    /// Without what was only assumed.
    pub fn without(&self, assumed: &SMatrix<f64, N, N>) -> Self {
        Self { hessian: self.hessian - assumed, ..*self }
    }

    /// σ of the point in three dimensions for unit noise; `None` if the information leaves a direction free.
    pub fn point_std(&self) -> Option<f64> {
        let covariance = inverse_of(&self.hessian).ok()?;
        let variance = (self.point.transpose() * covariance * self.point).trace();
        (variance.is_finite() && variance > 0.0).then(|| variance.sqrt())
    }

    /// The mean variance of the points about the workspace point with a station more.
    pub fn variance_with(&self, station: &SMatrix<f64, N, N>) -> f64 {
        let mut hessian = self.hessian + station;
        let scaling: SVector<f64, N> =
            hessian.diagonal().map(|information| if information > 0.0 { information.sqrt().recip() } else { 1.0 });
        let mut points = self.points;
        for row in 0..N {
            hessian.row_mut(row).component_mul_assign(&(scaling * scaling[row]).transpose());
            points.row_mut(row).scale_mut(scaling[row]);
        }
        hessian
            .cholesky()
            .and_then(|factor| factor.l().solve_lower_triangular(&points))
            .map_or(f64::INFINITY, |part| part.norm_squared())
    }
}
