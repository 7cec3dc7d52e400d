//! The report: what it is made of is gathered in the background, and so it is written.

use std::path::PathBuf;
use std::sync::Arc;

use crate::app;
use crate::app::jobs::JobOutcome;
use crate::report::document::{Document, InputFile, Options, document};
use crate::report::evidence::Evidence;
use crate::report::files::{HTML, report_files, write_files};
use crate::session;
use crate::text::report_panel as words;

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
        let file = open.path.clone().filter(|_| !open.is_unsaved());
        let title = open.title();
        self.report.start("gather report", &self.wake, revision, move |watch| {
            let evidence = Evidence::gather(&session, &given, watch)?;
            // What is on the disk is what was read; what is not saved is told as it would be saved.
            let bytes = file.and_then(|path| std::fs::read(path).ok());
            let bytes = bytes.unwrap_or_else(|| session::to_json(&session).into_bytes());
            let inputs = vec![InputFile::new(title, &bytes)];
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
