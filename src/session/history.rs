//! Undo and redo by snapshots. Profiles sit behind `Arc`, so a snapshot of a session is small.

use std::sync::Arc;

use super::Session;

/// Snapshots kept; enough for a day's edits.
const MAX_STEPS: usize = 200;

#[derive(Clone, Debug)]
struct Step {
    label: String,
    before: Arc<Session>,
}

/// The edits made to a session, each with a label.
#[derive(Clone, Debug, Default)]
pub struct History {
    undo: Vec<Step>,
    redo: Vec<Step>,
}

impl History {
    /// Records that `before` was about to be changed by the edit `label`; what was undone is forgotten.
    pub fn record(&mut self, label: impl Into<String>, before: Arc<Session>) {
        self.redo.clear();
        if self.undo.len() == MAX_STEPS {
            self.undo.remove(0);
        }
        self.undo.push(Step { label: label.into(), before });
    }

    /// The session before the last edit, in exchange for the present one.
    pub fn undo(&mut self, present: Arc<Session>) -> Option<Arc<Session>> {
        Self::step(&mut self.undo, &mut self.redo, present)
    }

    /// The session as it was before the last undo, in exchange for the present one.
    pub fn redo(&mut self, present: Arc<Session>) -> Option<Arc<Session>> {
        Self::step(&mut self.redo, &mut self.undo, present)
    }

    /// What undo would take back.
    #[must_use]
    pub fn undo_label(&self) -> Option<&str> {
        self.undo.last().map(|step| step.label.as_str())
    }

    /// What redo would bring back.
    #[must_use]
    pub fn redo_label(&self) -> Option<&str> {
        self.redo.last().map(|step| step.label.as_str())
    }

    fn step(from: &mut Vec<Step>, to: &mut Vec<Step>, present: Arc<Session>) -> Option<Arc<Session>> {
        let Step { label, before } = from.pop()?;
        to.push(Step { label, before: present });
        Some(before)
    }
}
