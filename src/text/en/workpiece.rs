//! Wording about scanned parts: what `handeye scan` prints and what the Verify step shows.

use std::fmt::Write as _;

use crate::calibrate::Method;
use crate::scan::{Deviation, PlaneEquation, PlaneFit, Region, Round, RoundKind, Shapes, Teeth, angle_between};
use crate::session::{Known, SessionScan};
use crate::text::digits::{decimals_for, fixed, signed};
use crate::verify::Figures;

use super::{method_name, plural};

/// Decimals of distances from planes, mm.
pub const DISTANCE_DECIMALS: usize = 3;
/// An angle this near to the nominal one is compared with it, degrees.
const COMPARED_WITHIN_DEG: f64 = 5.0;

/// The name of a scan.
#[must_use]
pub fn scan_name(scan: &SessionScan) -> String {
    let scans = || scan.station_label.as_ref().map_or_else(|| "all scans".to_owned(), |label| format!("scan {label}"));
    match &scan.target_name {
        Some(target) => format!("{target}: {}", scans()),
        None => scans(),
    }
}

/// A whole number in groups of three digits.
#[must_use]
pub fn grouped(number: usize) -> String {
    let digits = number.to_string();
    let mut grouped = String::new();
    for (idx, digit) in digits.chars().enumerate() {
        if idx > 0 && (digits.len() - idx).is_multiple_of(3) {
            grouped.push(',');
        }
        grouped.push(digit);
    }
    grouped
}

/// A plane's equation as papers print it: `x + 0.00058 y + 0.00073 z = 12.586`, with as many digits as are known.
#[must_use]
pub fn equation(equation: &PlaneEquation) -> String {
    let mut text = String::new();
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        let coefficient = equation.coefficients[axis];
        if axis == equation.leading {
            text.push_str(if text.is_empty() { "" } else { " + " });
            text.push_str(name);
            continue;
        }
        let digits = fixed(coefficient.abs(), decimals_for(Some(equation.coefficient_stds[axis])).clamp(3, 6));
        let sign = match (text.is_empty(), coefficient < 0.0) {
            (true, false) => "",
            (true, true) => "-",
            (false, false) => " + ",
            (false, true) => " - ",
        };
        write!(text, "{sign}{digits} {name}").ok();
    }
    let offset = fixed(equation.offset_mm, decimals_for(Some(equation.offset_std_mm)).min(4));
    format!("{text} = {offset}")
}

/// What heads the output: the scan, its points and the calibration.
#[must_use]
pub fn scan_head(name: &str, num_points: usize, num_profiles: Option<usize>, calibration: Option<&str>) -> String {
    let profiles = num_profiles.map_or_else(String::new, |num| format!(" in {} profile{}", grouped(num), plural(num)));
    let calibration = calibration.map_or_else(String::new, |name| format!("; calibration: {name}"));
    format!("{name}: {} point{}{profiles}{calibration}\n", grouped(num_points), plural(num_points))
}

/// One line of the plane table, or why there is no plane.
#[must_use]
pub fn plane_lines(region: &Region) -> String {
    let fit = match &region.plane {
        Ok(fit) => fit,
        Err(error) => return format!("  {}: {error}\n", region.name),
    };
    let sizes: Vec<f64> = region.distances_mm.iter().map(|distance| distance.abs()).collect();
    let figures = Figures::of(&sizes);
    let mm = |value: f64| fixed(value, DISTANCE_DECIMALS);
    format!(
        "  {}: {}\n     known to ± {} mm and ± {}° (1 σ); {} of {} points; {} drawn: mean {}, sd {}, max {}, RMS {} mm\n",
        region.name,
        equation(&fit.equation()),
        fixed(fit.height_std_mm(), 4),
        fixed(fit.normal_std_rad().to_degrees(), 4),
        grouped(fit.num_used),
        grouped(fit.num_points),
        figures.count,
        mm(figures.mean_mm),
        mm(figures.std_mm),
        mm(figures.max_mm),
        mm(figures.rms_mm),
    )
}

