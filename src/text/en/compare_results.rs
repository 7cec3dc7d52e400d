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
pub fn nearest(name: &str) -> String {
    format!("{name} is no rotation; the nearest one is compared")
}

/// Said of a file that is compared with itself.
pub const SAME_FILE: &str = "Both are the same file, or copies of it: their difference means nothing. Compare calibrations from two measurements";

/// Said of two calibrations from one measurement.
pub const SAME_DATA: &str = "Both were computed from the same measurement: their difference is that of the computations and says \
nothing about the cell, and no σ applies. Compare calibrations from two measurements";

/// Why a file of a history is left out.
#[must_use]
pub fn same_data(name: &str, known: &str) -> String {
    format!("{name}: the same file or measurement as {known}, which counts once")
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
        None if known == Known::SameData => "from the same data, so that chance does not come into it".to_owned(),
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
        "where was measured ({}) it moves by {mean_mm:.4} mm in the mean, at most {max_mm:.4} mm",
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
    format!("{} {order}", count(num_calibrations, "calibration"))
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
        "jump: {name} is {moved_mm:.4} mm from {previous}{p}; look what was done in between (collision, sensor or flange taken off)"
    )
}

/// Where none stands out.
pub const NO_JUMP: &str = "no jumps";

/// Behind the way from the previous calibration, where it is a jump.
pub const JUMP_MARK: &str = " jump";

/// The names of the axes of a trend, with their units.
pub const TREND_AXES: [&str; 6] = ["x / mm", "y / mm", "z / mm", "about x / °", "about y / °", "about z / °"];

/// The same of the workspace point.
pub const POINT_AXES: [&str; 3] = ["point x / mm", "point y / mm", "point z / mm"];

/// What a slope is given in: a slope a day is too small to be read.
const fn per(is_by_dates: bool) -> (f64, &'static str) {
    if is_by_dates { (30.0, "in 30 days") } else { (1.0, "a calibration") }
}

/// An axis that drifts, with its slope: `point x +0.060 ± 0.004 mm in 30 days`.
#[must_use]
pub fn drifting_axis(axis: &str, trend: &Trend, is_by_dates: bool) -> String {
    let (factor, per) = per(is_by_dates);
    let (name, unit) = axis.split_once(" / ").unwrap_or((axis, ""));
    format!("{name} {} {unit} {per}", with_std(trend.slope * factor, Some(trend.std * factor), 4))
}

/// What a history comes to.
#[must_use]
pub fn history_verdict(drifting: &[String], num_jumps: usize, is_unknown: bool) -> String {
    let jumps = match num_jumps {
        0 => String::new(),
        1 => "jumped once".to_owned(),
        number => format!("jumped {number} times"),
    };
    match (drifting.is_empty(), num_jumps) {
        (true, 0) if is_unknown => "Too few calibrations to tell a drift from chance".to_owned(),
        (true, 0) => "No drift beyond chance, and no jump".to_owned(),
        (true, _) if is_unknown => format!("The calibration {jumps}; too few to tell a drift from chance"),
        (true, _) => format!("The calibration {jumps}; between the jumps no drift beyond chance"),
        (false, 0) => format!("The calibration drifts: {}", drifting.join("; ")),
        (false, _) => format!("The calibration {jumps} and drifts: {}", drifting.join("; ")),
    }
}

/// The trend along an axis, its slope in the unit of the axis a day, or a calibration.
#[must_use]
pub fn trend_line(axis: &str, trend: &Trend, is_by_dates: bool) -> String {
    let (factor, per) = per(is_by_dates);
    let verdict = match trend.is_significant {
        Some(true) => "drifts",
        Some(false) => "no drift beyond chance",
        None => "too few calibrations to tell a drift from chance",
    };
    format!("trend {axis:<12} {} {per}: {verdict}", with_std(trend.slope * factor, Some(trend.std * factor), 4))
}

