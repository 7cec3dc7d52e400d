//! Step Compare.

pub mod panel;
