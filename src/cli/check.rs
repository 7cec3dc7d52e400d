//! `handeye check`: is this file a session, and is anything odd about it?

use std::fmt::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;

use crate::calibrate::Warning;
use crate::session::check::{Finding, findings};
use crate::session::format::{Loaded, load_with_notes};
use crate::session::{self, FurtherTarget, NothingToSolve, Session, measure};
use crate::text::check::finding_message;
use crate::text::warning_message;
use crate::watch::Unwatched;

use super::{EXIT_WRONG_INPUT, fail};

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
        Ok(loaded) => match super::print(&listing(&loaded)) {
            Ok(()) => ExitCode::SUCCESS,
            Err(exit_code) => exit_code,
        },
        Err(error) => fail(EXIT_WRONG_INPUT, &error),
    }
}

/// What `handeye check` prints: the session in one line, then a line a finding.
#[must_use]
pub fn listing(loaded: &Loaded) -> String {
    let Loaded { session, notes } = loaded;
    let all: Vec<Finding> = notes.iter().cloned().chain(findings(session)).collect();
    let mut listing = format!(
        "a valid session: {}, {} stations ({} enabled), {} profiles or points\n",
        if session.name.is_empty() { "unnamed" } else { session.name.lines().next().unwrap_or_default() },
        session.stations.len(),
        session.stations.iter().filter(|station| station.enabled).count(),
        session.num_captures(),
    );
    for FurtherTarget { name, stations, .. } in &session.further {
        // Writing to a string cannot fail.
        let _ = writeln!(listing, "with the further target {name}, {} stations", stations.len());
    }
    for finding in &all {
        let _ = writeln!(listing, "{}: {}", finding.code(), finding_message(finding));
    }
    let (warnings, failure) = outcome_of_all_methods(session);
    for warning in &warnings {
        let _ = writeln!(listing, "{}: {}", warning.code(), warning_message(warning));
    }
    // That stations are missing is said already.
    let stations_missing = all.iter().any(Finding::lacks_stations);
    if let Some(error) = failure.as_ref().filter(|_| !stations_missing) {
        let _ = writeln!(listing, "not-solvable: {error}");
    }
    if all.is_empty() && warnings.is_empty() && failure.is_none() {
        listing.push_str("nothing odd found\n");
    }
    listing
}

/// What the methods would warn of, each code once, and why none of them runs, if so: arcs, radius and rotations show only
/// when solved.
fn outcome_of_all_methods(session: &Session) -> (Vec<Warning>, Option<String>) {
    let Ok(measured) = measure(session, None, &mut Unwatched) else { return (Vec::new(), None) };
    let problem = match session::problem(session, &measured) {
        Ok(problem) => problem,
        // A workpiece is scanned for what a calibration is worth: that none is computed from it is not odd.
        Err(NothingToSolve::Workpiece) => return (Vec::new(), None),
        Err(refusal) => return (Vec::new(), Some(refusal.to_string())),
    };
    let outcomes: Vec<_> = problem.methods().iter().map(|method| problem.solve(*method)).collect();
    let failure = outcomes[0].as_ref().err().filter(|_| outcomes.iter().all(Result::is_err)).map(ToString::to_string);
    let mut warnings: Vec<Warning> = Vec::new();
    for solution in outcomes.into_iter().flatten() {
        for warning in solution.warnings {
            // That a station has no sweep matters to one method only.
            let is_said = warnings.iter().any(|known| known.code() == warning.code());
            if !is_said && !matches!(warning, Warning::StationSkipped { .. }) {
                warnings.push(warning);
            }
        }
    }
    (warnings, failure)
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
            listing(&loaded),
            "a valid session: cell 3, 0 stations (0 enabled), 0 profiles or points\n\
             no-stations: There are no stations yet.\n"
        );
    }
}
