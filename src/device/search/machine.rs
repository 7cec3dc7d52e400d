//! Where to go next: the state machine of Fig. 3, made proof against noise.
//!
//! R₁ at the start, R₂ a step on. While the two differ by less than noise, more steps decide, not a coin. A falling radius
//! turns the search round: what was captured stays in the curve. From then on it walks over the peak until the stop rule is
//! satisfied, coarsely while far from it. Where one side gives nothing more, the other one is tried.

use super::end::SearchEnd;
use super::report::{SearchPhase, SearchReport, StepSeen};
use super::settings::{SearchSettings, SettingsRefusal};
use super::trace::Trace;

/// Nearer to the ball's middle than this part of its radius the steps are fine.
const NEAR_PART: f64 = 0.25;
/// No step is longer than this part of the radius.
const LONGEST_STEP_PART: f64 = 0.25;
/// Further beyond the peak than this part of the radius there is little to be learned.
const FAR_PART: f64 = 0.6;
/// Steps of a probe that are fine; if noise still hides the slope then, coarse ones are quicker.
const NUM_FINE_PROBES: usize = 2;
/// From the very peak the radius falls by 3 % over this part of it, so where that does not show it never will.
const FLAT_PART: f64 = 0.25;
/// Profiles without an arc at one place before it counts as having none.
const REFUSED_AT_ONE_PLACE: u8 = 2;
/// Profiles without an arc in a row before it is lost; one or two may be holes.
const REFUSED_IN_A_ROW: u8 = 3;
/// A robot that is off its target by this part of a step, or of the whole way, twice in a row is stuck.
const STUCK_STEP_PART: f64 = 0.5;
const STUCK_WAY_PART: f64 = 0.05;
/// Noise of the reported poses alone does not make it so.
const STUCK_AT_STDS: f64 = 8.0;

/// What a search wants next.
#[derive(Clone, Debug, PartialEq)]
pub enum SearchNext {
    /// Go to this distance from the first profile along the direction, and capture.
    CaptureAt {
        /// The distance, signed, mm.
        commanded_mm: f64,
    },
    /// Nothing: it is over.
    Over(SearchEnd),
}

/// A search under way.
#[derive(Clone, Debug)]
pub struct Search {
    settings: SearchSettings,
    ball_radius_mm: f64,
    trace: Trace,
    report: SearchReport,
    next: SearchNext,
    forward: Way,
    backward: Way,
    /// Profiles in a row without an arc.
    num_refused: u8,
    /// Captures in a row off their target.
    num_stuck: u8,
}

/// One of the two ways from the start.
#[derive(Clone, Copy, Debug, Default)]
struct Way {
    /// How far it was gone, mm.
    reached_mm: f64,
    /// Whether nothing more is to be had there.
    is_closed: bool,
}

/// What to do: capture there, mm, or end.
type Decision = Result<f64, SearchEnd>;

impl Search {
    /// A search that has seen nothing yet. Settings that make no search end it at once, see [`SearchSettings::check`].
    #[must_use]
    pub fn new(settings: &SearchSettings, ball_radius_mm: f64) -> Self {
        let has_radius = ball_radius_mm.is_finite() && ball_radius_mm > 0.0;
        let no_radius = SettingsRefusal::NotPositive { what: "the ball's radius", found_mm: ball_radius_mm };
        let checked = settings.check().and(if has_radius { Ok(()) } else { Err(no_radius) });
        let mut search = Self {
            settings: *settings,
            ball_radius_mm,
            trace: Trace::new(settings, ball_radius_mm),
            report: SearchReport { sign: 1.0, ..SearchReport::default() },
            next: SearchNext::CaptureAt { commanded_mm: 0.0 },
            forward: Way::default(),
            backward: Way::default(),
            num_refused: 0,
            num_stuck: 0,
        };
        if let Err(refusal) = checked {
            search.settle(Err(SearchEnd::NotBegun(refusal)));
        }
        search
    }

