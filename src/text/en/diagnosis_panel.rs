//! The diagnosis panel: its own words; those of the findings are in [`super::diagnosis`].

use crate::calibrate::Edge;
use crate::session::Target;

use super::diagnosis::target_word;
use super::edges::edge_name;
use super::shell::count;

/// In place of the panel without a session.
pub const NO_SESSION: &str = "Open a session, or one of the samples, to have it examined.";
/// In place of the panel before the first results.
pub const CANCELLED: &str = "Solving was cancelled. \"Solve\" at the bottom right starts it again.";
/// While the first result is on its way.
pub const SOLVING: &str = "Solving: the diagnosis follows the first result.";
/// Shown on what belongs to an earlier revision.
pub const OUT_OF_DATE: &str = "out of date";
/// Title of the list.
pub const FINDINGS: &str = "Findings";
/// While the first diagnosis is on its way.
pub const EXAMINING: &str = "Examining the session …";
/// After a cancel.
pub const NOT_EXAMINED: &str = "The diagnosis was cancelled.";
/// Starts it again.
pub const DIAGNOSE: &str = "Diagnose";
/// Stops what is under way.
pub const CANCEL: &str = "Cancel";
/// What was looked for, group by group.
#[must_use]
pub const fn checked(target: &Target) -> &'static [&'static str] {
    match target {
        Target::RightAnglePlate => &[
            "poses: convention, order, inverse, units",
            "stations: wrong or stale poses, points off their edges",
            "rotations: enough of them, and about more than one axis",
            "edges: enough points on both, another mounting that fits as well",
            "residuals: two halves that agree, a normal distribution",
        ],
        Target::Point => &[
            "poses: convention, order, inverse, units, twins",
            "stations: wrong, stale or mixed-up poses",
            "rotations: enough of them, and about more than one axis",
            "scene: drift, a switched tool",
            "residuals: two halves that agree, a normal distribution",
        ],
        Target::Pose { .. } => &[
            "poses: a list that is inverted, poses that contradict the others, a flipped target",
            "rotations: enough of them, and about more than one axis",
            "target: whether its size is as stated",
            "residuals: two halves that agree, a normal distribution",
        ],
        Target::Rgbd { .. } => &[
            "motion: a list that is inverted, steps in which the camera lost its way",
            "rotations: enough of them, and about more than one axis",
            "clocks: whether the data tell by how much they differ",
            "stretches: each against the calibration made without it, two halves that agree",
        ],
        Target::Ball { .. } | Target::Workpiece => &[
            "poses: convention, order, inverse, units, twins",
            "stations: wrong, stale or mixed-up poses, wrong sides",
            "rotations: enough of them, and about more than one axis",
            "scene: radius, profile scale, mirrored axes, drift, a switched tool",
            "travel: along the laser's normal, steps as commanded",
        ],
    }
}

/// Above that list.
pub const CHECKED_TITLE: &str = "What was looked at:";
/// Name of the button that cancels the diagnosis.
pub const CANCEL_DIAGNOSIS: &str = "Cancel the diagnosis";

/// Name of a finding in the list.
#[must_use]
pub fn finding_name(number: usize, title: &str) -> String {
    format!("Finding {number}: {title}")
}

/// Selects a finding.
pub const SHOW: &str = "Show";

/// Name of the button that selects a finding.
#[must_use]
pub fn show_finding(title: &str) -> String {
    format!("Show: {title}")
}

/// How many findings there are, for the rail and the head of the list.
#[must_use]
pub fn num_findings(number: usize) -> String {
    count(number, "finding")
}

/// The figure behind a finding.
#[must_use]
pub fn residual_falls(given_mm: &str, mended_mm: &str) -> String {
    format!("residual {given_mm} → {mended_mm} mm when mended")
}

/// Button that is always there.
pub const TRY_READINGS: &str = "Try other pose conventions…";
/// What it does.
pub const TRY_READINGS_HINT: &str =
    "Solves with the poses read in every way that people confuse, and ranks the ways by their residual";
/// While it runs.
pub const TRYING_READINGS: &str = "Trying other conventions …";
/// Title of the outcome.
pub const READINGS: &str = "Ways to read the poses";
/// On its right.
pub const READINGS_HINT: &str = "RMS residual / mm, log scale";
/// Name of the button that cancels it.
pub const CANCEL_READINGS: &str = "Cancel trying conventions";
/// After that.
pub const READINGS_CANCELLED: &str = "Nothing was tried yet; \"Try other pose conventions…\" does.";
/// Marks the session as it is.
pub const AS_GIVEN: &str = "as given";
/// Button of a way.
pub const READ_SO: &str = "Read so";
/// Where there is none.
pub const NO_READINGS: &str = "No way to read the poses gave a solution.";

/// Name of a way's button.
#[must_use]
pub fn read_poses_as(name: &str) -> String {
    format!("Read the poses as {name}")
}

/// Ways that cannot be told apart.
#[must_use]
pub fn same_as(names: &str) -> String {
    format!("= {names}")
}

