//! What is wrong with a session, in words: titles, sentences, remedies, buttons, and the headings of the plots.

mod faults;
mod figures;
mod readings;
mod remedies;
#[cfg(test)]
mod tests;
mod words;

pub use faults::{fault_message, fault_remedy, fault_title, first_finding};
pub use figures::*;
pub use readings::{pose_reading, pose_reading_in_full};
pub use remedies::{remedy_label, remedy_undo_label};
pub use words::along;
pub(super) use words::target_word;

use crate::diagnose::Severity;

/// Title of what was found.
pub const HEADING: &str = "Diagnosis";
/// Nothing was found.
pub const NOTHING_FOUND: &str = "Nothing to object to.";

/// How much a finding weighs.
#[must_use]
pub const fn severity_name(severity: Severity) -> &'static str {
    match severity {
        Severity::Wrong => "Wrong",
        Severity::Doubtful => "Doubtful",
        Severity::Note => "Note",
    }
}

/// The same in result files.
#[must_use]
pub const fn severity_id(severity: Severity) -> &'static str {
    match severity {
        Severity::Wrong => "wrong",
        Severity::Doubtful => "doubtful",
        Severity::Note => "note",
    }
}

/// Its shape, so that colour is never alone.
#[must_use]
pub const fn severity_mark(severity: Severity) -> &'static str {
    match severity {
        Severity::Wrong => "✖",
        Severity::Doubtful => "!",
        Severity::Note => "i",
    }
}
