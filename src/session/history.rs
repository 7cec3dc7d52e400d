//! Undo and redo by snapshots. Profiles sit behind `Arc`, so a snapshot of a session is small.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use super::Session;

/// Snapshots kept; enough for a day's edits.
const MAX_STEPS: usize = 200;

/// A number for a gesture that nothing else has: a drag, or the strokes of one typing.
#[must_use]
pub fn new_gesture() -> u64 {
    static LAST: AtomicU64 = AtomicU64::new(0);
    LAST.fetch_add(1, Ordering::Relaxed) + 1
}

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
    /// The gesture that the newest step belongs to, as long as nothing else has happened.
    open_gesture: Option<u64>,
    num_forgotten: usize,
}

impl History {
    /// Records that the edit `label` turned `before` into `after`; what was undone is forgotten.
    ///
    /// Edits of the same gesture in a row are one step, under the first one's label; if they end where they began, there
    /// is no step.
    pub fn record(
        &mut self,
        label: impl Into<String>,
        gesture: Option<u64>,
        before: Arc<Session>,
        after: &Arc<Session>,
    ) {
        self.redo.clear();
        if gesture.is_some() && gesture == self.open_gesture {
            if self.undo.last().is_some_and(|step| step.before == *after) {
                self.undo.pop();
                self.open_gesture = None;
            }
            return;
        }
        if self.undo.len() == MAX_STEPS {
            self.undo.remove(0);
            self.num_forgotten += 1;
        }
        self.undo.push(Step { label: label.into(), before });
        self.open_gesture = gesture;
    }

    /// The session before the last edit, in exchange for the present one.
    pub fn undo(&mut self, present: Arc<Session>) -> Option<Arc<Session>> {
        self.open_gesture = None;
        Self::step(&mut self.undo, &mut self.redo, present)
    }

    /// The session as it was before the last undo, in exchange for the present one.
    pub fn redo(&mut self, present: Arc<Session>) -> Option<Arc<Session>> {
        self.open_gesture = None;
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

    /// The edits that can be taken back, the oldest first.
    #[must_use]
    pub fn undo_labels(&self) -> impl ExactSizeIterator<Item = &str> {
        self.undo.iter().map(|step| step.label.as_str())
    }

    /// The edits that can be brought back, the next one first.
    #[must_use]
    pub fn redo_labels(&self) -> impl ExactSizeIterator<Item = &str> {
        self.redo.iter().rev().map(|step| step.label.as_str())
    }

    /// Steps from the beginning to the present, forgotten ones included.
    #[must_use]
    pub const fn num_steps(&self) -> usize {
        self.num_forgotten + self.undo.len()
    }

    /// Whether all steps since the beginning are still there.
    #[must_use]
    pub const fn is_complete(&self) -> bool {
        self.num_forgotten == 0
    }

    fn step(from: &mut Vec<Step>, to: &mut Vec<Step>, present: Arc<Session>) -> Option<Arc<Session>> {
        let Step { label, before } = from.pop()?;
        to.push(Step { label, before: present });
        Some(before)
    }
}
