//! What `handeye report` prints.

/// A file was written.
#[must_use]
pub fn wrote(file: &str) -> String {
    format!("wrote {file}\n")
}

/// A name that no section has.
#[must_use]
pub fn no_such_section(ids: &[&str]) -> String {
    format!("expected one of: {}", ids.join(", "))
}

/// The report says why there is nothing in it.
#[must_use]
pub fn report_without_calibration(reason: &str) -> String {
    format!("nothing could be computed, and the report says so: {reason}")
}

/// The page was not printed.
#[must_use]
pub fn no_pdf(reason: &str) -> String {
    format!("no PDF: {reason}\n")
}
