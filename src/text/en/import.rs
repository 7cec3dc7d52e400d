//! Wording of the import's preview.

use crate::geometry::notation::{LengthUnit, OrientationForm};
use crate::geometry::{AngleOrder, PoseNotation};
use crate::session::Reading;
use crate::session::import::{Imported, Kind, Note, Part, Role, Separator, Source};

use super::import_bag as bag;
use super::plural;
use super::shell::count;

/// How messages name a pasted text.
pub const PASTED: &str = "pasted text";

/// Menu entry.
pub const IMPORT: &str = "Import poses or profiles…";
/// Menu entry.
pub const IMPORT_FOLDER: &str = "Import folder…";
/// Menu entry and button.
pub const PASTE: &str = "Paste a table of poses";
/// What the button does.
pub const PASTE_HINT: &str = "Copy the table in a spreadsheet, a robot program or a paper; then press this, or Ctrl+V";
/// The keys.
pub const PASTE_KEYS: &str = "Ctrl+V";
/// What a session of a board or marker without stations lacks.
pub const PAIRS_TITLE: &str = "No pairs of poses yet";
/// What they are.
pub const PAIRS_HINT: &str = "Import pairs of poses (CSV): in each row the flange in the base, as the robot reports it, and the board or marker in the camera, as the vision software finds it. Ten or more, turned about two axes; the JSON of moveit_calibration is read as well.";
/// Button.
pub const PAIRS: &str = "Import pairs of poses (CSV)…";
/// The columns, on hover.
pub const PAIRS_COLUMNS: &str =
    "x, y, z and the orientation of the flange, then the same of the target with “target_” in front of the names";
/// Beside the buttons.
pub const PASTE_KEY: &str = "Ctrl+V pastes as well";
/// What the button does.
pub const IMPORT_HINT: &str = "Spreadsheets (CSV), robot programs, profiles, ROS 2 bags; several files at once";
/// What the button does.
pub const IMPORT_FOLDER_HINT: &str = "A folder with poses and numbered profiles";
/// Menu entry.
pub const ADD_SESSION: &str = "Add stations of another session…";
/// Menu entry.
pub const EXPORT_POSES: &str = "Export poses as CSV…";
/// Menu entry.
pub const EXPORT_PROFILES: &str = "Export profiles as CSV…";
/// Reason of a disabled entry.
pub const NO_PROFILES: &str = "This session holds points only, no profiles.";
/// Reason of a disabled entry.
pub const NO_STATIONS: &str = "This session has no stations.";
/// Under the path field of the start page.
pub const ENTRY_HINT: &str = "Poses, profiles or images from elsewhere:";

/// The file filter's name.
pub const IMPORT_FILTER: &str = "Poses and profiles";
/// The file filter's name.
pub const ALL_FILTER: &str = "All files";
/// The file filter's name.
pub const CSV_FILTER: &str = "Table (CSV)";
/// Heading where the path is typed.
pub const IMPORT_PATH_TITLE: &str = "Import a file or a folder";
/// Heading where the path is typed.
pub const ADD_SESSION_PATH_TITLE: &str = "Add the stations of this session";
/// Heading where the path is typed.
pub const EXPORT_POSES_TITLE: &str = "Export the poses as CSV";
/// Heading where the path is typed.
pub const EXPORT_PROFILES_TITLE: &str = "Export the profiles as CSV into the folder";
/// Button where the path is typed.
pub const IMPORT_BUTTON: &str = "Import";
/// Button where the path is typed.
pub const EXPORT_BUTTON: &str = "Export";

/// Heading of the preview.
pub const TITLE: &str = "Import";
/// While the files are being read.
pub const READING: &str = "reading …";
/// Told where the options of last time were taken.
pub const AS_LAST_TIME: &str = "Read as last time";
/// What that means.
pub const AS_LAST_TIME_HINT: &str = "You have set how to read a table with these columns before";
/// Button that does away with them.
pub const FORGET: &str = "Forget";
/// Button that does away with what was set.
pub const RESET: &str = "As recognised";
/// What it does.
pub const RESET_HINT: &str = "Undoes what was set here";

