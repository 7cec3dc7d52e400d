//! The live cell as the window sees it: what can be asked of it, and how it stands. Plain data; the workbench changes it.

use std::path::PathBuf;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::calibrate::Edge;
use crate::device::{
    LinkState, MotionLimits, MotionRefusal, ProfileReading, Readiness, RobotReport, RobotSetup, RoutineEnd,
    SearchReport, SearchSettings, SensorSetup, SettleSettings,
};
use crate::plan::PlannedStation;
use crate::scene::PartKind;

pub use crate::device::LiveProfile;

/// The sensor on the flange as a drawing or a ruler has it: within 10° and 20 mm or so.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RoughMounting {
    /// `flange_from_sensor`, mm.
    pub translation_mm: [f64; 3],
    /// Its rotation.
    pub quaternion_wxyz: [f64; 4],
}

/// What is measured at a station; of a plate it is always one profile.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StationRoutine {
    /// The search for a ball's largest arc, or for a tip.
    #[default]
    LargestArc,
    /// One profile.
    FixedPoint,
}

/// What can stand in the simulated cell to practise on, in the order in which it is offered; no part: a ball.
pub const PRACTICE_PARTS: [Option<PartKind>; 3] = [None, Some(PartKind::Plate), Some(PartKind::Pin)];

/// Everything that is set before motion; the window remembers it between runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct CellSettings {
    /// What the robot may be asked to do.
    pub limits: MotionLimits,
    /// How to search.
    pub search: SearchSettings,
    /// When a capture counts.
    pub settle: SettleSettings,
    /// Roughly how the sensor is mounted; needed to propose stations before a first solution.
    pub mounting: Option<RoughMounting>,
    /// What a run measures at each station.
    pub routine: StationRoutine,
    /// The edge of a plate that the line is on; of this robot where it stands now, so not remembered.
    #[serde(skip)]
    pub edge: Edge,
    /// Whether a run asks before each station's motion.
    pub asks_before_motion: bool,
}

/// Something to ask of the live cell.
#[derive(Clone, Debug, PartialEq)]
pub enum CellCommand {
    /// Connects to a robot.
    ConnectRobot(RobotSetup),
    /// Connects to a profiler.
    ConnectSensor(SensorSetup),
    /// Lets the robot go; its reconnecting ends too.
    DisconnectRobot,
    /// Lets the profiler go.
    DisconnectSensor,
    /// Starts a simulated cell, connects to it, and begins a session for what stands in it: a part, or a ball.
    Practise(Option<PartKind>),
    /// Lets the simulated arm bring the line onto an edge of its plate, as somebody with a pendant would; that edge is chosen.
    JogToEdge(Edge),
    /// Ends the simulated cell.
    EndPractice,
    /// Allows motion, or forbids it; forbidding stops the robot.
    Arm(bool),
    /// Sets what is set before motion.
    SetSettings(Box<CellSettings>),
    /// Measures a station of one profile where the robot stands.
    CaptureStation,
    /// Searches the largest arc from where the robot stands: a station.
    FindLargestArc,
    /// Searches the tip from where the robot stands, and captures it: a station.
    FindTip,
    /// Asks for the next station's pose; it is shown in [`CellView::proposal`] and nothing moves.
    ProposeStation,
    /// Goes to the proposed pose and measures there.
    AcceptProposal,
    /// Throws the proposal away for another one.
    SkipProposal,
    /// Forgets the proposal.
    DropProposal,
    /// Measures so many stations one after the other, the first where the robot stands.
    StartRun {
        /// How many.
        num_stations: u16,
    },
    /// Lets a run wait before its next motion.
    PauseRun,
    /// Lets it go on.
    ResumeRun,
    /// Stops the robot first, then the routine and the run. What was captured stays.
    Stop,
    /// Plays the open session's stations through the panel and the search, without a robot.
    StartReplay,
    /// Ends that.
    EndReplay,
}

/// A link with what came over it last.
#[derive(Clone, Debug, PartialEq)]
pub struct LinkView<Setup, Report> {
    /// What it is connected to, or was.
    pub setup: Option<Setup>,
    /// How it is.
    pub state: LinkState,
    /// What came last.
    pub latest: Option<Report>,
}

