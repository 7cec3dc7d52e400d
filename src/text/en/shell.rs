//! Wording of the window's frame: menus, rail, inspector, status line, dialogs.

use crate::calibrate::{Method, Mount};
use crate::session::Target;

/// The program's name.
pub const PROGRAM: &str = "Handeye";
/// Menu.
pub const FILE: &str = "File";
/// Menu.
pub const EDIT: &str = "Edit";
/// Menu.
pub const VIEW: &str = "View";
/// Menu.
pub const HELP: &str = "Help";
/// Menu entry and button.
pub const OPEN: &str = "Open…";
/// Menu entry.
pub const OPEN_SAMPLE: &str = "Open sample";
/// Menu entry.
pub const SAVE: &str = "Save";
/// Menu entry.
pub const SAVE_AS: &str = "Save as…";
/// Menu entry.
pub const CLOSE: &str = "Close";
/// Menu entry.
pub const QUIT: &str = "Quit";
/// Menu entry and button.
pub const UNDO: &str = "Undo";
/// Menu entry and button.
pub const REDO: &str = "Redo";
/// Menu entry.
pub const SHORTCUTS_AND_ABOUT: &str = "Shortcuts and about";
/// Menu heading.
pub const THEME: &str = "Theme";
/// Theme.
pub const LIGHT: &str = "Light";
/// Theme.
pub const DARK: &str = "Dark";
/// Theme.
pub const FOLLOW_SYSTEM: &str = "As the system";
/// Menu heading.
pub const SCALE: &str = "Interface scale";
/// Menu entry.
pub const INSPECTOR: &str = "Inspector";
/// Reason of a disabled entry.
pub const NO_DOCUMENT: &str = "There is no open session.";
/// Reason of a disabled entry.
pub const NOTHING_TO_UNDO: &str = "Nothing has been changed.";
/// Reason of a disabled entry.
pub const NOTHING_TO_REDO: &str = "Nothing has been undone.";
/// Title without a document.
pub const NO_TITLE: &str = "no session";
/// Name of the dot that marks unsaved changes.
pub const UNSAVED: &str = "Unsaved changes";
/// A title with what is special about it.
#[must_use]
pub fn title_with(title: &str, remark: &str) -> String {
    format!("{title} ({remark})")
}

/// What the convention chip says on hover.
#[must_use]
pub fn convention_hint(formula: &str) -> String {
    format!("How this robot's controller writes an orientation: {formula}")
}

/// Undo with what it takes back.
#[must_use]
pub fn undo_label(label: &str) -> String {
    format!("Undo: {label}")
}

/// Redo with what it brings back.
#[must_use]
pub fn redo_label(label: &str) -> String {
    format!("Redo: {label}")
}

/// Rail step.
pub const STEP_SESSION: &str = "Session";
/// Rail step.
pub const STEP_ARCS: &str = "Arcs";
/// Rail step.
pub const STEP_POSES: &str = "Poses";
/// Rail step.
pub const STEP_COMPARE: &str = "Compare";
/// Rail step.
pub const STEP_DIAGNOSIS: &str = "Diagnosis";
/// Rail step.
pub const STEP_VERIFY: &str = "Verify";
/// What the rail's step does.
pub const STEP_SESSION_HINT: &str = "Open a session and see what it holds";
/// What the rail's step does.
pub const STEP_ARCS_HINT: &str = "Every profile with what was found of the target in it";
/// What the rail's step does.
pub const STEP_POSES_HINT: &str = "The stations' poses, and which of them take part";
/// What the rail's step does.
pub const STEP_COMPARE_HINT: &str = "The methods side by side";
/// What the rail's step does.
pub const STEP_DIAGNOSIS_HINT: &str = "What is wrong, how sure the result is, and where to measure next";
/// What the rail's step does.
pub const STEP_VERIFY_HINT: &str =
    "What the calibration is worth on other data: lines, planes, a touched point, workpieces";

/// Heading of the page shown where a step has nothing to show.
pub const EMPTY_TITLE: &str = "No session is open";
/// What to do about it.
pub const EMPTY_HINT: &str = "Open a session file or one of the samples; this page then shows its data.";
/// Button that leads there.
pub const CHOOSE_SESSION: &str = "Choose a session";

