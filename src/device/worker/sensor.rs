//! The profiler's worker: the live profile with what is found in it, and profiles on request.

use std::sync::mpsc::SyncSender;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use super::post::{Binding, Post, lock};
use super::{Connect, Deadlines, Duty, Hold, start};
use crate::device::driver::{ProfileReading, SensorDriver};
use crate::device::error::DeviceError;
use crate::device::link::LinkState;
use crate::fit::{ArcRefusal, Found, Refusal, Sought};
use crate::watch::Wake;

/// A live profile with what was found in it.
#[derive(Clone, Debug, PartialEq)]
pub struct LiveProfile {
    /// The profile.
    pub reading: ProfileReading,
    /// The arc, edge or tip in it; the reason where there is none.
    pub found: Result<Found, Refusal>,
    /// Profiles a second, as they come.
    pub rate_hz: f64,
}

impl LiveProfile {
    /// A profile with what is looked for in it.
    #[must_use]
    pub fn of(reading: ProfileReading, sought: Option<&Sought>, rate_hz: f64) -> Self {
        let found = sought.map_or_else(|| Err(ArcRefusal::NoBall.into()), |sought| sought.find(&reading.profile));
        Self { reading, found, rate_hz }
    }
}

type Sensor = dyn SensorDriver;

/// Something to ask of the profiler's thread.
#[derive(Debug)]
pub enum SensorRequest {
    /// The newest profile.
    Newest(SyncSender<Result<Option<ProfileReading>, DeviceError>>),
    /// To forget what was measured.
    Forget(SyncSender<Result<(), DeviceError>>),
}

/// What is shown to those who look on.
#[derive(Debug, Default)]
struct Shown {
    /// What to look for in the profiles; `None`: for nothing.
    sought: Option<Sought>,
    live: Option<LiveProfile>,
}

struct SensorDuty {
    shown: Arc<Mutex<Shown>>,
    deadlines: Deadlines,
    rate: Rate,
}

impl SensorDuty {
    fn show(&mut self, reading: &ProfileReading, post: &Post<SensorRequest>) {
        let (sought, is_known) = {
            let shown = lock(&self.shown);
            let is_same = |live: &LiveProfile| {
                live.reading.trigger_count == reading.trigger_count && live.reading.profile == reading.profile
            };
            (shown.sought, shown.live.as_ref().is_some_and(is_same))
        };
        if is_known {
            return;
        }
        let live = LiveProfile::of(reading.clone(), sought.as_ref(), self.rate.count(reading.received_at));
        lock(&self.shown).live = Some(live);
        post.tell();
    }
}

impl Duty for SensorDuty {
    type Driver = Sensor;
    type Request = SensorRequest;

    const LOOK_EVERY: Duration = Duration::from_millis(33);
    const DEVICE: &'static str = "Profiler";

    fn look(&mut self, driver: &mut Sensor, post: &Post<SensorRequest>) -> Result<(), DeviceError> {
        if let Some(reading) = driver.newest(Instant::now() + self.deadlines.request)? {
            self.show(&reading, post);
        }
        Ok(())
    }

    fn serve(
        &mut self,
        driver: &mut Sensor,
        request: SensorRequest,
        post: &Post<SensorRequest>,
    ) -> Result<(), DeviceError> {
        let deadline = Instant::now() + self.deadlines.request;
        // Who has given up waiting does not want the answer.
        match request {
            SensorRequest::Newest(reply) => {
                let outcome = driver.newest(deadline);
                let for_link = outcome.as_ref().map(drop).map_err(Clone::clone);
                let reading = outcome.as_ref().ok().cloned().flatten();
                reply.send(outcome).ok();
                // Fits take their time; they are made once the asker has the profile.
                if let Some(reading) = reading {
                    self.show(&reading, post);
                }
                for_link
            }
            SensorRequest::Forget(reply) => {
                let outcome = driver.forget(deadline);
                reply.send(outcome.clone()).ok();
                outcome
            }
        }
    }

    fn refuse(request: SensorRequest, error: DeviceError) {
        match request {
            SensorRequest::Newest(reply) => reply.send(Err(error)).ok(),
            SensorRequest::Forget(reply) => reply.send(Err(error)).ok(),
        };
    }

