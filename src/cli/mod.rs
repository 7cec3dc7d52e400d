//! The commands without a window: each takes its arguments and answers with the exit status of the contract.

use std::process::ExitCode;

pub mod check;
pub mod simulate;

/// The input is wrong: a file that is no session, an option out of range.
const WRONG_INPUT: u8 = 2;

/// Says on standard error, in one line, what is wrong with the input.
fn refuse_input(problem: &dyn std::fmt::Display) -> ExitCode {
    eprintln!("handeye: {problem}");
    ExitCode::from(WRONG_INPUT)
}
