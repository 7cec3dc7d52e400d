//! The report: what it is made of is gathered in the background, and so it is written.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::app;
use crate::app::jobs::JobOutcome;
use crate::report::document::{Document, InputFile, Options, document};
use crate::report::evidence::Evidence;
use crate::report::files::{HTML, report_files, write_files};
use crate::report::open::open;
use crate::session::{self, format::Stamp, measure};
use crate::text::report as text;
use crate::text::report_panel as words;
use crate::verify::{Calibration, Origin};

use super::{NoticeKind, Workbench};

/// All that a report is made of.
#[derive(Clone, Debug)]
pub struct Gathered {
    /// What was computed.
    pub evidence: Evidence,
    /// The session, as it stands in its file or would stand there.
    pub inputs: Vec<InputFile>,
    /// The whole report, without an operator's words.
    pub document: Document,
}

impl Gathered {
    /// The report with these sections and names.
    #[must_use]
    pub fn document_with(&self, options: &Options) -> Document {
        document(&self.evidence, &self.inputs, options)
    }
}

/// What has become of a file since it was read.
fn since(path: &Path, stamp: &Stamp) -> Option<&'static str> {
    match Stamp::of(path) {
        Ok(now) if now.has_contents_of(stamp) => None,
        Ok(_) => Some(text::CHANGED_SINCE),
        Err(_) => Some(text::GONE_SINCE),
    }
}

/// A calibration that came without a file.
fn pasted(calibration: &Calibration) -> InputFile {
    let name = match &calibration.origin {
        Origin::Given { name, .. } => name.clone(),
        Origin::Solved { .. } | Origin::Joint { .. } => String::new(),
    };
    let matrix = calibration.flange_from_sensor.matrix();
    let rows: [[f64; 4]; 4] = [0, 1, 2, 3].map(|row| [0, 1, 2, 3].map(|column| matrix[(row, column)]));
    InputFile::new(name, serde_json::json!(rows).to_string().as_bytes()).with_remark(Some(text::PASTED))
}

/// What came of writing: the page to be opened and the number of files beside it, or why not.
pub(super) type Reported = Result<(PathBuf, usize), String>;

impl Workbench {
    /// The page of the report that was written last for this document.
    #[must_use]
    pub fn written_report(&self) -> Option<&std::path::Path> {
        self.written_report.as_deref()
    }

    /// Whether a report is being written.
    #[must_use]
    pub const fn is_writing_report(&self) -> bool {
        self.reporting.is_running()
    }

    pub(super) fn gather_report(&mut self) {
        let Some(open) = &self.document else { return };
        let (session, revision, given) = (Arc::clone(&open.session), open.revision, self.given.clone());
        let file = open.path.clone().zip(open.stamp).filter(|_| !open.is_unsaved());
        let title = open.title();
        let known = self.known_readings();
        self.report.start("gather report", &self.wake, revision, move |watch| {
            let measured = measure(&session, known.as_deref(), watch)?;
            let evidence = Evidence::gather(&session, &measured, &given, watch)?;
            let of_session = match file {
                Some((path, stamp)) => InputFile::stamped(title, &stamp).with_remark(since(&path, &stamp)),
                None => InputFile::new(title, session::to_json(&session).as_bytes()).with_remark(Some(text::NOT_SAVED)),
            };
            let inputs: Vec<InputFile> = std::iter::once(of_session).chain(given.iter().map(pasted)).collect();
            let document = document(&evidence, &inputs, &Options::default());
            Ok(Arc::new(Gathered { evidence, inputs, document }))
        });
    }

    /// Writes what is shown, in place of an earlier report in the folder.
    pub(super) fn write_report(&mut self, folder: PathBuf, options: Options) {
        let Some(found) = self.report.last() else { return };
        let gathered = Arc::clone(&found.value);
        let of_document = self.document.as_ref().map(app::Document::id);
        self.reporting.start("write report", &self.wake, move |_| {
            let files = report_files(&gathered.document_with(&options), &gathered.evidence);
            let written = files
                .map_err(|error| error.to_string())
                .and_then(|files| write_files(&files, &folder).map_err(|error| error.to_string()));
            (of_document, written.map(|paths| (folder.join(HTML), paths.len())))
        });
    }

    /// Opens the page that was written last.
    pub(super) fn open_report(&mut self) {
        let Some(page) = self.written_report.clone() else { return };
        self.opening.start("open report", &self.wake, move |_| open(&page));
    }

    pub(super) fn poll_opening(&mut self) -> bool {
        let Some(outcome) = self.opening.poll() else { return false };
        match outcome {
            // The browser shows it.
            JobOutcome::Done(Ok(())) => {}
            JobOutcome::Done(Err(error)) => self.notify(NoticeKind::Error, error.to_string()),
            broken => self.notify_broken("opening the report", &broken),
        }
        true
    }

    pub(super) fn poll_report(&mut self) -> bool {
        let Some(outcome) = self.reporting.poll() else { return false };
        match outcome {
            JobOutcome::Done((of_document, Ok((page, num_files)))) => {
                let folder = page.parent().unwrap_or(&page).display().to_string();
                self.notify(NoticeKind::Done, words::wrote_report(num_files, &folder));
                if of_document == self.document.as_ref().map(app::Document::id) {
                    self.written_report = Some(page);
                }
            }
            JobOutcome::Done((_, Err(reason))) => self.notify(NoticeKind::Error, reason),
            broken => self.notify_broken("writing the report", &broken),
        }
        true
    }
}
