//! The open session with its file and its history.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::session::format::Stamp;
use crate::session::{History, Session};
use crate::text::document::UNTITLED;

/// How the file of the open session is, as far as is known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OnDisk {
    /// As it was read or written last, or there is none.
    #[default]
    Same,
    /// Another program has changed it.
    Changed,
    /// It was deleted or moved away.
    Gone,
}

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
    /// The revision since which nothing has changed that is computed with: names and notes do not make results old.
    pub data_revision: u64,
    /// What can be undone.
    pub history: History,
    /// What its file is like.
    pub on_disk: OnDisk,
    /// Whether its file is not to be changed.
    pub is_read_only: bool,
    pub(super) stamp: Option<Stamp>,
    /// What the file (or the sample) holds; `None` while no file does.
    saved: Option<Arc<Session>>,
    num_steps_when_saved: usize,
    is_unsaved: bool,
}

impl Document {
    /// A session that is in a file, or is a sample, which need not be saved.
    pub(super) fn new(session: Session, path: Option<PathBuf>, revision: u64) -> Self {
        let session = Arc::new(session);
        Self { saved: Some(Arc::clone(&session)), is_unsaved: false, ..Self::new_unsaved(session, path, revision) }
    }

    /// A session that no file holds yet as it is.
    pub(super) fn new_unsaved(session: Arc<Session>, path: Option<PathBuf>, revision: u64) -> Self {
        Self {
            // Revisions are never used twice, so the first is as good a name as any.
            id: revision,
            session,
            path,
            revision,
            data_revision: revision,
            history: History::default(),
            on_disk: OnDisk::Same,
            is_read_only: false,
            stamp: None,
            saved: None,
            num_steps_when_saved: 0,
            is_unsaved: true,
        }
    }

    /// Tells this document from others; unlike the revision it stays the same through edits.
    #[must_use]
    pub const fn id(&self) -> u64 {
        self.id
    }

    /// Whether there are edits that no file holds.
    #[must_use]
    pub const fn is_unsaved(&self) -> bool {
        self.is_unsaved
    }

    /// Steps of the history between the file and what is on the bench.
    #[must_use]
    pub fn num_unsaved_steps(&self) -> usize {
        self.history.num_steps().abs_diff(self.num_steps_when_saved)
    }

    /// The file's name, or the session's.
    #[must_use]
    pub fn title(&self) -> String {
        self.path
            .as_deref()
            .and_then(Path::file_name)
            .map_or_else(|| self.name_or_untitled().to_owned(), |name| name.to_string_lossy().into_owned())
    }

    /// The session's name, or what stands for one.
    #[must_use]
    pub fn name_or_untitled(&self) -> &str {
        match self.session.name.trim() {
            "" => UNTITLED,
            name => name,
        }
    }

    /// The session is another now, or only what it is called.
    pub(super) fn note_changed(&mut self, revision: u64, is_data_changed: bool) {
        self.revision = revision;
        if is_data_changed {
            self.data_revision = revision;
        }
        self.compare_with_saved();
    }

    /// This is what the file holds.
    pub(super) fn note_saved(&mut self, saved: Arc<Session>) {
        self.saved = Some(saved);
        self.compare_with_saved();
        if !self.is_unsaved {
            self.num_steps_when_saved = self.history.num_steps();
        }
    }

    fn compare_with_saved(&mut self) {
        self.is_unsaved =
            self.saved.as_ref().is_none_or(|saved| !Arc::ptr_eq(&self.session, saved) && self.session != *saved);
    }
}
