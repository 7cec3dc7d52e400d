//! English.

pub mod methods;
pub mod warnings;
