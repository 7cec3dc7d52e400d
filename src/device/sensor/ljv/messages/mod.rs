//! The messages of the LJ-V7000 command port, encoded and parsed both ways. Pure.
//!
//! Everything is little-endian and packed. A message begins with the number of bytes that follow. Sources: the drivers
//! and the dissector that `docs/profilers.md` names; the controller's own paper is not public.

use crate::device::error::DeviceError;

mod meaning;
mod profile;
mod setting;

pub use profile::{ProfileReply, ProfileRequest, RawProfile, WIRE_UNIT_MM};
pub use setting::SettingRequest;

/// What messages call the device.
pub const DEVICE: &str = "Keyence LJ-V7000";
/// Of LJ-V7000 controllers.
pub const VERSION_LJV: u16 = 1;
/// Of LJ-X8000 controllers.
pub const VERSION_LJX: u16 = 3;
/// The most bytes that a message may announce: some hundred times the longest profile.
pub const MAX_PREFIX: u32 = 4 << 20;

/// The codes of commands.
pub mod command {
    /// Lists errors.
    pub const GET_ERROR: u8 = 0x04;
    /// Takes a profile now, where the trigger mode is external.
    pub const SOFTWARE_TRIGGER: u8 = 0x21;
    /// Forgets all profiles.
    pub const CLEAR_MEMORY: u8 = 0x27;
    /// Reads a setting.
    pub const GET_SETTING: u8 = 0x31;
    /// Writes a setting.
    pub const SET_SETTING: u8 = 0x32;
    /// Makes written settings those that run.
    pub const REFLECT_SETTING: u8 = 0x33;
    /// Changes the active program.
    pub const CHANGE_PROGRAM: u8 = 0x39;
    /// Reads profiles in the high-speed mode.
    pub const GET_PROFILE: u8 = 0x42;
}

/// The codes of replies.
pub mod code {
    /// Done.
    pub const OK: u8 = 0;
    /// The command is not known.
    pub const UNDEFINED_COMMAND: u8 = 0x31;
    /// The command has another length.
    pub const COMMAND_LENGTH: u8 = 0x32;
    /// The controller is in another mode or state.
    pub const STATUS: u8 = 0x41;
    /// A value is out of its range.
    pub const PARAMETER: u8 = 0x42;
}

const REQUEST_DIRECTION: u16 = 0x00f0;
const REPLY_DIRECTION: u16 = 0xf000;
/// Bytes of the prefix.
const PREFIX_LEN: usize = 4;
/// Bytes of the header behind the prefix.
const HEADER_LEN: usize = 12;
/// Bytes of a request before its data.
const REQUEST_DATA_AT: usize = 20;
/// Bytes of a reply before its data.
const REPLY_DATA_AT: usize = 28;
/// The controller's status in a reply when it does not work any more.
const SYSTEM_ERROR: u8 = 0xff;

const CHECK_PORT: &str = "check that the address is that of an LJ-V7000 controller, and the port its TCP command port (24691 unless changed)";

/// What a message says of itself before its data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Direction {
    Request,
    Reply,
}

impl Direction {
    const fn bits(self) -> u16 {
        match self {
            Self::Request => REQUEST_DIRECTION,
            Self::Reply => REPLY_DIRECTION,
        }
    }

    /// Where the data begin, which is the least length of a message.
    const fn data_at(self) -> usize {
        match self {
            Self::Request => REQUEST_DATA_AT,
            Self::Reply => REPLY_DATA_AT,
        }
    }
}

/// What a command is called.
#[must_use]
pub fn name_of(command: u8) -> String {
    let name = match command {
        command::GET_ERROR => "get errors",
        command::SOFTWARE_TRIGGER => "software trigger",
        command::CLEAR_MEMORY => "clear memory",
        command::GET_SETTING => "get setting",
        command::SET_SETTING => "set setting",
        command::REFLECT_SETTING => "reflect setting",
        command::CHANGE_PROGRAM => "change program",
        command::GET_PROFILE => "get profile",
        _ => return format!("command 0x{command:02X}"),
    };
    format!("{name} (0x{command:02X})")
}

fn unexpected(command: u8, found: String, expected: impl Into<String>, remedy: &'static str) -> DeviceError {
    DeviceError::Unexpected { device: DEVICE, request: name_of(command), found, expected: expected.into(), remedy }
}

