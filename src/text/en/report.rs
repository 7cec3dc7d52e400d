//! Wording of reports.

use crate::calibrate::{Method, Mount};
use crate::geometry::AngleOrder;
use crate::geometry::PoseConvention;
use crate::geometry::notation::AngleUnit;
use crate::session::Target;

use super::{method_name, method_short_name, plural};

/// Section.
pub const VERDICT: &str = "Verdict";
/// Section.
pub const CALIBRATION: &str = "Calibration";
/// Section.
pub const SETUP: &str = "Set-up";
/// Section.
pub const METHODS: &str = "Methods side by side";
/// Section.
pub const FIGURES: &str = "Figures";
/// Section.
pub const DIAGNOSIS: &str = "Diagnosis";
/// Section.
pub const VALIDATION: &str = "Validation";
/// Section.
pub const VERIFICATION: &str = "Verification";
/// Section.
pub const STATIONS: &str = "Stations";
/// Section.
pub const TOOL_FRAMES: &str = "For the controller";
/// Section.
pub const INPUTS: &str = "Inputs and program";
/// Section.
pub const REFERENCES: &str = "References";
/// Section.
pub const SIGNATURE: &str = "Signature";

/// Of a report on a session without a name.
pub const UNNAMED: &str = "Session without a name";
/// Below the title.
pub const SUBTITLE: &str = "Hand-eye calibration report";
/// The language of this wording, as HTML has it.
pub const LANGUAGE: &str = "en";
/// Heads the list of sections.
pub const CONTENTS: &str = "Contents";

/// In place of a verdict.
pub const NO_CALIBRATION: &str = "No calibration";
/// The shape of no verdict.
pub const NO_VERDICT_MARK: &str = "–";
/// A part was measured without one.
pub const PART_MEASURED: &str = "The scanned parts were measured, see “Verification”.";

/// What the headline's figure is about.
#[must_use]
pub fn headline_note(distance_mm: &str, is_stated: bool, within_95_mm: &str) -> String {
    let point = if is_stated {
        format!("a point {distance_mm} mm before the sensor")
    } else {
        format!("a point amid what was seen, {distance_mm} mm before the sensor")
    };
    format!("1 σ of {point}, in three dimensions; 95 % within {within_95_mm} mm")
}

/// Name of a fact.
pub const METHOD: &str = "Method";
/// Name of a fact.
pub const IMPROVEMENT: &str = "Against the published method";
/// Name of a fact.
pub const SCALE: &str = "Scale of the verdict";
/// Name of a fact.
pub const NEXT_STEP: &str = "Next step";
/// Heads the warnings.
pub const WARNINGS: &str = "Warnings";

/// A method with what it does.
#[must_use]
pub fn method_and_id(method: Method) -> String {
    format!("{} ({})", method_name(method), method.id())
}

/// How a method's error compares with the baseline's.
#[must_use]
pub fn improvement_line(
    method: Method,
    error_mm: &str,
    percent: &str,
    baseline: Method,
    baseline_error_mm: &str,
) -> String {
    format!(
        "{}: {} error {error_mm} mm, {percent} % against {} ({baseline_error_mm} mm)",
        method_name(method),
        if Method::PLATE.contains(&method) { "left-out" } else { "maximum" },
        method_short_name(baseline),
    )
}

/// Title of a table, and what its columns are.
pub const TARGETS: &str = "Targets of this session";
/// Head of a column.
pub const TARGET: &str = "target";
/// Head of a column.
pub const KIND: &str = "kind";
/// Head of a column.
pub const RESULT: &str = "verdict";
/// Head of a column.
pub const METHOD_COLUMN: &str = "method";
/// Head of a column.
pub const STD_POINT: &str = "σ point";
/// Heads what a target alone says.
#[must_use]
pub fn of_target(title: &str, target: &str) -> String {
    format!("{title}: {target}")
}

/// What a calibration does to a point, in words.
#[must_use]
pub const fn meaning(mount: Mount) -> &'static str {
    match mount {
        Mount::OnFlange => {
            "flange_from_sensor takes a point from the sensor's frame to the flange's: p(flange) = R · p(sensor) + t. R is the left part of the matrix, t its last column; points are columns."
        }
        Mount::Fixed => {
            "base_from_sensor takes a point from the sensor's frame to the robot's base: p(base) = R · p(sensor) + t. R is the left part of the matrix, t its last column; points are columns."
        }
    }
}

/// The sensor's frame in words.
pub const SENSOR_FRAME: &str = "Sensor frame: the laser plane is y = 0, x runs across the line, z along the range axis, y completes a right-handed frame. Lengths are millimetres.";
/// Name of the transform.
#[must_use]
pub const fn transform_name(mount: Mount) -> &'static str {
    match mount {
        Mount::OnFlange => "flange_from_sensor",
        Mount::Fixed => "base_from_sensor",
    }
}

/// Title of a table.
#[must_use]
pub fn matrix_title(mount: Mount) -> String {
    format!("{}, homogeneous matrix", transform_name(mount))
}

