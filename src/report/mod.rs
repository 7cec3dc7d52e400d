//! What leaves the program besides sessions: result files, and numbers with as many digits as are true. A result file is
//! also where a calibration is read from.

pub mod calibration_file;
mod diagnosis_entry;
pub mod result_file;
pub mod result_history;
pub mod scan_file;
pub mod tool_frame;
pub mod verification_file;

pub use crate::text::digits;
