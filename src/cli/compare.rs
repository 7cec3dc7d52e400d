//! `handeye compare`: how far two calibrations are apart, and whether chance explains it.

use std::path::PathBuf;
use std::process::ExitCode;

use crate::geometry::Vec3;
use crate::report::result_history::file::comparison_file;
use crate::report::result_history::said::comparison_text;
use crate::report::result_history::{self, NotCompared, read_compared};
use crate::text::compare_results as words;
use crate::watch::Unwatched;

use super::{EXIT_NOTHING_COMPUTED, EXIT_WRONG_INPUT, fail};

/// Arguments of `handeye compare`.
#[derive(Clone, Debug, clap::Args)]
pub struct CompareArgs {
    /// The calibration to compare with: a result file, a matrix, or a session, which is solved
    #[arg(value_name = "A")]
    pub first: PathBuf,
    /// The calibration that is compared
    #[arg(value_name = "B")]
    pub second: PathBuf,
    /// Compare at this point too, in the sensor frame, mm; may be given several times
    #[arg(long = "at", value_name = "x,y,z", value_parser = point, allow_hyphen_values = true)]
    pub points: Vec<Vec3>,
    /// Print the comparison (JSON) instead of sentences
    #[arg(long)]
    pub json: bool,
}

fn point(text: &str) -> Result<Vec3, String> {
    result_history::point_in(text).ok_or_else(|| words::not_a_point(text))
}

/// Runs the command.
#[must_use]
pub fn run(args: &CompareArgs) -> ExitCode {
    match compared(args) {
        Ok(text) => super::print(&text).map_or_else(|exit_code| exit_code, |()| ExitCode::SUCCESS),
        Err(refusal) => refuse(&refusal),
    }
}

/// Ends with the status that goes with a refusal.
pub(super) fn refuse(refusal: &NotCompared) -> ExitCode {
    let status = match refusal {
        NotCompared::Wrong(_) => EXIT_WRONG_INPUT,
        NotCompared::NothingComputed(_) => EXIT_NOTHING_COMPUTED,
    };
    fail(status, &refusal.reason())
}

fn compared(args: &CompareArgs) -> Result<String, NotCompared> {
    let first = read_compared(&args.first, &mut Unwatched)?;
    let second = read_compared(&args.second, &mut Unwatched)?;
    let comparison = result_history::compared(first, second, &args.points)?;
    Ok(if args.json { format!("{:#}\n", comparison_file(&comparison)) } else { comparison_text(&comparison) })
}
