//! Step 3: the profiles, the arcs found in them, and the radius against the step.

mod curve;
mod list;
mod model;
mod panel;
mod profile;

pub use panel::{ArcsState, show};
