//! The capture panel: connecting, the safety strip, the search, the run. Its settings stand in [`super::capture_settings`].

use std::time::Duration;

use crate::device::{Readiness, RobotKind, SearchPhase, SensorKind};
use crate::scene::PartKind;
use crate::session::Target;

/// Menu.
pub const MENU: &str = "Cell";
/// Rail step.
pub const STEP: &str = "Capture";
/// What the rail's step does.
pub const STEP_HINT: &str = "Connect robot and profiler, search the largest arc, measure stations";

/// Start page: heading of the card.
pub const CELL: &str = "Live cell";
/// Start page: what it is for.
pub const CELL_LEAD: &str = "Measure with your own devices, or try a simulated cell.";
/// Button: starts the simulated cell.
pub const PRACTISE: &str = "Practise on a simulated cell";
/// The same where there is little room.
pub const PRACTISE_SHORT: &str = "Practise";
/// The same by its name, in menus and for those who do not see what stands beside it.
#[must_use]
pub const fn practise_on(part: Option<PartKind>) -> &'static str {
    match part {
        Some(PartKind::Plate) => "Practise on a simulated plate",
        Some(PartKind::Pin) => "Practise on a simulated pin",
        _ => PRACTISE,
    }
}
/// The buttons of these, beside each other.
#[must_use]
pub const fn practise_button(part: Option<PartKind>) -> &'static str {
    match part {
        Some(PartKind::Plate) => "on a plate",
        Some(PartKind::Pin) => "on a pin",
        _ => PRACTISE,
    }
}
/// The same, on hover.
#[must_use]
pub const fn practise_hint(part: Option<PartKind>) -> &'static str {
    match part {
        Some(PartKind::Plate) => {
            "The same with a right-angle plate: its two edges are measured, and a pendant is simulated as well"
        }
        Some(PartKind::Pin) => "The same with a pin: its tip is measured from several sides",
        _ => {
            "Starts a simulated robot and profiler on this computer, connects to them and begins a session for their ball"
        }
    }
}
/// Button: goes to the capture step.
pub const CONNECT_CELL: &str = "Connect to a cell…";
/// Badge of the simulated cell.
pub const PRACTICE: &str = "Simulated cell";
/// What that means.
pub const PRACTICE_HINT: &str = "Practice: nothing real moves. What is captured goes into a session of its own.";
/// Button.
pub const END_PRACTICE: &str = "End practice";

/// Reason of a disabled entry.
pub const NO_PRACTICE: &str = "No simulated cell is running.";

/// Card.
pub const ROBOT: &str = "Robot";
/// Card.
pub const PROFILER: &str = "Profiler";
/// Name of a field.
pub const ROBOT_DRIVER: &str = "Robot driver";
/// Name of a field.
pub const PROFILER_DRIVER: &str = "Profiler driver";
/// Name of a field.
pub const ROBOT_HOST: &str = "Robot host";
/// Name of a field.
pub const ROBOT_PORT: &str = "Robot port";
/// Name of a field.
pub const PROFILER_HOST: &str = "Profiler host";
/// Name of a field.
pub const PROFILER_PORT: &str = "Profiler port";
/// Name of a field.
pub const FOLDER: &str = "Watched folder";
/// Names of the fields for numbers that are no settings.
pub const OTHER_NUMBERS: [&str; 4] = [ROBOT_PORT, PROFILER_PORT, RUN_STATIONS, BALL_RADIUS];
/// In an empty field of a host.
pub const HOST_HINT: &str = "name or IP address";
/// In an empty field of a folder.
pub const FOLDER_HINT: &str = "folder that profiles are saved into";
/// Button.
pub const BROWSE: &str = "Browse…";
/// Heading where the path is typed.
pub const FOLDER_TITLE: &str = "Folder to watch for profiles";
/// Button below that path.
pub const FOLDER_BUTTON: &str = "Watch";
/// Checkbox.
pub const INVERT_Z: &str = "z grows towards the sensor";
/// The same, on hover.
pub const INVERT_Z_HINT: &str = "Turns the sign of z about. On the wire of an LJ-V z grows towards the head, so it is ticked for that; most bridges and files have it the other way. Change it if the live profile stands upside down: the ball's top must point to the sensor.";
/// Button.
pub const CONNECT: &str = "Connect";
/// Name of the button.
pub const CONNECT_ROBOT: &str = "Connect the robot";
/// Name of the button.
pub const CONNECT_PROFILER: &str = "Connect the profiler";
/// Button.
pub const DISCONNECT: &str = "Disconnect";
/// Name of the button.
pub const DISCONNECT_ROBOT: &str = "Disconnect the robot";
/// Name of the button.
pub const DISCONNECT_PROFILER: &str = "Disconnect the profiler";
/// Why a robot cannot be connected yet.
pub const NO_HOST: &str = "Enter the controller's name or IP address.";
/// Why a folder cannot be watched yet.
pub const NO_FOLDER: &str = "Choose the folder that the profiles are saved into.";

