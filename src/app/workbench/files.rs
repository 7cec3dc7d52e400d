//! The way between files and the bench.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::app::OnDisk;
use crate::app::jobs::JobOutcome;
use crate::session::format::{self, Stamp};
use crate::session::{self, Session, SessionError, Target};
use crate::text::sequence as words;

use super::{Document, NoticeKind, Workbench};

/// What a reload is called in the history.
const RELOAD_LABEL: &str = "reload from disk";

/// A session on its way to a file: taken when it was asked for, whatever happens on the bench meanwhile.
#[derive(Clone, Debug)]
pub(super) struct Save {
    document_id: u64,
    session: Arc<Session>,
    path: PathBuf,
    /// What the file has to be like for it to be replaced; `None` if the user wants it replaced whatever it is.
    known: Option<Stamp>,
}

/// What came of it.
pub(super) type SaveOutcome = Result<Stamp, SessionError>;

/// Why a session was read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Purpose {
    /// To be put on the bench.
    Open,
    /// To replace what is on the bench of this document.
    Reload {
        /// The document.
        document_id: u64,
    },
}

#[derive(Debug)]
pub(super) struct Loaded {
    purpose: Purpose,
    path: Option<PathBuf>,
    session: Result<(Session, Option<Stamp>), SessionError>,
    is_read_only: bool,
}

/// How a document's file was found.
#[derive(Clone, Copy, Debug)]
pub(super) struct Look {
    document_id: u64,
    /// What it was compared with.
    known: Stamp,
    on_disk: OnDisk,
    is_read_only: bool,
    /// The file's stamp, where only its time is another.
    touched: Option<Stamp>,
}

impl Workbench {
    /// Puts a session on the bench, as it is in a file or a sample, and solves it.
    pub fn open_session(&mut self, session: Session, path: Option<PathBuf>) {
        self.last_revision += 1;
        self.put_on_bench(Document::new(session, path, self.last_revision));
    }

    /// Puts a session on the bench that no file holds yet, such as an imported one, and solves it.
    pub fn open_unsaved_session(&mut self, session: Session) {
        self.last_revision += 1;
        self.put_on_bench(Document::new_unsaved(Arc::new(session), None, self.last_revision));
    }

    /// As long as it is empty there is nothing to be saved.
    pub(super) fn begin_session(&mut self, target: Target) {
        self.open_session(Session::new(target), None);
    }

    pub(super) fn put_on_bench(&mut self, document: Document) {
        self.let_go_of_document();
        self.end_practice();
        self.forget_errors();
        self.conflict = None;
        self.looking.cancel();
        self.looks_again = false;
        self.document = Some(document);
        self.keep_copy();
        self.forget_results();
        self.start_solving();
    }

    /// The file that another program has changed since, where a save met one.
    #[must_use]
    pub fn conflict(&self) -> Option<&Path> {
        self.conflict.as_deref()
    }

    /// What was edited while a file was being read is not thrown away.
    pub(super) fn may_replace_document(&mut self, name: &str) -> bool {
        let revision = self.document.as_ref().map(|document| document.revision);
        let is_edited = self.document.as_ref().is_some_and(Document::is_unsaved);
        if is_edited && revision != self.revision_before_loading {
            self.notify_of_opening(format!(
                "\"{name}\" was not opened: the session on the bench was edited while it was read. Save it, then open again"
            ));
            return false;
        }
        true
    }

    pub(super) fn take_loaded(&mut self, outcome: JobOutcome<Loaded>) {
        match outcome {
            JobOutcome::Done(Loaded { purpose, path, session: Ok((session, stamp)), is_read_only }) => match purpose {
                Purpose::Open => {
                    if self.may_replace_document(&session.name) {
                        self.last_revision += 1;
                        let mut document = Document::new(session, path.map(absolute), self.last_revision);
                        (document.stamp, document.is_read_only) = (stamp, is_read_only);
                        self.put_on_bench(document);
                    }
                }
                Purpose::Reload { document_id } => {
                    self.take_reloaded(document_id, path.as_deref(), session, stamp, is_read_only);
                }
            },
            JobOutcome::Done(Loaded { purpose: Purpose::Open, session: Err(error), .. }) => {
                self.notify_of_opening(error.to_string());
            }
            JobOutcome::Done(Loaded { session: Err(error), .. }) => {
                self.notify(NoticeKind::Error, error.to_string());
            }
            broken => {
                self.notify_broken("reading the file", &broken);
                self.mark_newest_as_of_opening();
            }
        }
    }

    fn take_reloaded(
        &mut self,
        document_id: u64,
        path: Option<&Path>,
        session: Session,
        stamp: Option<Stamp>,
        is_read_only: bool,
    ) {
        // Its file may have become another meanwhile.
        if self.document.as_ref().is_none_or(|document| document.id != document_id || document.path.as_deref() != path)
        {
            return;
        }
        self.let_go_of_document();
        self.forget_errors();
        self.conflict = None;
        self.replace_session(session, RELOAD_LABEL.to_owned(), None);
        if let Some(document) = &mut self.document {
            document.note_saved(Arc::clone(&document.session));
            (document.stamp, document.is_read_only, document.on_disk) = (stamp, is_read_only, OnDisk::Same);
        }
        self.keep_copy();
    }

