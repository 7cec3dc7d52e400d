//! Wording of the start page and the session's overview.

use crate::calibrate::Mount;
use crate::session::{FurtherTarget, Known, Target};
use crate::text::digits;

/// Heading of the start page.
pub const TITLE: &str = "Calibrate a laser profiler or a camera on a robot";
/// What this is about, in a sentence.
pub const LEAD: &str = "A ball, plate, pin or board seen from a handful of robot poses gives the sensor's place on the flange; an RGB-D camera needs its images only. Open a session, or learn with a sample.";
/// Heading.
pub const SAMPLES: &str = "Samples";
/// Heading.
pub const OPEN_FILE: &str = "Open a session file";
/// Heading with a document open.
pub const OPEN_ANOTHER: &str = "Open another session";
/// Name of the path field.
pub const PATH: &str = "Session file path";
/// Hint inside the empty path field.
pub const PATH_HINT: &str = "/path/to/session.json";
/// Button that shows the system's file dialog.
pub const CHOOSE_FILE: &str = "Choose a file…";
/// Button beside the path field.
pub const OPEN_PATH: &str = "Open";
/// Hint below.
pub const DROP_HINT: &str =
    "Or drop a session, tables of poses, profiles, robot programs or a whole folder anywhere on this window.";
/// Heading.
pub const RECENT: &str = "Recent files";
/// Over a file being dragged in.
pub const DROP_HERE: &str = "Drop to open";
/// Reading the samples.
pub const READING: &str = "reading …";

/// Name and one-line lesson of a sample.
#[must_use]
pub fn sample_lesson(file_name: &str) -> (&'static str, &'static str) {
    match file_name {
        "lin-mu-2019-table-1.json" => {
            ("Lin & Mu 2019, table 1", "Fixed point: the figures printed in the paper, re-computed")
        }
        "lin-mu-2019-table-2.json" => {
            ("Lin & Mu 2019, table 2", "Largest arc: the figures printed in the paper, re-computed")
        }
        "clean-sweeps.json" => (
            "Clean sweeps",
            "A calibration as it should be: curve and bundle reach the truth, the published stop does not",
        ),
        "dirty-profiles.json" => {
            ("Dirty profiles", "A table, spikes and gaps in view: what is not the ball is left out")
        }
        "few-rotations.json" => ("Few rotations", "Small residuals that prove nothing: orientations too much alike"),
        "near-largest-arc.json" => {
            ("Near the largest arc", "Single sections next to the largest arc: y is all but unknown")
        }
        "one-bad-pose.json" => ("One bad pose", "One pose is wrong by 2 mm: leaving each station out in turn finds it"),
        "plate.json" => ("Right-angle plate", "No ball at hand: points on two edges at a right angle are enough"),
        "tip.json" => {
            ("Touched tip", "A pin's point met from all sides, and touched: the simplest target, and a judge")
        }
        "poses.json" => (
            "Poses of a board",
            "A camera sees a board whole: AX = XB from pairs of poses, and the one that is wrong is named",
        ),
        "workpiece.json" => {
            ("Scanned workpieces", "A square block and teeth: measured sizes show what a calibration is worth")
        }
        "three-targets.json" => {
            ("Three targets", "Ball, plate and tip of one sensor: calibrate on one, verify on the others")
        }
        _ => ("Sample", "A sample session"),
    }
}

/// Name and one-line lesson of the recorded sequence.
pub const SEQUENCE_LESSON: (&str, &str) = (
    "RGB-D camera on a robot",
    "No target at all: the camera's motion from its images, held against the robot's, gives the mounting",
);
/// Where it is not beside the program.
pub const NO_SAMPLE_SEQUENCE: &str = "The recorded RGB-D sequence is too large to be carried: it is among the sample sessions of the source. “handeye simulate --target room --out walk.json” makes another.";

/// Sizes of a session of a board.
#[must_use]
pub fn sizes_of_boards(num_poses: usize) -> String {
    super::shell::count(num_poses, "pair") + " of poses"
}

/// Sizes of a sequence.
#[must_use]
pub fn sizes_of_sequence(num_frames: usize) -> String {
    super::shell::count(num_frames, "frame") + ", colour and depth"
}

/// Sizes of a session.
#[must_use]
pub fn sizes(num_stations: usize, num_captures: usize, points_only: bool) -> String {
    use super::shell::count;
    if points_only {
        format!("{}, reduced points", count(num_stations, "station"))
    } else {
        format!("{}, {}", count(num_stations, "station"), count(num_captures, "profile"))
    }
}

/// Name of a sample's button.
#[must_use]
pub fn open_sample(name: &str) -> String {
    format!("Open sample {name}")
}