    /// What to do next; the first is a capture at 0.
    #[must_use]
    pub fn next(&self) -> SearchNext {
        self.next.clone()
    }

    /// Takes in what was seen where [`Self::next`] sent the robot. Once it is over nothing changes it.
    pub fn take(&mut self, seen: StepSeen) {
        let SearchNext::CaptureAt { commanded_mm } = self.next else { return };
        let travelled_mm = seen.travelled_mm;
        let refusal = self.trace.push(commanded_mm, seen);
        let way = self.way_mut(if commanded_mm < 0.0 { -1.0 } else { 1.0 });
        way.reached_mm = way.reached_mm.max(commanded_mm.abs());
        let decision = self.decide(commanded_mm, travelled_mm, refusal).and_then(|commanded_mm| {
            if self.trace.num_captures() < usize::from(self.settings.max_captures) {
                Ok(commanded_mm)
            } else {
                let max_captures = self.settings.max_captures;
                Err(self.conclusion(SearchEnd::CapturesExhausted { max_captures }))
            }
        });
        self.settle(decision);
    }

    /// How it stands.
    #[must_use]
    pub const fn report(&self) -> &SearchReport {
        &self.report
    }

    fn settle(&mut self, decision: Decision) {
        self.trace.tell(&mut self.report);
        self.next = match decision {
            Ok(commanded_mm) => SearchNext::CaptureAt { commanded_mm },
            Err(end) => {
                self.report.phase = SearchPhase::Ended;
                self.report.end = Some(end.clone());
                SearchNext::Over(end)
            }
        };
    }

    fn decide(&mut self, commanded_mm: f64, travelled_mm: f64, refusal: Option<String>) -> Decision {
        if self.is_off_target(commanded_mm, travelled_mm) {
            self.num_stuck += 1;
            // Once it may have been on its way still.
            return if self.num_stuck > 1 {
                Err(SearchEnd::Stuck { commanded_mm, travelled_mm })
            } else {
                Ok(commanded_mm)
            };
        }
        self.num_stuck = 0;
        if let Some(reason) = refusal {
            self.num_refused += 1;
            return self.after_refusal(commanded_mm, travelled_mm, reason);
        }
        self.num_refused = 0;
        // While nothing is known of the slope there is no curve that anything could be off.
        let is_open = self.report.phase == SearchPhase::Probe && self.trace.grows().is_none();
        let misfit = if is_open { None } else { self.trace.misfit() };
        if let Some(end) = misfit.or_else(|| self.trace.found(&self.settings)) {
            return Err(end);
        }
        match self.report.phase {
            SearchPhase::First => {
                self.report.phase = SearchPhase::Probe;
                self.step_on()
            }
            SearchPhase::Probe if is_open && travelled_mm.abs() > FLAT_PART * self.ball_radius_mm => {
                Err(SearchEnd::RadiusUnchanged { travelled_mm: travelled_mm.abs() })
            }
            SearchPhase::Probe if is_open => self.step_on(),
            SearchPhase::Probe if self.trace.grows() == Some(false) => self.turn(),
            _ => self.go_on(),
        }
    }

    fn is_off_target(&self, commanded_mm: f64, travelled_mm: f64) -> bool {
        let tolerance_mm = (STUCK_STEP_PART * self.settings.step_mm)
            .max(STUCK_WAY_PART * commanded_mm.abs())
            .max(STUCK_AT_STDS * self.settings.travel_std_mm);
        let off_mm = (travelled_mm - commanded_mm).abs();
        off_mm > tolerance_mm || off_mm.is_nan()
    }

    fn after_refusal(&mut self, commanded_mm: f64, travelled_mm: f64, reason: String) -> Decision {
        match self.report.phase {
            SearchPhase::First if self.num_refused >= REFUSED_AT_ONE_PLACE => Err(SearchEnd::NoArcAtStart { reason }),
            // R₂ is none at all, so it is less than R₁.
            SearchPhase::Probe if self.num_refused >= REFUSED_AT_ONE_PLACE => self.turn(),
            SearchPhase::First | SearchPhase::Probe => Ok(commanded_mm),
            _ => {
                let is_passed = self.trace.beyond_peak_mm(self.report.sign).is_some();
                let most = if is_passed { REFUSED_AT_ONE_PLACE } else { REFUSED_IN_A_ROW };
                if self.num_refused < most {
                    self.step_on()
                } else {
                    self.close(SearchEnd::ArcLost { travelled_mm, reason })
                }
            }
        }
    }

