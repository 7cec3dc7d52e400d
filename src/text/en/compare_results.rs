//! Wording of comparisons of calibrations from files, and of their history.

use crate::geometry::Vec3;
use crate::text::digits::{decimals_for, signed};
use crate::verify::difference::{Difference, Known, PointShift, SIGNIFICANT_P};
use crate::verify::drift::{MIN_FOR_TREND, Trend};

use super::shell::count;

/// Why a file is left out.
#[must_use]
pub fn no_place(file: &str) -> String {
    format!("{file}: found a translation of more than a kilometre, expected the place of a sensor on its flange in mm")
}

/// Why a folder cannot be read.
#[must_use]
pub fn unreadable_folder(folder: &str, problem: &str) -> String {
    format!("{folder}: {problem}; expected a folder of result files (`handeye solve --json`)")
}

/// Why a folder is not read.
#[must_use]
pub fn too_many_files(folder: &str, found: usize, limit: usize) -> String {
    format!("{folder}: found {found} files, expected at most {limit}; move the older ones elsewhere")
}

/// Why a file of a history is left out.
#[must_use]
pub fn other_mount(name: &str) -> String {
    format!("{name}: the sensor is mounted otherwise than in the first file (on the flange, or beside the robot)")
}

/// Why there is no history.
#[must_use]
pub fn no_calibrations(folder: &str, first: Option<&String>) -> String {
    let reason =
        first.map_or_else(|| "no file that ends in json or txt".to_owned(), |reason| format!("none in: {reason}"));
    format!("{folder}: found no calibration ({reason}), expected result files, matrices or sessions")
}

/// Why two are not compared.
#[must_use]
pub fn mounts_differ(first: &str, second: &str) -> String {
    format!(
        "{first} and {second}: found one sensor on the flange and one beside the robot, expected both mounted alike"
    )
}

/// Heads a comparison.
#[must_use]
pub fn compare_head(first: &str, second: &str) -> String {
    format!("{second}\nless {first}\n")
}

/// Said of a matrix that is no rotation.
#[must_use]
pub fn nearest_line(name: &str) -> String {
    format!("{name} is no rotation; the nearest one is compared\n")
}

/// `+0.123 ± 0.010`, with as many digits as σ has.
#[must_use]
pub fn with_std(value: f64, std: Option<f64>, usual_decimals: usize) -> String {
    let decimals = std.map_or(usual_decimals, |std| decimals_for(Some(std)));
    let value = signed(value, decimals);
    std.map_or_else(|| value.clone(), |std| format!("{value} ± {std:.decimals$}"))
}

fn three(value: Vec3, std: Option<Vec3>, usual_decimals: usize) -> String {
    let axes = ["x", "y", "z"].iter().enumerate();
    let parts: Vec<String> = axes
        .map(|(idx, axis)| format!("{axis} {}", with_std(value[idx], std.map(|std| std[idx]), usual_decimals)))
        .collect();
    parts.join("   ")
}

/// Whether chance explains it.
#[must_use]
pub fn significance(p_value: Option<f64>, known: Known) -> String {
    let p_text = |p: f64| if p < 1e-4 { "p < 0.0001".to_owned() } else { format!("p = {p:.4}") };
    let other = if known == Known::One { "; the other counts as exact" } else { "" };
    match p_value {
        Some(p) if p < SIGNIFICANT_P => format!("a real difference ({}{other})", p_text(p)),
        Some(p) => format!("within what chance explains ({}{other})", p_text(p)),
        None if known == Known::None => "no σ is stated, so whether it is chance is not known".to_owned(),
        None => "the σ stated do not tell whether it is chance".to_owned(),
    }
}

/// The difference in the flange, three lines.
#[must_use]
pub fn difference_lines(difference: &Difference) -> String {
    let degrees = |v: Vec3| v.map(f64::to_degrees);
    let axis = difference.axis().map_or_else(String::new, |axis| {
        format!(", about ({})", [axis.x, axis.y, axis.z].map(|part| signed(part, 3)).join(", "))
    });
    let translation = three(difference.translation_mm, difference.translation_std_mm, 4);
    let rotation = three(degrees(difference.rotation_rad), difference.rotation_std_rad.map(degrees), 5);
    format!(
        "translation in the flange / mm   {translation}   in all {:.4}\nrotation in the flange / °       {rotation}   in all {:.5}{axis}\n{}\n",
        difference.translation_mm.norm(),
        difference.angle_rad().to_degrees(),
        significance(difference.p_value, difference.known),
    )
}

