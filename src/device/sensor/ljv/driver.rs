//! The driver of LJ-V7000 controllers: one connection, one request at a time.

use std::sync::Arc;
use std::time::Instant;

use crate::device::driver::{ProfileReading, SensorDriver};
use crate::device::error::DeviceError;
use crate::device::setup::SensorSetup;
use crate::device::wire::Wire;

use super::messages::{self, ProfileReply, ProfileRequest, Reply, Request, SettingRequest, command};

const NO_CONNECTION: &str = "check the cable, the address and the controller's TCP command port (24691 unless changed), and close other programs that hold it, such as LJ-Navigator";

/// A controller, connected.
#[derive(Debug)]
pub struct LjvDriver {
    wire: Wire,
    is_z_inverted: bool,
    /// Whether a profile is taken only when it is asked for: the trigger mode is external.
    is_triggered_from_here: bool,
    /// The controller gives each profile once; so this is the newest until another comes.
    newest: Option<ProfileReading>,
}

impl LjvDriver {
    /// Connects, asks whether profiles can be had, and what triggers them.
    ///
    /// # Errors
    /// [`DeviceError`].
    pub fn connect(setup: &SensorSetup, deadline: Instant) -> Result<Self, DeviceError> {
        let wire = Wire::connect(messages::DEVICE, &setup.endpoint, deadline, NO_CONNECTION)?;
        let mut driver = Self { wire, is_z_inverted: setup.is_z_inverted, is_triggered_from_here: false, newest: None };
        // A wrong mode is told now and not at the first capture.
        let reply = driver.ask(command::GET_PROFILE, ProfileRequest::NONE.encode(), deadline)?;
        ProfileReply::parse(&reply.data)?;
        driver.is_triggered_from_here = driver.has_external_trigger(reply.program, deadline)?;
        Ok(driver)
    }

    /// Whether the trigger mode of a program is external. A controller that does not say runs continuously.
    fn has_external_trigger(&mut self, program: u8, deadline: Instant) -> Result<bool, DeviceError> {
        let data = SettingRequest::trigger_mode(program).encode();
        match self.ask(command::GET_SETTING, data, deadline) {
            Ok(reply) => Ok(reply.data.first() == Some(&SettingRequest::EXTERNAL_TRIGGER)),
            Err(DeviceError::Refused { .. }) => Ok(false),
            Err(error) => Err(error),
        }
    }

    fn ask(&mut self, command: u8, data: Vec<u8>, deadline: Instant) -> Result<Reply, DeviceError> {
        let name = messages::name_of(command);
        self.wire.send(&name, &Request::new(command, data).encode(), deadline)?;
        let bytes = self.wire.receive(&name, deadline, |bytes| Reply::len_in(bytes, command))?;
        Reply::parse(&bytes, command)
    }
}

impl SensorDriver for LjvDriver {
    fn name(&self) -> &'static str {
        messages::DEVICE
    }

    fn newest(&mut self, deadline: Instant) -> Result<Option<ProfileReading>, DeviceError> {
        if self.is_triggered_from_here {
            self.ask(command::SOFTWARE_TRIGGER, Vec::new(), deadline)?;
        }
        let reply = self.ask(command::GET_PROFILE, ProfileRequest::NEWEST.encode(), deadline)?;
        let received_at = Instant::now();
        let reply = ProfileReply::parse(&reply.data)?;
        if let Some(raw) = reply.profiles.last() {
            let profile = Arc::new(reply.in_mm(raw, self.is_z_inverted)?);
            self.newest = Some(ProfileReading { profile, trigger_count: raw.trigger_count, received_at });
        }
        Ok(self.newest.clone())
    }

    fn forget(&mut self, deadline: Instant) -> Result<(), DeviceError> {
        self.newest = None;
        self.ask(command::CLEAR_MEMORY, Vec::new(), deadline)?;
        Ok(())
    }
}