/// Heading.
pub const SOURCES: &str = "Read from";
/// Heading.
pub const TEXT: &str = "Text";
/// Heading.
pub const POSES: &str = "Poses";
/// Heading.
pub const PROFILES: &str = "Profiles";
/// Row.
pub const FORM: &str = "form";
/// Row.
pub const SEPARATOR: &str = "separator";
/// Row.
pub const DECIMAL: &str = "decimal sign";
/// Value.
pub const DECIMAL_POINT: &str = "point, 1.5";
/// Value.
pub const DECIMAL_COMMA: &str = "comma, 1,5";
/// Row.
pub const HEADER: &str = "first row";
/// Value.
pub const HEADER_NAMES: &str = "column names";
/// Value.
pub const HEADER_POSE: &str = "a row like others";
/// Row.
pub const POSITION_UNIT: &str = "positions in";
/// Row.
pub const ORIENTATION: &str = "orientation";
/// Row.
pub const ANGLE_UNIT: &str = "angles in";
/// Value.
pub const DEGREES: &str = "degrees";
/// Value.
pub const RADIANS: &str = "radians";
/// Value.
pub const MILLIMETRES: &str = "millimetres";
/// Value.
pub const METRES: &str = "metres";
/// Row.
pub const POSE_OF: &str = "pose of";
/// Value.
pub const FLANGE: &str = "the flange";
/// Value.
pub const TOOL_POINT: &str = "a tool point";
/// Above its six numbers.
pub const TOOL_POINT_IN_FLANGE: &str = "The tool point in the flange";
/// Row.
pub const POSE_IN: &str = "in";
/// Value.
pub const ROBOT_BASE: &str = "the robot's base";
/// Value.
pub const USER_FRAME: &str = "a user frame";
/// Above its six numbers.
pub const USER_FRAME_IN_BASE: &str = "The user frame in the base";
/// Checkbox.
pub const INVERSE: &str = "inverse: the base as seen from the flange";
/// Row.
pub const PROFILE_UNIT: &str = "x and z in";
/// Checkbox.
pub const MIRROR_Z: &str = "z points the other way";
/// The makers' part of the list of orientations.
pub const MAKERS: &str = "As makers write it";
/// The quaternions' part of it.
pub const QUATERNIONS: &str = "As a quaternion";

/// Heading.
pub const PREVIEW: &str = "What each column means";
/// Heading.
pub const NOTES: &str = "Remarks";
/// Where no station came of the text.
pub const NOTHING: &str = "nothing could be read yet";
/// Head of the column of line numbers.
pub const LINE: &str = "line";
/// Heading where nothing could be read.
pub const BEGINNING: &str = "How the text begins";
/// Where nothing was recognised.
pub const CHOOSE_FORM: &str = "Choose the form at the left if you know it. These forms can be read:";
/// Where the clipboard was empty.
pub const CLIPBOARD_EMPTY: &str = "There is no text on the clipboard. Copy the table, then press Ctrl+V here.";
/// Where nothing was recognised in a pasted text.
pub const PASTE_AGAIN: &str = "Or copy something else and press Ctrl+V.";

/// Field.
pub const NAME: &str = "name";
/// Field.
pub const TARGET: &str = "target";
/// Field.
pub const RADIUS: &str = "radius";
/// Name of the field.
pub const NAME_FIELD: &str = "Name of the session";
/// Name of the list.
pub const TARGET_FIELD: &str = "Target of the session";
/// Name of the field.
pub const RADIUS_FIELD: &str = "Radius of the ball in mm";
/// Unit of the radius.
pub const MM: &str = "mm";
/// Target.
pub const BALL: &str = "ball";
/// Target.
pub const PLATE: &str = "right-angle plate";
/// Target.
pub const POINT: &str = "tip or pin";
/// Target.
pub const POSE: &str = "marker or board";
/// Target.
pub const WORKPIECE: &str = "scanned part";
/// Button.
pub const NEW_SESSION: &str = "Make a new session";
/// Button.
pub const ADD: &str = "Add to the open session";
/// Reason of a disabled button.
pub const NOTHING_OPEN: &str = "No session is open.";
/// Reason of a disabled button.
pub const NOTHING_READ: &str = "There is no station to make it of yet.";
/// Reason of a disabled button.
pub const PROFILES_ONLY: &str = "Profiles belong to poses: import both together.";
/// Reason of a disabled button.
pub const STILL_READING: &str = "The text is still being read.";
/// Reason of a disabled button.
pub const NAME_MISSING: &str = "Give the session a name.";
/// Beside a field that must not stay empty.
pub const NEEDED: &str = "! needed";
/// Reason of a disabled button.
pub const RADIUS_MISSING: &str = "Type the ball's radius in mm, for example 15.";
/// Why there can be no new session yet.
pub const RADIUS_UNUSABLE: &str = "Type a radius from 0.001 to 10 000 mm.";

