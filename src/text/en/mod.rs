//! English.

pub mod arcs;
pub mod methods;
pub mod warnings;
