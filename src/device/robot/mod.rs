//! Robots, one folder a protocol: its messages, and the driver that does the I/O.

pub mod curpos;
pub mod mappdk;
pub mod ur;

use std::time::Instant;

use super::driver::RobotDriver;
use super::error::DeviceError;
use super::setup::RobotSetup;

/// Connects to a robot and asks it once who it is.
///
/// # Errors
/// [`DeviceError`].
pub fn connect(setup: &RobotSetup, deadline: Instant) -> Result<Box<dyn RobotDriver>, DeviceError> {
    let _ = (setup, deadline);
    Err(DeviceError::CannotMove { device: "Robot" })
}