/// Lamp.
pub const OFF: &str = "Off";
/// Lamp.
pub const CONNECTING: &str = "Connecting …";
/// Lamp.
pub const READY: &str = "Ready";
/// Lamp of a robot that is connected but may not be moved.
pub const CONNECTED: &str = "Connected";
/// Lamp of a profiler that is connected and has sent nothing.
pub const NO_PROFILE_YET: &str = "Ready, no profile yet";
/// Lamp.
pub const FAILED: &str = "Failed";

/// The driver's name in the chooser.
#[must_use]
pub const fn robot_kind(kind: RobotKind) -> &'static str {
    match kind {
        RobotKind::FanucMappdk => "FANUC, MAPPDK server",
        RobotKind::FanucPage => "FANUC, web page (reads only)",
        RobotKind::UniversalRobots => "Universal Robots",
        RobotKind::Bridge => "Text bridge",
    }
}

/// The driver's name in the chooser.
#[must_use]
pub const fn sensor_kind(kind: SensorKind) -> &'static str {
    match kind {
        SensorKind::KeyenceLjv => "Keyence LJ-V7000",
        SensorKind::Bridge => "Text bridge",
        SensorKind::Folder => "Watched folder",
    }
}

/// What a driver asks of the controller, below the chooser.
#[must_use]
pub const fn robot_kind_hint(kind: RobotKind) -> &'static str {
    match kind {
        RobotKind::FanucMappdk => "Needs options R632 and R648 with MAPPDK_SERVER running. Moves the robot.",
        RobotKind::FanucPage => {
            "! Positions only to 0.01 mm and 0.01°: 0.17 mm at a metre's reach. Prefer MAPPDK where there is one. \
             Jog by hand, Handeye records."
        }
        RobotKind::UniversalRobots => "Reads by RTDE, moves by URScript; e-Series must be in remote control.",
        RobotKind::Bridge => "Any controller whose integrator has written a bridge: see docs/bridge.md.",
    }
}

/// What a driver asks of the profiler, below the chooser.
#[must_use]
pub const fn sensor_kind_hint(kind: SensorKind) -> &'static str {
    match kind {
        SensorKind::KeyenceLjv => "The controller must be in high-speed mode, batch measurement off.",
        SensorKind::Bridge => "Any profiler whose integrator has written a bridge: see docs/bridge.md.",
        SensorKind::Folder => "Profiles that the maker's software saves as CSV are picked up as they appear.",
    }
}

/// When a broken link is tried again.
#[must_use]
pub fn again_in(wait: Duration) -> String {
    if wait.is_zero() {
        "Tried again now.".to_owned()
    } else {
        format!("Tried again in {} s.", wait.as_secs_f64().ceil())
    }
}
/// A broken link that only a person can mend.
pub const NOT_AGAIN: &str = "Mend it, then connect again.";

/// In place of the lamp during a replay.
pub const RECORDED: &str = "recorded";
/// What the controller says of its readiness, in a few words.
#[must_use]
pub fn readiness(readiness: &Readiness) -> &str {
    match readiness {
        Readiness::Ready => "takes commands",
        Readiness::Unknown => "not told; a move will show",
        Readiness::NotReady { found, .. } => found,
        Readiness::ReadOnly => "reads only: jog by hand",
    }
}

