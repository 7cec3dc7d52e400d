//! What leaves the program besides sessions: result files, and numbers with as many digits as are true. A result file is
//! also where a calibration is read from.

mod best_solution;
pub mod calibration_file;
pub mod checksum;
pub mod compare;
pub mod comparison;
pub mod csv_tables;
mod diagnosis_entry;
pub mod diagnosis_lines;
pub mod document;
pub mod evidence;
pub mod figure;
pub mod files;
pub mod html;
pub mod judgement;
pub mod markdown;
pub mod odometry_file;
pub mod open;
pub mod pdf;
pub mod result_file;
pub mod result_history;
pub mod scan_file;
pub mod tool_frame;
pub mod verification;
pub mod verification_file;

pub use crate::text::digits;
pub use best_solution::best_solution;
