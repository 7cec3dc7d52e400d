//! From a session with its results to what they are worth on other data; the command line and the window share it.

use crate::calibrate::{MethodResult, Problem, best_available};
use crate::session::model::UnknownFields;
use crate::session::{Edit, FurtherTarget, Known, Measured, Session, Target, problem_of};
use crate::text::verify::{own_target_name, target_name_from_file};
use crate::verify::{Calibration, TargetCase, Verification, verify};
use crate::watch::{Cancelled, Watch};

/// The data of a target with what the methods made of them.
#[derive(Clone, Debug)]
pub struct SolvedTarget {
    /// The data.
    pub problem: Problem,
    /// One entry a method.
    pub results: Vec<MethodResult>,
}

/// What the methods made of the further targets of a verification: they stay what they are while only the session's own
/// stations change.
#[must_use]
pub fn solved_further(verification: &Verification) -> Vec<SolvedTarget> {
    let further = verification.targets.iter().filter(|target| target.further_idx.is_some());
    further.map(|target| SolvedTarget { problem: target.problem.clone(), results: target.results.clone() }).collect()
}

/// Streams with the camera's times by the robot's clock, as the best solution has it: what calibrations are held against must
/// not hang on a rough guess.
fn with_clocks_set(problem: &Problem, results: &[MethodResult]) -> Problem {
    let offset_s = best_available(results)
        .and_then(|solution| solution.motion.as_ref()?.time_offset)
        .map(|clocks| clocks.offset_s);
    match (problem, offset_s) {
        (Problem::Streams(streams), Some(offset_s)) => {
            let mut streams = streams.clone();
            streams.find_offset = false;
            streams.camera.iter_mut().for_each(|pose| pose.time_s += offset_s);
            Problem::Streams(streams)
        }
        _ => problem.clone(),
    }
}

/// The targets of a session with what the methods make of each: its own first, then the further ones, unless they are among
/// the `known`. A target that nothing is computed from, such as a workpiece, is none of them.
///
/// # Errors
/// [`Cancelled`] if `watch` says so.
pub fn target_cases(
    session: &Session,
    measured: &Measured,
    own: Option<(&Problem, &[MethodResult])>,
    known: &[SolvedTarget],
    watch: &mut dyn Watch,
) -> Result<Vec<TargetCase>, Cancelled> {
    let touched_mm = |target: &Target, known: &Known| match target {
        Target::Ball { .. } | Target::Point => known.point_in_base_mm,
        _ => None,
    };
    let mut cases: Vec<TargetCase> = own
        .into_iter()
        .map(|(problem, results)| TargetCase {
            name: own_target_name(&session.target).to_owned(),
            further_idx: None,
            problem: with_clocks_set(problem, results),
            results: results.to_vec(),
            touched_mm: touched_mm(&session.target, &session.known),
        })
        .collect();
    for (further_idx, further) in session.further.iter().enumerate() {
        let Ok(problem) = problem_of(session, measured, further_idx) else { continue };
        let results = match known.iter().find(|known| known.problem == problem) {
            Some(known) => known.results.clone(),
            None => problem.solve_all(problem.methods(), watch)?,
        };
        cases.push(TargetCase {
            name: further.name.clone(),
            further_idx: Some(further_idx),
            problem,
            results,
            touched_mm: touched_mm(&further.target, &further.known),
        });
    }
    Ok(cases)
}

/// All calibrations at hand, those `given` among them, on all targets of a session. What the methods made of further targets
/// is taken from `known` where it holds them.
///
/// # Errors
/// [`Cancelled`] if `watch` says so.
pub fn verification(
    session: &Session,
    measured: &Measured,
    own: Option<(&Problem, &[MethodResult])>,
    given: &[Calibration],
    known: &[SolvedTarget],
    watch: &mut dyn Watch,
) -> Result<Verification, Cancelled> {
    let cases = target_cases(session, measured, own, known, watch)?;
    verify(cases, given, watch)
}

/// All that a session measured, its own target and its further ones, as further targets of another session. The names that
/// they get are free among those there once the edit is made.
#[must_use]
pub fn adding_targets_of(session: Session, file_name: &str) -> Edit {
    let Session { name, target, known, stations, further, sensor, .. } = session;
    let name = if name.trim().is_empty() { target_name_from_file(file_name) } else { name };
    let own = FurtherTarget { name, target, known, profile_std_mm: None, stations, unknown: UnknownFields::new() };
    let with_noise = |target: FurtherTarget| {
        // What that session says of its profiles holds for them there as well.
        let profile_std_mm = target.profile_std_mm.or(sensor.profile_std_mm);
        Edit::AddFurther(Box::new(FurtherTarget { profile_std_mm, ..target }))
    };
    Edit::Several(std::iter::once(own).chain(further).map(with_noise).collect())
}
