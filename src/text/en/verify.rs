//! Wording of the Verify step and of `handeye verify`.

use crate::calibrate::Edge;
use crate::session::Target;
use crate::text::digits::{fixed, value};
use crate::verify::{ColumnFault, MatrixCheck, Origin, Suspect, Verification};

use super::methods::{method_name, method_short_name};

/// Where no session is open.
pub const NO_SESSION: &str = "Open a session to see what its calibration is worth on other data.";
/// Heading of a section.
pub const DISTANCES: &str = "Distances";
/// Heading of a section.
pub const STABILITY: &str = "Stability";
/// Heading of a section.
pub const CROSS_TARGET: &str = "Other targets";
/// Heading of a section.
pub const WORKPIECE: &str = "Workpiece";
/// While the first verification is under way.
pub const VERIFYING: &str = "Trying every calibration on every target …";
/// Where the verification was cancelled.
pub const NOT_VERIFIED: &str = "Nothing was verified yet. Change or solve the session to start.";
/// Where figures belong to an earlier state of the session.
pub const OUT_OF_DATE: &str = "out of date";
/// Where there is no calibration.
pub const NO_CALIBRATION: &str =
    "No method gave a calibration yet. Add stations, see what Diagnosis says, or paste a matrix under \"Stability\".";

/// Menu entry and button.
pub const ADD_TARGET: &str = "Add data of another target…";
/// Heading of the question for its path.
pub const ADD_TARGET_TITLE: &str = "Session with another target of the same sensor";
/// The button below it.
pub const ADD_TARGET_BUTTON: &str = "Add target";
/// Hint of the button.
pub const ADD_TARGET_HINT: &str =
    "Reads a session measured with the same sensor on the same robot; its target is kept in this session";

/// Names of a session's own target.
#[must_use]
pub const fn own_target_name(target: &Target) -> &'static str {
    match target {
        Target::Ball { .. } => "ball",
        Target::RightAnglePlate => "plate",
        Target::Point => "tip",
        Target::Pose { .. } => "target",
        Target::Workpiece => "workpiece",
        Target::Rgbd { .. } => "sequence",
    }
}

/// A target from a session without a name is called as its file.
#[must_use]
pub fn target_name_from_file(file_name: &str) -> String {
    if file_name.trim().is_empty() { "target".to_owned() } else { file_name.to_owned() }
}

/// Why a session cannot be a further target.
#[must_use]
pub fn other_mount(file: &str) -> String {
    format!(
        "{file} was not added: its sensor is mounted otherwise (on the flange, or beside the robot), so it is another calibration. \
         Choose a session of the same sensor"
    )
}

/// What the section is for.
pub const DISTANCES_HINT: &str =
    "Points of a plate's edges against the lines and the plane fitted to them (Chen et al. 2023, Figs. 3 and 4)";
/// What the section is for.
pub const STABILITY_HINT: &str = "A known point measured many times through each calibration (Table 3), and the matrices beside each other (Table 2)";
/// What the section is for.
pub const CROSS_TARGET_HINT: &str = "Every calibration on the data of every target of this session";
/// What the section is for.
pub const WORKPIECE_HINT: &str = "A scanned part: planes, teeth, diameters (Figs. 6 to 8)";
/// While a session is read.
pub const ADDING: &str = "reading the other target …";

/// How far the verification is.
#[must_use]
pub fn progress(done: usize, total: usize) -> String {
    if total == 0 { "verifying …".to_owned() } else { format!("verifying {done}/{total}") }
}

/// Where there is no plate.
pub const NO_PLATE: &str = "No plate was measured in this session. Add a session with a right-angle plate that the same sensor saw: the \
distances of its points from the fitted lines and plane show what the calibration is worth.";
/// Where there is neither a ball nor a tip.
pub const NO_PLACE: &str = "No ball or tip was measured in this session. Add a session with one that the same sensor saw from many poses: \
how far its place scatters shows what the calibration is worth.";
/// Where there is no target.
pub const NO_TARGET: &str =
    "This session has nothing to be calibrated from or verified on. Add the data of a ball, a tip or a plate.";