/// The angle between two planes, degrees, and its σ; with the difference from a nominal angle that is near.
#[must_use]
pub fn angle(first: &PlaneFit, second: &PlaneFit, nominal_deg: Option<f64>) -> String {
    let angle = angle_between(first, second);
    let (value, std) = (angle.angle_rad.to_degrees(), angle.std_rad.to_degrees());
    let decimals = decimals_for(Some(std)).clamp(2, 4);
    // The angle is that of the planes, 0 to 90°; nominal angles may be those of their outsides.
    let nominal = nominal_deg.map(|nominal| if nominal > 90.0 { 180.0 - nominal } else { nominal });
    let compared = nominal
        .filter(|nominal| (value - nominal).abs() < COMPARED_WITHIN_DEG)
        .map_or_else(String::new, |nominal| format!(", {}° off {nominal}°", signed(value - nominal, decimals)));
    format!("{}° ± {}°{compared}", fixed(value, decimals), fixed(std, decimals))
}

/// Planes and the angles between them.
#[must_use]
pub fn planes_table(regions: &[Region], known: &Known) -> String {
    if regions.is_empty() {
        return "Planes: none found that holds 4 % of the points\n".to_owned();
    }
    let mut text = String::from("Planes (mm)\n");
    for region in regions {
        text.push_str(&plane_lines(region));
    }
    let fits: Vec<(&str, &PlaneFit)> =
        regions.iter().filter_map(|region| Some((region.name.as_str(), region.plane.as_ref().ok()?))).collect();
    if fits.len() > 1 {
        text.push_str("Angles\n");
    }
    for (idx, (first_name, first)) in fits.iter().enumerate() {
        for (second_name, second) in &fits[idx + 1..] {
            writeln!(text, "  {first_name}, {second_name}: {}", angle(first, second, known.angle_deg)).ok();
        }
    }
    text
}

/// Teeth and diameters.
#[must_use]
pub fn shapes_table(shapes: &Shapes, known: &Known) -> String {
    let mut text = String::new();
    match &shapes.teeth {
        Some(Ok(teeth)) => text.push_str(&teeth_table(teeth, known)),
        Some(Err(error)) => drop(writeln!(text, "Teeth: {error}")),
        None => {}
    }
    match &shapes.round {
        Some(Ok(round)) => drop(writeln!(text, "{}", round_line(round, known.diameter_mm))),
        Some(Err(error)) => drop(writeln!(text, "Diameter: {error}")),
        None => {}
    }
    text
}

fn teeth_table(teeth: &Teeth, known: &Known) -> String {
    let mut text =
        format!("Teeth: {}\n   no.  place mm   pitch mm      ± 1 σ  height mm      ± 1 σ\n", teeth.teeth.len());
    for (idx, tooth) in teeth.teeth.iter().enumerate() {
        let cells = |measured: Option<crate::scan::Measured>| {
            measured.map_or_else(
                || ("–".to_owned(), String::new()),
                |measured| (fixed(measured.value_mm, 3), fixed(measured.std_mm, 3)),
            )
        };
        let (pitch, height) = (cells(tooth.pitch), cells(tooth.height));
        writeln!(
            text,
            "  {:>4} {:>9} {:>10} {:>10} {:>10} {:>10}",
            idx + 1,
            fixed(tooth.place_mm, 3),
            pitch.0,
            pitch.1,
            height.0,
            height.1,
        )
        .ok();
    }
    for (name, values, nominal) in [
        ("pitch", teeth.pitches().collect::<Vec<_>>(), known.pitch_mm),
        ("height", teeth.heights().collect(), known.height_mm),
    ] {
        let deviation = nominal.and_then(|nominal| Deviation::of(values.into_iter(), nominal));
        if let Some((deviation, nominal)) = deviation.zip(nominal) {
            writeln!(text, "  {name}: {}", deviation_words(&deviation, nominal)).ok();
        }
    }
    text
}

/// How values compare with their nominal one.
#[must_use]
pub fn deviation_words(deviation: &Deviation, nominal_mm: f64) -> String {
    format!(
        "mean {} mm, nominal {nominal_mm} mm; mean error {}, greatest {} mm",
        fixed(deviation.mean_value_mm, 3),
        fixed(deviation.mean_error_mm, 3),
        fixed(deviation.max_error_mm, 3)
    )
}

/// What a round thing is called.
#[must_use]
pub const fn round_name(kind: RoundKind) -> &'static str {
    match kind {
        RoundKind::Ball => "Ball",
        RoundKind::Cylinder => "Cylinder",
    }
}

