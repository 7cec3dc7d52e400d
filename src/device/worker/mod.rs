//! One thread a device: it owns the driver, keeps the connection up, looks at the device now and then, and answers one
//! request at a time.
//!
//! A stop never waits behind a request: it is a count that the thread looks at between the parts of a move. A driver that
//! panics is a broken connection. A worker that is dropped stops its robot if it moves, and ends.

mod post;
mod robot;
mod sensor;

#[cfg(test)]
mod tests;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::thread;
use std::time::{Duration, Instant};

use super::error::{DeviceError, system_words};
use crate::watch::Wake;

use post::{Next, Post};
pub use robot::{RobotClient, RobotWorker};
pub use sensor::{LiveProfile, SensorClient, SensorWorker};

/// How long is waited at most, for what.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Deadlines {
    /// For a connection.
    pub connect: Duration,
    /// For the answer to a request.
    pub request: Duration,
    /// For a stop to be taken.
    pub stop: Duration,
    /// For a profile that is later than the move before it.
    pub profile: Duration,
    /// For a move, beyond what it takes by its speed at a tenth of the override.
    pub beyond_move: Duration,
}

impl Default for Deadlines {
    fn default() -> Self {
        Self {
            connect: Duration::from_secs(3),
            request: Duration::from_secs(1),
            stop: Duration::from_secs(1),
            profile: Duration::from_secs(3),
            beyond_move: Duration::from_secs(5),
        }
    }
}

/// Makes a driver by a deadline; called again for each attempt.
pub type Connect<Driver> = Box<dyn FnMut(Instant) -> Result<Box<Driver>, DeviceError> + Send>;

/// What a worker does with its driver.
trait Duty: Send + 'static {
    type Driver: ?Sized + 'static;
    type Request: Send + 'static;

    /// Time between two looks while nothing is asked.
    const LOOK_EVERY: Duration;
    /// What messages call the device while there is no driver to ask.
    const DEVICE: &'static str;

    /// Takes what the device shows now to those who look on. An error breaks the connection, unless it leaves it usable.
    fn look(&mut self, driver: &mut Self::Driver, post: &Post<Self::Request>) -> Result<(), DeviceError>;

    /// Answers a request. What it gives back is for the connection only: the asker has it already.
    fn serve(
        &mut self,
        driver: &mut Self::Driver,
        request: Self::Request,
        post: &Post<Self::Request>,
    ) -> Result<(), DeviceError>;

    /// Answers a request that nobody can serve.
    fn refuse(request: Self::Request, error: DeviceError);

    /// Stops whatever the device does.
    fn stop(&mut self, driver: &mut Self::Driver) -> Result<(), DeviceError>;

    /// Whether the device may still be doing what it was told.
    fn may_be_moving(&self) -> bool;

    /// What was shown is not so any more.
    fn hide(&mut self);
}

/// A worker's thread, from the outside. Dropping it ends the thread.
#[derive(Debug)]
struct Hold<Request>(Arc<Post<Request>>);

impl<Request> Drop for Hold<Request> {
    fn drop(&mut self) {
        self.0.end();
    }
}

fn start<D: Duty>(duty: D, connect: Connect<D::Driver>, deadlines: Deadlines, wake: Wake) -> Hold<D::Request> {
    let post = Arc::new(Post::new(D::DEVICE, deadlines, wake));
    let worker = Worker { duty, connect, post: Arc::clone(&post) };
    let spawned = thread::Builder::new().name(D::DEVICE.to_lowercase()).spawn(move || worker.run());
    if let Err(error) = spawned {
        let error = DeviceError::System {
            device: D::DEVICE,
            what: "starting a thread".to_owned(),
            reason: system_words(&error),
        };
        post.change_link(|link| link.on_failed(error, Instant::now()));
    }
    Hold(post)
}

struct Worker<D: Duty> {
    duty: D,
    connect: Connect<D::Driver>,
    post: Arc<Post<D::Request>>,
}