    pub(super) fn start_loading(&mut self, path: PathBuf, purpose: Purpose) {
        self.revision_before_loading = self.document.as_ref().map(|document| document.revision);
        self.loading.start("load session", &self.wake, move |_| {
            let session = format::load_with_stamp(&path).map(|(loaded, stamp)| (loaded.session, Some(stamp)));
            let is_read_only = format::is_read_only(&path);
            Loaded { purpose, path: Some(path), session, is_read_only }
        });
    }

    /// A session's file, or the folder of an RGB-D sequence.
    pub(super) fn open_file(&mut self, path: PathBuf) {
        if path.is_dir() {
            self.open_sequence(&absolute(path));
        } else {
            self.start_loading(path, Purpose::Open);
        }
    }

    /// The session of a sequence stands beside its folder and is called like it; where there is none, it is begun.
    fn open_sequence(&mut self, folder: &Path) {
        let Some(name) = folder.file_name().map(|name| name.to_string_lossy().into_owned()) else {
            self.notify_of_opening(words::no_name(&folder.display().to_string()));
            return;
        };
        let file = folder.with_file_name(format!("{name}.json"));
        if file.exists() {
            self.start_loading(file, Purpose::Open);
            return;
        }
        let session = Session { name: name.clone(), ..Session::new(Target::Rgbd { sequence: name }) };
        self.last_revision += 1;
        self.put_on_bench(Document::new_unsaved(Arc::new(session), Some(file), self.last_revision));
    }

    pub(super) fn reload(&mut self) {
        let Some(document) = &self.document else { return };
        if let Some(path) = document.path.clone() {
            let purpose = Purpose::Reload { document_id: document.id };
            self.start_loading(path, purpose);
        }
    }

    pub(super) fn open_sample(&mut self, sample_idx: usize) {
        let Some(sample) = session::samples::ALL.get(sample_idx) else {
            self.notify_of_opening(format!("there is no sample session number {sample_idx}"));
            return;
        };
        self.revision_before_loading = self.document.as_ref().map(|document| document.revision);
        self.loading.start("load sample", &self.wake, move |_| Loaded {
            purpose: Purpose::Open,
            path: None,
            session: session::parse(sample.json.as_bytes(), sample.file_name).map(|session| (session, None)),
            is_read_only: false,
        });
    }

    pub(super) fn close_document(&mut self) {
        self.let_go_of_document();
        self.end_practice();
        self.loading.cancel();
        self.solving.cancel();
        self.looking.cancel();
        self.document = None;
        self.conflict = None;
        self.keep_copy();
        self.forget_results();
    }

    pub(super) fn save(&mut self) {
        match self.document.as_ref().map(|document| self.path_to_be(document)) {
            Some(Some(path)) => self.start_saving(path),
            Some(None) => {
                self.notify(NoticeKind::Error, "this session has no file yet: choose one with \"Save as…\"".to_owned());
            }
            None => self.notify(NoticeKind::Error, "there is no open session to save".to_owned()),
        }
    }

    /// The document's file once all saves that are under way have arrived.
    fn path_to_be(&self, document: &Document) -> Option<PathBuf> {
        let on_its_way =
            self.newest_save.as_ref().filter(|(document_id, _)| self.is_saving() && *document_id == document.id);
        on_its_way.map(|(_, path)| path).or(document.path.as_ref()).cloned()
    }

    /// Saves to a file. The document's own is replaced only if it is as it was; that another may be replaced was asked
    /// where it was chosen.
    pub(super) fn start_saving(&mut self, path: PathBuf) {
        let path = absolute(path);
        let known = self.document.as_ref().filter(|document| document.path.as_deref() == Some(&*path));
        let known = known.and_then(|document| document.stamp);
        self.queue_save(path, known);
    }

    /// Saves to the file that another program has changed.
    pub(super) fn save_anyway(&mut self) {
        self.conflict = None;
        if let Some(path) = self.document.as_ref().and_then(|document| document.path.clone()) {
            self.queue_save(path, None);
        }
    }

    fn queue_save(&mut self, path: PathBuf, known: Option<Stamp>) {
        let Some(document) = &self.document else {
            self.notify(NoticeKind::Error, "there is no open session to save".to_owned());
            return;
        };
        let save = Save { document_id: document.id, session: Arc::clone(&document.session), path, known };
        self.newest_save = Some((save.document_id, save.path.clone()));
        if self.saving.is_running() {
            // A save is never dropped; the next one starts when this one has ended.
            self.save_queue.push_back(save);
        } else {
            self.run_save(save);
        }
    }

