//! The messages of the text bridge; pure, in both directions. A request is a line, and its reply is a line with its id.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::device::error::{MessageError, sentence};
use crate::geometry::{Base, Flange, PoseConvention, Profile, Transform};

/// The version of the protocol; in every message as `bridge`.
pub const VERSION: u32 = 1;
/// A line, its end included, has at most so many bytes: twenty thousand points with all their digits.
pub const MAX_LINE_BYTES: usize = 1024 * 1024;

/// What stands on the other side.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BridgedDevice {
    /// A robot.
    Robot,
    /// A profiler.
    Profiler,
}

/// A request of ours.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Request {
    /// [`VERSION`].
    pub bridge: u32,
    /// Comes back in the reply.
    pub id: u64,
    /// What is asked.
    #[serde(flatten)]
    pub ask: Ask,
}

/// What is asked.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "request", rename_all = "kebab-case")]
pub enum Ask {
    /// Both: who are you? The first request of a connection. Answered by [`Answer::Hello`].
    Hello {
        /// What we think to talk to.
        device: BridgedDevice,
    },
    /// Robot: pose and state. Answered by [`Answer::State`].
    State,
    /// Robot: go straight there. Answered by [`Answer::Accepted`] at once.
    Move {
        /// Where to.
        pose: BridgePose,
        /// How fast, mm/s.
        speed_mm_s: f64,
        /// How fast it may turn, degrees a second.
        rotation_speed_deg_s: f64,
    },
    /// Robot: stand still, now. Answered by [`Answer::Accepted`] at once.
    Stop,
    /// Profiler: the newest profile. Answered by [`Answer::Profile`] or [`Answer::NoProfile`].
    Newest,
    /// Profiler: forget what was measured so far. Answered by [`Answer::Accepted`].
    Forget,
}

impl Ask {
    /// What errors call it.
    #[must_use]
    pub const fn word(&self) -> &'static str {
        match self {
            Self::Hello { .. } => "hello",
            Self::State => "state",
            Self::Move { .. } => "move",
            Self::Stop => "stop",
            Self::Newest => "newest",
            Self::Forget => "forget",
        }
    }
}

/// The reply to a request.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reply {
    /// [`VERSION`].
    pub bridge: u32,
    /// That of the request.
    pub id: u64,
    /// The answer.
    #[serde(flatten)]
    pub answer: Answer,
}

/// An answer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "reply", rename_all = "kebab-case")]
pub enum Answer {
    /// Who it is.
    Hello(Hello),
    /// Pose and state of a robot.
    State(RobotState),
    /// It was understood and is being done.
    Accepted,
    /// A profile.
    Profile(BridgeProfile),
    /// There is no profile (yet).
    NoProfile,
    /// It was understood and will not be done.
    Refused {
        /// Why.
        found: String,
        /// What to do.
        #[serde(default)]
        remedy: String,
    },
}

impl Answer {
    /// What errors call it.
    #[must_use]
    pub const fn word(&self) -> &'static str {
        match self {
            Self::Hello(_) => "hello",
            Self::State(_) => "state",
            Self::Accepted => "accepted",
            Self::Profile(_) => "profile",
            Self::NoProfile => "no-profile",
            Self::Refused { .. } => "refused",
        }
    }
}

/// Who answers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Hello {
    /// What it is.
    pub device: BridgedDevice,
    /// Its name, for people.
    pub name: String,
    /// Robot: whether it can be moved by this bridge.
    #[serde(default)]
    pub can_move: bool,
    /// Robot: the least step of a reported coordinate, mm; 0 where nobody knows.
    #[serde(default)]
    pub resolution_mm: f64,
    /// Robot: which tool and frame its poses are of, for people.
    #[serde(default)]
    pub tool: String,
    /// Robot: in which way of writing angles it wants and gives orientations (the id of a pose convention, such as
    /// `kuka-abc`); none: quaternions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub convention: Option<String>,
}

/// A pose: the flange in the base.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BridgePose {
    /// Position, mm.
    pub position_mm: [f64; 3],
    /// Orientation; always in a request.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub quaternion_wxyz: Option<[f64; 4]>,
    /// Orientation in the robot's own angles, degrees; in a request where its hello named a convention.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub angles_deg: Option<[f64; 3]>,
}

impl BridgePose {
    /// Writes a pose: the quaternion, and the angles where the robot has its own.
    #[must_use]
    pub fn from_pose(base_from_flange: &Transform<Base, Flange>, convention: Option<&PoseConvention>) -> Self {
        Self {
            position_mm: base_from_flange.translation_mm().into(),
            quaternion_wxyz: Some(base_from_flange.quaternion_wxyz()),
            angles_deg: convention.map(|convention| convention.angles_deg_from_rotation(&base_from_flange.rotation())),
        }
    }