/// Heads of a table.
pub const CALIBRATION: &str = "calibration";
/// Head over figures, unit included.
pub const TO_LINES: &str = "distance to lines / mm";
/// Head over figures, unit included.
pub const TO_PLANE: &str = "distance to plane / mm";
/// Head over figures.
pub const BETWEEN_LINES: &str = "between the lines";
/// Head of a column.
pub const MEAN: &str = "mean";
/// Head of a column.
pub const SPREAD: &str = "sd";
/// Head of a column.
pub const MAXIMUM: &str = "max";
/// Head of a column.
pub const RMS: &str = "RMS / mm";
/// Head of a column.
pub const ANGLE: &str = "angle p–q";
/// Head of a column.
pub const GAP: &str = "gap / mm";
/// Title of the card with the figures.
pub const DISTANCES_TABLE: &str = "Distances of the points from the lines and the plane";
/// What the distances are measured from.
pub const DISTANCES_OF: &str = "each edge's line and the plane are fitted freely to the points";
/// Beside a calibration on its own data.
pub const OWN_DATA: &str = "own data";
/// What that means.
pub const OWN_DATA_HINT: &str = "Computed from these very data: its errors here are in sample. Click to show it below";
/// The opposite.
pub const OTHER_DATA_HINT: &str = "Click to show it below";
/// Title of a histogram.
pub const LINE_HISTOGRAM: &str = "Points by distance to their line";
/// Title of a histogram.
pub const PLANE_HISTOGRAM: &str = "Points by distance to the plane";
/// Title of an axis.
pub const LINE_AXIS: &str = "distance to line / mm";
/// Title of an axis.
pub const PLANE_AXIS: &str = "distance to plane / mm";
/// Title of an axis.
pub const POINTS_AXIS: &str = "points";
/// Title of an axis.
pub const STATION_AXIS: &str = "station";
/// Title of an axis.
pub const ERROR_AXIS: &str = "error / mm";
/// Title of the picture.
pub const IN_SPACE: &str = "Points, lines and plane in the base";
/// How the picture is handled.
pub const SPACE_HINT: &str = "drag to turn, scroll to zoom, double click to reset";

/// The picture's name for screen readers.
#[must_use]
pub fn space_name(calibration: &str) -> String {
    format!("Points, lines and plane of {calibration} in space; arrow keys turn it")
}

/// How much larger deviations are drawn.
#[must_use]
pub fn enlarged(factor: &str) -> String {
    if factor == "1" { "true scale".to_owned() } else { format!("deviations × {factor}") }
}

/// A bin under the pointer.
#[must_use]
pub fn bin_readout(calibration: &str, from: &str, to: &str, count: usize) -> String {
    format!("{calibration}: {count} from {from} to {to} mm")
}

/// A point under the pointer.
#[must_use]
pub fn point_readout(label: &str, edge: Edge, to_line: &str, to_plane: &str) -> String {
    format!("station {label}, edge {}: {to_line} mm off its line, {to_plane} mm off the plane", edge_letter(edge))
}

/// A bar under the pointer.
#[must_use]
pub fn station_readout(label: &str, calibration: &str, error: &str) -> String {
    format!("station {label}, {calibration}: {error} mm")
}

/// Name of the control that selects a calibration.
#[must_use]
pub fn show_calibration(name: &str) -> String {
    format!("Show {name}")
}

/// Name of the control that shows a calibration's columns.
#[must_use]
pub fn show_column(name: &str) -> String {
    format!("Columns of {name}")
}

/// Name of the control that shows a calibration in charts.
#[must_use]
pub fn show_in_charts(name: &str) -> String {
    format!("{name} in charts")
}

/// What it does.
pub const SHOW_IN_CHARTS_HINT: &str = "Click to hide it in the charts, or to show it again";
/// Where all are hidden.
pub const ALL_HIDDEN: &str = "Choose a calibration above to see its bars.";

/// Name of the control that shows a target's stations.
#[must_use]
pub fn show_target(name: &str) -> String {
    format!("Show stations of {name}")
}

/// Title of the table like Table 3.
pub const STABILITY_TABLE: &str = "A known point, measured many times";
/// What its rows are.
pub const FROM_TOUCHED: &str = "measured − touched point";
/// What its rows are.
pub const FROM_MEAN: &str = "measured − mean of each calibration; enter the touched point to see its offset";
/// Where all columns are hidden.
pub const NO_COLUMN: &str = "Choose a calibration above to see its columns.";
/// Head of the column of labels.
pub const NUMBER: &str = "no.";
/// Label of a row.
pub const THREE_DELTA: &str = "3δ";
/// Label of a row.
pub const THREE_DELTA_3D: &str = "3δ in 3D / mm";
/// Before the fields of the touched point.
pub const TOUCHED: &str = "Touched point in the base";
/// What it is.
pub const TOUCHED_HINT: &str =
    "Where a calibrated tip touched the point (for a ball: its centre); without it the mean takes its place";
