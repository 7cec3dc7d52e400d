//! `handeye history`: the calibrations of a folder over time.

use std::io::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;

use crate::report::result_history::file::{history_csv, history_file};
use crate::report::result_history::read_history;
use crate::report::result_history::said::history_text;
use crate::text::compare_results as words;
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
                    writeln!(std::io::stderr(), "{}", words::left_out_line(reason)).ok();
                }
            }
            let text = match (args.json, args.csv) {
                (true, _) => format!("{:#}\n", history_file(&history)),
                (_, true) => history_csv(&history),
                _ => history_text(&history),
            };
            super::print(&text).map_or_else(|exit_code| exit_code, |()| ExitCode::SUCCESS)
        }
        Err(refusal) => refuse(&refusal),
    }
}
