//! Laser profilers, one folder a protocol: its messages, and the driver that does the I/O.

use std::time::Instant;

use super::driver::SensorDriver;
use super::error::DeviceError;
use super::setup::{SensorKind, SensorSetup};

pub mod average;
pub mod bridge;
pub mod folder;
pub mod ljv;

/// Connects to a profiler and asks it once who it is.
///
/// # Errors
/// [`DeviceError`].
pub fn connect(setup: &SensorSetup, deadline: Instant) -> Result<Box<dyn SensorDriver>, DeviceError> {
    match setup.kind {
        SensorKind::KeyenceLjv => Ok(Box::new(ljv::driver::LjvDriver::connect(setup, deadline)?)),
        SensorKind::Folder => Ok(Box::new(folder::FolderDriver::connect(setup, deadline)?)),
        SensorKind::Bridge => Ok(Box::new(bridge::BridgeSensor::connect(setup, deadline)?)),
    }
}