fn u16_at(bytes: &[u8], at: usize) -> Option<u16> {
    Some(u16::from_le_bytes(*bytes.get(at..)?.first_chunk()?))
}

fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_le_bytes(*bytes.get(at..)?.first_chunk()?))
}

/// A length as the wire has it. No message of ours is longer than [`MAX_PREFIX`].
fn wire_len(len: usize) -> u32 {
    u32::try_from(len).unwrap_or(u32::MAX)
}

/// How many of the bytes make the first message; `None` while some are missing. What cannot be a message is told as soon
/// as its header is there, not when its announced length has come.
fn message_len(bytes: &[u8], direction: Direction, command: u8) -> Result<Option<usize>, DeviceError> {
    let Some(prefix) = u32_at(bytes, 0) else { return Ok(None) };
    let least = wire_len(direction.data_at() - PREFIX_LEN);
    if !(least..=MAX_PREFIX).contains(&prefix) {
        let found = format!("a message of {prefix} bytes");
        return Err(unexpected(command, found, format!("{least} to {MAX_PREFIX} bytes"), CHECK_PORT));
    }
    if let Some(found) = u16_at(bytes, 6).filter(|found| *found != direction.bits()) {
        let found = format!("direction 0x{found:04X}");
        return Err(unexpected(command, found, format!("0x{:04X}", direction.bits()), CHECK_PORT));
    }
    if let Some(body_len) = u32_at(bytes, 12)
        && u64::from(body_len) + HEADER_LEN as u64 != u64::from(prefix)
    {
        let found = format!("a body of {body_len} bytes in a message of {prefix}");
        return Err(unexpected(command, found, format!("{} bytes", prefix as usize - HEADER_LEN), CHECK_PORT));
    }
    let len = PREFIX_LEN + prefix as usize;
    Ok((bytes.len() >= len).then_some(len))
}

fn begin(version: u16, direction: Direction, code: u8, data_len: usize) -> Vec<u8> {
    let len = direction.data_at() + data_len;
    let mut bytes = Vec::with_capacity(len);
    bytes.extend(wire_len(len - PREFIX_LEN).to_le_bytes());
    bytes.extend(version.to_le_bytes());
    bytes.extend(direction.bits().to_le_bytes());
    bytes.extend([code, 0, 0, 0]);
    bytes.extend(wire_len(len - PREFIX_LEN - HEADER_LEN).to_le_bytes());
    bytes
}

/// A whole message and nothing else, or what is wrong with it.
fn check_whole(bytes: &[u8], direction: Direction, command: u8) -> Result<(), DeviceError> {
    match message_len(bytes, direction, command)? {
        Some(len) if len == bytes.len() => Ok(()),
        Some(len) => {
            Err(unexpected(command, format!("{} bytes", bytes.len()), format!("a message of {len}"), CHECK_PORT))
        }
        None => Err(unexpected(command, format!("only {} bytes", bytes.len()), "a whole message", CHECK_PORT)),
    }
}

/// A request to the controller.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Request {
    /// Of the protocol.
    pub version: u16,
    /// See [`command`].
    pub command: u8,
    /// What belongs to the command.
    pub data: Vec<u8>,
}

impl Request {
    /// A request of an LJ-V client.
    #[must_use]
    pub const fn new(command: u8, data: Vec<u8>) -> Self {
        Self { version: VERSION_LJV, command, data }
    }

    /// Its bytes.
    #[must_use]
    pub fn encode(&self) -> Vec<u8> {
        let mut bytes = begin(self.version, Direction::Request, 0, self.data.len());
        bytes.extend([self.command, 0, 0, 0]);
        bytes.extend(&self.data);
        bytes
    }

    /// How many of the bytes make the first request; `None` while some are missing.
    ///
    /// # Errors
    /// [`DeviceError::Unexpected`] where they cannot become one.
    pub fn len_in(bytes: &[u8]) -> Result<Option<usize>, DeviceError> {
        message_len(bytes, Direction::Request, 0)
    }

