//! Where a worker's thread and those who ask it meet: requests, stops, the state of the link, and news.

use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use super::Deadlines;
use crate::device::error::DeviceError;
use crate::device::link::{Link, LinkState};
use crate::watch::Wake;

/// Requests that may wait; there is hardly ever more than one.
const MAX_WAITING: usize = 8;

/// What the thread is to do next, the most urgent first.
pub(super) enum Next<Request> {
    /// To end.
    Over,
    /// To stop the device; the count is that of the stops asked for so far.
    Stop(u64),
    /// To answer.
    Request(Request),
    /// Nothing has come by the given time.
    Nothing,
}

#[derive(Debug)]
struct Inside<Request> {
    requests: VecDeque<Request>,
    num_stops_asked: u64,
    num_stops_served: u64,
    /// Whether the device took the last stop; `None` where it could not be told.
    stop_taken: Option<bool>,
    /// The same of the stop that was tried as the connection broke.
    stop_taken_at_break: Option<bool>,
    /// Whether the thread is at a request, such as a move.
    is_serving: bool,
    is_over: bool,
    is_left: bool,
}

#[derive(Debug)]
struct Board<Request> {
    inside: Mutex<Inside<Request>>,
    changed: Condvar,
}

pub(super) struct Post<Request> {
    device: &'static str,
    pub(super) deadlines: Deadlines,
    board: Board<Request>,
    link: Mutex<Link>,
    has_news: AtomicBool,
    wake: Wake,
}

impl<Request> std::fmt::Debug for Post<Request> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_struct("Post").field("device", &self.device).finish_non_exhaustive()
    }
}

