//! A rough mounting as a person says it: what the sensor looks along, and how its line lies.

use nalgebra::{Matrix3, Rotation3, UnitQuaternion};

use crate::app::cell::RoughMounting;
use crate::geometry::Vec3;

/// Names of the six directions of a frame's axes, in the order of [`direction`].
pub const DIRECTIONS: [&str; 6] = ["+x", "−x", "+y", "−y", "+z", "−z"];

/// The direction of a name.
#[must_use]
pub fn direction(idx: usize) -> Vec3 {
    let mut direction = Vec3::zeros();
    direction[(idx / 2).min(2)] = if idx.is_multiple_of(2) { 1.0 } else { -1.0 };
    direction
}

/// The name that a direction is nearest to, if it is along an axis to within a degree.
#[must_use]
pub fn name_of(wanted: Vec3) -> Option<usize> {
    let wanted = wanted.try_normalize(0.0)?;
    let least = 1.0_f64.to_radians().cos();
    (0..DIRECTIONS.len()).find(|idx| direction(*idx).dot(&wanted) > least)
}

/// A mounting that is being typed: no number of it is made up.
#[derive(Clone, Debug, PartialEq)]
pub struct MountingDraft {
    /// Its axes; where it is does not count.
    pub axes: RoughMounting,
    /// Where it is in the flange, as typed.
    pub place_mm: [String; 3],
}

impl Default for MountingDraft {
    /// Looking along the flange's z, the line along its x, nowhere yet.
    fn default() -> Self {
        let axes = RoughMounting { translation_mm: [0.0; 3], quaternion_wxyz: [1.0, 0.0, 0.0, 0.0] };
        Self { axes, place_mm: Default::default() }
    }
}

impl MountingDraft {
    /// The mounting, once all of its numbers are typed.
    #[must_use]
    pub fn typed(&self) -> Option<RoughMounting> {
        let mut translation_mm = [0.0; 3];
        for (value, text) in translation_mm.iter_mut().zip(&self.place_mm) {
            let text = text.trim().replace('−', "-").replace(',', ".");
            *value = text.parse::<f64>().ok().filter(|value| value.abs() <= FURTHEST_MM)?;
        }
        Some(RoughMounting { translation_mm, ..self.axes })
    }
}

/// No sensor is mounted further from the flange, mm.
pub const FURTHEST_MM: f64 = 2000.0;

/// The rotation `flange_from_sensor` of a mounting; none for a quaternion without length.
#[must_use]
pub fn rotation(mounting: &RoughMounting) -> UnitQuaternion<f64> {
    let [w, x, y, z] = mounting.quaternion_wxyz;
    UnitQuaternion::try_new(nalgebra::Quaternion::new(w, x, y, z), 1e-9).unwrap_or_default()
}

/// What the sensor looks along, and how its line lies, in the flange.
#[must_use]
pub fn look_and_line(mounting: &RoughMounting) -> [Vec3; 2] {
    let rotation = rotation(mounting);
    [rotation * Vec3::z(), rotation * Vec3::x()]
}

/// Turned so that the sensor looks along `look`; the line lies as nearly along `line` as that allows.
#[must_use]
pub fn turned(mounting: RoughMounting, look: Vec3, line: Vec3) -> RoughMounting {
    let z = look.try_normalize(0.0).unwrap_or_else(Vec3::z);
    let across = line - z * z.dot(&line);
    // A line along the view is none: any other axis will do until the user says which.
    let other = || {
        let axis = if z.x.abs() < 0.5 { Vec3::x() } else { Vec3::y() };
        axis - z * z.dot(&axis)
    };
    let x = across.try_normalize(1e-6).unwrap_or_else(|| other().normalize());
    let y = z.cross(&x);
    let rotation = Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[x, y, z]));
    with_rotation(mounting, &UnitQuaternion::from_rotation_matrix(&rotation))
}

/// The same place, another rotation.
#[must_use]
pub fn with_rotation(mounting: RoughMounting, rotation: &UnitQuaternion<f64>) -> RoughMounting {
    RoughMounting { quaternion_wxyz: [rotation.w, rotation.i, rotation.j, rotation.k], ..mounting }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pair_of_axes_gives_a_rotation_that_says_so() {
        for look in 0..6 {
            for line in 0..6 {
                let mounting = turned(MountingDraft::default().axes, direction(look), direction(line));
                let [seen_look, seen_line] = look_and_line(&mounting);
                assert_eq!(name_of(seen_look), Some(look));
                let seen_line = name_of(seen_line).expect("along an axis");
                if look / 2 == line / 2 {
                    assert_ne!(seen_line / 2, look / 2, "a line along the view is none");
                } else {
                    assert_eq!(seen_line, line);
                }
                let norm: f64 = mounting.quaternion_wxyz.iter().map(|part| part * part).sum();
                assert!((norm - 1.0).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn a_mounting_is_none_until_all_of_it_is_typed() {
        let mut draft = MountingDraft::default();
        for (idx, text) in ["12,5", "−3", " 90 "].into_iter().enumerate() {
            assert_eq!(draft.typed(), None);
            draft.place_mm[idx] = text.to_owned();
        }
        let expected = RoughMounting { translation_mm: [12.5, -3.0, 90.0], ..draft.axes };
        assert_eq!(draft.typed(), Some(expected));
        for wrong in ["", "far", "NaN", "1e9"] {
            draft.place_mm[1] = wrong.to_owned();
            assert_eq!(draft.typed(), None, "{wrong}");
        }
    }

    #[test]
    fn an_oblique_mounting_has_no_name() {
        assert_eq!(name_of(Vec3::new(1.0, 0.3, 0.0)), None);
        assert_eq!(name_of(Vec3::zeros()), None);
    }
}
