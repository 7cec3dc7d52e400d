//! The part of `URScript` that is needed to move: pure, in both directions. Lengths in m, angles in radians.

use nalgebra::Vector3;

use crate::device::error::MessageError;
use crate::geometry::{Base, Tcp, Transform, so3};

/// Longer programs are none of ours.
pub const MAX_PROGRAM_BYTES: usize = 64 * 1024;

/// x, y, z in m and a rotation vector in radians: how scripts and RTDE write the pose of the tool point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UrPose(pub [f64; 6]);

impl UrPose {
    /// A tool point in the middle of the flange.
    pub const AT_FLANGE: Self = Self([0.0; 6]);

    /// As the controller would write it.
    #[must_use]
    pub fn from_pose(base_from_tcp: &Transform<Base, Tcp>) -> Self {
        let position = base_from_tcp.translation_mm() / 1000.0;
        let rotation = so3::log(&base_from_tcp.rotation());
        Self([position.x, position.y, position.z, rotation.x, rotation.y, rotation.z])
    }

    /// The pose that is written so.
    #[must_use]
    pub fn pose(&self) -> Transform<Base, Tcp> {
        let Self([x, y, z, rx, ry, rz]) = *self;
        Transform::from_parts(Vector3::new(x, y, z) * 1000.0, so3::exp(Vector3::new(rx, ry, rz)))
    }
}

/// A statement of a program.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Statement {
    /// Goes straight to a pose.
    MoveL {
        /// Where the tool point goes.
        pose: UrPose,
        /// Acceleration, m/s².
        acceleration_m_s2: f64,
        /// Speed, m/s.
        speed_m_s: f64,
        /// How long it is to take, s; overrules speed and acceleration. 0: as fast as these allow.
        time_s: f64,
    },
    /// Goes to joint angles.
    MoveJ {
        /// The angles, radians.
        joints_rad: [f64; 6],
        /// Acceleration, rad/s².
        acceleration_rad_s2: f64,
        /// Speed, rad/s.
        speed_rad_s: f64,
    },
    /// Writes a register that RTDE shows.
    WriteOutputInteger {
        /// Which.
        register: u8,
        /// What.
        value: i32,
    },
    /// Says where on the flange the tool point is from now on.
    SetTcp {
        /// The tool point in the flange.
        offset: UrPose,
    },
    /// Waits for the end of the controller's cycle: what was set before is then what the controller tells.
    Sync,
    /// Slows the tool point down to a stand.
    StopL {
        /// Deceleration, m/s².
        deceleration_m_s2: f64,
    },
    /// Slows the joints down to a stand.
    StopJ {
        /// Deceleration, rad/s².
        deceleration_rad_s2: f64,
    },
}

impl Statement {
    fn encode(&self) -> String {
        match self {
            Self::MoveL { pose: UrPose(pose), acceleration_m_s2, speed_m_s, time_s } => {
                let time = if *time_s > 0.0 { format!(", t={time_s:.6}") } else { String::new() };
                format!("movel(p[{}], a={acceleration_m_s2:.6}, v={speed_m_s:.6}{time})", numbers(pose))
            }
            Self::MoveJ { joints_rad, acceleration_rad_s2, speed_rad_s } => {
                format!("movej([{}], a={acceleration_rad_s2:.6}, v={speed_rad_s:.6})", numbers(joints_rad))
            }
            Self::WriteOutputInteger { register, value } => {
                format!("write_output_integer_register({register}, {value})")
            }
            Self::SetTcp { offset: UrPose(offset) } => format!("set_tcp(p[{}])", numbers(offset)),
            Self::Sync => "sync()".to_owned(),
            Self::StopL { deceleration_m_s2 } => format!("stopl({deceleration_m_s2:.6})"),
            Self::StopJ { deceleration_rad_s2 } => format!("stopj({deceleration_rad_s2:.6})"),
        }
    }

    /// Reads a call; `None` if it is none of these.
    fn parse(line: &str) -> Option<Self> {
        let (name, arguments) = line.trim().strip_suffix(')')?.split_once('(')?;
        let arguments = Arguments::parse(arguments)?;
        match name.trim() {
            "movel" => Some(Self::MoveL {
                pose: arguments.pose?,
                acceleration_m_s2: arguments.named("a", 0).unwrap_or(1.2),
                speed_m_s: arguments.named("v", 1).unwrap_or(0.25),
                time_s: arguments.named("t", 2).unwrap_or(0.0),
            }),
            "movej" => Some(Self::MoveJ {
                joints_rad: arguments.joints_rad?,
                acceleration_rad_s2: arguments.named("a", 0).unwrap_or(1.4),
                speed_rad_s: arguments.named("v", 1).unwrap_or(1.05),
            }),
            "write_output_integer_register" => Some(Self::WriteOutputInteger {
                register: whole(arguments.named("register", 0)?)?.try_into().ok()?,
                value: whole(arguments.named("value", 1)?)?,
            }),
            "set_tcp" => Some(Self::SetTcp { offset: arguments.pose? }),
            "sync" => Some(Self::Sync),
            "stopl" => Some(Self::StopL { deceleration_m_s2: arguments.named("a", 0).unwrap_or(20.0) }),
            "stopj" => Some(Self::StopJ { deceleration_rad_s2: arguments.named("a", 0)? }),
            _ => None,
        }
    }
}

