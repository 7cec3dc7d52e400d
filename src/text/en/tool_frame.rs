//! Words of the tool frame as text.

use crate::geometry::PoseConvention;
use crate::text::digits;

/// The heading of an export: what it is, in which convention, and how well it is known. `std` holds one σ of the translation,
/// mm, and of the rotation, degrees, each about the axis where it is largest.
#[must_use]
pub fn heading(
    is_carried: bool,
    is_camera: bool,
    convention: Option<&PoseConvention>,
    units: &str,
    remark: Option<&str>,
    std: Option<[f64; 2]>,
) -> Vec<String> {
    let what = if is_carried {
        "flange_from_sensor: the sensor's frame in the flange"
    } else {
        "base_from_sensor: the sensor's frame in the robot's base"
    };
    let mut lines = vec![format!("Handeye, {what}")];
    lines.push(match convention {
        Some(convention) => format!("{units}; R = {}", convention.formula),
        None => units.to_owned(),
    });
    lines.push(if is_camera {
        "sensor: the camera's frame, usually x right, y down, z along the optical axis".to_owned()
    } else {
        "sensor: laser plane y = 0, x across the line, z along the range axis".to_owned()
    });
    if let Some([translation_mm, rotation_deg]) = std {
        lines.push(format!(
            "standard deviation: {} mm, {} deg at most along an axis",
            digits::value(translation_mm, Some(translation_mm)),
            digits::value(rotation_deg, Some(rotation_deg)),
        ));
    }
    lines.extend(remark.map(str::to_owned));
    lines
}

/// Neither a file nor a list is wanted.
pub const NO_FILE: &str = "found no file, expected a session, a result file or a matrix";

/// A warning beside a text that is written all the same.
pub const NOT_USABLE: &str =
    "the calibration is not usable: `handeye solve` says why; mend that before it is entered at a controller";

/// A line of the list of formats.
#[must_use]
pub fn list_line(id: &str, label: &str, units: &str) -> String {
    format!("{id:<22} {label} ({units})\n")
}

/// A name that no format has.
#[must_use]
pub fn no_such_format(id: &str) -> String {
    format!("found {id}, expected the name of a format; `handeye tool-frame --list` lists them")
}

/// A controller's tool, wanted of a sensor that no robot carries.
#[must_use]
pub fn not_of_a_fixed_sensor(id: &str) -> String {
    format!(
        "found a sensor that stands beside the robot, but {id} is the tool of a carried one; take a matrix, a quaternion or a ROS transform"
    )
}

/// A folder that cannot be made.
#[must_use]
pub fn no_folder(folder: &str, problem: &str) -> String {
    format!("cannot make the folder {folder}: {problem}")
}

/// A file was written, and what came back.
#[must_use]
pub fn wrote(file: &str, translation_mm: f64, rotation_deg: f64) -> String {
    format!("wrote {file} (read back: off by {translation_mm:.4} mm and {rotation_deg:.5}°, the rounding)\n")
}

/// A matrix that is not a rotation: its nearest one may be far from what was meant, and a robot would follow it.
#[must_use]
pub fn no_rotation(file: &str, defect: f64) -> String {
    format!(
        "{file}: found a matrix whose left part is no rotation (RᵀR is off 1 by up to {defect:.3}), expected one that a robot can \
         be given; `handeye verify --calibration` names the likely misprint"
    )
}

/// Name of a tool that nobody has named.
pub const DEFAULT_NAME: &str = "scanner";
/// Where there is nothing to write.
pub const NO_CALIBRATION: &str =
    "No method gave a calibration yet. Add stations, or see under Diagnosis what is wrong.";
/// Heading of the list.
pub const FORMATS: &str = "Written for";
/// Hint in the field above the list.
pub const FILTER: &str = "Find a controller or format";
/// Where the list is empty.
pub const NONE_FOUND: &str = "No format of this name.";
/// Why the list has no controllers.
pub const NO_TOOL: &str = "The sensor stands beside the robot, so its frame is no tool of a controller.";
/// Heading of a group.
pub const OWN_ROBOT: &str = "Robot of this session";
/// Heading of a group.
pub const CONTROLLERS: &str = "Robot controllers";
/// Heading of a group.
pub const ROS: &str = "ROS";
/// Heading of a group.
pub const PROGRAMS: &str = "Programs: matrices and quaternions";
/// Heading of a group.
pub const PENDANTS: &str = "Six numbers to type on a pendant";
/// Button.
pub const COPY: &str = "Copy";
/// Button.
pub const SAVE: &str = "Save…";
/// Heading of the question for the file.
pub const SAVE_TITLE: &str = "File for the tool frame";
/// Name of the field with the text.
pub const TEXT: &str = "Text of the tool frame";
/// Label of a field.
pub const CALIBRATION: &str = "Calibration";
/// Label of a field.
pub const NAME: &str = "Name of the tool";
/// Label of a field.
pub const NUMBER: &str = "Number";

/// How well the calibration is known.
#[must_use]
pub fn known_to(std_mm: Option<&str>) -> String {
    match std_mm {
        Some(std_mm) => format!("± {std_mm} mm at the workspace point (1 σ)"),
        None => "uncertainty not known".to_owned(),
    }
}

/// What the numbers mean.
#[must_use]
pub fn meaning(is_carried: bool, units: &str, formula: Option<&str>) -> String {
    let frame = if is_carried { "the flange" } else { "the robot's base" };
    match formula {
        Some(formula) => format!("The sensor's frame in {frame}. Units: {units}. R = {formula}."),
        None => format!("The sensor's frame in {frame}. Units: {units}."),
    }
}

/// The text was read back.
#[must_use]
pub fn read_back(translation_mm: &str, rotation_deg: &str) -> String {
    format!("Read back from this text: equal within {translation_mm} mm and {rotation_deg}°, its rounding.")
}

/// The text was read back, and is another pose.
#[must_use]
pub fn read_back_wrong(translation_mm: &str, rotation_deg: &str) -> String {
    format!(
        "Read back from this text it is another pose, off by {translation_mm} mm and {rotation_deg}°. Do not use it."
    )
}
