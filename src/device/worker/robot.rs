//! The robot's worker: the live pose, moves that can be stopped at any time, and reports on request.

use std::sync::mpsc::SyncSender;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use super::post::{Binding, Post, lock};
use super::{Connect, Deadlines, Duty, Hold, start};
use crate::device::driver::{LinearMove, MoveState, Readiness, RobotDriver, RobotReport};
use crate::device::error::DeviceError;
use crate::device::link::LinkState;
use crate::watch::Wake;

/// How long after a stop was asked for the driver hears of it, at most, while it moves.
const MOVE_POLL: Duration = Duration::from_millis(10);

type Robot = dyn RobotDriver;

/// Something to ask of the robot's thread.
#[derive(Debug)]
pub enum RobotRequest {
    /// The pose now.
    Report(SyncSender<Result<RobotReport, DeviceError>>),
    /// A move, until it has ended.
    Move {
        /// Where to, and how fast.
        motion: LinearMove,
        /// When it has to have ended.
        deadline: Instant,
        /// Takes the outcome.
        reply: SyncSender<Result<(), DeviceError>>,
    },
}

struct RobotDuty {
    latest: Arc<Mutex<Option<RobotReport>>>,
    deadlines: Deadlines,
    is_moving: bool,
}

impl RobotDuty {
    fn report(&self, driver: &mut Robot, post: &Post<RobotRequest>) -> Result<RobotReport, DeviceError> {
        let report = driver.report(Instant::now() + self.deadlines.request)?;
        *lock(&self.latest) = Some(report.clone());
        post.tell();
        Ok(report)
    }

    fn run_move(
        &mut self,
        driver: &mut Robot,
        motion: &LinearMove,
        deadline: Instant,
        post: &Post<RobotRequest>,
    ) -> Result<(), DeviceError> {
        if post.is_interrupted_within(Duration::ZERO) {
            return Err(DeviceError::Stopped { device: driver.name() });
        }
        let start = Instant::now();
        // Of a move whose start got no answer nobody knows whether it began.
        self.is_moving = true;
        if let Err(error) = driver.start_move(motion, start + self.deadlines.request) {
            self.is_moving = !error.leaves_connection_usable();
            return Err(error);
        }
        let mut next_look = start + Self::LOOK_EVERY;
        loop {
            // The thread tells the driver as soon as it is back from here.
            if post.is_interrupted_within(MOVE_POLL) {
                return Err(DeviceError::Stopped { device: driver.name() });
            }
            if driver.move_state(Instant::now() + self.deadlines.request)? == MoveState::Done {
                self.is_moving = false;
                self.report(driver, post)?;
                return Ok(());
            }
            let now = Instant::now();
            if now >= deadline {
                let waited = now - start;
                return Err(DeviceError::Timeout {
                    device: driver.name(),
                    request: "the end of a move".to_owned(),
                    waited,
                });
            }
            if now >= next_look {
                next_look = now + Self::LOOK_EVERY;
                // A controller that somebody takes out of its remote mode does not always say that the move is over.
                if let Readiness::NotReady { found, remedy } = self.report(driver, post)?.readiness {
                    let (device, needed) = (driver.name(), "a controller that takes commands of motion");
                    return Err(DeviceError::NotReady { device, found, needed, remedy });
                }
            }
        }
    }
}

impl Duty for RobotDuty {
    type Driver = Robot;
    type Request = RobotRequest;

    const LOOK_EVERY: Duration = Duration::from_millis(100);
    const DEVICE: &'static str = "Robot";

    fn look(&mut self, driver: &mut Robot, post: &Post<RobotRequest>) -> Result<(), DeviceError> {
        self.report(driver, post).map(drop)
    }

    fn serve(
        &mut self,
        driver: &mut Robot,
        request: RobotRequest,
        post: &Post<RobotRequest>,
    ) -> Result<(), DeviceError> {
        // Who has given up waiting does not want the answer.
        match request {
            RobotRequest::Report(reply) => {
                let outcome = self.report(driver, post);
                let for_link = outcome.as_ref().map(drop).map_err(Clone::clone);
                reply.send(outcome).ok();
                for_link
            }
            RobotRequest::Move { motion, deadline, reply } => {
                let outcome = self.run_move(driver, &motion, deadline, post);
                reply.send(outcome.clone()).ok();
                match outcome {
                    // The controller answers; it is the move that takes too long.
                    Err(DeviceError::Timeout { .. }) if Instant::now() >= deadline => Ok(()),
                    outcome => outcome,
                }
            }
        }
    }