/// A driver and where it is connected to.
#[must_use]
pub fn at_address(driver: &str, host: &str, port: u16) -> String {
    format!("{driver}, {host}:{port}")
}
/// A watched folder.
#[must_use]
pub fn watching(folder: &str) -> String {
    format!("Watching {folder}")
}
/// Of a robot that tells its pose coarsely.
pub const COARSE_POSES: &str = "Poses in steps of 0.01 mm and 0.01°: 0.17 mm at a metre's reach.";
/// Row label.
pub const POINTS: &str = "Valid points";
/// Their number.
#[must_use]
pub fn valid_of(num_valid: usize, num_points: usize) -> String {
    format!("{num_valid} of {num_points}")
}
/// Row label.
pub const RATE: &str = "Rate";
/// Row label.
pub const READINESS: &str = "Controller";
/// Row label.
pub const MOTION: &str = "Motion";
/// Row label: which tool and frame the pose is of.
pub const TOOL: &str = "Pose of";
/// Value where the controller does not name its tool.
pub const TOOL_NOT_TOLD: &str = "not told";
/// What to see to there.
pub const TOOL_HINT: &str =
    "Which tool and frame the controller shows the pose of. All stations must be of the same: the flange, or one tool.";
/// How the robot is.
#[must_use]
pub const fn motion(is_moving: Option<bool>) -> &'static str {
    match is_moving {
        Some(true) => "moving",
        Some(false) => "standing still",
        None => "not told",
    }
}

/// Card of the live profile.
pub const LIVE: &str = "Live profile";
/// Without a profiler.
pub const LIVE_OFF: &str = "Connect a profiler: its profile is drawn here as it comes.";
/// Connected, nothing came.
pub const LIVE_NOTHING: &str =
    "No profile has come yet. Check that the laser is on, and that the profiler measures or is triggered.";
/// Connected to a folder, nothing came.
#[must_use]
pub fn live_nothing_in(folder: &str) -> String {
    format!("No profile in {folder} yet. Save one there with the profiler's own software.")
}
/// Toggle.
pub const FIT_VIEW: &str = "fit the view";
/// On hover.
pub const FIT_VIEW_HINT: &str = "Drag to pan, Ctrl and wheel to zoom; this, or a double click, shows everything again";
/// The rate of the profiles.
#[must_use]
pub fn rate(rate_hz: &str) -> String {
    format!("{rate_hz} Hz")
}
/// The arc in words, above the plot.
#[must_use]
pub fn arc(radius: &str, angle_deg: &str, point_std_um: &str) -> String {
    format!("l = {radius} mm   arc of {angle_deg}°   point noise {point_std_um} µm")
}
/// The same where there is little room.
#[must_use]
pub fn arc_short(radius: &str, angle_deg: &str) -> String {
    format!("l = {radius} mm   {angle_deg}°")
}
/// What was found of an edge or tip, above the plot.
#[must_use]
pub fn edge_line(found: &str, point_std_um: &str) -> String {
    format!("{found}   point noise {point_std_um} µm")
}
/// Title of the travel axis.
pub const TRAVEL_AXIS: &str = "travel from the first profile / mm";

/// Card of the curve.
pub const RADIUS_AGAINST_STEP: &str = "Radius against step";
/// Without a search.
pub const NO_SEARCH: &str = "The radius of every step appears here while the largest arc is searched.";
/// A search that has seen no arc yet.
pub const NO_STEP_YET: &str = "No step with an arc yet.";

