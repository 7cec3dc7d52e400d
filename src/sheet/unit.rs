//! Units behind the names of columns: `x [mm]`, `z_um`, `rx/deg`.

use crate::geometry::notation::{AngleUnit, LengthUnit};

use super::text::half_width;

/// The plain name and the unit of a header's cell: `Trans X [mm]` is `transx` and `mm`.
pub fn name_and_unit(cell: &str) -> (String, Option<String>) {
    let cell: String = cell.chars().map(half_width).collect::<String>().to_lowercase();
    let mut unit = None;
    let mut name = cell.trim().trim_matches('$').to_owned();
    for (open, close) in [('[', ']'), ('(', ')'), ('{', '}')] {
        if let Some(start) = name.find(open)
            && let Some(len) = name[start..].find(close)
            && start > 0
        {
            unit = Some(name[start + 1..start + len].trim().to_owned());
            name.replace_range(start..=start + len, "");
        }
    }
    for word in ["millimeter", "millimetre", "mm", "m", "deg", "degree", "degrees", "°", "rad"] {
        for before in ['/', '_', ' '] {
            let suffix = format!("{before}{word}");
            if unit.is_none() && name.trim_end().ends_with(&suffix) && name.trim_end().len() > suffix.len() {
                name.truncate(name.trim_end().len() - suffix.len());
                unit = Some(word.to_owned());
            }
        }
    }
    let mut plain: String = name.chars().filter(|c| c.is_alphanumeric() || *c == '#').collect();
    for prefix in ["pose", "tcp", "robot", "flange", "tool", "actual", "cart"] {
        let rest = plain.strip_prefix(prefix).filter(|rest| !rest.is_empty());
        plain = rest.map_or_else(|| plain.clone(), str::to_owned);
    }
    (plain, unit)
}

pub fn length_unit(unit: &str) -> Option<LengthUnit> {
    match unit {
        "mm" | "millimeter" | "millimetre" => Some(LengthUnit::Millimetres),
        "m" | "meter" | "metre" => Some(LengthUnit::Metres),
        _ => None,
    }
}

pub fn angle_unit(unit: &str) -> Option<AngleUnit> {
    match unit {
        "deg" | "degree" | "degrees" | "°" | "grad" => Some(AngleUnit::Degrees),
        "rad" | "radian" | "radians" => Some(AngleUnit::Radians),
        _ => None,
    }
}

/// Millimetres in the unit that a profile's column has behind its name; `None` without a unit.
///
/// # Errors
/// The unit, if it is none of length.
pub fn column_in_mm(cell: &str) -> Result<Option<f64>, String> {
    let lower = cell.trim().to_lowercase();
    let suffix = lower.rsplit_once(['_', '/', ' ']).map(|(_, after)| after.to_owned());
    let is_length = |unit: &String| matches!(unit.as_str(), "um" | "µm" | "μm" | "cm" | "in" | "inch");
    let unit = name_and_unit(cell).1.or_else(|| suffix.filter(is_length));
    match unit.as_deref() {
        None | Some("") => Ok(None),
        Some("mm" | "millimeter" | "millimetre") => Ok(Some(1.0)),
        Some("m" | "meter" | "metre") => Ok(Some(1000.0)),
        Some("cm") => Ok(Some(10.0)),
        Some("um" | "µm" | "μm" | "micron") => Ok(Some(0.001)),
        Some("in" | "inch" | "\"") => Ok(Some(25.4)),
        Some(other) => Err(other.to_owned()),
    }
}

/// Whether a cell is a unit and nothing else, as in a second row of a header.
pub fn is_unit(cell: &str) -> bool {
    let unit = cell.trim().trim_matches(['[', ']', '(', ')']).to_lowercase();
    matches!(unit.as_str(), "" | "-" | "1") || length_unit(&unit).is_some() || angle_unit(&unit).is_some()
}
