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

/// Between two looks at what has to hold while an answer is waited for.
const WATCH_EVERY: Duration = Duration::from_millis(20);

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

/// When a client was bound: what begins then goes on neither over a later connection nor past a later stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Binding {
    connection: u64,
    num_stops_asked: u64,
}

#[derive(Debug)]
struct Inside<Request> {
    requests: VecDeque<Request>,
    num_stops_asked: u64,
    num_stops_served: u64,
    /// Whether the device took the last stop; `None` where it could not be told.
    stop_taken: Option<bool>,
    /// The same of the stop that the thread tried of itself.
    stop_taken_unasked: Option<bool>,
    /// Whether the thread is at something that may have to be stopped, or stops it.
    is_at_it: bool,
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
            stop_taken_unasked: None,
            is_at_it: false,
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

    /// Waits until there is something to do, at most until `until`. A stop that was asked for comes even before the end.
    pub fn next(&self, until: Option<Instant>, may_be_moving: bool) -> Next<Request> {
        let mut inside = lock(&self.board.inside);
        loop {
            if inside.num_stops_served < inside.num_stops_asked {
                inside.is_at_it = true;
                return Next::Stop(inside.num_stops_asked);
            }
            if inside.is_over {
                return Next::Over;
            }
            if let Some(request) = inside.requests.pop_front() {
                inside.is_at_it = true;
                return Next::Request(request);
            }
            inside.is_at_it = may_be_moving;
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
            inside.stop_taken_unasked = None;
        });
    }

    /// The thread has stopped the device of itself; `None`: there was no need.
    pub fn note_stopped_unasked(&self, taken: Option<bool>) {
        lock(&self.board.inside).stop_taken_unasked = taken;
    }

    /// How the look at the device went.
    pub fn note_look(&self, refusal: Option<&DeviceError>) {
        let is_known = lock(&self.link).refusal() == refusal;
        if !is_known {
            self.change_link(|link| link.on_looked(refusal.cloned()));
        }
    }

    /// There is no connection to stop by; what is known is how it went as it broke.
    pub fn note_stopped_without_connection(&self, count: u64) {
        self.change(|inside| {
            inside.num_stops_served = count;
            inside.stop_taken = inside.stop_taken_unasked.filter(|taken| *taken);
        });
    }

    /// The thread ends: nobody is left waiting.
    pub fn leave(&self, refuse: impl FnMut(Request)) {
        let mut waiting = VecDeque::new();
        self.change(|inside| {
            inside.is_left = true;
            inside.num_stops_served = inside.num_stops_asked;
            inside.stop_taken = inside.stop_taken_unasked.or(inside.stop_taken);
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
    /// Who is bound gets no answer over another connection or after a stop. What still waits when a stop is asked for is
    /// not done any more.
    pub fn ask<Answer>(
        &self,
        what: &str,
        binding: Option<Binding>,
        patience: Duration,
        request: impl FnOnce(SyncSender<Result<Answer, DeviceError>>) -> Request,
    ) -> Result<Answer, DeviceError> {
        self.ask_while(what, binding, patience, || Ok(()), request)
    }

    /// The same, as long as something else holds: otherwise its error is the answer, and the thread is at the request still.
    pub fn ask_while<Answer>(
        &self,
        what: &str,
        binding: Option<Binding>,
        patience: Duration,
        holds: impl Fn() -> Result<(), DeviceError>,
        request: impl FnOnce(SyncSender<Result<Answer, DeviceError>>) -> Request,
    ) -> Result<Answer, DeviceError> {
        self.need_connection(what, binding)?;
        let (sender, receiver): (_, Receiver<Result<Answer, DeviceError>>) = sync_channel(1);
        let timeout = || DeviceError::Timeout { device: self.device, request: what.to_owned(), waited: patience };
        let stopped = || DeviceError::Stopped { device: self.device };
        let num_stops_asked = {
            let mut inside = lock(&self.board.inside);
            let is_past_stop = binding.is_some_and(|binding| binding.num_stops_asked != inside.num_stops_asked);
            if inside.is_over || inside.is_left || is_past_stop {
                return Err(stopped());
            }
            if inside.requests.len() >= MAX_WAITING {
                return Err(timeout());
            }
            inside.requests.push_back(request(sender));
            inside.num_stops_asked
        };
        self.board.changed.notify_all();
        let deadline = Instant::now() + patience;
        loop {
            let left = deadline.saturating_duration_since(Instant::now());
            match receiver.recv_timeout(left.min(WATCH_EVERY)) {
                Ok(answer) => return answer,
                Err(RecvTimeoutError::Timeout) if left.is_zero() => return Err(timeout()),
                Err(RecvTimeoutError::Timeout) => holds()?,
                Err(RecvTimeoutError::Disconnected) if self.num_stops_asked() != num_stops_asked => {
                    return Err(stopped());
                }
                Err(RecvTimeoutError::Disconnected) => return Err(self.closed(what)),
            }
        }
    }

    /// The connection that is there, and to which somebody is bound; or why there is none.
    pub fn need_connection(&self, what: &str, binding: Option<Binding>) -> Result<(), DeviceError> {
        let (is_made, state, num_connections) = {
            let link = lock(&self.link);
            (link.is_made(), link.state(Instant::now()), link.num_connections())
        };
        match state {
            _ if is_made && binding.is_none_or(|binding| binding.connection == num_connections) => Ok(()),
            _ if is_made => Err(self.closed(what)),
            LinkState::Failed { error, .. } => Err(error),
            LinkState::Off | LinkState::Connecting | LinkState::Ready => Err(DeviceError::NotReady {
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

    /// Whether the connection with this number still holds.
    pub fn has_connection(&self, connection: u64) -> bool {
        let link = lock(&self.link);
        link.is_made() && link.num_connections() == connection
    }

    pub fn num_connections(&self) -> u64 {
        lock(&self.link).num_connections()
    }

    fn num_stops_asked(&self) -> u64 {
        lock(&self.board.inside).num_stops_asked
    }

    /// To the connection that is there now, until the next stop.
    pub fn bind(&self) -> Binding {
        Binding { connection: self.num_connections(), num_stops_asked: self.num_stops_asked() }
    }

    /// Asks for a stop; answers which one it is. Whatever waits is dropped, and so refused: it could be a move.
    pub fn ask_stop(&self) -> u64 {
        let mut count = 0;
        self.change(|inside| {
            inside.num_stops_asked += 1;
            inside.requests.clear();
            count = inside.num_stops_asked;
        });
        count
    }

    /// Whether the device took the stop; `None` where it could not be told in time.
    pub fn wait_for_stop(&self, count: u64) -> Option<bool> {
        let is_waiting = |inside: &mut Inside<Request>| inside.num_stops_served < count && !inside.is_left;
        let waited = self.board.changed.wait_timeout_while(lock(&self.board.inside), self.stop_patience(), is_waiting);
        let (inside, timeout) = waited.unwrap_or_else(PoisonError::into_inner);
        if timeout.timed_out() { None } else { inside.stop_taken }
    }

    /// Within a move the thread may be at two questions, each with a deadline of its own, before it comes to the stop.
    fn stop_patience(&self) -> Duration {
        self.deadlines.request * 2 + self.deadlines.stop
    }

    /// Ends the thread; waits if something may be on the move: it is to be told to stop before the program ends.
    pub fn end(&self) {
        let mut inside = lock(&self.board.inside);
        inside.is_over = true;
        self.board.changed.notify_all();
        let is_at_it = |inside: &mut Inside<Request>| inside.is_at_it && !inside.is_left;
        let waited = self.board.changed.wait_timeout_while(inside, self.stop_patience(), is_at_it);
        drop(waited);
    }

    fn change(&self, change: impl FnOnce(&mut Inside<Request>)) {
        change(&mut lock(&self.board.inside));
        self.board.changed.notify_all();
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;

    #[test]
    fn what_waits_as_a_stop_is_asked_for_is_not_done() {
        /// Long past anything that is waited for here.
        const PATIENCE: Duration = Duration::from_secs(20);
        let post = Arc::new(Post::new("Test", Deadlines::default(), Arc::new(|| {})));
        post.change_link(|link| link.on_connected(Instant::now()));
        let asked = Arc::clone(&post);
        let asker = std::thread::spawn(move || {
            asked.ask("a move", None, PATIENCE, |reply: SyncSender<Result<(), DeviceError>>| reply)
        });
        let deadline = Instant::now() + PATIENCE;
        while lock(&post.board.inside).requests.is_empty() {
            assert!(Instant::now() < deadline, "the move waits");
            std::thread::sleep(Duration::from_millis(1));
        }
        let count = post.ask_stop();
        assert!(matches!(post.next(None, false), Next::Stop(_)));
        post.note_stopped(count, Some(true));
        assert!(matches!(post.next(Some(Instant::now()), false), Next::Nothing));
        assert_eq!(asker.join().ok(), Some(Err(DeviceError::Stopped { device: "Test" })));
    }
}
