//! English.

pub mod arcs;
pub mod capture;
pub mod capture_edges;
pub mod capture_settings;
pub mod cell;
pub mod check;
pub mod cli;
pub mod compare;
pub mod compare_results;
pub mod conventions;
pub mod diagnosis;
pub mod diagnosis_panel;
pub mod document;
pub mod edges;
pub mod edits;
pub mod figures;
pub mod import;
pub mod import_bag;
pub mod import_cli;
pub mod methods;
pub mod odometry;
pub mod poses;
pub mod report;
pub mod report_cli;
pub mod report_panel;
pub mod sequence;
pub mod shell;
pub mod start;
pub mod tool_frame;
pub mod verify;
pub mod warnings;
pub mod workpiece;

pub use check::*;
pub use cli::*;
pub use methods::*;
pub use warnings::*;

/// The ending of a plural.
const fn plural(count: usize) -> &'static str {
    if count == 1 { "" } else { "s" }
}
