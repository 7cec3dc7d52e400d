//! The Verify step: what a calibration is worth on other data than its own.

mod compare_results;
mod cross_target;
mod distances;
mod histogram;
mod marks;
mod matrices;
mod panel;
mod result_history;
mod space;
mod stability;
mod workpiece;

pub use panel::{Section, VerifyState, show};