/// Title where a finding has no plot of its own, and where there is none: left-out errors.
#[must_use]
pub const fn stations_agree(target: &Target) -> &'static str {
    match target {
        Target::RightAnglePlate => "Each point off its edge by the others",
        Target::Rgbd { .. } => "Each stretch against the others",
        _ => "Each station against the others",
    }
}

/// Without left-out errors.
pub const TOO_FEW_TO_LEAVE_OUT: &str = "Too few stations to hold each against the others.";
/// Axis title.
pub const STATION_AXIS: &str = "station";
/// Axis title.
pub const OFF_AXIS: &str = "off the others / mm";
/// Legend.
pub const ACCUSED: &str = "named by the finding";
/// Legend.
pub const OTHERS: &str = "others";
/// Legend.
pub const TREND_LINE: &str = "steady drift";
/// Legend.
pub const ONE_TO_ONE: &str = "as commanded";
/// Legend.
pub const STEP: &str = "step";

/// Readout of a step.
#[must_use]
pub fn step_readout(commanded_mm: &str, moved_mm: &str) -> String {
    format!("commanded {commanded_mm} mm\nmoved {moved_mm} mm")
}

/// The session's value in a curve.
#[must_use]
pub fn given_value(value: &str) -> String {
    format!("given {value}")
}

/// The fitting value in a curve.
#[must_use]
pub fn found_value(value: &str) -> String {
    format!("fits best {value}")
}

/// Readout of a bar.
#[must_use]
pub fn station_value(label: &str, figures: &str) -> String {
    format!("station {label}\n{figures}")
}

/// Beside the triad.
#[must_use]
pub fn unknown_direction(along: &str) -> String {
    format!("Least known {along}")
}

/// The same as a vector.
#[must_use]
pub fn unit_vector(x: &str, y: &str, z: &str) -> String {
    format!("({x}, {y}, {z})")
}

/// Names of the principal axes of the rotations, in order of size.
pub const PRINCIPAL_AXES: [&str; 3] = ["least", "middle", "most"];
/// Before the rotations.
pub const ROTATIONS_ABOUT: &str = "RMS rotation about the principal axes";

/// Title.
pub const INFLUENCE: &str = "Influence of each station";
/// Shows residuals.
pub const RESIDUALS: &str = "residual";
/// What they are.
pub const RESIDUALS_HINT: &str = "Each station's residual over what its noise and its pull on the result let one expect; beyond ±3 it hardly is chance";
/// Shows what leaving out moves.
pub const MOVES: &str = "moves";
/// What it is.
pub const MOVES_HINT: &str = "How far the workspace point moves when the station is left out";
/// Axis title.
pub const STUDENTISED_AXIS: &str = "residual / its σ";
/// Axis title.
pub const MOVES_AXIS: &str = "moves / mm";

/// Readout of a station's influence.
#[must_use]
pub fn influence_readout(label: &str, residual: &str, p_value: &str, moves_mm: &str) -> String {
    format!("station {label}\nresidual {residual} σ (p {p_value})\nleft out: {moves_mm} mm")
}

/// Title.
pub const HALVES: &str = "Two halves";
/// What they are.
pub const HALVES_HINT: &str = "Calibrations from two halves of the stations, for many ways to halve them: how far apart they put the workspace point";
/// Axis title.
pub const SPLIT_AXIS: &str = "splits, sorted";
/// Axis title.
pub const APART_AXIS: &str = "apart / mm";
/// Without enough stations.
pub const TOO_FEW_FOR_HALVES: &str = "Eight stations or more are needed to halve them.";

/// Legend.
#[must_use]
pub fn median(median_mm: &str) -> String {
    format!("median {median_mm}")
}

/// Legend.
#[must_use]
pub fn expected(expected_mm: &str) -> String {
    format!("expected {expected_mm}")
}

/// Title.
pub const NORMALITY: &str = "Normality";
/// What it is.
pub const NORMALITY_HINT: &str = "Residuals over their σ against the quantiles of the normal distribution: on the line if only chance is at work (Anderson and Darling)";
/// Axis title.
pub const QUANTILE_AXIS: &str = "normal quantile";
/// Axis title.
pub const RESIDUAL_AXIS: &str = "residual / σ";
/// Without enough residuals.
pub const TOO_FEW_RESIDUALS: &str = "Too few residuals to judge their distribution.";
/// Before the validation is there.
pub const NOT_VALIDATED: &str = "Too few stations to check the result against itself.";

/// The test's outcome.
#[must_use]
pub fn p_value(p: &str) -> String {
    format!("p {p}")
}

/// Title.
pub const ACCURACY: &str = "Accuracy";
/// Row: the point that the headline is about.
#[must_use]
pub fn point_at(z_mm: &str) -> String {
    format!("at z = {z_mm} mm")
}

/// The ball that holds it with 95 %.
#[must_use]
pub fn within_95(within_mm: &str) -> String {
    format!("95 % within {within_mm} mm")
}

/// Row: the direction in which it is known worst.
#[must_use]
pub fn weakest(along: &str) -> String {
    format!("weakest {along}")
}

/// Row: how the point follows the radius.
#[must_use]
pub fn by_radius(step_mm: &str) -> String {
    format!("moves by, if R is {step_mm} mm off")
}