/// Before the next step's button.
pub const NEXT: &str = "Next";
/// Next step.
#[must_use]
pub const fn next_arcs(target: &Target) -> &'static str {
    match target {
        Target::Ball { .. } => "Look at the arcs",
        Target::RightAnglePlate => "Look at the edges",
        Target::Pose { .. } => "Look at what was seen",
        Target::Rgbd { .. } => "Look at the sequence",
        _ => "Look at the profiles",
    }
}

/// Next step with a workpiece.
pub const NEXT_VERIFY: &str = "See what was scanned";
/// Next step.
pub const NEXT_POSES: &str = "Check the poses";
/// Next step.
pub const NEXT_COMPARE: &str = "Compare the methods";
/// Next step where nothing was found.
pub const NEXT_DIAGNOSIS: &str = "See the diagnosis";
/// Next step.
pub const NEXT_SAVE: &str = "Save the session…";
/// Status.
pub const READING_FILE: &str = "Reading the file …";
/// Status.
pub const OUT_OF_DATE: &str = "out of date";
/// What it means.
pub const OUT_OF_DATE_HINT: &str = "The session has changed since these results were computed.";
/// Button.
pub const CANCEL: &str = "Cancel";
/// Button.
pub const DISMISS: &str = "Dismiss";
/// Name of the progress bar.
pub const SOLVING: &str = "solving";
/// Solves after a cancel.
pub const SOLVE: &str = "Solve";

/// Progress of the solver.
#[must_use]
pub fn solving_progress(done: usize, total: usize) -> String {
    if total == 0 { SOLVING.to_owned() } else { format!("solving {done} / {total}") }
}

/// Next step where something was found.
#[must_use]
pub fn next_findings(number: usize) -> String {
    if number == 1 { "See the finding".to_owned() } else { format!("See the {number} findings") }
}

/// Progress of the diagnosis.
#[must_use]
pub fn diagnosing_progress(done: usize, total: usize) -> String {
    if total == 0 { "examining".to_owned() } else { format!("examining {done} / {total}") }
}

/// `1 station`, `2 stations`.
#[must_use]
pub fn count(number: usize, singular: &str) -> String {
    if number == 1 { format!("1 {singular}") } else { format!("{number} {singular}s") }
}

/// What was solved, and in what time; what there is where nothing is solved.
#[must_use]
pub fn summary(num_stations: usize, captures: &str, elapsed_ms: Option<u128>) -> String {
    let solved = match elapsed_ms {
        None => String::new(),
        Some(0) => ", solved in under 1 ms".to_owned(),
        Some(elapsed_ms) => format!(", solved in {elapsed_ms} ms"),
    };
    format!("{}, {captures}{solved}", count(num_stations, "station"))
}

/// Heading of the inspector.
#[must_use]
pub fn station_heading(label: &str, step: Option<usize>) -> String {
    step.map_or_else(|| format!("Station {label}"), |step| format!("Station {label}, step {step}"))
}

/// Name of the transform that a session is about.
#[must_use]
pub const fn transform_name(mount: Mount) -> &'static str {
    match mount {
        Mount::OnFlange => "flange_from_sensor",
        Mount::Fixed => "base_from_sensor",
    }
}

/// Row of the inspector.
pub const FLANGE_POSITION: &str = "flange";
/// Row of the inspector.
pub const SIDE_OF_BALL: &str = "side of the ball";
/// Row of the inspector.
pub const SECTION_RADIUS: &str = "section radius l";
/// Row of the inspector.
pub const ARC: &str = "arc";
/// Row of the inspector.
pub const FIT: &str = "fit";
/// Row of the inspector.
pub const LARGEST_ARC_AT: &str = "largest arc at y";
/// Row of the inspector.
pub const LEFT_OUT: &str = "left out";
/// What the row means.
#[must_use]
pub fn left_out_hint(method: Method) -> &'static str {
    match method {
        Method::FixedPoint => "Distance between this station's tip and the tip found without it",
        Method::Motion => "Distance between this station's target and the target found without it",
        _ => "Distance between this station's ball and the ball found without it",
    }
}

