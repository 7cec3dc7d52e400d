//! What `handeye scan` prints.

use std::fmt::Write as _;

use crate::scan::{Deviation, PlaneFit, Region, Round, Shapes, Teeth};
use crate::session::Known;
use crate::text::digits::{decimals_for, fixed, signed};
use crate::text::en::plural;
use crate::verify::Figures;

use super::{DISTANCE_DECIMALS, angle, equation, grouped, height_std, optimistic, round_name};

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
    let remark = optimistic(fit).map_or_else(String::new, |remark| format!("     {remark}\n"));
    format!(
        "  {}: {}\n{remark}     known to ± {} mm and ± {}° (1 σ); {} of {} points; {} drawn: mean {}, sd {}, max {}, RMS {} mm\n",
        region.name,
        equation(&fit.equation()),
        height_std(fit),
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
