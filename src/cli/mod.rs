//! The commands without a window: one file a command.
//!
//! Exit status: 0 done, 2 the input is wrong (one line on standard error), 3 nothing could be computed.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Parser, Subcommand};

pub mod cell;
pub mod check;
pub mod compare;
pub mod export;
pub mod history;
pub mod import;
pub mod odometry;
pub mod plan;
mod progress;
pub mod report;
pub mod scan;
pub mod screenshot;
pub mod simulate;
pub mod solve;
pub mod tool_frame;
pub mod verify;

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
    /// Says what calibrations are worth on other data: distances, stability, other targets
    Verify(verify::VerifyArgs),
    /// Validates a session file and lists what is odd about it
    Check(check::CheckArgs),
    /// Imports poses and profiles (tables, robot programs, papers, folders) into a session file
    Import(Box<import::ImportArgs>),
    /// Exports the poses and profiles of a session file as CSV
    Export(export::ExportArgs),
    /// Writes a calibration as the tool frame of a controller, for ROS, or as a matrix
    ToolFrame(tool_frame::ToolFrameArgs),
    /// Measures planes, teeth and diameters of a scanned part, and exports its points
    Scan(Box<scan::ScanArgs>),
    /// Compares two calibrations: in the flange, at points, and with their σ
    Compare(compare::CompareArgs),
    /// Lists the calibrations of a folder over time: drift and jumps
    History(history::HistoryArgs),
    /// Finds the motion of an RGB-D camera from a recorded sequence: trajectory, distance, heading
    Odometry(odometry::OdometryArgs),
    /// Plans the stations to measure next
    Plan(plan::PlanArgs),
    /// Writes a simulated session with its truth
    Simulate(Box<simulate::SimulateArgs>),
    /// Serves a simulated cell on loopback with the real wire protocols, until stopped
    Cell(cell::CellArgs),
    /// Writes a report to read, print and sign: a page, tables, the result file, texts for the controller
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
            Self::Verify(args) => verify::run(args),
            Self::Check(args) => check::run(args),
            Self::Import(args) => import::run(args),
            Self::Export(args) => export::run(args),
            Self::ToolFrame(args) => tool_frame::run(args),
            Self::Scan(args) => scan::run(args),
            Self::Compare(args) => compare::run(args),
            Self::History(args) => history::run(args),
            Self::Odometry(args) => odometry::run(args),
            Self::Plan(args) => plan::run(args),
            Self::Simulate(args) => simulate::run(args),
            Self::Cell(args) => cell::run(args),
            Self::Report(args) => report::run(args),
            Self::Screenshot(args) => screenshot::run(args),
        }
    }
}

/// Prints a line beside what a command has to say.
pub(crate) fn remark(message: &dyn std::fmt::Display) {
    // With nowhere to say it, the result is still one.
    writeln!(std::io::stderr(), "handeye: {message}").ok();
}

/// The folder that a file is in: what it names lies there.
fn folder_of(file: &Path) -> &Path {
    file.parent().unwrap_or(Path::new(""))
}

/// Prints the one line that goes with a failure.
pub fn fail(exit_code: u8, message: &dyn std::fmt::Display) -> ExitCode {
    // With nowhere to complain to, the exit status must do.
    remark(message);
    ExitCode::from(exit_code)
}

/// Prints what a command has to say. A reader that has seen enough (`| head`) is no failure.
pub(crate) fn print(text: &str) -> Result<(), ExitCode> {
    match std::io::stdout().write_all(text.as_bytes()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(fail(EXIT_NOTHING_COMPUTED, &format_args!("the output could not be written: {error}")))
        }
        _ => Ok(()),
    }
}

/// Help and version as asked for; a wrong argument in one line, as every other refusal.
#[must_use]
pub fn usage_error(error: &clap::Error) -> ExitCode {
    if !error.use_stderr() {
        return match print(&error.render().to_string()) {
            Ok(()) => ExitCode::SUCCESS,
            Err(exit_code) => exit_code,
        };
    }
    let text = error.render().to_string();
    let lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
    let said: Vec<&str> = lines.take_while(|line| !line.starts_with("Usage:")).collect();
    let message = said.join(" ");
    let message =
        message.trim_start_matches("error: ").trim_end_matches("For more information, try '--help'.").trim_end();
    // The usage line names the command that was meant.
    let usage = text.lines().find_map(|line| line.trim().strip_prefix("Usage: handeye "));
    let command = usage.and_then(|usage| usage.split_whitespace().next());
    let command =
        command.filter(|word| word.chars().all(|c| c.is_ascii_lowercase() || c == '-') && !word.starts_with('-'));
    let command = command.map(|command| format!("{command} ")).unwrap_or_default();
    fail(EXIT_WRONG_INPUT, &format_args!("{message} (see `handeye {command}--help`)"))
}
