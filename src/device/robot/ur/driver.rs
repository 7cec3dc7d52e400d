//! Drives a robot of Universal Robots.

use std::time::{Duration, Instant};

use crate::device::driver::{LinearMove, MoveState, Readiness, RobotDriver, RobotReport};
use crate::device::error::DeviceError;
use crate::device::robot::arrival::check_arrival;
use crate::device::setup::Endpoint;
use crate::device::wire::Wire;
use crate::geometry::{Base, Flange, Transform};

use super::dashboard::{self, Question};
use super::script::{Program, Statement, UrPose};
use super::state::{MARK_REGISTER, UrState};
use super::stream::Stream;

/// What errors call it.
pub(super) const DEVICE: &str = "Universal Robots";

/// Doubles, and joint encoders of some micrometres at the tool point.
const RESOLUTION_MM: f64 = 0.001;
/// Gentle, so that a head on a bracket does not swing.
const ACCELERATION_M_S2: f64 = 0.3;
/// Firm: 100 mm/s end within 5 mm.
const STOP: Statement = Statement::StopL { deceleration_m_s2: 1.0 };
/// A ramp up and a ramp down make the fastest moment at most twice the mean.
const PEAK_OVER_MEAN: f64 = 2.0;
/// A program that has not begun after this is not going to: the controller takes none, or not from here.
const START_GRACE: Duration = Duration::from_secs(2);
/// A program that has done its last statement has ended after this.
const END_GRACE: Duration = Duration::from_millis(300);
/// The switch between local and remote control is looked at so often, and a dashboard that failed is tried again.
const REMOTE_AGE: Duration = Duration::from_secs(1);
/// The dashboard must not hold up the robot for longer, least of all a stop.
const DASHBOARD_PATIENCE: Duration = Duration::from_millis(200);

/// How far the other ports are from that of RTDE (30004): secondary interface 30002, realtime 30003, dashboard 29999.
const BELOW_RTDE_SECONDARY: u16 = 2;
const BELOW_RTDE_REALTIME: u16 = 1;
const BELOW_RTDE_DASHBOARD: u16 = 5;

/// A robot of Universal Robots.
#[derive(Debug)]
pub struct UrRobot {
    endpoint: Endpoint,
    stream: Stream,
    dashboard: Option<Dashboard>,
    dashboard_tried_at: Instant,
    motion: Option<Underway>,
    /// The operator's tool point, while a program of ours has or may have set it aside.
    set_aside: Option<UrPose>,
    last_mark: i32,
}

/// A program under way.
#[derive(Debug)]
struct Underway {
    /// By which the program was sent; `None` once the controller has hung up, which does not end the program.
    script: Option<Wire>,
    target: Transform<Base, Flange>,
    sent_at: Instant,
    has_played: bool,
}

/// The dashboard, and what it said last.
#[derive(Debug)]
struct Dashboard {
    wire: Wire,
    is_remote: Option<bool>,
}

impl UrRobot {
    /// Connects to the stream, and to the dashboard if it answers.
    ///
    /// # Errors
    /// [`DeviceError`].
    pub fn connect(endpoint: &Endpoint, deadline: Instant) -> Result<Self, DeviceError> {
        let mut stream = Stream::connect(endpoint, deadline)?;
        let state = stream.newest(deadline)?;
        // It is of use and not needed: half of the time that is left is enough to try.
        let half_way = Instant::now() + deadline.saturating_duration_since(Instant::now()) / 2;
        let dashboard = Dashboard::connect(endpoint, half_way).ok();
        let dashboard_tried_at = Instant::now();
        Ok(Self {
            endpoint: endpoint.clone(),
            stream,
            dashboard,
            dashboard_tried_at,
            motion: None,
            set_aside: None,
            last_mark: state.mark,
        })
    }

