//! Step 6: what is wrong and what mends it, how sure the result is, and where to measure next.

mod accuracy;
mod bars;
mod findings;
mod model;
mod panel;
mod plan;
mod plots;
mod readings;
pub mod triad;
mod validation;

pub use model::{Seen, Shown, View};
pub use panel::{DiagnosisState, show, show_view};