/// Button.
pub const SET_TOUCHED: &str = "Set point";
/// Why it is disabled.
pub const TOUCHED_MISSING: &str = "Type all three coordinates, in mm";
/// Button.
pub const CLEAR_TOUCHED: &str = "Forget point";

/// Name of a field.
#[must_use]
pub fn touched_axis(axis: &str) -> String {
    format!("Touched point, {axis}")
}

/// Title of the card.
pub const MATRICES: &str = "Calibrations beside each other (flange_from_sensor, mm)";
/// Names of the two lists.
pub const MATRIX_CHOICE: [&str; 2] = ["Left matrix", "Right matrix"];

/// How two matrices differ.
#[must_use]
pub fn matrix_difference(shift: &[String; 3], rotation_deg: &str, at_point_mm: &str, distance_mm: &str) -> String {
    let [x, y, z] = shift;
    format!(
        "Right minus left: Δx {x}, Δy {y}, Δz {z} mm, turned by {rotation_deg}°; {at_point_mm} mm at a point {distance_mm} mm before the sensor"
    )
}

/// Title of the card.
pub const PASTED: &str = "A matrix from elsewhere: is it a calibration?";
/// What a screen reader calls its field.
pub const PASTED_FIELD: &str = "Numbers of the matrix";
/// What it is for.
pub const PASTE_HINT: &str = "Paste a matrix from a paper, another program or the controller: it is checked for being a rotation, and can be \
judged on the data of this session beside the others.";
/// Example in the field.
pub const PASTE_EXAMPLE: &str = "3 × 4 or 4 × 4 numbers, row by row:\n0.998 −0.021 −0.056 −7.806\n0.001 0.944 −0.331 123.890\n0.006 0.331 0.942 −79.412";
/// Name of a calibration without one.
pub const GIVEN_NAME: &str = "pasted";
/// Name of a field.
pub const GIVEN_NAME_FIELD: &str = "Name of the matrix";
/// Button.
pub const GIVE: &str = "Judge it along";
/// What it does.
pub const GIVE_HINT: &str = "Adds the nearest rotation with this translation to all tables of this step";
/// Why it is disabled.
pub const GIVE_MISSING: &str = "Paste a matrix first";
/// Label of a figure.
pub const DEFECT: &str = "Largest defect of lengths and products";
/// Label of figures.
pub const COLUMN_LENGTHS: &str = "Lengths of the columns";
/// Label of figures.
pub const COLUMN_PRODUCTS: &str = "Products of columns 1·2, 1·3, 2·3";
/// Label of a figure.
pub const DETERMINANT: &str = "Determinant";
/// Label of a figure.
pub const TO_NEAREST: &str = "Largest turn of a column to the nearest rotation";
/// Label of a matrix.
pub const NEAREST: &str = "nearest rotation";

/// The defect, and what rounding explains.
#[must_use]
pub fn defect(defect: &str, rounding: &str) -> String {
    format!("{defect} (rounding {rounding})")
}

/// Name of the button that forgets a given calibration.
#[must_use]
pub fn withdraw(name: &str) -> String {
    format!("Forget {name}")
}

/// Title of the table.
pub const CROSS_TABLE: &str = "Every calibration on every target";
/// What its figures are.
pub const CROSS_TABLE_HINT: &str = "ball and tip: scatter of its place; plate: distance to its lines; dim: own data";
/// Where there is only the session's own target.
pub const ONLY_OWN: &str = "Only the session's own target so far, which proves little: add the data of another one that the same sensor measured.";
/// Title of the card.
pub const JOINT: &str = "All targets together";
/// Head of a column.
pub const TARGET: &str = "target";
/// Head of a column.
pub const STD_ALONE: &str = "σ point, alone / mm";
/// Head of a column.
pub const STD_JOINT: &str = "σ point, together / mm";
/// Head of a column.
pub const MOVED: &str = "moved / mm";
/// Head of a column.
pub const P_VALUE: &str = "by chance";

/// Targets whose own calibrations are as far from the joint one as this less often by chance are said to contradict it.
pub const CONTRADICTED_BELOW: f64 = 0.01;

/// A target whose own calibration is too far from the joint one.
#[must_use]
pub fn contradicts(p_value: &str) -> String {
    format!("! {p_value} contradicts")
}

/// Title of the list.
pub const FURTHER: &str = "Further targets in this session";
/// Button.
pub const REMOVE: &str = "Remove";
/// What it does.
pub const REMOVE_HINT: &str = "Takes the target and its stations out of the session; undo brings them back";