/// Heading.
pub const NOTES: &str = "Notes";
/// Hint in the empty notes.
pub const NOTES_HINT: &str = "What the next person should know about this session";
/// Heading.
pub const SETUP: &str = "Session, robot and sensor";
/// Heading.
pub const TARGET_AND_DATA: &str = "Target and data";
/// Row.
pub const NAME: &str = "name";
/// A session without a name.
pub const NO_NAME: &str = "no name";
/// Row.
pub const BALL_RADIUS: &str = "ball radius";
/// Row.
pub const BALL_RADIUS_STD: &str = "radius, 1σ";
/// Row: how well the place of a board is seen.
pub const TARGET_TRANSLATION_STD: &str = "seen place, 1σ";
/// Row: how well its orientation is seen.
pub const TARGET_ROTATION_STD: &str = "seen angle, 1σ";
/// Hint in an empty field of what the method finds by itself.
pub const FOUND_FROM_DATA: &str = "from data";
/// Row: where the tip is, touched with a calibrated tool.
pub const TOUCHED_POINT: &str = "touched at";
/// Hint in the empty field.
pub const TOUCHED_POINT_HINT: &str = "not touched";
/// Row: from a certificate.
pub const NOMINAL_ANGLE: &str = "angle of its planes";
/// Row: from a certificate.
pub const NOMINAL_PITCH: &str = "pitch of its teeth";
/// Row: from a certificate.
pub const NOMINAL_HEIGHT: &str = "height of its teeth";
/// Row: from a certificate.
pub const NOMINAL_DIAMETER: &str = "diameter";
/// Row: where methods that need one start.
pub const ROUGH_MOUNTING: &str = "rough mounting";
/// Hint in the empty field.
pub const ROUGH_MOUNTING_HINT: &str = "not stated: x y z and three angles";
/// Row above those of the other targets of the same sensor.
pub const FURTHER: &str = "further targets";
/// Leads to the page where further targets are changed.
pub const CHANGE_FURTHER: &str = "in Verify";
/// What it leads to.
pub const CHANGE_FURTHER_HINT: &str = "Named, used and removed in Verify, which judges the calibration on them";

/// What the six numbers are.
#[must_use]
pub fn rough_mounting_hint([a, b, c]: [&str; 3]) -> String {
    format!(
        "Roughly where the sensor is on the flange: x y z in mm, then {a} {b} {c} in degrees, with blanks between them. The methods for plates start from it."
    )
}

/// Another count of numbers than belongs there.
#[must_use]
pub fn numbers_missing(found: usize, needed: usize) -> String {
    format!("found {found} number{}, needed {needed} with blanks between them", super::plural(found))
}

/// What a further target is, and what is known of it.
#[must_use]
pub fn further(further: &FurtherTarget) -> String {
    let used = further.stations.iter().filter(|station| station.enabled).count();
    let figures = super::verify::further_figures(&further.target, used, further.stations.len());
    let Known { point_in_base_mm, angle_deg, pitch_mm, height_mm, diameter_mm } = further.known;
    let touched = point_in_base_mm.map(|point| {
        let [x, y, z] = [point.x, point.y, point.z].map(|value| digits::plain(value, 3));
        format!("touched at {x}, {y}, {z} mm")
    });
    let size = |name: &str, value: Option<f64>, unit: &str| value.map(|value| format!("{name} {value}{unit}"));
    let known = [
        touched,
        size("angle", angle_deg, "°"),
        size("pitch", pitch_mm, " mm"),
        size("height", height_mm, " mm"),
        size("diameter", diameter_mm, " mm"),
    ];
    let parts: Vec<String> = std::iter::once(figures).chain(known.into_iter().flatten()).collect();
    parts.join(" · ")
}

/// Hint in the empty field: nothing is stated.
pub const EXACT: &str = "exact";
/// Leads to the page where it is changed.
pub const CHANGE_CONVENTION: &str = "in Poses";
/// What it leads to.
pub const CHANGE_CONVENTION_HINT: &str = "Changed in Poses: the convention says how the numbers there are read";
/// Kind of target.
pub const BALL: &str = "ball";
/// Kind of target.
pub const PLATE: &str = "right-angle plate";
/// Kind of target.
pub const POINT: &str = "point";
/// Kind of target.
pub const BOARD: &str = "board or marker";
/// How a target is measured.
pub const BALL_HINT: &str = "Profiles of a ball from several orientations; sweeps across it are best";
/// How a target is measured.
pub const PLATE_HINT: &str = "Profiles across the two edges of a right-angled plate";
/// How a target is measured.
pub const POINT_HINT: &str = "Profiles across the tip of a pin that stays where it is";
/// How a target is measured.
pub const BOARD_HINT: &str =
    "A camera that sees the whole pose of a board or marker; pairs of poses are imported as CSV";
