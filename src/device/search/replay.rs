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
            stop: None,
        }
    }

    /// Index of the capture after which a search would have stopped; `None` if it would not have, as far as it has played.
    #[must_use]
    pub fn stop_idx(&self) -> Option<usize> {
        self.stop.as_ref().map(|(idx, _)| *idx)
    }

    /// Where in the state machine the move to the next capture belongs.
    fn phase_of_next(&mut self, from_mm: f64, next: Option<f64>) -> SearchPhase {
        let Some(next_mm) = next else { return SearchPhase::Ended };
        let has_turned = (next_mm - from_mm) * self.report.sign < 0.0;
        if has_turned {
            self.report.sign = -self.report.sign;
        }
        if self.trace.grows().is_none() {
            SearchPhase::Probe
        } else if has_turned {
            SearchPhase::Reverse
        } else if self.trace.beyond_peak_mm(self.report.sign).is_some() {
            SearchPhase::Pass
        } else {
            SearchPhase::Climb
        }
    }
}

impl Iterator for Replay {
    type Item = SearchReport;

    fn next(&mut self) -> Option<SearchReport> {
        let seen = self.recorded.next()?;
        let travelled_mm = seen.travelled_mm;
        self.trace.push(travelled_mm, seen);
        let next_mm = self.recorded.as_slice().first().map(|next| next.travelled_mm);
        self.report.phase = self.phase_of_next(travelled_mm, next_mm);
        if self.stop.is_none() {
            let end = self.trace.misfit().or_else(|| self.trace.found(&self.settings));
            self.stop = end.map(|end| (self.trace.num_captures() - 1, end));
        }
        self.trace.tell(&mut self.report);
        if next_mm.is_none() {
            let end = self.stop.as_ref().map(|(_, end)| end.clone());
            let extent_mm = self.report.points.iter().map(|point| point.travelled_mm.abs()).fold(0.0, f64::max);
            self.report.end = end
                .or_else(|| self.trace.found_after_all(&self.settings))
                .or(Some(SearchEnd::TravelExhausted { max_travel_mm: extent_mm }));
        }
        Some(self.report.clone())
    }
}