/// Card of the state machine.
pub const SEARCH: &str = "Search for the largest arc";
/// A box of the state machine.
#[must_use]
pub const fn phase(phase: SearchPhase) -> &'static str {
    match phase {
        SearchPhase::First => "First",
        SearchPhase::Probe => "Probe",
        SearchPhase::Reverse => "Reverse",
        SearchPhase::Climb => "Climb",
        SearchPhase::Pass => "Pass",
        SearchPhase::Ended => "Found",
    }
}
/// The last box where the search ended otherwise.
pub const NOT_FOUND: &str = "Ended";
/// What happens in a box.
#[must_use]
pub const fn phase_does(phase: SearchPhase) -> &'static str {
    match phase {
        SearchPhase::First => "profile R₁",
        SearchPhase::Probe => "one step: R₂",
        SearchPhase::Reverse => "R₂ < R₁: other way",
        SearchPhase::Climb => "l grows",
        SearchPhase::Pass => "past the peak",
        SearchPhase::Ended => "peak ± σ",
    }
}
/// A box's state for those who do not see it.
#[must_use]
pub fn phase_name(phase: &str, state: &str) -> String {
    format!("{phase}: {state}")
}
/// The box where the search is.
pub const PHASE_NOW: &str = "now";
/// A box that was passed.
pub const PHASE_DONE: &str = "done";
/// A box that was not entered.
pub const PHASE_AHEAD: &str = "not entered";
/// The step under way, in words.
#[must_use]
pub fn search_progress(num_captures: usize, travelled_mm: &str) -> String {
    let s = super::plural(num_captures);
    format!("{num_captures} profile{s}, at {travelled_mm} mm")
}

/// Button of the search.
pub const FIND: &str = "Find largest arc";
/// On hover.
pub const FIND_HINT: &str =
    "Steps the robot through the ball from where it stands, and keeps every step as one station";
/// Button of a single profile.
pub const CAPTURE: &str = "Capture fixed-point station";
/// The same where the card's title says the rest.
pub const CAPTURE_SHORT: &str = "Capture one profile";
/// The button's name.
#[must_use]
pub const fn capture_name(target: &Target) -> &'static str {
    match target {
        Target::RightAnglePlate => "Capture this edge",
        Target::Point => "Capture the tip",
        _ => CAPTURE,
    }
}
/// On hover.
pub const CAPTURE_HINT: &str = "Keeps one profile and pose where the robot stands, as a station; nothing moves";
/// Card.
pub const STATION: &str = "This station";
/// What the session holds.
#[must_use]
pub fn num_stations(count: usize) -> String {
    match count {
        0 => "No stations yet".to_owned(),
        count => format!("{count} station{} in the session", super::plural(count)),
    }
}

/// Card.
pub const NEXT_STATION: &str = "Next station";
/// Without a proposal.
pub const NO_PROPOSAL: &str =
    "Asks for the orientation that tells most. Its pose is shown first; nothing moves before you accept it.";
/// Button.
pub const PROPOSE: &str = "Propose";
/// Name of the button.
pub const PROPOSE_NAME: &str = "Propose the next station";
/// Button; it moves the robot.
pub const ACCEPT: &str = "Go there and measure";
/// On hover.
pub const ACCEPT_HINT: &str = "Moves the robot to the proposed pose, in a straight line";
/// Button.
pub const ANOTHER: &str = "Another";
/// Name of the button.
pub const ANOTHER_NAME: &str = "Propose another station";
/// Button.
pub const FORGET: &str = "Forget";
/// Name of the button.
pub const FORGET_NAME: &str = "Forget the proposal";
/// The way to a proposal.
#[must_use]
pub fn way(distance_mm: &str, turn_deg: &str) -> String {
    format!("{distance_mm} mm away, turn {turn_deg}°")
}
/// Name of the small picture: the flange's axes now and there, seen in the base.
#[must_use]
pub fn picture(tilt_deg: &str, azimuth_deg: &str, spin_deg: &str) -> String {
    format!("The flange's axes now (faint) and there: tilt {tilt_deg}° towards {azimuth_deg}°, spin {spin_deg}°")
}
/// Why nothing can be proposed.
pub const NEEDS_MOUNTING: &str =
    "Needs a rough mounting (in the settings): until a first solution nobody knows from where else the ball is seen.";

