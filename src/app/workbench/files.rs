//! The way between files and the bench.

use std::path::PathBuf;
use std::sync::Arc;

use crate::session::{self, Session, SessionError};

use super::{Document, NoticeKind, Workbench};

/// A session on its way to a file: taken when it was asked for, whatever happens on the bench meanwhile.
#[derive(Clone, Debug)]
pub(super) struct Save {
    document_id: u64,
    session: Arc<Session>,
    path: PathBuf,
}

#[derive(Debug)]
pub(super) struct Loaded {
    pub path: Option<PathBuf>,
    pub session: Result<Session, SessionError>,
}

impl Workbench {
    /// What was edited while the file was being read is not thrown away.
    pub(super) fn take_loaded(&mut self, session: Session, path: Option<PathBuf>) {
        let revision = self.document.as_ref().map(|document| document.revision);
        let is_edited = self.document.as_ref().is_some_and(Document::is_unsaved);
        if is_edited && revision != self.revision_before_loading {
            self.notify_of_opening(format!(
                    "\"{}\" was not opened: the session on the bench was edited while it was read. Save it, then open again",
                    session.name
            ));
        } else {
            self.open_session(session, path);
        }
    }

    /// Puts a session on the bench that no file holds yet, and solves it.
    pub fn open_unsaved_session(&mut self, session: Session) {
        self.open_session(session, None);
        if let Some(document) = &mut self.document {
            document.mark_as_never_saved();
        }
    }

    pub(super) fn start_loading(&mut self, path: PathBuf) {
        self.revision_before_loading = self.document.as_ref().map(|document| document.revision);
        self.loading.start("load session", &self.wake, move |_| {
            let session = session::load(&path);
            Loaded { path: Some(path), session }
        });
    }

    pub(super) fn open_sample(&mut self, sample_idx: usize) {
        let Some(sample) = session::samples::ALL.get(sample_idx) else {
            self.notify_of_opening(format!("there is no sample session number {sample_idx}"));
            return;
        };
        self.revision_before_loading = self.document.as_ref().map(|document| document.revision);
        self.loading.start("load sample", &self.wake, move |_| Loaded {
            path: None,
            session: session::parse(sample.json.as_bytes(), sample.file_name),
        });
    }

    pub(super) fn close_document(&mut self) {
        self.loading.cancel();
        self.solving.cancel();
        self.document = None;
        self.forget_results();
    }

    pub(super) fn save(&mut self) {
        match self.document.as_ref().map(|document| document.path.clone()) {
            Some(Some(path)) => self.start_saving(path),
            Some(None) => {
                self.notify(NoticeKind::Error, "this session has no file yet: choose one with \"Save as…\"".to_owned());
            }
            None => self.notify(NoticeKind::Error, "there is no open session to save".to_owned()),
        }
    }

    pub(super) fn start_saving(&mut self, path: PathBuf) {
        let Some(document) = &self.document else {
            self.notify(NoticeKind::Error, "there is no open session to save".to_owned());
            return;
        };
        let save = Save { document_id: document.id, session: Arc::clone(&document.session), path };
        if self.saving.is_running() {
            // A save is never dropped; the next one starts when this one has ended.
            self.save_queue.push_back(save);
        } else {
            self.run_save(save);
        }
    }

    pub(super) fn run_save(&mut self, save: Save) {
        self.saving.start("save session", &self.wake, move |_| {
            let outcome = session::save(&save.session, &save.path);
            (save, outcome)
        });
    }

    pub(super) fn note_saved(&mut self, save: Save) {
        self.forget_errors();
        self.notify(NoticeKind::Done, format!("saved to {}", save.path.display()));
        // Another document may be on the bench by now; its file is another.
        if let Some(document) = self.document.as_mut().filter(|document| document.id == save.document_id) {
            document.saved = Some(save.session);
            document.path = Some(save.path);
        }
    }

    pub(super) fn save_anyway(&mut self) {
        self.save();
    }

    pub(super) fn reload(&mut self) {
        if let Some(path) = self.document.as_ref().and_then(|document| document.path.clone()) {
            self.start_loading(path);
        }
    }

    pub(super) fn recover(&mut self, _idx: usize) {}

    pub(super) fn discard_recoverable(&mut self, _idx: usize) {}
}
