//! `handeye history`: the calibrations of a folder over time.

use std::io::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;

use crate::report::digits::signed;
use crate::report::result_history::file::{history_csv, history_file};
use crate::report::result_history::{History, Order, read_history};
use crate::text::compare_results as words;
use crate::verify::drift::Trend;
use crate::watch::Unwatched;

use super::compare::refuse;

/// Arguments of `handeye history`.
#[derive(Clone, Debug, clap::Args)]
pub struct HistoryArgs {
    /// The folder with result files, matrices and sessions
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
    /// Print the history as JSON
    #[arg(long, conflicts_with = "csv")]
    pub json: bool,
    /// Print the table as CSV
    #[arg(long)]
    pub csv: bool,
}

/// Runs the command.
#[must_use]
pub fn run(args: &HistoryArgs) -> ExitCode {
    match read_history(&args.folder, &mut Unwatched) {
        Ok(history) => {
            if args.csv {
                // A table has no place for them; with nowhere to tell them, the table must do.
                for reason in &history.left_out {
                    write!(std::io::stderr(), "{}", words::left_out_line(reason)).ok();
                }
            }
            let text = match (args.json, args.csv) {
                (true, _) => format!("{:#}\n", history_file(&history)),
                (_, true) => history_csv(&history),
                _ => table(&history),
            };
            super::print(&text).map_or_else(|exit_code| exit_code, |()| ExitCode::SUCCESS)
        }
        Err(refusal) => refuse(&refusal),
    }
}

fn table(history: &History) -> String {
    let is_by_dates = history.order == Order::Dates;
    let drift = &history.drift;
    let mut rows = vec![words::HISTORY_COLUMNS.map(str::to_owned)];
    for (idx, (calibration, change)) in history.calibrations.iter().zip(&drift.from_first).enumerate() {
        let moved = change.difference.translation_mm;
        let previous = idx.checked_sub(1).and_then(|previous| drift.from_previous.get(previous));
        let from_previous =
            previous.map_or_else(|| "-".to_owned(), |step| format!("{:.4}", step.shift.shift_mm.norm()));
        let mark = if drift.jumps.contains(&idx) { " jump" } else { "" };
        rows.push([
            calibration.name.clone(),
            calibration.date().unwrap_or_else(|| "-".to_owned()),
            signed(moved.x, 4),
            signed(moved.y, 4),
            signed(moved.z, 4),
            format!("{:.5}", change.difference.angle_rad().to_degrees()),
            format!("{:.4}", change.shift.shift_mm.norm()),
            from_previous + mark,
        ]);
    }
    let widths: [usize; 8] =
        std::array::from_fn(|column| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or_default());
    let mut said = words::history_head(history.calibrations.len(), is_by_dates);
    said.push('\n');
    for row in rows {
        let cells: Vec<String> = row
            .iter()
            .zip(widths)
            .enumerate()
            .map(
                |(column, (cell, width))| {
                    if column < 2 { format!("{cell:<width$}") } else { format!("{cell:>width$}") }
                },
            )
            .collect();
        said.push_str(cells.join("  ").trim_end());
        said.push('\n');
    }
    said.push('\n');
    for jump in &drift.jumps {
        let (Some(step), Some(previous)) = (drift.from_previous.get(jump - 1), history.calibrations.get(jump - 1))
        else {
            continue;
        };
        let moved_mm = step.shift.shift_mm.norm();
        said.push_str(&words::jump_line(
            &history.calibrations[*jump].name,
            &previous.name,
            moved_mm,
            step.shift.p_value,
        ));
    }
    if drift.jumps.is_empty() {
        said.push_str(words::NO_JUMP);
    }
    for (idx, (axis, trend)) in words::TREND_AXES.iter().zip(&drift.trends).enumerate() {
        let in_unit = |value: f64| if idx < 3 { value } else { value.to_degrees() };
        let shown = Trend { slope: in_unit(trend.slope), std: in_unit(trend.std), ..*trend };
        said.push_str(&words::trend_line(axis, &shown, is_by_dates));
    }
    if drift.trends.is_empty() {
        said.push_str(&words::no_trend_line(history.calibrations.len()));
    }
    for reason in &history.left_out {
        said.push_str(&words::left_out_line(reason));
    }
    said
}
