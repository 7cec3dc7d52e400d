//! How a robot, a spreadsheet or another program writes a whole pose as numbers: units, order, frame and direction.

use nalgebra::{Quaternion, UnitQuaternion};
use thiserror::Error;

use super::{Base, Flange, PoseConvention, Tcp, Transform, Vec3};

/// Unit of the angles of a pose.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AngleUnit {
    /// Degrees.
    #[default]
    Degrees,
    /// Radians.
    Radians,
}

impl AngleUnit {
    /// Degrees in one unit.
    #[must_use]
    pub fn in_degrees(self) -> f64 {
        match self {
            Self::Degrees => 1.0,
            Self::Radians => 1.0_f64.to_degrees(),
        }
    }

    /// As it stands behind a number.
    #[must_use]
    pub const fn symbol(self) -> &'static str {
        match self {
            Self::Degrees => "°",
            Self::Radians => "rad",
        }
    }
}

/// Unit of the position of a pose.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LengthUnit {
    /// Millimetres.
    #[default]
    Millimetres,
    /// Metres.
    Metres,
}

impl LengthUnit {
    /// Millimetres in one unit.
    #[must_use]
    pub const fn in_mm(self) -> f64 {
        match self {
            Self::Millimetres => 1.0,
            Self::Metres => 1000.0,
        }
    }

    /// As it stands behind a number.
    #[must_use]
    pub const fn symbol(self) -> &'static str {
        match self {
            Self::Millimetres => "mm",
            Self::Metres => "m",
        }
    }
}

/// What stands after the position.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OrientationForm {
    /// Three angles, as [`PoseNotation::convention`] has them.
    #[default]
    Angles,
    /// A unit quaternion, the real part first.
    QuaternionWxyz,
    /// A unit quaternion, the real part last.
    QuaternionXyzw,
}

/// As [`PoseNotation::text`] names the forms and units of angles, in their order.
const FORM_NAMES: [&str; 3] = ["angles", "quaternion-wxyz", "quaternion-xyzw"];
const ANGLE_UNIT_NAMES: [&str; 2] = ["deg", "rad"];

/// How a pose stands as six or seven numbers: three for the position, then those of the orientation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseNotation {
    /// How three angles make a rotation; kept even while the orientation is written as a quaternion.
    pub convention: &'static PoseConvention,
    /// What stands after the position.
    pub orientation: OrientationForm,
    /// Of the angles.
    pub angle_unit: AngleUnit,
    /// Of the position.
    pub length_unit: LengthUnit,
    /// Where the numbers are those of a tool point, its frame in the flange; `None` if they are the flange's own.
    pub flange_from_tcp: Option<Transform<Flange, Tcp>>,
    /// Whether the numbers are those of the base in the flange (or tool point) instead.
    pub is_inverse: bool,
}

impl Default for PoseNotation {
    fn default() -> Self {
        Self::of(PoseConvention::default_convention())
    }
}

/// Why numbers are not a pose.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum NotAPose {
    /// Too few or too many.
    #[error("found {found} numbers, needed {needed} for a pose")]
    Count {
        /// How many there are.
        found: usize,
        /// How many there must be.
        needed: usize,
    },
    /// NaN or infinite.
    #[error("found a number that is not finite, needed a finite one")]
    NotFinite,
    /// Four numbers that are no rotation.
    #[error("found a quaternion of norm {norm:.4}, needed norm 1 within {tolerance}")]
    QuaternionNorm {
        /// Its norm.
        norm: f64,
        /// How far off it may be.
        tolerance: f64,
    },
}

/// Off unit norm by more, a quaternion is not a rounded one but a mistake.
pub const QUATERNION_NORM_TOLERANCE: f64 = 1e-3;

impl PoseNotation {
    /// The flange in the base, millimetres and degrees, in a maker's angles.
    #[must_use]
    pub const fn of(convention: &'static PoseConvention) -> Self {
        Self {
            convention,
            orientation: OrientationForm::Angles,
            angle_unit: AngleUnit::Degrees,
            length_unit: LengthUnit::Millimetres,
            flange_from_tcp: None,
            is_inverse: false,
        }
    }

    /// The flange in the base as the maker's pendant shows it.
    #[must_use]
    pub const fn usual(convention: &'static PoseConvention) -> Self {
        Self { angle_unit: convention.usual_angle_unit, ..Self::of(convention) }
    }

    /// Whether the angles written are those of the flange in the base: then they can be kept beside the rotation.
    #[must_use]
    pub fn writes_angles_of_the_flange(&self) -> bool {
        self.orientation == OrientationForm::Angles && self.flange_from_tcp.is_none() && !self.is_inverse
    }

