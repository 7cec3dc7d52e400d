//! What is wrong with a session, found by trying: each suspicion is a re-solve with one thing changed, and what makes the
//! residual fall is named, with its evidence and its remedy.
//!
//! Data flows `Session` + `BallProblem` + method results → [`diagnose`] → [`Diagnosis`]. Nothing here changes a session;
//! [`remedy::apply`] makes a changed copy when the user asks for it.

mod consensus;
pub mod convention;
pub mod finding;
pub mod geometry;
pub mod hypotheses;
mod model;
mod motion;
mod plate;
pub mod remedy;
mod station_reading;
pub mod stations;
mod verdict;
mod weighing;

pub use convention::{PoseReading, ReadingFit};
pub use finding::{Axis, CurveAxis, Evidence, Fault, Finding, Plot, Severity, StationBar};
pub use remedy::Remedy;
pub use verdict::{Reason, verdict_with};

use crate::calibrate::validation::{Validation, validate};
use crate::calibrate::{BallProblem, MethodResult, Problem, best_available};
use crate::session::Session;
use crate::watch::{Cancelled, Watch};

/// What was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagnosis {
    /// The most serious first; empty if there is nothing to object to.
    pub findings: Vec<Finding>,
    /// The ways to read the poses, best first; empty where the poses as given fit.
    pub readings: Vec<ReadingFit>,
    /// How much the best available solution can be relied on; `None` without one.
    pub validation: Option<Validation>,
}

impl Diagnosis {
    /// Whether it makes sense to plan further stations from the result: not while something else is wrong with it than
    /// that the orientations are too much alike, which further stations mend.
    #[must_use]
    pub fn allows_planning(&self) -> bool {
        self.findings.first().is_none_or(|first| {
            first.severity != Severity::Wrong
                || matches!(
                    first.fault,
                    Fault::NoRotation { .. }
                        | Fault::LittleRotation { .. }
                        | Fault::OneAxis { .. }
                        | Fault::TwinPoses { .. }
                )
        })
    }
}

/// Everything that a suspicion may look at.
#[derive(Clone, Copy, Debug)]
pub struct Case<'a> {
    /// The document.
    pub session: &'a Session,
    /// Its enabled stations, reduced to arcs or tips.
    pub problem: &'a BallProblem,
    /// What the methods made of it.
    pub results: &'a [MethodResult],
}

/// A residual that falls by more once the poses are read in another way leaves nothing for other suspicions to explain.
const CLEARLY_MISREAD: f64 = 10.0;

/// Examines a session and its results.
///
/// # Errors
/// [`Cancelled`] if `watch` says so.
pub fn diagnose(case: Case<'_>, watch: &mut dyn Watch) -> Result<Diagnosis, Cancelled> {
    const PARTS: usize = 4;
    watch.report(0, PARTS)?;
    let (misread, readings) = convention::examine(case, watch)?;
    watch.report(1, PARTS)?;
    // With all poses misread, looking for single wrong ones takes long and leads nowhere.
    let is_clear = misread.as_ref().is_some_and(|misread| misread.explains > CLEARLY_MISREAD);
    let mut findings = if is_clear { geometry::examine(case) } else { suspicions(case) };
    findings.extend(misread);
    watch.report(2, PARTS)?;
    let causes = weighing::causes(case, findings);
    watch.report(3, PARTS)?;
    let validation = best_available(case.results).and_then(validate);
    let findings = weighing::with_warnings(case, causes, validation.as_ref());
    Ok(Diagnosis { findings, readings, validation })
}

/// A tip has no size that errors could be held against; that of a usual ball stands in, mm.
const SIZE_FOR_A_TIP_MM: f64 = 15.0;

/// Examines a session with any target and its results. A tip is examined as a ball whose centres are given.
///
/// # Errors
/// [`Cancelled`] if `watch` says so.
pub fn diagnose_any(
    session: &Session,
    problem: &Problem,
    results: &[MethodResult],
    watch: &mut dyn Watch,
) -> Result<Diagnosis, Cancelled> {
    match problem {
        Problem::Ball(problem) => diagnose(Case { session, problem, results }, watch),
        Problem::Point(tip) => {
            let problem = &BallProblem { radius_mm: SIZE_FOR_A_TIP_MM, ..tip.clone() };
            diagnose(Case { session, problem, results }, watch)
        }
        Problem::Plate(problem) => plate::examine(session, problem, results, watch),
        Problem::Motion(_) | Problem::Streams(_) => motion::examine(results, watch),
    }
}

/// What the quick examinations find, the poses read as they are.
fn suspicions(case: Case<'_>) -> Vec<Finding> {
    let mut findings = geometry::examine(case);
    findings.extend(stations::examine(case));
    findings.extend(hypotheses::examine(case));
    findings
}