/// Title of the bars.
#[must_use]
pub fn errors_per_station(target: &str) -> String {
    format!("Errors per station: {target}")
}

/// Name of the field with a target's name.
#[must_use]
pub fn name_of(target: &str) -> String {
    format!("Name of {target}")
}

/// What a further target is.
#[must_use]
pub fn further_figures(target: &Target, used: usize, stations: usize) -> String {
    format!("{} · {used} of {stations} stations used", super::start::target(target))
}

/// The name of a calibration: what it was computed from and how.
#[must_use]
pub fn calibration_name(origin: &Origin, verification: &Verification) -> String {
    match origin {
        Origin::Solved { target_idx: 0, method } => method_name(*method).to_owned(),
        Origin::Solved { target_idx, method } => match verification.targets.get(*target_idx) {
            Some(target) => format!("{}, {}", target.name, method_short_name(*method)),
            None => method_name(*method).to_owned(),
        },
        Origin::Joint { .. } => "All targets together".to_owned(),
        Origin::Given { name, is_nearest: true } => nearest_of(name),
        Origin::Given { name, is_nearest: false } => name.clone(),
    }
}

/// A matrix in whose place the nearest rotation is taken.
#[must_use]
pub fn nearest_of(name: &str) -> String {
    format!("{name} (nearest rotation)")
}

/// The letter of an edge.
#[must_use]
pub const fn edge_letter(edge: Edge) -> &'static str {
    match edge {
        Edge::P => "p",
        Edge::Q => "q",
    }
}

/// Whether a matrix is a rotation, in one sentence.
#[must_use]
pub fn matrix_verdict(check: &MatrixCheck) -> String {
    if check.is_rotation() {
        return "A rotation, as far as its digits tell".to_owned();
    }
    if check.nearest.is_none() {
        return "Not a rotation, and none is near it".to_owned();
    }
    if check.determinant < 0.0 && check.suspects.is_empty() {
        return "Not a rotation but a mirror image: one axis points the other way".to_owned();
    }
    "Not a rotation".to_owned()
}

/// Decimals of figures of a matrix: those that it was written with.
#[must_use]
pub fn matrix_decimals(check: &MatrixCheck) -> usize {
    check.decimals.clamp(2, 6)
}

/// An angle between columns, as exact as the matrix was written.
#[must_use]
pub fn matrix_angle(check: &MatrixCheck, angle_rad: f64) -> String {
    // A degree is some hundredths.
    format!("{}°", fixed(angle_rad.to_degrees(), matrix_decimals(check).saturating_sub(2).max(1)))
}

fn column_fault(check: &MatrixCheck, fault: &ColumnFault) -> String {
    match fault {
        ColumnFault::Length { column, length } => {
            format!("column {} is {} long", column + 1, fixed(*length, matrix_decimals(check)))
        }
        ColumnFault::Angle { columns: [a, b], angle_rad } => {
            format!("columns {} and {} stand at {}", a + 1, b + 1, matrix_angle(check, *angle_rad))
        }
    }
}

/// What is probably misprinted, and what is wrong even then; where several misprints are as likely, all of them.
#[must_use]
pub fn suspects_sentence(check: &MatrixCheck) -> Option<String> {
    let one = |suspect: &Suspect| {
        let decimals = matrix_decimals(check);
        let left = match suspect.faults_then.first() {
            Some(worst) => format!(
                ", still {:.0} times what rounding explains ({})",
                suspect.defect_then / check.rounding,
                column_fault(check, worst)
            ),
            None => ", which rounding explains".to_owned(),
        };
        format!(
            "row {}, column {} is {}; with {} there the defect falls to {}{left}",
            suspect.row + 1,
            suspect.column + 1,
            fixed(suspect.found, decimals),
            fixed(suspect.likely, decimals),
            fixed(suspect.defect_then, decimals),
        )
    };
    let all: Vec<String> = check.suspects.iter().map(one).collect();
    let joined = all.join(". Or ");
    let mut letters = joined.chars();
    let first = letters.next()?;
    Some(first.to_uppercase().chain(letters).collect())
}

/// First line of `handeye verify`.
#[must_use]
pub fn verify_head(session: &str, calibrations: usize, targets: usize) -> String {
    let plural = super::plural;
    format!("{session} · {calibrations} calibration{} on {targets} target{}\n", plural(calibrations), plural(targets))
}

/// Why there is nothing to verify.
#[must_use]
pub fn nothing_to_verify(reason: &str) -> String {
    let reason = if reason.is_empty() { "no target is one to calibrate from" } else { reason };
    format!("no calibration was computed ({reason}); give one with --calibration")
}