    fn stop(&mut self, _driver: &mut Sensor) -> Result<(), DeviceError> {
        Ok(())
    }

    fn may_be_moving(&self) -> bool {
        false
    }

    fn hide(&mut self) {
        lock(&self.shown).live = None;
    }
}

/// Profiles a second, smoothed over about ten of them.
#[derive(Debug, Default)]
struct Rate {
    last_at: Option<Instant>,
    period_s: Option<f64>,
}

impl Rate {
    fn count(&mut self, now: Instant) -> f64 {
        const WEIGHT_OF_NEWEST: f64 = 0.1;
        if let Some(last_at) = self.last_at.replace(now) {
            let newest_s = now.saturating_duration_since(last_at).as_secs_f64();
            let period_s = self.period_s.map_or(newest_s, |mean_s| mean_s + WEIGHT_OF_NEWEST * (newest_s - mean_s));
            self.period_s = Some(period_s);
        }
        self.period_s.filter(|period_s| *period_s > 0.0).map_or(0.0, |period_s| 1.0 / period_s)
    }
}

/// Asks the profiler's worker; cheap to copy.
#[derive(Clone, Debug)]
pub struct SensorClient {
    post: Arc<Post<SensorRequest>>,
    binding: Option<Binding>,
    shown: Arc<Mutex<Shown>>,
}

impl SensorClient {
    /// The newest profile; `None` if there is none (yet).
    ///
    /// # Errors
    /// [`DeviceError`].
    pub fn newest(&self) -> Result<Option<ProfileReading>, DeviceError> {
        self.post.ask("a profile", self.binding, self.post.deadlines.request * 2, SensorRequest::Newest)
    }

    /// Forgets what was measured so far, where the device can.
    ///
    /// # Errors
    /// [`DeviceError`].
    pub fn forget(&self) -> Result<(), DeviceError> {
        self.post.ask("clearing its memory", self.binding, self.post.deadlines.request * 2, SensorRequest::Forget)
    }

    /// Whether the connection still holds.
    ///
    /// # Errors
    /// [`DeviceError`]: why it does not.
    pub fn check_connection(&self) -> Result<(), DeviceError> {
        self.post.need_connection("a profile", self.binding)
    }

    /// What to look for in the live profiles; `None`: for nothing.
    pub fn look_for(&self, sought: Option<Sought>) {
        let mut shown = lock(&self.shown);
        if shown.sought != sought {
            shown.sought = sought;
            // The one that is shown was looked at for something else.
            if let Some(live) = shown.live.take() {
                shown.live = Some(LiveProfile::of(live.reading, sought.as_ref(), live.rate_hz));
            }
        }
    }

    /// One that asks over the connection that is there now, and neither over a later one nor after the next stop.
    #[must_use]
    pub fn of_this_connection(&self) -> Self {
        Self { binding: Some(self.post.bind()), ..self.clone() }
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

    /// What the profiler showed last.
    #[must_use]
    pub fn live(&self) -> Option<LiveProfile> {
        lock(&self.shown).live.clone()
    }

    /// The deadlines that the worker keeps.
    #[must_use]
    pub fn deadlines(&self) -> Deadlines {
        self.post.deadlines
    }

    /// Whether there is anything new since this was asked last.
    #[must_use]
    pub fn take_news(&self) -> bool {
        self.post.take_news()
    }
}

/// The profiler's thread. Dropping it ends the thread.
#[derive(Debug)]
pub struct SensorWorker {
    client: SensorClient,
    _hold: Hold<SensorRequest>,
}

impl SensorWorker {
    /// Starts it; `wake` is called when there is news.
    #[must_use]
    pub fn start(connect: Connect<dyn SensorDriver>, deadlines: Deadlines, wake: Wake) -> Self {
        let shown = Arc::default();
        let duty = SensorDuty { shown: Arc::clone(&shown), deadlines, rate: Rate::default() };
        let hold = start(duty, connect, deadlines, wake);
        Self { client: SensorClient { post: Arc::clone(&hold.0), binding: None, shown }, _hold: hold }
    }

    /// Whom to ask.
    #[must_use]
    pub const fn client(&self) -> &SensorClient {
        &self.client
    }
}