/// Row of the inspector for a reduced point.
#[must_use]
pub const fn target_in_sensor(target: &Target) -> &'static str {
    match target {
        Target::Ball { .. } => "ball in sensor",
        Target::Point => "tip in sensor",
        Target::Pose { .. } => "target in sensor",
        _ => "point in sensor",
    }
}

/// Row of the inspector: what was found in a profile of a plate or tip.
pub const FOUND: &str = "found";
/// Row of the inspector.
pub const POINT_X: &str = "x";
/// Row of the inspector.
pub const POINT_Z: &str = "z";
/// Row of the inspector.
pub const POINTS_USED: &str = "points used";
/// Row of the inspector.
pub const POINT_NOISE: &str = "noise of a point";
/// Row of the inspector.
pub const PLATE_EDGE: &str = "edge of the plate";
/// Row of the inspector.
pub const OFF_EDGE: &str = "off its edge";
/// What the row means.
pub const OFF_EDGE_HINT: &str = "Distance of this point from the line of its edge, in the base";
/// The same for the left-out error.
pub const OFF_EDGE_LEFT_OUT_HINT: &str = "Distance of this point from its edge as found without this station";

/// Points of a profile that a point rests on.
#[must_use]
pub fn points_used(num_used: usize, num_points: usize) -> String {
    format!("{num_used} of {num_points}")
}

/// Row of the inspector.
pub const RANGE_SEEN: &str = "range seen, z";

/// From one length to another.
#[must_use]
pub fn from_to_mm(from: &str, to: &str) -> String {
    format!("{from} … {to} mm")
}

/// What the side's ratio means.
pub const SIDE_HINT: &str =
    "The side of the laser plane on which the ball's centre lies; the other side costs that many times as much";
/// Row of the inspector.
pub const TRANSLATION: &str = "x y z";
/// Row of the inspector.
pub const TRANSLATION_STD: &str = "± x y z";
/// The station takes no part.
pub const STATION_LEFT_OUT: &str = "This station does not take part.";
/// The station was not used by the method.
pub const STATION_NOT_USED: &str = "This method did not use this station.";
/// Where there is no uncertainty.
pub const NO_UNCERTAINTY: &str = "Nothing is left over to judge the accuracy by.";
/// Before there is a result.
pub const NO_RESULTS: &str = "Not solved yet.";
/// Method picker.
pub const METHOD: &str = "Method shown";
/// Menu button.
pub const COPY: &str = "Copy";
/// Menu entry.
pub const COPY_MATRIX: &str = "Matrix";
/// Menu entry.
pub const COPY_POSE: &str = "Position and angles";
/// Menu entry.
pub const COPY_QUATERNION: &str = "Position and quaternion";
/// Heading of the warnings.
pub const FINDINGS: &str = "Warnings of this method";
/// No warnings.
pub const NO_FINDINGS: &str = "Nothing to remark.";

/// Findings of a kind that are not listed.
#[must_use]
pub fn more_of_a_kind(number: usize, code: &str) -> String {
    format!("and {number} more: {code}")
}

/// Section of an arc, in words.
#[must_use]
pub fn arc_extent(angle_deg: f64, num_inliers: usize, num_points: usize) -> String {
    format!("{angle_deg:.0}°, {num_inliers} of {num_points} points")
}

/// Row of the angles, by the maker's names.
#[must_use]
pub fn angle_names(names: [&str; 3]) -> String {
    names.join(" ")
}

/// Row of the angles' standard deviations.
#[must_use]
pub fn angle_std_names(names: [&str; 3]) -> String {
    format!("± {}", names.join(" "))
}

/// Heading of the question before changes are lost.
#[must_use]
pub fn save_changes_to(title: &str) -> String {
    format!("Save the changes to {title}?")
}

/// The question's explanation.
pub const SAVE_CHANGES_HINT: &str = "Without saving they are lost.";
/// What saving does not save.
#[must_use]
pub fn unread_cells(number: usize) -> String {
    let (texts, are) = if number == 1 { ("text", "is") } else { ("texts", "are") };
    format!("! {number} unreadable {texts} in Poses {are} not part of the session and cannot be saved.")
}

