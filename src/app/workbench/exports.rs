//! Exports, written in the background.

use std::path::PathBuf;
use std::sync::Arc;

use crate::app::jobs::JobOutcome;
use crate::session::Session;
use crate::session::export::{self, ExportError, TableStyle};
use crate::text::{import as words, report_panel as report_words};

use super::{NoticeKind, Workbench};

/// What was written, in words, or why it could not be.
pub(super) type Exported = Result<String, ExportError>;

impl Workbench {
    /// The poses in the numbers in which they are shown. Whoever asked for the path has asked about a file that is there.
    pub(super) fn export_poses(&mut self, path: PathBuf) {
        self.start_export(move |session| {
            let text = export::poses_csv(session, &session.robot.notation, TableStyle::default());
            export::write_text(&path, &text, true)?;
            Ok(words::exported_poses(session.num_captures(), &path.display().to_string()))
        });
    }

    /// The profiles, one a file; files that are there already are not replaced.
    pub(super) fn export_profiles(&mut self, folder: PathBuf) {
        self.start_export(move |session| {
            let num_profiles = export::write_profiles(session, &folder, TableStyle::default(), false)?;
            Ok(words::exported_profiles(num_profiles, &folder.display().to_string()))
        });
    }

    /// A file that the window has made.
    pub(super) fn write_file(&mut self, path: PathBuf, contents: Arc<[u8]>) {
        self.exporting.start("write a file", &self.wake, move |_| {
            export::write_bytes(&path, &contents, true)?;
            Ok(report_words::wrote(&path.display().to_string()))
        });
    }

    fn start_export(&mut self, write: impl FnOnce(&Session) -> Exported + Send + 'static) {
        let Some(document) = &self.document else { return };
        let session = Arc::clone(&document.session);
        self.exporting.start("export", &self.wake, move |_| write(&session));
    }

    pub(super) fn poll_exports(&mut self) -> bool {
        let Some(outcome) = self.exporting.poll() else { return false };
        match outcome {
            JobOutcome::Done(Ok(message)) => self.notify(NoticeKind::Done, message),
            JobOutcome::Done(Err(error)) => self.notify(NoticeKind::Error, error.to_string()),
            broken => self.notify_broken("exporting", &broken),
        }
        true
    }
}
