//! What comparisons of calibrations found, as `compare --json`, `history --json` and `history --csv` print it. Other programs
//! rely on the names.

use serde_json::{Value, json};

use crate::verify::difference::{Difference, Known, PointShift, SIGNIFICANT_P};
use crate::verify::drift::{Change, Trend};

use super::super::diagnosis_entry::vector;
use super::super::result_file::transform;
use super::{Compared, Comparison, Course, History, Order, Shared};

/// The format's name of a comparison.
pub const COMPARISON_FORMAT: &str = "handeye-comparison";
/// The format's name of a history.
pub const HISTORY_FORMAT: &str = "handeye-history";
/// The version of both.
pub const VERSION: u32 = 1;

/// Two calibrations as a JSON document.
#[must_use]
pub fn comparison_file(comparison: &Comparison) -> Value {
    let Comparison { from, to, shared, difference, points } = comparison;
    json!({
        "format": COMPARISON_FORMAT,
        "version": VERSION,
        "from": calibration_entry(from),
        "to": calibration_entry(to),
        "shared": match shared {
            Shared::Nothing => Value::Null,
            Shared::File => json!("file"),
            Shared::Data => json!("data"),
        },
        "difference": difference_entry(difference),
        "reference_point": points.reference.as_ref().map(shift_entry),
        "points": points.given.iter().map(shift_entry).collect::<Vec<_>>(),
        "measured_points": points.measured.iter().map(shift_entry).collect::<Vec<_>>(),
    })
}

/// A history as a JSON document; slopes are a day, or a calibration where the order is that of the names.
#[must_use]
pub fn history_file(history: &History) -> Value {
    let calibrations = history.calibrations.iter().zip(&history.drift.from_first).enumerate();
    let entries: Vec<Value> = calibrations
        .map(|(idx, (calibration, from_first))| {
            let from_previous = idx.checked_sub(1).and_then(|previous| history.drift.from_previous.get(previous));
            let mut entry = calibration_entry(calibration);
            entry["from_first"] = change_entry(from_first);
            entry["from_previous"] = from_previous.map_or(Value::Null, change_entry);
            entry["is_jump"] = json!(history.drift.jumps.contains(&idx));
            entry
        })
        .collect();
    let trends: Vec<Trend> = history.shown_trends().collect();
    let (of_point, of_axes) = trends.split_at(history.drift.point_trends.len());
    json!({
        "format": HISTORY_FORMAT,
        "version": VERSION,
        "order": match history.order {
            Order::Dates => "dates",
            Order::Names => "names",
        },
        "reference_point_in_sensor_mm": vector(history.reference_point_in_sensor_mm),
        "calibrations": entries,
        "course": match history.course() {
            Course::Steady => "steady",
            Course::Moved => "moved",
            Course::Unknown => "unknown",
        },
        "point_trends": trend_entries(of_point, &["x_mm", "y_mm", "z_mm"]),
        "trends": trend_entries(of_axes, &["x_mm", "y_mm", "z_mm", "about_x_deg", "about_y_deg", "about_z_deg"]),
        "left_out": history.left_out,
    })
}

fn trend_entries(trends: &[Trend], axes: &[&str]) -> Vec<Value> {
    let entry = |(trend, axis): (&Trend, &&str)| {
        json!({
            "axis": axis,
            "slope": trend.slope,
            "std": trend.std,
            "at_first": trend.at_first,
            "is_significant": trend.is_significant,
        })
    };
    trends.iter().zip(axes).map(entry).collect()
}

fn calibration_entry(calibration: &Compared) -> Value {
    json!({
        "name": calibration.name,
        "date": calibration.date(),
        "is_nearest_rotation": calibration.is_nearest,
        "flange_from_sensor": transform(&calibration.stated.flange_from_sensor),
    })
}

fn change_entry(change: &Change) -> Value {
    let mut entry = difference_entry(&change.difference);
    entry["reference_point"] = shift_entry(&change.shift);
    entry
}

fn difference_entry(difference: &Difference) -> Value {
    json!({
        "translation_mm": vector(difference.translation_mm),
        "translation_std_mm": difference.translation_std_mm.map(vector),
        "rotation_deg": vector(difference.rotation_rad.map(f64::to_degrees)),
        "rotation_std_deg": difference.rotation_std_rad.map(|std| vector(std.map(f64::to_degrees))),
        "angle_deg": difference.angle_rad().to_degrees(),
        "axis": difference.axis().map(vector),
        "p_value": difference.p_value,
        "is_significant": difference.p_value.map(|p| p < SIGNIFICANT_P),
        "std_of": match difference.known {
            Known::None => "none",
            Known::One => "one",
            Known::Both => "both",
            Known::SameData => "same data",
        },
    })
}

fn shift_entry(shift: &PointShift) -> Value {
    json!({
        "point_in_sensor_mm": vector(shift.point_in_sensor_mm),
        "shift_mm": vector(shift.shift_mm),
        "std_mm": shift.std_mm.map(vector),
        "size_mm": shift.shift_mm.norm(),
        "p_value": shift.p_value,
    })
}

/// A history as a table: a row a calibration, against the first, and the reference point's way from the previous.
#[must_use]
pub fn history_csv(history: &History) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let head = [
        "name",
        "date",
        "dx_mm",
        "dy_mm",
        "dz_mm",
        "about_x_deg",
        "about_y_deg",
        "about_z_deg",
        "point_mm",
        "point_from_previous_mm",
        "p_value_from_previous",
        "jump",
    ];
    // Writing to memory cannot fail, and every row has as many cells.
    let _ = writer.write_record(head);
    for (idx, (calibration, change)) in history.calibrations.iter().zip(&history.drift.from_first).enumerate() {
        let previous = idx.checked_sub(1).and_then(|previous| history.drift.from_previous.get(previous));
        let shown = |value: Option<f64>| value.map_or_else(String::new, |value| value.to_string());
        let mut row = vec![calibration.name.clone(), calibration.date().unwrap_or_default()];
        row.extend(change.difference.translation_mm.iter().map(f64::to_string));
        row.extend(change.difference.rotation_rad.iter().map(|angle| angle.to_degrees().to_string()));
        row.push(change.shift.shift_mm.norm().to_string());
        row.push(shown(previous.map(|previous| previous.shift.shift_mm.norm())));
        row.push(shown(previous.and_then(|previous| previous.shift.p_value)));
        row.push(if history.drift.jumps.contains(&idx) { "yes" } else { "no" }.to_owned());
        let _ = writer.write_record(&row);
    }
    String::from_utf8(writer.into_inner().unwrap_or_default()).unwrap_or_default()
}