    /// The names of the numbers of the orientation, as on the teach pendant.
    #[must_use]
    pub fn orientation_names(&self) -> &'static [&'static str] {
        match self.orientation {
            OrientationForm::Angles => &self.convention.angle_names,
            OrientationForm::QuaternionWxyz => &["qw", "qx", "qy", "qz"],
            OrientationForm::QuaternionXyzw => &["qx", "qy", "qz", "qw"],
        }
    }

    /// How many numbers a pose has: six, or seven with a quaternion.
    #[must_use]
    pub fn num_numbers(&self) -> usize {
        3 + self.orientation_names().len()
    }

    /// Everything about it in one word, as tables of poses carry it: [`Self::from_text`] gives it back to the bit.
    ///
    /// `kuka-abc/angles/deg/mm`, and behind it `/inverse` and `/tcp=x:y:z:qw:qx:qy:qz` (mm) where that is so.
    #[must_use]
    pub fn text(&self) -> String {
        let named = |names: &[&'static str], idx: usize| names.get(idx).copied().unwrap_or_default();
        let mut text = format!(
            "{}/{}/{}/{}",
            self.convention.id,
            named(&FORM_NAMES, self.orientation as usize),
            named(&ANGLE_UNIT_NAMES, self.angle_unit as usize),
            self.length_unit.symbol()
        );
        if self.is_inverse {
            text.push_str("/inverse");
        }
        if let Some(flange_from_tcp) = &self.flange_from_tcp {
            let translation = flange_from_tcp.translation_mm();
            let numbers = translation.iter().copied().chain(flange_from_tcp.quaternion_wxyz());
            let numbers: Vec<String> = numbers.map(|number| number.to_string()).collect();
            text.push_str("/tcp=");
            text.push_str(&numbers.join(":"));
        }
        text
    }

    /// The notation of such a word; `None` if it is none, or of a convention that is not known.
    #[must_use]
    pub fn from_text(text: &str) -> Option<Self> {
        let mut words = text.trim().split('/');
        let convention = PoseConvention::by_id(words.next()?)?;
        let form = words.next()?;
        let angle_unit = words.next()?;
        let length_unit = words.next()?;
        let mut notation = Self {
            orientation: [OrientationForm::Angles, OrientationForm::QuaternionWxyz, OrientationForm::QuaternionXyzw]
                .into_iter()
                .zip(FORM_NAMES)
                .find_map(|(known, name)| (name == form).then_some(known))?,
            angle_unit: [AngleUnit::Degrees, AngleUnit::Radians]
                .into_iter()
                .zip(ANGLE_UNIT_NAMES)
                .find_map(|(known, name)| (name == angle_unit).then_some(known))?,
            length_unit: [LengthUnit::Millimetres, LengthUnit::Metres]
                .into_iter()
                .find(|unit| unit.symbol() == length_unit)?,
            ..Self::of(convention)
        };
        for word in words {
            if word == "inverse" {
                notation.is_inverse = true;
            } else {
                let numbers: Vec<f64> =
                    word.strip_prefix("tcp=")?.split(':').map(|number| number.parse().ok()).collect::<Option<_>>()?;
                let [x, y, z, w, i, j, k] = numbers.try_into().ok()?;
                let is_finite = [x, y, z].iter().all(|value: &f64| value.is_finite());
                let rotation = unit_quaternion([w, i, j, k]).ok().filter(|_| is_finite)?;
                notation.flange_from_tcp = Some(Transform::from_parts(Vec3::new(x, y, z), rotation));
            }
        }
        Some(notation)
    }

    /// The pose that the numbers stand for.
    ///
    /// # Errors
    /// [`NotAPose`]: another count of numbers, one that is not finite, or a quaternion off unit norm.
    pub fn base_from_flange(&self, numbers: &[f64]) -> Result<Transform<Base, Flange>, NotAPose> {
        let needed = self.num_numbers();
        if numbers.len() != needed {
            return Err(NotAPose::Count { found: numbers.len(), needed });
        }
        if numbers.iter().any(|number| !number.is_finite()) {
            return Err(NotAPose::NotFinite);
        }
        let translation_mm = Vec3::new(numbers[0], numbers[1], numbers[2]) * self.length_unit.in_mm();
        let rotation = match self.orientation {
            OrientationForm::Angles => {
                let angles_deg = [numbers[3], numbers[4], numbers[5]].map(|angle| angle * self.angle_unit.in_degrees());
                if angles_deg.iter().any(|angle| !angle.is_finite()) {
                    return Err(NotAPose::NotFinite);
                }
                self.convention.rotation_from_angles_deg(angles_deg)
            }
            OrientationForm::QuaternionWxyz => unit_quaternion([numbers[3], numbers[4], numbers[5], numbers[6]])?,
            OrientationForm::QuaternionXyzw => unit_quaternion([numbers[6], numbers[3], numbers[4], numbers[5]])?,
        };
        let written = Transform::<Base, Tcp>::from_parts(translation_mm, rotation);
        let base_from_tcp = if self.is_inverse { Transform::from_rigid(written.rigid().inverse()) } else { written };
        let base_from_flange: Transform<Base, Flange> = match &self.flange_from_tcp {
            Some(flange_from_tcp) => base_from_tcp * flange_from_tcp.inverse(),
            None => Transform::from_rigid(*base_from_tcp.rigid()),
        };
        // Huge numbers overflow in the units that are counted in, and in products.
        let parts = base_from_flange.quaternion_wxyz();
        if !base_from_flange.translation_mm().iter().chain(&parts).all(|value| value.is_finite()) {
            return Err(NotAPose::NotFinite);
        }
        Ok(Transform::from_parts(base_from_flange.translation_mm(), upper_half(base_from_flange.rotation())))
    }

    /// The numbers of a pose.
    #[must_use]
    pub fn numbers(&self, base_from_flange: &Transform<Base, Flange>) -> Vec<f64> {
        let base_from_tcp: Transform<Base, Tcp> = match &self.flange_from_tcp {
            Some(flange_from_tcp) => *base_from_flange * *flange_from_tcp,
            None => Transform::from_rigid(*base_from_flange.rigid()),
        };
        let written =
            if self.is_inverse { Transform::from_rigid(base_from_tcp.rigid().inverse()) } else { base_from_tcp };
        let mut numbers: Vec<f64> =
            (written.translation_mm() / self.length_unit.in_mm()).iter().map(|v| v + 0.0).collect();
        let [w, x, y, z] = written.quaternion_wxyz();
        match self.orientation {
            OrientationForm::Angles => {
                let angles_deg = self.convention.angles_deg_from_rotation(&written.rotation());
                numbers.extend(angles_deg.map(|angle| angle / self.angle_unit.in_degrees()));
            }
            OrientationForm::QuaternionWxyz => numbers.extend([w, x, y, z]),
            OrientationForm::QuaternionXyzw => numbers.extend([x, y, z, w]),
        }
        numbers
    }
}

