//! Step 5: the methods side by side, their errors, and how their results differ.

mod bars;
mod cards;
mod closed_forms;
mod differences;
mod panel;
mod paper;
mod published;
mod scatter;
pub(in crate::ui) mod table;

pub use panel::{CompareState, show};
