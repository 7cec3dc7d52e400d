//! Step 3: the profiles, the arcs found in them, and the radius against the step.

pub mod curve;
mod list;
pub mod model;
mod panel;
pub mod profile;
mod scan;
pub mod spread;
mod strip;

pub use panel::{ArcsState, show};
