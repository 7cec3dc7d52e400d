//! `handeye solve`: every method that the session's data allows, as a table or as the result file.

use std::fmt::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};

use crate::calibrate::validation::{Bootstrap, bootstrap};
use crate::calibrate::{Method, MethodResult, Problem, SolveError, best_available};
use crate::diagnose::Diagnosis;
use crate::report::evidence::Examined;
use crate::report::result_file::{Examination, result_file};
use crate::session::{self, Session, Target, measure_in};
use crate::text::cli::no_such_station;
use crate::text::diagnosis::first_finding;

use super::progress::watched;
use super::{EXIT_NOTHING_COMPUTED, EXIT_WRONG_INPUT, fail, folder_of};

mod diagnosis;
mod paper_tables;
mod stations;
mod tables;

pub use tables::six_numbers;

/// Arguments of `handeye solve`.
#[derive(Debug, Args)]
pub struct SolveArgs {
    /// Session file
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// Run only this method; may be given several times
    #[arg(long = "method", value_name = "ID", value_parser = method_parser())]
    pub methods: Vec<Method>,
    /// Leave this station out, by its label; may be given several times
    #[arg(long, value_name = "LABEL")]
    pub without: Vec<String>,
    /// Print the result file (JSON) instead of tables
    #[arg(long)]
    pub json: bool,
    /// Print tables in the layout of Lin & Mu's Tables 1 and 2
    #[arg(long, conflicts_with = "json")]
    pub paper_tables: bool,
    /// Leave out what is wrong with the session, how far the result can be relied on, and where to measure next
    #[arg(long)]
    pub no_diagnosis: bool,
    /// Solve N times with stations drawn with replacement, and print the spread
    #[arg(
        long, value_name = "N", conflicts_with_all = ["no_diagnosis", "paper_tables"],
        value_parser = clap::value_parser!(u32).range(1..=100_000)
    )]
    pub bootstrap: Option<u32>,
}

fn method_parser() -> impl TypedValueParser<Value = Method> {
    PossibleValuesParser::new(Method::ALL.map(Method::id))
        .try_map(|id| Method::by_id(&id).ok_or_else(|| format!("no method is called {id}")))
}

/// Runs the command.
#[must_use]
pub fn run(args: &SolveArgs) -> ExitCode {
    let mut session = match session::load(&args.file) {
        Ok(session) => session,
        Err(error) => return fail(EXIT_WRONG_INPUT, &error),
    };
    for label in &args.without {
        match session.stations.iter_mut().find(|station| station.label == *label) {
            Some(station) => station.enabled = false,
            None => return fail(EXIT_WRONG_INPUT, &no_such_station(label, &session)),
        }
    }
    solved(args, &session).unwrap_or_else(|reason| fail(EXIT_NOTHING_COMPUTED, &reason))
}

/// What takes its time before anything is solved.
const fn reading(target: &Target) -> &'static str {
    match target {
        Target::Rgbd { .. } => "tracking frames",
        _ => "reading profiles",
    }
}

/// # Errors
/// Why there is nothing to print, in one line.
fn solved(args: &SolveArgs, session: &Session) -> Result<ExitCode, String> {
    let measured = watched(reading(&session.target), |progress| measure_in(folder_of(&args.file), session, progress))?;
    let problem = session::problem(session, &measured).map_err(|refusal| refusal.to_string())?;
    let methods = if args.methods.is_empty() { problem.methods() } else { args.methods.as_slice() };
    let results = watched("solving", |progress| problem.solve_all(methods, progress))?;
    if args.paper_tables {
        return Ok(printed(&paper_tables::paper_tables(session, &results), session, &results, None));
    }
    let found = if args.no_diagnosis { None } else { Some(Found::new(args, session, &problem, &results)?) };
    let examination = found.as_ref().map(Found::examination);
    let text = if args.json {
        format!("{:#}\n", result_file(session, &results, examination.as_ref()))
    } else {
        let section = examination.as_ref().map(|found| diagnosis::section(session, &results, found));
        tables::tables(session, &results, found.as_ref().map(|found| &found.examined.diagnosis))
            + &section.unwrap_or_default()
    };
    Ok(printed(&text, session, &results, found.as_ref().map(|found| &found.examined.diagnosis)))
}

/// What was found out beside the results.
struct Found {
    examined: Examined,
    bootstrap: Option<Bootstrap>,
}

impl Found {
    fn new(args: &SolveArgs, session: &Session, problem: &Problem, results: &[MethodResult]) -> Result<Self, String> {
        /// The same session gives the same output.
        const SEED: u64 = 1;
        let examined = watched("examining", |progress| Examined::new(session, problem, results, progress))?;
        let bootstrap = match best_available(results).zip(args.bootstrap) {
            Some((solution, num_draws)) => {
                Some(watched("drawing stations", |progress| bootstrap(solution, num_draws as usize, SEED, progress))?)
            }
            None => None,
        };
        Ok(Self { examined, bootstrap })
    }

    const fn examination(&self) -> Examination<'_> {
        Examination { bootstrap: self.bootstrap.as_ref(), ..self.examined.examination() }
    }
}

/// Prints, and says so if no method gave a result.
fn printed(text: &str, session: &Session, results: &[MethodResult], diagnosis: Option<&Diagnosis>) -> ExitCode {
    if let Err(exit_code) = super::print(text) {
        return exit_code;
    }
    if results.iter().any(|result| result.outcome.is_ok()) {
        return ExitCode::SUCCESS;
    }
    let mut reasons = String::from("nothing could be computed");
    // The fixed point asks for least, so its reason is the one that all of them have.
    let of_first = results.first().and_then(|result| Some((result.method, result.outcome.as_ref().err()?)));
    if let Some((_, error @ SolveError::OtherTarget { .. })) = of_first {
        return fail(EXIT_NOTHING_COMPUTED, &format!("{reasons}: {error}"));
    }
    if let Some((method, error)) = of_first {
        // Writing to a string does not fail.
        write!(reasons, ": {} – {error}", method.id()).ok();
    }
    if let Some(finding) = diagnosis.and_then(|diagnosis| diagnosis.findings.first()) {
        write!(reasons, "; {}", first_finding(&finding.fault, session)).ok();
    }
    fail(EXIT_NOTHING_COMPUTED, &reasons)
}