/// A thread that panicked while it held the lock has left plain data behind, whole at any time.
pub(super) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl<Request> Post<Request> {
    pub fn new(device: &'static str, deadlines: Deadlines, wake: Wake) -> Self {
        let inside = Inside {
            requests: VecDeque::new(),
            num_stops_asked: 0,
            num_stops_served: 0,
            stop_taken: None,
            stop_taken_at_break: None,
            is_serving: false,
            is_over: false,
            is_left: false,
        };
        Self {
            device,
            deadlines,
            board: Board { inside: Mutex::new(inside), changed: Condvar::new() },
            link: Mutex::new(Link::default()),
            has_news: AtomicBool::new(false),
            wake,
        }
    }

    // What the thread does.

    /// Waits until there is something to do, at most until `until`.
    pub fn next(&self, until: Option<Instant>) -> Next<Request> {
        let mut inside = lock(&self.board.inside);
        loop {
            if inside.is_over {
                return Next::Over;
            }
            inside.is_serving = false;
            if inside.num_stops_served < inside.num_stops_asked {
                return Next::Stop(inside.num_stops_asked);
            }
            if let Some(request) = inside.requests.pop_front() {
                inside.is_serving = true;
                return Next::Request(request);
            }
            let Some(until) = until else {
                inside = self.board.changed.wait(inside).unwrap_or_else(PoisonError::into_inner);
                continue;
            };
            let left = until.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Next::Nothing;
            }
            inside = self.board.changed.wait_timeout(inside, left).unwrap_or_else(PoisonError::into_inner).0;
        }
    }

    /// Waits for so long; answers whether a stop (or the end) came in.
    pub fn is_interrupted_within(&self, patience: Duration) -> bool {
        let is_calm =
            |inside: &mut Inside<Request>| !inside.is_over && inside.num_stops_served == inside.num_stops_asked;
        let waited = self.board.changed.wait_timeout_while(lock(&self.board.inside), patience, is_calm);
        !waited.unwrap_or_else(PoisonError::into_inner).1.timed_out()
    }

    pub fn note_stopped(&self, count: u64, taken: Option<bool>) {
        self.change(|inside| {
            inside.num_stops_served = count;
            inside.stop_taken = taken;
            inside.stop_taken_at_break = None;
        });
    }

    pub fn note_stopped_by_break(&self, taken: Option<bool>) {
        self.change(|inside| inside.stop_taken_at_break = taken);
    }

    /// There is no connection to stop by; what is known is how it went as it broke.
    pub fn note_stopped_without_connection(&self, count: u64) {
        self.change(|inside| {
            inside.num_stops_served = count;
            inside.stop_taken = inside.stop_taken_at_break.filter(|taken| *taken);
        });
    }

    /// The thread ends: nobody is left waiting.
    pub fn leave(&self, refuse: impl FnMut(Request)) {
        let mut waiting = VecDeque::new();
        self.change(|inside| {
            inside.is_left = true;
            inside.num_stops_served = inside.num_stops_asked;
            std::mem::swap(&mut waiting, &mut inside.requests);
        });
        waiting.into_iter().for_each(refuse);
    }

    pub fn change_link(&self, change: impl FnOnce(&mut Link)) {
        change(&mut lock(&self.link));
        self.tell();
    }

    pub fn retry_at(&self) -> Option<Instant> {
        lock(&self.link).retry_at()
    }

    /// There is something new to be seen; who was woken and has not looked yet is not woken again.
    pub fn tell(&self) {
        if !self.has_news.swap(true, Ordering::AcqRel) {
            (self.wake)();
        }
    }

    // What the others do.

    pub fn take_news(&self) -> bool {
        self.has_news.swap(false, Ordering::AcqRel)
    }

    pub fn is_over(&self) -> bool {
        lock(&self.board.inside).is_over
    }

    pub fn link_state(&self, now: Instant) -> LinkState {
        lock(&self.link).state(now)
    }

    /// Asks, and waits for the answer until the deadline and a little longer: the thread keeps it, too.
    ///
    /// Over any other connection than the one given there is no answer.
    pub fn ask<Answer>(
        &self,
        what: &str,
        connection: Option<u64>,
        patience: Duration,
        request: impl FnOnce(SyncSender<Result<Answer, DeviceError>>) -> Request,
    ) -> Result<Answer, DeviceError> {
        self.need_connection(what, connection)?;
        let (sender, receiver): (_, Receiver<Result<Answer, DeviceError>>) = sync_channel(1);
        let timeout = || DeviceError::Timeout { device: self.device, request: what.to_owned(), waited: patience };
        {
            let mut inside = lock(&self.board.inside);
            if inside.is_over || inside.is_left {
                return Err(DeviceError::Stopped { device: self.device });
            }
            if inside.requests.len() >= MAX_WAITING {
                return Err(timeout());
            }
            inside.requests.push_back(request(sender));
        }
        self.board.changed.notify_all();
        match receiver.recv_timeout(patience) {
            Ok(answer) => answer,
            Err(RecvTimeoutError::Timeout) => Err(timeout()),
            Err(RecvTimeoutError::Disconnected) => Err(self.closed(what)),
        }
    }

    fn need_connection(&self, what: &str, connection: Option<u64>) -> Result<(), DeviceError> {
        let (state, num_connections) = {
            let link = lock(&self.link);
            (link.state(Instant::now()), link.num_connections())
        };
        match state {
            LinkState::Ready if connection.is_none_or(|connection| connection == num_connections) => Ok(()),
            LinkState::Ready => Err(self.closed(what)),
            LinkState::Failed { error, .. } => Err(error),
            LinkState::Off | LinkState::Connecting => Err(DeviceError::NotReady {
                device: self.device,
                found: "no connection yet".to_owned(),
                needed: "a connection",
                remedy: "wait until it is connected",
            }),
        }
    }

    fn closed(&self, what: &str) -> DeviceError {
        DeviceError::Closed { device: self.device, request: what.to_owned() }
    }

    pub fn num_connections(&self) -> u64 {
        lock(&self.link).num_connections()
    }

    /// Asks for a stop; answers which one it is.
    pub fn ask_stop(&self) -> u64 {
        let mut count = 0;
        self.change(|inside| {
            inside.num_stops_asked += 1;
            count = inside.num_stops_asked;
        });
        count
    }

    /// Whether the device took the stop; `None` where it could not be told in time.
    pub fn wait_for_stop(&self, count: u64) -> Option<bool> {
        // The thread may be within a request, which has a deadline of its own.
        let patience = self.deadlines.request + self.deadlines.stop;
        let is_waiting = |inside: &mut Inside<Request>| inside.num_stops_served < count;
        let waited = self.board.changed.wait_timeout_while(lock(&self.board.inside), patience, is_waiting);
        let (inside, timeout) = waited.unwrap_or_else(PoisonError::into_inner);
        if timeout.timed_out() { None } else { inside.stop_taken }
    }

    /// Ends the thread; waits a little if it is at a request: a robot on the move is to be told to stop.
    pub fn end(&self, patience: Duration) {
        let mut inside = lock(&self.board.inside);
        inside.is_over = true;
        self.board.changed.notify_all();
        let is_at_it = |inside: &mut Inside<Request>| inside.is_serving && !inside.is_left;
        let waited = self.board.changed.wait_timeout_while(inside, patience, is_at_it);
        drop(waited);
    }

    fn change(&self, change: impl FnOnce(&mut Inside<Request>)) {
        change(&mut lock(&self.board.inside));
        self.board.changed.notify_all();
    }
}