/// Card.
pub const RUN: &str = "Run";
/// Name of a field.
pub const RUN_STATIONS: &str = "Stations to measure";
/// Row label.
pub const RUN_MEASURES: &str = "At each station";
/// Choice.
pub const LARGEST_ARC: &str = "largest arc";
/// Choice.
pub const FIXED_POINT: &str = "one profile";
/// Checkbox.
pub const ASKS: &str = "ask before each station's motion";
/// Button; it moves the robot.
pub const START_RUN: &str = "Start run";
/// On hover.
pub const START_RUN_HINT: &str =
    "Measures the first station where the robot stands, then goes on to orientations that tell most";
/// Button.
pub const PAUSE: &str = "Pause";
/// Name of the button.
pub const PAUSE_NAME: &str = "Pause the run";
/// On hover.
pub const PAUSE_HINT: &str = "Waits before the next motion; what is under way is finished first";
/// Button.
pub const RESUME: &str = "Resume";
/// Name of the button.
pub const RESUME_NAME: &str = "Resume the run";
/// How far the run is.
#[must_use]
pub fn run_progress(num_done: u16, num_stations: u16, num_failed: u16) -> String {
    match num_failed {
        0 => format!("{num_done} of {num_stations} stations"),
        failed => format!("{num_done} of {num_stations} stations, {failed} given up"),
    }
}
/// The run waits.
pub const RUN_PAUSED: &str = "paused";
/// The run waits for an answer.
pub const RUN_ASKS: &str = "asks before it moves";
/// Button.
pub const REPLAY: &str = "Replay the session";
/// On hover.
pub const REPLAY_HINT: &str = "Plays the session's profiles through this panel and the search, without a robot";
/// Button.
pub const END_REPLAY: &str = "End replay";
/// Where a replay is.
#[must_use]
pub fn replaying(label: &str, capture: usize, num_captures: usize) -> String {
    format!("Replay: station {label}, profile {capture} of {num_captures}")
}
/// A replay at its end.
pub const REPLAY_OVER: &str = "The replay has come to its end.";

/// The safety strip's switch.
pub const ARM: &str = "Arm motion";
/// On hover.
pub const ARM_HINT: &str = "While this is off the robot is not moved from here. There is no workspace box: every move is within the limits of a single one.";
/// On hover, with a workspace box.
pub const ARM_HINT_BOX: &str =
    "While this is off the robot is not moved from here. Moves end inside the workspace box.";
/// The switch's state.
pub const ARMED: &str = "Motion armed";
/// The switch's state.
pub const NOT_ARMED: &str = "Motion off";
/// What the limits of motion are, in short.
#[must_use]
pub fn limits(speed_mm_s: &str, move_mm: &str) -> String {
    format!("≤ {speed_mm_s} mm/s, moves ≤ {move_mm} mm")
}
/// The red button.
pub const STOP: &str = "Stop";
/// The same in other steps.
pub const STOP_ROBOT: &str = "Stop the robot";
/// Button at a broken connection.
pub const RETRY: &str = "Retry now";
/// Its name.
pub const RETRY_ROBOT: &str = "Connect the robot again now";
/// Its name.
pub const RETRY_PROFILER: &str = "Connect the profiler again now";
/// At the step in the rail, while the robot may be moved.
pub const ARMED_MARK: &str = "armed";
/// Beside it, above a question.
pub const STILL_AT_WORK: &str = "The robot is at work behind this question, and goes on.";
/// On hover.
pub const STOP_HINT: &str =
    "Stops the robot first, then the routine. Space and Escape do the same. What was captured stays.";

/// The keys that stop.
pub const STOP_KEYS: &str = "Space, Esc";
/// Shortcut's explanation.
pub const STOP_KEYS_HINT: &str = "stop the robot while a routine runs, in every step";

