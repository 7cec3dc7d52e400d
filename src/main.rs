//! The program: arguments, then the window or a command.

use std::process::ExitCode;

use clap::Parser as _;
use handeye::cli::Args;

fn main() -> ExitCode {
    match Args::parse().command {
        Some(command) => command.run(),
        None => ExitCode::SUCCESS,
    }
}
