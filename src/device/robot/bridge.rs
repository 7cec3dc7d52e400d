//! Drives any robot by the text bridge.

use std::thread;
use std::time::{Duration, Instant};

use crate::device::bridge::BridgeConnection;
use crate::device::bridge::messages::{Answer, Ask, BridgePose, BridgedDevice, Hello, RobotState};
use crate::device::driver::{LinearMove, MoveState, Readiness, RobotDriver, RobotReport};
use crate::device::error::{DeviceError, MessageError, sentence};
use crate::device::setup::Endpoint;
use crate::geometry::{Base, Flange, PoseConvention, Transform};

use super::arrival::check_arrival;

const DEVICE: &str = "Robot (text bridge)";
/// Between two looks at whether the robot stands.
const LOOK_EVERY: Duration = Duration::from_millis(10);
const REMEDY: &str = "compare the bridge's messages with docs/bridge.md";

/// A robot by the text bridge.
#[derive(Debug)]
pub struct BridgeRobot {
    connection: BridgeConnection,
    hello: Hello,
    convention: Option<&'static PoseConvention>,
    target: Option<Transform<Base, Flange>>,
}

impl BridgeRobot {
    /// Connects, and asks who is there.
    ///
    /// # Errors
    /// [`DeviceError`].
    pub fn connect(endpoint: &Endpoint, deadline: Instant) -> Result<Self, DeviceError> {
        let (connection, hello) = BridgeConnection::connect(DEVICE, BridgedDevice::Robot, endpoint, deadline)?;
        let convention = match &hello.convention {
            Some(id) => Some(PoseConvention::by_id(id).ok_or_else(|| {
                let error = MessageError::new(id, "the id of a pose convention, such as kuka-abc");
                error.of(DEVICE, "hello", "name a convention of docs/conventions.md, or none for quaternions")
            })?),
            None => None,
        };
        Ok(Self { connection, hello, convention, target: None })
    }

    fn state(&mut self, deadline: Instant) -> Result<(RobotState, Transform<Base, Flange>), DeviceError> {
        match self.connection.ask(&Ask::State, deadline)? {
            Answer::State(state) => {
                let pose = state.pose.pose(self.convention).map_err(|error| error.of(DEVICE, "state", REMEDY))?;
                Ok((state, pose))
            }
            other => Err(self.connection.unexpected(&Ask::State, &other)),
        }
    }

    fn accepted(&mut self, ask: &Ask, deadline: Instant) -> Result<(), DeviceError> {
        match self.connection.ask(ask, deadline)? {
            Answer::Accepted => Ok(()),
            other => Err(self.connection.unexpected(ask, &other)),
        }
    }
}

impl RobotDriver for BridgeRobot {
    fn name(&self) -> &'static str {
        DEVICE
    }

    fn report(&mut self, deadline: Instant) -> Result<RobotReport, DeviceError> {
        let (state, base_from_flange) = self.state(deadline)?;
        let readiness = match state.not_ready {
            _ if !self.hello.can_move => Readiness::ReadOnly,
            Some(found) => Readiness::NotReady {
                found: sentence(&found),
                remedy: "see the robot's pendant, or the bridge's own output",
            },
            None => Readiness::Ready,
        };
        Ok(RobotReport {
            base_from_flange,
            joints_deg: state.joints_deg,
            is_moving: Some(state.is_moving),
            readiness,
            tool: sentence(&self.hello.tool),
            resolution_mm: self.hello.resolution_mm,
            received_at: Instant::now(),
        })
    }

    fn start_move(&mut self, motion: &LinearMove, deadline: Instant) -> Result<(), DeviceError> {
        if !self.hello.can_move {
            return Err(DeviceError::CannotMove { device: DEVICE });
        }
        let ask = Ask::Move {
            pose: BridgePose::from_pose(&motion.base_from_flange, self.convention),
            speed_mm_s: motion.speed_mm_s,
            rotation_speed_deg_s: motion.rotation_speed_deg_s,
        };
        self.accepted(&ask, deadline)?;
        self.target = Some(motion.base_from_flange);
        Ok(())
    }

    fn move_state(&mut self, deadline: Instant) -> Result<MoveState, DeviceError> {
        let Some(target) = self.target else { return Ok(MoveState::Done) };
        let (state, found) = self.state(deadline)?;
        if let Some(found) = state.move_failed {
            self.target = None;
            let remedy = "see the robot's pendant, or the bridge's own output".to_owned();
            let found = sentence(&found);
            return Err(DeviceError::Refused { device: DEVICE, request: "move".to_owned(), found, remedy });
        }
        if state.is_moving {
            return Ok(MoveState::Moving);
        }
        self.target = None;
        check_arrival(DEVICE, &target, &found)?;
        Ok(MoveState::Done)
    }

    /// Asks for a stand, and waits for it.
    fn stop(&mut self, deadline: Instant) -> Result<(), DeviceError> {
        if !self.hello.can_move {
            return Err(DeviceError::CannotMove { device: DEVICE });
        }
        let start = Instant::now();
        self.target = None;
        self.accepted(&Ask::Stop, deadline)?;
        loop {
            let (state, _) = self.state(deadline)?;
            if !state.is_moving {
                return Ok(());
            }
            let left = deadline.saturating_duration_since(Instant::now());
            if left.is_zero() {
                let waited = start.elapsed();
                return Err(DeviceError::Timeout { device: DEVICE, request: "stop".to_owned(), waited });
            }
            thread::sleep(LOOK_EVERY.min(left));
        }
    }
}
