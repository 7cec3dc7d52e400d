//! Work on results that takes its time: it runs in a slot of its own, and its last outcome stays until a newer one comes.

use std::time::{Duration, Instant};

use crate::watch::Cancelled;

use super::jobs::{JobOutcome, JobWatch, Slot, Wake};
use super::workbench::Progress;

/// What a study found out about a revision of the document.
#[derive(Clone, Debug)]
pub struct Found<T> {
    /// The revision it belongs to.
    pub revision: u64,
    /// What was found.
    pub value: T,
    /// How long it took.
    pub elapsed: Duration,
}

/// A study: the running job, if there is one, and its last outcome.
#[derive(Debug)]
pub struct Study<T> {
    slot: Slot<Result<Found<T>, Cancelled>>,
    last: Option<Found<T>>,
}

impl<T> Default for Study<T> {
    fn default() -> Self {
        Self { slot: Slot::default(), last: None }
    }
}

impl<T: Send + 'static> Study<T> {
    /// The last outcome, of whatever revision.
    #[must_use]
    pub const fn last(&self) -> Option<&Found<T>> {
        self.last.as_ref()
    }

    /// Whether it is under way.
    #[must_use]
    pub const fn is_running(&self) -> bool {
        self.slot.is_running()
    }

    /// How far it is, while it is under way.
    #[must_use]
    pub fn progress(&self) -> Option<Progress> {
        self.slot.progress().map(|(done, total)| Progress { done, total })
    }

    /// Starts anew; a study under way is given up.
    pub(super) fn start(
        &mut self,
        name: &str,
        wake: &Wake,
        revision: u64,
        study: impl FnOnce(&mut JobWatch) -> Result<T, Cancelled> + Send + 'static,
    ) {
        self.slot.start(name, wake, move |watch| {
            let start = Instant::now();
            let value = study(watch)?;
            Ok(Found { revision, value, elapsed: start.elapsed() })
        });
    }

    /// Gives up; the last outcome stays.
    pub(super) fn cancel(&mut self) {
        self.slot.cancel();
    }

    /// Gives up and forgets the last outcome.
    pub(super) fn clear(&mut self) {
        self.slot.cancel();
        self.last = None;
    }

    /// Takes in the outcome if the study has ended; answers how it ended.
    pub(super) fn poll(&mut self) -> Option<JobOutcome<()>> {
        Some(match self.slot.poll()? {
            JobOutcome::Done(outcome) => {
                if let Ok(found) = outcome {
                    self.last = Some(found);
                }
                JobOutcome::Done(())
            }
            JobOutcome::Panicked => JobOutcome::Panicked,
            JobOutcome::NotStarted(error) => JobOutcome::NotStarted(error),
        })
    }
}
