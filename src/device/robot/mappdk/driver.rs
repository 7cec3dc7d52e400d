//! Drives a FANUC robot by its MAPPDK server.

use std::time::{Duration, Instant};

use crate::device::driver::{LinearMove, MoveState, Readiness, RobotDriver, RobotReport};
use crate::device::error::{DeviceError, MessageError};
use crate::device::robot::arrival::check_arrival;
use crate::device::setup::Endpoint;
use crate::geometry::{Base, Flange, Transform};

use super::line::{DEVICE, Line};
use super::messages::{self, Command, Motion, Reply, Xyzwpr};
use super::route::Route;

/// Three decimals.
const RESOLUTION_MM: f64 = 0.001;
/// Of the greatest acceleration: a ball on a stand, and a head on a bracket, swing less.
const ACCELERATION_PERCENT: u16 = 50;
/// How long one look at a move waits for its end; short, for the caller has to look at other things too.
const LOOK: Duration = Duration::from_millis(5);
/// What the server answers to a target that the arm cannot get to; it looks before it moves.
const NOT_REACHABLE: &str = "position-is-not-reachable";
/// The server that looks on must not hold up a stop for longer.
const LOOKING_ON_PATIENCE: Duration = Duration::from_millis(200);
/// Columns of a value hold six digits before the point.
const MAX_VALUE: f64 = 999_999.0;

/// A FANUC robot by its MAPPDK server.
#[derive(Debug)]
pub struct MappdkRobot {
    /// Takes commands, one at a time; deaf while the robot moves.
    commands: Line,
    /// Tells the pose meanwhile, where the controller runs a second server.
    looking_on: Option<Line>,
    motion: Option<Underway>,
    last_pose: (Transform<Base, Flange>, Instant),
}

/// A move under way.
#[derive(Debug)]
struct Underway {
    route: Route,
    piece_sent_at: Instant,
    /// Whether the piece that was sent has not been answered yet.
    is_piece_running: bool,
}

impl MappdkRobot {
    /// Connects to the server, and to that which looks on (the next port) if it answers.
    ///
    /// # Errors
    /// [`DeviceError`].
    pub fn connect(endpoint: &Endpoint, deadline: Instant) -> Result<Self, DeviceError> {
        let mut commands = Line::connect(endpoint, deadline)?;
        let last_pose = (ask_pose(&mut commands, deadline)?, Instant::now());
        // It is of use and not needed: half of the time that is left is enough to try.
        let half_way = Instant::now() + deadline.saturating_duration_since(Instant::now()) / 2;
        let second = endpoint.port.checked_add(1).map(|port| Endpoint { host: endpoint.host.clone(), port });
        let looking_on = second.and_then(|second| Line::connect(&second, half_way).ok());
        Ok(Self { commands, looking_on, motion: None, last_pose })
    }

    /// Sends the next piece of the way; `false` if there is none.
    fn send_piece(&mut self, deadline: Instant) -> Result<bool, DeviceError> {
        let Some(motion) = &mut self.motion else { return Ok(false) };
        let Some(piece) = motion.route.next_piece() else { return Ok(false) };
        let Xyzwpr(values) = Xyzwpr::from_pose(&piece);
        let command = Command::MoveP(Motion {
            speed: motion.route.speed_mm_s(),
            acceleration_percent: ACCELERATION_PERCENT,
            // Each piece ends at a stand: the reply says that it has ended.
            corner: 0,
            is_linear: true,
            values: values.to_vec(),
        });
        // Of a piece that could not be sent whole nobody knows whether it runs: a stop waits for it.
        motion.is_piece_running = true;
        motion.piece_sent_at = Instant::now();
        self.commands.send(command, deadline)?;
        Ok(true)
    }
}

