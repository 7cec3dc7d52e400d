//! A recorded session played through the panel: profile, pose and search as if they came from a cell. Nothing is edited.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use crate::app::cell::{LiveProfile, ReplayView};
use crate::calibrate::Reading as MeasuredReading;
use crate::device::search::{Replay as SearchReplay, StepSeen};
use crate::device::{ProfileReading, Readiness, RobotReport, SearchReport};
use crate::fit::{ArcRefusal, Found, Refusal, Sought};
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
    /// What is in the captures of the station that plays, and the reports of its search, one a capture.
    station: Option<Played>,
    /// Gone once the last capture was shown; that stays to be looked at until the replay is ended.
    ticker: Option<Ticker>,
}

/// A station, ready to be played.
struct Played {
    found: Vec<Option<Result<Found, Refusal>>>,
    /// None where nothing is searched.
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
            Some(played) if played.found.len() == station.captures.len() => played,
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
        let found = played.found.get(capture_idx).cloned().flatten();
        view.live = match (&capture.reading, found) {
            (Reading::Profile(profile), Some(found)) => {
                let trigger_count = u32::try_from(capture_idx).unwrap_or_default();
                let reading = ProfileReading { profile: Arc::clone(profile), trigger_count, received_at: now };
                Some(LiveProfile { reading, found, rate_hz: RATE_HZ })
            }
            _ => None,
        };
        view.sensor.latest = view.live.as_ref().map(|live| live.reading.clone());
    }

    /// What is in a station's captures, taken from the results where it is there, and what a search for the largest arc would
    /// have made of it.
    fn played(&self, station_idx: usize, station: &Station) -> Played {
        let sought = self.sought();
        let measured = self.results.as_ref().filter(|results| self.is_current(results.revision));
        let found_in = |(capture_idx, capture): (usize, &Capture)| {
            let Reading::Profile(profile) = &capture.reading else { return None };
            Some(match measured.and_then(|results| results.measured.reading(station_idx, capture_idx)) {
                Some(MeasuredReading::Arc(arc)) => Ok(Found::Arc(Arc::clone(arc))),
                Some(MeasuredReading::Edge(edge)) => Ok(Found::Edge(Arc::clone(edge))),
                Some(MeasuredReading::Refused(refusal)) => Err(refusal.clone()),
                Some(MeasuredReading::Point(_) | MeasuredReading::Pose(_)) | None => {
                    sought.map_or_else(|| Err(ArcRefusal::NoBall.into()), |sought| sought.find(profile))
                }
            })
        };
        let found: Vec<_> = station.captures.iter().enumerate().map(found_in).collect();
        let Some(ball) = sought.as_ref().and_then(Sought::ball) else {
            return Played { found, reports: Vec::new() };
        };
        let seen = travels_mm(&station.captures).into_iter().zip(&found).map(|(travelled_mm, found)| StepSeen {
            travelled_mm,
            radius_and_std_mm: match found {
                Some(Ok(Found::Arc(arc))) => Ok([arc.circle.radius_mm, arc.std_mm()[2]]),
                Some(Err(refusal)) => Err(refusal.to_string()),
                Some(Ok(Found::Edge(_))) | None => Err(words::NO_PROFILE.to_owned()),
            },
        });
        let reports = SearchReplay::new(&self.cell.view.settings.search, ball.ball_radius_mm, seen.collect());
        let reports = reports.map(Arc::new).collect();
        Played { found, reports }
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