    fn readiness(&mut self, state: &UrState, deadline: Instant) -> Readiness {
        if self.dashboard_tried_at.elapsed() >= REMOTE_AGE {
            let deadline = deadline.min(Instant::now() + DASHBOARD_PATIENCE);
            self.dashboard = match self.dashboard.take() {
                Some(mut dashboard) => dashboard.ask(deadline).is_ok().then_some(dashboard),
                None => Dashboard::connect(&self.endpoint, deadline).ok(),
            };
            self.dashboard_tried_at = Instant::now();
        }
        state.readiness(self.is_remote())
    }

    fn is_remote(&self) -> Option<bool> {
        self.dashboard.as_ref().and_then(|dashboard| dashboard.is_remote)
    }

    /// The state once no program runs any more. Our last one ends a moment after it has written its mark; one of somebody
    /// else is not ended by a move of ours.
    fn idle_state(&mut self, deadline: Instant) -> Result<UrState, DeviceError> {
        let give_up = deadline.min(Instant::now() + END_GRACE);
        loop {
            let state = self.stream.newest(deadline)?;
            if state.is_program_stopped() {
                return Ok(state);
            }
            if Instant::now() >= give_up {
                return Err(DeviceError::NotReady {
                    device: DEVICE,
                    found: "a program that runs".to_owned(),
                    needed: "no program",
                    remedy: "stop the program on the pendant",
                });
            }
        }
    }

    /// Sends a program that does this, gives the operator's tool point back, and then writes the next mark.
    fn run(
        &mut self,
        script: &mut Wire,
        name: &str,
        mut statements: Vec<Statement>,
        deadline: Instant,
    ) -> Result<(), DeviceError> {
        self.last_mark = self.last_mark.checked_add(1).unwrap_or(1);
        if let Some(offset) = self.set_aside {
            // Else the mark could be told with a pose that does not fit the tool point yet.
            statements.extend([Statement::SetTcp { offset }, Statement::Sync]);
        }
        statements.push(Statement::WriteOutputInteger { register: MARK_REGISTER, value: self.last_mark });
        let program = Program { name: name.to_owned(), statements };
        script.send(name, program.encode().as_bytes(), deadline)
    }

    fn connect_script(&self, deadline: Instant) -> Result<Wire, DeviceError> {
        let remedy = "enable the primary and secondary client interfaces in the controller's services";
        // The secondary interface tells us ten states a second that we do not need, the realtime one up to five hundred.
        Wire::connect(DEVICE, &below(&self.endpoint, BELOW_RTDE_SECONDARY), deadline, remedy)
            .or_else(|_| Wire::connect(DEVICE, &below(&self.endpoint, BELOW_RTDE_REALTIME), deadline, remedy))
    }
}

