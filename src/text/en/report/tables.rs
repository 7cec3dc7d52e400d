//! Wording of the tables of reports: methods, validation, verification, stations.

use crate::calibrate::{Method, Mount};
use crate::session::Target;

use crate::text::en::{method_name, plural};

/// Title of a table.
pub const OVERVIEW: &str = "Errors of the methods";
/// Head of a column.
pub const MAXIMUM: &str = "maximum";
/// Head of a column.
pub const RMS: &str = "RMS";
/// Group of columns: errors of the stations that the method was computed from.
pub const IN_SAMPLE_GROUP: &str = "in sample / mm";
/// Group of columns: errors of stations that it was not computed from.
pub const LEFT_OUT_GROUP: &str = "left out / mm";

/// Head of the column of the largest error in sample: the papers' maximum is a coordinate, that of a plate a distance.
#[must_use]
pub const fn maximum_in_sample(target: &Target) -> &'static str {
    match target {
        Target::RightAnglePlate | Target::Rgbd { .. } => MAXIMUM,
        _ => "max. axis",
    }
}

/// Head of a column.
pub const RMS_3D: &str = "RMS 3D";
/// Group of columns.
pub const FROM_TRUTH: &str = "from the truth";
/// Head of a column.
pub const POINT: &str = "point";
/// Head of a column.
pub const ROTATION: &str = "rotation";

/// What the columns of the errors mean.
#[must_use]
pub const fn errors_legend(target: &Target) -> [&'static str; 2] {
    const STRETCH_LEFT_OUT: &str = "left out: each stretch against the calibration made without it, RMS 3D · σ point: 1 σ of a point in the workspace, 3D";
    const LEFT_OUT: &str = "left out: each station against the calibration made without it, RMS 3D · σ point: 1 σ of a point in the workspace, 3D";
    let first = match target {
        Target::RightAnglePlate => {
            "max: largest distance of a point from its edge, in sample · RMS: of these distances, in sample"
        }
        Target::Point => {
            "max: largest coordinate (one axis) off the first station's tip, in sample, as in the papers · RMS: of the distances (3D) of all tips from their mean, in sample"
        }
        Target::Pose { .. } => {
            "max: largest coordinate relative to the first station · RMS: scatter of the target's origin about its place, 3D"
        }
        Target::Rgbd { .. } => {
            "max: what the steps of the worst stretch of the way are off by, RMS 3D, in sample · RMS: over all stretches"
        }
        Target::Ball { .. } | Target::Workpiece => {
            "max: largest coordinate (one axis) off the first station's ball, in sample, as in the papers · RMS: of the distances (3D) of all balls from their mean, in sample"
        }
    };
    let left_out = if matches!(target, Target::Rgbd { .. }) { STRETCH_LEFT_OUT } else { LEFT_OUT };
    [first, left_out]
}

/// A method that gave nothing.
#[must_use]
pub fn not_computed(method: Method, reason: &str) -> String {
    format!("{}: not computed. {reason}", method_name(method))
}

/// Title of a table.
pub const CLOSED_FORMS: &str = "Published closed forms on the same motions";
/// Head of a column.
pub const CLOSED_FORM: &str = "closed form";
/// Head over columns.
pub const FROM_REFINED: &str = "off the refined answer";
/// Head over columns.
pub const LEFT_OVER: &str = "residual, RMS";
/// Head of a column.
pub const TRANSLATION: &str = "translation";
/// Below the table.
pub const CLOSED_FORMS_NOTE: &str = "Residual: of the place and orientation of what was seen, about their means.";
/// Title of a table.
pub const DIFFERENCES: &str = "Differences of the calibrations, second relative to first";
/// Head of a column.
pub const PAIR: &str = "methods";
/// Head of a column.
pub const AT_POINT: &str = "at workspace point";
/// Head of a column.
pub const IN_STDS: &str = "in σ";
/// What the last column means.
pub const DIFFERENCES_NOTE: &str =
    "in σ: the distance over its standard deviation, the two taken as independent; up to 2 they agree";

/// Title of a method's table in the layout of the papers.
#[must_use]
pub fn paper_table_title(method: Method) -> String {
    let like = if Method::BALL.contains(&method) { ", in the layout of Lin & Mu, Tables 1 and 2" } else { "" };
    format!("{}{like}", method_name(method))
}

/// Group of columns.
pub const FLANGE_IN_BASE: &str = "flange in base: quaternion";
/// Group of columns.
pub const FLANGE_POSITION: &str = "flange in base / mm";
/// Group of columns: the target in the sensor's frame.
#[must_use]
pub fn in_sensor(method: Method) -> String {
    format!("{} in sensor / mm", seen(method))
}

/// Group of columns: the target where it stands still.
#[must_use]
pub fn in_standing_frame(method: Method, mount: Mount) -> String {
    let frame = match mount {
        Mount::OnFlange => "base",
        Mount::Fixed => "flange",
    };
    format!("{} in {frame} / mm", seen(method))
}