/// Why poses that have an edge each cannot go there.
pub const EDGES_OF_NO_PLATE: &str = "These poses have a column edge, which only a plate has: choose the right-angle plate, or set the column to be ignored.";

/// The forms, with what they look like.
pub const FORMS: [(Kind, &str); 10] = [
    (Kind::PoseTable, "one pose a row: CSV, TSV, or columns apart by blanks; with points or the names of profiles"),
    (Kind::PrintedTable, "a table of poses and points copied from a paper, with q0=…, t1=…, xs=…"),
    (Kind::FanucProgram, "the positions P[…] of a .ls file"),
    (Kind::AbbModule, "the robtargets of a .mod file"),
    (Kind::KukaProgram, "POS and E6POS of a .src or .dat file"),
    (Kind::UrScript, "p[…] in a script or a list"),
    (Kind::Profile, "rows of x and z; of several files each belongs to the pose of its number"),
    (Kind::ProfileColumns, "x in the first column, z of one profile in each other"),
    (Kind::Yaml, "lists of points, with or without poses"),
    (Kind::PosePairs, "a JSON list of pairs of 4 × 4 matrices: the flange in the base, the target in the camera"),
];

/// What a source was taken for.
#[must_use]
pub const fn kind(kind: Kind) -> &'static str {
    match kind {
        Kind::Session => "Handeye session",
        Kind::PoseTable => "table of poses",
        Kind::PrintedTable => "printed table",
        Kind::FanucProgram => "FANUC program",
        Kind::AbbModule => "ABB module",
        Kind::KukaProgram => "KUKA program",
        Kind::UrScript => "UR script",
        Kind::Profile => "profile",
        Kind::ProfileColumns => "profiles in columns",
        Kind::PosePairs => "pairs of poses",
        Kind::Yaml => "YAML",
        Kind::RosBag => "ROS 2 bag",
    }
}

/// What separates the cells.
#[must_use]
pub const fn separator(separator: Separator) -> &'static str {
    match separator {
        Separator::Comma => "comma",
        Separator::Semicolon => "semicolon",
        Separator::Tab => "tab",
        Separator::Blanks => "blanks",
    }
}

/// The unit of lengths, spelt out.
#[must_use]
pub const fn length_unit(unit: LengthUnit) -> &'static str {
    match unit {
        LengthUnit::Millimetres => MILLIMETRES,
        LengthUnit::Metres => METRES,
    }
}

/// What a column means, with its unit.
#[must_use]
pub fn role(role: Role, notation: &PoseNotation, point_unit: LengthUnit) -> String {
    let axis = |idx: usize| ["x", "y", "z"].get(idx).copied().unwrap_or("?");
    match role {
        Role::Ignore => "not used".to_owned(),
        Role::Label => "station".to_owned(),
        Role::Position(idx) => format!("{} / {}", axis(idx), notation.length_unit.symbol()),
        Role::Orientation(idx) => orientation_number(idx, notation),
        Role::Point(idx) => format!("point {} / {}", axis(idx), point_unit.symbol()),
        Role::Target(idx @ 0..3) => format!("target {}", axis(idx)),
        Role::Target(idx) => format!("target {}", orientation_number(idx - 3, notation)),
        Role::Side => "side".to_owned(),
        Role::Edge => "edge".to_owned(),
        Role::Used => "used".to_owned(),
        Role::Step => "step / mm".to_owned(),
        Role::Profile => "profile".to_owned(),
        Role::Notation => "notation".to_owned(),
    }
}

