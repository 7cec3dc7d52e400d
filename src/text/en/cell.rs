//! What the live cell has to say: notices, and the reasons for a proposed pose.

use crate::calibrate::Edge;
use crate::device::{MotionRefusal, RobotKind, RoutineEnd, SensorKind};
use crate::plan::PlannedStation;

use super::edges::edge_name;
use super::plural;

/// A capture has nowhere to go.
pub const NO_SESSION: &str = "nothing was captured: no session is open. Begin one for your target, then capture again";
/// From the open session's target nothing is calibrated.
pub const NOTHING_TO_CAPTURE: &str = "nothing was captured: the open session is for no ball, plate or tip. Begin a session for one of these, then capture again";
/// One thing at a time.
pub const BUSY: &str = "the cell is at work: stop it first, or wait until it has ended";
/// What holds for a routine holds to its end.
pub const SETTINGS_IN_USE: &str =
    "the settings of motion and captures stay as they are while the robot is at work: stop it, then change them";
/// There is no robot to ask.
pub const NO_ROBOT: &str = "no robot is connected: connect one first";
/// There is no profiler to ask.
pub const NO_SENSOR: &str = "no profiler is connected: connect one first";
/// The switch needs to know where the robot is.
pub const NO_POSE_TO_ARM_AT: &str =
    "motion was not armed: the robot is not connected, or has not told its pose yet. Connect it, then arm again";
/// A connection was lost while motion was armed.
pub const DISARMED: &str =
    "the connection to the robot was lost, so motion is no longer armed. Look at the robot, then arm again";
/// What was being captured was taken back.
pub const STATION_TAKEN_BACK: &str =
    "the station that was being measured was taken back, so the robot was stopped. Capture it again when you want it";
/// The document was closed or replaced during a routine.
pub const DOCUMENT_GONE: &str = "the session was closed or replaced, so the robot was stopped";
/// A replay has nothing to play.
pub const NOTHING_TO_REPLAY: &str = "there is nothing to replay: open a session with profiles first";
/// A rough plan needs to know where the sensor is.
pub const NO_MOUNTING: &str = "no pose can be proposed yet: say roughly how the sensor is mounted on the flange, or capture a few stations by hand";
/// A rough plan needs to know where the ball is.
pub const NO_BALL_SEEN: &str =
    "no pose can be proposed yet: bring the laser line onto the ball, so that it is known where it is";
/// A rough plan needs to know where the tip is.
pub const NO_TIP_SEEN: &str =
    "no pose can be proposed yet: bring the laser line onto the tip, so that it is known where it is";
/// A rough plan needs a point of each edge.
#[must_use]
pub fn edge_unseen(edge: Edge) -> String {
    let name = edge_name(edge);
    format!(
        "no pose can be proposed yet: jog until the laser line crosses edge {name}, choose edge {name}, and capture it once"
    )
}
/// A run would end after its first station.
pub const RUN_NEEDS_MOUNTING: &str = "the run was not begun: after its first station nobody would know where to go. Say roughly how the sensor is mounted on the flange, or capture a few stations by hand first";
/// Why a run ended.
pub const LINK_LOST: &str = "the connection to the robot was lost";
/// Why a run ended.
pub const DEVICE_FAILED: &str = "a device failed. See to it, arm again, and start a new run";
/// A recorded capture is a point already.
pub const NO_PROFILE: &str = "the capture holds no profile";
/// There is no proposal (any more).
pub const NO_PROPOSAL: &str = "there is no proposed pose: ask for one first";

/// The name of a simulated cell's session.
pub const PRACTICE_NAME: &str = "practice";
/// The simulated robot.
pub const PRACTICE_ROBOT: &str = "simulated FANUC LR Mate 200iD";

/// The make of the robots that a driver connects to; `None` where it is any.
#[must_use]
pub const fn make_of_robot(kind: RobotKind) -> Option<&'static str> {
    match kind {
        RobotKind::FanucMappdk | RobotKind::FanucPage => Some("FANUC"),
        RobotKind::UniversalRobots => Some("Universal Robots"),
        RobotKind::Bridge => None,
    }
}

/// The profilers that a driver connects to; `None` where they are any.
#[must_use]
pub const fn model_of_sensor(kind: SensorKind) -> Option<&'static str> {
    match kind {
        SensorKind::KeyenceLjv => Some("Keyence LJ-V7000"),
        SensorKind::Bridge | SensorKind::Folder => None,
    }
}

/// A session holds stations of another robot.
#[must_use]
pub fn other_robot(recorded: &str, connected: &str) -> String {
    format!(
        "the session's robot is {recorded}, the one that is connected {connected}: their stations make no calibration together. Begin a new session, or correct the robot's name in the session"
    )
}

/// A search that is longer than it has to be.
#[must_use]
pub fn travel_is_oblique(angle_deg: f64) -> String {
    format!("The search goes {angle_deg:.0}° off the laser plane's normal: straight across the line it is shorter")
}

/// The simulated profiler.
#[must_use]
pub fn practice_sensor(head_id: &str) -> String {
    format!("simulated Keyence {}", head_id.to_uppercase())
}

