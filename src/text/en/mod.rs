//! English.

pub mod arcs;
pub mod check;
pub mod cli;
pub mod compare;
pub mod methods;
pub mod poses;
pub mod shell;
pub mod start;
pub mod warnings;

pub use check::*;
pub use cli::*;
pub use methods::*;
pub use warnings::*;