/// A diameter, with what the certificate says.
#[must_use]
pub fn round_line(round: &Round, nominal_mm: Option<f64>) -> String {
    let decimals = decimals_for(Some(round.diameter_std_mm)).clamp(3, 4);
    let compared = nominal_mm.map_or_else(String::new, |nominal| {
        format!(", {} mm off the certified {nominal} mm", signed(round.diameter_mm - nominal, decimals))
    });
    format!(
        "{}: diameter {} ± {} mm{compared}; RMS {} mm over {} points",
        round_name(round.kind),
        fixed(round.diameter_mm, decimals),
        fixed(round.diameter_std_mm, decimals),
        fixed(round.rms_mm, 3),
        grouped(round.num_used),
    )
}

/// Where a session has no scan.
pub const NO_SCAN: &str = "the session holds no scan: its target is no \"workpiece\", nor is a further target's; \
                           `handeye simulate --target workpiece` makes one";
/// Where nothing says how the sensor is mounted.
#[must_use]
pub fn no_calibration(reason: &str) -> String {
    format!(
        "no calibration to see the scan with: {reason}. Give one: --calibration RESULT.json (from `handeye solve --json`) \
         or a text file with the matrix"
    )
}
/// Why a session without another target has no calibration of its own.
pub const ONLY_A_WORKPIECE: &str = "the session has no target from which one is computed";
/// The truth of a simulated session.
pub const TRUTH: &str = "truth of the simulation";
/// A session that was not simulated.
pub const NO_TRUTH: &str = "the session was not simulated, so it knows no truth";
/// A region without points.
pub const EMPTY_REGION: &str = "there are no points inside of that; draw around some, or click on one";
/// A method without a result.
#[must_use]
pub fn no_result_of(method: Method) -> String {
    format!("{} has no result", method_name(method))
}
/// No scan has that name.
#[must_use]
pub fn no_such_scan(wanted: &str, names: &[String]) -> String {
    format!("--scan: found {wanted}, expected one of: {}", names.join(", "))
}
/// What was written.
#[must_use]
pub fn wrote_cloud(path: &str, num_points: usize) -> String {
    format!("wrote {} points to {path}\n", grouped(num_points))
}

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
pub const TOOL_POINT_HINT: &str = "Click on a face: the plane about that point becomes a region";
/// Tool of the picture.
pub const TOOL_RECTANGLE: &str = "Rectangle";
/// What it does.
pub const TOOL_RECTANGLE_HINT: &str =
    "Draw a rectangle: all points inside of it, also hidden ones, become a region. Shift turns the drag into a move";
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
/// Title of a card.
pub const TEETH: &str = "Teeth";
/// Title of a card.
pub const AGAINST_NOMINAL: &str = "Against nominal values";
/// Head of a column.
pub const TOOTH_COLUMN: &str = "  tooth";
/// Heads of the columns of teeth.
pub const TEETH_COLUMNS: [&str; 5] = ["place, mm", "pitch, mm", "error, mm", "height, mm", "error, mm"];
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
    let profiles = num_profiles.map_or_else(String::new, |num| format!(", {} profile{}", grouped(num), plural(num)));
    format!("{name}: {} points{profiles}", grouped(num_points))
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
    let basis = if fit.is_known_from_profiles() {
        "from how its profiles scatter"
    } else {
        "as if every point counted for itself: too few profiles"
    };
    format!(
        "{}\nknown to ± {} mm and ± {}° (1 σ), {basis}\n{} of {} points, RMS {} mm",
        equation(&fit.equation()),
        fixed(fit.height_std_mm(), 4),
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equations_are_printed_as_in_the_paper() {
        let mut plane = PlaneEquation {
            coefficients: [1.0, 0.000_581_3, 0.000_736],
            coefficient_stds: [0.0, 1e-5, 1e-4],
            leading: 0,
            offset_mm: 12.5864,
            offset_std_mm: 0.012,
        };
        assert_eq!(equation(&plane), "x + 0.000581 y + 0.00074 z = 12.586");
        plane = PlaneEquation { coefficients: [-0.25, -0.5, 1.0], leading: 2, coefficient_stds: [0.0012; 3], ..plane };
        assert_eq!(equation(&plane), "-0.2500 x - 0.5000 y + z = 12.586");
    }

    #[test]
    fn large_numbers_are_grouped() {
        assert_eq!(grouped(0), "0");
        assert_eq!(grouped(999), "999");
        assert_eq!(grouped(5_000_000), "5,000,000");
    }
}
