//! A recorded session played through the panel: profile, pose and search as if they came from a cell. Nothing is edited.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use crate::app::cell::{LiveProfile, ReplayView};
use crate::calibrate::Reading as MeasuredReading;
use crate::device::search::{Replay as SearchReplay, StepSeen};
use crate::device::{ProfileReading, Readiness, RobotReport, SearchReport};
use crate::fit::{ArcFit, ArcRefusal, Refusal, extract_arc};
use crate::geometry::Vec3;
use crate::session::{Capture, Reading, Station};
use crate::text::cell as words;
use crate::watch::Wake;

use super::super::{NoticeKind, Workbench};

/// Captures a second.
const RATE_HZ: f64 = 10.0;
/// Time between two captures.
const PERIOD: Duration = Duration::from_millis(100);

/// A replay under way.
pub(super) struct Replay {
    document_id: u64,
    next_at: Instant,
    station_idx: usize,
    capture_idx: usize,
    /// The arcs and the reports of the station that plays, one a capture.
    station: Option<Played>,
    /// Gone once the last capture was shown; that stays to be looked at until the replay is ended.
    ticker: Option<Ticker>,
}

/// A station, ready to be played.
struct Played {
    arcs: Vec<Option<Result<Arc<ArcFit>, ArcRefusal>>>,
    reports: Vec<Arc<SearchReport>>,
}

/// Wakes the window for each capture.
struct Ticker(Arc<AtomicBool>);

impl Ticker {
    fn start(wake: Wake) -> Self {
        let is_over = Arc::new(AtomicBool::new(false));
        let watched = Arc::clone(&is_over);
        // Without a thread the replay goes on only while something else wakes the window: a pity, but no harm.
        let ticker = thread::Builder::new().name("replay".to_owned()).spawn(move || {
            while !watched.load(Ordering::Relaxed) {
                thread::sleep(PERIOD);
                wake();
            }
        });
        drop(ticker);
        Self(is_over)
    }
}

impl Drop for Ticker {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

impl Workbench {
    pub(super) fn start_replay(&mut self) {
        if self.cell.measuring.is_some() || self.cell.run.is_some() {
            self.notify_of_cell(NoticeKind::Error, words::BUSY.to_owned());
            return;
        }
        let has_profile = |capture: &Capture| matches!(capture.reading, Reading::Profile(_));
        let document = self
            .document
            .as_ref()
            .filter(|document| document.session.stations.iter().flat_map(|station| &station.captures).any(has_profile));
        let Some(document) = document else {
            self.notify_of_cell(NoticeKind::Error, words::NOTHING_TO_REPLAY.to_owned());
            return;
        };
        self.cell.view.search = None;
        self.cell.view.replay = Some(ReplayView { station_idx: 0, capture_idx: 0, is_over: false });
        self.cell.replay = Some(Replay {
            document_id: document.id,
            next_at: Instant::now(),
            station_idx: 0,
            capture_idx: 0,
            station: None,
            ticker: Some(Ticker::start(self.wake.clone())),
        });
        // It was made for where the robot is, and what is shown now is where it was.
        self.forget_proposal();
    }

    pub(super) fn end_replay(&mut self) {
        let was_shown = self.cell.view.replay.take().is_some();
        self.cell.replay = None;
        if was_shown {
            // What came over the links is shown again.
            self.cell.view.search = None;
            self.cell.view.robot.latest = self.cell.robot.as_ref().and_then(|robot| robot.client().latest());
            self.cell.view.live = self.cell.sensor.as_ref().and_then(|sensor| sensor.client().live());
            self.cell.view.sensor.latest = self.cell.view.live.as_ref().map(|live| live.reading.clone());
        }
    }

    /// Shows the next capture once its time has come.
    pub(super) fn poll_replay(&mut self, now: Instant) -> bool {
        let Some(mut replay) = self.cell.replay.take() else { return false };
        if replay.ticker.is_none() || now < replay.next_at {
            self.cell.replay = Some(replay);
            return false;
        }
        // After a pause of the window nothing is made up for.
        replay.next_at = now + PERIOD;
        let session = match &self.document {
            Some(document) if document.id == replay.document_id => Arc::clone(&document.session),
            _ => {
                self.end_replay();
                return true;
            }
        };
        while session.stations.get(replay.station_idx).is_some_and(|at| replay.capture_idx >= at.captures.len()) {
            (replay.station_idx, replay.capture_idx, replay.station) = (replay.station_idx + 1, 0, None);
        }
        let Some(station) = session.stations.get(replay.station_idx) else {
            if let Some(view) = &mut self.cell.view.replay {
                view.is_over = true;
            }
            replay.ticker = None;
            self.cell.replay = Some(replay);
            return true;
        };
        let (station_idx, capture_idx) = (replay.station_idx, replay.capture_idx);
        // An edit during the replay may have changed the station: it is worked out anew if it does not fit any more.
        let played = match replay.station.take() {
            Some(played) if played.arcs.len() == station.captures.len() => played,
            _ => self.played(station_idx, station),
        };
        self.show_recorded(&station.captures[capture_idx], &played, capture_idx, now);
        self.cell.view.replay = Some(ReplayView { station_idx, capture_idx, is_over: false });
        replay.station = Some(played);
        replay.capture_idx += 1;
        self.cell.replay = Some(replay);
        true
    }

