//! Good, usable, or not usable, with the reason beside it and the headline figure.

use crate::calibrate::verdict::{GOOD_UP_TO_MM, USABLE_UP_TO_MM};
use crate::calibrate::{self, Solution};
use crate::diagnose::Severity;
use crate::report::compare::improvement;
use crate::report::document::{Block, Cell, Column, Fact, Finding, Table, Verdict, typeset, typeset_numbers};
use crate::report::evidence::{Evidence, TargetEvidence};
use crate::report::judgement::Judgement;
use crate::text::compare::verdict_scale;
use crate::text::digits::{self, fixed, signed};
use crate::text::report as words;
use crate::text::{start, verdict_mark, verdict_name};

pub(in crate::report::document) fn blocks(evidence: &Evidence) -> Vec<Block> {
    let Some((target, solution)) = evidence.answer() else { return vec![Block::Verdict(nothing(evidence))] };
    let judgement = Judgement::on(&target.session, solution, target.diagnosis());
    let reason = match judgement.lowered {
        Some((by_figures, code)) => words::lowered(by_figures, judgement.verdict, code, &judgement.reason),
        None => judgement.reason.clone(),
    };
    let verdict = Verdict {
        rating: Some(judgement.verdict),
        name: verdict_name(judgement.verdict).to_owned(),
        mark: verdict_mark(judgement.verdict),
        reason: typeset_numbers(&reason),
        headline: judgement.workspace_point.map(|point| format!("± {} mm", std_text(point.std_mm))),
        headline_note: solution.uncertainty.as_ref().zip(judgement.workspace_point).map(|(known, point)| {
            let within_95_mm = std_text(known.workspace_point_95_mm);
            words::headline_note(&typeset(&digits::plain(point.z_mm, 1)), point.is_stated, &within_95_mm)
        }),
    };
    let mut blocks = vec![Block::Verdict(verdict), Block::Facts(facts(evidence, target, solution))];
    if evidence.targets.iter().filter(|target| target.outcome.is_ok()).count() > 1 {
        blocks.push(Block::Table(targets(evidence)));
    }
    if !judgement.warnings.is_empty() {
        blocks.push(Block::Heading(words::WARNINGS.to_owned()));
        let codes = solution.warnings.iter().map(|warning| warning.code().to_owned());
        let warnings = judgement.warnings.iter().zip(codes).map(|((message, remedy), code)| Finding {
            severity: Severity::Doubtful,
            code,
            message: typeset_numbers(message),
            remedy: (*remedy).to_owned(),
        });
        blocks.push(Block::Findings(warnings.collect()));
    }
    blocks
}

/// Nothing could be computed: the report says why.
fn nothing(evidence: &Evidence) -> Verdict {
    let has_parts = evidence.parts.iter().any(|part| part.outcome.is_ok());
    let mut reason = evidence.refusal().unwrap_or_default();
    if has_parts {
        reason = format!("{} {}", sentence(&reason), words::PART_MEASURED);
    }
    Verdict {
        // Where a part was to be measured, no calibration is no failure.
        rating: (!has_parts).then_some(calibrate::Verdict::NotUsable),
        name: words::NO_CALIBRATION.to_owned(),
        mark: if has_parts { words::NO_VERDICT_MARK } else { verdict_mark(calibrate::Verdict::NotUsable) },
        reason: sentence(&reason),
        headline: None,
        headline_note: None,
    }
}

fn sentence(words: &str) -> String {
    let mut letters = words.trim().trim_end_matches('.').chars();
    let first = letters.next().map(|first| first.to_uppercase().to_string()).unwrap_or_default();
    format!("{first}{}.", letters.as_str())
}

fn facts(evidence: &Evidence, target: &TargetEvidence, solution: &Solution) -> Vec<Fact> {
    let mut facts = vec![Fact::new(words::METHOD, words::method_and_id(solution.method))];
    if evidence.targets.len() > 1 {
        facts.push(Fact::new(
            words::TARGET_FACT,
            format!("{} ({})", target.name, start::target(&target.session.target)),
        ));
    }
    if let Some((improvement, percent)) =
        improvement(target.results()).and_then(|found| Some((found, found.percent()?)))
    {
        let line = words::improvement_line(
            improvement.method,
            &fixed(improvement.error_mm, 3),
            &typeset(&signed(percent, 0)),
            improvement.baseline,
            &fixed(improvement.baseline_error_mm, 3),
        );
        facts.push(Fact::new(words::COMPARED, line));
    }
    let scale = format!("{} {}", verdict_scale(GOOD_UP_TO_MM, USABLE_UP_TO_MM), words::SCALE_NOTE);
    facts.push(Fact::new(words::SCALE, scale));
    facts
}

/// One row a target: what it is, and what its own data give.
fn targets(evidence: &Evidence) -> Table {
    let columns = vec![
        Column::words(words::TARGET, "target"),
        Column::words(words::KIND, "kind"),
        Column::words(words::METHOD_COLUMN, "method"),
        Column::words(words::RESULT, "verdict"),
        Column::number(words::STD_POINT, Some("mm"), "workspace_point_std_mm"),
    ];
    let row = |target: &TargetEvidence| {
        let judged = target.best().map(|best| (best, Judgement::on(&target.session, best, target.diagnosis())));
        let std_mm =
            judged.as_ref().and_then(|(best, _)| best.uncertainty.as_ref()).map(|known| known.workspace_point_std_mm);
        let word = |word: Option<String>| word.map_or_else(Cell::missing, Cell::words);
        vec![
            Cell::words(&target.name),
            Cell::words(start::target(&target.session.target)),
            word(judged.as_ref().map(|(best, _)| crate::text::method_name(best.method).to_owned())),
            word(
                judged
                    .as_ref()
                    .map(|(_, judged)| format!("{} {}", verdict_mark(judged.verdict), verdict_name(judged.verdict))),
            ),
            std_mm.map_or_else(Cell::missing, Cell::size),
        ]
    };
    Table {
        id: "targets".to_owned(),
        title: words::TARGETS.to_owned(),
        columns,
        rows: evidence.targets.iter().filter(|target| target.outcome.is_ok()).map(row).collect(),
        note: None,
    }
}

/// A standard deviation with two digits.
fn std_text(std: f64) -> String {
    digits::value(std, Some(std))
}
