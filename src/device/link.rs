//! The state of a connection. Pure: it is told what happened and when, and says what to do next.

use std::time::{Duration, Instant};

use super::error::DeviceError;

/// How a connection is.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum LinkState {
    /// Not wanted.
    #[default]
    Off,
    /// Being made.
    Connecting,
    /// Made.
    Ready,
    /// Broken, and made anew after a while; or it stands, and the device refuses to show anything over it.
    Failed {
        /// What happened, and what to do.
        error: DeviceError,
        /// How long until it is tried again; `None` where only a person can help.
        retry_in: Option<Duration>,
    },
}

/// The wait before a broken connection is made again; twice as long after each failure in a row ...
const FIRST_WAIT: Duration = Duration::from_millis(500);
/// ... up to this.
const LONGEST_WAIT: Duration = Duration::from_secs(10);
/// A connection that has held for so long has proved itself: what failed before it counts no more.
const PROVEN_AFTER: Duration = Duration::from_secs(5);

#[derive(Clone, Debug)]
enum Stage {
    Connecting,
    Ready { since: Instant, refusal: Option<DeviceError> },
    Failed { error: DeviceError, retry_at: Option<Instant> },
}

/// A connection that is wanted, from its first attempt on.
#[derive(Clone, Debug)]
pub struct Link {
    stage: Stage,
    num_failures: u32,
    num_connections: u64,
}

impl Default for Link {
    fn default() -> Self {
        Self { stage: Stage::Connecting, num_failures: 0, num_connections: 0 }
    }
}

impl Link {
    /// An attempt begins.
    pub fn on_connecting(&mut self) {
        self.stage = Stage::Connecting;
    }

    /// The attempt succeeded.
    pub fn on_connected(&mut self, now: Instant) {
        self.stage = Stage::Ready { since: now, refusal: None };
        self.num_connections += 1;
    }

    /// The attempt failed, or the connection broke.
    pub fn on_failed(&mut self, error: DeviceError, now: Instant) {
        if let Stage::Ready { since, .. } = self.stage
            && now.saturating_duration_since(since) >= PROVEN_AFTER
        {
            self.num_failures = 0;
        }
        self.num_failures = self.num_failures.saturating_add(1);
        let retry_at = error.may_pass_by_itself().then(|| now + wait_after(self.num_failures));
        self.stage = Stage::Failed { error, retry_at };
    }

    /// The device was looked at over a connection that stands: with what it refused, if it did.
    pub fn on_looked(&mut self, found: Option<DeviceError>) {
        if let Stage::Ready { refusal, .. } = &mut self.stage {
            *refusal = found;
        }
    }

    /// What the device refused when it was looked at last.
    #[must_use]
    pub const fn refusal(&self) -> Option<&DeviceError> {
        match &self.stage {
            Stage::Ready { refusal, .. } => refusal.as_ref(),
            Stage::Connecting | Stage::Failed { .. } => None,
        }
    }

    /// When the next attempt is to begin; `None` if there is to be none for now.
    #[must_use]
    pub const fn retry_at(&self) -> Option<Instant> {
        match self.stage {
            Stage::Failed { retry_at, .. } => retry_at,
            Stage::Connecting | Stage::Ready { .. } => None,
        }
    }

    /// Whether the connection is made, whatever the device answers over it.
    #[must_use]
    pub const fn is_made(&self) -> bool {
        matches!(self.stage, Stage::Ready { .. })
    }

    /// Tells this connection from those before: what was begun over one does not go on over another.
    #[must_use]
    pub const fn num_connections(&self) -> u64 {
        self.num_connections
    }

    /// How it is, as seen at a moment.
    #[must_use]
    pub fn state(&self, now: Instant) -> LinkState {
        match &self.stage {
            Stage::Connecting => LinkState::Connecting,
            Stage::Ready { refusal: None, .. } => LinkState::Ready,
            // It is looked at again at once.
            Stage::Ready { refusal: Some(error), .. } => {
                LinkState::Failed { error: error.clone(), retry_in: Some(Duration::ZERO) }
            }
            Stage::Failed { error, retry_at } => LinkState::Failed {
                error: error.clone(),
                retry_in: retry_at.map(|retry_at| retry_at.saturating_duration_since(now)),
            },
        }
    }
}