fn unit_quaternion([w, x, y, z]: [f64; 4]) -> Result<UnitQuaternion<f64>, NotAPose> {
    let quaternion = Quaternion::new(w, x, y, z);
    let norm = quaternion.norm();
    if (norm - 1.0).abs() > QUATERNION_NORM_TOLERANCE {
        return Err(NotAPose::QuaternionNorm { norm, tolerance: QUATERNION_NORM_TOLERANCE });
    }
    Ok(UnitQuaternion::new_normalize(quaternion))
}

/// Of the two quaternions of a rotation the one that files hold, so that a pose is the same after it was saved.
fn upper_half(rotation: UnitQuaternion<f64>) -> UnitQuaternion<f64> {
    if rotation.w < 0.0 { UnitQuaternion::new_unchecked(-rotation.into_inner()) } else { rotation }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::so3;

    #[test]
    fn every_form_gives_the_pose_back() {
        let base_from_flange =
            Transform::<Base, Flange>::from_parts(Vec3::new(512.5, -80.25, 310.0), so3::exp(Vec3::new(0.4, -1.1, 2.0)));
        let flange_from_tcp = Transform::from_parts(Vec3::new(1.0, 2.0, 150.0), so3::exp(Vec3::new(0.1, 0.2, -0.3)));
        for orientation in [OrientationForm::Angles, OrientationForm::QuaternionWxyz, OrientationForm::QuaternionXyzw] {
            for angle_unit in [AngleUnit::Degrees, AngleUnit::Radians] {
                for length_unit in [LengthUnit::Millimetres, LengthUnit::Metres] {
                    for (flange_from_tcp, is_inverse) in
                        [(None, false), (Some(flange_from_tcp), false), (None, true), (Some(flange_from_tcp), true)]
                    {
                        let convention = PoseConvention::default_convention();
                        let notation = PoseNotation {
                            convention,
                            orientation,
                            angle_unit,
                            length_unit,
                            flange_from_tcp,
                            is_inverse,
                        };
                        let numbers = notation.numbers(&base_from_flange);
                        let again = notation.base_from_flange(&numbers).expect("a pose");
                        let apart_mm = (again.translation_mm() - base_from_flange.translation_mm()).norm();
                        let apart_rad = again.rotation().angle_to(&base_from_flange.rotation());
                        assert!(apart_mm < 1e-9 && apart_rad < 1e-12, "{notation:?}: {apart_mm} mm, {apart_rad} rad");
                    }
                }
            }
        }
    }
}
