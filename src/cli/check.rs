//! `handeye check`: is this file a session, and is anything odd about it?

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use crate::calibrate::{Method, Mount, Solution, Warning, best_available};
use crate::session::check::{Finding, findings};
use crate::session::format::{Loaded, load_with_notes};
use crate::session::{self, FurtherTarget, NothingToSolve, Session, Target, measure_in};
use crate::text::check::{finding_message, touched_point_off};
use crate::text::warning_message;
use crate::watch::Unwatched;

use super::{EXIT_WRONG_INPUT, fail, folder_of};

/// Arguments of `handeye check`.
#[derive(Clone, Debug, clap::Args)]
pub struct CheckArgs {
    /// The session file.
    pub file: PathBuf,
}

/// Validates a session file and lists what is odd about it. What is odd is no failure: the status is then 0 as well.
#[must_use]
pub fn run(args: &CheckArgs) -> ExitCode {
    match load_with_notes(&args.file) {
        Ok(loaded) => match super::print(&listing(folder_of(&args.file), &loaded)) {
            Ok(()) => ExitCode::SUCCESS,
            Err(exit_code) => exit_code,
        },
        Err(error) => fail(EXIT_WRONG_INPUT, &error),
    }
}

/// What `handeye check` prints: the session in one line, then a line a finding.
#[must_use]
pub fn listing(folder: &Path, loaded: &Loaded) -> String {
    let Loaded { session, notes } = loaded;
    let all: Vec<Finding> = notes.iter().cloned().chain(findings(session)).collect();
    let name = if session.name.is_empty() { "unnamed" } else { session.name.lines().next().unwrap_or_default() };
    let stations = format!(
        "{} stations ({} enabled), {} profiles or points",
        session.stations.len(),
        session.stations.iter().filter(|station| station.enabled).count(),
        session.num_captures(),
    );
    let measured = match &session.target {
        Target::Rgbd { sequence } => format!("an RGB-D sequence in {sequence}"),
        _ => stations,
    };
    let mut listing = format!("a valid session: {name}, {measured}\n");
    for FurtherTarget { name, stations, .. } in &session.further {
        // Writing to a string cannot fail.
        let _ = writeln!(listing, "with the further target {name}, {} stations", stations.len());
    }
    for finding in &all {
        let _ = writeln!(listing, "{}: {}", finding.code(), finding_message(finding));
    }
    let Outcome { warnings, touched_off, failure } = outcome_of_all_methods(folder, session);
    for (method, warning) in &warnings {
        let _ = writeln!(listing, "{}: {} ({})", warning.code(), warning_message(warning), method.id());
    }
    if let Some(off) = &touched_off {
        let _ = writeln!(listing, "touched-point-off: {}", touched_point_off(off.distance_mm, off.std_mm, off.method));
    }
    // That stations are missing is said already.
    let stations_missing = all.iter().any(Finding::lacks_stations);
    if let Some(error) = failure.as_ref().filter(|_| !stations_missing) {
        let _ = writeln!(listing, "not-solvable: {error}");
    }
    if all.is_empty() && warnings.is_empty() && touched_off.is_none() && failure.is_none() {
        listing.push_str("nothing odd found\n");
    }
    listing
}

/// What solving shows.
#[derive(Debug, Default)]
struct Outcome {
    /// What the methods warn of, each code once: of the method that gives the answer, where that one does.
    warnings: Vec<(Method, Warning)>,
    /// A point that was touched and that the answer has somewhere else.
    touched_off: Option<TouchedOff>,
    /// Why none of the methods runs, if so.
    failure: Option<String>,
}

#[derive(Debug)]
struct TouchedOff {
    distance_mm: f64,
    std_mm: f64,
    method: Method,
}

/// Runs all methods: arcs, radius and rotations show only when solved.
fn outcome_of_all_methods(folder: &Path, session: &Session) -> Outcome {
    let Ok(measured) = measure_in(folder, session, &mut Unwatched) else { return Outcome::default() };
    let problem = match session::problem(session, &measured) {
        Ok(problem) => problem,
        // A workpiece is scanned for what a calibration is worth: that none is computed from it is not odd.
        Err(NothingToSolve::Workpiece) => return Outcome::default(),
        Err(refusal) => return Outcome { failure: Some(refusal.to_string()), ..Outcome::default() },
    };
    let Ok(results) = problem.solve_all(problem.methods(), &mut Unwatched) else { return Outcome::default() };
    let Some(answer) = best_available(&results) else {
        let failure = results.first().and_then(|result| result.outcome.as_ref().err()).map(ToString::to_string);
        return Outcome { failure, ..Outcome::default() };
    };
    let others = results.iter().filter_map(|result| result.outcome.as_ref().ok());
    let mut warnings: Vec<(Method, Warning)> = Vec::new();
    for solution in std::iter::once(answer).chain(others) {
        for warning in &solution.warnings {
            // That a station has no sweep matters to one method only.
            let is_said = warnings.iter().any(|(_, known)| known.code() == warning.code());
            if !is_said && !matches!(warning, Warning::StationSkipped { .. }) {
                warnings.push((solution.method, warning.clone()));
            }
        }
    }
    Outcome { warnings, touched_off: touched_off(session, answer), failure: None }
}

/// Whether a touched point lies where the answer cannot have it.
fn touched_off(session: &Session, answer: &Solution) -> Option<TouchedOff> {
    /// What touching with a robot's tool may be off without anything being wrong, mm.
    const TOUCH_STD_MM: f64 = 0.1;
    /// Further off than this many σ it is hardly chance.
    const NUM_STDS: f64 = 5.0;
    // A tip on the flange stands still nowhere in the base.
    let touched_mm = session.known.point_in_base_mm.filter(|_| answer.mount == Mount::OnFlange)?;
    let std_mm = answer.uncertainty.as_ref()?.workspace_point_std_mm;
    let distance_mm = (touched_mm - answer.target_in_base_mm).norm();
    (distance_mm > NUM_STDS * std_mm.hypot(TOUCH_STD_MM)).then_some(TouchedOff {
        distance_mm,
        std_mm,
        method: answer.method,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::format::parse_with_notes;

    #[test]
    fn the_listing_has_a_line_a_finding() {
        let json = r#"{"format": "handeye-session", "version": 1, "name": "cell 3",
            "target": {"kind": "ball", "radius_mm": 15}, "stations": []}"#;
        let loaded = parse_with_notes(json.as_bytes(), "cell.json").expect("valid");
        assert_eq!(
            listing(Path::new(""), &loaded),
            "a valid session: cell 3, 0 stations (0 enabled), 0 profiles or points\n\
             no-stations: There are no stations yet.\n"
        );
    }
}
