//! Laser profilers, one folder a protocol: its messages, and the driver that does the I/O.

use std::time::Instant;

use super::driver::SensorDriver;
use super::error::DeviceError;
use super::setup::SensorSetup;

/// Connects to a profiler and asks it once who it is.
///
/// # Errors
/// [`DeviceError`].
pub fn connect(setup: &SensorSetup, deadline: Instant) -> Result<Box<dyn SensorDriver>, DeviceError> {
    let _ = (setup, deadline);
    Err(DeviceError::Stopped { device: "Sensor" })
}