    fn refuse(request: RobotRequest, error: DeviceError) {
        match request {
            RobotRequest::Report(reply) => reply.send(Err(error)).ok(),
            RobotRequest::Move { reply, .. } => reply.send(Err(error)).ok(),
        };
    }

    fn stop(&mut self, driver: &mut Robot) -> Result<(), DeviceError> {
        match driver.stop(Instant::now() + self.deadlines.stop) {
            // What only reads was never sent anywhere.
            Ok(()) | Err(DeviceError::CannotMove { .. }) => {
                self.is_moving = false;
                Ok(())
            }
            Err(error) => Err(error),
        }
    }

    fn may_be_moving(&self) -> bool {
        self.is_moving
    }

    fn hide(&mut self) {
        *lock(&self.latest) = None;
    }
}

/// Asks the robot's worker; cheap to copy.
#[derive(Clone, Debug)]
pub struct RobotClient {
    post: Arc<Post<RobotRequest>>,
    binding: Option<Binding>,
    latest: Arc<Mutex<Option<RobotReport>>>,
}

impl RobotClient {
    /// The pose now.
    ///
    /// # Errors
    /// [`DeviceError`].
    pub fn report(&self) -> Result<RobotReport, DeviceError> {
        self.post.ask("its pose", self.binding, self.post.deadlines.request * 2, RobotRequest::Report)
    }

    /// Moves, and comes back when the move has ended.
    ///
    /// # Errors
    /// [`DeviceError`]; `Stopped` if somebody stopped the robot meanwhile.
    pub fn move_to(&self, motion: LinearMove, patience: Duration) -> Result<(), DeviceError> {
        self.move_while(motion, patience, || Ok(()))
    }

    /// The same, as long as something else holds. Where that fails the robot moves on: it is the asker's to stop it.
    ///
    /// # Errors
    /// [`DeviceError`]; that of `holds` as soon as it fails.
    pub fn move_while(
        &self,
        motion: LinearMove,
        patience: Duration,
        holds: impl Fn() -> Result<(), DeviceError>,
    ) -> Result<(), DeviceError> {
        let deadline = Instant::now() + patience;
        let patience = patience + self.post.deadlines.request * 3;
        let request = |reply| RobotRequest::Move { motion, deadline, reply };
        self.post.ask_while("a move", self.binding, patience, holds, request)
    }

    /// Stops the robot, whatever it does. Comes back at once.
    pub fn stop(&self) {
        self.post.ask_stop();
    }

    /// Stops the robot, and waits: whether it took the stop; `None` where it could not be told in time.
    #[must_use]
    pub fn stop_and_wait(&self) -> Option<bool> {
        self.post.wait_for_stop(self.post.ask_stop())
    }

    /// The deadlines that the worker keeps.
    #[must_use]
    pub fn deadlines(&self) -> Deadlines {
        self.post.deadlines
    }

    /// One that asks over the connection that is there now, and neither over a later one nor after the next stop.
    #[must_use]
    pub fn of_this_connection(&self) -> Self {
        Self { binding: Some(self.post.bind()), ..self.clone() }
    }

    /// Whether the connection with this number still holds, whatever the robot answers over it.
    #[must_use]
    pub fn has_connection(&self, connection: u64) -> bool {
        self.post.has_connection(connection)
    }

    /// Tells the connection that is there now from those before.
    #[must_use]
    pub fn num_connections(&self) -> u64 {
        self.post.num_connections()
    }

    /// How the connection is.
    #[must_use]
    pub fn link_state(&self, now: Instant) -> LinkState {
        self.post.link_state(now)
    }

    /// What the robot said last.
    #[must_use]
    pub fn latest(&self) -> Option<RobotReport> {
        lock(&self.latest).clone()
    }

    /// Whether there is anything new since this was asked last.
    #[must_use]
    pub fn take_news(&self) -> bool {
        self.post.take_news()
    }
}

/// The robot's thread. Dropping it stops a robot on the move, and ends the thread.
#[derive(Debug)]
pub struct RobotWorker {
    client: RobotClient,
    _hold: Hold<RobotRequest>,
}

impl RobotWorker {
    /// Starts it; `wake` is called when there is news.
    #[must_use]
    pub fn start(connect: Connect<dyn RobotDriver>, deadlines: Deadlines, wake: Wake) -> Self {
        let latest = Arc::default();
        let duty = RobotDuty { latest: Arc::clone(&latest), deadlines, is_moving: false };
        let hold = start(duty, connect, deadlines, wake);
        Self { client: RobotClient { post: Arc::clone(&hold.0), binding: None, latest }, _hold: hold }
    }

    /// Whom to ask.
    #[must_use]
    pub const fn client(&self) -> &RobotClient {
        &self.client
    }
}
