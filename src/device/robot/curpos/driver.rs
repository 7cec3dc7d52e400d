//! Reads where a FANUC robot is from its web page; it cannot be moved this way.

use std::time::Instant;

use crate::device::driver::{LinearMove, MoveState, Readiness, RobotDriver, RobotReport};
use crate::device::error::{DeviceError, MessageError};
use crate::device::setup::Endpoint;
use crate::device::wire::Wire;

use super::http::{self, Response};
use super::page::{CurposPage, PATH, RESOLUTION_MM};

const DEVICE: &str = "FANUC (web page)";
const NO_CONNECTION: &str = "switch the controller's web server on (HOST COMM, HTTP), and check address and port";
const OTHER_PAGE: &str = "open the page in a browser: it must show the current position of group 1";

/// A FANUC robot by its web page.
#[derive(Debug)]
pub struct CurposRobot {
    endpoint: Endpoint,
}

impl CurposRobot {
    /// Reads the page once.
    ///
    /// # Errors
    /// [`DeviceError`].
    pub fn connect(endpoint: &Endpoint, deadline: Instant) -> Result<Self, DeviceError> {
        let robot = Self { endpoint: endpoint.clone() };
        robot.read(deadline)?;
        Ok(robot)
    }

    /// Gets the page over a connection of its own, as the controller ends each with its answer.
    fn read(&self, deadline: Instant) -> Result<CurposPage, DeviceError> {
        let wrong = |error: MessageError| error.of(DEVICE, PATH, OTHER_PAGE);
        let mut wire = Wire::connect(DEVICE, &self.endpoint, deadline, NO_CONNECTION)?;
        wire.send(PATH, http::encode_get(&self.endpoint.host, PATH).as_bytes(), deadline)?;
        let mut response = None;
        wire.receive_or_end(PATH, deadline, |bytes, is_closed| {
            response = Response::parse(bytes, is_closed).map_err(wrong)?;
            Ok(response.as_ref().map(|_| bytes.len()))
        })?;
        match response {
            Some(Response { status: 200, body }) => CurposPage::parse(&String::from_utf8_lossy(&body)).map_err(wrong),
            Some(Response { status, .. }) => Err(refused(status)),
            None => Err(DeviceError::Closed { device: DEVICE, request: PATH.to_owned() }),
        }
    }
}

impl RobotDriver for CurposRobot {
    fn name(&self) -> &'static str {
        DEVICE
    }

    fn report(&mut self, deadline: Instant) -> Result<RobotReport, DeviceError> {
        let page = self.read(deadline)?;
        Ok(RobotReport {
            base_from_flange: page.world.pose(),
            joints_deg: page.joints_deg,
            is_moving: None,
            readiness: Readiness::ReadOnly,
            tool: format!("UTOOL {} in WORLD", page.tool),
            resolution_mm: RESOLUTION_MM,
            received_at: Instant::now(),
        })
    }

    fn start_move(&mut self, _motion: &LinearMove, _deadline: Instant) -> Result<(), DeviceError> {
        Err(DeviceError::CannotMove { device: DEVICE })
    }

    fn move_state(&mut self, _deadline: Instant) -> Result<MoveState, DeviceError> {
        Ok(MoveState::Done)
    }

    fn stop(&mut self, _deadline: Instant) -> Result<(), DeviceError> {
        Err(DeviceError::CannotMove { device: DEVICE })
    }
}

fn refused(status: u16) -> DeviceError {
    let remedy = match status {
        401 | 403 => "unlock the web server's resource for reading (HOST COMM, HTTP)",
        404 => "check that the address is that of a FANUC controller",
        _ => "open the page in a browser and follow what it says",
    };
    DeviceError::Refused {
        device: DEVICE,
        request: PATH.to_owned(),
        found: format!("HTTP status {status}"),
        remedy: remedy.to_owned(),
    }
}
