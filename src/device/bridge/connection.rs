//! A connection to a text bridge: one request, one reply with its id.

use std::time::Instant;

use crate::device::error::{DeviceError, sentence};
use crate::device::setup::Endpoint;
use crate::device::wire::Wire;

use super::messages::{self, Answer, Ask, BridgedDevice, Hello, Request, VERSION};

const REMEDY: &str = "compare the bridge's messages with docs/bridge.md";

/// A connection to a text bridge that has said who it is.
#[derive(Debug)]
pub struct BridgeConnection {
    device: &'static str,
    wire: Wire,
    next_id: u64,
}

impl BridgeConnection {
    /// Connects, and asks who is there; `device` is what errors call it.
    ///
    /// # Errors
    /// [`DeviceError`]; `Unexpected` if something else than `bridged` is there.
    pub fn connect(
        device: &'static str,
        bridged: BridgedDevice,
        endpoint: &Endpoint,
        deadline: Instant,
    ) -> Result<(Self, Hello), DeviceError> {
        let wire = Wire::connect(device, endpoint, deadline, "start the bridge's program, and check address and port")?;
        let mut connection = Self { device, wire, next_id: 1 };
        let ask = Ask::Hello { device: bridged };
        match connection.ask(&ask, deadline)? {
            Answer::Hello(hello) if hello.device == bridged => Ok((connection, hello)),
            Answer::Hello(hello) => Err(DeviceError::Unexpected {
                device,
                request: ask.word().to_owned(),
                found: format!("a {:?}", hello.device).to_lowercase(),
                expected: format!("a {bridged:?}").to_lowercase(),
                remedy: "the ports of robot and profiler may be swapped",
            }),
            other => Err(connection.unexpected(&ask, &other)),
        }
    }

    /// Asks, and waits for the answer to that.
    ///
    /// # Errors
    /// [`DeviceError`]; `Refused` if the bridge says no, after which the connection is still good.
    pub fn ask(&mut self, ask: &Ask, deadline: Instant) -> Result<Answer, DeviceError> {
        let device = self.device;
        let word = ask.word();
        let id = self.next_id;
        self.next_id += 1;
        let line = messages::encode_line(&Request { bridge: VERSION, id, ask: ask.clone() })
            .map_err(|error| error.of(device, word, REMEDY))?;
        self.wire.send(word, line.as_bytes(), deadline)?;
        let line = self.wire.receive(word, deadline, |bytes| {
            messages::line_len(bytes).map_err(|error| error.of(device, word, REMEDY))
        })?;
        let reply = messages::parse_reply(&line).map_err(|error| error.of(device, word, REMEDY))?;
        if reply.id != id {
            return Err(DeviceError::Unexpected {
                device,
                request: word.to_owned(),
                found: format!("id {}", reply.id),
                expected: format!("id {id}"),
                remedy: "the bridge has to answer each request once, with its id",
            });
        }
        match reply.answer {
            Answer::Refused { found, remedy } => {
                let remedy = if remedy.is_empty() { "see the bridge's own output" } else { &remedy };
                let (found, remedy) = (sentence(&found), sentence(remedy));
                Err(DeviceError::Refused { device, request: word.to_owned(), found, remedy })
            }
            answer => Ok(answer),
        }
    }

    /// The error for an answer to another request than `ask`.
    #[must_use]
    pub fn unexpected(&self, ask: &Ask, found: &Answer) -> DeviceError {
        DeviceError::Unexpected {
            device: self.device,
            request: ask.word().to_owned(),
            found: format!("the reply {}", found.word()),
            expected: "a reply of that request".to_owned(),
            remedy: REMEDY,
        }
    }
}
