//! How a search ended.

use thiserror::Error;

use super::settings::SettingsRefusal;

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
    /// It never began.
    #[error(transparent)]
    NotBegun(#[from] SettingsRefusal),
    /// The first profile holds no arc.
    #[error("no arc in the first profile: {reason}")]
    NoArcAtStart {
        /// Why.
        reason: String,
    },
    /// The radius stays as it is: the travel is not across the laser line.
    #[error(
        "the section's radius did not change over {travelled_mm:.1} mm; the search has to go across the laser line, so choose another direction"
    )]
    RadiusUnchanged {
        /// How far it went, mm.
        travelled_mm: f64,
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
