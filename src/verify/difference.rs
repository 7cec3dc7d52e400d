//! How far two calibrations are apart: in the flange, at points of the workspace, and against what they state of themselves.

use nalgebra::{Matrix6, SMatrix, Vector6};

use crate::geometry::so3::{self, hat};
use crate::geometry::{Flange, Mat3, Sensor, Transform, Vec3, stats};

/// A calibration, and how sure it says it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Stated {
    /// The calibration; `base_from_sensor` for a sensor beside the robot.
    pub flange_from_sensor: Transform<Flange, Sensor>,
    /// Covariance of (rotation about the sensor's axes in rad, translation along the flange's axes in mm), if it is known.
    pub covariance: Option<Matrix6<f64>>,
}

/// Whose covariance a comparison rests on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Known {
    /// Nobody's: nothing is known of what is chance.
    None,
    /// One of the two; the other counts as exact.
    One,
    /// Both; their errors are taken to be independent.
    Both,
    /// Both are from the same data: whatever they state, it is no doubt about their difference.
    SameData,
}

/// The second calibration less the first.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// Along the flange's axes, mm.
    pub translation_mm: Vec3,
    /// The rotation from the first to the second, about the flange's axes, rad.
    pub rotation_rad: Vec3,
    /// σ of the translation, mm.
    pub translation_std_mm: Option<Vec3>,
    /// σ of the rotation, rad.
    pub rotation_std_rad: Option<Vec3>,
    /// The probability of a difference as large, or larger, by chance alone.
    pub p_value: Option<f64>,
    /// What the σ rest on.
    pub known: Known,
}

/// Where a point that the sensor sees goes with the other calibration.
#[derive(Clone, Debug, PartialEq)]
pub struct PointShift {
    /// The point, mm.
    pub point_in_sensor_mm: Vec3,
    /// Along the flange's axes, mm.
    pub shift_mm: Vec3,
    /// σ of the shift along each of these axes, mm.
    pub std_mm: Option<Vec3>,
    /// The probability of a shift as large, or larger, by chance alone.
    pub p_value: Option<f64>,
}

/// Less likely than this by chance alone, a difference is one.
pub const SIGNIFICANT_P: f64 = 0.01;

impl Difference {
    /// The angle of the rotation, rad.
    #[must_use]
    pub fn angle_rad(&self) -> f64 {
        self.rotation_rad.norm()
    }

    /// The axis of the rotation in the flange; `None` where there is none.
    #[must_use]
    pub fn axis(&self) -> Option<Vec3> {
        self.rotation_rad.try_normalize(1e-12)
    }
}

/// The covariance of both, in (rotation about the first one's sensor axes, translation): of small differences it is the sum.
fn combined(from: &Stated, to: &Stated) -> (Option<Matrix6<f64>>, Known) {
    match (&from.covariance, &to.covariance) {
        (Some(first), Some(second)) => {
            // The second's rotation is about its own sensor's axes.
            let turn = from.flange_from_sensor.rotation().inverse() * to.flange_from_sensor.rotation();
            let mut to_first = Matrix6::identity();
            to_first.fixed_view_mut::<3, 3>(0, 0).copy_from(turn.to_rotation_matrix().matrix());
            (Some(first + to_first * second * to_first.transpose()), Known::Both)
        }
        (Some(only), None) | (None, Some(only)) => (Some(*only), Known::One),
        (None, None) => (None, Known::None),
    }
}

/// Compares two calibrations.
#[must_use]
pub fn difference(from: &Stated, to: &Stated) -> Difference {
    let (a, b) = (&from.flange_from_sensor, &to.flange_from_sensor);
    let translation_mm = b.translation_mm() - a.translation_mm();
    let in_sensor_rad = so3::log(&(a.rotation().inverse() * b.rotation()));
    let (covariance, known) = combined(from, to);
    let turn = *a.rotation().to_rotation_matrix().matrix();
    let mut change = Vector6::zeros();
    change.fixed_rows_mut::<3>(0).copy_from(&in_sensor_rad);
    change.fixed_rows_mut::<3>(3).copy_from(&translation_mm);
    Difference {
        translation_mm,
        rotation_rad: turn * in_sensor_rad,
        translation_std_mm: covariance.map(|c| std(&c.fixed_view::<3, 3>(3, 3).into_owned())),
        rotation_std_rad: covariance.map(|c| std(&(turn * c.fixed_view::<3, 3>(0, 0) * turn.transpose()))),
        p_value: covariance.and_then(|c| p_value(&c, &change)),
        known,
    }
}