/// Button.
pub const DISCARD: &str = "Discard";
/// Heading of the save dialog.
pub const SAVE_AS_TITLE: &str = "Save the session as";
/// Heading of the question before another file is replaced.
pub const REPLACE_TITLE: &str = "Replace the file that is there?";
/// The question's explanation.
pub const REPLACE_HINT: &str = "This file exists already. What is in it now is lost.";
/// Button.
pub const REPLACE: &str = "Replace";
/// Name of the path field.
pub const FILE_PATH: &str = "File path";
/// Told where the system offers no file dialog.
pub const NO_FILE_DIALOG: &str = "There is no system file dialog here: type the path.";
/// The file filter's name.
pub const FILE_FILTER: &str = "Handeye session";

/// Heading of the help window.
pub const SHORTCUTS: &str = "Shortcuts";
/// Heading of the help window.
pub const ABOUT: &str = "About";
/// The program in a sentence.
pub const ABOUT_TEXT: &str = "A workbench for the hand-eye calibration of robot-mounted laser profilers, after Lin and Mu (2019: ball, fixed point and largest arc) and Chen et al. (2023: right-angle plate, verification). Files of RGB-D sequences (CN102692236) are kept, but not solved.";
/// Shortcut's explanation.
pub const KEYS_RAIL: &str = "go to a step of the rail";
/// Shortcut's explanation.
pub const KEYS_LIST: &str = "previous or next station, or finding in Diagnosis";
/// Shortcut's explanation.
pub const KEYS_STEPS: &str = "previous or next profile of the station, in Arcs";
/// The key.
pub const TAB: &str = "Tab";
/// Shortcut's explanation.
pub const KEYS_TAB: &str = "next control; with Shift the one before";
/// The keys.
pub const SPACE: &str = "Space / Enter";
/// Shortcut's explanation.
pub const KEYS_SPACE: &str = "press the control; Enter mends the finding selected";
/// The key.
pub const ESCAPE: &str = "Esc";
/// Shortcut's explanation.
pub const KEYS_ESCAPE: &str = "close a menu or a question; stop the bootstrap";
/// Shortcut's explanation.
pub const KEYS_SCALE: &str = "make the interface larger or smaller";
/// Shortcut's explanation.
pub const KEYS_SCALE_BACK: &str = "interface in its own size again";
/// The mouse.
pub const DRAG: &str = "Drag";
/// Its explanation.
pub const KEYS_PAN: &str = "move the view of a plot";
/// The mouse.
pub const CTRL_WHEEL: &str = "Ctrl + wheel";
/// Its explanation.
pub const KEYS_ZOOM: &str = "zoom a plot";
/// The mouse.
pub const RIGHT_DRAG: &str = "Right drag";
/// Its explanation.
pub const KEYS_BOX_ZOOM: &str = "zoom a plot to a box";
/// Shortcut's explanation.
pub const KEYS_PLOT: &str = "fit the view of a plot";
/// The keys.
pub const DOUBLE_CLICK: &str = "Double click";

/// Two shortcuts for the same.
#[must_use]
pub fn either_key(first: &str, second: &str) -> String {
    format!("{first} / {second}")
}

/// Version line.
#[must_use]
pub fn version(version: &str) -> String {
    format!("Version {version}")
}

/// The one line told where no window can be opened for want of a display.
pub const NO_DISPLAY: &str =
    "the window needs a display, and there is none here (neither DISPLAY nor WAYLAND_DISPLAY is set)";
/// The one line told where a library is missing.
pub const MISSING_LIBRARIES: &str = "the window could not be opened; on Debian and Ubuntu: apt install libxkbcommon-x11-0 libxcursor1 libxi6 libgl1 libegl1";
/// The one line told where there is no OpenGL.
pub const NO_OPENGL: &str = "the window needs OpenGL; on Debian and Ubuntu: apt install libgl1 libegl1 libgl1-mesa-dri";
/// The one line told where the display does not answer.
pub const DEAD_DISPLAY: &str = "the window could not reach the display";
/// What works all the same.
pub const WITHOUT_WINDOW: &str =
    "`handeye solve FILE` works without one (`handeye report FILE` will, in a later version)";
