//! The dashboard of a Universal Robots controller: a line to ask, a line to answer; pure, in both directions.

use crate::device::error::MessageError;

/// What the server says to whoever connects.
pub const GREETING: &str = "Connected: Universal Robots Dashboard Server";
/// Longer lines are none of this protocol.
pub const MAX_LINE_BYTES: usize = 1024;

/// A question.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Question {
    /// `robotmode`, answered by `Robotmode: RUNNING`.
    RobotMode,
    /// `safetystatus`, answered by `Safetystatus: NORMAL`.
    SafetyStatus,
    /// `is in remote control`, answered by `true` or `false`; by something else where the software is too old.
    IsInRemoteControl,
    /// `running`, answered by `Program running: false`.
    Running,
    /// `PolyscopeVersion`.
    PolyscopeVersion,
    /// `get serial number`.
    SerialNumber,
    /// `quit`, answered by `Disconnected`.
    Quit,
    /// Anything else.
    Other(String),
}

impl Question {
    const KNOWN: [Self; 7] = [
        Self::RobotMode,
        Self::SafetyStatus,
        Self::IsInRemoteControl,
        Self::Running,
        Self::PolyscopeVersion,
        Self::SerialNumber,
        Self::Quit,
    ];

    /// The words, without the end of the line.
    #[must_use]
    pub fn words(&self) -> &str {
        match self {
            Self::RobotMode => "robotmode",
            Self::SafetyStatus => "safetystatus",
            Self::IsInRemoteControl => "is in remote control",
            Self::Running => "running",
            Self::PolyscopeVersion => "PolyscopeVersion",
            Self::SerialNumber => "get serial number",
            Self::Quit => "quit",
            Self::Other(words) => words,
        }
    }

    /// The line.
    #[must_use]
    pub fn encode(&self) -> String {
        format!("{}\n", self.words())
    }

    /// Reads a line; capitals do not matter.
    #[must_use]
    pub fn parse(line: &str) -> Self {
        let words = line.trim();
        let known = Self::KNOWN.into_iter().find(|question| question.words().eq_ignore_ascii_case(words));
        known.unwrap_or_else(|| Self::Other(words.to_owned()))
    }
}

/// How many of the bytes make the first line, its end included; `None` until it has come.
///
/// # Errors
/// [`MessageError`] if it is too long.
pub fn line_len(bytes: &[u8]) -> Result<Option<usize>, MessageError> {
    match bytes.iter().position(|byte| *byte == b'\n') {
        Some(end) if end < MAX_LINE_BYTES => Ok(Some(end + 1)),
        None if bytes.len() < MAX_LINE_BYTES => Ok(None),
        _ => Err(MessageError::new(bytes, format!("a line of at most {MAX_LINE_BYTES} bytes"))),
    }
}

/// What the answer to `is in remote control` says; `None` where the controller does not know the question.
#[must_use]
pub fn parse_remote_control(line: &str) -> Option<bool> {
    match line.trim().to_ascii_lowercase().as_str() {
        "true" => Some(true),
        "false" => Some(false),
        _ => None,
    }
}

/// The answer to `is in remote control`.
#[must_use]
pub fn encode_remote_control(is_remote: bool) -> String {
    format!("{is_remote}\n")
}