/// Compares what two calibrations make of a point that the sensor sees, at one and the same pose of the flange.
#[must_use]
pub fn point_shift(from: &Stated, to: &Stated, point_in_sensor_mm: Vec3) -> PointShift {
    let (a, b) = (&from.flange_from_sensor, &to.flange_from_sensor);
    let shift_mm = b.map_point(point_in_sensor_mm) - a.map_point(point_in_sensor_mm);
    let covariance = combined(from, to).0.map(|covariance| {
        let mut by_calibration = SMatrix::<f64, 3, 6>::zeros();
        let by_rotation = -(a.rotation().to_rotation_matrix().matrix() * hat(point_in_sensor_mm));
        by_calibration.fixed_view_mut::<3, 3>(0, 0).copy_from(&by_rotation);
        by_calibration.fixed_view_mut::<3, 3>(0, 3).copy_from(&Mat3::identity());
        by_calibration * covariance * by_calibration.transpose()
    });
    PointShift {
        point_in_sensor_mm,
        shift_mm,
        std_mm: covariance.as_ref().map(std),
        p_value: covariance.and_then(|covariance| p_value(&covariance, &shift_mm)),
    }
}

fn std(covariance: &Mat3) -> Vec3 {
    covariance.diagonal().map(|variance| variance.max(0.0).sqrt())
}

/// `None` of a covariance that is none. The doubt in the noise is in the covariances themselves, hence χ².
fn p_value<const N: usize>(covariance: &SMatrix<f64, N, N>, change: &nalgebra::SVector<f64, N>) -> Option<f64> {
    let cholesky = nalgebra::linalg::Cholesky::new(*covariance)?;
    let root = cholesky.l().solve_lower_triangular(change)?;
    let squared = root.norm_squared();
    // N is 3 or 6.
    #[expect(clippy::cast_precision_loss, reason = "see above")]
    let p_value = stats::chi_squared_p_value(squared, N as f64);
    (squared.is_finite() && p_value.is_finite()).then_some(p_value)
}

#[cfg(test)]
mod tests {
    use nalgebra::UnitQuaternion;

    use super::*;

    fn stated(translation: [f64; 3], rotation: [f64; 3], std: Option<[f64; 2]>) -> Stated {
        let rotation: UnitQuaternion<f64> = so3::exp(Vec3::from(rotation));
        let variances =
            |[rad, mm]: [f64; 2]| Matrix6::from_diagonal(&Vector6::new(rad, rad, rad, mm, mm, mm).map(|std| std * std));
        Stated {
            flange_from_sensor: Transform::from_parts(Vec3::from(translation), rotation),
            covariance: std.map(variances),
        }
    }

    #[test]
    fn a_known_change_comes_back_along_the_axes_of_the_flange() {
        let a = stated([10.0, 20.0, 130.0], [0.3, -2.0, 0.5], None);
        let turn = Vec3::new(0.0, 1e-3, 0.0);
        let b = Stated {
            flange_from_sensor: Transform::from_parts(
                Vec3::new(10.1, 20.0, 129.8),
                so3::exp(turn) * a.flange_from_sensor.rotation(),
            ),
            covariance: None,
        };
        let found = difference(&a, &b);
        assert!((found.translation_mm - Vec3::new(0.1, 0.0, -0.2)).norm() < 1e-12);
        assert!((found.rotation_rad - turn).norm() < 1e-12 && (found.angle_rad() - 1e-3).abs() < 1e-12);
        assert_eq!((found.p_value, found.known), (None, Known::None));
        let back = difference(&b, &a);
        assert!((back.rotation_rad + turn).norm() < 1e-12);
        assert_eq!(difference(&a, &a).axis(), None);
        let point = Vec3::new(5.0, 0.0, 60.0);
        let shift = point_shift(&a, &b, point);
        let expected = b.flange_from_sensor.map_point(point) - a.flange_from_sensor.map_point(point);
        assert!((shift.shift_mm - expected).norm() < 1e-12 && shift.std_mm.is_none());
    }

    #[test]
    fn what_chance_explains_is_not_significant_and_what_it_does_not_is() {
        let a = stated([0.0; 3], [0.0; 3], Some([1e-4, 0.01]));
        let near = stated([0.01, -0.01, 0.0], [0.0, 1e-4, 0.0], Some([1e-4, 0.01]));
        let far = stated([0.2, 0.0, 0.0], [0.0; 3], Some([1e-4, 0.01]));
        let p = |other: &Stated| difference(&a, other).p_value.expect("both are known");
        assert!(p(&near) > 0.5 && p(&far) < 1e-6, "{} {}", p(&near), p(&far));
        let found = difference(&a, &far);
        let both = Vec3::repeat(0.01 * 2.0_f64.sqrt());
        assert!((found.translation_std_mm.expect("known") - both).norm() < 1e-12);
        assert_eq!(difference(&a, &stated([0.0; 3], [0.0; 3], None)).known, Known::One);
        // 60 mm away the rotation adds 60 mm · 0.1 mrad · √2 across.
        let shift = point_shift(&a, &far, Vec3::new(0.0, 0.0, 60.0));
        let std = shift.std_mm.expect("known");
        assert!((std.x - both.x.hypot(60.0 * 1e-4 * 2.0_f64.sqrt())).abs() < 1e-9 && (std.z - both.z).abs() < 1e-12);
        let broken = Stated { covariance: Some(Matrix6::from_element(f64::NAN)), ..a.clone() };
        assert_eq!(difference(&broken, &far).p_value, None);
    }
}
