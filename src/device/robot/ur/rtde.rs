//! The packets of RTDE (real-time data exchange), version 2, big-endian; pure, in both directions.
//!
//! A packet is its size (u16, these bytes included), its type (an ASCII letter) and its payload.

use crate::device::error::MessageError;

/// Size and type.
const HEADER_BYTES: usize = 3;
/// Longer packets are none of this protocol: the longest, a list of names, may have 2048 bytes.
pub const MAX_PACKET_BYTES: usize = 4096;
/// The version spoken here.
pub const VERSION: u16 = 2;
/// What the controller writes for the type of a name that it does not know; the recipe is of no use then.
pub const NOT_FOUND: &str = "NOT_FOUND";

/// How many of the bytes make the first packet; `None` until they have all come.
///
/// # Errors
/// [`MessageError`] if the size is none of this protocol.
pub fn packet_len(bytes: &[u8]) -> Result<Option<usize>, MessageError> {
    let [high, low, ..] = bytes else { return Ok(None) };
    let len = usize::from(u16::from_be_bytes([*high, *low]));
    if !(HEADER_BYTES..=MAX_PACKET_BYTES).contains(&len) {
        return Err(MessageError::new(
            &bytes[..bytes.len().min(HEADER_BYTES)],
            format!("a packet of {HEADER_BYTES} to {MAX_PACKET_BYTES} bytes"),
        ));
    }
    Ok((bytes.len() >= len).then_some(len))
}

/// What a client sends.
#[derive(Clone, Debug, PartialEq)]
pub enum ClientPacket {
    /// Asks for a version of the protocol.
    RequestVersion(u16),
    /// Asks for the version of the controller's software.
    ControllerVersion,
    /// Asks for a stream of these values.
    SetupOutputs {
        /// How often, Hz.
        frequency_hz: f64,
        /// Their names.
        names: Vec<String>,
    },
    /// Announces values that the client will write.
    SetupInputs {
        /// Their names.
        names: Vec<String>,
    },
    /// Starts the stream.
    Start,
    /// Pauses it.
    Pause,
    /// Values that the client writes.
    Data {
        /// Of which recipe.
        recipe_id: u8,
        /// The values, one after the other.
        values: Vec<u8>,
    },
    /// A text for the log.
    Message(TextMessage),
}

/// What a controller sends.
#[derive(Clone, Debug, PartialEq)]
pub enum ServerPacket {
    /// Whether it speaks the version.
    VersionAccepted(bool),
    /// Major, minor, bugfix, build.
    ControllerVersion([u32; 4]),
    /// The types of the values that were asked for.
    OutputTypes {
        /// Of which recipe; 0 where it is of no use.
        recipe_id: u8,
        /// A type or [`NOT_FOUND`] each.
        types: Vec<String>,
    },
    /// The types of the values that the client announced.
    InputTypes {
        /// Of which recipe; 0 where it is of no use.
        recipe_id: u8,
        /// A type, [`NOT_FOUND`] or `IN_USE` each.
        types: Vec<String>,
    },
    /// Whether the stream was started.
    Started(bool),
    /// Whether it was paused.
    Paused(bool),
    /// Values of the stream.
    Data {
        /// Of which recipe.
        recipe_id: u8,
        /// The values, one after the other.
        values: Vec<u8>,
    },
    /// A text for whoever looks on; may come at any time.
    Message(TextMessage),
}

/// A text for the log, of either side.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TextMessage {
    /// The text, cut at 255 bytes.
    pub text: String,
    /// Who says it, cut at 255 bytes.
    pub source: String,
    /// 0 exception, 1 error, 2 warning, 3 information.
    pub level: u8,
}

impl ClientPacket {
    /// The packet with its header.
    #[must_use]
    pub fn encode(&self) -> Vec<u8> {
        match self {
            Self::RequestVersion(version) => packet(b'V', &version.to_be_bytes()),
            Self::ControllerVersion => packet(b'v', &[]),
            Self::SetupOutputs { frequency_hz, names } => {
                packet(b'O', &[&frequency_hz.to_be_bytes(), names.join(",").as_bytes()].concat())
            }
            Self::SetupInputs { names } => packet(b'I', names.join(",").as_bytes()),
            Self::Start => packet(b'S', &[]),
            Self::Pause => packet(b'P', &[]),
            Self::Data { recipe_id, values } => packet(b'U', &[&[*recipe_id][..], values].concat()),
            Self::Message(message) => packet(b'M', &message.encode()),
        }
    }

