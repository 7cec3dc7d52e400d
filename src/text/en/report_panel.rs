//! Words of the Report step, and of files that are saved from the window.

/// Rail step.
pub const STEP: &str = "Report";
/// What the rail's step does.
pub const STEP_HINT: &str = "The report, and the calibration for a controller, ROS or a program";
/// Section.
pub const TOOL_FRAME: &str = "Tool frame";
/// What the section shows.
pub const TOOL_FRAME_HINT: &str = "The calibration as text for a controller, ROS or a program";
/// Beside the tabs, where the results belong to an earlier state of the session.
pub const OUT_OF_DATE: &str = "! out of date: the session has changed since";
/// Button that leads here.
pub const NEXT_REPORT: &str = "See the report";

/// A file was written.
#[must_use]
pub fn wrote(file: &str) -> String {
    format!("Wrote {file}")
}
