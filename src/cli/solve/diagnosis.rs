//! The section that `solve` prints after its tables: what is wrong, how far the result can be relied on, where to measure
//! next.

use std::fmt::Write as _;

use crate::calibrate::verdict::judge;
use crate::calibrate::{Method, MethodResult, Solution, Verdict, best_available};
use crate::diagnose::Finding;
use crate::plan::Plan;
use crate::report::digits::fixed;
use crate::report::result_file::Examination;
use crate::session::Session;
use crate::text::cli::nothing_wrong_but_poorly_known;
use crate::text::diagnosis as words;
use crate::text::shell::more_of_a_kind;

/// Findings of a kind that are listed before the rest is only counted.
const MAX_OF_A_KIND: usize = 3;

/// The section, headed "Diagnosis". Writing to a string does not fail, hence the `ok()`s.
pub fn section(session: &Session, results: &[MethodResult], examination: &Examination<'_>) -> String {
    let mut out = format!("\n{}\n", words::HEADING);
    let solution = best_available(results);
    let is_good = solution.is_none_or(|solution| judge(solution).0 == Verdict::Good);
    findings(&mut out, session, examination, is_good);
    let lines = solution.into_iter().flat_map(|solution| figures(session, solution, examination));
    for line in lines.chain(examination.plan.and_then(|plan| next_pose(session, plan))) {
        writeln!(out, "  {line}").ok();
    }
    out
}

fn findings(out: &mut String, session: &Session, examination: &Examination<'_>, is_good: bool) {
    let findings = &examination.diagnosis.findings;
    if findings.is_empty() {
        let has_next_pose = examination.plan.is_some_and(|plan| !plan.stations.is_empty());
        let sentence = if is_good { words::NOTHING_FOUND } else { nothing_wrong_but_poorly_known(has_next_pose) };
        writeln!(out, "  {sentence}").ok();
    }
    for finding in findings {
        let code = finding.fault.code();
        let of_kind: Vec<&Finding> = findings.iter().filter(|other| other.fault.code() == code).collect();
        let place = of_kind.iter().position(|other| *other == finding).unwrap_or(0);
        if place == MAX_OF_A_KIND {
            writeln!(out, "    {}", more_of_a_kind(of_kind.len() - MAX_OF_A_KIND, code)).ok();
        }
        if place >= MAX_OF_A_KIND {
            continue;
        }
        let message = words::fault_message(&finding.fault, session);
        let remedy = words::fault_remedy(&finding.fault, session);
        write!(out, "  {} [{code}] {message} {remedy}", words::severity_mark(finding.severity)).ok();
        if let Some(residual_mm) = finding.evidence.residual_mm {
            write!(out, " {}", words::residual_falls(residual_mm)).ok();
        }
        out.push('\n');
    }
    if let Some(first) = findings.first() {
        let step = first
            .remedy
            .as_ref()
            .map_or_else(|| words::fault_remedy(&first.fault, session), |remedy| words::remedy_label(remedy, session));
        // Beside a single finding, its remedy has just been said.
        if findings.len() > 1 || step != words::fault_remedy(&first.fault, session) {
            writeln!(out, "  {}", words::next_step_line(&step)).ok();
        }
    }
}

fn figures(session: &Session, solution: &Solution, examination: &Examination<'_>) -> Vec<String> {
    let validation = examination.diagnosis.validation.as_ref();
    let most_influential = validation.and_then(|validation| {
        let moves = |idx: usize| validation.influence[idx].moves_workspace_point_mm;
        (0..validation.influence.len())
            .max_by(|a, b| moves(*a).total_cmp(&moves(*b)))
            .map(|idx| &validation.influence[idx])
    });
    [
        validation.and_then(|validation| validation.split_half.as_ref()).map(words::split_half_line),
        validation.and_then(|validation| validation.normality.as_ref()).map(words::normality_line),
        most_influential.map(words::influence_line),
        examination.bootstrap.map(words::bootstrap_line),
        solution.uncertainty.as_ref().map(|uncertainty| words::accuracy_line(uncertainty, solution.mount)),
        Method::BALL.contains(&solution.method).then(|| words::radius_line(solution)),
        solution.radius.as_ref().map(words::estimated_radius_line),
        solution.noise.as_ref().map(|noise| words::noise_line(noise, &session.robot)),
    ]
    .into_iter()
    .flatten()
    .collect()
}

fn next_pose(session: &Session, plan: &Plan) -> Option<String> {
    let station = plan.stations.first()?;
    let convention = session.robot.notation.convention;
    let named = |names: [&str; 3], values: [f64; 3], unit: &str| {
        let parts: Vec<String> =
            names.iter().zip(values).map(|(name, value)| format!("{name} {}", fixed(value, 2))).collect();
        format!("{}{unit}", parts.join(" "))
    };
    let position = named(["x", "y", "z"], station.base_from_flange.translation_mm().into(), " mm");
    let angles = convention.angles_deg_from_rotation(&station.base_from_flange.rotation());
    let angles = named(convention.angle_names, angles, "°");
    let (before_mm, after_mm) = (plan.workspace_point_std_mm, station.workspace_point_std_mm);
    Some(words::next_pose_line(station.edge, &position, &angles, before_mm, after_mm))
}
