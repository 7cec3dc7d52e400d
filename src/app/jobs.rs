//! Work in the background: one typed slot a kind of job. A newer job replaces the running one.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, TryRecvError, sync_channel};
use std::thread;

pub use crate::watch::Wake;
use crate::watch::{Cancelled, Watch};

#[derive(Debug, Default)]
struct Shared {
    cancelled: AtomicBool,
    done: AtomicUsize,
    total: AtomicUsize,
}

/// The worker's end: takes its progress and tells it to stop.
#[derive(Debug)]
pub struct JobWatch(Arc<Shared>);

impl Watch for JobWatch {
    fn report(&mut self, done: usize, total: usize) -> Result<(), Cancelled> {
        self.0.done.store(done, Ordering::Relaxed);
        self.0.total.store(total, Ordering::Relaxed);
        if self.0.cancelled.load(Ordering::Relaxed) { Err(Cancelled) } else { Ok(()) }
    }
}

/// What came of a job.
#[derive(Debug)]
pub enum JobOutcome<T> {
    /// Its result.
    Done(T),
    /// It broke down: a bug, told to the user instead of taking the window with it.
    Panicked,
    /// The system gave no thread.
    NotStarted(std::io::Error),
}

#[derive(Debug)]
struct Running<T> {
    shared: Arc<Shared>,
    outcome: Receiver<JobOutcome<T>>,
}

/// A place for one running job of a kind.
#[derive(Debug)]
pub struct Slot<T> {
    running: Option<Running<T>>,
}

impl<T> Default for Slot<T> {
    fn default() -> Self {
        Self { running: None }
    }
}

impl<T: Send + 'static> Slot<T> {
    /// Starts a job on a thread of its own; a running one is told to stop and its result dropped.
    pub fn start(&mut self, name: &str, wake: &Wake, job: impl FnOnce(&mut JobWatch) -> T + Send + 'static) {
        self.cancel();
        let shared = Arc::new(Shared::default());
        let (sender, outcome) = sync_channel(1);
        let failure_sender = sender.clone();
        let worker_shared = Arc::clone(&shared);
        let wake = Arc::clone(wake);
        let spawned = thread::Builder::new().name(name.to_owned()).spawn(move || {
            let result = catch_unwind(AssertUnwindSafe(|| job(&mut JobWatch(worker_shared))));
            let outcome = result.map_or(JobOutcome::Panicked, JobOutcome::Done);
            // Nobody listens any more if a newer job took the slot: then the result is not wanted.
            sender.send(outcome).ok();
            wake();
        });
        if let Err(error) = spawned {
            failure_sender.send(JobOutcome::NotStarted(error)).ok();
        }
        self.running = Some(Running { shared, outcome });
    }

    /// Tells the running job to stop and forgets it.
    pub fn cancel(&mut self) {
        if let Some(running) = self.running.take() {
            running.shared.cancelled.store(true, Ordering::Relaxed);
        }
    }

    /// The outcome, once, if the job has ended.
    pub fn poll(&mut self) -> Option<JobOutcome<T>> {
        let outcome = match self.running.as_ref()?.outcome.try_recv() {
            Ok(outcome) => outcome,
            Err(TryRecvError::Empty) => return None,
            Err(TryRecvError::Disconnected) => JobOutcome::Panicked,
        };
        self.running = None;
        Some(outcome)
    }

    /// Whether a job is running.
    #[must_use]
    pub const fn is_running(&self) -> bool {
        self.running.is_some()
    }

    /// Parts done and in all, of a running job.
    #[must_use]
    pub fn progress(&self) -> Option<(usize, usize)> {
        self.running
            .as_ref()
            .map(|running| (running.shared.done.load(Ordering::Relaxed), running.shared.total.load(Ordering::Relaxed)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wait<T: Send + 'static>(slot: &mut Slot<T>, woken: &Receiver<()>) -> JobOutcome<T> {
        loop {
            if let Some(outcome) = slot.poll() {
                return outcome;
            }
            woken.recv().expect("the worker wakes us");
        }
    }

    fn wake() -> (Wake, Receiver<()>) {
        let (sender, receiver) = sync_channel(8);
        (
            Arc::new(move || {
                sender.try_send(()).ok();
            }),
            receiver,
        )
    }

    #[test]
    fn a_newer_job_replaces_the_running_one() {
        let (wake, woken) = wake();
        let mut slot = Slot::default();
        slot.start("first", &wake, |watch| while watch.report(0, 1).is_ok() {});
        slot.start("second", &wake, |_| ());
        assert!(matches!(wait(&mut slot, &woken), JobOutcome::Done(())));
        assert!(!slot.is_running());
    }

    #[test]
    fn a_panic_becomes_an_outcome() {
        let (wake, woken) = wake();
        let mut slot: Slot<()> = Slot::default();
        slot.start("broken", &wake, |_| panic!("as the test wants it"));
        assert!(matches!(wait(&mut slot, &woken), JobOutcome::Panicked));
    }
}
