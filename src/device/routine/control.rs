//! The hand that holds a routine: stop and pause, from any thread.

use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

#[derive(Clone, Copy, Debug, Default)]
struct Wish {
    stop: bool,
    pause: bool,
}

/// Tells a routine to stop or to wait before its next motion.
#[derive(Clone, Debug, Default)]
pub struct Control(Arc<(Mutex<Wish>, Condvar)>);

/// Somebody wants the routine to stop.
#[derive(Clone, Copy, Debug)]
pub(super) struct StopWanted;

impl Control {
    /// Lets the routine end at its next breath; the robot is told by whoever calls this.
    pub fn stop(&self) {
        self.change(|wish| wish.stop = true);
    }

    /// Lets it wait before its next motion, or go on.
    pub fn pause(&self, is_paused: bool) {
        self.change(|wish| wish.pause = is_paused);
    }

    /// Waits for so long, unless a stop is wanted.
    pub(super) fn wait(&self, patience: Duration) -> Result<(), StopWanted> {
        let waited = self.0.1.wait_timeout_while(self.lock(), patience, |wish| !wish.stop);
        let wish = *waited.unwrap_or_else(PoisonError::into_inner).0;
        if wish.stop { Err(StopWanted) } else { Ok(()) }
    }

    /// Waits while a pause is wanted.
    pub(super) fn wait_while_paused(&self) -> Result<(), StopWanted> {
        let waited = self.0.1.wait_while(self.lock(), |wish| wish.pause && !wish.stop);
        let wish = *waited.unwrap_or_else(PoisonError::into_inner);
        if wish.stop { Err(StopWanted) } else { Ok(()) }
    }

    fn change(&self, change: impl FnOnce(&mut Wish)) {
        change(&mut self.lock());
        self.0.1.notify_all();
    }

    fn lock(&self) -> MutexGuard<'_, Wish> {
        self.0.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
