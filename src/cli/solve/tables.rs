//! The tables that `solve` prints for people.

use std::fmt::Write as _;

use crate::calibrate::{Method, MethodResult, Mount, Solution, Uncertainty, best_available};
use crate::diagnose::{Diagnosis, verdict_with};
use crate::geometry::{Flange, Sensor, Transform};
use crate::report::compare::{distance_from_truth, improvement, maximum_error_mm};
use crate::report::digits::{decimals_for, fixed, signed};
use crate::session::{Session, Target};
use crate::text;
use crate::text::conventions::not_known_apart;

use super::stations::stations;

/// Everything about the results, for a terminal 100 columns wide.
///
/// Writing to a string does not fail, hence the `ok()`s.
pub fn tables(session: &Session, results: &[MethodResult], diagnosis: Option<&Diagnosis>) -> String {
    let mut out = String::new();
    writeln!(out, "{} · {}{}\n", session.name, text::start::target(&session.target), measured(session)).ok();
    if let Some(solution) = best_available(results) {
        writeln!(out, "{}", text::answer_head(solution.method)).ok();
        verdict_and_calibration(&mut out, session, solution, diagnosis);
        if !session.further.is_empty() {
            writeln!(out, "  {}", text::cli::further_line(session)).ok();
        }
        out.push('\n');
    }
    overview(&mut out, session, results);
    for result in results {
        match &result.outcome {
            Ok(solution) => method_section(&mut out, session, solution, diagnosis),
            Err(error) => {
                writeln!(
                    out,
                    "\n{} ({})\n  not computed: {error}",
                    text::method_name(result.method),
                    result.method.id()
                )
                .ok();
            }
        }
    }
    out
}

/// How much was measured of a target; a sequence has frames.
fn measured(session: &Session) -> String {
    if matches!(session.target, Target::Rgbd { .. }) {
        return String::new();
    }
    let enabled = || session.stations.iter().filter(|station| station.enabled);
    let num_captures: usize = enabled().map(|station| station.captures.len()).sum();
    format!(" · {} of {} stations, {num_captures} captures", enabled().count(), session.stations.len())
}

fn overview(out: &mut String, session: &Session, results: &[MethodResult]) {
    let has_truth = session.truth.is_some();
    writeln!(
        out,
        "{:<28} {:>9} {:>9} {:>9} {:>9}{}",
        "errors in mm",
        "max",
        "RMS",
        "left out",
        "σ point",
        if has_truth { "   from truth" } else { "" }
    )
    .ok();
    for result in results {
        let name = text::method_name(result.method);
        let Ok(solution) = &result.outcome else {
            writeln!(out, "{name:<28} {:>9}", "–").ok();
            continue;
        };
        let figure = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), |value| fixed(value, 3));
        let truth = session.truth.as_ref().map_or_else(String::new, |truth| {
            let distance = distance_from_truth(solution, truth);
            let known = solution.uncertainty.as_ref();
            // What an error is worth saying of, the uncertainty says.
            let rotation_std_deg = known.map(|known| known.rotation_covariance().trace().max(0.0).sqrt().to_degrees());
            format!(
                "   {} mm, {}°",
                text::digits::value(distance.workspace_point_mm, known.map(|known| known.workspace_point_std_mm)),
                text::digits::value(distance.rotation_rad.to_degrees(), rotation_std_deg)
            )
        });
        writeln!(
            out,
            "{name:<28} {:>9} {:>9} {:>9} {:>9}{truth}",
            figure(Some(maximum_error_mm(solution))),
            figure(Some(solution.scatter.rms_mm)),
            figure(solution.leave_one_out.map(|left_out| left_out.rms_mm)),
            figure(solution.uncertainty.as_ref().map(|uncertainty| uncertainty.workspace_point_std_mm)),
        )
        .ok();
    }
    for line in text::report::errors_legend(&session.target) {
        writeln!(out, "{line}").ok();
    }
    if let Some(improvement) = improvement(results)
        && let Some(percent) = improvement.percent()
    {
        let line = text::report::improvement_line(
            improvement.method,
            &fixed(improvement.error_mm, 3),
            &signed(percent, 0),
            improvement.baseline,
            &fixed(improvement.baseline_error_mm, 3),
        );
        writeln!(out, "{line}").ok();
    }
}

fn method_section(out: &mut String, session: &Session, solution: &Solution, diagnosis: Option<&Diagnosis>) {
    let method: Method = solution.method;
    writeln!(out, "\n{} ({})", text::method_name(method), method.id()).ok();
    verdict_and_calibration(out, session, solution, diagnosis);
    stations(out, solution);
    for warning in &solution.warnings {
        writeln!(out, "  ! [{}] {} {}", warning.code(), text::warning_message(warning), text::warning_remedy(warning))
            .ok();
    }
}

fn verdict_and_calibration(out: &mut String, session: &Session, solution: &Solution, diagnosis: Option<&Diagnosis>) {
    let (verdict, reason) = verdict_with(solution, diagnosis);
    writeln!(out, "  {}", text::verdict_line(verdict, reason, &solution.warnings, session)).ok();
    six_numbers(out, session, &solution.flange_from_sensor, solution.uncertainty.as_ref());
    let Some(motion) = &solution.motion else { return };
    if let Some(offset) = motion.time_offset {
        writeln!(out, "  {}", text::odometry::time_offset(offset.offset_s, offset.std_s)).ok();
    }
    if let Some(tracked) = &motion.tracked {
        writeln!(out, "  {}", text::odometry::steps_line(tracked)).ok();
    }
}

/// The six numbers of a calibration, each with its σ where that is known.
pub fn six_numbers(
    out: &mut String,
    session: &Session,
    flange_from_sensor: &Transform<Flange, Sensor>,
    uncertainty: Option<&Uncertainty>,
) {
    let name = match session.mount {
        Mount::OnFlange => "flange_from_sensor",
        Mount::Fixed => "base_from_sensor",
    };
    let convention = session.robot.notation.convention;
    let translation = flange_from_sensor.translation_mm();
    let rotation = flange_from_sensor.rotation();
    let angles = convention.angles_deg_from_rotation(&rotation);
    let translation_std = uncertainty.map(|uncertainty| uncertainty.translation_std_mm);
    write!(out, "  {name}: ").ok();
    for axis in 0..3 {
        let std = translation_std.map(|std| std[axis]);
        write!(out, "{} {}", ["x", "y", "z"][axis], fixed(translation[axis], decimals_for(std))).ok();
        if let Some(std) = std {
            write!(out, " ± {}", fixed(std, decimals_for(Some(std)))).ok();
        }
        out.push_str(if axis < 2 { ", " } else { " mm\n" });
    }
    let angles_std = uncertainty.map(|known| convention.angles_std_deg(&rotation, &known.rotation_covariance()));
    write!(out, "  {:>width$}  ", "", width = name.len()).ok();
    for axis in 0..3 {
        let std = angles_std.map(|std| std[axis]);
        write!(out, "{} {}", convention.angle_names[axis], fixed(angles[axis], decimals_for(std))).ok();
        if let Some(std) = std {
            write!(out, " ± {}", fixed(std, decimals_for(Some(std)))).ok();
        }
        out.push_str(if axis < 2 { ", " } else { " °" });
    }
    writeln!(out, " ({})", convention.label).ok();
    let remark = uncertainty.and_then(|known| not_known_apart(convention, &rotation, &known.rotation_covariance()));
    if let Some(remark) = remark {
        writeln!(out, "  {:>width$}  {remark}", "", width = name.len()).ok();
    }
}
