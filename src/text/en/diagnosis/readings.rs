//! Ways to read poses, by name.

use crate::diagnose::PoseReading;
use crate::diagnose::convention::{AngleUnit, Inversion, LengthUnit, QuaternionOrder, RotationReading};
use crate::geometry::AngleOrder;

/// A way to read poses, by name: "FANUC W P R", "inverse poses, positions in metres".
#[must_use]
pub fn pose_reading(reading: &PoseReading) -> String {
    let parts = [rotation_words(reading), inversion_words(reading.inversion), length_words(reading.length_unit)];
    let parts: Vec<String> = parts.into_iter().flatten().collect();
    if parts.is_empty() { AS_GIVEN.to_owned() } else { parts.join(", ") }
}

/// The same with all names of the order: other makers, and the two ways to spell it out.
#[must_use]
pub fn pose_reading_in_full(reading: &PoseReading) -> String {
    let name = pose_reading(reading);
    let Some(order) = reading.angle_order() else { return name };
    let others: Vec<&str> = reading.makers().iter().skip(1).filter_map(|maker| maker.label.split(' ').next()).collect();
    let also = match others.split_at_checked(MAX_LISTED_MAKERS) {
        _ if others.is_empty() => String::new(),
        Some((listed, rest)) if rest.len() > 1 => format!(", also {}, …", listed.join(", ")),
        _ => format!(", also {}", others.join(", ")),
    };
    match order {
        AngleOrder::Intrinsic([i, j, k]) => {
            format!("{name}{also} ({order} = {} read backwards)", AngleOrder::Extrinsic([k, j, i]))
        }
        AngleOrder::Extrinsic([i, j, k]) => {
            format!("{name}{also} ({order} = {} read backwards)", AngleOrder::Intrinsic([k, j, i]))
        }
        AngleOrder::RotationVector => format!("{name}{also}"),
    }
}

/// Other makers of an order that are listed; `docs/conventions.md` has them all.
const MAX_LISTED_MAKERS: usize = 2;

/// The poses as the session has them.
const AS_GIVEN: &str = "given";

fn rotation_words(reading: &PoseReading) -> Option<String> {
    match &reading.rotation {
        RotationReading::AsGiven => None,
        RotationReading::Quaternion(QuaternionOrder::Xyzw) => Some("quaternion x y z w".to_owned()),
        RotationReading::Quaternion(QuaternionOrder::WxyzReordered) => Some("quaternion w x y z".to_owned()),
        RotationReading::Angles(angles) => {
            let name = reading
                .makers()
                .first()
                .map_or_else(|| format!("{} angles", angles.to), |maker| maker.label.to_owned());
            Some(match angles.unit {
                AngleUnit::Degrees => name,
                AngleUnit::Radians => format!("{name} in radians"),
                AngleUnit::DegreesConvertedTwice => format!("{name} without the second conversion to radians"),
            })
        }
    }
}

fn inversion_words(inversion: Inversion) -> Option<String> {
    match inversion {
        Inversion::AsGiven => None,
        Inversion::WholePose => Some("inverse poses (base in the flange)".to_owned()),
        Inversion::RotationAlone => Some("inverse rotations".to_owned()),
    }
}

fn length_words(unit: LengthUnit) -> Option<String> {
    let unit = match unit {
        LengthUnit::Millimetres => return None,
        LengthUnit::Metres => "metres",
        LengthUnit::Inches => "inches",
        LengthUnit::Micrometres => "micrometres",
    };
    Some(format!("positions in {unit}"))
}
