//! English.

pub mod arcs;
pub mod check;
pub mod compare;
pub mod methods;
pub mod warnings;

pub use methods::*;
pub use warnings::*;
