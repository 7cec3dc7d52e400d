//! The inspector at the right: the selected capture, the chosen method's calibration, and what to know about it.

pub mod findings;
pub mod model;
pub mod panel;