/// What becomes of a point.
#[must_use]
pub fn point_line(what: &str, shift: &PointShift, known: Known) -> String {
    let point = shift.point_in_sensor_mm;
    let at = [point.x, point.y, point.z].map(|part| format!("{part:.2}")).join(", ");
    let moved = three(shift.shift_mm, shift.std_mm, 4);
    format!(
        "{what} ({at}) in the sensor moves / mm   {moved}   in all {:.4}; {}\n",
        shift.shift_mm.norm(),
        significance(shift.p_value, known)
    )
}

/// The point of the headline.
pub const REFERENCE_POINT: &str = "the workspace point";
/// A point that was asked for.
pub const GIVEN_POINT: &str = "the point";

/// Over all points at which was measured.
#[must_use]
pub fn measured_line(num_points: usize, mean_mm: f64, max_mm: f64) -> String {
    format!(
        "where was measured ({}) it moves by {mean_mm:.4} mm in the mean, at most {max_mm:.4} mm\n",
        count(num_points, "point")
    )
}

/// Heads a history.
#[must_use]
pub fn history_head(num_calibrations: usize, is_by_dates: bool) -> String {
    let order = if is_by_dates {
        "by their dates"
    } else {
        "by the names of the files, as not all have a date (`date` in the file, or 2026-03-01 in its name)"
    };
    format!("{} {order}\n", count(num_calibrations, "calibration"))
}

/// The columns of a history's table.
pub const HISTORY_COLUMNS: [&str; 8] =
    ["calibration", "date", "dx/mm", "dy/mm", "dz/mm", "turn/°", "point/mm", "from previous/mm"];

/// What a jump is.
#[must_use]
pub fn jump_line(name: &str, previous: &str, moved_mm: f64, p_value: Option<f64>) -> String {
    let p = p_value
        .map_or_else(String::new, |p| if p < 1e-4 { ", p < 0.0001".to_owned() } else { format!(", p = {p:.4}") });
    format!(
        "jump: {name} is {moved_mm:.4} mm from {previous}{p}; look what was done in between (collision, sensor or flange taken off)\n"
    )
}

/// Where none stands out.
pub const NO_JUMP: &str = "no jumps\n";

/// The names of the axes of a trend, with their units.
pub const TREND_AXES: [&str; 6] = ["x / mm", "y / mm", "z / mm", "about x / °", "about y / °", "about z / °"];

/// The trend along an axis, its slope in the unit of the axis a day, or a calibration.
#[must_use]
pub fn trend_line(axis: &str, trend: &Trend, is_by_dates: bool) -> String {
    /// A slope a day is too small to be read.
    const DAYS: f64 = 30.0;
    let (factor, per) = if is_by_dates { (DAYS, "in 30 days") } else { (1.0, "a calibration") };
    let verdict = match trend.is_significant {
        Some(true) => "drifts",
        Some(false) => "no drift beyond chance",
        None => "too few calibrations to tell a drift from chance",
    };
    format!("trend {axis:<12} {} {per}: {verdict}\n", with_std(trend.slope * factor, Some(trend.std * factor), 4))
}

/// Why there is no trend.
#[must_use]
pub fn no_trend_line(num_calibrations: usize) -> String {
    if num_calibrations < MIN_FOR_TREND {
        format!("no trend: found {num_calibrations}, needed {MIN_FOR_TREND} calibrations\n")
    } else {
        "no trend: all calibrations have the same date\n".to_owned()
    }
}

/// A file that was left out.
#[must_use]
pub fn left_out_line(reason: &str) -> String {
    format!("left out: {reason}\n")
}

/// Why a point is not one.
#[must_use]
pub fn not_a_point(text: &str) -> String {
    format!("found {text}, expected three numbers with commas between them: a point in the sensor frame in mm")
}