    /// Reads a whole request. Bytes that say nothing are not looked at: clients leave garbage in some.
    ///
    /// # Errors
    /// [`DeviceError::Unexpected`].
    pub fn parse(bytes: &[u8]) -> Result<Self, DeviceError> {
        check_whole(bytes, Direction::Request, 0)?;
        Ok(Self {
            version: u16_at(bytes, 4).unwrap_or_default(),
            command: bytes[16],
            data: bytes[REQUEST_DATA_AT..].to_vec(),
        })
    }
}

/// The controller's answer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Reply {
    /// Of the protocol.
    pub version: u16,
    /// What is wrong with the request's header; see [`code`].
    pub header_code: u8,
    /// The command that is answered.
    pub command: u8,
    /// How the command went; see [`code`].
    pub body_code: u8,
    /// 0 while it measures, 255 after a system error.
    pub status: u8,
    /// The program that is active.
    pub program: u8,
    /// What belongs to the command; nothing where it was refused.
    pub data: Vec<u8>,
}

impl Reply {
    /// A good answer of an LJ-V controller.
    #[must_use]
    pub const fn new(command: u8, program: u8, data: Vec<u8>) -> Self {
        Self { version: VERSION_LJV, header_code: 0, command, body_code: code::OK, status: 0, program, data }
    }

    /// A refusal.
    #[must_use]
    pub const fn refusal(command: u8, program: u8, body_code: u8) -> Self {
        Self { version: VERSION_LJV, header_code: 0, command, body_code, status: 0, program, data: Vec::new() }
    }

    /// Its bytes.
    #[must_use]
    pub fn encode(&self) -> Vec<u8> {
        let mut bytes = begin(self.version, Direction::Reply, self.header_code, self.data.len());
        bytes.extend([self.command, self.body_code, self.status, 0, 0, 0, 0, 0]);
        bytes.extend([self.program, 0, 0, 0]);
        bytes.extend(&self.data);
        bytes
    }

    /// How many of the bytes make the first reply to a command; `None` while some are missing.
    ///
    /// # Errors
    /// [`DeviceError::Unexpected`] where they cannot become one.
    pub fn len_in(bytes: &[u8], command: u8) -> Result<Option<usize>, DeviceError> {
        message_len(bytes, Direction::Reply, command)
    }

    /// Reads a whole reply to a command.
    ///
    /// # Errors
    /// [`DeviceError::Unexpected`] where it is none, [`DeviceError::Refused`] with what its codes mean, and
    /// [`DeviceError::NotReady`] after a system error.
    pub fn parse(bytes: &[u8], command: u8) -> Result<Self, DeviceError> {
        check_whole(bytes, Direction::Reply, command)?;
        let reply = Self {
            version: u16_at(bytes, 4).unwrap_or_default(),
            header_code: bytes[8],
            command: bytes[16],
            body_code: bytes[17],
            status: bytes[18],
            program: bytes[24],
            data: bytes[REPLY_DATA_AT..].to_vec(),
        };
        reply.check(command)?;
        Ok(reply)
    }

    fn check(&self, command: u8) -> Result<(), DeviceError> {
        match self.version {
            VERSION_LJV => {}
            VERSION_LJX => {
                let found = "protocol version 3, that of LJ-X8000 controllers".to_owned();
                let remedy =
                    "connect an LJ-X8000 by the text bridge, or let its software save profiles into a watched folder";
                return Err(unexpected(command, found, "version 1, that of LJ-V7000 controllers", remedy));
            }
            other => return Err(unexpected(command, format!("protocol version {other}"), "version 1", CHECK_PORT)),
        }
        let refused = |(found, remedy): (String, &str)| DeviceError::Refused {
            device: DEVICE,
            request: name_of(command),
            found,
            remedy: remedy.to_owned(),
        };
        if self.header_code != 0 {
            return Err(refused(meaning::of_header(self.header_code)));
        }
        if self.command != command {
            let remedy = "close other programs that use this connection, and connect again";
            return Err(unexpected(
                command,
                format!("an answer to {}", name_of(self.command)),
                "one to this request",
                remedy,
            ));
        }
        if self.body_code != code::OK {
            return Err(refused(meaning::of_body(command, self.body_code)));
        }
        if self.status == SYSTEM_ERROR {
            return Err(DeviceError::NotReady {
                device: DEVICE,
                found: "a system error".to_owned(),
                needed: "a controller that measures",
                remedy: "read the error on the controller's monitor or in LJ-Navigator, clear it, and restart the controller",
            });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