impl<D: Duty> Worker<D> {
    fn run(mut self) {
        while !self.post.is_over() {
            self.post.change_link(super::link::Link::on_connecting);
            let deadline = Instant::now() + self.post.deadlines.connect;
            let connected = guarded(D::DEVICE, || (self.connect)(deadline));
            let error = match connected {
                Ok(mut driver) => {
                    self.duty.hide();
                    self.post.change_link(|link| link.on_connected(Instant::now()));
                    let broken = self.attend(&mut *driver);
                    let Some(error) = broken else { break };
                    // Whatever is left of the connection may still carry a stop.
                    self.stop_what_is_left(&mut *driver).ok();
                    // Closing a connection is the driver's code, too.
                    guarded(D::DEVICE, move || {
                        drop(driver);
                        Ok(())
                    })
                    .ok();
                    error
                }
                Err(error) => error,
            };
            self.post.change_link(|link| link.on_failed(error.clone(), Instant::now()));
            self.sit_out(&error);
        }
        self.post.leave(|request| D::refuse(request, DeviceError::Stopped { device: D::DEVICE }));
    }

    /// Serves as long as the connection holds; `None` once nobody wants it any more.
    fn attend(&mut self, driver: &mut D::Driver) -> Option<DeviceError> {
        if let Err(error) = self.stop_what_is_left(driver)
            && !error.leaves_connection_usable()
        {
            return Some(error);
        }
        let mut next_look = Instant::now();
        loop {
            let outcome = match self.post.next(Some(next_look), self.duty.may_be_moving()) {
                Next::Over => {
                    self.stop_what_is_left(driver).ok();
                    return None;
                }
                Next::Stop(count) => {
                    // Where nothing was sent there was nothing to stop.
                    let was_moving = self.duty.may_be_moving();
                    let outcome = self.stop(driver);
                    self.post.note_stopped(count, Some(outcome.is_ok() || !was_moving));
                    outcome
                }
                Next::Request(request) => match self.stop_what_is_left(driver) {
                    Ok(()) => guarded(D::DEVICE, || self.duty.serve(driver, request, &self.post)),
                    Err(error) => {
                        D::refuse(request, error.clone());
                        Err(error)
                    }
                },
                Next::Nothing => {
                    next_look = Instant::now() + D::LOOK_EVERY;
                    let outcome = self
                        .stop_what_is_left(driver)
                        .and_then(|()| guarded(D::DEVICE, || self.duty.look(driver, &self.post)));
                    if outcome.is_err() {
                        self.duty.hide();
                    }
                    self.post.note_look(outcome.as_ref().err());
                    outcome
                }
            };
            if let Err(error) = outcome
                && !error.leaves_connection_usable()
            {
                return Some(error);
            }
        }
    }

    fn stop(&mut self, driver: &mut D::Driver) -> Result<(), DeviceError> {
        guarded(D::DEVICE, || self.duty.stop(driver))
    }

    /// A move that broke off, and a stop that was not taken, may have left the robot under way: as long as that is so, it
    /// is told to stop before anything else is done.
    fn stop_what_is_left(&mut self, driver: &mut D::Driver) -> Result<(), DeviceError> {
        let outcome = self.duty.may_be_moving().then(|| self.stop(driver));
        self.post.note_stopped_unasked(outcome.as_ref().map(Result::is_ok));
        outcome.unwrap_or(Ok(()))
    }

    /// Waits for the time of the next attempt; whoever asks meanwhile hears why there is no answer.
    fn sit_out(&self, error: &DeviceError) {
        let retry_at = self.post.retry_at();
        loop {
            match self.post.next(retry_at, false) {
                Next::Over | Next::Nothing => return,
                Next::Stop(count) if !self.duty.may_be_moving() => self.post.note_stopped(count, Some(true)),
                Next::Stop(count) => self.post.note_stopped_without_connection(count),
                Next::Request(request) => D::refuse(request, error.clone()),
            }
        }
    }
}

/// A panic of a driver is a bug, but no reason for the thread to vanish.
fn guarded<T>(device: &'static str, call: impl FnOnce() -> Result<T, DeviceError>) -> Result<T, DeviceError> {
    catch_unwind(AssertUnwindSafe(call)).unwrap_or_else(|_| {
        Err(DeviceError::System {
            device,
            what: "talking to the device".to_owned(),
            reason: "the driver broke down; this is a bug in Handeye".to_owned(),
        })
    })
}