/// Why there is no trend.
#[must_use]
pub fn no_trend_line(num_calibrations: usize) -> String {
    if num_calibrations < MIN_FOR_TREND {
        format!("no trend: found {num_calibrations}, needed {MIN_FOR_TREND} calibrations")
    } else {
        "no trend: all calibrations have the same date".to_owned()
    }
}

/// A file that was left out.
#[must_use]
pub fn left_out_line(reason: &str) -> String {
    format!("left out: {reason}")
}

/// Why a point is not one.
#[must_use]
pub fn not_a_point(text: &str) -> String {
    format!("found {text}, expected three numbers with commas between them: a point in the sensor frame in mm")
}

/// Heading of the section that compares two calibrations.
pub const COMPARE: &str = "Compare results";
/// What it is for.
pub const COMPARE_HINT: &str =
    "Two calibrations from files, or this session against a file: how far they are apart, and whether by chance";
/// Heading of the section with a folder of results.
pub const HISTORY: &str = "Result history";
/// What it is for.
pub const HISTORY_HINT: &str = "The calibrations of a folder over time: drift and jumps";
/// Why the session cannot be compared.
pub const NO_OPEN_SESSION: &str = "No session is open any more; choose a file instead";
/// Title of the card.
pub const SIDES: &str = "What is compared";
/// Row of the calibration that is compared with.
pub const FROM: &str = "Earlier";
/// Row of the calibration that is compared.
pub const TO: &str = "Later";
/// Names of the fields with the paths of the two.
pub const SIDE_FIELDS: [&str; 2] = ["File of the earlier calibration", "File of the later calibration"];
/// Names of the switches that take the open session in place of a file.
pub const SIDE_SESSIONS: [&str; 2] = ["The earlier is the open session", "The later is the open session"];
/// In a field for a path.
pub const SIDE_EXAMPLE: &str = "result file, matrix or session";
/// Beside the switch, and in place of a path.
pub const OPEN_SESSION: &str = "the open session";
/// Why that cannot be chosen.
pub const NO_SESSION_OPEN: &str = "No session is open";
/// Button.
pub const CHOOSE: &str = "Choose…";
/// Names of the buttons that ask for a file.
pub const CHOOSE_SIDES: [&str; 2] =
    ["Choose the file of the earlier calibration", "Choose the file of the later calibration"];
/// Title of the question for a file.
pub const CHOOSE_SIDE_TITLE: &str = "File with a calibration: a result, a matrix or a session";
/// Row of the points.
pub const POINTS: &str = "Also at";
/// Name of the field.
pub const POINTS_FIELD: &str = "Points in the sensor frame to compare at, mm";
/// In the field.
pub const POINTS_EXAMPLE: &str = "points in the sensor frame / mm: 0,0,80; 10,0,60";
/// Button.
pub const COMPARE_BUTTON: &str = "Compare these";
/// Why it is disabled.
pub const SIDE_MISSING: &str = "Choose two calibrations first";
/// Where nothing was compared yet.
pub const NOTHING_COMPARED: &str = "Choose a result file, a matrix or a session for each side, or take the open session for one of them. The difference is \
that of the later less the earlier, in the flange and at points of the workspace, with σ and what of it chance explains.";
/// While the two are read.
pub const COMPARING: &str = "Reading and solving …";
/// Button.
pub const STOP: &str = "Cancel";
/// Title of the card.
pub const DIFFERENCE: &str = "Later less earlier";
/// Where the session was edited since.
pub const OUT_OF_DATE: &str = "out of date: the session was changed";
/// Title of the plot.
pub const DIFFERENCE_PLOT: &str = "Where the later calibration puts things, less the earlier";
/// Heads of the table.
pub const DIFFERENCE_COLUMNS: [&str; 5] = ["", "x", "y", "z", "in all"];
/// Rows of the table.
pub const TRANSLATION: &str = "translation / mm";
/// Row of the table.
pub const ROTATION: &str = "rotation / °";
/// Row of the table.
pub const REFERENCE_ROW: &str = "workspace point / mm";
/// What a verdict is about.
pub const AS_A_WHOLE: &str = "translation and rotation together";
/// Names of the places in the plot.
pub const TRANSLATION_PLACE: &str = "sensor's origin";
/// Title of an axis.
pub const DIFFERENCE_AXIS: &str = "difference / mm";
/// Beside a plot with error bars.
pub const BARS_ARE_STD: &str = "bars: ± σ";