/// Why a routine did not do what it was asked; `None` if it did.
#[must_use]
pub fn reason_of_end(end: &RoutineEnd) -> Option<String> {
    Some(match end {
        RoutineEnd::Done => return None,
        RoutineEnd::Searched(end) if end.is_found() => return None,
        RoutineEnd::Searched(end) => end.to_string(),
        RoutineEnd::NothingSeen { reason } => nothing_seen(reason),
        RoutineEnd::NotAllowed(refusal) => format!("the robot was not moved: {refusal}"),
        RoutineEnd::NeverStill { moved_mm: None } => {
            "the robot did not stand still: its controller says that it moves, again and again. Let it settle longer"
                .to_owned()
        }
        RoutineEnd::NeverStill { moved_mm: Some(moved_mm) } => format!(
            "the robot did not stand still: it moved by {moved_mm:.3} mm during a profile, again and again. Let it settle longer, or allow more"
        ),
        RoutineEnd::StaleProfiles { trigger_count } => format!(
            "no profile came that is later than the move: the trigger count stayed at {trigger_count}. See whether the profiler still measures, and how it is triggered; into a watched folder save a profile for each capture"
        ),
        RoutineEnd::Failed { error, robot_stopped: Some(true) } => format!("{error}. No move is under way"),
        RoutineEnd::Failed { error, robot_stopped } => format!("{error}. {}", stop_taken(*robot_stopped)),
        RoutineEnd::Stopped { robot_stopped: Some(true) } => "stopped".to_owned(),
        RoutineEnd::Stopped { robot_stopped } => format!("stopped on request. {}", stop_taken(*robot_stopped)),
    })
}

/// The same with what is kept of the station; `None` where there is nothing to tell.
#[must_use]
pub fn routine_ended(station: &str, num_captures: usize, end: &RoutineEnd) -> Option<String> {
    let reason = reason_of_end(end)?;
    Some(match num_captures {
        0 => reason,
        1 => format!("{station}: {reason}. Its 1 capture is kept"),
        _ => format!("{station}: {reason}. Its {num_captures} captures are kept"),
    })
}

/// A stop that was wanted, and taken.
#[must_use]
pub fn stopped(station: &str, num_captures: usize) -> String {
    match num_captures {
        0 => "stopped; nothing was captured".to_owned(),
        1 => format!("stopped; the 1 capture of {station} is kept"),
        _ => format!("stopped; the {num_captures} captures of {station} are kept"),
    }
}

/// A run that somebody stopped.
#[must_use]
pub fn run_stopped(num_done: u16, num_stations: u16, is_armed: bool) -> String {
    let armed = still_armed(is_armed);
    format!("the run was stopped after {num_done} of {num_stations} stations; what was captured is kept{armed}")
}

/// Whoever comes back to the cell after a run should know.
const fn still_armed(is_armed: bool) -> &'static str {
    if is_armed { ". Motion is still armed" } else { "" }
}

const fn stop_taken(robot_stopped: Option<bool>) -> &'static str {
    match robot_stopped {
        Some(true) => "The robot was stopped",
        Some(false) => "The robot did not take the stop: stop it at its pendant",
        None => "The robot could not be told to stop: stop it at its pendant",
    }
}

/// A run came to its end.
#[must_use]
pub fn run_done(num_done: u16, num_failed: u16, is_armed: bool) -> String {
    let given_up = if num_failed == 0 { String::new() } else { format!(", {num_failed} given up") };
    let armed = still_armed(is_armed);
    format!("run done: {num_done} station{} measured{given_up}{armed}", plural(num_done.into()))
}

/// A run ended before its time.
#[must_use]
pub fn run_ended(num_done: u16, num_stations: u16, reason: &str) -> String {
    format!("the run ended after {num_done} of {num_stations} stations: {reason}")
}

/// Too many stations failed one after the other.
#[must_use]
pub fn failed_in_a_row(num: u16) -> String {
    format!("{num} stations in a row were given up. See the notices before")
}

/// No proposed pose can be gone to.
#[must_use]
pub fn nothing_allowed(refusal: &MotionRefusal) -> String {
    format!("none of the proposed poses can be gone to; of the first, {refusal}")
}

/// Why a station of the plan is proposed.
#[must_use]
pub fn reason_of_planned(station: &PlannedStation, now_mm: Option<f64>) -> String {
    let how = orientation(station);
    match (now_mm, station.workspace_point_std_mm) {
        (Some(now), Some(then)) => {
            format!("{how}: it brings σ of the workspace point from {now:.3} to about {then:.3} mm")
        }
        _ => format!("{how}: of the poses allowed, it tells most about the calibration"),
    }
}

/// Why a station is proposed before there is a solution.
#[must_use]
pub fn reason_of_rough(station: &PlannedStation) -> String {
    let seen = if station.edge.is_some() { "the edges" } else { "the target" };
    format!("{}: another orientation, from the rough mounting and {seen} as seen so far", orientation(station))
}

/// Why the second station of an edge is proposed.
pub const REASON_OF_BESIDE: &str =
    "the same orientation, shifted across the line: it shows in which direction the edge goes";

fn orientation(station: &PlannedStation) -> String {
    let turned =
        format!("tilted {:.0}° towards {:.0}°, spun {:.0}°", station.tilt_deg, station.azimuth_deg, station.spin_deg);
    match station.edge {
        Some(edge) => format!("edge {}, {turned}", edge_name(edge)),
        None => turned,
    }
}

/// A profile that was to show the target does not.
#[must_use]
pub fn nothing_seen(reason: &str) -> String {
    format!("the target was not found: {reason}")
}

/// A station by its label.
#[must_use]
pub fn station(label: &str) -> String {
    format!("station {label}")
}
