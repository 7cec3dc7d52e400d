//! What the Verify step shows of scanned parts.

use crate::calibrate::Method;
use crate::scan::PlaneFit;
use crate::text::digits::{decimals_for, fixed};
use crate::text::en::{method_name, plural};

use super::{TRUTH, equation, grouped, height_std, optimistic};

/// How many of the points are drawn.
#[must_use]
pub fn showing(num_shown: usize, num_points: usize) -> String {
    if num_shown == num_points {
        format!("showing all {} points", grouped(num_points))
    } else {
        format!("showing {} of {} points", grouped(num_shown), grouped(num_points))
    }
}

/// The point under the pointer.
#[must_use]
pub fn point_readout(x: &str, y: &str, z: &str) -> String {
    format!("x {x}  y {y}  z {z} mm")
}

/// What a calibration is called in a list.
#[must_use]
pub fn calibration_name(calibration: &ScanChoice<'_>) -> String {
    match calibration {
        ScanChoice::Best => "best of this session".to_owned(),
        ScanChoice::Of(method) => method_name(*method).to_owned(),
        ScanChoice::Truth => TRUTH.to_owned(),
        ScanChoice::File(name) => (*name).to_owned(),
    }
}

/// Where a calibration comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ScanChoice<'a> {
    /// The best that the session gives.
    Best,
    /// That of a method.
    Of(Method),
    /// The truth of a simulation.
    Truth,
    /// A file of this name.
    File(&'a str),
}

/// Title of the empty section.
pub const NO_SCAN_TITLE: &str = "No scanned part here";
/// What leads out of it.
pub const NO_SCAN_HINT: &str = "A scan is a path of captures over a part: a session, or a further target of it, whose target is a \
                                workpiece. Simulate one, measure it on the command line, or open points from elsewhere.";
/// The commands for that.
pub const NO_SCAN_COMMANDS: &str =
    "handeye simulate --target workpiece --out part.json    ·    handeye scan part.json --calibration RESULT.json";
/// After the user has given up an examination.
pub const CANCELLED: &str = "the examination of the scan was cancelled";
/// Button beside that, and beside any other reason.
pub const EXAMINE_AGAIN: &str = "Examine again";
/// Button.
pub const UNDO_REGIONS: &str = "Undo regions";
/// What it does.
pub const UNDO_REGIONS_HINT: &str =
    "Takes back the last region that was added or removed, or planes that were found anew";
/// While points are worked out.
pub const EXAMINING: &str = "examining the scan…";
/// Label of the list of scans.
pub const SCAN: &str = "Scan";
/// What it is for.
pub const SCAN_HINT: &str = "The scan whose points are shown; all scans of a part together come first";
/// Label of the list of calibrations.
pub const CALIBRATION: &str = "seen through";
/// Entry of that list.
pub const CHOOSE_CALIBRATION: &str = "From a file…";
/// Button.
pub const CANCEL: &str = "Cancel";
/// While points are written.
pub const EXPORTING: &str = "exporting";
/// Button.
pub const EXPORT_POINTS: &str = "Export points…";
/// What it does.
pub const EXPORT_POINTS_HINT: &str = "Writes all points in the base, mm, as PLY or CSV by the ending of the name";
/// Heading where the path is typed for that.
pub const EXPORT_POINTS_TITLE: &str = "Export the points as PLY or CSV";
/// Button.
pub const OPEN_POINTS: &str = "Open points…";
/// What it does.
pub const OPEN_POINTS_HINT: &str = "Reads points from elsewhere: PLY, CSV or XYZ, in mm";
/// Heading where the path is typed for that.
pub const OPEN_POINTS_TITLE: &str = "Open points (PLY, CSV or XYZ, mm)";
/// Heading where the path of a calibration is typed.
pub const CALIBRATION_TITLE: &str = "Calibration: a result file, or a text file with a matrix";
/// Button below that.
pub const USE_BUTTON: &str = "Use";
/// Kinds of files of points, in the system's dialog.
pub const POINTS_FILTER: &str = "Points";
/// What a screen reader calls the picture.
pub const CLOUD: &str = "Points of the scan";
/// Before the directions of view.
pub const LOOK_ALONG: &str = "look along";
/// Before the kinds of colours.
pub const COLOR_BY: &str = "colour";
/// Colours by height.
pub const BY_HEIGHT: &str = "height";
/// Colours by region.
pub const BY_REGION: &str = "region";
/// Colours by distance.
pub const BY_DISTANCE: &str = "distance";
/// Title of a scale of colours.
pub const HEIGHT_SCALE: &str = "z, mm";
/// Title of a scale of colours.
pub const DISTANCE_SCALE: &str = "from plane, mm";
/// Tool of the picture.
pub const TOOL_TURN: &str = "Turn";
/// What it does.
pub const TOOL_TURN_HINT: &str = "Drag to turn, Shift or the right button to move, wheel to zoom, double click to see all; arrow keys, + and − as well";
/// Tool of the picture.
pub const TOOL_POINT: &str = "Pick plane";
/// What it does.
pub const TOOL_POINT_HINT: &str =
    "Click on a face: the plane about that point becomes a region; Enter takes the face in the middle of the picture";
