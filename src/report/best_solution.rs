//! The calibration that a session stands for where nobody says which one is meant.

use crate::calibrate::{Solution, best_available};
use crate::session::{self, Measured, NothingToSolve, Session};
use crate::text::workpiece::ONLY_A_WORKPIECE;
use crate::watch::{Cancelled, Watch};

/// The best solution for the session's own target, or for the first further one that has any; otherwise why there is none.
///
/// # Errors
/// [`Cancelled`].
pub fn best_solution(
    session: &Session,
    measured: &Measured,
    watch: &mut dyn Watch,
) -> Result<Result<Solution, String>, Cancelled> {
    let own = session::problem(session, measured);
    let further = (0..session.further.len()).map(|idx| session::problem_of(session, measured, idx));
    let mut reason = ONLY_A_WORKPIECE.to_owned();
    for problem in std::iter::once(own).chain(further) {
        let problem = match problem {
            Ok(problem) => problem,
            Err(NothingToSolve::Workpiece) => continue,
            Err(refusal) => {
                reason = refusal.to_string();
                continue;
            }
        };
        let results = problem.solve_all(problem.methods(), watch)?;
        if let Some(solution) = best_available(&results) {
            return Ok(Ok(solution.clone()));
        }
        if let Some(error) = results.iter().find_map(|result| result.outcome.as_ref().err()) {
            reason = error.to_string();
        }
    }
    Ok(Err(reason))
}
