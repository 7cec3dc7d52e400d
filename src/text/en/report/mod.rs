//! Wording of reports; that of their tables is in `tables`.

mod tables;

use crate::calibrate::{Method, Mount, Verdict};
use crate::geometry::notation::AngleUnit;
use crate::geometry::{AngleOrder, PoseConvention};
use crate::session::Target;

use super::{method_name, method_short_name, verdict_name};

pub use tables::*;

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
pub const COMPARED: &str = "Methods compared";
/// Name of a fact.
pub const SCALE: &str = "Scale of the verdict";
/// What the scale is held against.
pub const SCALE_NOTE: &str =
    "The larger of σ of a workspace point and the left-out RMS counts; a warning or finding can lower the verdict.";
/// Name of a fact.
pub const NEXT_STEP: &str = "Next step";
/// Heads the warnings.
pub const WARNINGS: &str = "Warnings";

/// A method with what it does.
#[must_use]
pub fn method_and_id(method: Method) -> String {
    format!("{} ({})", method_name(method), method.id())
}

/// Two methods compared: always the largest arc (without sweeps the bundle) against the fixed point, or a plate's bundle against
/// the published method, whichever of them is to be used.
#[must_use]
pub fn improvement_line(
    method: Method,
    error_mm: &str,
    percent: &str,
    baseline: Method,
    baseline_error_mm: &str,
) -> String {
    let error = if Method::PLATE.contains(&method) {
        "left-out distance from the edges, RMS"
    } else {
        "largest coordinate off the first station, in sample"
    };
    format!(
        "{} against {}: {error_mm} mm against {baseline_error_mm} mm, {percent} % ({error})",
        method_name(method),
        method_short_name(baseline),
    )
}

/// A verdict that something lowered.
#[must_use]
pub fn lowered(by_figures: Verdict, verdict: Verdict, code: &str, reason: &str) -> String {
    let [from, to] = [by_figures, verdict].map(|verdict| verdict_name(verdict).to_lowercase());
    format!("By its figures alone it would be {from}; “{code}” lowers it to {to}. {reason}")
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
#[must_use]
pub const fn sensor_frame(target: &Target) -> &'static str {
    match target {
        Target::Pose { .. } => {
            "Sensor frame: that of the camera, as the program has it that found the target: usually z along the optical axis, x to the right and y down in the image. Lengths are millimetres."
        }
        Target::Rgbd { .. } => {
            "Sensor frame: that of the colour camera: x to the right, y down, z along the optical axis. Lengths are millimetres."
        }
        _ => PROFILER_FRAME,
    }
}

const PROFILER_FRAME: &str = "Sensor frame: the laser plane is y = 0, x runs across the line, z along the range axis, y completes a right-handed frame. Lengths are millimetres.";
/// How many digits are printed.
pub const DIGITS: &str =
    "Figures end with the second digit of their σ, R and quaternion one digit later; result.json has all digits.";
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
pub const TARGET_NOISE: &str = "Noise of the seen target, stated";
/// Name of a fact.
pub const REFERENCE_DISTANCE: &str = "Accuracy stated at";
/// Name of a fact.
pub const FRAMES: &str = "Frames";
/// Name of a fact.
pub const PICTURE_SIZE: &str = "Pictures";
/// Name of a fact.
pub const CAMERA_TRAVEL: &str = "Camera's way";
/// Name of a fact.
pub const AGAINST_TRUTH: &str = "Against the true way";
/// Name of a fact.
pub const CLOCKS: &str = "Clocks";
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
/// Beside the radius of a ball whose centres the session holds.
pub const RADIUS_NOT_USED: &str = "not used, as the readings are centres already";
/// A noise that the session does not hold.
pub const ESTIMATED: &str = "not stated; estimated from the data, see “Validation”";

/// The noise of poses; `is_estimated` where the report tells what the data show of it.
#[must_use]
pub fn pose_noise(position_mm: Option<f64>, orientation_deg: Option<f64>, is_estimated: bool) -> String {
    match (position_mm, orientation_deg) {
        (None, None) => if is_estimated { ESTIMATED } else { NOT_STATED }.to_owned(),
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

/// The code of the finding that the controller is not to be given the calibration.
pub const NOT_FOR_USE_CODE: &str = "not-usable";
/// What to do instead.
pub const NOT_FOR_USE_REMEDY: &str = "Mend what the diagnosis names and calibrate again before anything is entered.";

/// The verdict beside the texts for the controller.
#[must_use]
pub fn not_for_use(reason: &str) -> String {
    format!("This calibration is not usable. {reason}")
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

/// Of a file that is another by now.
pub const CHANGED_SINCE: &str = "changed since it was read; the checksum is of what was read";
/// Of a file that cannot be read any more.
pub const GONE_SINCE: &str = "cannot be read any more; the checksum is of what was read";
/// Of a session that no file holds as it is.
pub const NOT_SAVED: &str = "not saved; the checksum is of the file that “Save” would write";
/// Of a calibration that was given as figures.
pub const PASTED: &str =
    "a calibration that was pasted; the checksum is of its 16 figures, row by row, as JSON prints them";
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
        Target::RightAnglePlate => &[
            CHEN,
            "The bundle of both edges and the uncertainty are Handeye's own: docs/plate.md, docs/uncertainty.md.",
        ],
        Target::Pose { .. } => &[
            CLOSED_FORM_PAPERS,
            "The refined answer and its uncertainty are Handeye's own: docs/motion.md, docs/uncertainty.md.",
        ],
        Target::Point => &[
            CHEN,
            "The fixed point of a tip is the fixed point of a ball's centre with the tip in its place (docs/methods.md); how a tip is found in a profile and the uncertainty are Handeye's own: docs/edges.md, docs/uncertainty.md.",
        ],
        Target::Workpiece => {
            &[CHEN, "How planes, teeth and diameters are measured is Handeye's own: docs/workpiece.md."]
        }
        Target::Rgbd { .. } => &[
            "Visual odometry method based on an RGB-D camera, patent application CN 102692236 A, 2012.",
            CLOSED_FORM_PAPERS,
            "The tracking of the images, the refined answer and its uncertainty are Handeye's own: docs/odometry.md, docs/motion.md, docs/uncertainty.md.",
        ],
    }
}

const CLOSED_FORM_PAPERS: &str = "Closed forms: Tsai & Lenz 1989; Park & Martin 1994; Horaud & Dornaika 1995; Daniilidis 1999; Andreff, Horaud & Espiau 2001; Li, Wang & Wu 2010; Shah 2013.";

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
