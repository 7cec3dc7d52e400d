//! Words of the Report step, and of files that are saved from the window.

/// Rail step.
pub const STEP: &str = "Report";
/// What the rail's step does.
pub const STEP_HINT: &str = "The report, and the calibration for a controller, ROS or a program";
/// Section.
pub const TOOL_FRAME: &str = "Tool frame";
/// What the section shows.
pub const TOOL_FRAME_HINT: &str = "The calibration as text for a controller, ROS or a program";
/// Section.
pub const REPORT: &str = "Report";
/// What the section shows.
pub const REPORT_HINT: &str = "All that is known of the session as a page, to be printed, signed and archived";
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

/// What to do where there is nothing to report.
pub const NOTHING_TO_REPORT: &str =
    "There is nothing to report yet. Add stations under Poses or Capture; the report then follows by itself.";
/// While it is made.
pub const GATHERING: &str = "Gathering the report …";
/// After a cancel.
pub const NOT_GATHERED: &str = "The report was not made.";
/// Button.
pub const GATHER: &str = "Make the report";
/// Heading of what the report holds.
pub const SECTIONS: &str = "Sections";
/// Label of a field.
pub const OPERATOR: &str = "Operator";
/// Label of a field.
pub const PLACE: &str = "Place";
/// Label of a field.
pub const DATE: &str = "Date";
/// Label of a field.
pub const REMARKS: &str = "Remarks";
/// In the field of the date: a report holds no clock.
pub const DATE_HINT: &str = "as it is to stand there";
/// Button.
pub const SAVE_REPORT: &str = "Save report…";
/// What the button does.
pub const SAVE_REPORT_HINT: &str =
    "Writes into a folder: the page (HTML), Markdown, a CSV file a table, the result file, figures and tool frames";
/// While it is written.
pub const WRITING: &str = "Writing the report …";
/// Heading of the question for the folder.
pub const REPORT_FOLDER_TITLE: &str = "Folder for the report";
/// Button.
pub const COPY_PATH: &str = "Copy path";
/// Button.
pub const OPEN_IN_BROWSER: &str = "Open in browser";
/// Name of the picture of the page for screen readers.
pub const PREVIEW: &str = "Preview of the report";
/// Where no section is chosen.
pub const NO_SECTIONS: &str = "Choose at least one section at the left.";

/// The report was written.
#[must_use]
pub fn wrote_report(num_files: usize, folder: &str) -> String {
    format!("Wrote the report, {num_files} files, into {folder}")
}

/// How far the gathering is.
#[must_use]
pub fn gathering_progress(done: usize, total: usize) -> String {
    if total == 0 { GATHERING.to_owned() } else { format!("Gathering the report, {done} of {total}") }
}
/// Before the path of the page that was written last.
pub const WRITTEN_TO: &str = "Written to";
