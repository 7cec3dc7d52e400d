//! Texts with places for numbers: filled in one direction, read in the other. Both follow the same template, so that a text
//! read back shows what rounding, signs and singular angles have done to it; that the template says the right thing is the
//! task of the examples in the tests and of the independent check in `tests/clients`.

use nalgebra::{Quaternion, UnitQuaternion};

use super::field::{Field, Place, Quantity};
use super::{NotThisFormat, Parent, ToolFrame};
use crate::geometry::{Flange, Mat3, PoseConvention, Sensor, Transform, Vec3, so3};
use crate::text::digits;

/// The numbers of a pose in every form. What a text does not hold is `None` after reading.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Numbers {
    translation_mm: [Option<f64>; 3],
    angles_deg: [Option<f64>; 3],
    quaternion_wxyz: [Option<f64>; 4],
    rotation: [[Option<f64>; 3]; 3],
}

impl Numbers {
    pub fn of(pose: &Transform<Flange, Sensor>, convention: Option<&PoseConvention>) -> Self {
        let rotation = pose.rotation();
        let matrix = rotation.to_rotation_matrix();
        Self {
            translation_mm: <[f64; 3]>::from(pose.translation_mm()).map(Some),
            angles_deg: convention
                .map_or([None; 3], |convention| convention.angles_deg_from_rotation(&rotation).map(Some)),
            quaternion_wxyz: pose.quaternion_wxyz().map(Some),
            rotation: [0, 1, 2].map(|row| [0, 1, 2].map(|column| Some(matrix[(row, column)]))),
        }
    }

    fn get(&self, quantity: Quantity) -> Option<f64> {
        match quantity {
            Quantity::Translation(idx) => self.translation_mm[idx],
            Quantity::Angle(idx) => self.angles_deg[idx],
            Quantity::Quaternion(idx) => self.quaternion_wxyz[idx],
            Quantity::Rotation(row, column) => self.rotation[row][column],
        }
    }

    fn set(&mut self, quantity: Quantity, value: f64) {
        let place = match quantity {
            Quantity::Translation(idx) => &mut self.translation_mm[idx],
            Quantity::Angle(idx) => &mut self.angles_deg[idx],
            Quantity::Quaternion(idx) => &mut self.quaternion_wxyz[idx],
            Quantity::Rotation(row, column) => &mut self.rotation[row][column],
        };
        *place = Some(value);
    }

    /// The pose that they stand for, from whichever form of the rotation is whole.
    pub fn pose(&self, convention: Option<&PoseConvention>) -> Option<Transform<Flange, Sensor>> {
        let translation = all(self.translation_mm)?;
        let rotation = if let (Some(angles), Some(convention)) = (all(self.angles_deg), convention) {
            convention.rotation_from_angles_deg(angles)
        } else if let Some([w, x, y, z]) = all(self.quaternion_wxyz) {
            UnitQuaternion::try_new(Quaternion::new(w, x, y, z), 0.5)?
        } else {
            let rows = all(self.rotation.map(all))?;
            so3::nearest_rotation(&Mat3::from_fn(|row, column| rows[row][column]))?
        };
        Some(Transform::from_parts(Vec3::from(translation), rotation))
    }
}

fn all<T: Copy, const N: usize>(parts: [Option<T>; N]) -> Option<[T; N]> {
    let whole: Vec<T> = parts.into_iter().collect::<Option<_>>()?;
    whole.try_into().ok()
}

/// A piece of a template.
enum Piece<'a> {
    Literal(&'a str),
    Field(Field),
}

/// The pieces; braces around anything but a field's name are literal.
fn pieces(template: &str) -> Vec<Piece<'_>> {
    let mut pieces = Vec::new();
    let mut literal_from = 0;
    let mut at = 0;
    while let Some(open) = template[at..].find('{').map(|offset| at + offset) {
        at = open + 1;
        let Some(close) = template[at..].find('}').map(|offset| at + offset) else { break };
        if let Some(field) = Field::parse(&template[at..close]) {
            pieces.push(Piece::Literal(&template[literal_from..open]));
            pieces.push(Piece::Field(field));
            at = close + 1;
            literal_from = at;
        }
    }
    pieces.push(Piece::Literal(&template[literal_from..]));
    pieces
}

