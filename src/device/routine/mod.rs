//! What a cell does as a whole: move, settle, capture, search.

use std::sync::Arc;

use crate::geometry::{Base, Flange, Profile, Transform};

use super::error::DeviceError;
use super::safety::MotionRefusal;
use super::search::{SearchEnd, SearchReport};

/// A settled capture.
#[derive(Clone, Debug, PartialEq)]
pub struct StepCapture {
    /// The pose as reported while the profile was taken.
    pub base_from_flange: Transform<Base, Flange>,
    /// The profile; the mean of several where they were asked for.
    pub profile: Arc<Profile>,
    /// The commanded move from the capture before, mm; `None` for the first.
    pub step_mm: Option<f64>,
    /// Noise of a point of the profile along the range axis, by the repeats; `None` for a single one, mm.
    pub repeat_std_mm: Option<f64>,
    /// How many profiles went into it.
    pub num_profiles: u16,
}

/// What a routine tells while it runs.
#[derive(Clone, Debug, PartialEq)]
pub enum RoutineEvent {
    /// On the way to a pose.
    Moving {
        /// Where to.
        base_from_flange: Transform<Base, Flange>,
    },
    /// The move is over; waiting for the robot to stand still, and for a later profile.
    Settling,
    /// A capture, to be kept at once.
    Captured(StepCapture),
    /// What the search makes of it.
    Searched(Box<SearchReport>),
    /// It is over.
    Ended(RoutineEnd),
}

/// How a routine ended.
#[derive(Clone, Debug, PartialEq)]
pub enum RoutineEnd {
    /// It did what it was asked.
    Done,
    /// A search ended; [`SearchEnd::Found`] is success.
    Searched(SearchEnd),
    /// A motion was not sent.
    NotAllowed(MotionRefusal),
    /// The pose before the profile and that after it differ, again and again.
    NeverStill {
        /// By how much, mm.
        moved_mm: f64,
    },
    /// No profile later than the move came in time.
    StaleProfiles {
        /// The trigger count that stayed.
        trigger_count: u32,
    },
    /// A device failed; the robot was told to stop.
    Failed {
        /// What happened.
        error: DeviceError,
        /// Whether the robot took the stop; `None` where it could not be told.
        robot_stopped: Option<bool>,
    },
    /// Somebody pressed stop.
    Stopped {
        /// Whether the robot took the stop; `None` where it could not be told.
        robot_stopped: Option<bool>,
    },
}