/// Why nothing can be armed or moved.
pub const NO_ROBOT: &str = "Connect a robot first.";
/// The same.
pub const ROBOT_ONLY_READS: &str = "This connection only reads: jog the robot by hand and capture where it stands.";
/// Why nothing can be captured.
pub const NO_PROFILER: &str = "Connect a profiler first.";
/// The same.
pub const NO_TARGET_SESSION: &str = "Captures go into a session with a ball, a plate or a tip: begin one first.";
/// Why no arc is searched.
pub const NO_BALL: &str = "Only a ball has a largest arc.";
/// The same.
pub const ROUTINE_RUNS: &str = "Wait for the routine under way, or stop it.";
/// The same.
pub const REPLAY_RUNS: &str = "End the replay first.";
/// The same.
pub const NOT_ARMED_YET: &str = "Arm motion first: nobody may be in reach of the robot.";
/// The same.
pub const SETTINGS_WRONG: &str = "Correct the settings marked red first.";
/// The same.
pub const NO_PROFILES: &str = "The session holds no profiles to replay.";

/// Button without a session.
pub const NEW_SESSION: &str = "New session for this ball";
/// Name of the field.
pub const BALL_RADIUS: &str = "Ball radius";
/// On hover.
pub const BALL_RADIUS_HINT: &str = "Half the ball's diameter, from its certificate or a micrometer";
/// Name of the button of the next thing to do, which may stand in a card as well.
#[must_use]
pub fn next_button(label: &str) -> String {
    format!("Next: {label}")
}
/// What the routine is at.
pub const MOVING: &str = "The robot moves.";
/// The same.
pub const SETTLING: &str = "Waiting until the robot stands still and a later profile comes.";
/// The same where a person or another program saves the profiles.
pub const SETTLING_BY_FOLDER: &str =
    "Waiting until the robot stands still and a profile comes: save one into the watched folder now.";
/// The same.
pub const THINKING: &str = "Working out the next step.";
/// The same.
pub const STOPPING: &str = "Stopping.";
/// Primary button after a run.
pub const COMPARE: &str = "Compare the methods";
/// Button after a run.
pub const DISARM: &str = "Disarm";
/// Primary button.
pub const SET_MOUNTING: &str = "Enter the mounting";
/// Primary button.
pub const KEEP_MOUNTING: &str = "Use it here as well";
/// Why nothing can be proposed or moved.
pub const OTHER_MOUNTING: &str = "The rough mounting was given for another robot. Is it the same here?";
/// In the settings, for which robot that was.
#[must_use]
pub fn mounting_of(driver: &str, host: &str) -> String {
    format!("Given for another robot: {driver}, {host}.")
}
/// How many more stations make the calibration good.
#[must_use]
pub fn outlook(std_mm: &str, num_to_good: Option<usize>, good_mm: f64) -> String {
    let now = format!("σ of the workspace point: {std_mm} mm");
    match num_to_good {
        Some(num) => {
            let s = super::plural(num);
            format!("{now}. By the plan about {num} more station{s} bring it to {good_mm} mm, which is Good.")
        }
        None => format!("{now}. No number of stations like these brings it to {good_mm} mm, which is Good."),
    }
}

/// Why the controller would refuse to move.
#[must_use]
pub fn not_ready(found: &str, remedy: &str) -> String {
    format!("The controller says: {found}. {}", sentence(remedy))
}

/// Sentences of the band: what to do next, and why.
pub mod now {
    use crate::calibrate::Edge;
    use crate::session::Target;
    use crate::text::edges::edge_name;

