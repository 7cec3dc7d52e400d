//! From the covariance of the unknowns to the figures that people read.

use nalgebra::{Matrix6, SMatrix, Vector6};

use crate::geometry::so3::hat;
use crate::geometry::{Mat3, Rigid, Vec3, stats};

use super::ball::VarianceSpread;
use super::observation::NUM_UNKNOWNS;
use super::solution::Uncertainty;
use super::solver::{Gradient, Hessian, sensor_block};

/// How the inverse of the normal equations becomes a covariance, and how well that is known.
#[derive(Clone, Debug, PartialEq)]
pub enum Spread {
    /// All observations weigh the same; what they scatter by sets the scale.
    Scaled {
        /// Factor on the inverse.
        factor: f64,
        /// Equations left over.
        degrees_of_freedom: f64,
    },
    /// The weights are those of the noise, stated or estimated.
    Modelled(Box<VarianceSpread>),
}

impl Spread {
    /// Factor on the inverse of the normal equations.
    #[must_use]
    pub const fn factor(&self) -> f64 {
        match self {
            Self::Scaled { factor, .. } => *factor,
            Self::Modelled(_) => 1.0,
        }
    }
}

/// The figures for the inverse of the normal equations: unknowns (rotation, translation; ball), the first two as a right
/// perturbation along the sensor's axes.
///
/// `reference_point_in_sensor_mm` is the point whose standard deviation is the headline; `by_radius` is the change of the
/// unknowns with one standard deviation of the ball's radius.
#[must_use]
pub fn uncertainty(
    inverse: &Hessian,
    spread: &Spread,
    by_radius: &Gradient,
    flange_from_sensor: &Rigid,
    reference_point_in_sensor_mm: Vec3,
) -> Uncertainty {
    let by_sensor = point_by_sensor(reference_point_in_sensor_mm);
    let degrees_of_freedom = match spread {
        Spread::Scaled { degrees_of_freedom, .. } => *degrees_of_freedom,
        Spread::Modelled(spread) => {
            let mut by_unknowns = SMatrix::<f64, 3, NUM_UNKNOWNS>::zeros();
            by_unknowns.fixed_view_mut::<3, 6>(0, 0).copy_from(&by_sensor);
            spread.degrees_of_freedom(inverse, &by_unknowns)
        }
    };
    let factor = spread.factor() * doubt_in_the_noise(degrees_of_freedom);
    let right_covariance = sensor_block(&(inverse * factor + by_radius * by_radius.transpose()));
    of_sensor(&right_covariance, degrees_of_freedom, flange_from_sensor, reference_point_in_sensor_mm)
}

/// The figures for a covariance of (rotation, translation) of the sensor, a right perturbation along the sensor's axes, in
/// which the doubt in the noise itself is counted ([`doubt_in_the_noise`]).
pub(crate) fn of_sensor(
    right_covariance: &Matrix6<f64>,
    degrees_of_freedom: f64,
    flange_from_sensor: &Rigid,
    reference_point_in_sensor_mm: Vec3,
) -> Uncertainty {
    let by_sensor = point_by_sensor(reference_point_in_sensor_mm);
    let to_flange_axes = to_flange_axes(flange_from_sensor);
    let covariance = to_flange_axes * right_covariance * to_flange_axes.transpose();
    let std = |idx: usize| covariance[(idx, idx)].max(0.0).sqrt();
    let point_covariance = by_sensor * right_covariance * by_sensor.transpose();
    let rotation = flange_from_sensor.rotation.to_rotation_matrix();
    Uncertainty {
        covariance,
        translation_std_mm: Vec3::new(std(3), std(4), std(5)),
        rotation_std_rad: Vec3::new(std(0), std(1), std(2)),
        workspace_point_std_mm: point_covariance.trace().max(0.0).sqrt(),
        reference_point_in_sensor_mm,
        workspace_point_covariance: rotation.matrix() * point_covariance * rotation.matrix().transpose(),
        degrees_of_freedom,
        // The quantile carries the doubt in the noise itself.
        workspace_point_95_mm: distance_quantile(
            0.95,
            &(point_covariance / doubt_in_the_noise(degrees_of_freedom)),
            degrees_of_freedom,
        ),
    }
}

impl Uncertainty {
    /// The same with what one more unknown may be off by: `change` is that of the sensor with one standard deviation of it, a right
    /// perturbation along the sensor's axes.
    pub(crate) fn with_change(&self, change: &Vector6<f64>, flange_from_sensor: &Rigid) -> Self {
        let to_sensor_axes = to_flange_axes(flange_from_sensor).transpose();
        let right_covariance =
            to_sensor_axes * self.covariance * to_sensor_axes.transpose() + change * change.transpose();
        of_sensor(&right_covariance, self.degrees_of_freedom, flange_from_sensor, self.reference_point_in_sensor_mm)
    }
}

/// By how much errors vary more where the noise was learnt from the same data: the variance of Student's t.
pub(crate) fn doubt_in_the_noise(degrees_of_freedom: f64) -> f64 {
    /// With less the variance is unbounded; twice as much is as good as "hardly known".
    const LEAST: f64 = 4.0;
    if degrees_of_freedom.is_infinite() {
        return 1.0;
    }
    let freedom = degrees_of_freedom.max(LEAST);
    freedom / (freedom - 2.0)
}

/// The change of a calibration with the radius: of (rotation about the sensor's axes in rad, translation along the flange's
/// axes in mm), and of a point given in the sensor frame along the flange's axes, all a mm of radius.
#[must_use]
pub fn change_by_radius(
    by_radius: &Gradient,
    flange_from_sensor: &Rigid,
    point_in_sensor_mm: Vec3,
) -> (Vector6<f64>, Vec3) {
    let of_sensor: Vector6<f64> = by_radius.fixed_rows::<6>(0).into_owned();
    let of_point = flange_from_sensor.rotation * (point_by_sensor(point_in_sensor_mm) * of_sensor);
    (to_flange_axes(flange_from_sensor) * of_sensor, of_point)
}

fn to_flange_axes(flange_from_sensor: &Rigid) -> Matrix6<f64> {
    let mut to_flange_axes = Matrix6::identity();
    to_flange_axes.fixed_view_mut::<3, 3>(3, 3).copy_from(flange_from_sensor.rotation.to_rotation_matrix().matrix());
    to_flange_axes
}

/// The distance from the mean that a normal vector with this covariance keeps within with a probability.
///
/// The square is a sum of three squares of unequal size; a single scaled χ² with the same mean and variance stands for it
/// (Satterthwaite), and F where the covariance itself rests on few degrees of freedom. Good to a per cent or two.
#[must_use]
pub fn distance_quantile(probability: f64, covariance: &Mat3, degrees_of_freedom: f64) -> f64 {
    let mean = covariance.trace();
    let squares = covariance.dot(covariance);
    if !(mean > 0.0 && squares > 0.0) {
        return 0.0;
    }
    let effective = mean * mean / squares;
    (mean * stats::f_quantile(probability, effective, degrees_of_freedom)).sqrt()
}

/// Derivative of a point given in the sensor frame by (rotation, translation), along the sensor's axes: dp = v − p × ω.
pub(crate) fn point_by_sensor(point_in_sensor_mm: Vec3) -> SMatrix<f64, 3, 6> {
    let mut derivative = SMatrix::<f64, 3, 6>::zeros();
    derivative.fixed_view_mut::<3, 3>(0, 0).copy_from(&-hat(point_in_sensor_mm));
    derivative.fixed_view_mut::<3, 3>(0, 3).copy_from(&Mat3::identity());
    derivative
}