/// Whether a matrix that was given is a rotation, and what may be wrong with it.
#[must_use]
pub fn matrix_lines(name: &str, check: &MatrixCheck) -> String {
    let found = (!check.is_rotation()).then(|| defect_line(check));
    let lines: Vec<String> =
        found.into_iter().chain(suspects_sentence(check)).map(|line| format!("  {line}\n")).collect();
    format!("{name}: {}\n{}", matrix_verdict(check), lines.concat())
}

/// Why a session by itself gives nothing to verify; one that holds scans has another command.
#[must_use]
pub fn nothing_own(reason: &str, has_scans: bool) -> String {
    let elsewhere = if has_scans { "; `handeye scan` measures its scans through a calibration" } else { "" };
    format!("{reason}{elsewhere}")
}

/// How far a matrix is from a rotation, in two lines.
#[must_use]
pub fn defect_line(check: &MatrixCheck) -> String {
    let angle = check.angle_rad.map_or_else(String::new, |angle| {
        format!("; the nearest rotation, which is taken instead, turns a column by {}", matrix_angle(check, angle))
    });
    let faults: Vec<String> = check.faults.iter().map(|fault| column_fault(check, fault)).collect();
    let decimals = matrix_decimals(check);
    format!(
        "the largest element of RᵀR − 1 is {}, by rounding at most {}; the determinant is {}{angle}\n  {}",
        fixed(check.defect, decimals),
        value(check.rounding, Some(check.rounding)),
        fixed(check.determinant, decimals),
        faults.join(", ")
    )
}

/// Where the session holds scans, which are measured by another command.
#[must_use]
pub fn scans_elsewhere(file: &str) -> String {
    format!(
        "\nthe session holds scans of a workpiece; planes, teeth and diameters through a calibration are measured by\n  \
         handeye scan {file} --calibration RESULT.json\n"
    )
}

/// Profiles of a target in which nothing was found.
#[must_use]
pub fn refused(target: &str, num_refused: usize, num_captures: usize) -> String {
    format!("{target}: {num_refused} of {num_captures} profiles were refused")
}

/// One of them.
#[must_use]
pub fn refused_capture(station: &str, reason: &str) -> String {
    format!("{station}: {reason}")
}

/// So many more of them.
#[must_use]
pub fn more_refused(count: usize) -> String {
    format!("and {count} more; --json has them all")
}

/// Heads the calibration from all targets.
pub const JOINT_HEAD: &str = "\nall targets together\n";

/// Why there is no calibration from all targets.
#[must_use]
pub fn no_joint(reason: &str) -> String {
    format!("\nall targets together: {reason}\n")
}

/// Heads the table of what each target says of the joint calibration.
#[must_use]
pub fn joint_targets_head(width: usize) -> String {
    format!("{:<width$}{STD_ALONE:>20}{STD_JOINT:>24}{MOVED:>13}{P_VALUE:>14}\n", "")
}

/// A row of it.
#[must_use]
pub fn joint_target(name: &str, width: usize, lengths_mm: [f64; 3], p_value: f64) -> String {
    let [alone, together, moved] = lengths_mm.map(|length| fixed(length, 3));
    let contradiction = if p_value < CONTRADICTED_BELOW { contradicts("") } else { String::new() };
    format!("  {name:<width$}{alone:>18}{together:>24}{moved:>13}{:>14}{contradiction}", fixed(p_value, 4))
}

/// What two of its columns mean.
pub const JOINT_HINT: &str =
    "moved: from where the target alone puts the workspace point · by chance: how often noise alone moves it so far";

/// Heads the table of distances.
#[must_use]
pub fn distances_head(target: &str, points: usize, width: usize) -> String {
    format!(
        "\ndistances of {points} points from the fitted lines and plane / mm: {target}\n\
         {:<width$}{:>8}{:>8}{:>8}  {:>8}{:>8}{:>8}  {:>9}{:>8}\n",
        "", "line", "sd", "max", "plane", "sd", "max", "angle/°", "gap"
    )
}

/// Heads the stability tables.
#[must_use]
pub fn stability_head(target: &str, is_touched: bool) -> String {
    let reference = if is_touched { "touched point" } else { "mean" };
    format!("\nmeasured − {reference} / mm: {target}\n")
}

/// Heads the cross-target table.
pub const CROSS_TABLE_HEAD: &str = "\nevery calibration on every target, RMS / max in mm\n";
/// Below all tables.
pub const OWN_DATA_FOOT: &str = "* computed from these data\n";
