//! The files of a report, and the folder that they are written into.

use std::collections::BTreeMap;
use std::io::{Cursor, ErrorKind, Write as _};
use std::num::NonZero;
use std::path::{Component, Path, PathBuf};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use image::ImageFormat;
use thiserror::Error;

use crate::whole_file;

use super::checksum::sha256;
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
/// What a report consists of: a line a file, as `sha256sum` prints and checks them.
pub const SUMS: &str = "report.sha256";
/// The page as a browser prints it.
pub const PDF: &str = "report.pdf";
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
    /// There is something else in the folder's place.
    #[error("{} is a file, and a report needs a folder; give one that is missing or that a report was written to", folder.display())]
    NotAFolder {
        /// Its place.
        folder: PathBuf,
    },
    /// The operating system did not let us make the folder.
    #[error("cannot make the folder {}: {problem}", folder.display())]
    NoFolder {
        /// The folder.
        folder: PathBuf,
        /// The operating system's words.
        problem: std::io::Error,
    },
    /// There is a file that no report has written.
    #[error(
        "{} is there already, and no report has written it; choose another folder, or move it away",
        file.display()
    )]
    Foreign {
        /// The file.
        file: PathBuf,
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
    files.extend(drawn(&document.figures().collect::<Vec<_>>())?);
    files.extend(exports(evidence).into_iter().map(|export| file(export.path, export.text)));
    Ok(files)
}