/// Title of a table.
pub const QUATERNION_TITLE: &str = "Unit quaternion, real part first";
/// Title of a table.
#[must_use]
pub fn six_numbers_title(label: &str) -> String {
    format!("x y z and {label}")
}

/// Head of a column.
pub const QUANTITY: &str = "quantity";
/// Head of a column.
pub const VALUE: &str = "value";
/// Head of a column.
pub const STD: &str = "± 1 σ";
/// Head of a column.
pub const UNIT: &str = "unit";
/// Head of a column of a matrix: of the rotation.
pub const ROTATION_PART: &str = "R";
/// Head of a column of a matrix: of the translation.
pub const TRANSLATION_PART: &str = "t";

/// How three angles make the rotation, in words.
#[must_use]
pub fn convention_in_words(convention: &PoseConvention) -> String {
    let [a, b, c] = convention.angle_names;
    let unit = match convention.usual_angle_unit {
        AngleUnit::Degrees => "degrees",
        AngleUnit::Radians => "radians",
    };
    let axis = |axis| format!("{axis:?}").to_lowercase();
    let order = match convention.order {
        AngleOrder::RotationVector => {
            return format!(
                "{}: {a} {b} {c} are the rotation's axis, a unit vector, times its angle, in {unit}. x y z are millimetres.",
                convention.label
            );
        }
        AngleOrder::Extrinsic([first, second, third]) => format!(
            "turn by {a} about the fixed {} axis, then by {b} about the fixed {} axis, then by {c} about the fixed {} axis",
            axis(first),
            axis(second),
            axis(third)
        ),
        AngleOrder::Intrinsic([first, second, third]) => format!(
            "turn by {a} about the {} axis, then by {b} about the {} axis as it is then, then by {c} about the {} axis as it is then",
            axis(first),
            axis(second),
            axis(third)
        ),
    };
    format!(
        "{}: {order}. As matrices: {}. Angles are {unit}, positive by the right-hand rule; x y z are millimetres.",
        convention.label, convention.formula
    )
}

/// Name of a fact.
pub const ROBOT: &str = "Robot";
/// Name of a fact.
pub const ROBOT_NOISE: &str = "Noise of the robot, stated";
/// Name of a fact.
pub const POSES: &str = "Poses written as";
/// Name of a fact.
pub const SENSOR: &str = "Sensor";
/// Name of a fact.
pub const SENSOR_NOISE: &str = "Noise of a profile point, stated";
/// Name of a fact.
pub const REFERENCE_DISTANCE: &str = "Accuracy stated at";
/// Name of a fact.
pub const MOUNT: &str = "Sensor mounted";
/// Name of a fact.
pub const TARGET_FACT: &str = "Target";
/// Name of a fact.
pub const STATIONS_FACT: &str = "Stations";
/// Name of a fact.
pub const CAPTURES: &str = "Captures in use";
/// Name of a fact.
pub const LEFT_OUT: &str = "Stations left out";
/// Name of a fact.
pub const SCANS: &str = "Scanned parts";
/// Name of a fact.
pub const FURTHER_TARGET: &str = "Further target";
/// Name of a fact.
pub const IF_RADIUS: &str = "If the radius is wrong";
/// Name of a fact.
pub const NOTES: &str = "Notes of the session";
/// Name of a fact.
pub const REMARKS: &str = "Remarks";
/// A fact that the session does not hold.
pub const NOT_STATED: &str = "not stated";
/// A noise that the session does not hold.
pub const ESTIMATED: &str = "not stated; estimated from the data, see “Validation”";

/// The robot's noise.
#[must_use]
pub fn robot_noise(position_mm: Option<f64>, orientation_deg: Option<f64>) -> String {
    match (position_mm, orientation_deg) {
        (None, None) => ESTIMATED.to_owned(),
        (position, orientation) => {
            let part =
                |value: Option<f64>, unit: &str| value.map_or_else(|| NOT_STATED.to_owned(), |v| format!("{v}{unit}"));
            format!("position {}, orientation {} (1 σ, each axis)", part(position, " mm"), part(orientation, "°"))
        }
    }
}

/// A profile's noise.
#[must_use]
pub fn sensor_noise(std_mm: Option<f64>) -> String {
    std_mm.map_or_else(|| NOT_STATED.to_owned(), |std_mm| format!("{std_mm} mm (1 σ)"))
}

/// Title of a table.
pub const OVERVIEW: &str = "Errors of the methods";
/// Head of a column.
pub const MAXIMUM: &str = "maximum";
/// Head of a column.
pub const RMS: &str = "RMS";
/// Head of a column.
pub const LEFT_OUT_RMS: &str = "left out";
/// Group of columns.
pub const FROM_TRUTH: &str = "from the truth";
/// Head of a column.
pub const POINT: &str = "point";
/// Head of a column.
pub const ROTATION: &str = "rotation";

