//! `handeye solve`: every method that the session's data allows, as a table or as the result file.

use std::fmt::Write as _;
use std::io::IsTerminal as _;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};

use crate::calibrate::{Method, MethodResult, solve_all};
use crate::report::result_file::result_file;
use crate::session::{self, ball_problem, measure};
use crate::watch::{Cancelled, Watch};

use super::{EXIT_NOTHING_COMPUTED, EXIT_WRONG_INPUT, fail};

mod paper_tables;
mod tables;

/// Arguments of `handeye solve`.
#[derive(Debug, Args)]
pub struct SolveArgs {
    /// Session file
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// Run only this method; may be given several times
    #[arg(long = "method", value_name = "ID", value_parser = method_parser())]
    pub methods: Vec<Method>,
    /// Print the result file (JSON) instead of tables
    #[arg(long)]
    pub json: bool,
    /// Print tables in the layout of Lin & Mu's Tables 1 and 2
    #[arg(long, conflicts_with = "json")]
    pub paper_tables: bool,
}

fn method_parser() -> impl TypedValueParser<Value = Method> {
    PossibleValuesParser::new(Method::ALL.map(Method::id))
        .try_map(|id| Method::by_id(&id).ok_or_else(|| format!("no method is called {id}")))
}

/// Shows progress on a terminal and nowhere else.
struct TerminalProgress {
    what: &'static str,
    is_terminal: bool,
    shown: bool,
}

impl TerminalProgress {
    fn new(what: &'static str) -> Self {
        Self { what, is_terminal: std::io::stderr().is_terminal(), shown: false }
    }

    fn clear(&mut self) {
        if self.shown {
            eprint!("\r\x1b[K");
            self.shown = false;
        }
    }
}

impl Watch for TerminalProgress {
    fn report(&mut self, done: usize, total: usize) -> Result<(), Cancelled> {
        if self.is_terminal {
            eprint!("\r{} {done}/{total}\x1b[K", self.what);
            self.shown = true;
        }
        Ok(())
    }
}

/// Runs the command.
#[must_use]
pub fn run(args: &SolveArgs) -> ExitCode {
    let session = match session::load(&args.file) {
        Ok(session) => session,
        Err(error) => return fail(EXIT_WRONG_INPUT, &error),
    };
    let methods: Vec<Method> = if args.methods.is_empty() { Method::ALL.to_vec() } else { args.methods.clone() };
    let mut progress = TerminalProgress::new("reading profiles");
    let measured = measure(&session, None, &mut progress);
    progress.clear();
    let Ok(measured) = measured else {
        return fail(EXIT_NOTHING_COMPUTED, &Cancelled);
    };
    let problem = match ball_problem(&session, &measured) {
        Ok(problem) => problem,
        Err(refusal) => return fail(EXIT_NOTHING_COMPUTED, &refusal),
    };
    let mut progress = TerminalProgress::new("solving");
    let results = solve_all(&problem, &methods, &mut progress);
    progress.clear();
    let Ok(results) = results else {
        return fail(EXIT_NOTHING_COMPUTED, &Cancelled);
    };
    let text = if args.json {
        format!("{:#}\n", result_file(&session, &results))
    } else if args.paper_tables {
        paper_tables::paper_tables(&session, &results)
    } else {
        tables::tables(&session, &problem, &results)
    };
    if let Err(exit_code) = super::print(&text) {
        return exit_code;
    }
    exit_code(&results)
}

fn exit_code(results: &[MethodResult]) -> ExitCode {
    if results.iter().any(|result| result.outcome.is_ok()) {
        return ExitCode::SUCCESS;
    }
    let mut reasons = String::from("nothing could be computed");
    for result in results {
        if let Err(error) = &result.outcome {
            let separator = if reasons.contains(':') { ";" } else { ":" };
            // Writing to a string does not fail.
            write!(reasons, "{separator} {} – {error}", result.method.id()).ok();
        }
    }
    fail(EXIT_NOTHING_COMPUTED, &reasons)
}
