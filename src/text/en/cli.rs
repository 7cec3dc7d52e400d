//! What the commands print.

use crate::calibrate::{Verdict, VerdictReason, Warning};

use super::{verdict_name, warning_message};

/// The verdict with its reason, in one line.
#[must_use]
pub fn verdict_line(verdict: Verdict, reason: VerdictReason, warnings: &[Warning]) -> String {
    let name = verdict_name(verdict);
    match reason {
        VerdictReason::WorkspacePoint(std_mm) => {
            format!("{name}: a point in the workspace is known to ± {std_mm:.2} mm (1 σ, 3D)")
        }
        VerdictReason::LeaveOneOut(error_mm) => {
            format!("{name}: a station predicted by the others is missed by {error_mm:.2} mm (RMS)")
        }
        VerdictReason::Warning(idx) => {
            let message = warnings.get(idx).map_or_else(String::new, warning_message);
            format!("{name}: {message}")
        }
        VerdictReason::NoRedundancy => format!("{name}: nothing is left over to judge by; add stations"),
    }
}
