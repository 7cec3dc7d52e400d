//! The methods side by side: their errors, their differences, and a table each in the layout of the paper's.

use crate::calibrate::motion::ClosedFormAnswer;
use crate::calibrate::{MethodResult, Solution};
use crate::report::compare::{distance_from_truth, maximum_error_mm};
use crate::report::comparison::{Comparison, DifferenceRow};
use crate::report::document::{Block, Cell, Column, Table};
use crate::report::evidence::{Evidence, TargetEvidence};
use crate::session::Target;
use crate::text::compare::pair;
use crate::text::digits::decimals_for;
use crate::text::report as words;
use crate::text::{closed_form_name, method_name, method_short_name};

use super::{of_each_target, paper_table};

/// Micrometres, as the papers print errors.
const ERROR_DECIMALS: usize = 3;

pub(in crate::report::document) fn blocks(evidence: &Evidence) -> Vec<Block> {
    of_each_target(evidence, of_target)
}

fn of_target(target: &TargetEvidence, suffix: &str) -> Vec<Block> {
    let comparison = Comparison::new(&target.session, target.results());
    let mut blocks = vec![Block::Table(overview(target, suffix))];
    let failed = target.results().iter().filter_map(|result| Some((result.method, result.outcome.as_ref().err()?)));
    blocks.extend(failed.map(|(method, error)| Block::Paragraph(words::not_computed(method, &error.to_string()))));
    if !comparison.differences.is_empty() {
        blocks.push(Block::Table(differences(&comparison.differences, suffix)));
    }
    // A way has no poses of stations that the paper's table could list.
    let has_stations = !matches!(target.session.target, Target::Rgbd { .. });
    for column in comparison.columns.iter().filter(|_| has_stations) {
        if let Ok(table) = &column.outcome {
            blocks.push(Block::Table(paper_table::of_method(column.method, table, suffix)));
        }
    }
    let motion = target.best().and_then(|best| best.motion.as_ref());
    blocks.extend(motion.map(|motion| Block::Table(closed_forms(&motion.closed_forms, suffix))));
    blocks.extend(comparison.published.as_ref().map(|published| Block::Table(paper_table::published(published))));
    blocks
}

fn overview(target: &TargetEvidence, suffix: &str) -> Table {
    let truth = target.session.truth.as_ref();
    // Off an edge there are only two directions.
    let rms = if target.session.target == Target::RightAnglePlate { words::RMS } else { words::RMS_3D };
    let mut columns = vec![
        Column::words(words::METHOD_COLUMN, "method"),
        Column::number(words::maximum_in_sample(&target.session.target), None, "maximum_error_mm")
            .under(words::IN_SAMPLE_GROUP),
        Column::number(rms, None, "scatter_rms_mm").under(words::IN_SAMPLE_GROUP),
        Column::number(rms, None, "leave_one_out_rms_mm").under(words::LEFT_OUT_GROUP),
        Column::number(words::STD_POINT, Some("mm"), "workspace_point_std_mm"),
    ];
    if truth.is_some() {
        columns.push(Column::number(words::POINT, Some("mm"), "from_truth_mm").under(words::FROM_TRUTH));
        columns.push(Column::number(words::ROTATION, Some("°"), "from_truth_deg").under(words::FROM_TRUTH));
    }
    let best = target.best().map(|best| best.method);
    let row = |result: &MethodResult| {
        let name = Cell::words(method_name(result.method));
        let name = if best == Some(result.method) { name.strong() } else { name };
        let Ok(solution) = &result.outcome else {
            return std::iter::once(name).chain((1..columns.len()).map(|_| Cell::missing())).collect();
        };
        let known = solution.uncertainty.as_ref();
        let mut row = vec![
            name,
            Cell::number(maximum_error_mm(solution), ERROR_DECIMALS),
            Cell::number(solution.scatter.rms_mm, ERROR_DECIMALS),
            Cell::maybe(solution.leave_one_out.map(|left_out| left_out.rms_mm), ERROR_DECIMALS),
            Cell::maybe(known.map(|known| known.workspace_point_std_mm), ERROR_DECIMALS),
        ];
        row.extend(truth.into_iter().flat_map(|truth| from_truth(solution, truth)));
        row
    };
    Table {
        id: format!("methods{suffix}"),
        title: words::OVERVIEW.to_owned(),
        rows: target.results().iter().map(row).collect(),
        note: Some(words::errors_legend(&target.session.target).join(" · ")),
        columns,
    }
}

