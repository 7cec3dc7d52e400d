//! Good, usable, or not usable: a plain verdict with its reason.

use super::{Solution, Warning};

/// Up to this standard deviation of a workspace point, mm, a calibration is called good: about the repeatability of
/// an industrial arm with its profiler, so the calibration no longer is the weak link.
pub const GOOD_UP_TO_MM: f64 = 0.1;
/// Up to this, mm, it is called usable: enough to find a seam or a part, not to measure it.
pub const USABLE_UP_TO_MM: f64 = 0.5;

/// A plain verdict.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// Fit for measuring.
    Good,
    /// Fit for coarse work, or to be looked at.
    Usable,
    /// Not to be used.
    NotUsable,
}

/// What the verdict rests on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum VerdictReason {
    /// The standard deviation of a point in the workspace, mm.
    WorkspacePoint(f64),
    /// The left-out error, which is above the standard deviation of that point.
    LeaveOneOut {
        /// How far stations are missed that the others predict, RMS, mm.
        left_out_mm: f64,
        /// The standard deviation of a point in the workspace, mm.
        std_mm: f64,
    },
    /// A warning, by its index in the solution, weighs more than the figures.
    Warning(usize),
    /// Nothing is left over to judge by.
    NoRedundancy,
}

/// Judges a solution by the standard deviation of a workspace point, the left-out error and the warnings.
#[must_use]
pub fn judge(solution: &Solution) -> (Verdict, VerdictReason) {
    let Some(uncertainty) = &solution.uncertainty else {
        return (Verdict::NotUsable, VerdictReason::NoRedundancy);
    };
    let workspace_std_mm = uncertainty.workspace_point_std_mm;
    let left_out_mm = solution.leave_one_out.map_or(0.0, |left_out| left_out.rms_mm);
    let (figure_mm, reason) = if left_out_mm > workspace_std_mm {
        (left_out_mm, VerdictReason::LeaveOneOut { left_out_mm, std_mm: workspace_std_mm })
    } else {
        (workspace_std_mm, VerdictReason::WorkspacePoint(workspace_std_mm))
    };
    let by_figures = if figure_mm <= GOOD_UP_TO_MM {
        Verdict::Good
    } else if figure_mm <= USABLE_UP_TO_MM {
        Verdict::Usable
    } else {
        Verdict::NotUsable
    };
    let doubt = solution.warnings.iter().position(Warning::casts_doubt);
    match doubt {
        Some(warning_idx) if by_figures == Verdict::Good => (Verdict::Usable, VerdictReason::Warning(warning_idx)),
        _ => (by_figures, reason),
    }
}