/// Group of columns: the error.
#[must_use]
pub const fn error(method: Method) -> &'static str {
    match method {
        Method::PlateOrthogonal | Method::PlateBundle => "off the edge / mm",
        _ => "error from first / mm",
    }
}

const fn seen(method: Method) -> &'static str {
    match method {
        Method::PlateOrthogonal | Method::PlateBundle => "edge point",
        Method::FixedPoint => "tip",
        Method::Motion => "target",
        Method::BallFixedPoint | Method::BallMaxArcStep | Method::BallMaxArc | Method::BallBundle => "ball",
    }
}

/// Head of a column.
pub const NUMBER: &str = "no.";
/// Below a table with rows that were not used.
pub const UNUSED_NOTE: &str = "–: the station was left out, or the method could not use it";

/// Title of the table that a paper printed.
pub const PUBLISHED: &str = "As published";
/// Group of columns.
pub const PRINTED_BALL: &str = "printed ball in base / mm";
/// Group of columns.
pub const PRINTED_ERROR: &str = "printed error / mm";
/// Group of columns.
pub const RECOMPUTED_ERROR: &str = "error of the printed centres / mm";

/// Below the printed table.
#[must_use]
pub fn misprints_note(count: usize) -> String {
    if count == 0 {
        "The printed errors follow from the printed centres.".to_owned()
    } else {
        format!("≠: {count} misprint{}; the printed centres give another error", plural(count))
    }
}

/// Nothing is wrong.
pub const NOTHING_FOUND: &str = "Nothing was found to be wrong.";

/// The truth of a simulated session.
pub const TRUTH: &str = "From the truth (simulated session)";

/// How far a result is from the truth.
#[must_use]
pub fn truth_line(point_mm: &str, rotation_deg: &str) -> String {
    format!("{point_mm} mm at the workspace point, {rotation_deg}°")
}

/// Name of a fact.
pub const LEAVE_ONE_OUT: &str = "Left out, predicted by others";

/// Distances of stations, left out or in sample.
#[must_use]
pub fn distances_line(target: &Target, rms_mm: &str, max_mm: &str) -> String {
    let from = match target {
        Target::RightAnglePlate => "of the points from their edges",
        Target::Point => "of the tips, 3D",
        Target::Pose { .. } => "of the target's origins, 3D",
        Target::Rgbd { .. } => "that the steps of the camera are off by, RMS of a stretch, 3D",
        Target::Ball { .. } | Target::Workpiece => "of the balls, 3D",
    };
    format!("RMS {rms_mm} mm, maximum {max_mm} mm (distances {from})")
}

/// There are too few stations for it.
pub const NO_LEAVE_ONE_OUT: &str = "too few stations to leave one out";
/// Name of a fact.
pub const IN_SAMPLE: &str = "In sample";
/// Name of a fact.
pub const ROTATION_SPAN: &str = "Largest rotation between two poses";

/// Title of a table.
pub const DISTANCES: &str = "Distances of the edge points from the fitted lines and plane";
/// Title of a table.
#[must_use]
pub const fn stability_title(is_touched: bool) -> &'static str {
    if is_touched {
        "A known point measured many times: measured − touched"
    } else {
        "The point measured many times: scatter about its mean"
    }
}

/// What δ is, and over what.
#[must_use]
pub const fn stability_note(is_of_tip: bool) -> &'static str {
    if is_of_tip {
        "3δ: three standard deviations of the measurements · 3D: root of the sum of squares over the axes · a measurement: the tip as a capture shows it"
    } else {
        "3δ: three standard deviations of the measurements · 3D: root of the sum of squares over the axes · a measurement: the centre that all arcs of a station give together, whichever of them the method itself uses (“Errors of the methods” is over those)"
    }
}
/// Head of a column.
pub const CALIBRATION_COLUMN: &str = "calibration";
/// Group of columns.
pub const TO_LINES: &str = "to the lines / mm";
/// Group of columns.
pub const TO_PLANE: &str = "to the plane / mm";
/// Head of a column.
pub const MEAN: &str = "mean";
/// Head of a column.
pub const SPREAD: &str = "sd";
/// Head of a column.
pub const ANGLE: &str = "angle p–q";
/// Head of a column.
pub const GAP: &str = "gap";
/// Group of columns.
pub const MEAN_DEVIATION: &str = "mean deviation / mm";
/// Group of columns.
pub const THREE_DELTA: &str = "3δ / mm";
/// Head of a column.
pub const THREE_DELTA_3D: &str = "3D";
/// Group of columns.
pub const DEVIATION: &str = "deviation / mm";
/// Title of a table.
pub const CROSS_TARGETS: &str = "Every calibration on every target";
/// What the errors on targets are, and what the star means.
pub const CROSS_TARGETS_NOTE: &str = "RMS and maximum: of the distances (3D) of a ball's or tip's stations from their common place, of a plate's points from their edges · *: the calibration was computed from this target, so in sample";
/// Head of a column.
pub const DATA: &str = "data";
/// The calibration was computed from these data, or from others.
#[must_use]
pub const fn data(is_own: bool) -> &'static str {
    if is_own { "own" } else { "others" }
}
/// What that means.
pub const DATA_NOTE: &str = "data: own where the calibration was computed from these very data, so in sample";
/// Title of a table.
pub const JOINT: &str = "All targets solved together";
/// What its columns mean.
pub const JOINT_NOTE: &str = "moved: from where the target alone puts the workspace point · by chance: how often noise alone moves it so far; !: the target contradicts the others";
/// Head of a column.
pub const STD_ALONE: &str = "σ point alone";
/// Head of a column.
pub const STD_TOGETHER: &str = "σ point together";
/// Head of a column.
pub const MOVED: &str = "moved";
/// Head of a column.
pub const BY_CHANCE: &str = "by chance";