    /// After a section while the way is known: up to the peak, and past it.
    fn go_on(&mut self) -> Decision {
        let sign = self.report.sign;
        let Some(beyond_mm) = self.trace.beyond_peak_mm(sign) else {
            self.report.phase = SearchPhase::Climb;
            return self.step_on();
        };
        self.report.phase = SearchPhase::Pass;
        if !self.trace.is_covered(-sign) && !self.way(-sign).is_closed && self.trace.is_well_covered(sign) {
            return self.turn();
        }
        if beyond_mm > FAR_PART * self.ball_radius_mm {
            return self.close(self.travel_exhausted());
        }
        self.step_on()
    }

    /// A step further the way it goes; a shorter one up to the limit.
    fn step_on(&mut self) -> Decision {
        let sign = self.report.sign;
        let reached_mm = self.way(sign).reached_mm;
        let next_mm = (reached_mm + self.step_mm()).min(self.settings.max_travel_mm);
        if next_mm > reached_mm { Ok(sign * next_mm) } else { self.close(self.travel_exhausted()) }
    }

    /// Coarse while far from the peak, never so long that it would leap over what is near it.
    fn step_mm(&self) -> f64 {
        let longest_mm = LONGEST_STEP_PART * self.ball_radius_mm;
        let fine_mm = self.settings.step_mm.min(longest_mm);
        let coarse_mm = self.settings.coarse_step_mm.clamp(fine_mm, longest_mm.max(fine_mm));
        if self.num_refused > 0 {
            return fine_mm;
        }
        if self.report.phase == SearchPhase::Probe {
            return if self.trace.num_captures() > NUM_FINE_PROBES { coarse_mm } else { fine_mm };
        }
        let until_near_mm = self.trace.beside_mm().unwrap_or(0.0) - NEAR_PART * self.ball_radius_mm;
        match self.report.phase {
            SearchPhase::Pass if until_near_mm > 0.0 => coarse_mm,
            SearchPhase::Pass => fine_mm,
            _ => until_near_mm.clamp(fine_mm, coarse_mm),
        }
    }

    /// The other way, beyond what was captured there already.
    fn turn(&mut self) -> Decision {
        self.report.phase = SearchPhase::Reverse;
        self.report.sign = -self.report.sign;
        self.num_refused = 0;
        self.step_on()
    }

    /// Nothing more is to be had this way, for the reason given; if the peak lies behind, the other way may still help.
    fn close(&mut self, why: SearchEnd) -> Decision {
        let sign = self.report.sign;
        self.way_mut(sign).is_closed = true;
        let may_turn = !self.way(-sign).is_closed && self.trace.beyond_peak_mm(sign).is_some();
        let is_short = |beyond_mm: f64| beyond_mm < FAR_PART * self.ball_radius_mm;
        if may_turn && self.trace.beyond_peak_mm(-sign).is_none_or(is_short) {
            return self.turn();
        }
        Err(self.conclusion(why))
    }

    /// Found if what there is will do; otherwise the reason given.
    fn conclusion(&self, why: SearchEnd) -> SearchEnd {
        self.trace.found_after_all(&self.settings).unwrap_or(why)
    }

    fn travel_exhausted(&self) -> SearchEnd {
        SearchEnd::TravelExhausted { max_travel_mm: self.settings.max_travel_mm }
    }

    fn way(&self, sign: f64) -> Way {
        if sign < 0.0 { self.backward } else { self.forward }
    }

    fn way_mut(&mut self, sign: f64) -> &mut Way {
        if sign < 0.0 { &mut self.backward } else { &mut self.forward }
    }
}
