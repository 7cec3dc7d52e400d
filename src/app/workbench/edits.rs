//! The one way in which the document changes.

use std::sync::Arc;

use crate::diagnose::{self, Remedy};
use crate::session::edit::CellValue;
use crate::session::{Edit, History, Place, Session};
use crate::text::diagnosis::remedy_undo_label;
use crate::text::edits::edit_label;

use super::{NoticeKind, Workbench};

impl Workbench {
    /// Makes an edit; one that cannot be made is told, and nothing changes.
    pub(super) fn edit(&mut self, edit: &Edit, gesture: Option<u64>) {
        let Some(document) = &self.document else { return };
        let label = edit_label(edit, &document.session);
        self.edit_as(edit, gesture, label);
    }

    /// The same, under a label that says more than the edit knows. Answers whether it could be made.
    pub(super) fn edit_as(&mut self, edit: &Edit, gesture: Option<u64>, label: String) -> bool {
        let Some(document) = &self.document else { return false };
        match edit.apply(&document.session) {
            Ok(changed) => {
                self.replace_session(changed, label, gesture);
                true
            }
            Err(refusal) => {
                self.notify(NoticeKind::Error, refusal.to_string());
                false
            }
        }
    }

    pub(super) fn edit_station(&mut self, station_idx: usize, value: CellValue) {
        self.edit(&Edit::SetCells(vec![(Place { station_idx, capture_idx: 0 }, value)]), None);
    }

    pub(super) fn go_through_history(&mut self, steps: isize) {
        let Some(document) = &mut self.document else { return };
        let step = if steps < 0 { History::undo } else { History::redo };
        let before = Arc::clone(&document.session);
        for _ in 0..steps.unsigned_abs() {
            let Some(session) = step(&mut document.history, Arc::clone(&document.session)) else { break };
            document.session = session;
        }
        if !Arc::ptr_eq(&before, &document.session) {
            self.touch(&before);
        }
    }

    pub(super) fn apply_remedy(&mut self, remedy: &Remedy) {
        let Some(document) = &self.document else { return };
        let label = remedy_undo_label(remedy, &document.session);
        self.replace_session(diagnose::remedy::apply(&document.session, remedy), label, None);
    }

    /// One edit that can be undone; one that changes nothing is none.
    pub(super) fn replace_session(&mut self, changed: Session, label: String, gesture: Option<u64>) {
        let Some(document) = &mut self.document else { return };
        if changed == *document.session {
            return;
        }
        let before = std::mem::replace(&mut document.session, Arc::new(changed));
        document.history.record(label, gesture, Arc::clone(&before), &document.session);
        self.touch(&before);
    }

    /// The document has changed: a new revision, to be solved unless it is only called something else.
    fn touch(&mut self, before: &Session) {
        let Some(document) = &mut self.document else { return };
        self.last_revision += 1;
        let is_data_changed = !document.session.gives_results_of(before);
        document.note_changed(self.last_revision, is_data_changed);
        self.keep_copy();
        if is_data_changed {
            self.start_solving();
        }
    }
}