/// Every figure as SVG and PNG, in order. Pixels take most of a report's time, so each processor draws a part of them.
fn drawn(figures: &[&Figure]) -> Result<Vec<ReportFile>, FigureError> {
    let draw = |figure: &Figure| -> Result<[ReportFile; 2], FigureError> {
        let svg = ReportFile { path: figure_path(figure, "svg"), bytes: figure.svg()?.into_bytes() };
        Ok([svg, ReportFile { path: figure_path(figure, "png"), bytes: png(figure)? }])
    };
    let slots: Vec<OnceLock<Result<[ReportFile; 2], FigureError>>> = figures.iter().map(|_| OnceLock::new()).collect();
    let next = AtomicUsize::new(0);
    let work = || {
        while let Some((figure, slot)) = {
            let idx = next.fetch_add(1, Ordering::Relaxed);
            figures.get(idx).zip(slots.get(idx))
        } {
            slot.get_or_init(|| draw(figure));
        }
    };
    let num_threads = thread::available_parallelism().map_or(1, NonZero::get).min(figures.len());
    thread::scope(|scope| {
        for _ in 1..num_threads {
            // Where no thread is to be had, this one draws everything.
            let _ = thread::Builder::new().spawn_scoped(scope, work);
        }
        work();
    });
    let mut files = Vec::with_capacity(2 * figures.len());
    for drawn in slots.into_iter().filter_map(OnceLock::into_inner) {
        files.extend(drawn?);
    }
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

/// Writes the files into a folder, which is made where it is missing, and a list of them with their checksums. Each is replaced
/// in one step or not at all. What an earlier report has written there and this one does not is removed, unless somebody has
/// changed it since; a file of anybody else's is never replaced. Gives the files that were written.
///
/// # Errors
/// [`ReportError`]. After [`ReportError::Foreign`] and [`ReportError::NotAFolder`] nothing is written, after another the files before the one that it names.
pub fn write_files(files: &[ReportFile], folder: &Path) -> Result<Vec<PathBuf>, ReportError> {
    if folder.exists() && !folder.is_dir() {
        return Err(ReportError::NotAFolder { folder: folder.to_path_buf() });
    }
    let earlier = earlier_files(&folder.join(SUMS));
    let foreign = files.iter().find(|file| !earlier.contains_key(&file.path) && folder.join(&file.path).exists());
    if let Some(file) = foreign {
        return Err(ReportError::Foreign { file: folder.join(&file.path) });
    }
    let mut written = Vec::with_capacity(files.len() + 1);
    for file in files {
        written.push(write_file(&folder.join(&file.path), &file.bytes)?);
    }
    let sums: Vec<String> = files.iter().map(|file| format!("{}  {}\n", sha256(&file.bytes), file.path)).collect();
    written.push(write_file(&folder.join(SUMS), sums.concat().as_bytes())?);
    let is_of_now = |path: &str| files.iter().any(|file| file.path == path);
    for (path, sum) in earlier.iter().filter(|(path, _)| !is_of_now(path)) {
        let path = folder.join(path);
        if std::fs::read(&path).is_ok_and(|bytes| sha256(&bytes) == *sum) {
            remove(&path)?;
        }
    }
    // No two prints have the same bytes, but a page that was printed from another report must not stay beside this one.
    if !earlier.is_empty() {
        remove(&folder.join(PDF))?;
    }
    Ok(written)
}

fn write_file(path: &Path, bytes: &[u8]) -> Result<PathBuf, ReportError> {
    if let Some(parent) = path.parent() {
        std::fs::create_dir_all(parent)
            .map_err(|problem| ReportError::NoFolder { folder: parent.to_path_buf(), problem })?;
    }
    whole_file::replace(path, |opened| opened.write_all(bytes))
        .map_err(|problem: std::io::Error| ReportError::Unwritable { file: path.to_path_buf(), problem })?;
    Ok(path.to_path_buf())
}

fn remove(path: &Path) -> Result<(), ReportError> {
    match std::fs::remove_file(path) {
        Err(problem) if problem.kind() != ErrorKind::NotFound => {
            Err(ReportError::Unwritable { file: path.to_path_buf(), problem })
        }
        _ => Ok(()),
    }
}

/// The files that an earlier report has listed with their checksums; none without such a list. Places outside of the folder
/// are not ours.
fn earlier_files(sums: &Path) -> BTreeMap<String, String> {
    let text = std::fs::read_to_string(sums).unwrap_or_default();
    let entry = |line: &str| {
        let (sum, path) = line.split_once("  ")?;
        let is_below = Path::new(path).components().all(|part| matches!(part, Component::Normal(_)));
        is_below.then(|| (path.to_owned(), sum.to_owned()))
    };
    text.lines().filter_map(entry).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(path: &str, text: &str) -> ReportFile {
        ReportFile { path: path.to_owned(), bytes: text.as_bytes().to_vec() }
    }

    #[test]
    fn a_later_report_replaces_the_earlier_one_and_nothing_else() {
        let folder = tempfile::tempdir().expect("a folder");
        let place = |path: &str| folder.path().join(path);
        write_files(&[file(RESULT, "1"), file("tables/a.csv", "a"), file("tables/b.csv", "b")], folder.path())
            .expect("written");
        std::fs::write(place("tables/b.csv"), "noted by hand").expect("written");
        std::fs::write(place("mine.txt"), "mine").expect("written");
        std::fs::write(place(PDF), "printed").expect("written");
        write_files(&[file(RESULT, "2")], folder.path()).expect("written");
        assert_eq!(std::fs::read_to_string(place(RESULT)).expect("there"), "2");
        assert!(!place("tables/a.csv").exists() && !place(PDF).exists());
        assert!(place("tables/b.csv").exists() && place("mine.txt").exists());
    }

    #[test]
    fn a_file_in_the_place_of_the_folder_is_named() {
        let folder = tempfile::tempdir().expect("a folder");
        let place = folder.path().join("out");
        std::fs::write(&place, "mine").expect("written");
        let refused = write_files(&[file(RESULT, "1")], &place).expect_err("it is a file");
        assert!(refused.to_string().contains("out is a file, and a report needs a folder"), "{refused}");
    }

    #[test]
    fn what_no_report_has_written_is_never_replaced() {
        let folder = tempfile::tempdir().expect("a folder");
        let session = folder.path().join(RESULT);
        std::fs::write(&session, "a session of that name").expect("written");
        let refused = write_files(&[file("tables/a.csv", "a"), file(RESULT, "1")], folder.path());
        assert!(matches!(refused, Err(ReportError::Foreign { file }) if file == session));
        assert_eq!(std::fs::read_to_string(&session).expect("there"), "a session of that name");
        assert!(!folder.path().join("tables").exists());
    }
}
