//! Wording of the pose table.

use crate::calibrate::{Side, SideChoice, Warning};
use crate::geometry::PoseNotation;
use crate::session::check::Finding;
use crate::session::table::{Column, column_name, column_unit};
use crate::session::{Row, Target};

use super::plural;

/// Column.
pub const CHECK: &str = "check";
/// Nothing is the matter.
pub const FINE: &str = "Nothing to remark";
/// The station takes no part.
pub const LEFT_OUT: &str = "Left out by you";
/// Button.
pub const UNFOLD_ALL: &str = "Unfold all";
/// Button.
pub const FOLD_ALL: &str = "Fold all";
/// The table of a sequence.
pub const NO_POSES_OF_SEQUENCE: &str = "Nothing to edit here";
/// Where the poses of a sequence are.
pub const POSES_OF_SEQUENCE: &str = "The robot's poses stand in the folder of the sequence, in flange.txt.";
/// A session without stations.
pub const EMPTY: &str = "No stations yet";
/// How a session without stations gets some.
pub const NO_STATIONS: &str =
    "Add a station (Insert), paste a table of poses (Ctrl+V), or import files of poses and profiles (Ctrl+I).";

/// Button.
pub const ADD: &str = "Add station";
/// Its name and shortcut.
pub const ADD_HINT: &str = "Add a station below (Insert or Ctrl+Shift+N)";
/// Button.
pub const DUPLICATE: &str = "Duplicate";
/// Its name and shortcut.
pub const DUPLICATE_HINT: &str = "Duplicate the selected rows (Ctrl+Shift+D)";
/// Button.
pub const DELETE: &str = "Delete";
/// Its name and shortcut.
pub const DELETE_HINT: &str = "Delete the selected rows (Ctrl+Delete)";
/// A button's name and shortcut.
pub const MOVE_UP_HINT: &str = "Move the selected stations up (Alt+Up)";
/// A button's name and shortcut.
pub const MOVE_DOWN_HINT: &str = "Move the selected stations down (Alt+Down)";
/// Button.
pub const SORT: &str = "Sort";
/// Its name, and what else does it.
pub const SORT_BUTTON_HINT: &str = "Sort by the column of the cursor (or click a column's head)";
/// Tip of a column's head.
pub const SORT_HINT: &str = "Sort the stations by this column; once more turns the order around";
/// Button.
pub const FILL: &str = "Fill down";
/// Its name and shortcut.
pub const FILL_HINT: &str = "Fill the first selected row into those below (Ctrl+D)";
/// Button.
pub const COPY: &str = "Copy";
/// Its name and shortcut.
pub const COPY_HINT: &str = "Copy the selected cells for a spreadsheet (Ctrl+C)";
/// Button.
pub const PASTE: &str = "Paste";
/// Its name and shortcut.
pub const PASTE_HINT: &str = "Paste cells, or poses in any form (Ctrl+V)";
/// Button beside the count of texts that wait.
pub const GO_THERE: &str = "Show";
/// The line below the table, where there is nothing else to say.
pub const KEYS_HINT: &str = "Type to replace · Enter or F2 to edit · Tab goes right · Shift extends · Ctrl+C, Ctrl+V with spreadsheets · Ctrl+D fills down";
/// What was asked to be emptied cannot be empty.
pub const NOT_CLEARED: &str = "A pose and a label cannot be empty; Ctrl+Delete deletes the row.";
/// Tip of the poses of a sweep that is folded.
pub const FIRST_OF_SWEEP: &str = "The first capture of a sweep; editing unfolds it";
/// Check of a capture in whose profile the target was not found.
#[must_use]
pub const fn not_found(target: &Target) -> &'static str {
    match target {
        Target::Ball { .. } => "no arc",
        Target::RightAnglePlate => "no edge",
        Target::Point => "no tip",
        Target::Pose { .. } | Target::Workpiece | Target::Rgbd { .. } => "nothing found",
    }
}

/// A column's head: name and unit.
#[must_use]
pub fn column_head(notation: &PoseNotation, column: Column) -> String {
    match column_unit(notation, column) {
        "" => column_name(notation, column).to_owned(),
        unit => format!("{} / {unit}", column_name(notation, column)),
    }
}

/// What a column's head does, as screen readers say it.
#[must_use]
pub fn sort_by(head: &str) -> String {
    format!("Sort by {head}")
}

/// A cell's name for screen readers: its column and its row.
#[must_use]
pub fn cell_name(notation: &PoseNotation, column: Column, row_name: &str) -> String {
    format!("{} of {row_name}", column_name(notation, column))
}

/// Name of a row's head.
#[must_use]
pub fn row_head(row_name: &str) -> String {
    format!("Row of station {row_name}")
}

/// Name of a row's check.
#[must_use]
pub fn check_of(label: &str, row: Row) -> String {
    match row {
        Row::Station(_) => format!("check of {label}"),
        Row::Capture(place) => format!("check of {}", capture_name(label, place.capture_idx + 1)),
    }
}

/// A capture in the label's column, below its station.
#[must_use]
pub fn capture_of(capture_number: usize) -> String {
    format!("   .{capture_number}")
}

/// Behind a sweep's label.
#[must_use]
pub fn num_captures(number: usize) -> String {
    format!("×{number}")
}

/// An entry of a list of choices.
#[must_use]
pub fn choice(text: &str) -> String {
    if text == "-" { "−".to_owned() } else { text.to_owned() }
}

