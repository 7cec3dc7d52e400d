//! Verification: it follows the results; further targets and calibrations from elsewhere are added to it.

use std::path::{Path, PathBuf};

use crate::app::jobs::JobOutcome;
use crate::app::study::Study;
use crate::report::verification::{adding_targets_of, solved_further, verification};
use crate::session::{self, Session, SessionError};
use crate::text::verify as words;
use crate::verify::{Calibration, Origin, Verification};

use super::{NoticeKind, Workbench};

/// A session read to be a further target, for the document that asked for it.
#[derive(Debug)]
pub(super) struct Added {
    document_id: u64,
    path: PathBuf,
    session: Result<Session, SessionError>,
}

impl Workbench {
    /// What every calibration is worth on every target. It follows the results by itself.
    #[must_use]
    pub const fn verification(&self) -> &Study<Verification> {
        &self.verification
    }

    /// Calibrations from elsewhere that are judged along, such as a pasted matrix.
    #[must_use]
    pub fn given_calibrations(&self) -> &[Calibration] {
        &self.given
    }

    /// Whether another session is being read as a further target.
    #[must_use]
    pub const fn is_adding_further(&self) -> bool {
        self.adding.is_running()
    }

    pub(super) fn start_verifying(&mut self) {
        let Some(results) = self.results.clone().filter(|results| self.is_current(results.revision)) else { return };
        let Some(document) = &self.document else { return };
        let session = std::sync::Arc::clone(&document.session);
        // Each capture of a routine would start over: what is known is verified when it has ended.
        self.verifies_later = self.cell.is_measuring();
        if self.verifies_later {
            return;
        }
        let given = self.given.clone();
        let known = self.verification.last().map(|found| solved_further(&found.value)).unwrap_or_default();
        self.verification.start("verify", &self.wake, results.revision, move |watch| {
            let own = results.problem.as_deref().map(|problem| (problem, &*results.methods));
            verification(&session, &results.measured, own, &given, &known, watch)
        });
    }

    /// Verifies what came while a routine was under way, now that none is.
    pub(super) fn verify_what_waited(&mut self) {
        if self.verifies_later && !self.cell.is_measuring() {
            self.start_verifying();
        }
    }

    pub(super) fn give_calibration(&mut self, calibration: Calibration) {
        // One of the same name is the same, corrected.
        if let Origin::Given { name, .. } = &calibration.origin {
            self.given.retain(|known| !matches!(&known.origin, Origin::Given { name: of, .. } if of == name));
        }
        self.given.push(calibration);
        self.start_verifying();
    }

    pub(super) fn withdraw_calibration(&mut self, name: &str) {
        self.given.retain(|known| !matches!(&known.origin, Origin::Given { name: of, .. } if of == name));
        self.start_verifying();
    }

    /// Reads another session in the background; its target becomes a further one of the open session.
    pub(super) fn start_adding_further(&mut self, path: PathBuf) {
        let Some(document) = &self.document else { return };
        let document_id = document.id;
        self.adding.start("add target", &self.wake, move |_| {
            let session = session::load(&path);
            Added { document_id, path, session }
        });
    }

    pub(super) fn take_added(&mut self, outcome: JobOutcome<Added>) {
        let added = match outcome {
            JobOutcome::Done(added) => added,
            broken => {
                self.notify_broken("reading the other target", &broken);
                return;
            }
        };
        let Some(document) = self.document.as_ref().filter(|document| document.id == added.document_id) else { return };
        let file_name = added.path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        match added.session {
            Err(error) => self.notify(NoticeKind::Error, error.to_string()),
            Ok(other) if other.mount != document.session.mount => {
                self.notify(NoticeKind::Error, words::other_mount(&shown(&added.path)));
            }
            Ok(other) => self.edit(&adding_targets_of(other, &file_name), None),
        }
    }
}

fn shown(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}