    fn run_save(&mut self, save: Save) {
        self.saving.start("save session", &self.wake, move |_| {
            let outcome = format::save_over(&save.session, &save.path, save.known.as_ref());
            (save, outcome)
        });
    }

    pub(super) fn take_saved(&mut self, outcome: JobOutcome<(Save, SaveOutcome)>) {
        match outcome {
            JobOutcome::Done((save, Ok(stamp))) => self.note_saved(save, stamp),
            JobOutcome::Done((save, Err(error))) => self.note_not_saved(save, &error),
            broken => self.notify_broken("saving", &broken),
        }
        if let Some(next) = self.save_queue.pop_front() {
            self.run_save(next);
        }
    }

    fn note_saved(&mut self, save: Save, stamp: Stamp) {
        self.forget_errors();
        let was_gone = self.document_of(&save).is_some_and(|document| document.on_disk == OnDisk::Gone);
        let again = if was_gone { " again: it had been deleted or moved" } else { "" };
        self.notify(NoticeKind::Done, format!("saved to {}{again}", save.path.display()));
        // Saves that wait know only the file as it was before this one.
        for waiting in self.save_queue.iter_mut().filter(|waiting| waiting.path == save.path && waiting.known.is_some())
        {
            waiting.known = Some(stamp);
        }
        // Another document may be on the bench by now; its file is another.
        if let Some(document) = self.document_of(&save) {
            let folder_before = document.path.as_deref().and_then(Path::parent).map(Path::to_owned);
            document.note_saved(save.session);
            document.path = Some(save.path);
            (document.stamp, document.is_read_only, document.on_disk) = (Some(stamp), false, OnDisk::Same);
            let folder = document.path.as_deref().and_then(Path::parent);
            // The sequence is that beside the file.
            let has_other_sequence =
                matches!(document.session.target, Target::Rgbd { .. }) && folder != folder_before.as_deref();
            self.keep_copy();
            if has_other_sequence {
                self.start_solving();
            }
        }
    }

    fn note_not_saved(&mut self, save: Save, error: &SessionError) {
        if matches!(error, SessionError::ChangedOnDisk { .. })
            && let Some(document) = self.document_of(&save)
        {
            document.on_disk = OnDisk::Changed;
            self.conflict = Some(save.path);
            return;
        }
        if matches!(error, SessionError::ReadOnly { .. })
            && let Some(document) = self.document_of(&save)
            && document.path.as_ref() == Some(&save.path)
        {
            document.is_read_only = true;
        }
        self.notify(NoticeKind::Error, error.to_string());
    }

    fn document_of(&mut self, save: &Save) -> Option<&mut Document> {
        self.document.as_mut().filter(|document| document.id == save.document_id)
    }

    /// Looks in the background whether another program has changed the file.
    pub(super) fn look_at_file(&mut self) {
        let Some(document) = &self.document else { return };
        let (Some(path), Some(known)) = (document.path.clone(), document.stamp) else { return };
        if self.is_saving() || self.loading.is_running() {
            return;
        }
        // The one under way may have been past the file already; a second one beside it helps nobody on a slow disk.
        if self.looking.is_running() {
            self.looks_again = true;
            return;
        }
        let document_id = document.id;
        self.looking.start("look at the file", &self.wake, move |_| look(document_id, &path, known));
    }

    pub(super) fn take_look(&mut self, outcome: &JobOutcome<Look>) {
        if std::mem::take(&mut self.looks_again) {
            self.look_at_file();
        }
        // A look that broke down is none; saving looks again.
        let JobOutcome::Done(look) = outcome else { return };
        let document = self.document.as_mut().filter(|document| document.id == look.document_id);
        // A save may have come in between.
        if let Some(document) = document.filter(|document| document.stamp == Some(look.known)) {
            (document.on_disk, document.is_read_only) = (look.on_disk, look.is_read_only);
            document.stamp = look.touched.or(document.stamp);
        }
    }
}

/// A path that means the same in another run, which may start in another folder.
fn absolute(path: PathBuf) -> PathBuf {
    std::path::absolute(&path).unwrap_or(path)
}

/// Its time says whether it has to be read; its contents decide.
fn look(document_id: u64, path: &Path, known: Stamp) -> Look {
    let is_read_only = format::is_read_only(path);
    let found = |on_disk, touched| Look { document_id, known, on_disk, is_read_only, touched };
    match fs::metadata(path) {
        Ok(metadata) if known.looks_like(&metadata) => found(OnDisk::Same, None),
        Err(error) if error.kind() == io::ErrorKind::NotFound => found(OnDisk::Gone, None),
        _ => match Stamp::of(path) {
            Ok(stamp) if stamp.has_contents_of(&known) => found(OnDisk::Same, Some(stamp)),
            Ok(_) => found(OnDisk::Changed, None),
            // Not to be read for now; saving tells what is the matter.
            Err(_) => found(OnDisk::Same, None),
        },
    }
}
