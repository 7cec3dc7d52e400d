//! Recorded captures played through the search: nothing is decided, but it shows what a search would have made of them.

use super::end::SearchEnd;
use super::report::{SearchPhase, SearchReport, StepSeen};
use super::settings::SearchSettings;
use super::trace::Trace;

/// The reports of a search to which these captures came in this order, one a capture.
#[derive(Clone, Debug)]
pub struct Replay {
    settings: SearchSettings,
    trace: Trace,
    recorded: std::vec::IntoIter<StepSeen>,
    report: SearchReport,
    previous_mm: Option<f64>,
    /// How it would have ended.
    stop: Option<(usize, SearchEnd)>,
}

impl Replay {
    /// Of captures in their order. Of the settings, only the stop rule and the noise of the travel matter.
    #[must_use]
    pub fn new(settings: &SearchSettings, ball_radius_mm: f64, recorded: Vec<StepSeen>) -> Self {
        Self {
            settings: *settings,
            trace: Trace::new(settings, ball_radius_mm),
            recorded: recorded.into_iter(),
            report: SearchReport { sign: 1.0, ..SearchReport::default() },
            previous_mm: None,
            stop: None,
        }
    }

    /// Index of the capture after which a search would have stopped; `None` if it would not have, as far as it has played.
    #[must_use]
    pub fn stop_idx(&self) -> Option<usize> {
        self.stop.as_ref().map(|(idx, _)| *idx)
    }

    /// Where in the state machine the capture belongs.
    fn advance(&mut self, travelled_mm: f64) {
        let way_mm = self.previous_mm.replace(travelled_mm).map_or(0.0, |previous| travelled_mm - previous);
        // Without a way there is no change of it.
        let has_turned = way_mm * self.report.sign < 0.0;
        if has_turned {
            self.report.sign = -self.report.sign;
        }
        self.report.phase = match self.report.phase {
            SearchPhase::First if self.trace.num_captures() <= 1 => SearchPhase::First,
            SearchPhase::First | SearchPhase::Probe if self.trace.grows().is_none() => SearchPhase::Probe,
            _ if self.trace.beyond_peak_mm(self.report.sign).is_some() => SearchPhase::Pass,
            _ if has_turned => SearchPhase::Reverse,
            _ => SearchPhase::Climb,
        };
    }
}

impl Iterator for Replay {
    type Item = SearchReport;

    fn next(&mut self) -> Option<SearchReport> {
        let seen = self.recorded.next()?;
        let travelled_mm = seen.travelled_mm;
        self.trace.push(travelled_mm, seen);
        self.advance(travelled_mm);
        if self.stop.is_none() {
            let end = self.trace.misfit().or_else(|| self.trace.found(&self.settings));
            self.stop = end.map(|end| (self.trace.num_captures() - 1, end));
        }
        self.trace.tell(&mut self.report);
        if self.recorded.len() == 0 {
            let end = self.stop.as_ref().map(|(_, end)| end.clone());
            let extent_mm = self.report.points.iter().map(|point| point.travelled_mm.abs()).fold(0.0, f64::max);
            self.report.end = end
                .or_else(|| self.trace.found_after_all(&self.settings))
                .or(Some(SearchEnd::TravelExhausted { max_travel_mm: extent_mm }));
            self.report.phase = SearchPhase::Ended;
        }
        Some(self.report.clone())
    }
}
