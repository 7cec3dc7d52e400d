//! A search as it stands, for whoever looks on, and what a capture tells it.

use super::end::SearchEnd;

/// Where in the state machine of Fig. 3 a search is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SearchPhase {
    /// Takes the first profile, R₁.
    #[default]
    First,
    /// A step in the positive direction: R₂; more of them while they differ by less than noise.
    Probe,
    /// R₂ < R₁: back over the start, then the other way.
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

/// A search as it stands.
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