fn from_truth(solution: &Solution, truth: &crate::session::Truth) -> [Cell; 2] {
    let distance = distance_from_truth(solution, truth);
    let known = solution.uncertainty.as_ref();
    let rotation_std_deg = known.map(|known| known.rotation_covariance().trace().max(0.0).sqrt().to_degrees());
    // What an error is worth saying of, the uncertainty says.
    [
        Cell::number(distance.workspace_point_mm, decimals_for(known.map(|known| known.workspace_point_std_mm))),
        Cell::number(distance.rotation_rad.to_degrees(), decimals_for(rotation_std_deg)),
    ]
}

fn differences(rows: &[DifferenceRow], suffix: &str) -> Table {
    let translation = ["Δx", "Δy", "Δz"].into_iter().zip(["x", "y", "z"]);
    let translation =
        translation.map(|(title, axis)| Column::number(title, Some("mm"), format!("difference_{axis}_mm")));
    let row = |row: &DifferenceRow| {
        let difference = &row.difference;
        let names = pair(method_short_name(row.first), method_short_name(row.second));
        let mut cells = vec![Cell::words(names)];
        cells.extend(difference.translation_mm.iter().map(|value| Cell::signed(*value, ERROR_DECIMALS)));
        cells.push(Cell::number(difference.rotation_rad.to_degrees(), 4));
        cells.push(Cell::number(difference.workspace_point_mm, ERROR_DECIMALS));
        cells.push(Cell::maybe(difference.in_stds, 1));
        cells
    };
    Table {
        id: format!("differences{suffix}"),
        title: words::DIFFERENCES.to_owned(),
        columns: std::iter::once(Column::words(words::PAIR, "methods"))
            .chain(translation)
            .chain([
                Column::number(words::ROTATION, Some("°"), "rotation_deg"),
                Column::number(words::AT_POINT, Some("mm"), "workspace_point_mm"),
                Column::number(words::IN_STDS, None, "in_std"),
            ])
            .collect(),
        rows: rows.iter().map(row).collect(),
        note: Some(words::DIFFERENCES_NOTE.to_owned()),
    }
}

/// What the published closed forms make of the same motions.
fn closed_forms(answers: &[ClosedFormAnswer], suffix: &str) -> Table {
    let row = |answered: &ClosedFormAnswer| {
        let answer = answered.answer.as_ref();
        vec![
            Cell::words(closed_form_name(answered.form)),
            Cell::maybe(answer.map(|answer| answer.off_mm), ERROR_DECIMALS),
            Cell::maybe(answer.map(|answer| answer.off_rad.to_degrees()), 4),
            Cell::maybe(answer.map(|answer| answer.residual_mm), ERROR_DECIMALS),
            Cell::maybe(answer.map(|answer| answer.residual_rad.to_degrees()), 4),
        ]
    };
    Table {
        id: format!("closed-forms{suffix}"),
        title: words::CLOSED_FORMS.to_owned(),
        columns: vec![
            Column::words(words::CLOSED_FORM, "closed_form"),
            Column::number(words::TRANSLATION, Some("mm"), "off_mm").under(words::FROM_REFINED),
            Column::number(words::ROTATION, Some("°"), "off_deg").under(words::FROM_REFINED),
            Column::number(words::TRANSLATION, Some("mm"), "residual_mm").under(words::LEFT_OVER),
            Column::number(words::ROTATION, Some("°"), "residual_deg").under(words::LEFT_OVER),
        ],
        rows: answers.iter().map(row).collect(),
        note: Some(words::CLOSED_FORMS_NOTE.to_owned()),
    }
}
