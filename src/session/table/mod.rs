//! The session as a spreadsheet: columns, the text of cells, and typed text back to values.

pub mod number;

pub use number::{NotANumber, parse_number};
