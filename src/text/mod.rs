//! All wording that a person reads, in one place a language, so that a second language is a second folder.
//!
//! Errors carry their own sentence (their `Display`): they are the same in the window and on the command line.

pub mod digits;
mod en;
pub mod typeset;

pub use en::*;
