//! `handeye report`: everything that is known of a session, as a page to be read, printed, signed and archived.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;

use crate::report::calibration_file::read_calibration_for;
use crate::report::document::{InputFile, Options, SectionId, document};
use crate::report::evidence::Evidence;
use crate::report::files::{HTML, report_files, write_files};
use crate::report::pdf;
use crate::session::{self, measure_in};
use crate::text::report_cli as words;
use crate::verify::{Calibration, Origin};
use crate::watch::Unwatched;

use super::{EXIT_NOTHING_COMPUTED, EXIT_WRONG_INPUT, fail, folder_of};

/// Arguments of `handeye report`.
#[derive(Debug, Args)]
pub struct ReportArgs {
    /// Session file
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// Folder to write the report into; it is made if it is missing
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Only this section; may be given several times
    #[arg(long = "section", value_name = "ID", value_parser = section_of, conflicts_with = "without")]
    pub sections: Vec<SectionId>,
    /// All sections but this one; may be given several times
    #[arg(long, value_name = "ID", value_parser = section_of)]
    pub without: Vec<SectionId>,
    /// Result file (`handeye solve --json`) or text file with a matrix, to be judged along; may be given several times
    #[arg(long = "calibration", value_name = "RESULT.json|MATRIX")]
    pub calibrations: Vec<PathBuf>,
    /// Who answers for the report
    #[arg(long, default_value = "", hide_default_value = true)]
    pub operator: String,
    /// Where it was made
    #[arg(long, default_value = "", hide_default_value = true)]
    pub place: String,
    /// When it was made, in your own words; the report holds no clock
    #[arg(long, default_value = "", hide_default_value = true)]
    pub date: String,
    /// Remarks for the section on the set-up
    #[arg(long, value_name = "TEXT", default_value = "", hide_default_value = true)]
    pub notes: String,
    /// Print the page to report.pdf as well, with a browser that is installed
    #[arg(long)]
    pub pdf: bool,
}

fn section_of(id: &str) -> Result<SectionId, String> {
    SectionId::by_id(id).ok_or_else(|| words::no_such_section(&SectionId::ALL.map(SectionId::id)))
}

/// Runs the command.
#[must_use]
pub fn run(args: &ReportArgs) -> ExitCode {
    match reported(args) {
        Ok((said, refusal)) => match (super::print(&said), refusal) {
            (Err(exit_code), _) => exit_code,
            (Ok(()), None) => ExitCode::SUCCESS,
            (Ok(()), Some(reason)) => fail(EXIT_NOTHING_COMPUTED, &reason),
        },
        Err((status, reason)) => fail(status, &reason),
    }
}

type Refusal = (u8, String);

/// What was written, and why the report holds no figures where it does not.
fn reported(args: &ReportArgs) -> Result<(String, Option<String>), Refusal> {
    let wrong = |error: &dyn std::fmt::Display| (EXIT_WRONG_INPUT, error.to_string());
    let (session, bytes) = session::load_with_bytes(&args.file).map_err(|error| wrong(&error))?;
    let mut inputs = vec![InputFile::new(name_of(&args.file), &bytes)];
    let mut given = Vec::new();
    for path in &args.calibrations {
        let read = read_calibration_for(path, session.mount).map_err(|error| wrong(&error))?;
        inputs.push(read.file);
        let origin = Origin::Given { name: read.name.clone(), is_nearest: !read.check.is_rotation() };
        given.push(Calibration { origin, flange_from_sensor: read.flange_from_sensor, workspace_point_std_mm: None });
    }
    let nothing = |error: &dyn std::fmt::Display| (EXIT_NOTHING_COMPUTED, error.to_string());
    let evidence = measure_in(folder_of(&args.file), &session, &mut Unwatched)
        .and_then(|measured| Evidence::gather(&session, &measured, &given, &mut Unwatched))
        .map_err(|cancelled| nothing(&cancelled))?;
    let document = document(&evidence, &inputs, &options(args));
    let files = report_files(&document, &evidence).map_err(|error| nothing(&error))?;
    let written = write_files(&files, &args.out).map_err(|error| wrong(&error))?;
    let mut said: String = written.iter().map(|path| words::wrote(&path.display().to_string())).collect();
    if args.pdf {
        said.push_str(&match pdf::print(&args.out.join(HTML)) {
            Ok(path) => words::wrote(&path.display().to_string()),
            Err(error) => words::no_pdf(&error.to_string()),
        });
    }
    let has_parts = evidence.parts.iter().any(|part| part.outcome.is_ok());
    let refusal = evidence.refusal().filter(|_| !has_parts);
    Ok((said, refusal.map(|reason| words::report_without_calibration(&reason))))
}

fn options(args: &ReportArgs) -> Options {
    let sections: BTreeSet<SectionId> = if args.sections.is_empty() {
        SectionId::ALL.into_iter().filter(|section| !args.without.contains(section)).collect()
    } else {
        args.sections.iter().copied().collect()
    };
    let [operator, place, date, notes] = [&args.operator, &args.place, &args.date, &args.notes].map(Clone::clone);
    Options { sections, operator, place, date, notes }
}

/// The file's name without its folder: that is another on every machine.
fn name_of(path: &Path) -> String {
    path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned())
}
