//! The files of a report, and the folder that they are written into.

use std::io::{Cursor, Write as _};
use std::path::{Path, PathBuf};

use image::ImageFormat;
use thiserror::Error;

use crate::whole_file;

use super::csv_tables::csv_table;
use super::document::{Document, exports};
use super::evidence::Evidence;
use super::figure::{Figure, FigureError};
use super::html::html;
use super::markdown::markdown;
use super::result_file::result_file;

/// The report itself.
pub const HTML: &str = "report.html";
/// The same as Markdown.
pub const MARKDOWN: &str = "report.md";
/// The result file, as `solve --json` prints it.
pub const RESULT: &str = "result.json";
/// The folder of the tables.
pub const TABLES: &str = "tables";
/// The folder of the figures.
pub const FIGURES: &str = "figures";
/// Pixels of a figure for programs that take no SVG: 144 an inch.
const PIXELS_PER_POINT: f64 = 2.0;

/// A file of a report.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReportFile {
    /// Its place below the report's folder, with forward slashes.
    pub path: String,
    /// What is in it.
    pub bytes: Vec<u8>,
}

/// Why a report was not written, or not all of it.
#[derive(Debug, Error)]
pub enum ReportError {
    /// The operating system did not let us make the folder.
    #[error("cannot make the folder {}: {problem}", folder.display())]
    NoFolder {
        /// The folder.
        folder: PathBuf,
        /// The operating system's words.
        problem: std::io::Error,
    },
    /// The operating system did not let us write a file.
    #[error("cannot write {}: {problem}", file.display())]
    Unwritable {
        /// The file.
        file: PathBuf,
        /// The operating system's words.
        problem: std::io::Error,
    },
}

/// Every file of a report: the page, the same as Markdown, the tables, the result file and the texts for the controller.
/// Which tables there are follows from the document's sections.
///
/// # Errors
/// [`FigureError`] if a figure cannot be drawn.
pub fn report_files(document: &Document, evidence: &Evidence) -> Result<Vec<ReportFile>, FigureError> {
    let file = |path: String, text: String| ReportFile { path, bytes: text.into_bytes() };
    let mut files = vec![
        file(HTML.to_owned(), html(document)?),
        file(MARKDOWN.to_owned(), markdown(document)),
        file(RESULT.to_owned(), result(evidence)),
    ];
    files.extend(document.tables().map(|table| file(format!("{TABLES}/{}.csv", table.id), csv_table(table))));
    for figure in document.figures() {
        files.push(file(figure_path(figure, "svg"), figure.svg()?));
        files.push(ReportFile { path: figure_path(figure, "png"), bytes: png(figure)? });
    }
    files.extend(exports(evidence).into_iter().map(|export| file(export.path, export.text)));
    Ok(files)
}

/// Where a figure's file is, below the report's folder.
pub(super) fn figure_path(figure: &Figure, extension: &str) -> String {
    format!("{FIGURES}/{}.{extension}", figure.id)
}

fn png(figure: &Figure) -> Result<Vec<u8>, FigureError> {
    let mut bytes = Vec::new();
    figure
        .png(PIXELS_PER_POINT)?
        .write_to(&mut Cursor::new(&mut bytes), ImageFormat::Png)
        .map_err(|error| FigureError::NotDrawn { reason: error.to_string() })?;
    Ok(bytes)
}

/// What `solve --json` prints of the target whose calibration is the answer, as if it were the session's only one; of the
/// session's own where there is no answer.
fn result(evidence: &Evidence) -> String {
    let target = evidence.answer().map(|(target, _)| target).or(evidence.targets.first());
    let solved = target.and_then(|target| target.outcome.as_ref().ok());
    let session = target.map_or(&evidence.session, |target| &target.session);
    let results = solved.map_or(&[][..], |solved| &solved.results);
    let examination = solved.map(|solved| solved.examined.examination());
    format!("{:#}\n", result_file(session, results, examination.as_ref()))
}

/// Writes the files into a folder, which is made where it is missing. Each is replaced in one step or not at all; other files
/// there are left alone. Gives the files that were written.
///
/// # Errors
/// [`ReportError`]; the files before the one that it names are written.
pub fn write_files(files: &[ReportFile], folder: &Path) -> Result<Vec<PathBuf>, ReportError> {
    let mut written = Vec::with_capacity(files.len());
    for file in files {
        let path = folder.join(&file.path);
        if let Some(parent) = path.parent() {
            std::fs::create_dir_all(parent)
                .map_err(|problem| ReportError::NoFolder { folder: parent.to_path_buf(), problem })?;
        }
        whole_file::replace(&path, |opened| opened.write_all(&file.bytes))
            .map_err(|problem: std::io::Error| ReportError::Unwritable { file: path.clone(), problem })?;
        written.push(path);
    }
    Ok(written)
}
