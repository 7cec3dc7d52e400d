//! The one list of methods that the command line, the window and the tests all read.

use crate::watch::{Cancelled, Watch};

use super::ball;
use super::{BallProblem, Solution, SolveError, Warning};

/// A way to compute `flange_from_sensor`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Method {
    /// Lin & Mu 2019 §1: one section a station, y = ±√(R² − l²).
    BallFixedPoint,
    /// Lin & Mu 2019 §2 as published: step along Y and stop at the first l ≥ R.
    BallMaxArcStep,
    /// The same sweep, the whole radius-vs-step curve fitted, with the real pose of every step.
    BallMaxArc,
    /// All points of all profiles at once.
    BallBundle,
    /// Chen et al. 2023 §3: the difference vectors of the two edges, perpendicular to each other.
    PlateOrthogonal,
    /// All edge points on two lines that meet at a right angle.
    PlateBundle,
    /// A tip or pin that the laser line touches from several poses.
    FixedPoint,
    /// The flange's motions against those of a target, or of a camera: A X = X B.
    Motion,
}

impl Method {
    /// All methods, in the order in which they are shown.
    pub const ALL: [Self; 8] = [
        Self::BallFixedPoint,
        Self::BallMaxArcStep,
        Self::BallMaxArc,
        Self::BallBundle,
        Self::PlateOrthogonal,
        Self::PlateBundle,
        Self::FixedPoint,
        Self::Motion,
    ];
    /// All of them, the one whose answer is to be used first.
    pub const BEST_FIRST: [Self; 8] = [
        Self::BallBundle,
        Self::BallMaxArc,
        Self::BallFixedPoint,
        Self::BallMaxArcStep,
        Self::PlateBundle,
        Self::PlateOrthogonal,
        Self::FixedPoint,
        Self::Motion,
    ];
    /// Those for a ball.
    pub const BALL: [Self; 4] = [Self::BallFixedPoint, Self::BallMaxArcStep, Self::BallMaxArc, Self::BallBundle];
    /// Those for a right-angle plate.
    pub const PLATE: [Self; 2] = [Self::PlateOrthogonal, Self::PlateBundle];
    /// That for a tip.
    pub const POINT: [Self; 1] = [Self::FixedPoint];
    /// That for a target whose whole pose is seen.
    pub const MOTION: [Self; 1] = [Self::Motion];

    /// The name in files and on the command line.
    #[must_use]
    pub const fn id(self) -> &'static str {
        match self {
            Self::BallFixedPoint => "ball-fixed-point",
            Self::BallMaxArcStep => "ball-max-arc-step",
            Self::BallMaxArc => "ball-max-arc",
            Self::BallBundle => "ball-bundle",
            Self::PlateOrthogonal => "plate-orthogonal",
            Self::PlateBundle => "plate-bundle",
            Self::FixedPoint => "fixed-point",
            Self::Motion => "motion",
        }
    }

    /// Whether its target may be on either side of the sensor's plane, and the side is part of what was found.
    #[must_use]
    pub const fn has_sides(self) -> bool {
        !matches!(self, Self::FixedPoint | Self::Motion)
    }

    /// The method with this name.
    #[must_use]
    pub fn by_id(id: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|method| method.id() == id)
    }
}

/// What became of one method on one problem.
#[derive(Clone, Debug, PartialEq)]
pub struct MethodResult {
    /// Which method.
    pub method: Method,
    /// Its solution, or why nothing could be computed.
    pub outcome: Result<Solution, SolveError>,
}

/// Runs one method for the ball.
///
/// # Errors
/// [`SolveError`] if nothing can be computed from this problem, or if the method is for another target. A poor result is a solution with warnings.
pub fn solve(problem: &BallProblem, method: Method) -> Result<Solution, SolveError> {
    match method {
        Method::BallFixedPoint => ball::fixed_point::solve(problem),
        Method::BallMaxArcStep => ball::max_arc_step::solve(problem),
        Method::BallMaxArc => ball::max_arc::solve(problem),
        Method::BallBundle => ball::bundle::solve(problem),
        Method::PlateOrthogonal | Method::PlateBundle | Method::FixedPoint | Method::Motion => {
            Err(SolveError::OtherTarget { method, available: &Method::BALL })
        }
    }
}

/// Runs the given methods for the ball in their order.
///
/// # Errors
/// [`Cancelled`] if `watch` says so between two methods.
pub fn solve_all(
    problem: &BallProblem,
    methods: &[Method],
    watch: &mut dyn Watch,
) -> Result<Vec<MethodResult>, Cancelled> {
    each(methods, watch, |method| solve(problem, method))
}

/// The results of methods, one after the other.
pub(super) fn each(
    methods: &[Method],
    watch: &mut dyn Watch,
    solve: impl Fn(Method) -> Result<Solution, SolveError>,
) -> Result<Vec<MethodResult>, Cancelled> {
    let mut results = Vec::with_capacity(methods.len());
    for &method in methods {
        watch.report(results.len(), methods.len())?;
        results.push(MethodResult { method, outcome: solve(method) });
    }
    Ok(results)
}

/// The solution of a method, if it has one.
#[must_use]
pub fn solution_of(results: &[MethodResult], method: Method) -> Option<&Solution> {
    results.iter().find(|result| result.method == method).and_then(|result| result.outcome.as_ref().ok())
}

/// The solution to use: of the bundle, else of the whole curve, else of the fixed point, else of the published stop; one that
/// did not settle only if none did.
#[must_use]
pub fn best_available(results: &[MethodResult]) -> Option<&Solution> {
    let solutions = || Method::BEST_FIRST.into_iter().filter_map(|method| solution_of(results, method));
    let has_settled =
        |solution: &&Solution| !solution.warnings.iter().any(|warning| matches!(warning, Warning::NotConverged { .. }));
    solutions().find(has_settled).or_else(|| solutions().next())
}
