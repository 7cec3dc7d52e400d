//! What can go wrong between us and a device: what was asked, what was found, what was needed, what to do.

use std::time::Duration;

use thiserror::Error;

/// Why a device did not do what it was asked.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum DeviceError {
    /// Nobody answers at the address.
    #[error("{device}: no connection to {address} ({reason}); {remedy}")]
    NotConnected {
        /// The device's name.
        device: &'static str,
        /// Host and port.
        address: String,
        /// What the system said.
        reason: String,
        /// What to do.
        remedy: &'static str,
    },
    /// The deadline passed.
    #[error("{device}: no answer to {request} within {} ms; check the cable, and that the controller is not paused", waited.as_millis())]
    Timeout {
        /// The device's name.
        device: &'static str,
        /// What was asked.
        request: String,
        /// How long it was waited for.
        waited: Duration,
    },
    /// The other side closed the connection.
    #[error("{device}: the connection was closed during {request}; see whether its program still runs")]
    Closed {
        /// The device's name.
        device: &'static str,
        /// What was asked.
        request: String,
    },
    /// The answer is none of this protocol.
    #[error("{device}: found {found} in answer to {request}, needed {expected}; {remedy}")]
    Unexpected {
        /// The device's name.
        device: &'static str,
        /// What was asked.
        request: String,
        /// What came.
        found: String,
        /// What should have come.
        expected: String,
        /// What to do.
        remedy: &'static str,
    },
    /// The device understood and says no.
    #[error("{device}: {request} was refused: {found}; {remedy}")]
    Refused {
        /// The device's name.
        device: &'static str,
        /// What was asked.
        request: String,
        /// What it said.
        found: String,
        /// What to do.
        remedy: String,
    },
    /// The controller has looked at the target before it moved, and the arm cannot get there. Another target may do.
    #[error("{device}: {request} was refused: {found}; {remedy}")]
    OutOfReach {
        /// The device's name.
        device: &'static str,
        /// What was asked.
        request: String,
        /// What it said.
        found: String,
        /// What to do.
        remedy: String,
    },
    /// The device is not in a state to do that.
    #[error("{device}: found {found}, needed {needed}; {remedy}")]
    NotReady {
        /// The device's name.
        device: &'static str,
        /// Its state.
        found: String,
        /// The state that it would have to be in.
        needed: &'static str,
        /// What to do.
        remedy: &'static str,
    },
    /// This driver only reads.
    #[error("{device}: this connection can only read; jog the robot by hand, or connect with a driver that moves it")]
    CannotMove {
        /// The device's name.
        device: &'static str,
    },
    /// The robot stopped somewhere else than it was sent.
    #[error("{device}: stopped {distance_mm:.3} mm and {turn_deg:.3}° from the target of the move; clear what holds it up and look at its alarms", distance_mm = f64::from(*distance_um) / 1000.0, turn_deg = f64::from(*turn_mdeg) / 1000.0)]
    NotArrived {
        /// The device's name.
        device: &'static str,
        /// How far from the target, µm.
        distance_um: u32,
        /// How far turned against it, thousandths of a degree.
        turn_mdeg: u32,
    },
    /// Somebody pressed stop.
    #[error("{device}: stopped on request")]
    Stopped {
        /// The device's name.
        device: &'static str,
    },
    /// The system refused something else than the network: a folder, a file, a thread.
    #[error("{device}: {what} failed ({reason})")]
    System {
        /// The device's name.
        device: &'static str,
        /// What was tried.
        what: String,
        /// What the system said.
        reason: String,
    },
}

impl DeviceError {
    /// Whether the device may be asked further over the same connection.
    #[must_use]
    pub const fn leaves_connection_usable(&self) -> bool {
        matches!(
            self,
            Self::Refused { .. }
                | Self::OutOfReach { .. }
                | Self::NotReady { .. }
                | Self::CannotMove { .. }
                | Self::NotArrived { .. }
                | Self::Stopped { .. }
        )
    }

    /// Whether the same attempt may succeed later although nobody has done anything about it.
    #[must_use]
    pub const fn may_pass_by_itself(&self) -> bool {
        !matches!(
            self,
            Self::Refused { .. } | Self::OutOfReach { .. } | Self::NotReady { .. } | Self::CannotMove { .. }
        )
    }
}

/// What a message holds that its protocol does not allow. Parsers are pure and know no device: a driver makes a
/// [`DeviceError::Unexpected`] of it.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("found {found}, needed {expected}")]
pub struct MessageError {
    /// What came.
    pub found: String,
    /// What should have come.
    pub expected: String,
}

impl MessageError {
    /// From the bytes that were found; long ones are cut.
    pub fn new(found: impl AsRef<[u8]>, expected: impl Into<String>) -> Self {
        Self { found: excerpt(found), expected: expected.into() }
    }

    /// The same as the answer of a device to a request.
    #[must_use]
    pub fn of(self, device: &'static str, request: &str, remedy: &'static str) -> DeviceError {
        DeviceError::Unexpected {
            device,
            request: request.to_owned(),
            found: self.found,
            expected: self.expected,
            remedy,
        }
    }
}

/// As much as fits a line beside the rest of a sentence.
const MAX_SHOWN: usize = 60;
/// A sentence of somebody else may be longer, and is still read.
const MAX_SENTENCE: usize = 240;

/// Bytes from a wire as a short text that can be shown: quoted, escaped, cut.
#[must_use]
pub fn excerpt(bytes: impl AsRef<[u8]>) -> String {
    let bytes = bytes.as_ref();
    match bytes.len() {
        0 => "nothing".to_owned(),
        len if len > MAX_SHOWN => format!("\"{}\"… ({len} bytes)", bytes[..MAX_SHOWN].escape_ascii()),
        _ => format!("\"{}\"", bytes.escape_ascii()),
    }
}

/// What a device says for people to read, on one line, cut where it goes on and on.
#[must_use]
pub fn sentence(text: &str) -> String {
    let mut shown: String = text.chars().take(MAX_SENTENCE).map(|c| if c.is_control() { ' ' } else { c }).collect();
    if text.chars().nth(MAX_SENTENCE).is_some() {
        shown.push('…');
    }
    shown
}

/// What the system says, without its number.
#[must_use]
pub fn system_words(error: &std::io::Error) -> String {
    let told = error.to_string();
    told.split_once(" (os error ").map_or(told.as_str(), |(words, _)| words).to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_of_the_system_are_words() {
        let refused = std::io::Error::from_raw_os_error(111);
        assert!(refused.to_string().contains("os error"));
        let told = system_words(&refused);
        assert!(!told.is_empty() && !told.contains("os error") && !told.contains('('), "{told}");
        assert_eq!(system_words(&std::io::Error::other("deadline passed")), "deadline passed");
    }

    #[test]
    fn what_comes_from_a_wire_is_shown_short_and_on_one_line() {
        assert_eq!(excerpt(b""), "nothing");
        assert_eq!(excerpt(b"a\"\n\xff"), r#""a\"\n\xff""#);
        assert_eq!(excerpt(vec![b'x'; 5000]), format!("\"{}\"… (5000 bytes)", "x".repeat(60)));
        assert_eq!(sentence("joint 5\nat its limit"), "joint 5 at its limit");
        assert_eq!(sentence(&"ä".repeat(5000)), "ä".repeat(240) + "…");
    }
}
