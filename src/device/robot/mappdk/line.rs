//! One connection to a MAPPDK server: a command, and a reply without an end.

use std::time::{Duration, Instant};

use crate::device::error::{DeviceError, MessageError};
use crate::device::setup::Endpoint;
use crate::device::wire::Wire;

use super::messages::{self, Command, Completeness, Reply};

/// Silence after a reply that may be whole, as many are that hold a number, before it is taken for whole.
const DRAIN: Duration = Duration::from_millis(50);

/// What errors call the device.
pub(super) const DEVICE: &str = "FANUC (MAPPDK)";
const REMEDY: &str = "check that MAPPDK_SERVER listens at this port and nobody else is connected to it";

/// A connection with at most one command outstanding.
#[derive(Debug)]
pub(super) struct Line {
    wire: Wire,
    outstanding: Command,
    sent_at: Instant,
    pending: Vec<u8>,
    last_arrival: Instant,
}

impl Line {
    /// Connects, and waits for the greeting.
    pub(super) fn connect(endpoint: &Endpoint, deadline: Instant) -> Result<Self, DeviceError> {
        let remedy = "run MAPPDK_SERVER on the controller (options R632 and R648), and check address and port";
        let wire = Wire::connect(DEVICE, endpoint, deadline, remedy)?;
        let now = Instant::now();
        // The greeting is as the reply to a command that has nothing else to say.
        let greeting = Command::Exit;
        let mut line = Self { wire, outstanding: greeting, sent_at: now, pending: Vec::new(), last_arrival: now };
        let reply = line.reply("the greeting", deadline)?;
        if reply == Reply::ok(messages::SUCCESS) {
            Ok(line)
        } else {
            Err(MessageError::new(reply.encode(), "0:success").of(DEVICE, "the greeting", REMEDY))
        }
    }

    /// Sends a command and waits for its reply.
    pub(super) fn ask(&mut self, command: Command, deadline: Instant) -> Result<Reply, DeviceError> {
        let word = command.word();
        self.send(command, deadline)?;
        self.reply(word, deadline)
    }

    /// Sends a command; [`Self::reply`] or [`Self::reply_within`] must follow before the next.
    pub(super) fn send(&mut self, command: Command, deadline: Instant) -> Result<(), DeviceError> {
        let word = command.word();
        // Whatever came after the last reply would be taken for the next one.
        self.pending.extend(self.wire.take_arrived(word, Duration::ZERO)?);
        if !self.pending.trim_ascii().is_empty() {
            let error = MessageError::new(&self.pending, "no reply before there is a command");
            return Err(error.of(DEVICE, word, "reconnect; replies and commands are out of step"));
        }
        self.pending.clear();
        self.wire.send(word, command.encode().as_bytes(), deadline)?;
        self.outstanding = command;
        self.sent_at = Instant::now();
        Ok(())
    }

    /// Waits for the reply.
    pub(super) fn reply(&mut self, word: &str, deadline: Instant) -> Result<Reply, DeviceError> {
        loop {
            let patience = deadline.saturating_duration_since(Instant::now()).min(DRAIN);
            if let Some(reply) = self.reply_within(word, patience)? {
                return Ok(reply);
            }
            if patience.is_zero() {
                let waited = self.sent_at.elapsed();
                return Err(DeviceError::Timeout { device: DEVICE, request: word.to_owned(), waited });
            }
        }
    }

    /// The reply if it has come, or comes within `patience`.
    pub(super) fn reply_within(&mut self, word: &str, patience: Duration) -> Result<Option<Reply>, DeviceError> {
        let arrived = self.wire.take_arrived(word, patience)?;
        if !arrived.is_empty() {
            self.pending.extend(arrived);
            self.last_arrival = Instant::now();
        }
        let unexpected = |error: MessageError| error.of(DEVICE, word, REMEDY);
        let is_whole = match messages::completeness(&self.outstanding, &self.pending).map_err(unexpected)? {
            Completeness::Partial => false,
            Completeness::Perhaps => self.last_arrival.elapsed() >= DRAIN,
            Completeness::Whole => true,
        };
        if !is_whole {
            return Ok(None);
        }
        Reply::parse(&std::mem::take(&mut self.pending)).map(Some).map_err(unexpected)
    }
}