/// The template with the numbers in their places.
pub(super) fn fill(
    template: &str,
    numbers: &Numbers,
    frame: &ToolFrame,
    convention: Option<&PoseConvention>,
) -> String {
    let mut text = String::new();
    for piece in pieces(template) {
        match piece {
            Piece::Literal(literal) => text.push_str(literal),
            Piece::Field(Field::Name) => text.push_str(frame.name.as_str()),
            Piece::Field(Field::ToolNumber) => text.push_str(&frame.number.to_string()),
            Piece::Field(Field::ParentFrame) => text.push_str(parent_frame(frame.parent)),
            Piece::Field(Field::AngleName(idx)) => {
                text.push_str(convention.map_or("", |convention| convention.angle_names[idx]));
            }
            Piece::Field(Field::Number(place)) => {
                let value = numbers.get(place.quantity).unwrap_or(f64::NAN);
                let written = digits::fixed(value * place.factor, place.decimals);
                let in_parentheses = place.parenthesised && written.starts_with('-');
                text.extend(if in_parentheses { ["(", &written, ")"] } else { ["", &written, ""] });
            }
        }
    }
    text
}

const fn parent_frame(parent: Parent) -> &'static str {
    match parent {
        Parent::Flange => "tool0",
        Parent::Base => "base_link",
    }
}

/// Reads a text that follows the template.
pub(super) fn read(template: &str, text: &str, convention: Option<&PoseConvention>) -> Result<Numbers, NotThisFormat> {
    let mut numbers = Numbers::default();
    let mut rest = text.trim_start();
    for piece in pieces(template) {
        match piece {
            Piece::Literal(literal) => rest = skip(rest, literal)?,
            Piece::Field(Field::Name | Field::ParentFrame) => {
                rest = rest.trim_start().trim_start_matches(|c: char| c.is_ascii_alphanumeric() || c == '_');
            }
            Piece::Field(Field::ToolNumber) => {
                rest = rest.trim_start().trim_start_matches(|c: char| c.is_ascii_digit());
            }
            Piece::Field(Field::AngleName(idx)) => {
                rest = skip(rest, convention.map_or("", |convention| convention.angle_names[idx]))?;
            }
            Piece::Field(Field::Number(place)) => {
                let (value, after) = number(rest, &place)?;
                numbers.set(place.quantity, value / place.factor);
                rest = after;
            }
        }
    }
    if rest.trim().is_empty() {
        Ok(numbers)
    } else {
        Err(NotThisFormat::Literal { found: start_of(rest), expected: "the end".to_owned() })
    }
}

/// The text behind a literal; white space in either does not count.
fn skip<'a>(text: &'a str, literal: &str) -> Result<&'a str, NotThisFormat> {
    let mut rest = text;
    for expected in literal.chars().filter(|c| !c.is_whitespace()) {
        rest = rest.trim_start();
        rest = rest
            .strip_prefix(expected)
            .ok_or_else(|| NotThisFormat::Literal { found: start_of(rest), expected: literal.trim().to_owned() })?;
    }
    Ok(rest)
}

/// The number at the beginning of a text, and what follows it.
fn number<'a>(text: &'a str, place: &Place) -> Result<(f64, &'a str), NotThisFormat> {
    let text = text.trim_start();
    if let Some(inside) = text.strip_prefix('(').filter(|_| place.parenthesised) {
        let (value, after) = number(inside, &Place { parenthesised: false, ..*place })?;
        return Ok((value, skip(after, ")")?));
    }
    let is_of_number = |c: char| c.is_ascii_digit() || matches!(c, '+' | '-' | '.' | 'e' | 'E');
    let end = text.find(|c| !is_of_number(c)).unwrap_or(text.len());
    let value = text[..end].parse().ok().filter(|value: &f64| value.is_finite());
    value.map(|value| (value, &text[end..])).ok_or_else(|| NotThisFormat::NoNumber { found: start_of(text) })
}

/// What stands there, no more than a few words of the line.
fn start_of(text: &str) -> String {
    text.trim_start().lines().next().unwrap_or_default().chars().take(20).collect()
}

/// What the digits of a template leave open at most: mm, and degrees.
pub(super) fn resolution(template: &str) -> [f64; 2] {
    let mut squared_mm = 0.0;
    let mut degrees = 0.0;
    for piece in pieces(template) {
        let Piece::Field(Field::Number(place)) = piece else { continue };
        let half_unit = place.half_unit();
        match place.quantity {
            Quantity::Translation(_) => squared_mm += half_unit * half_unit,
            // Angles add up at worst, where their axes fall together.
            Quantity::Angle(_) => degrees += half_unit,
            // A unit quaternion turns by twice the angle between two of them; a matrix by no more than the sum of its
            // elements' errors.
            Quantity::Quaternion(_) => degrees += 2.0 * half_unit.to_degrees(),
            Quantity::Rotation(..) => degrees += half_unit.to_degrees(),
        }
    }
    // The comparison itself is good to some 1e-12 mm and, by the arc cosine of a quaternion near 1, 2e-6 degrees.
    [squared_mm.sqrt() + 1e-9, degrees + 5e-6]
}