/// A number of the orientation, with its unit.
#[must_use]
pub fn orientation_number(idx: usize, notation: &PoseNotation) -> String {
    let name = notation.orientation_names().get(idx).copied().unwrap_or("?");
    match notation.orientation {
        OrientationForm::Angles => format!("{name} / {}", notation.angle_unit.symbol()),
        OrientationForm::QuaternionWxyz | OrientationForm::QuaternionXyzw => name.to_owned(),
    }
}

/// How an orientation is written.
#[must_use]
pub const fn orientation_form(form: OrientationForm, convention: &'static str) -> &'static str {
    match form {
        OrientationForm::Angles => convention,
        OrientationForm::QuaternionWxyz => "quaternion w x y z",
        OrientationForm::QuaternionXyzw => "quaternion x y z w",
    }
}

/// The rotation spelt out.
#[must_use]
pub fn orientation_meaning(notation: &PoseNotation) -> String {
    match notation.orientation {
        OrientationForm::Angles if notation.convention.order == AngleOrder::RotationVector => {
            "axis times angle".to_owned()
        }
        OrientationForm::Angles => notation.convention.formula.to_owned(),
        OrientationForm::QuaternionWxyz => "the real part first".to_owned(),
        OrientationForm::QuaternionXyzw => "the real part last".to_owned(),
    }
}

/// Name of the control in a row of settings.
#[must_use]
pub fn setting(label: &str) -> String {
    format!("Setting: {label}")
}

/// Name of the list over a column of the preview.
#[must_use]
pub fn column_role(number: usize) -> String {
    format!("Meaning of column {number}")
}

/// Name of one of six numbers.
#[must_use]
pub fn frame_number(frame: &str, number: &str) -> String {
    format!("{frame}: {number}")
}

/// What a source gave.
#[must_use]
pub fn part(part: &Part) -> String {
    let mut gave = Vec::new();
    if part.num_poses > 0 {
        gave.push(count(part.num_poses, "pose"));
    }
    if part.num_readings > 0 {
        gave.push(match part.kind {
            Kind::PoseTable | Kind::PrintedTable => count(part.num_readings, "point"),
            Kind::Profile | Kind::ProfileColumns | Kind::RosBag => count(part.num_readings, "profile"),
            _ => count(part.num_readings, "reading"),
        });
    }
    let what = kind(part.kind);
    match (part.kind, part.num_readings) {
        (Kind::Session, _) | (Kind::Profile, 1) => what.to_owned(),
        _ if gave.is_empty() => format!("{what}: nothing"),
        _ => format!("{what}: {}", gave.join(", ")),
    }
}

/// Where something came from: the source, or how many there are.
#[must_use]
pub fn sources_name(sources: &[Source]) -> String {
    match sources {
        [only] => only.name.clone(),
        _ => count(sources.len(), "file"),
    }
}

/// The name that a new session gets unless the user types another.
#[must_use]
pub fn suggested_name(sources: &[Source]) -> String {
    let Some(first) = sources.first() else { return String::new() };
    if first.name == PASTED {
        return "Pasted poses".to_owned();
    }
    let file = first.name.rsplit(['/', '\\']).next().unwrap_or(&first.name);
    let stem = file.rsplit_once('.').map_or(file, |(stem, _)| stem);
    if stem.is_empty() { "Imported poses".to_owned() } else { stem.to_owned() }
}

/// What there is to be imported, in a line.
#[must_use]
pub fn outcome(imported: &Imported) -> String {
    let readings = || imported.stations.iter().flat_map(|station| &station.captures).map(|capture| &capture.reading);
    // A pose without a profile has an empty one.
    let is_profile = |reading: &&Reading| matches!(reading, Reading::Profile(profile) if !profile.is_empty());
    let num_profiles = readings().filter(is_profile).count();
    let num_points = readings().filter(|reading| matches!(reading, Reading::Point(_))).count();
    let with = match (num_profiles, num_points) {
        (0, 0) => String::new(),
        (profiles, 0) => format!(" with {}", count(profiles, "profile")),
        (0, points) => format!(" with {}", count(points, "point")),
        (profiles, points) => format!(" with {} and {}", count(profiles, "profile"), count(points, "point")),
    };
    let stations = count(imported.stations.len(), "station");
    // What of a bag was left out stands with its topics.
    let is_of_bag = imported.notes.iter().any(|note| matches!(note, Note::Bag(_)));
    if is_of_bag && imported.num_problems == 0 {
        return format!("{stations}{with}");
    }
    format!("{stations}{with}; {}", left_out(imported.num_problems))
}

/// How much could not be read.
#[must_use]
pub fn left_out(num_problems: usize) -> String {
    if num_problems == 0 { "nothing left out".to_owned() } else { format!("{num_problems} left out") }
}

/// Above the list of what was left out.
#[must_use]
pub fn problems(num_listed: usize, num_problems: usize) -> String {
    if num_listed < num_problems {
        format!("{num_problems} left out, the first {num_listed} of them listed")
    } else {
        left_out(num_problems)
    }
}

/// Rows that the table does not show.
#[must_use]
pub fn more_rows(num_shown: usize, num_rows: usize) -> String {
    if num_shown < num_rows { format!("the first {num_shown} of {num_rows} rows") } else { count(num_rows, "row") }
}

/// Something to know about what was read.
#[must_use]
pub fn note(note: &Note) -> String {
    match note {
        Note::UserFrameTakenAsBase { frame, num_poses } => format!(
            "{} in frame {frame}, which the file does not define: give it at the left, else it counts as the robot's base",
            poses_are(*num_poses)
        ),
        Note::ToolTakenAsFlange { tool, num_poses } => format!(
            "{} of tool {tool}, which the file does not define: give its point at the left, else it counts as the flange",
            poses_are(*num_poses)
        ),
        Note::PosesWithoutReading { num_poses } => format!(
            "{} neither a profile nor a point: import the profiles together with the poses",
            if *num_poses == 1 { "1 pose has".to_owned() } else { format!("{num_poses} poses have") },
        ),
        Note::ProfilesWithoutPose { names } => {
            format!("{} without a pose, left out: {}", count(names.len(), "profile"), some_of(names))
        }
        Note::SourcesLeftOut { names } => {
            format!("{} in which nothing was recognised, left out: {}", count(names.len(), "file"), some_of(names))
        }
        Note::OtherTablesLeftOut { caption, num_tables } => {
            let first = if caption.is_empty() { "the first".to_owned() } else { format!("the first, \"{caption}\",") };
            let others = count(*num_tables, "further table");
            format!("The text holds {others}: only {first} was read. Copy another one alone to import it")
        }
        Note::QuaternionsNormalised { num_poses } => {
            format!("{num_poses} quaternion{} rounded: brought back to norm 1", were(*num_poses))
        }
        Note::OtherGroups { num_poses } => {
            format!("{} given for several groups of axes: the first group was read", poses_are(*num_poses))
        }
        Note::JointPoses { num_poses } => {
            format!("{num_poses} position{} given as joint angles only, left out", were(*num_poses))
        }
        Note::Bag(report) => bag::report(report),
    }
}

/// The first few names.
fn some_of(names: &[String]) -> String {
    const MAX_LISTED: usize = 3;
    let listed = names.iter().take(MAX_LISTED).cloned().collect::<Vec<_>>().join(", ");
    if names.len() > MAX_LISTED { format!("{listed}, …") } else { listed }
}

fn poses_are(num_poses: usize) -> String {
    format!("{} {}", count(num_poses, "pose"), if num_poses == 1 { "is" } else { "are" })
}

fn were(number: usize) -> String {
    format!("{} {}", plural(number), if number == 1 { "was" } else { "were" })
}

/// Told once poses are written.
#[must_use]
pub fn exported_poses(num_poses: usize, file: &str) -> String {
    format!("{} written to {file}", count(num_poses, "pose"))
}

/// Told once profiles are written.
#[must_use]
pub fn exported_profiles(num_profiles: usize, folder: &str) -> String {
    format!("{} written to {folder}", count(num_profiles, "profile"))
}