impl RobotDriver for MappdkRobot {
    fn name(&self) -> &'static str {
        DEVICE
    }

    fn report(&mut self, deadline: Instant) -> Result<RobotReport, DeviceError> {
        match (&mut self.looking_on, &self.motion) {
            (Some(line), Some(_)) => match ask_pose(line, deadline.min(Instant::now() + LOOKING_ON_PATIENCE)) {
                Ok(pose) => self.last_pose = (pose, Instant::now()),
                // An answer may still come, to a question that was another by then.
                Err(DeviceError::Timeout { .. }) => self.looking_on = None,
                Err(error) => return Err(error),
            },
            (Some(line), None) => self.last_pose = (ask_pose(line, deadline)?, Instant::now()),
            (None, None) => self.last_pose = (ask_pose(&mut self.commands, deadline)?, Instant::now()),
            // The only connection is deaf now.
            (None, Some(_)) => {}
        }
        let (base_from_flange, received_at) = self.last_pose;
        let tool = if self.looking_on.is_some() {
            "UTOOL 8 in UFRAME 8"
        } else {
            "UTOOL 8 in UFRAME 8; no pose during moves, as the second port does not answer"
        };
        Ok(RobotReport {
            base_from_flange,
            joints_deg: Vec::new(),
            // The server tells nothing of moves that are not ours.
            is_moving: self.motion.is_some().then_some(true),
            readiness: Readiness::Unknown,
            tool: tool.to_owned(),
            resolution_mm: RESOLUTION_MM,
            received_at,
        })
    }

    fn start_move(&mut self, motion: &LinearMove, deadline: Instant) -> Result<(), DeviceError> {
        if self.motion.is_some() {
            return Err(DeviceError::NotReady {
                device: DEVICE,
                found: "a move under way".to_owned(),
                needed: "no move under way",
                remedy: "wait for its end, or stop it",
            });
        }
        let Xyzwpr(values) = Xyzwpr::from_pose(&motion.base_from_flange);
        if !values.iter().all(|value| value.abs() <= MAX_VALUE) {
            return Err(refused("movep", NOT_REACHABLE));
        }
        let start = ask_pose(&mut self.commands, deadline)?;
        self.motion = Some(Underway {
            route: Route::new(&start, motion),
            piece_sent_at: Instant::now(),
            is_piece_running: false,
        });
        self.send_piece(deadline)?;
        Ok(())
    }

    fn move_state(&mut self, deadline: Instant) -> Result<MoveState, DeviceError> {
        let Some(motion) = &mut self.motion else { return Ok(MoveState::Done) };
        if motion.is_piece_running {
            let patience = deadline.saturating_duration_since(Instant::now()).min(LOOK);
            let Some(reply) = self.commands.reply_within("movep", patience)? else { return Ok(MoveState::Moving) };
            motion.is_piece_running = false;
            if let Err(error) = success("movep", &reply) {
                self.motion = None;
                return Err(error);
            }
        }
        if motion.piece_sent_at.elapsed().as_secs_f64() < motion.route.least_piece_seconds() {
            return Ok(MoveState::Moving);
        }
        let target = *motion.route.target();
        if self.send_piece(deadline)? {
            return Ok(MoveState::Moving);
        }
        self.motion = None;
        let found = ask_pose(&mut self.commands, deadline)?;
        self.last_pose = (found, Instant::now());
        check_arrival(DEVICE, &target, &found)?;
        Ok(MoveState::Done)
    }

    /// The server cannot stop a move: no further piece is sent, and the one under way is waited for.
    fn stop(&mut self, deadline: Instant) -> Result<(), DeviceError> {
        if self.motion.as_ref().is_some_and(|motion| motion.is_piece_running) {
            // Whether the piece arrived or was given up: it has ended.
            self.commands.reply("movep", deadline)?;
        }
        self.motion = None;
        Ok(())
    }
}

fn ask_pose(line: &mut Line, deadline: Instant) -> Result<Transform<Base, Flange>, DeviceError> {
    let reply = line.ask(Command::CurPos, deadline)?;
    if !reply.is_ok {
        return Err(refused("curpos", &reply.message));
    }
    let wrong = |error: MessageError| error.of(DEVICE, "curpos", "check that it is MAPPDK that answers");
    Ok(messages::parse_position(&reply.message).map_err(wrong)?.pose())
}

fn success(request: &str, reply: &Reply) -> Result<(), DeviceError> {
    if reply.is_ok { Ok(()) } else { Err(refused(request, &reply.message)) }
}

fn refused(request: &str, message: &str) -> DeviceError {
    if message == NOT_REACHABLE {
        return DeviceError::OutOfReach {
            device: DEVICE,
            request: request.to_owned(),
            found: message.to_owned(),
            remedy: "choose a pose nearer to the robot, or turn the wrist less; the arm keeps its configuration during a move"
                .to_owned(),
        };
    }
    let remedy = match message {
        "PR[81]-was-not-set" => "free position register 81 for MAPPDK; it must not be locked by another program",
        "R[81]-was-not-set" | "R[82]-was-not-set" | "R[83]-was-not-set" => "free the registers 81 to 83 for MAPPDK",
        "cannot-convert-joint-vals" | "error-in-joint-values" => "check that robot and MAPPDK have as many axes",
        "wrong-command" => "install a MAPPDK that knows the command",
        _ => "read the alarm on the teach pendant, and reset it",
    };
    DeviceError::Refused {
        device: DEVICE,
        request: request.to_owned(),
        found: message.to_owned(),
        remedy: remedy.to_owned(),
    }
}