    fn show_recorded(&mut self, capture: &Capture, played: &Played, capture_idx: usize, now: Instant) {
        let view = &mut self.cell.view;
        view.robot.latest = Some(RobotReport {
            base_from_flange: capture.base_from_flange,
            joints_deg: Vec::new(),
            is_moving: None,
            readiness: Readiness::ReadOnly,
            tool: String::new(),
            resolution_mm: 0.0,
            received_at: now,
        });
        view.search = played.reports.get(capture_idx).cloned();
        let arc = played.arcs.get(capture_idx).cloned().flatten();
        view.live = match (&capture.reading, arc) {
            (Reading::Profile(profile), Some(arc)) => {
                let trigger_count = u32::try_from(capture_idx).unwrap_or_default();
                let reading = ProfileReading { profile: Arc::clone(profile), trigger_count, received_at: now };
                Some(LiveProfile { reading, arc, rate_hz: RATE_HZ })
            }
            _ => None,
        };
        view.sensor.latest = view.live.as_ref().map(|live| live.reading.clone());
    }

    /// The arcs of a station, taken from the results where they are there, and what a search would have made of them.
    fn played(&self, station_idx: usize, station: &Station) -> Played {
        let ball = self.ball();
        let measured = self.results.as_ref().filter(|results| self.is_current(results.revision));
        let arc_of = |(capture_idx, capture): (usize, &Capture)| {
            let Reading::Profile(profile) = &capture.reading else { return None };
            Some(match measured.and_then(|results| results.measured.reading(station_idx, capture_idx)) {
                Some(MeasuredReading::Arc(arc)) => Ok(Arc::clone(arc)),
                Some(MeasuredReading::Refused(Refusal::Arc(refusal))) => Err(refusal.clone()),
                _ => ball.map_or(Err(ArcRefusal::NoBall), |ball| extract_arc(profile, &ball).map(Arc::new)),
            })
        };
        let arcs: Vec<_> = station.captures.iter().enumerate().map(arc_of).collect();
        let radius_mm = ball.map_or(0.0, |ball| ball.ball_radius_mm);
        let seen = travels_mm(&station.captures).into_iter().zip(&arcs).map(|(travelled_mm, arc)| StepSeen {
            travelled_mm,
            radius_and_std_mm: match arc {
                Some(Ok(arc)) => Ok([arc.circle.radius_mm, arc.std_mm()[2]]),
                Some(Err(refusal)) => Err(refusal.to_string()),
                None => Err(words::NO_PROFILE.to_owned()),
            },
        });
        let reports = SearchReplay::new(&self.cell.view.settings.search, radius_mm, seen.collect());
        let reports = reports.map(Arc::new).collect();
        Played { arcs, reports }
    }
}

/// How far each capture is from the first, mm: along the way from the first to the furthest, whose sign is that of the first
/// commanded step.
fn travels_mm(captures: &[Capture]) -> Vec<f64> {
    let first_mm = captures.first().map_or_else(Vec3::zeros, |capture| capture.base_from_flange.translation_mm());
    let offsets: Vec<Vec3> =
        captures.iter().map(|capture| capture.base_from_flange.translation_mm() - first_mm).collect();
    let furthest = offsets.iter().copied().max_by(|a, b| a.norm().total_cmp(&b.norm())).unwrap_or_default();
    let direction = furthest.try_normalize(0.0).unwrap_or_default();
    let first_step_mm = captures.get(1).and_then(|capture| capture.step_mm).unwrap_or(1.0);
    let first_travel_mm = offsets.get(1).map_or(1.0, |offset| offset.dot(&direction));
    let sign = if first_step_mm * first_travel_mm < 0.0 { -1.0 } else { 1.0 };
    offsets.iter().map(|offset| sign * offset.dot(&direction)).collect()
}