/// Arguments of a call: at most one vector, then numbers by name or by place. Only its `p` tells a pose from joint angles.
struct Arguments<'a> {
    pose: Option<UrPose>,
    joints_rad: Option<[f64; 6]>,
    numbers: Vec<(Option<&'a str>, f64)>,
}

impl<'a> Arguments<'a> {
    fn parse(text: &'a str) -> Option<Self> {
        let (pose, joints_rad, rest) = match text.split_once('[') {
            Some((before, inside)) => {
                let (inside, rest) = inside.split_once(']')?;
                let values: Vec<f64> = inside.split(',').map(number).collect::<Option<_>>()?;
                let (values, rest) = (values.try_into().ok()?, rest.trim_start().trim_start_matches(','));
                match before.trim() {
                    "p" => (Some(UrPose(values)), None, rest),
                    "" => (None, Some(values), rest),
                    _ => return None,
                }
            }
            None => (None, None, text),
        };
        let numbers = rest
            .split(',')
            .filter(|argument| !argument.trim().is_empty())
            .map(|argument| match argument.split_once('=') {
                Some((name, value)) => Some((Some(name.trim()), number(value)?)),
                None => Some((None, number(argument)?)),
            })
            .collect::<Option<_>>()?;
        Some(Self { pose, joints_rad, numbers })
    }

    /// The number of this name, or the one without a name at this place.
    fn named(&self, name: &str, place: usize) -> Option<f64> {
        let by_name = self.numbers.iter().find(|(found, _)| *found == Some(name));
        let by_place = || self.numbers.get(place).filter(|(found, _)| found.is_none());
        by_name.or_else(by_place).map(|(_, value)| *value)
    }
}

fn number(text: &str) -> Option<f64> {
    text.trim().parse::<f64>().ok().filter(|value| value.is_finite())
}

#[expect(clippy::cast_possible_truncation, reason = "checked to be a whole number of this range")]
fn whole(value: f64) -> Option<i32> {
    (value.fract() == 0.0 && (f64::from(i32::MIN)..=f64::from(i32::MAX)).contains(&value)).then_some(value as i32)
}

/// Nine decimals: a nanometre, and less than that at the end of an arm.
fn numbers(values: &[f64; 6]) -> String {
    values.map(|value| format!("{:.9}", value + 0.0)).join(", ")
}

/// A program: one statement by itself, or a function of several. A new one ends that which runs.
#[derive(Clone, Debug, PartialEq)]
pub struct Program {
    /// The name of the function; empty for a statement by itself.
    pub name: String,
    /// What it does, in order.
    pub statements: Vec<Statement>,
}

impl Program {
    /// A statement by itself.
    #[must_use]
    pub fn single(statement: Statement) -> Self {
        Self { name: String::new(), statements: vec![statement] }
    }

    /// The text as it is sent.
    #[must_use]
    pub fn encode(&self) -> String {
        let lines = self.statements.iter().map(Statement::encode);
        if self.name.is_empty() {
            lines.map(|line| line + "\n").collect()
        } else {
            let head = format!("def {}():", self.name);
            let body = lines.map(|line| "  ".to_owned() + &line);
            [head].into_iter().chain(body).chain(["end\n".to_owned()]).collect::<Vec<_>>().join("\n")
        }
    }

    /// How many of the bytes make the first program; `None` until its last line has come.
    ///
    /// # Errors
    /// [`MessageError`] if it is too long.
    pub fn len_of_first(bytes: &[u8]) -> Result<Option<usize>, MessageError> {
        /// Each has an `end` of its own.
        const OPENERS: [&[u8]; 5] = [b"def", b"sec", b"thread", b"if", b"while"];
        let mut end = 0;
        let mut depth = 0_usize;
        for line in bytes.split_inclusive(|byte| *byte == b'\n') {
            if !line.ends_with(b"\n") {
                break;
            }
            end += line.len();
            let line = line.trim_ascii();
            let is_of_word = |byte: &u8| byte.is_ascii_alphanumeric() || *byte == b'_';
            let word = line.split(|byte| !is_of_word(byte)).next().unwrap_or_default();
            if OPENERS.contains(&word) {
                depth += 1;
            } else if word == b"end" {
                depth = depth.saturating_sub(1);
            }
            if depth == 0 && !line.is_empty() {
                return Ok(Some(end));
            }
        }
        if bytes.len() > MAX_PROGRAM_BYTES {
            return Err(MessageError::new(bytes, format!("a program of at most {MAX_PROGRAM_BYTES} bytes")));
        }
        Ok(None)
    }

    /// Reads one whole program.
    ///
    /// # Errors
    /// [`MessageError`] at the first line that is none of ours.
    pub fn parse(text: &str) -> Result<Self, MessageError> {
        let mut lines =
            text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#')).peekable();
        let mut name = String::new();
        if let Some(head) = lines.peek().and_then(|line| line.strip_prefix("def ")) {
            let head = head.trim_end_matches(':').trim();
            head.strip_suffix("()")
                .ok_or_else(|| MessageError::new(head, "def, a name and ():"))?
                .clone_into(&mut name);
            lines.next();
        }
        let mut statements = Vec::new();
        for line in lines {
            if line == "end" && !name.is_empty() {
                break;
            }
            let statement = Statement::parse(line)
                .ok_or_else(|| MessageError::new(line, "movel, movej, set_tcp, sync, stopl, stopj or a register"))?;
            statements.push(statement);
        }
        Ok(Self { name, statements })
    }
}
