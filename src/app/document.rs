//! The open session with its file and its history.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::session::{History, Session};

/// The open session.
#[derive(Clone, Debug)]
pub struct Document {
    /// Tells this document from those opened before.
    pub(super) id: u64,
    /// The session as it is now.
    pub session: Arc<Session>,
    /// Its file; `None` for a sample or a new session.
    pub path: Option<PathBuf>,
    /// Counts the edits; results know the revision they belong to.
    pub revision: u64,
    /// What can be undone.
    pub history: History,
    /// As a file or sample has it; `None` if none does.
    pub(super) saved: Option<Arc<Session>>,
}

impl Document {
    pub(super) fn new(session: Session, path: Option<PathBuf>, revision: u64) -> Self {
        let session = Arc::new(session);
        // Revisions are never used twice, so the first is as good a name as any.
        Self { id: revision, saved: Some(Arc::clone(&session)), session, path, revision, history: History::default() }
    }

    /// Whether there is something that no file holds.
    #[must_use]
    pub fn is_unsaved(&self) -> bool {
        self.saved.as_ref().is_none_or(|saved| !Arc::ptr_eq(&self.session, saved) && self.session != *saved)
    }

    /// No file holds anything of it, not even as it was when it came onto the bench.
    pub(super) fn mark_as_never_saved(&mut self) {
        self.saved = None;
    }

    /// The file's name, or the session's.
    #[must_use]
    pub fn title(&self) -> String {
        self.path
            .as_deref()
            .and_then(Path::file_name)
            .map_or_else(|| self.session.name.clone(), |name| name.to_string_lossy().into_owned())
    }
}
