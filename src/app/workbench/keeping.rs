//! Copies of the unsaved session for a run that ends badly, and what such runs have left behind.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::SystemTime;

use crate::app::recovery::{News, Origin, Recoverable, Recovery, RecoverySettings, Snapshot};
use crate::session::{Session, SessionError};

use super::{Document, NoticeKind, Workbench};

impl Workbench {
    /// From now on keeps a copy of what is unsaved, and looks for what other runs have left behind.
    pub fn keep_copies(&mut self, settings: RecoverySettings) {
        match Recovery::start(settings, Arc::clone(&self.wake)) {
            Ok(recovery) => self.recovery = Some(recovery),
            Err(error) => {
                self.notify(
                    NoticeKind::Error,
                    format!("no recovery copies are kept: found no thread ({error}). Save often"),
                );
            }
        }
        self.keep_copy();
    }

    /// What runs that ended badly have left behind.
    #[must_use]
    pub fn recoverable(&self) -> &[Recoverable] {
        &self.recoverable
    }

    /// The end of a run that the user wants to end: what is unsaved now is given up.
    pub fn end(&mut self) {
        if let Some(recovery) = self.recovery.take() {
            recovery.forget();
        }
    }

    /// The document has changed, or its file has: the copy follows.
    pub(super) fn keep_copy(&self) {
        let Some(recovery) = &self.recovery else { return };
        match self.document.as_ref().filter(|document| document.is_unsaved()) {
            Some(document) => {
                recovery.keep(Snapshot { session: Arc::clone(&document.session), origin: origin(document) });
            }
            None => recovery.forget(),
        }
    }

    pub(super) fn recover(&mut self, idx: usize) {
        if let (Some(recovery), Some(recoverable)) = (&self.recovery, self.recoverable.get(idx)) {
            self.revision_before_loading = self.document.as_ref().map(|document| document.revision);
            recovery.read(recoverable.file.clone());
        }
    }

    pub(super) fn discard_recoverable(&mut self, idx: usize) {
        if let (Some(recovery), Some(recoverable)) = (&self.recovery, self.recoverable.get(idx)) {
            recovery.discard(recoverable.file.clone());
        }
    }

    pub(super) fn take_news_of_recovery(&mut self) -> bool {
        let mut has_news = false;
        while let Some(news) = self.recovery.as_ref().and_then(Recovery::poll) {
            has_news = true;
            match news {
                News::Found(recoverable) => self.recoverable = recoverable,
                News::Kept => {}
                News::Read { file, outcome } => self.take_copy(file, *outcome),
                News::NotKept { folder, problem } => self.notify(
                    NoticeKind::Error,
                    format!(
                        "no recovery copy could be written to {}: {problem}. It is tried again; save often",
                        folder.display()
                    ),
                ),
            }
        }
        has_news
    }

    fn take_copy(&mut self, file: PathBuf, outcome: Result<(Session, Origin), SessionError>) {
        match outcome {
            Ok((session, origin)) => {
                if self.may_replace_document(&session.name) {
                    self.open_recovered(session, origin);
                    // A copy of our own is asked for before, so one of the two is on disk at any time.
                    if let Some(recovery) = &self.recovery {
                        recovery.discard(file);
                    }
                }
            }
            Err(error) => self.notify_of_opening(error.to_string()),
        }
    }

    fn open_recovered(&mut self, session: Session, origin: Origin) {
        self.last_revision += 1;
        let mut document = Document::new_unsaved(Arc::new(session), origin.path, self.last_revision);
        // Saving compares with the file as it was when the work began.
        document.stamp = origin.stamp;
        self.put_on_bench(document);
    }
}

fn origin(document: &Document) -> Origin {
    Origin {
        title: document.title(),
        path: document.path.clone(),
        written_at: SystemTime::now(),
        num_edits: document.num_unsaved_steps(),
        last_edit: document.history.undo_label().map(str::to_owned),
        stamp: document.stamp,
    }
}
