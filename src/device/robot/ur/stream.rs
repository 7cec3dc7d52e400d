//! The stream of states from RTDE.

use std::time::Instant;

use crate::device::error::{DeviceError, MessageError};
use crate::device::setup::Endpoint;
use crate::device::wire::Wire;

use super::driver::DEVICE;
use super::rtde::{self, ClientPacket, NOT_FOUND, ServerPacket, TextMessage, VERSION};
use super::state::{NAMES, OFFSET_NAME, UrState};

/// Every controller gives as many; a newer one could give four times as many, which nobody here would read.
const FREQUENCY_HZ: f64 = 125.0;
const REMEDY: &str =
    "check that the port is that of RTDE (30004), and that RTDE is enabled in the controller's services";

/// A stream that runs.
#[derive(Debug)]
pub(super) struct Stream {
    wire: Wire,
    recipe_id: u8,
    types: Vec<String>,
    /// The last warning or error that the controller sent, for the reason of a move that ended early.
    pub last_warning: Option<String>,
}

impl Stream {
    /// Connects, agrees on what is streamed, and starts it.
    pub(super) fn connect(endpoint: &Endpoint, deadline: Instant) -> Result<Self, DeviceError> {
        let remedy = "switch the robot on, enable RTDE in its services, and check address and port";
        let wire = Wire::connect(DEVICE, endpoint, deadline, remedy)?;
        let mut stream = Self { wire, recipe_id: 0, types: Vec::new(), last_warning: None };
        let request = "the version of RTDE";
        match stream.ask(request, &ClientPacket::RequestVersion(VERSION), deadline)? {
            ServerPacket::VersionAccepted(true) => {}
            ServerPacket::VersionAccepted(false) => {
                let found = format!("it does not speak version {VERSION} of RTDE");
                let remedy = "update the controller to PolyScope 3.4 or later".to_owned();
                return Err(DeviceError::Refused { device: DEVICE, request: request.to_owned(), found, remedy });
            }
            other => return Err(unexpected(request, &other)),
        }
        let with_offset = NAMES.into_iter().chain([OFFSET_NAME]);
        if !stream.set_up(with_offset, deadline)? && !stream.set_up(NAMES.into_iter(), deadline)? {
            let error = MessageError::new(stream.types.join(","), "a type for each of the names");
            return Err(error.of(DEVICE, "the recipe of RTDE", "update the controller's software"));
        }
        match stream.ask("the start of RTDE", &ClientPacket::Start, deadline)? {
            ServerPacket::Started(true) => Ok(stream),
            other => Err(unexpected("the start of RTDE", &other)),
        }
    }

    /// Asks for these values; `false` if the controller does not know all of them.
    fn set_up(&mut self, names: impl Iterator<Item = &'static str>, deadline: Instant) -> Result<bool, DeviceError> {
        let request = "the recipe of RTDE";
        let names: Vec<String> = names.map(str::to_owned).collect();
        let num_names = names.len();
        let packet = ClientPacket::SetupOutputs { frequency_hz: FREQUENCY_HZ, names };
        match self.ask(request, &packet, deadline)? {
            ServerPacket::OutputTypes { recipe_id, types } => {
                let is_known = types.len() == num_names && types.iter().all(|name| name != NOT_FOUND);
                (self.recipe_id, self.types) = (recipe_id, types);
                Ok(is_known)
            }
            other => Err(unexpected(request, &other)),
        }
    }

    /// The state now: what had arrived before is thrown away, for it may be old.
    pub(super) fn newest(&mut self, deadline: Instant) -> Result<UrState, DeviceError> {
        let request = "the state";
        let start = Instant::now();
        loop {
            match self.packet_or_text(request, Instant::now()) {
                Ok(_) => check_in_time(request, start, deadline)?,
                Err(DeviceError::Timeout { .. }) => break,
                Err(error) => return Err(error),
            }
        }
        loop {
            check_in_time(request, start, deadline)?;
            // A recipe that was given up for another may still have a packet under way.
            if let ServerPacket::Data { recipe_id, values } = self.packet(request, deadline)?
                && recipe_id == self.recipe_id
            {
                return rtde::parse_values(&self.types, &values)
                    .and_then(|values| UrState::parse(&values))
                    .map_err(|error| error.of(DEVICE, request, REMEDY));
            }
        }
    }

    fn ask(&mut self, request: &str, packet: &ClientPacket, deadline: Instant) -> Result<ServerPacket, DeviceError> {
        self.wire.send(request, &packet.encode(), deadline)?;
        self.packet(request, deadline)
    }

    /// The next packet that is no text.
    fn packet(&mut self, request: &str, deadline: Instant) -> Result<ServerPacket, DeviceError> {
        let start = Instant::now();
        loop {
            if let Some(packet) = self.packet_or_text(request, deadline)? {
                return Ok(packet);
            }
            check_in_time(request, start, deadline)?;
        }
    }

    /// The next packet; `None` if that is a text, which is kept where it warns.
    fn packet_or_text(&mut self, request: &str, deadline: Instant) -> Result<Option<ServerPacket>, DeviceError> {
        /// 0 exception, 1 error, 2 warning.
        const WARNING: u8 = 2;
        let wrong = |error: MessageError| error.of(DEVICE, request, REMEDY);
        let bytes = self.wire.receive(request, deadline, |bytes| rtde::packet_len(bytes).map_err(wrong))?;
        Ok(match ServerPacket::parse(&bytes).map_err(wrong)? {
            ServerPacket::Message(TextMessage { text, level, .. }) => {
                if level <= WARNING {
                    self.last_warning = Some(text);
                }
                None
            }
            packet => Some(packet),
        })
    }
}

/// A controller that sends faster than we read always has another packet there: that is no reason to go on for ever.
fn check_in_time(request: &str, start: Instant, deadline: Instant) -> Result<(), DeviceError> {
    if Instant::now() < deadline {
        return Ok(());
    }
    Err(DeviceError::Timeout { device: DEVICE, request: request.to_owned(), waited: start.elapsed() })
}

fn unexpected(request: &str, found: &ServerPacket) -> DeviceError {
    MessageError::new(format!("{found:?}"), "the answer to that").of(DEVICE, request, REMEDY)
}
