//! Two calibrations side by side: how they differ, and which is better by how much.

use crate::calibrate::Solution;
use crate::geometry::Vec3;

/// The difference between two calibrations of the same sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference {
    /// Second minus first translation, along the flange's axes, mm.
    pub translation_mm: Vec3,
    /// Angle between the two orientations, rad.
    pub rotation_rad: f64,
    /// How far apart the two put the workspace point, mm.
    pub workspace_point_mm: f64,
    /// That distance over its standard deviation, taking the two as independent; `None` without both uncertainties.
    pub in_stds: Option<f64>,
}

/// How `second` differs from `first`.
#[must_use]
pub fn difference(first: &Solution, second: &Solution) -> Difference {
    let (first_transform, second_transform) = (&first.flange_from_sensor, &second.flange_from_sensor);
    let reference_point = second
        .uncertainty
        .as_ref()
        .or(first.uncertainty.as_ref())
        .map_or_else(Vec3::zeros, |uncertainty| uncertainty.reference_point_in_sensor_mm);
    let workspace_point_mm =
        (second_transform.map_point(reference_point) - first_transform.map_point(reference_point)).norm();
    let in_stds = first.uncertainty.as_ref().zip(second.uncertainty.as_ref()).map(|(a, b)| {
        workspace_point_mm / a.workspace_point_std_mm.hypot(b.workspace_point_std_mm).max(f64::MIN_POSITIVE)
    });
    Difference {
        translation_mm: second_transform.translation_mm() - first_transform.translation_mm(),
        rotation_rad: first_transform.rotation().angle_to(&second_transform.rotation()),
        workspace_point_mm,
        in_stds,
    }
}
