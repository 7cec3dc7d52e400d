//! `handeye report`: part of the command line's contract, not available in this version. It says so and what to use.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;

use super::{EXIT_NOTHING_COMPUTED, fail};

/// Arguments of `handeye report`.
#[derive(Debug, Args)]
pub struct ReportArgs {
    /// Session file
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// Folder to write the report into
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
}

/// Runs the command: refuses, and names what there is instead.
#[must_use]
pub fn run(args: &ReportArgs) -> ExitCode {
    fail(
        EXIT_NOTHING_COMPUTED,
        &format_args!(
            "reports are not available in this version; `handeye solve {0}` prints tables, with --json the result file",
            args.file.display()
        ),
    )
}
