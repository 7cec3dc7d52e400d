//! What is wrong with the session, with its remedies.

use crate::diagnose::Severity;
use crate::report::diagnosis_lines::{Listed, listed, next_step};
use crate::report::document::{Block, Fact, Finding, typeset_numbers};
use crate::report::evidence::{Evidence, TargetEvidence};
use crate::text::diagnosis as text;
use crate::text::report as words;
use crate::text::shell::more_of_a_kind;

use super::of_each_target;

pub(in crate::report::document) fn blocks(evidence: &Evidence) -> Vec<Block> {
    of_each_target(evidence, |target, _| of_target(target))
}

fn of_target(target: &TargetEvidence) -> Vec<Block> {
    let Some(diagnosis) = target.diagnosis() else { return Vec::new() };
    if diagnosis.findings.is_empty() {
        return vec![Block::Paragraph(words::NOTHING_FOUND.to_owned())];
    }
    let entry = |listed: &Listed<'_>| match listed {
        Listed::More(count, code) => Finding {
            severity: Severity::Note,
            code: (*code).to_owned(),
            message: more_of_a_kind(*count, code),
            remedy: String::new(),
        },
        Listed::Finding(finding) => {
            let falls = finding.evidence.residual_mm.map(text::residual_falls).unwrap_or_default();
            let message = text::fault_message(&finding.fault, &target.session);
            Finding {
                severity: finding.severity,
                code: finding.fault.code().to_owned(),
                message: typeset_numbers(format!("{message} {falls}").trim_end()),
                remedy: typeset_numbers(&text::fault_remedy(&finding.fault, &target.session)),
            }
        }
    };
    let findings = listed(diagnosis).iter().map(entry).collect();
    let step = next_step(&target.session, diagnosis)
        .map(|step| Block::Facts(vec![Fact::new(words::NEXT_STEP, typeset_numbers(&step))]));
    std::iter::once(Block::Findings(findings)).chain(step).collect()
}