    /// Reads a pose; the quaternion counts where both are there.
    ///
    /// # Errors
    /// [`MessageError`] if there is no orientation, or no pose of a robot.
    pub fn pose(&self, convention: Option<&PoseConvention>) -> Result<Transform<Base, Flange>, MessageError> {
        /// No robot reaches further.
        const MAX_POSITION_MM: f64 = 1e5;
        /// As far as rounding to two decimals takes a quaternion from unit length.
        const MAX_LENGTH_ERROR: f64 = 0.02;
        let position = Vector3::from(self.position_mm);
        if !position.iter().all(|value| value.abs() <= MAX_POSITION_MM) {
            return Err(MessageError::new(format!("{:?}", self.position_mm), "a position in mm"));
        }
        let rotation = match (self.quaternion_wxyz, self.angles_deg, convention) {
            (Some([w, x, y, z]), ..) => {
                let quaternion = Quaternion::new(w, x, y, z);
                if (quaternion.norm() - 1.0).abs() < MAX_LENGTH_ERROR {
                    UnitQuaternion::from_quaternion(quaternion)
                } else {
                    return Err(MessageError::new(format!("{:?}", [w, x, y, z]), "a quaternion of length 1"));
                }
            }
            (None, Some(angles_deg), Some(convention)) if angles_deg.iter().all(|angle| angle.is_finite()) => {
                convention.rotation_from_angles_deg(angles_deg)
            }
            _ => {
                let expected = "quaternion_wxyz, or angles_deg and the convention named in hello";
                return Err(MessageError::new("a pose without orientation", expected));
            }
        };
        Ok(Transform::from_parts(position, rotation))
    }
}

/// Pose and state of a robot.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RobotState {
    /// Where the flange is.
    pub pose: BridgePose,
    /// Joint angles, degrees; may be left out.
    #[serde(default)]
    pub joints_deg: Vec<f64>,
    /// From the moment a move is accepted until the robot stands still again.
    pub is_moving: bool,
    /// Why it takes no move now (not in remote mode, emergency stop, ...); none: it takes one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub not_ready: Option<String>,
    /// Why the last move was given up; none: it was not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub move_failed: Option<String>,
}

/// A profile.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BridgeProfile {
    /// Grows by one or more with each profile that is taken, modulo 2³².
    pub trigger_count: u32,
    /// Across the line, mm.
    pub x_mm: Vec<f64>,
    /// Along the range axis, mm; null where there is no valid point.
    pub z_mm: Vec<Option<f64>>,
}

impl BridgeProfile {
    /// The profile.
    ///
    /// # Errors
    /// [`MessageError`] if it is none.
    pub fn profile(self) -> Result<Profile, MessageError> {
        Profile::new(self.x_mm, &self.z_mm).map_err(|error| MessageError::new("no profile", error.to_string()))
    }
}

/// Writes a line, its end included.
///
/// # Errors
/// [`MessageError`] if it is too long.
pub fn encode_line<T: Serialize>(message: &T) -> Result<String, MessageError> {
    let mut line = serde_json::to_string(message)
        .map_err(|error| MessageError::new(error.to_string(), "a message that can be written as JSON"))?;
    line.push('\n');
    if line.len() > MAX_LINE_BYTES {
        return Err(MessageError::new(&line, format!("a line of at most {MAX_LINE_BYTES} bytes")));
    }
    Ok(line)
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

/// Reads a request.
///
/// # Errors
/// [`MessageError`].
pub fn parse_request(line: &[u8]) -> Result<Request, MessageError> {
    parse_line(line)
}

/// Reads a reply.
///
/// # Errors
/// [`MessageError`].
pub fn parse_reply(line: &[u8]) -> Result<Reply, MessageError> {
    parse_line(line)
}

/// The version is looked at first: a message of another one may have other fields.
fn parse_line<T: DeserializeOwned>(line: &[u8]) -> Result<T, MessageError> {
    #[derive(Deserialize)]
    struct Versioned {
        bridge: u32,
    }
    let wrong = |error: serde_json::Error| {
        MessageError::new(line, format!("a line of the text bridge ({})", sentence(&error.to_string())))
    };
    let Versioned { bridge } = serde_json::from_slice(line).map_err(wrong)?;
    if bridge != VERSION {
        return Err(MessageError::new(format!("version {bridge}"), format!("version {VERSION} of the text bridge")));
    }
    serde_json::from_slice(line).map_err(wrong)
}