/// Tool of the picture.
pub const TOOL_RECTANGLE: &str = "Rectangle";
/// What it does.
pub const TOOL_RECTANGLE_HINT: &str = "Draw a rectangle: the points inside of it that can be seen become a region; Enter takes the one drawn in the middle. Shift turns the drag into a move";
/// Title of a card.
pub const PLANES: &str = "Planes, and distances of random points (mm)";
/// Button.
pub const FIND_PLANES: &str = "Find planes";
/// What it does.
pub const FIND_PLANES_HINT: &str = "Finds all planes of the part anew, in place of the regions below";
/// Where there are none.
pub const NO_PLANES: &str = "No planes yet: find them, or pick one in the picture.";
/// All of them.
pub const ALL_REGIONS: &str = "all planes";
/// Title of an axis.
pub const DISTANCE_AXIS: &str = "distance from the plane, mm";
/// Head of a column.
pub const REGION_COLUMN: &str = "  region";
/// Head of a column.
pub const EQUATION_COLUMN: &str = "equation";
/// Heads of the columns of distances.
pub const FIGURE_COLUMNS: [&str; 3] = ["mean", "sd", "max"];
/// Head of a column.
pub const STD_COLUMN: &str = "± 1 σ";
/// Head of a column.
pub const POINTS_COLUMN: &str = "points";
/// Title of a card.
pub const TEETH: &str = "Teeth";
/// Title of a card.
pub const AGAINST_NOMINAL: &str = "Against nominal values";
/// Head of a column.
pub const TOOTH_COLUMN: &str = "  tooth";
/// Heads of the columns of teeth.
pub const TEETH_COLUMNS: [&str; 7] =
    ["place, mm", "pitch, mm", "± 1 σ", "error, mm", "height, mm", "± 1 σ", "error, mm"];
/// What is measured.
pub const PITCH: &str = "Pitch";
/// What is measured.
pub const HEIGHT: &str = "Height";
/// Label of a figure.
pub const MEAN_ERROR: &str = "    mean error";
/// Label of a figure.
pub const GREATEST_ERROR: &str = "    greatest error";
/// Label of a figure.
pub const CERTIFIED: &str = "    certified";
/// Label of a figure.
pub const DIFFERENCE: &str = "    difference";
/// Label of a figure.
pub const ROUND_RMS: &str = "    RMS of its points";
/// Label of a figure.
pub const ROUND_POINTS: &str = "    points used";

/// Title of the card with the points.
#[must_use]
pub fn picture_title(name: &str, num_points: usize, num_profiles: Option<usize>) -> String {
    format!("{name}: {}", self::num_points(num_points, num_profiles))
}

/// The same without a name.
#[must_use]
pub fn num_points(num_points: usize, num_profiles: Option<usize>) -> String {
    let profiles = num_profiles.map_or_else(String::new, |num| format!(", {} profile{}", grouped(num), plural(num)));
    format!("{} points{profiles}", grouped(num_points))
}

/// What a screen reader calls the button.
#[must_use]
pub fn look_along(axis: &str) -> String {
    format!("Look along {axis}")
}

/// Title of the histogram.
#[must_use]
pub fn histogram_title(num_drawn: usize, shown: &str) -> String {
    format!("{num_drawn} random points: {shown}")
}

/// What is known of a plane.
#[must_use]
pub fn plane_hover(fit: &PlaneFit) -> String {
    let basis = optimistic(fit).unwrap_or_else(|| "from how its profiles scatter".to_owned());
    format!(
        "{}\nknown to ± {} mm and ± {}° (1 σ), {basis}\n{} of {} points, RMS {} mm",
        equation(&fit.equation()),
        height_std(fit),
        fixed(fit.normal_std_rad().to_degrees(), 4),
        grouped(fit.num_used),
        grouped(fit.num_points),
        fixed(fit.rms_mm, 4),
    )
}

/// What a screen reader calls the button.
#[must_use]
pub fn remove_region(name: &str) -> String {
    format!("Remove region {name}")
}

/// What a screen reader calls the coloured square.
#[must_use]
pub fn show_region(name: &str) -> String {
    format!("Distances of region {name} alone")
}

/// What a screen reader calls the field.
#[must_use]
pub fn region_name_field(name: &str) -> String {
    format!("Name of region {name}")
}

/// Before an angle.
#[must_use]
pub fn angle_label(first: &str, second: &str) -> String {
    format!("angle {first}, {second}")
}

/// Label of a mean value.
#[must_use]
pub fn mean_label(name: &str, nominal_mm: f64) -> String {
    format!("{name}, nominal {nominal_mm} mm")
}

/// Label of a diameter.
#[must_use]
pub fn diameter_label(name: &str) -> String {
    format!("{name}, diameter")
}

/// A length.
#[must_use]
pub fn mm(value: f64) -> String {
    format!("{} mm", fixed(value, 3))
}

/// A length and its σ.
#[must_use]
pub fn plus_minus(value: f64, std: f64) -> String {
    let decimals = decimals_for(Some(std)).clamp(3, 4);
    format!("{} ± {} mm", fixed(value, decimals), fixed(std, decimals))
}