/// Before the targets to begin a session for.
pub const NEW_SESSION: &str = "Or begin a new session, measured on";
/// Before the field for a ball's radius.
pub const OTHER_BALL: &str = "a ball of radius";
/// Name of that field.
pub const OTHER_BALL_NAME: &str = "Radius of the new session's ball, mm";
/// Button.
pub const BEGIN: &str = "Begin";

/// A field's name with its unit.
#[must_use]
pub fn field_name(label: &str, unit: &str) -> String {
    if unit.is_empty() { label.to_owned() } else { format!("{label}, {unit}") }
}

/// A target to begin a session for.
#[must_use]
pub fn preset(name: &str, is_ball: bool, radius_mm: f64) -> String {
    if is_ball { format!("a {name}, {radius_mm} mm") } else { format!("a {name}") }
}

/// Row.
pub const ROBOT: &str = "robot";
/// Row.
pub const CONVENTION: &str = "orientation";
/// Row.
pub const POSITION_STD: &str = "position, 1σ";
/// Row.
pub const ORIENTATION_STD: &str = "orientation, 1σ";
/// Row.
pub const SENSOR: &str = "sensor";
/// Row.
pub const PROFILE_STD: &str = "profile point, 1σ";
/// Row.
pub const REFERENCE_DISTANCE: &str = "accuracy stated at";
/// Row.
pub const TARGET: &str = "target";
/// Row.
pub const MOUNT: &str = "mounted";
/// Row.
pub const STATIONS: &str = "stations";
/// Row.
pub const CAPTURES: &str = "captures";
/// Row.
pub const FRAMES: &str = "frames";
/// Value of what is still in its folder.
pub const NOT_READ: &str = "not read";
/// Row: the true poses of a sequence.
pub const GROUND_TRUTH: &str = "ground truth";
/// Row: the poses of the robot that carries the camera.
pub const FLANGE_POSES: &str = "robot's poses";
/// Value of what a sequence's folder has.
pub const IN_FOLDER: &str = "in the folder";
/// Row.
pub const TRUTH: &str = "truth";
/// Row.
pub const PUBLISHED: &str = "printed figures";
/// Value.
pub const KNOWN: &str = "known (simulated)";
/// Value.
pub const NOT_KNOWN: &str = "not known";
/// Value.
pub const NONE: &str = "none";
/// Value.
pub const YES: &str = "in the file";
/// Value of an unknown quantity.
pub const NOT_STATED: &str = "not stated";
/// Row.
pub const FILE: &str = "file";
/// Value where a session has no file.
pub const NOT_SAVED: &str = "not saved yet";

/// Stations in all and those taking part.
#[must_use]
pub fn stations_in_use(num_enabled: usize, num_stations: usize) -> String {
    if num_stations == 0 {
        "none".to_owned()
    } else if num_enabled == num_stations {
        format!("{num_stations}, all in use")
    } else {
        format!("{num_stations}, {num_enabled} in use")
    }
}

/// Profiles and reduced points.
#[must_use]
pub fn captures(num_profiles: usize, num_points: usize) -> String {
    use super::shell::count;
    match (num_profiles, num_points) {
        (profiles, 0) => count(profiles, "profile"),
        (0, points) => count(points, "reduced point"),
        (profiles, points) => format!("{}, {}", count(profiles, "profile"), count(points, "reduced point")),
    }
}

/// Poses of a board or marker.
#[must_use]
pub fn board_poses(number: usize) -> String {
    format!("{} of the target", super::shell::count(number, "pose"))
}

/// What was measured.
#[must_use]
pub fn target(target: &Target) -> String {
    match target {
        Target::Ball { radius_mm, radius_std_mm: None } => format!("ball, radius {radius_mm} mm"),
        Target::Ball { radius_mm, radius_std_mm: Some(std_mm) } => {
            format!("ball, radius {radius_mm} ± {std_mm} mm, to be estimated")
        }
        Target::RightAnglePlate => "right-angle plate".to_owned(),
        Target::Point => "point".to_owned(),
        Target::Pose { .. } => "marker or board, its whole pose seen".to_owned(),
        Target::Workpiece => "workpiece".to_owned(),
        Target::Rgbd { sequence } => format!("RGB-D sequence {sequence}"),
    }
}

/// Where the sensor is.
#[must_use]
pub const fn mount(mount: Mount) -> &'static str {
    match mount {
        Mount::OnFlange => "on the flange",
        Mount::Fixed => "beside the robot, fixed",
    }
}
