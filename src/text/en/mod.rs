//! English.

pub mod methods;
pub mod poses;
pub mod shell;
pub mod start;
pub mod warnings;
