//! The Report step: what leaves the program, for people and for controllers.

mod panel;
mod tool_frame;

pub use panel::{ReportState, show};