impl<Setup, Report> Default for LinkView<Setup, Report> {
    fn default() -> Self {
        Self { setup: None, state: LinkState::Off, latest: None }
    }
}

/// What a routine is at.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Activity {
    /// Nothing.
    #[default]
    Idle,
    /// On the way.
    Moving,
    /// Waits for the robot to stand still and for a later profile.
    Settling,
    /// Between two captures.
    Thinking,
    /// Told to stop, not yet standing.
    Stopping,
}

/// A proposed station, before anything moves.
#[derive(Clone, Debug, PartialEq)]
pub struct Proposal {
    /// Where to go.
    pub station: PlannedStation,
    /// Why there, in words.
    pub reason: String,
    /// Length of the way, mm.
    pub distance_mm: f64,
    /// Turn on the way, degrees.
    pub turn_deg: f64,
    /// Why it cannot be gone to; `None` if it can.
    pub refusal: Option<MotionRefusal>,
}

/// A run over several stations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RunView {
    /// Stations measured.
    pub num_done: u16,
    /// Stations that were given up, with a reason in the notices.
    pub num_failed: u16,
    /// Stations in all.
    pub num_stations: u16,
    /// Whether it waits before the next motion.
    pub is_paused: bool,
    /// Whether it waits for the proposal to be accepted.
    pub is_asking: bool,
}

/// A replay of the open session.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReplayView {
    /// Index of the station that plays.
    pub station_idx: usize,
    /// Index of the capture that plays.
    pub capture_idx: usize,
    /// Whether it has come to the end.
    pub is_over: bool,
}

/// The live cell as it stands.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CellView {
    /// The robot.
    pub robot: LinkView<RobotSetup, RobotReport>,
    /// The profiler.
    pub sensor: LinkView<SensorSetup, ProfileReading>,
    /// The newest profile with what was found in it.
    pub live: Option<LiveProfile>,
    /// Whether the cell is the simulated one.
    pub is_practice: bool,
    /// Whether motion is allowed.
    pub is_armed: bool,
    /// What is set before motion.
    pub settings: CellSettings,
    /// What the routine is at.
    pub activity: Activity,
    /// The search under way, or the last one; see [`Self::is_search_past`].
    pub search: Option<Arc<SearchReport>>,
    /// Noise of a point of a profile along the range axis, by the repeats of the last capture, mm.
    pub repeat_std_mm: Option<f64>,
    /// How the last routine ended; `None` while one is under way.
    pub last_end: Option<RoutineEnd>,
    /// The station that is proposed.
    pub proposal: Option<Proposal>,
    /// The run under way, or the last one.
    pub run: Option<RunView>,
    /// The replay under way.
    pub replay: Option<ReplayView>,
    /// Where the profiles of a watched folder lie, for the words of an empty state.
    pub watched_folder: Option<PathBuf>,
}

impl CellView {
    /// Whether a routine is under way.
    #[must_use]
    pub const fn is_busy(&self) -> bool {
        !matches!(self.activity, Activity::Idle)
    }

    /// Whether the search that is shown is that of the last station, while the next one has not begun.
    #[must_use]
    pub fn is_search_past(&self) -> bool {
        self.is_busy() && self.search.as_ref().is_some_and(|search| search.end.is_some())
    }

    /// Whether the last routine ended without the robot's word that it stands: it may still be moving.
    #[must_use]
    pub fn is_stop_unconfirmed(&self) -> bool {
        let is_unconfirmed = matches!(
            self.last_end,
            Some(RoutineEnd::Failed { robot_stopped, .. } | RoutineEnd::Stopped { robot_stopped })
                if robot_stopped != Some(true)
        );
        let readiness = self.robot.latest.as_ref().map(|report| &report.readiness);
        is_unconfirmed && self.robot.state != LinkState::Off && readiness != Some(&Readiness::ReadOnly)
    }

    /// Whether what is set before motion is in use by a routine, and stays as it is until that has ended.
    #[must_use]
    pub const fn are_settings_in_use(&self) -> bool {
        !matches!(self.activity, Activity::Idle | Activity::Stopping)
    }
}