/// Why there is no calibration from all targets.
#[must_use]
pub fn no_joint(reason: &str) -> String {
    format!("All targets together: {reason}")
}

/// Whether other targets bear out the answer.
#[must_use]
pub const fn borne_out(is_borne_out: bool) -> &'static str {
    if is_borne_out {
        "The other targets bear the calibration out: on none of them its error is far above that of the calibration computed from that target."
    } else {
        "Other targets do not bear the calibration out: its error there is far above that of the calibration computed from that target."
    }
}

/// Profiles of a target in which nothing was found.
#[must_use]
pub fn refused(target: &str, num_refused: usize, num_captures: usize, first: &str) -> String {
    format!("{target}: {num_refused} of {num_captures} profiles were refused; the first: {first}")
}

/// Heads a scanned part.
#[must_use]
pub fn part_heading(name: &str) -> String {
    format!("Scanned part: {name}")
}

/// What was scanned and how it is seen.
#[must_use]
pub fn part_line(num_points: &str, num_profiles: usize, calibration: &str) -> String {
    format!("{num_points} points in {num_profiles} profile{}; calibration: {calibration}.", plural(num_profiles))
}

/// Title of a table.
pub const PLANES: &str = "Planes";
/// Head of a column.
pub const PLANE: &str = "plane";
/// Head of a column.
pub const EQUATION: &str = "equation (mm)";
/// Group of columns.
pub const KNOWN_TO: &str = "known to, 1 σ";
/// Head of a column.
pub const HEIGHT: &str = "height";
/// Head of a column.
pub const NORMAL: &str = "normal";
/// Group of columns.
pub const DRAWN: &str = "distances of points drawn / mm";
/// No plane.
pub const NO_PLANES: &str = "No plane was found that holds 4 % of the points.";
/// Title of a table.
pub const ANGLES: &str = "Angles between the planes";
/// Name of a fact.
pub const PITCHES: &str = "Pitch";
/// Name of a fact.
pub const HEIGHTS: &str = "Height";
/// Head of a column.
pub const ANGLE_WITH_STD: &str = "angle ± 1 σ";
/// Head of a column.
pub const PLANES_OF_ANGLE: &str = "planes";
/// Title of a table.
pub const TEETH: &str = "Teeth";
/// Head of a column.
pub const TOOTH: &str = "tooth";
/// Head of a column.
pub const PLACE: &str = "place";
/// Head of a column.
pub const PITCH: &str = "pitch";
/// Name of a fact.
pub const DIAMETER: &str = "Diameter";

/// Title of a table.
#[must_use]
pub fn stations_title(method: Method) -> String {
    format!("Stations as {} has them", method_name(method))
}

/// Head of a column.
pub const SIDE: &str = "side";
/// Head of a column.
pub const EDGE: &str = "edge";
/// Head of a column.
pub const STRETCH: &str = "stretch";
/// Head of a column.
pub const POSES_COLUMN: &str = "poses";
/// Head of a column.
pub const CAPTURES_COLUMN: &str = "captures";
/// Head of a column.
pub const ERROR_SIZE: &str = "error |e|";
/// Head of a column.
pub const LEFT_OUT_COLUMN: &str = "left out";
/// Head of a column.
pub const STUDENTISED: &str = "studentised";
/// Head of a column.
pub const MOVES_POINT: &str = "moves point";
/// Group of columns.
pub const SWEEP: &str = "largest arc";
/// Head of a column.
pub const PEAK: &str = "peak at";
/// Head of a column.
pub const OFF_NORMAL: &str = "off normal";
/// What the columns mean.
pub const STATIONS_NOTE: &str = "error: distance (3D) from the mean, in sample · left out: distance (3D) from what the others predict · studentised: residual in its σ · moves point: how far the workspace point moves without the station";
/// The same for stretches of a way.
pub const STRETCHES_NOTE: &str = "error: distance (3D) of where the stretch puts the scene from the mean, in sample · left out: what its steps are off by with the calibration made without it, RMS · studentised: residual in its σ · moves point: how far the workspace point moves without the stretch";
/// The same for a plate.
pub const EDGE_POINTS_NOTE: &str =
    "error: distance from its edge, in sample · left out: from the edges found without the station";
/// In place of figures.
pub const STATION_LEFT_OUT: &str = "left out";
