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

/// Menu entry, followed by the plots in sight.
pub const PICTURES: &str = "Picture of";
/// Why the entry is not to be had.
pub const NO_PICTURES: &str = "No plot is in sight.";
/// Menu entry of a plot.
pub const SAVE_PNG: &str = "Save as PNG…";
/// Menu entry of a plot.
pub const SAVE_SVG: &str = "Save as SVG…";
/// Menu entry of a plot.
pub const COPY_PICTURE: &str = "Copy picture";
/// Heading of the question for the file.
pub const PICTURE_TITLE: &str = "File for the picture";
/// Notice.
pub const COPIED_PICTURE: &str = "Picture copied";
/// Notice: a bug, or no memory.
pub const NO_PICTURE: &str = "The picture could not be drawn. Your session is unchanged.";
/// Notice.
pub const COPIED_TEXT: &str = "Text copied";
