//! Step Arcs.

pub mod panel;