    /// Reads one whole packet.
    ///
    /// # Errors
    /// [`MessageError`].
    pub fn parse(bytes: &[u8]) -> Result<Self, MessageError> {
        let (kind, payload) = split(bytes)?;
        let wrong = |expected| MessageError::new(bytes, expected);
        match kind {
            b'V' => Ok(Self::RequestVersion(u16::from_be_bytes(exact(payload).ok_or_else(|| wrong("a version"))?))),
            b'v' => Ok(Self::ControllerVersion),
            b'O' => {
                let (frequency, names) = payload.split_first_chunk().ok_or_else(|| wrong("a frequency, then names"))?;
                Ok(Self::SetupOutputs { frequency_hz: f64::from_be_bytes(*frequency), names: list(names)? })
            }
            b'I' => Ok(Self::SetupInputs { names: list(payload)? }),
            b'S' => Ok(Self::Start),
            b'P' => Ok(Self::Pause),
            b'U' => data(bytes, payload).map(|(recipe_id, values)| Self::Data { recipe_id, values }),
            b'M' => TextMessage::parse(payload).map(Self::Message),
            _ => Err(wrong("a packet of type V, v, O, I, S, P, U or M")),
        }
    }
}

impl ServerPacket {
    /// The packet with its header.
    #[must_use]
    pub fn encode(&self) -> Vec<u8> {
        match self {
            Self::VersionAccepted(is_accepted) => packet(b'V', &[u8::from(*is_accepted)]),
            Self::ControllerVersion(version) => packet(b'v', &version.map(u32::to_be_bytes).concat()),
            Self::OutputTypes { recipe_id, types } => {
                packet(b'O', &[&[*recipe_id][..], types.join(",").as_bytes()].concat())
            }
            Self::InputTypes { recipe_id, types } => {
                packet(b'I', &[&[*recipe_id][..], types.join(",").as_bytes()].concat())
            }
            Self::Started(is_accepted) => packet(b'S', &[u8::from(*is_accepted)]),
            Self::Paused(is_accepted) => packet(b'P', &[u8::from(*is_accepted)]),
            Self::Data { recipe_id, values } => packet(b'U', &[&[*recipe_id][..], values].concat()),
            Self::Message(message) => packet(b'M', &message.encode()),
        }
    }

    /// Reads one whole packet.
    ///
    /// # Errors
    /// [`MessageError`].
    pub fn parse(bytes: &[u8]) -> Result<Self, MessageError> {
        let (kind, payload) = split(bytes)?;
        let wrong = |expected| MessageError::new(bytes, expected);
        let flag = || match payload {
            [flag] => Ok(*flag != 0),
            _ => Err(wrong("accepted or not, in one byte")),
        };
        match kind {
            b'V' => flag().map(Self::VersionAccepted),
            b'v' => {
                let version: [u8; 16] = exact(payload).ok_or_else(|| wrong("four numbers"))?;
                let part = |idx: usize| u32::from_be_bytes([0, 1, 2, 3].map(|byte| version[4 * idx + byte]));
                Ok(Self::ControllerVersion([0, 1, 2, 3].map(part)))
            }
            b'O' => {
                let (recipe_id, types) = payload.split_first().ok_or_else(|| wrong("a recipe, then types"))?;
                Ok(Self::OutputTypes { recipe_id: *recipe_id, types: list(types)? })
            }
            b'I' => {
                let (recipe_id, types) = payload.split_first().ok_or_else(|| wrong("a recipe, then types"))?;
                Ok(Self::InputTypes { recipe_id: *recipe_id, types: list(types)? })
            }
            b'S' => flag().map(Self::Started),
            b'P' => flag().map(Self::Paused),
            b'U' => data(bytes, payload).map(|(recipe_id, values)| Self::Data { recipe_id, values }),
            b'M' => TextMessage::parse(payload).map(Self::Message),
            _ => Err(wrong("a packet of type V, v, O, I, S, P, U or M")),
        }
    }
}

impl TextMessage {
    fn encode(&self) -> Vec<u8> {
        let mut payload = Vec::new();
        for text in [&self.text, &self.source] {
            let bytes = &text.as_bytes()[..text.len().min(255)];
            payload.push(u8::try_from(bytes.len()).unwrap_or(u8::MAX));
            payload.extend_from_slice(bytes);
        }
        payload.push(self.level);
        payload
    }

    fn parse(payload: &[u8]) -> Result<Self, MessageError> {
        let parts = || {
            let (len, rest) = payload.split_first()?;
            let (text, rest) = rest.split_at_checked(usize::from(*len))?;
            let (len, rest) = rest.split_first()?;
            let (source, rest) = rest.split_at_checked(usize::from(*len))?;
            let readable = |bytes| String::from_utf8_lossy(bytes).into_owned();
            Some(Self { text: readable(text), source: readable(source), level: *rest.first()? })
        };
        parts().ok_or_else(|| MessageError::new(payload, "a text, its source and its level"))
    }
}

fn packet(kind: u8, payload: &[u8]) -> Vec<u8> {
    let payload = &payload[..payload.len().min(MAX_PACKET_BYTES - HEADER_BYTES)];
    let size = u16::try_from(HEADER_BYTES + payload.len()).unwrap_or(u16::MAX);
    [&size.to_be_bytes()[..], &[kind], payload].concat()
}