    /// Nothing is connected, nothing was before.
    pub const BEGIN: &str = "No cell is connected. Enter the addresses of robot and profiler at the left, or practise.";
    /// A link is broken.
    pub const ROBOT_FAILED: &str = "The robot is not connected; the reason stands in its card.";
    /// A link is broken.
    pub const PROFILER_FAILED: &str = "The profiler is not connected; the reason stands in its card.";
    /// A robot is known.
    pub const CONNECT_ROBOT: &str = "Connect the robot: its pose is read with every profile.";
    /// A profiler is known.
    pub const CONNECT_PROFILER: &str = "Connect the profiler.";
    /// An address is missing.
    pub const ENTER_ROBOT: &str = "Enter the robot's address at the left.";
    /// An address is missing.
    pub const ENTER_PROFILER: &str = "Enter the profiler's address, or its folder, at the left.";
    /// On its way.
    pub const CONNECTING: &str = "Connecting …";
    /// No session.
    pub const SESSION: &str = "Captures go into a session. Begin one for your ball; its radius must be right.";
    /// Another target.
    pub const OTHER_TARGET: &str =
        "From the open session's target nothing is calibrated. Begin one for your ball; its radius must be right.";
    /// No profile.
    pub const PROFILE: &str = "Waiting for a profile: check that the laser is on.";
    /// Nothing is found in the profile.
    #[must_use]
    pub const fn jog(target: &Target) -> &'static str {
        match target {
            Target::RightAnglePlate => {
                "Jog the robot until the laser line crosses one edge of the plate: its point is then marked."
            }
            Target::Point => "Jog the robot until the laser line lies on the tip: its point is then marked.",
            _ => "Jog the robot until the laser line crosses the ball: the arc is then drawn orange.",
        }
    }
    /// No mounting.
    pub const MOUNT: &str =
        "Say roughly how the sensor is mounted: the next stations can then be proposed. 10° and 20 mm will do.";
    /// Not armed.
    #[must_use]
    pub const fn arm(target: &Target) -> &'static str {
        match target {
            Target::RightAnglePlate => {
                "The line is on an edge. See that nobody is in reach of the robot, then arm motion."
            }
            Target::Point => "The line is on the tip. See that nobody is in reach of the robot, then arm motion.",
            _ => "The line is on the ball. See that nobody is in reach of the robot, then arm motion.",
        }
    }
    /// All is ready.
    pub const RUN: &str = "Ready. The run measures every station by itself; Stop, Space or Escape ends it.";
    /// Nobody knows the mounting yet.
    pub const FIND: &str = "Ready to search the largest arc where the robot stands.";
    /// A proposal waits.
    pub const ARM_FOR_PROPOSAL: &str =
        "Look at the proposed pose. See that nobody is in reach of the robot, then arm motion.";
    /// A robot that somebody jogs.
    #[must_use]
    pub fn capture(target: &Target, edge: Edge) -> String {
        let on = match target {
            Target::RightAnglePlate => format!("edge {}, as chosen below", edge_name(edge)),
            Target::Point => "the tip".to_owned(),
            _ => "the ball".to_owned(),
        };
        format!("The line is on {on}. Capture here, then jog to another orientation and capture again.")
    }
    /// The first capture of an edge.
    #[must_use]
    pub fn first_on_edge(edge: Edge) -> String {
        format!(
            "Capture edge {} here: the other stations are proposed from the first one of each edge.",
            edge_name(edge)
        )
    }
    /// The other edge has none yet.
    #[must_use]
    pub fn other_edge(edge: Edge) -> String {
        let name = edge_name(edge);
        format!("Now jog until the line crosses edge {name}, choose edge {name} below, and capture once there.")
    }
    /// A proposal waits.
    pub const ACCEPT: &str = "Look at the proposed pose. The robot goes there in a straight line.";
    /// A proposal cannot be gone to.
    pub const SKIP: &str = "The proposed pose cannot be gone to; ask for another.";
    /// A run pauses.
    pub const RESUME: &str = "The run is paused before its next motion.";
    /// A run is over.
    pub const COMPARE: &str = "The run is over. See what the methods make of it.";
    /// A run is over, and the robot may still be moved.
    #[must_use]
    pub fn still_armed(sentence: &str) -> String {
        format!("{sentence} Motion is still armed.")
    }
    /// Settings are wrong.
    #[must_use]
    pub fn settings(problem: &str) -> String {
        format!("Correct the settings marked red at the left. {problem}")
    }
}

/// A single profile was captured.
pub const CAPTURED: &str = "Captured.";
/// Noise of a point by the profiles that were averaged.
#[must_use]
pub fn repeat_noise(std_um: &str) -> String {
    format!("Point noise by the repeats: {std_um} µm")
}
/// What is shown came before the connection was lost.
pub const LAST_PROFILE: &str = "last profile";
/// What is shown is of the station before.
pub const LAST_STATION: &str = "last station";

/// An error's words as a sentence of their own.
#[must_use]
pub fn sentence(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}