impl RobotDriver for UrRobot {
    fn name(&self) -> &'static str {
        DEVICE
    }

    fn report(&mut self, deadline: Instant) -> Result<RobotReport, DeviceError> {
        let state = self.stream.newest(deadline)?;
        let received_at = Instant::now();
        let tool = if state.flange_from_tcp.is_some() {
            "flange; the active TCP is taken off"
        } else {
            "active TCP; this software does not tell where it is on the flange"
        };
        Ok(RobotReport {
            base_from_flange: state.base_from_flange(),
            joints_deg: Vec::new(),
            is_moving: Some(!state.is_standing()),
            readiness: self.readiness(&state, deadline),
            tool: tool.to_owned(),
            resolution_mm: RESOLUTION_MM,
            received_at,
        })
    }

    fn start_move(&mut self, motion: &LinearMove, deadline: Instant) -> Result<(), DeviceError> {
        let state = self.idle_state(deadline)?;
        refuse_unready(self.readiness(&state, deadline))?;
        let mut script = self.connect_script(deadline)?;
        self.stream.last_warning = None;
        let mut statements = vec![move_statement(&state, motion)];
        // One that an aborted program of ours has left at the flange is still to be given back.
        self.set_aside = state.tcp_offset().or(self.set_aside);
        if self.set_aside.is_some() {
            // `movel` leads the tool point straight and at the speed: were it ahead of the flange, that would swing.
            statements.insert(0, Statement::SetTcp { offset: UrPose::AT_FLANGE });
        }
        self.run(&mut script, "handeye_move", statements, deadline)?;
        self.motion = Some(Underway {
            script: Some(script),
            target: motion.base_from_flange,
            sent_at: Instant::now(),
            has_played: false,
        });
        Ok(())
    }

    fn move_state(&mut self, deadline: Instant) -> Result<MoveState, DeviceError> {
        let Some(motion) = &mut self.motion else { return Ok(MoveState::Done) };
        // The interface tells its states to whoever is connected; nobody may let them pile up.
        if motion.script.as_mut().is_some_and(|script| script.take_arrived("handeye_move", Duration::ZERO).is_err()) {
            motion.script = None;
        }
        let state = self.stream.newest(deadline)?;
        motion.has_played |= !state.is_program_stopped();
        let has_played = motion.has_played;
        let is_late = motion.sent_at.elapsed() >= START_GRACE;
        if state.mark == self.last_mark {
            if !state.is_standing() {
                return Ok(MoveState::Moving);
            }
            let target = motion.target;
            self.motion = None;
            self.set_aside = None;
            check_arrival(DEVICE, &target, &state.base_from_flange())?;
            return Ok(MoveState::Done);
        }
        // In a stop the program may wait for ever.
        let readiness = state.readiness(None);
        if matches!(readiness, Readiness::NotReady { .. }) {
            self.motion = None;
            refuse_unready(readiness)?;
        }
        if state.is_program_stopped() && (has_played || is_late) {
            let found = match self.stream.last_warning.take() {
                Some(warning) => warning,
                None if has_played => "the program ended before the target was reached".to_owned(),
                None => "the program was not started".to_owned(),
            };
            self.motion = None;
            return Err(DeviceError::Refused {
                device: DEVICE,
                request: "handeye_move".to_owned(),
                found,
                remedy:
                    "see the log on the pendant; the controller must be in remote control, and the pose within reach"
                        .to_owned(),
            });
        }
        Ok(MoveState::Moving)
    }

    /// A new program ends that which runs.
    fn stop(&mut self, deadline: Instant) -> Result<(), DeviceError> {
        let request = "handeye_stop";
        let start = Instant::now();
        let half_way = start + deadline.saturating_duration_since(start) / 2;
        // Over the same connection, so that it cannot overtake the move.
        let mut script = self.motion.take().and_then(|motion| motion.script);
        let mut is_sent = false;
        let mut sends_left = 2;
        loop {
            // What was sent to one that hung up may not have been read; another may have a place for it.
            if script.as_mut().is_some_and(|script| script.take_arrived(request, Duration::ZERO).is_err()) {
                (script, is_sent) = (None, false);
            }
            if !is_sent && sends_left > 0 {
                sends_left -= 1;
                let mut wire = match script.take() {
                    Some(wire) => wire,
                    None => self.connect_script(deadline)?,
                };
                match self.run(&mut wire, request, vec![STOP], deadline) {
                    Ok(()) => (script, is_sent) = (Some(wire), true),
                    Err(_) if sends_left > 0 => continue,
                    Err(error) => return Err(error),
                }
            }
            let state = self.stream.newest(deadline)?;
            let readiness = state.readiness(self.is_remote());
            // In a stop of its own, or in local control, the controller takes no program of ours, and does not always say
            // that it is in one. Then it is enough that none runs; one that is held up goes on as soon as it may.
            let takes_none = matches!(readiness, Readiness::NotReady { .. }) || Instant::now() >= half_way;
            let is_done = state.mark == self.last_mark;
            if (is_done || takes_none && state.is_program_stopped()) && state.is_standing() {
                if is_done {
                    self.set_aside = None;
                }
                return Ok(());
            }
            if Instant::now() >= deadline {
                if let Readiness::NotReady { found, .. } = readiness {
                    return Err(DeviceError::NotReady {
                        device: DEVICE,
                        found: format!("a program that has not ended, and {found}"),
                        needed: "no program",
                        remedy: "stop the program on the pendant before anything else",
                    });
                }
                return Err(DeviceError::Timeout {
                    device: DEVICE,
                    request: request.to_owned(),
                    waited: start.elapsed(),
                });
            }
        }
    }
}

