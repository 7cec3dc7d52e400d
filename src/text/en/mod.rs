//! English.

pub mod check;
pub mod methods;
pub mod warnings;