fn wait_after(num_failures: u32) -> Duration {
    // Beyond ten doublings it is the longest wait anyway.
    let doublings = num_failures.saturating_sub(1).min(10);
    FIRST_WAIT.saturating_mul(1 << doublings).min(LONGEST_WAIT)
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn closed() -> DeviceError {
        DeviceError::Closed { device: "Robot", request: String::new() }
    }

    fn waits(link: &mut Link, num: usize, mut now: Instant) -> Vec<u128> {
        let mut waits = Vec::new();
        for _ in 0..num {
            link.on_connecting();
            link.on_failed(closed(), now);
            let retry_at = link.retry_at().expect("it is tried again");
            waits.push((retry_at - now).as_millis());
            now = retry_at;
        }
        waits
    }

    #[test]
    fn the_waits_double_up_to_a_limit() {
        let mut link = Link::default();
        assert_eq!(waits(&mut link, 7, Instant::now()), [500, 1000, 2000, 4000, 8000, 10_000, 10_000]);
        link.num_failures = u32::MAX;
        assert_eq!(waits(&mut link, 1, Instant::now()), [10_000]);
    }

    #[test]
    fn only_a_connection_that_held_starts_the_waits_anew() {
        let now = Instant::now();
        for (held_s, expected) in [(0, 4000), (4, 4000), (5, 500), (600, 500)] {
            let mut link = Link::default();
            waits(&mut link, 3, now);
            link.on_connecting();
            link.on_connected(now);
            let broken_at = now + Duration::from_secs(held_s);
            link.on_failed(closed(), broken_at);
            assert_eq!(link.retry_at(), Some(broken_at + Duration::from_millis(expected)), "held for {held_s} s");
        }
    }

    #[test]
    fn what_only_a_person_can_help_with_is_not_tried_again() {
        let now = Instant::now();
        let refused = DeviceError::Refused {
            device: "Robot",
            request: String::new(),
            found: String::new(),
            remedy: String::new(),
        };
        let not_ready = DeviceError::NotReady { device: "Robot", found: String::new(), needed: "", remedy: "" };
        for error in [refused, not_ready, DeviceError::CannotMove { device: "Robot" }] {
            let mut link = Link::default();
            link.on_failed(error.clone(), now);
            assert_eq!(link.retry_at(), None);
            assert_eq!(link.state(now), LinkState::Failed { error, retry_in: None });
        }
    }

    #[test]
    fn the_state_counts_down_and_never_below_nothing() {
        let now = Instant::now();
        let mut link = Link::default();
        assert_eq!(link.state(now), LinkState::Connecting);
        link.on_connected(now);
        assert!(link.is_made());
        assert_eq!(link.state(now), LinkState::Ready);
        link.on_failed(closed(), now);
        for (later_ms, expected_ms) in [(0, 500), (300, 200), (500, 0), (900, 0)] {
            let state = link.state(now + Duration::from_millis(later_ms));
            assert_eq!(
                state,
                LinkState::Failed { error: closed(), retry_in: Some(Duration::from_millis(expected_ms)) }
            );
        }
    }

    #[test]
    fn what_the_device_refuses_is_told_and_breaks_nothing() {
        let now = Instant::now();
        let refused = DeviceError::CannotMove { device: "Robot" };
        let mut link = Link::default();
        link.on_looked(Some(refused.clone()));
        assert_eq!(link.state(now), LinkState::Connecting, "there is nothing to look at");
        link.on_connected(now);
        link.on_looked(Some(refused.clone()));
        assert_eq!(link.state(now), LinkState::Failed { error: refused, retry_in: Some(Duration::ZERO) });
        assert!(link.is_made() && link.retry_at().is_none());
        link.on_looked(None);
        assert_eq!(link.state(now), LinkState::Ready);
    }
}
