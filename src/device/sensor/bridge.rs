//! Any other profiler, by the text bridge; `docs/bridge.md` describes the messages.

use std::sync::Arc;
use std::time::Instant;

use crate::device::bridge::BridgeConnection;
use crate::device::bridge::messages::{Answer, Ask, BridgeProfile, BridgedDevice};
use crate::device::driver::{ProfileReading, SensorDriver};
use crate::device::error::DeviceError;
use crate::device::setup::SensorSetup;

const DEVICE: &str = "Profiler bridge";

/// A bridge to a profiler, connected.
#[derive(Debug)]
pub struct BridgeSensor {
    connection: BridgeConnection,
    is_z_inverted: bool,
}

impl BridgeSensor {
    /// Connects, and asks whether a profiler is there.
    ///
    /// # Errors
    /// [`DeviceError`].
    pub fn connect(setup: &SensorSetup, deadline: Instant) -> Result<Self, DeviceError> {
        let (connection, _) = BridgeConnection::connect(DEVICE, BridgedDevice::Profiler, &setup.endpoint, deadline)?;
        Ok(Self { connection, is_z_inverted: setup.is_z_inverted })
    }

    fn reading_of(&self, mut found: BridgeProfile) -> Result<ProfileReading, DeviceError> {
        if self.is_z_inverted {
            found.z_mm.iter_mut().flatten().for_each(|z| *z = -*z);
        }
        let trigger_count = found.trigger_count;
        let remedy = "let the bridge give as many x_mm as z_mm, in mm, and null where there is no valid point";
        let profile = found.profile().map_err(|error| error.of(DEVICE, Ask::Newest.word(), remedy))?;
        Ok(ProfileReading { profile: Arc::new(profile), trigger_count, received_at: Instant::now() })
    }
}

impl SensorDriver for BridgeSensor {
    fn name(&self) -> &'static str {
        DEVICE
    }

    fn newest(&mut self, deadline: Instant) -> Result<Option<ProfileReading>, DeviceError> {
        match self.connection.ask(&Ask::Newest, deadline)? {
            Answer::Profile(found) => self.reading_of(found).map(Some),
            Answer::NoProfile => Ok(None),
            other => Err(self.connection.unexpected(&Ask::Newest, &other)),
        }
    }

    fn forget(&mut self, deadline: Instant) -> Result<(), DeviceError> {
        match self.connection.ask(&Ask::Forget, deadline)? {
            Answer::Accepted => Ok(()),
            other => Err(self.connection.unexpected(&Ask::Forget, &other)),
        }
    }
}
