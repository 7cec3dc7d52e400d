//! What is set before motion, in the capture panel.

/// Card.
pub const SETTINGS: &str = "Settings";
/// Section.
pub const SEARCH: &str = "Search";
/// Section.
pub const LIMITS: &str = "Motion limits";
/// Section.
pub const CAPTURES: &str = "Captures";
/// Section.
pub const MOUNTING: &str = "Rough mounting";

/// While a routine runs.
pub const IN_USE: &str = "In use: they can be changed again once the robot is not at work.";
/// Field: which axes.
pub const FRAME: &str = "Axes of";
/// Choice.
pub const TOOL: &str = "tool";
/// Choice.
pub const BASE: &str = "base";
/// Field: along what.
pub const DIRECTION: &str = "Direction";
/// Choice.
pub const VECTOR: &str = "vector";
/// On hover.
pub const DIRECTION_HINT: &str =
    "Along what the robot steps: as nearly as you can across the laser plane. A few degrees off do no harm.";
/// Names of the parts of a vector.
pub const PARTS: [&str; 3] = ["Direction x", "Direction y", "Direction z"];
/// Field.
pub const STEP: &str = "Step";
/// Field.
pub const COARSE_STEP: &str = "Coarse step";
/// On hover.
pub const COARSE_STEP_HINT: &str = "Steps while the peak is still far";
/// Field.
pub const MAX_TRAVEL: &str = "Travel either way";
/// Field.
pub const MAX_CAPTURES: &str = "Most profiles";
/// Field.
pub const STOP_RULE: &str = "Stop once";
/// Choice.
pub const STOP_PEAK: &str = "peak known";
/// Choice.
pub const STOP_PUBLISHED: &str = "l ≥ R (paper)";
/// Field.
pub const PEAK_STD: &str = "Peak known to";

/// Field.
pub const SPEED_CAP: &str = "Speed cap";
/// Field.
pub const TURN_CAP: &str = "Turning cap";
/// Field.
pub const MAX_MOVE: &str = "Longest move";
/// Field.
pub const MAX_TURN: &str = "Greatest turn";
/// Field.
pub const TRANSIT_SPEED: &str = "Speed to a station";
/// Field.
pub const SEARCH_SPEED: &str = "Speed of a step";
/// Checkbox.
pub const WORKSPACE: &str = "Workspace box of the flange";
/// On hover.
pub const WORKSPACE_HINT: &str = "No move ends outside of it, in the robot's base. Without it: the longest move to either side of the pose at arming";
/// Names of its sides.
pub const SIDES: [[&str; 2]; 3] = [["x from", "x to"], ["y from", "y to"], ["z from", "z to"]];

/// Field.
pub const SETTLE: &str = "Wait after a move";
/// Field.
pub const STILL: &str = "Still within";
/// Field.
pub const STILL_TURN: &str = "Still within (turn)";
/// Field.
pub const AVERAGED: &str = "Profiles averaged";
/// Field.
pub const RETRIES: &str = "Tries again";

/// Why the mounting is asked for.
pub const MOUNTING_WHY: &str = "From a drawing or with a ruler, to about 10° and 20 mm: where the sensor is on the flange. Needed to propose stations until a first solution knows better.";
/// Of what the numbers are.
pub const MOUNTING_ORIGIN: &str = "x, y and z say where the profile's x = 0, z = 0 is in the flange: often in the middle of the measuring range, in front of the head, not at it.";
/// In an empty field.
pub const MILLIMETRES: &str = "mm";
/// Button.
pub const USE_MOUNTING: &str = "Use this mounting";
/// While it cannot be pressed.
pub const MOUNTING_MISSING: &str = "Type x, y and z first";
/// Button.
pub const FORGET_MOUNTING: &str = "Forget the mounting";
/// Field.
pub const LOOKS_ALONG: &str = "Sensor looks along";
/// Field.
pub const LINE_ALONG: &str = "Laser line along";
/// A direction of the flange.
#[must_use]
pub fn of_flange(axis: &str) -> String {
    format!("flange {axis}")
}
/// Where no axis fits.
pub const OBLIQUE: &str = "oblique";
/// Name of a number of the mounting.
#[must_use]
pub fn mounting_number(name: &str) -> String {
    format!("Mounting {name}")
}
/// Once there is a solution.
pub const MOUNTING_SOLVED: &str = "The session has a solution; the stations are proposed by it.";

/// The search in one line.
#[must_use]
pub fn search_summary(direction: &str, step_mm: &str, max_travel_mm: &str) -> String {
    format!("{direction}, {step_mm} mm, ≤ {max_travel_mm} mm")
}
/// The limits in one line.
#[must_use]
pub fn limits_summary(speed_mm_s: &str, max_move_mm: &str, has_box: bool) -> String {
    // Without a box of its own it is one about the pose at arming.
    let place = if has_box { "own box".to_owned() } else { format!("±{max_move_mm} mm") };
    format!("≤ {speed_mm_s} mm/s, {place}")
}
/// The captures in one line.
#[must_use]
pub fn captures_summary(settle_ms: u32, num_profiles: u16) -> String {
    format!("{settle_ms} ms, {num_profiles} profile{}", super::plural(num_profiles.into()))
}
/// The mounting in one line.
pub const GIVEN: &str = "given";
/// The same.
pub const GIVEN_ELSEWHERE: &str = "from another robot";
/// The same.
pub const NOT_GIVEN: &str = "not given";

/// A number that was typed and is not used.
#[must_use]
pub fn not_taken(name: &str, typed: &str, least: &str, most: &str, unit: &str, kept: &str, is_whole: bool) -> String {
    let kind = if is_whole { "a whole number" } else { "a number" };
    let typed = if typed.is_empty() { "nothing" } else { typed };
    format!("{name}: {typed} is not taken, {kept}{unit} stays. Enter {kind} from {least} to {most}{unit}.")
}

/// Something about the settings that cannot be, and what to do.
pub mod problem {
    /// A direction without length.
    pub const NO_DIRECTION: &str = "The direction has no length: enter a part along some axis.";
    /// Less travel than two steps.
    pub const LITTLE_TRAVEL: &str = "The travel is less than two steps: allow more, or step less.";
    /// Coarse steps that are finer than the fine ones.
    pub const COARSE_IS_FINER: &str = "The coarse step is smaller than the step: make it at least as long.";
    /// Fast transit.
    pub const TRANSIT_TOO_FAST: &str = "The speed to a station is above the speed cap.";
    /// Fast search.
    pub const SEARCH_TOO_FAST: &str = "The speed of a step is above the speed cap.";
    /// Fast turning.
    pub const TURNS_TOO_FAST: &str = "The turning cap is above all that is ever allowed: lower it.";
    /// A step longer than a move may be.
    pub const STEP_TOO_LONG: &str = "A step is longer than the longest move.";
    /// A step as long as the ball.
    pub const STEP_BEYOND_BALL: &str = "A step is longer than the ball's radius: take smaller steps.";
    /// An empty box.
    pub const EMPTY_BOX: &str =
        "The workspace box is empty: each \u{201c}from\u{201d} must be below its \u{201c}to\u{201d}.";
    /// The robot stands outside of the box.
    pub const OUTSIDE_BOX: &str = "The robot stands outside of the workspace box.";
}
