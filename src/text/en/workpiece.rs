//! Wording about scanned parts: what `handeye scan` prints and what the Verify step shows.

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
        if idx > 0 && (digits.len() - idx) % 3 == 0 {
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
        text.push_str(&format!("{sign}{digits} {name}"));
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
            text.push_str(&format!("  {first_name}, {second_name}: {}\n", angle(first, second, known.angle_deg)));
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
        Some(Err(error)) => text.push_str(&format!("Teeth: {error}\n")),
        None => {}
    }
    match &shapes.round {
        Some(Ok(round)) => text.push_str(&format!("{}\n", round_line(round, known.diameter_mm))),
        Some(Err(error)) => text.push_str(&format!("Diameter: {error}\n")),
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
        text.push_str(&format!(
            "  {:>4} {:>9} {:>10} {:>10} {:>10} {:>10}\n",
            idx + 1,
            fixed(tooth.place_mm, 3),
            pitch.0,
            pitch.1,
            height.0,
            height.1,
        ));
    }
    for (name, values, nominal) in [
        ("pitch", teeth.pitches().collect::<Vec<_>>(), known.pitch_mm),
        ("height", teeth.heights().collect(), known.height_mm),
    ] {
        let deviation = nominal.and_then(|nominal| Deviation::of(values.into_iter(), nominal));
        if let Some((deviation, nominal)) = deviation.zip(nominal) {
            text.push_str(&format!("  {name}: {}\n", deviation_words(&deviation, nominal)));
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equations_are_printed_as_in_the_paper() {
        let mut plane = PlaneEquation {
            coefficients: [1.0, 0.000_581_3, 0.000_735],
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
