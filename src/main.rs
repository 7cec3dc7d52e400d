//! The program: arguments, then the window or a command.

use std::process::ExitCode;

use clap::Parser as _;
use handeye::cli::{self, Args};
use handeye::ui;

fn main() -> ExitCode {
    let args = match Args::try_parse() {
        Ok(args) => args,
        Err(error) => return cli::usage_error(&error),
    };
    match args.command {
        Some(command) => command.run(),
        None => match ui::run(ui::Start { file: args.file, ..ui::Start::default() }) {
            Ok(()) => ExitCode::SUCCESS,
            Err(error) => cli::fail(cli::EXIT_WRONG_INPUT, &error),
        },
    }
}
