//! The Report step: what leaves the program, for people and for controllers.

mod figures;
mod page;
mod panel;
mod preview;
mod table;
mod tool_frame;

pub use panel::{ReportState, show};
pub use preview::ReportMemory;
