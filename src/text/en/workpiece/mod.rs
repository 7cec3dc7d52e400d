//! Wording about scanned parts: what `handeye scan` prints and what the Verify step shows, and what they share.

mod panel;
mod report;

use std::fmt::Write as _;

use crate::calibrate::Method;
use crate::geometry::Vec3;
use crate::scan::{MIN_PROFILES, PlaneEquation, PlaneFit, RoundKind, angle_between};
use crate::session::SessionScan;
use crate::text::digits::{decimals_for, fixed, signed};

use super::{method_name, plural};

pub use panel::*;
pub use report::*;

/// Decimals of distances from planes, mm.
pub const DISTANCE_DECIMALS: usize = 3;
/// An angle this near to the nominal one is compared with it, degrees.
const COMPARED_WITHIN_DEG: f64 = 5.0;

/// The name of a scan.
#[must_use]
pub fn scan_name(scan: &SessionScan) -> String {
    let scans = match &scan.station_label {
        None => "all scans".to_owned(),
        // Most are called so by whoever recorded them.
        Some(label) if label.to_lowercase().starts_with("scan") => label.clone(),
        Some(label) => format!("scan {label}"),
    };
    match &scan.target_name {
        Some(target) => format!("{target}: {scans}"),
        None => scans,
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
    let is_known = first.is_known_from_profiles() && second.is_known_from_profiles();
    let sign = if is_known { "±" } else { "± >" };
    format!("{}° {sign} {}°{compared}", fixed(value, decimals), fixed(std, decimals))
}

/// How well a plane's height is known, mm: at least that badly where too few profiles met it.
#[must_use]
pub fn height_std(fit: &PlaneFit) -> String {
    let std = fixed(fit.height_std_mm(), 4);
    if fit.is_known_from_profiles() { std } else { format!("> {std}") }
}

/// Why σ of a plane is too good to be true; nothing where it is not.
#[must_use]
pub fn optimistic(fit: &PlaneFit) -> Option<String> {
    (!fit.is_known_from_profiles()).then(|| {
        format!(
            "σ is optimistic: {} profile{} met it, and fewer than {MIN_PROFILES} do not tell how they scatter",
            fit.num_profiles,
            plural(fit.num_profiles)
        )
    })
}

/// What a round thing is called.
#[must_use]
pub const fn round_name(kind: RoundKind) -> &'static str {
    match kind {
        RoundKind::Ball => "Ball",
        RoundKind::Cylinder => "Cylinder",
    }
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
/// A region that is there already.
#[must_use]
pub fn region_is_known(name: &str) -> String {
    format!("those points are region {name} already; remove it first, or draw around a part of it")
}
/// A box of the command line without points, and where there are some.
#[must_use]
pub fn empty_box(scan: &str, corners: &[f64], bounds_mm: Option<[Vec3; 2]>) -> String {
    let corners: Vec<String> = corners.iter().map(f64::to_string).collect();
    let bounds = bounds_mm.map_or_else(String::new, |[low, high]| {
        let corner = |at: Vec3| [at.x, at.y, at.z].map(|value| fixed(value, 1)).join(" ");
        format!("; its points are between {} and {}", corner(low), corner(high))
    });
    format!("--plane: found no point of {scan} in the box {} mm{bounds}", corners.join(" "))
}
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
