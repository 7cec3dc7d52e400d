//! The commands without a window: one file a command.
//!
//! Exit status: 0 done, 2 the input is wrong (one line on standard error), 3 nothing could be computed.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Parser, Subcommand};

pub mod check;
pub mod report;
pub mod screenshot;
pub mod simulate;
pub mod solve;

/// The input is wrong.
pub const EXIT_WRONG_INPUT: u8 = 2;
/// Nothing could be computed.
pub const EXIT_NOTHING_COMPUTED: u8 = 3;

/// Workbench for the hand-eye calibration of robot-mounted laser profilers.
///
/// Without a command the window opens, on the start page or on FILE.
#[derive(Debug, Parser)]
#[command(name = "handeye", version, args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub struct Args {
    /// Session file to open in the window.
    #[arg(value_name = "FILE")]
    pub file: Option<PathBuf>,
    /// What to do instead of opening the window.
    #[command(subcommand)]
    pub command: Option<Command>,
}

/// The commands without a window.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Runs the calibration methods on a session file
    Solve(solve::SolveArgs),
    /// Validates a session file and lists what is odd about it
    Check(check::CheckArgs),
    /// Writes a simulated session with its truth
    Simulate(simulate::SimulateArgs),
    /// Not available in this version: says what to use instead
    Report(report::ReportArgs),
    /// Draws a step of the window into a PNG file, without a display
    Screenshot(screenshot::ScreenshotArgs),
}

impl Command {
    /// Carries the command out.
    #[must_use]
    pub fn run(&self) -> ExitCode {
        match self {
            Self::Solve(args) => solve::run(args),
            Self::Check(args) => check::run(args),
            Self::Simulate(args) => simulate::run(args),
            Self::Report(args) => report::run(args),
            Self::Screenshot(args) => screenshot::run(args),
        }
    }
}

/// Prints the one line that goes with a failure.
pub fn fail(exit_code: u8, message: &dyn std::fmt::Display) -> ExitCode {
    eprintln!("handeye: {message}");
    ExitCode::from(exit_code)
}