/// What the columns of the errors mean.
#[must_use]
pub const fn errors_legend(target: &Target) -> [&'static str; 2] {
    const LEFT_OUT: &str =
        "left out: each station predicted by the others, RMS · σ point: 1 σ of a point in the workspace, 3D";
    let first = match target {
        Target::RightAnglePlate => "max: largest distance of a point from its edge · RMS: of these distances",
        Target::Point => {
            "max: largest coordinate relative to the first station · RMS: scatter of the tip about its place, 3D"
        }
        Target::Ball { .. } | Target::Workpiece | Target::Rgbd { .. } => {
            "max: largest coordinate relative to the first station · RMS: scatter of the ball about its place, 3D"
        }
    };
    [first, LEFT_OUT]
}

/// A method that gave nothing.
#[must_use]
pub fn not_computed(method: Method, reason: &str) -> String {
    format!("{}: not computed. {reason}", method_name(method))
}

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
pub const LEAVE_ONE_OUT: &str = "Each station predicted by the others";

/// Left-out errors.
#[must_use]
pub fn leave_one_out_line(rms_mm: &str, max_mm: &str) -> String {
    format!("RMS {rms_mm} mm, maximum {max_mm} mm")
}

/// There are too few stations for it.
pub const NO_LEAVE_ONE_OUT: &str = "too few stations to leave one out";
/// Name of a fact.
pub const IN_SAMPLE: &str = "Scatter in sample";
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

/// What δ is.
pub const STABILITY_NOTE: &str =
    "3δ: three standard deviations of the measurements · 3D: root of the sum over the axes";
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
pub const CROSS_TARGETS: &str = "Every calibration on every target, RMS and maximum of the errors";
/// What the star means.
pub const OWN_DATA: &str = "*: computed from these very data, so in sample";
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
pub const STATIONS_NOTE: &str = "error: about the mean, in sample · left out: predicted by the others · studentised: residual in its σ · moves point: how far the workspace point moves without the station";
/// The same for a plate.
pub const EDGE_POINTS_NOTE: &str =
    "error: distance from its edge, in sample · left out: from the edges found without the station";
/// In place of figures.
pub const STATION_LEFT_OUT: &str = "left out";

/// What the exports are.
#[must_use]
pub const fn tool_frames_intro(mount: Mount) -> &'static str {
    match mount {
        Mount::OnFlange => {
            "The sensor's frame as the controller takes it. Each text was read back and compared; what differs is the rounding of its digits."
        }
        Mount::Fixed => {
            "The sensor stands beside the robot, so its frame is no tool. The texts hold it in the robot's base; each was read back and compared."
        }
    }
}

/// An export with its round trip.
#[must_use]
pub fn tool_frame_caption(label: &str, units: &str, file: &str, translation_mm: f64, rotation_deg: f64) -> String {
    format!("{label} ({units}); {file}; read back: off by {translation_mm:.4} mm and {rotation_deg:.5}°")
}

/// The program has no exports of that maker's syntax.
pub const NO_TOOL_FRAME: &str =
    "For this way of writing poses there is no export; `handeye tool-frame --list` names all formats.";

/// Title of a table.
pub const FILES: &str = "Files that this report was made from";
/// Head of a column.
pub const FILE: &str = "file";
/// Head of a column.
pub const BYTES: &str = "bytes";
/// Head of a column.
pub const SHA256: &str = "SHA-256";
/// Name of a fact.
pub const PROGRAM: &str = "Program";
/// Name of a fact.
pub const RESULT_FILE: &str = "All figures with all digits";

/// The program's version.
#[must_use]
pub fn program(version: &str) -> String {
    format!("Handeye {version}")
}

/// Where the figures are.
#[must_use]
pub fn result_file(result: &str, tables: &str) -> String {
    format!("{result} (with covariances), and each table as CSV in {tables}/")
}

/// The report was made of a session that is in no file.
pub const NO_FILE: &str = "The session was in no file when the report was made.";

/// What a method rests on.
#[must_use]
pub const fn references(target: &Target) -> &'static [&'static str] {
    match target {
        Target::Ball { .. } => &[
            LIN_MU,
            "The fits of the whole curve and of all points at once, and their uncertainty, are Handeye's own: docs/methods.md, docs/uncertainty.md.",
        ],
        Target::RightAnglePlate | Target::Point | Target::Workpiece => &[
            CHEN,
            "The bundle of both edges and the uncertainty are Handeye's own: docs/plate.md, docs/uncertainty.md.",
        ],
        Target::Rgbd { .. } => &[],
    }
}

const LIN_MU: &str = "Lin Yuying, Mu Ping'an: “An improved hand-eye calibration method for robot based on standard ball”, Software Guide 18(5), 2019, doi 10.11907/rjdk.182468.";
const CHEN: &str = "Chen Xinyu, Zhou Jie, Zhang Qingxin, Ren Yan: “Hand-eye calibration of robot with linear structured light under orthogonal constraints”, Laser & Infrared 53(5), 2023, doi 10.3969/j.issn.1001-5078.2023.05.015.";

/// Line to sign on.
pub const SIGNED_NAME: &str = "Name";
/// Line to sign on.
pub const SIGNED_PLACE: &str = "Place";
/// Line to sign on.
pub const SIGNED_DATE: &str = "Date";
/// Line to sign on.
pub const SIGNED: &str = "Signature";
