//! What leaves the program besides sessions: result files, and numbers with as many digits as are true.

mod diagnosis_entry;
pub mod result_file;

pub use crate::text::digits;