/// A robot that nobody looks after any more has to stop.
impl Drop for UrRobot {
    fn drop(&mut self) {
        /// A few bytes into a buffer that is empty, or a connection.
        const PATIENCE: Duration = Duration::from_millis(200);
        let request = "handeye_stop";
        let Some(motion) = self.motion.take() else { return };
        let deadline = Instant::now() + PATIENCE;
        let is_sent = motion.script.is_some_and(|mut script| {
            // The first takes what came before the end, the second finds that.
            (0..2).all(|_| script.take_arrived(request, Duration::ZERO).is_ok())
                && self.run(&mut script, request, vec![STOP], deadline).is_ok()
        });
        if !is_sent && let Ok(mut script) = self.connect_script(deadline) {
            // Where that fails too there is nobody left to be told.
            let _ = self.run(&mut script, request, vec![STOP], deadline);
        }
    }
}

impl Dashboard {
    fn connect(endpoint: &Endpoint, deadline: Instant) -> Result<Self, DeviceError> {
        let remedy = "enable the dashboard in the controller's services";
        let wire = Wire::connect(DEVICE, &below(endpoint, BELOW_RTDE_DASHBOARD), deadline, remedy)?;
        let mut dashboard = Self { wire, is_remote: None };
        dashboard.line("the greeting", deadline)?;
        dashboard.ask(deadline)?;
        Ok(dashboard)
    }

    fn ask(&mut self, deadline: Instant) -> Result<(), DeviceError> {
        let question = Question::IsInRemoteControl;
        self.wire.send(question.words(), question.encode().as_bytes(), deadline)?;
        self.is_remote = dashboard::parse_remote_control(&self.line(question.words(), deadline)?);
        Ok(())
    }

    fn line(&mut self, request: &str, deadline: Instant) -> Result<String, DeviceError> {
        let line = self.wire.receive(request, deadline, |bytes| {
            dashboard::line_len(bytes).map_err(|error| error.of(DEVICE, request, "check the port of the dashboard"))
        })?;
        Ok(String::from_utf8_lossy(&line).into_owned())
    }
}

/// The straight move. Where the turn governs, the time is given: a script has no speed of turning.
fn move_statement(state: &UrState, motion: &LinearMove) -> Statement {
    let start = state.base_from_flange();
    let target = &motion.base_from_flange;
    let distance_mm = (target.translation_mm() - start.translation_mm()).norm();
    let turn_deg = start.rotation().angle_to(&target.rotation()).to_degrees();
    let straight_s = distance_mm / motion.speed_mm_s.max(f64::MIN_POSITIVE);
    let turn_s = turn_deg / motion.rotation_speed_deg_s.max(f64::MIN_POSITIVE);
    Statement::MoveL {
        pose: UrPose::from_pose(&Transform::from_rigid(*target.rigid())),
        acceleration_m_s2: ACCELERATION_M_S2,
        speed_m_s: motion.speed_mm_s / 1000.0,
        time_s: if turn_s > straight_s { PEAK_OVER_MEAN * turn_s } else { 0.0 },
    }
}

fn refuse_unready(readiness: Readiness) -> Result<(), DeviceError> {
    match readiness {
        Readiness::NotReady { found, remedy } => {
            Err(DeviceError::NotReady { device: DEVICE, found, needed: "running, in remote control", remedy })
        }
        Readiness::Ready | Readiness::Unknown | Readiness::ReadOnly => Ok(()),
    }
}

/// Another port of the same controller.
fn below(endpoint: &Endpoint, distance: u16) -> Endpoint {
    Endpoint { host: endpoint.host.clone(), port: endpoint.port.saturating_sub(distance) }
}
