//! The search for the largest arc (Lin & Mu 2019, §2 and Fig. 3) as a pure state machine: it is told what was seen at each
//! step, and says where to go next.

use serde::{Deserialize, Serialize};
use thiserror::Error;

/// The frame in which a direction is given.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DirectionFrame {
    /// The flange (or the tool that is active in the controller) at the first profile.
    #[default]
    Tool,
    /// The robot's base.
    Base,
}

/// When a search has found what it looked for.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StopRule {
    /// As published: the first section whose radius is that of the ball; with noise, once the radius has fallen again.
    Published,
    /// Ours: the fitted curve has passed its peak, and says where it is to within this σ, mm.
    PeakKnown {
        /// The wanted σ of the peak along the travel, mm.
        peak_std_mm: f64,
    },
}

/// How to search.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct SearchSettings {
    /// The frame of [`Self::direction`].
    pub frame: DirectionFrame,
    /// Along what to step; any length but 0.
    pub direction: [f64; 3],
    /// A step, mm.
    pub step_mm: f64,
    /// Steps while far from the peak, mm; as [`Self::step_mm`] if not greater.
    pub coarse_step_mm: f64,
    /// How far from the first profile the robot may go, either way, mm.
    pub max_travel_mm: f64,
    /// Most captures of one search.
    pub max_captures: u16,
    /// When it is over.
    pub stop: StopRule,
}

impl Default for SearchSettings {
    fn default() -> Self {
        Self {
            frame: DirectionFrame::Tool,
            direction: [0.0, 1.0, 0.0],
            step_mm: 0.75,
            coarse_step_mm: 1.5,
            max_travel_mm: 25.0,
            max_captures: 60,
            stop: StopRule::PeakKnown { peak_std_mm: 0.02 },
        }
    }
}

/// Where in the state machine of Fig. 3 a search is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SearchPhase {
    /// Takes the first profile, R₁.
    #[default]
    First,
    /// One step in the positive direction: R₂.
    Probe,
    /// R₂ < R₁: back to the start, then the other way.
    Reverse,
    /// Steps on while the radius grows.
    Climb,
    /// Steps past the peak until the curve says where it is.
    Pass,
    /// It is over.
    Ended,
}

/// What one step of a search saw.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SearchPoint {
    /// Commanded distance from the first profile, mm.
    pub commanded_mm: f64,
    /// Distance along the direction by the reported poses, mm.
    pub travelled_mm: f64,
    /// Radius of the section, mm, and its σ; `None` where there was no arc.
    pub radius_and_std_mm: Option<[f64; 2]>,
}

/// The curve fitted through the steps so far: l² = R² − c (m − m₀)² over the travel m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurveEstimate {
    /// Where the peak is along the travel, m₀, mm.
    pub peak_mm: f64,
    /// Its σ, mm.
    pub peak_std_mm: f64,
    /// The factor c: 1 where the travel is along the laser's normal, less where it is not.
    pub curvature: f64,
}

/// How a search ended.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum SearchEnd {
    /// It found the largest arc.
    #[error("found the largest arc at {peak_mm:.3} mm (σ {peak_std_mm:.3} mm)")]
    Found {
        /// Where, along the travel, mm.
        peak_mm: f64,
        /// Its σ, mm.
        peak_std_mm: f64,
    },
    /// The first profile holds no arc.
    #[error("no arc in the first profile: {reason}; bring the laser line onto the ball")]
    NoArcAtStart {
        /// Why.
        reason: String,
    },
    /// The arc was there and is gone.
    #[error("the arc was lost at {travelled_mm:.2} mm before the peak was found: {reason}")]
    ArcLost {
        /// Where, mm.
        travelled_mm: f64,
        /// Why.
        reason: String,
    },
    /// What is measured is no ball of this radius, or it moved.
    #[error(
        "the sections stopped following the ball at {travelled_mm:.2} mm: off by {residual_mm:.3} mm, expected about {expected_mm:.3} mm; check the ball's radius, and that it does not move"
    )]
    ResidualGrew {
        /// Where, mm.
        travelled_mm: f64,
        /// What is left of the radius by the curve, mm.
        residual_mm: f64,
        /// What would be usual, mm.
        expected_mm: f64,
    },
    /// The robot was sent but did not go.
    #[error(
        "the robot was sent to {commanded_mm:.2} mm and is at {travelled_mm:.2} mm; look at its alarms and what holds it up"
    )]
    Stuck {
        /// Where it was sent, mm.
        commanded_mm: f64,
        /// Where it is, mm.
        travelled_mm: f64,
    },
    /// No peak within the travel.
    #[error(
        "no peak within {max_travel_mm:.1} mm of the first profile; start nearer to the ball's middle, or allow more travel"
    )]
    TravelExhausted {
        /// The limit, mm.
        max_travel_mm: f64,
    },
    /// No peak within the captures.
    #[error("no peak within {max_captures} captures; take larger steps, or allow more")]
    CapturesExhausted {
        /// The limit.
        max_captures: u16,
    },
}

impl SearchEnd {
    /// Whether the peak was found.
    #[must_use]
    pub const fn is_found(&self) -> bool {
        matches!(self, Self::Found { .. })
    }
}

/// A search as it stands, for whoever looks on.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SearchReport {
    /// Where in the state machine it is.
    pub phase: SearchPhase,
    /// The way it goes: +1 or −1 along the direction.
    pub sign: f64,
    /// What was seen so far, in the order of the captures.
    pub points: Vec<SearchPoint>,
    /// The curve through them, once there are enough.
    pub curve: Option<CurveEstimate>,
    /// Where the published rule would have stopped (index into the points), once it would.
    pub published_stop_idx: Option<usize>,
    /// How it ended.
    pub end: Option<SearchEnd>,
}

/// What a capture showed, for the search.
#[derive(Clone, Debug, PartialEq)]
pub struct StepSeen {
    /// Distance along the direction by the reported poses, mm.
    pub travelled_mm: f64,
    /// Radius of the section and its σ, mm; or why there is none.
    pub radius_and_std_mm: Result<[f64; 2], String>,
}

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
    report: SearchReport,
}

impl Search {
    /// A search that has seen nothing yet.
    #[must_use]
    pub fn new(settings: &SearchSettings, ball_radius_mm: f64) -> Self {
        let _ = (settings, ball_radius_mm);
        Self { report: SearchReport::default() }
    }

    /// What to do next; the first is a capture at 0.
    #[must_use]
    pub fn next(&self) -> SearchNext {
        SearchNext::CaptureAt { commanded_mm: 0.0 }
    }

    /// Takes in what was seen where [`Self::next`] sent the robot.
    pub fn take(&mut self, seen: StepSeen) {
        let _ = seen;
    }

    /// How it stands.
    #[must_use]
    pub const fn report(&self) -> &SearchReport {
        &self.report
    }
}