/// A point that was asked for, as a row of the table.
#[must_use]
pub fn point_row(point: Vec3) -> String {
    format!("{} / mm", point_place(point))
}

/// The same in the plot.
#[must_use]
pub fn point_place(point: Vec3) -> String {
    let [x, y, z] = [point.x, point.y, point.z].map(plain);
    format!("({x}, {y}, {z})")
}

/// Without zeros behind.
fn plain(value: f64) -> String {
    let text = format!("{value:.2}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// A verdict on chance with what it is about.
#[must_use]
pub fn verdict_on(what: &str, significance: &str) -> String {
    format!("{what}: {significance}")
}

/// A value under the pointer.
#[must_use]
pub fn difference_readout(place: &str, axis: &str, value: &str) -> String {
    format!("{place}, {axis}: {value} mm")
}

/// Row of the folder.
pub const FOLDER: &str = "Folder";
/// Name of the field.
pub const FOLDER_FIELD: &str = "Folder with results";
/// In the field.
pub const FOLDER_EXAMPLE: &str = "folder with result files, matrices or sessions";
/// Name of the button that asks for a folder.
pub const CHOOSE_FOLDER: &str = "Choose the folder with results";
/// Title of the question for a folder.
pub const CHOOSE_FOLDER_TITLE: &str = "Folder with results";
/// Button.
pub const READ_FOLDER: &str = "Read";
/// Why it is disabled.
pub const FOLDER_MISSING: &str = "Type a folder first";
/// Button below a typed path.
pub const USE_PATH: &str = "Use";
/// Where no folder was read yet.
pub const NOTHING_READ: &str = "Keep each month's result (`handeye solve FILE --json > cell_2026-03-01.json`, or the report's result.json) in one folder with the date \
in its name, and choose that folder here: it is shown how the calibration moved, and whether that is more than chance.";
/// Title of the card.
pub const HISTORY_TABLE: &str = "Each calibration, against the first";
/// Heads of the table.
pub const HISTORY_HEADS: [&str; 8] =
    ["calibration", "date", "Δx / mm", "Δy / mm", "Δz / mm", "turn / °", "point / mm", "from previous"];
/// Title of the card with jumps, trends and files that were left out.
pub const HISTORY_REMARKS: &str = "Jumps, trends, and files that were left out";
/// Title of the plot.
pub const DRIFT_PLOT: &str = "Way from the first calibration";
/// What is drawn.
pub const QUANTITIES: [&str; 3] = ["workspace point", "origin", "rotation"];
/// Axis of lengths.
pub const WAY_AXIS: &str = "from the first / mm";
/// Axis of angles.
pub const TURN_AXIS: &str = "from the first / °";
/// Axis of numbers.
pub const NUMBER_AXIS: &str = "calibration, in the order of the names";
/// In the legend.
pub const TREND_LEGEND: &str = "trend";
/// In the legend.
pub const DRIFT_LEGEND: &str = "drifts";
/// In the legend.
pub const JUMP_LEGEND: &str = "jump";

/// Axis of dates.
#[must_use]
pub fn days_axis(first: &str) -> String {
    format!("days since {first}")
}

/// A calibration under the pointer.
#[must_use]
pub fn history_readout(name: &str, axis: &str, value: &str, unit: &str) -> String {
    format!("{name}, {axis} {value} {unit}")
}

/// How far the reading of a folder is.
#[must_use]
pub fn reading_folder(done: usize, total: usize) -> String {
    if total == 0 { "reading …".to_owned() } else { format!("reading {done} of {total}") }
}

/// Rows of the table that are not shown.
#[must_use]
pub fn more_rows(hidden: usize) -> String {
    format!("and {}; `handeye history FOLDER --csv` lists them all", count(hidden, "more calibration"))
}
