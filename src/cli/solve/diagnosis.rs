//! The section that `solve` prints after its tables: what is wrong, how far the result can be relied on, where to measure
//! next.

use std::fmt::Write as _;

use crate::calibrate::verdict::judge;
use crate::calibrate::{MethodResult, Verdict, best_available};
use crate::plan::Plan;
use crate::report::diagnosis_lines::{Listed, accuracy_lines, listed, next_step};
use crate::report::digits::fixed;
use crate::report::result_file::Examination;
use crate::session::Session;
use crate::text::cli::nothing_wrong_but_poorly_known;
use crate::text::diagnosis as words;
use crate::text::shell::more_of_a_kind;

/// The section, headed "Diagnosis". Writing to a string does not fail, hence the `ok()`s.
pub fn section(session: &Session, results: &[MethodResult], examination: &Examination<'_>) -> String {
    let mut out = format!("\n{}\n", words::HEADING);
    let solution = best_available(results);
    let is_good = solution.is_none_or(|solution| judge(solution).0 == Verdict::Good);
    findings(&mut out, session, examination, is_good);
    let lines = solution.into_iter().flat_map(|solution| accuracy_lines(session, solution, examination));
    for line in lines.chain(examination.plan.and_then(|plan| next_pose(session, plan))) {
        writeln!(out, "  {line}").ok();
    }
    out
}

fn findings(out: &mut String, session: &Session, examination: &Examination<'_>, is_good: bool) {
    let findings = &examination.diagnosis.findings;
    if findings.is_empty() {
        let has_next_pose = examination.plan.is_some_and(|plan| !plan.stations.is_empty());
        let sentence =
            if is_good { words::NOTHING_FOUND } else { nothing_wrong_but_poorly_known(&session.target, has_next_pose) };
        writeln!(out, "  {sentence}").ok();
    }
    for listed in listed(examination.diagnosis) {
        let finding = match listed {
            Listed::Finding(finding) => finding,
            Listed::More(count, code) => {
                writeln!(out, "    {}", more_of_a_kind(count, code)).ok();
                continue;
            }
        };
        let message = words::fault_message(&finding.fault, session);
        let remedy = words::fault_remedy(&finding.fault, session);
        let mark = words::severity_mark(finding.severity);
        write!(out, "  {mark} [{}] {message} {remedy}", finding.fault.code()).ok();
        if let Some(residual_mm) = finding.evidence.residual_mm {
            write!(out, " {}", words::residual_falls(residual_mm)).ok();
        }
        out.push('\n');
    }
    if let Some((first, step)) = findings.first().zip(next_step(session, examination.diagnosis)) {
        // Beside a single finding, its remedy has just been said.
        if findings.len() > 1 || step != words::fault_remedy(&first.fault, session) {
            writeln!(out, "  {}", words::next_step_line(&step)).ok();
        }
    }
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
