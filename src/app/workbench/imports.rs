//! Imports on their way to the bench.

use std::path::PathBuf;
use std::sync::Arc;

use crate::app::ImportInto;
use crate::app::jobs::{JobOutcome, Slot};
use crate::session::Edit;
use crate::session::import::{self, ImportError, ImportOptions, Imported, Source};
use crate::text::edits::import_label;
use crate::text::import as words;

use super::{NoticeKind, Progress, Workbench};

/// An import that the user looks at before it is made.
#[derive(Clone, Debug)]
pub struct ImportDraft {
    /// Tells this draft from those before.
    pub id: u64,
    /// What was read from disk or pasted; empty while the files are being read.
    pub sources: Arc<Vec<Source>>,
    /// What the user has set.
    pub options: ImportOptions,
    /// What came of it last; `None` until something has come. See [`Workbench::is_reading_import`].
    pub outcome: Option<Result<Arc<Imported>, ImportError>>,
}

/// The draft and what is being read for it.
#[derive(Debug, Default)]
pub(super) struct Imports {
    draft: Option<ImportDraft>,
    last_id: u64,
    files: Slot<Result<Vec<Source>, ImportError>>,
    reading: Slot<Result<Imported, ImportError>>,
}

impl Imports {
    pub const fn is_busy(&self) -> bool {
        self.files.is_running() || self.reading.is_running()
    }

    fn begin(&mut self, sources: Vec<Source>) {
        self.end();
        self.last_id += 1;
        let options = ImportOptions::default();
        self.draft = Some(ImportDraft { id: self.last_id, sources: Arc::new(sources), options, outcome: None });
    }

    fn end(&mut self) {
        self.files.cancel();
        self.reading.cancel();
        self.draft = None;
    }
}

impl Workbench {
    /// The preview of an import, while one is open.
    #[must_use]
    pub const fn import(&self) -> Option<&ImportDraft> {
        self.imports.draft.as_ref()
    }

    /// Whether files are being read for the preview, or read in another way: what it shows is not the last word then.
    #[must_use]
    pub const fn is_reading_import(&self) -> bool {
        self.imports.is_busy()
    }

    /// Progress of that.
    #[must_use]
    pub fn import_progress(&self) -> Option<Progress> {
        self.imports.reading.progress().map(|(done, total)| Progress { done, total })
    }

    pub(super) fn start_import(&mut self, paths: Vec<PathBuf>) {
        self.forget_errors();
        self.imports.begin(Vec::new());
        self.imports.files.start("read import", &self.wake, move |_| import::read_paths(&paths));
    }

    pub(super) fn start_import_of_text(&mut self, text: String) {
        self.forget_errors();
        self.imports.begin(vec![Source::from_text(words::PASTED, text)]);
        self.read_import();
    }

    pub(super) fn set_import_options(&mut self, options: ImportOptions) {
        let Some(draft) = &mut self.imports.draft else { return };
        draft.options = options;
        if !self.imports.files.is_running() {
            self.read_import();
        }
    }

    /// Reads the draft's sources as its options say; of poses that nothing is known of it is assumed that they are
    /// written as those on the bench.
    fn read_import(&mut self) {
        let Some(draft) = &self.imports.draft else { return };
        let (sources, options) = (Arc::clone(&draft.sources), draft.options.clone());
        let notation = self.document.as_ref().map(|document| document.session.robot.notation).unwrap_or_default();
        self.imports
            .reading
            .start("preview import", &self.wake, move |watch| import::read(&sources, &options, &notation, watch));
    }

    pub(super) fn poll_imports(&mut self) -> bool {
        let files = self.imports.files.poll();
        let reading = self.imports.reading.poll();
        let changed = files.is_some() || reading.is_some();
        match files {
            Some(JobOutcome::Done(Ok(sources))) => {
                if let Some(draft) = &mut self.imports.draft {
                    draft.sources = Arc::new(sources);
                }
                self.read_import();
            }
            // There is nothing to look at, so it is told where the file was chosen.
            Some(JobOutcome::Done(Err(error))) => {
                self.imports.end();
                self.notify_of_opening(error.to_string());
            }
            Some(broken) => self.give_import_up(&broken),
            None => {}
        }
        match reading {
            Some(JobOutcome::Done(outcome)) => {
                if let Some(draft) = &mut self.imports.draft {
                    draft.outcome = Some(outcome.map(Arc::new));
                }
            }
            Some(broken) => self.give_import_up(&broken),
            None => {}
        }
        changed
    }

    fn give_import_up<T>(&mut self, broken: &JobOutcome<T>) {
        self.imports.end();
        self.notify_broken("reading the import", broken);
    }

    /// What the preview shows goes where the user wants it; not while it is being read anew.
    pub(super) fn finish_import(&mut self, into: ImportInto) {
        if self.imports.is_busy() {
            return;
        }
        let Some(ImportDraft { outcome: Some(Ok(imported)), sources, .. }) = &self.imports.draft else { return };
        let (imported, name) = (Arc::clone(imported), words::sources_name(sources));
        match into {
            ImportInto::NewSession { name, target } => {
                // The preview stays if there can be no such session.
                match Arc::unwrap_or_clone(imported).into_session(name, target) {
                    Ok(session) => {
                        self.imports.end();
                        self.open_unsaved_session(session);
                    }
                    Err(refusal) => self.notify(NoticeKind::Error, refusal.to_string()),
                }
            }
            ImportInto::OpenSession => self.add_stations(&imported, &name),
        }
    }

    /// The preview stays if the session refuses them.
    fn add_stations(&mut self, imported: &Imported, name: &str) {
        let Some(document) = &self.document else { return };
        let stations = imported.stations.clone();
        if let Err(refusal) = import::check_edges(&stations, &document.session.target) {
            self.notify(NoticeKind::Error, refusal.to_string());
            return;
        }
        let label = import_label(stations.len(), name);
        let edit = Edit::InsertStations { at: document.session.stations.len(), stations };
        if self.edit_as(&edit, None, label) {
            self.imports.end();
        }
    }

    pub(super) fn cancel_import(&mut self) {
        self.imports.end();
    }
}
