//! What a cell does as a whole: move, settle, capture, search. One thread a routine, which asks the two workers.

mod capture;
mod control;
mod run;

#[cfg(test)]
mod tests;

use std::cell::Cell;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::thread;

use crate::fit::{ArcOptions, EdgeOptions, Sought};
use crate::geometry::{Base, Flange, Profile, Transform};
use crate::watch::Wake;

use super::error::{DeviceError, system_words};
use super::safety::{Arming, MotionRefusal};
use super::search::{SearchEnd, SearchReport, SearchSettings};
use super::settle::SettleSettings;
use super::worker::{RobotClient, SensorClient};

pub use control::Control;

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
    /// What was looked for was not found. A profile that was to show it is kept all the same.
    NothingSeen {
        /// Why not.
        reason: String,
    },
    /// A motion was not sent.
    NotAllowed(MotionRefusal),
    /// The pose before the profile and that after it differ, again and again.
    NeverStill {
        /// By how much, mm; `None` where only the controller says that it moves.
        moved_mm: Option<f64>,
    },
    /// No profile later than the move came in time.
    StaleProfiles {
        /// The trigger count that stayed.
        trigger_count: u32,
    },
    /// A device failed; the robot was told to stop if it was sent anywhere.
    Failed {
        /// What happened.
        error: DeviceError,
        /// Whether the robot took the stop, or needed none; `None` where it could not be told.
        robot_stopped: Option<bool>,
    },
    /// Somebody pressed stop.
    Stopped {
        /// Whether the robot took the stop; `None` where it could not be told.
        robot_stopped: Option<bool>,
    },
}

impl RoutineEnd {
    /// Whether it did what it was asked.
    #[must_use]
    pub const fn is_success(&self) -> bool {
        matches!(self, Self::Done | Self::Searched(SearchEnd::Found { .. }))
    }
}

/// What to measure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Measurement {
    /// One settled profile, in which something is to be found if that is said.
    Profile(Option<Sought>),
    /// The search for the largest arc of a ball.
    LargestArc(SearchSettings, ArcOptions),
    /// One settled profile of a tip, once it is known where that is.
    Tip(SearchSettings, EdgeOptions),
}

/// What a routine is to do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Task {
    /// Where to go first; `None`: it begins where the robot stands.
    pub go_to: Option<Transform<Base, Flange>>,
    /// What to measure there; `None`: nothing.
    pub measurement: Option<Measurement>,
    /// When a capture counts.
    pub settle: SettleSettings,
    /// The permission to move; without it nothing moves.
    pub arming: Option<Arming>,
}

/// A routine under way, from the outside. Dropping it lets it end, the robot told to stop.
#[derive(Debug)]
pub struct Routine {
    control: Control,
    events: Receiver<RoutineEvent>,
    is_over: bool,
}

impl Routine {
    /// Starts it; `wake` is called with every event.
    #[must_use]
    pub fn start(task: Task, robot: RobotClient, sensor: SensorClient, wake: Wake) -> Self {
        let control = Control::default();
        // Not bounded: there are a few events a capture, captures are limited, and none may be lost or hold up the robot.
        let (sender, events) = channel();
        let runner = run::Runner {
            task,
            robot,
            sensor,
            control: control.clone(),
            has_moved: Cell::new(false),
            events: sender.clone(),
            wake,
        };
        let spawned = thread::Builder::new().name("routine".to_owned()).spawn(move || runner.run());
        if let Err(error) = spawned {
            let error = DeviceError::System {
                device: "Cell",
                what: "starting a thread".to_owned(),
                reason: system_words(&error),
            };
            sender.send(RoutineEvent::Ended(RoutineEnd::Failed { error, robot_stopped: None })).ok();
        }
        Self { control, events, is_over: false }
    }

    /// Stop and pause.
    #[must_use]
    pub const fn control(&self) -> &Control {
        &self.control
    }

    /// The next event, if one has come. The last one is [`RoutineEvent::Ended`], always.
    pub fn poll(&mut self) -> Option<RoutineEvent> {
        if self.is_over {
            return None;
        }
        let event = match self.events.try_recv() {
            Ok(event) => event,
            Err(TryRecvError::Empty) => return None,
            Err(TryRecvError::Disconnected) => RoutineEvent::Ended(run::broken_down(None)),
        };
        self.is_over = matches!(event, RoutineEvent::Ended(_));
        Some(event)
    }
}

impl Drop for Routine {
    fn drop(&mut self) {
        self.control.stop();
    }
}