/// What the row means.
pub const BY_RADIUS_HINT: &str = "How far the point would move if the ball's radius R were larger by this much: a wrong radius shows in no residual of a fixed point";
/// Before the first bootstrap.
pub const NOT_YET: &str = "not run";
/// Row.
pub const BOOTSTRAP_ROW: &str = "σ by bootstrap";
/// Where nothing is left over to judge by.
pub const NO_UNCERTAINTY: &str = "Nothing is left over to judge the accuracy by: add stations.";
/// Where no method has a result.
pub const NO_SOLUTION: &str = "No method has a result yet; the findings say why.";
/// Labels of the ellipses.
pub const ELLIPSE_HINT: &str =
    "1σ ellipse of the workspace point along the flange's axes; the arrow is the direction known worst";

/// Button.
#[must_use]
pub fn bootstrap_button(num_draws: usize) -> String {
    format!("Bootstrap {num_draws}")
}

/// What it does.
pub const BOOTSTRAP_HINT: &str =
    "Solves many times with stations drawn with replacement; the spread is a second opinion on σ";

/// Name of the button that cancels it.
pub const CANCEL_BOOTSTRAP: &str = "Cancel the bootstrap";

/// While it runs.
#[must_use]
pub fn bootstrap_progress(done: usize, total: usize) -> String {
    format!("bootstrap {done} / {total}")
}

/// What it found.
#[must_use]
pub fn bootstrap_result(std_mm: &str) -> String {
    format!("± {std_mm} mm")
}

/// Draws that failed.
#[must_use]
pub fn bootstrap_details(num_draws: usize, num_failed: usize, within_95_mm: &str) -> String {
    let failed = if num_failed == 0 { String::new() } else { format!("; {num_failed} draws had no solution") };
    format!("{num_draws} draws, 95 % of them within {within_95_mm} mm{failed}")
}

/// The spread agrees with the stated one.
pub const BOOTSTRAP_AGREES: &str = "The bootstrap agrees with the stated σ";
/// It does not.
pub const BOOTSTRAP_DIFFERS: &str = "The bootstrap differs from the stated σ by more than half";

/// Title.
pub const NEXT_POSES: &str = "Next poses";
/// Before the table.
#[must_use]
pub fn now_at(std_mm: &str) -> String {
    format!("now ± {std_mm} mm")
}

/// While planning.
pub const PLANNING: &str = "planning …";
/// While the result is one to be mended.
pub const NO_PLAN_YET: &str = "Mend the first finding; poses planned from a wrong result lead nowhere.";
/// Before there is a plan.
pub const NO_PLAN: &str = "A plan needs a calibration to start from; the findings say what is missing.";
/// Column: the edge of a plate.
pub const EDGE: &str = "edge";
/// Column.
pub const TILT: &str = "tilt / °";
/// Column.
pub const AZIMUTH: &str = "azim. / °";
/// Column.
pub const SPIN: &str = "spin / °";
/// Column.
pub const STD_AFTER: &str = "σ / mm";
/// What it is.
pub const STD_AFTER_HINT: &str = "σ of the workspace point once this station and those above it are measured";
/// Button.
pub const COPY_TABLE: &str = "Copy";
/// Its name.
pub const COPY_TABLE_NAME: &str = "Copy the next poses";
/// What it does.
pub const COPY_TABLE_HINT: &str = "The table with its head, tab-separated, for a spreadsheet";
/// Field.
pub const MAX_TILT: &str = "tilt ≤";
/// Field.
pub const MAX_SPIN: &str = "spin ±";
/// Field.
pub const STANDOFF: &str = "stand-off";
/// Between its ends.
pub const TO: &str = "to";
/// Name of the first end's field.
pub const STANDOFF_FROM: &str = "stand-off from";
/// Name of the second end's field.
pub const STANDOFF_TO: &str = "stand-off to";
/// Where the stand-off is that of the stations measured.
pub const STANDOFF_AS_MEASURED: &str = "as measured";
/// What the limits are.
#[must_use]
pub fn limits_hint(target: &Target) -> String {
    let (of, seen) = match target {
        Target::RightAnglePlate => (" at the same edge", "edge"),
        Target::Ball { .. } => ("", "ball's centre"),
        _ => ("", target_word(target)),
    };
    format!(
        "Angles are relative to the mean orientation of the stations{of}; the stand-off is the distance of the {seen} along the range axis"
    )
}

/// In the verdict's band: what one more station brings.
#[must_use]
pub fn gain(edge: Option<Edge>, tilt_deg: &str, before_mm: &str, after_mm: &str) -> String {
    let at = edge.map_or_else(String::new, |edge| format!(" at edge {},", edge_name(edge)));
    format!("a station{at} tilted {tilt_deg}° would bring ± {before_mm} → ± {after_mm} mm")
}

/// Before the next step in the band.
pub const NEXT_STEP: &str = "Next:";
/// Leads to the diagnosis.
pub const SEE_DIAGNOSIS: &str = "See diagnosis";
/// Leads to the table of poses.
pub const SEE_NEXT_POSES: &str = "See next poses";