/// Check of a station with the pose of another.
#[must_use]
pub fn same_as(label: &str) -> String {
    format!("same as {label}")
}

/// A finding in a word or two, for the check column.
#[must_use]
pub fn finding_word(finding: &Finding) -> String {
    match finding {
        Finding::TwinStations { twin_label, .. } => same_as(twin_label),
        Finding::NoReading { .. } => "no profile".to_owned(),
        Finding::EmptyProfile { .. } => "no points".to_owned(),
        Finding::StepDiffersFromPose { .. } => "step".to_owned(),
        Finding::PointOutsidePlane { .. } => "off the plane".to_owned(),
        Finding::FarPose { .. } => "out of reach".to_owned(),
        Finding::FarFromOthers { .. } => "far off".to_owned(),
        Finding::QuaternionsNormalised { .. }
        | Finding::NoStations
        | Finding::FewStations { .. }
        | Finding::EdgeWithoutStations { .. }
        | Finding::FewOnEdge { .. }
        | Finding::InFurther { .. }
        | Finding::NoiseNotGiven { .. } => String::new(),
    }
}

/// A warning about a station in a word or two, for the check column.
#[must_use]
pub const fn warning_word(warning: &Warning) -> &'static str {
    match warning {
        Warning::ArcLargerThanBall { .. } => "large arc",
        Warning::StationSkipped { .. } => "not used",
        Warning::TravelOffNormal { .. } => "travel",
        Warning::PeakNotCovered { .. } => "no peak",
        Warning::StationStandsOut { .. } => "stands out",
        Warning::BlindInY { .. } => "blind in y",
        Warning::SideAmbiguous { .. } => "side",
        _ => "look",
    }
}

/// The check of a row with something to look at.
#[must_use]
pub fn check_mark(word: &str, num_notes: usize) -> String {
    if num_notes > 1 { format!("! {word} +{}", num_notes - 1) } else { format!("! {word}") }
}

/// Behind the notes that a tip lists.
#[must_use]
pub fn more_notes(number: usize) -> String {
    format!("and {number} more")
}

/// The check of a row with texts that are not in the document.
#[must_use]
pub fn waiting(reason: &str, number: usize) -> String {
    let word = if reason.starts_with("not a rotation") { "not a rotation" } else { "not read" };
    if number > 1 { format!("! {word} ×{number}") } else { format!("! {word}") }
}

/// Why the text of a cell is not in the document.
#[must_use]
pub fn not_taken(text: &str, reason: &str) -> String {
    let shown: String = text.chars().take(40).collect();
    format!("\"{shown}\" is not in the session: {reason}")
}

/// How many texts are not in the document.
#[must_use]
pub fn refused_cells(number: usize) -> String {
    let (verb, text) = if number == 1 { ("is", "a text that") } else { ("are", "texts that") };
    format!(
        "{number} cell{} hold{} {text} {verb} not in the session.",
        plural(number),
        if number == 1 { "s" } else { "" }
    )
}

/// What was deleted.
#[must_use]
pub fn deleted(num_rows: usize) -> String {
    format!(
        "Deleted {num_rows} row{}; Ctrl+Z brings {} back.",
        plural(num_rows),
        if num_rows == 1 { "it" } else { "them" }
    )
}

/// What was pasted.
#[must_use]
pub fn pasted(
    [num_rows, num_columns]: [usize; 2],
    num_refused: usize,
    num_held_back: usize,
    num_left_out: usize,
) -> String {
    let waits = if num_refused == 1 { "waits" } else { "wait" };
    let stations_are = if num_held_back == 1 { "station is" } else { "stations are" };
    let parts = [
        (true, format!("Pasted {num_rows} × {num_columns} cells.")),
        (num_refused > 0, format!("{num_refused} could not be read and {waits} in place.")),
        (num_held_back > 0, format!("{num_held_back} new {stations_are} left out until then.")),
        (num_left_out > 0, format!("{num_left_out} had no cell to go to.")),
    ];
    parts.into_iter().filter(|(is_so, _)| *is_so).map(|(_, part)| part).collect::<Vec<_>>().join(" ")
}

/// Nothing was pasted.
#[must_use]
pub fn not_pasted(reason: &dyn std::fmt::Display) -> String {
    format!("Nothing was pasted: {reason}.")
}

/// Title's right side.
#[must_use]
pub fn usage(num_enabled: usize, num_stations: usize) -> String {
    format!("{num_enabled} of {num_stations} stations take part")
}

/// Name of a row's checkbox.
#[must_use]
pub fn use_station(label: &str) -> String {
    format!("Use station {label}")
}

/// Name of a row's fold button.
#[must_use]
pub fn unfold_station(label: &str) -> String {
    format!("Show the captures of station {label}")
}

/// Name of a row's fold button.
#[must_use]
pub fn fold_station(label: &str) -> String {
    format!("Hide the captures of station {label}")
}

/// A capture's name in the table, from 1.
#[must_use]
pub fn capture_name(station_label: &str, capture_number: usize) -> String {
    format!("{station_label}.{capture_number}")
}

/// The side as the session has it.
#[must_use]
pub const fn side(side: SideChoice) -> &'static str {
    match side {
        SideChoice::Auto => "auto",
        SideChoice::Given(Side::Plus) => "+",
        SideChoice::Given(Side::Minus) => "−",
    }
}

/// A capture's profile was refused.
#[must_use]
pub fn refused(capture_number: usize, reason: &str) -> String {
    format!("Profile {capture_number}: {reason}")
}
