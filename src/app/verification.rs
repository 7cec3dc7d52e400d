//! From a session with its results to what they are worth on other data; the command line and the window share it.

use crate::calibrate::{MethodResult, Problem};
use crate::session::model::UnknownFields;
use crate::session::{Edit, FurtherTarget, Known, Measured, Session, Target, problem_of};
use crate::text::verify::{own_target_name, target_name_from_file};
use crate::verify::{Calibration, TargetCase, Verification, verify};
use crate::watch::{Cancelled, Watch};

/// The targets of a session with what the methods make of each: its own first, then the further ones. A target that nothing
/// is computed from, such as a workpiece, is none of them.
///
/// # Errors
/// [`Cancelled`] if `watch` says so.
pub fn target_cases(
    session: &Session,
    measured: &Measured,
    own: Option<(&Problem, &[MethodResult])>,
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
            problem: problem.clone(),
            results: results.to_vec(),
            touched_mm: touched_mm(&session.target, &session.known),
        })
        .collect();
    for (further_idx, further) in session.further.iter().enumerate() {
        let Ok(problem) = problem_of(session, measured, further_idx) else { continue };
        let results = problem.solve_all(problem.methods(), watch)?;
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

/// All calibrations at hand, those `given` among them, on all targets of a session.
///
/// # Errors
/// [`Cancelled`] if `watch` says so.
pub fn verification(
    session: &Session,
    measured: &Measured,
    own: Option<(&Problem, &[MethodResult])>,
    given: &[Calibration],
    watch: &mut dyn Watch,
) -> Result<Verification, Cancelled> {
    let cases = target_cases(session, measured, own, watch)?;
    verify(cases, given, watch)
}

/// All that a session measured, its own target and its further ones, as further targets of another session. The names that
/// they get are free among those there once the edit is made.
#[must_use]
pub fn adding_targets_of(session: Session, file_name: &str) -> Edit {
    let Session { name, target, known, stations, further, .. } = session;
    let name = if name.trim().is_empty() { target_name_from_file(file_name) } else { name };
    let own = FurtherTarget { name, target, known, stations, unknown: UnknownFields::new() };
    Edit::Several(std::iter::once(own).chain(further).map(|target| Edit::AddFurther(Box::new(target))).collect())
}