fn split(bytes: &[u8]) -> Result<(u8, &[u8]), MessageError> {
    match bytes {
        [_, _, kind, payload @ ..] if packet_len(bytes)? == Some(bytes.len()) => Ok((*kind, payload)),
        _ => Err(MessageError::new(bytes, "one whole packet")),
    }
}

fn exact<const N: usize>(payload: &[u8]) -> Option<[u8; N]> {
    payload.try_into().ok()
}

fn data(bytes: &[u8], payload: &[u8]) -> Result<(u8, Vec<u8>), MessageError> {
    let (recipe_id, values) =
        payload.split_first().ok_or_else(|| MessageError::new(bytes, "the number of a recipe, then its values"))?;
    Ok((*recipe_id, values.to_vec()))
}

/// Comma-separated names. Some clients end the list with a comma: an empty name is none.
fn list(bytes: &[u8]) -> Result<Vec<String>, MessageError> {
    let text = std::str::from_utf8(bytes).map_err(|_| MessageError::new(bytes, "names, separated by commas"))?;
    Ok(text.split(',').map(str::trim).filter(|name| !name.is_empty()).map(str::to_owned).collect())
}

/// A value of a recipe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// `BOOL` or `UINT8`.
    U8(u8),
    /// `UINT32`.
    U32(u32),
    /// `UINT64`.
    U64(u64),
    /// `INT32`.
    I32(i32),
    /// `DOUBLE`.
    F64(f64),
    /// `VECTOR3D`.
    Vector3([f64; 3]),
    /// `VECTOR6D`.
    Vector6([f64; 6]),
    /// `VECTOR6INT32`.
    Vector6I32([i32; 6]),
    /// `VECTOR6UINT32`.
    Vector6U32([u32; 6]),
}

impl Value {
    /// The bytes of the value.
    #[must_use]
    pub fn encode(&self) -> Vec<u8> {
        match self {
            Self::U8(value) => vec![*value],
            Self::U32(value) => value.to_be_bytes().to_vec(),
            Self::U64(value) => value.to_be_bytes().to_vec(),
            Self::I32(value) => value.to_be_bytes().to_vec(),
            Self::F64(value) => value.to_be_bytes().to_vec(),
            Self::Vector3(values) => values.map(f64::to_be_bytes).concat(),
            Self::Vector6(values) => values.map(f64::to_be_bytes).concat(),
            Self::Vector6I32(values) => values.map(i32::to_be_bytes).concat(),
            Self::Vector6U32(values) => values.map(u32::to_be_bytes).concat(),
        }
    }

    /// Takes a value of this type from the front of the bytes.
    fn take(type_name: &str, bytes: &mut &[u8]) -> Option<Self> {
        fn chunk<const N: usize>(bytes: &mut &[u8]) -> Option<[u8; N]> {
            let (chunk, rest) = bytes.split_first_chunk::<N>()?;
            *bytes = rest;
            Some(*chunk)
        }
        fn array<T: Copy + Default, const B: usize, const N: usize>(
            bytes: &mut &[u8],
            from_bytes: fn([u8; B]) -> T,
        ) -> Option<[T; N]> {
            let mut values = [T::default(); N];
            for value in &mut values {
                *value = from_bytes(chunk(bytes)?);
            }
            Some(values)
        }
        Some(match type_name {
            "BOOL" | "UINT8" => Self::U8(chunk::<1>(bytes)?[0]),
            "UINT32" => Self::U32(u32::from_be_bytes(chunk(bytes)?)),
            "UINT64" => Self::U64(u64::from_be_bytes(chunk(bytes)?)),
            "INT32" => Self::I32(i32::from_be_bytes(chunk(bytes)?)),
            "DOUBLE" => Self::F64(f64::from_be_bytes(chunk(bytes)?)),
            "VECTOR3D" => Self::Vector3(array(bytes, f64::from_be_bytes)?),
            "VECTOR6D" => Self::Vector6(array(bytes, f64::from_be_bytes)?),
            "VECTOR6INT32" => Self::Vector6I32(array(bytes, i32::from_be_bytes)?),
            "VECTOR6UINT32" => Self::Vector6U32(array(bytes, u32::from_be_bytes)?),
            _ => return None,
        })
    }
}

/// The values of a packet of data, by the types of its recipe.
///
/// # Errors
/// [`MessageError`] if they do not fill the packet.
pub fn parse_values(types: &[String], values: &[u8]) -> Result<Vec<Value>, MessageError> {
    let mut rest = values;
    let parsed: Option<Vec<Value>> = types.iter().map(|type_name| Value::take(type_name, &mut rest)).collect();
    parsed
        .filter(|_| rest.is_empty())
        .ok_or_else(|| MessageError::new(values, format!("values of {}", types.join(","))))
}

/// The payload of a packet of data.
#[must_use]
pub fn encode_values(values: &[Value]) -> Vec<u8> {
    values.iter().flat_map(Value::encode).collect()
}
