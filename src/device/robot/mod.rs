//! Robots, one folder a protocol: its messages, and the driver that does the I/O.

pub(super) mod arrival;
pub mod bridge;
pub mod curpos;
pub mod mappdk;
pub mod ur;

use std::time::Instant;

use super::driver::RobotDriver;
use super::error::DeviceError;
use super::setup::{RobotKind, RobotSetup};

/// Connects to a robot and asks it once who it is.
///
/// # Errors
/// [`DeviceError`].
pub fn connect(setup: &RobotSetup, deadline: Instant) -> Result<Box<dyn RobotDriver>, DeviceError> {
    let endpoint = &setup.endpoint;
    Ok(match setup.kind {
        RobotKind::FanucMappdk => Box::new(mappdk::MappdkRobot::connect(endpoint, deadline)?),
        RobotKind::FanucPage => Box::new(curpos::CurposRobot::connect(endpoint, deadline)?),
        RobotKind::UniversalRobots => Box::new(ur::UrRobot::connect(endpoint, deadline)?),
        RobotKind::Bridge => Box::new(bridge::BridgeRobot::connect(endpoint, deadline)?),
    })
}
