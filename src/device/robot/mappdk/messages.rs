//! What goes over the wire to a MAPPDK server and back; pure, in both directions.
//!
//! A command is a line; the fields of a move stand in fixed columns. A reply is `code:message` **without an end**, so
//! whether it is complete can only be told from the command ([`completeness`]).

use nalgebra::Vector3;

use crate::device::error::MessageError;
use crate::geometry::{Base, Flange, PoseConvention, Transform};

/// What a server says to whoever connects, and to every command that has nothing else to say.
pub const SUCCESS: &str = "success";
/// No reply of the server is longer: strings of its language hold no more.
pub const MAX_REPLY_BYTES: usize = 254;
/// No command is longer, with some room: a move of nine axes has 158 bytes.
pub const MAX_COMMAND_BYTES: usize = 512;

/// The errors that the server is known to answer.
pub const KNOWN_ERRORS: [&str; 12] = [
    "position-is-not-reachable",
    "PR[81]-was-not-set",
    "R[81]-was-not-set",
    "R[82]-was-not-set",
    "R[83]-was-not-set",
    "cannot-convert-joint-vals",
    "error-in-joint-values",
    "cannot-get-ins_pwr",
    "wrong-rdo-value",
    "wrong-dout-value",
    "wrong-sys_var-value",
    "wrong-command",
];

/// x, y, z in mm and W, P, R in degrees, as the controller writes a pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Xyzwpr(pub [f64; 6]);

impl Xyzwpr {
    /// The pose as the controller would write it.
    #[must_use]
    pub fn from_pose(base_from_flange: &Transform<Base, Flange>) -> Self {
        let position = base_from_flange.translation_mm();
        let [w, p, r] = PoseConvention::default_convention().angles_deg_from_rotation(&base_from_flange.rotation());
        Self([position.x, position.y, position.z, w, p, r])
    }

    /// The pose that is written so.
    #[must_use]
    pub fn pose(&self) -> Transform<Base, Flange> {
        let Self([x, y, z, w, p, r]) = *self;
        let rotation = PoseConvention::default_convention().rotation_from_angles_deg([w, p, r]);
        Transform::from_parts(Vector3::new(x, y, z), rotation)
    }
}

/// The fields of a move, of joints or of a pose.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    /// Speed: mm/s in a linear move, percent otherwise; 0 to 9999.
    pub speed: u16,
    /// Acceleration, percent.
    pub acceleration_percent: u16,
    /// How far the corner at the end is cut, 0 (it stops there) to 100.
    pub corner: u16,
    /// Whether the tool point goes straight.
    pub is_linear: bool,
    /// Joint angles in degrees, or x, y, z, W, P, R.
    pub values: Vec<f64>,
}

/// A command to the server.
#[derive(Clone, Debug, PartialEq)]
pub enum Command {
    /// Asks for the pose.
    CurPos,
    /// Asks for the joint angles.
    CurJPos,
    /// Asks for the power that is drawn.
    InsPwr,
    /// Moves the joints.
    MoveJ(Motion),
    /// Moves to a pose.
    MoveP(Motion),
    /// Runs a program of the controller.
    MappdkCall(String),
    /// Reads a digital output of the robot.
    GetRdo(u8),
    /// Sets a digital output of the robot.
    SetRdo(u8, bool),
    /// Reads a digital output.
    GetDout(u16),
    /// Sets a digital output.
    SetDout(u16, bool),
    /// Sets a system variable.
    SetSysVar(String, bool),
    /// Ends the connection.
    Exit,
    /// Anything else; the server answers `1:wrong-command`.
    Other(String),
}

impl Command {
    /// The command as a line, with its end.
    #[must_use]
    pub fn encode(&self) -> String {
        match self {
            Self::CurPos => "curpos\n".to_owned(),
            Self::CurJPos => "curjpos\n".to_owned(),
            Self::InsPwr => "ins_pwr\n".to_owned(),
            Self::MoveJ(motion) => encode_motion("movej", motion),
            Self::MoveP(motion) => encode_motion("movep", motion),
            Self::MappdkCall(program) => format!("mappdkcall:{program}\n"),
            Self::GetRdo(number) => format!("getrdo:{number}\n"),
            Self::SetRdo(number, is_on) => format!("setrdo:{number}:{is_on}\n"),
            Self::GetDout(number) => format!("getdout:{number:05}\n"),
            Self::SetDout(number, is_on) => format!("setdout:{number:05}:{is_on}\n"),
            Self::SetSysVar(name, is_true) => format!("setsysvar:{name}:{}\n", if *is_true { 'T' } else { 'F' }),
            Self::Exit => "exit\n".to_owned(),
            Self::Other(text) => format!("{text}\n"),
        }
    }

    /// Reads a line, with or without its end.
    ///
    /// # Errors
    /// [`MessageError`] where a known command has wrong fields.
    pub fn parse(line: &str) -> Result<Self, MessageError> {
        let line = line.trim_end_matches(['\r', '\n']);
        let (word, fields) = line.split_once(':').unwrap_or((line, ""));
        match word {
            "curpos" => Ok(Self::CurPos),
            "curjpos" => Ok(Self::CurJPos),
            "ins_pwr" => Ok(Self::InsPwr),
            "movej" => parse_motion(line).map(Self::MoveJ),
            "movep" => parse_motion(line).map(Self::MoveP),
            "mappdkcall" => Ok(Self::MappdkCall(fields.to_owned())),
            "getrdo" => Ok(Self::GetRdo(parse_number(line, fields)?)),
            "setrdo" => parse_switch(line, fields).map(|(number, is_on)| Self::SetRdo(number, is_on)),
            "getdout" => Ok(Self::GetDout(parse_number(line, fields)?)),
            "setdout" => parse_switch(line, fields).map(|(number, is_on)| Self::SetDout(number, is_on)),
            "setsysvar" => match fields.rsplit_once(':') {
                Some((name, value @ ("T" | "F"))) => Ok(Self::SetSysVar(name.to_owned(), value == "T")),
                _ => Err(MessageError::new(line, "setsysvar:NAME:T or :F")),
            },
            "exit" => Ok(Self::Exit),
            _ => Ok(Self::Other(line.to_owned())),
        }
    }

    /// What errors call it.
    #[must_use]
    pub const fn word(&self) -> &'static str {
        match self {
            Self::CurPos => "curpos",
            Self::CurJPos => "curjpos",
            Self::InsPwr => "ins_pwr",
            Self::MoveJ(_) => "movej",
            Self::MoveP(_) => "movep",
            Self::MappdkCall(_) => "mappdkcall",
            Self::GetRdo(_) => "getrdo",
            Self::SetRdo(..) => "setrdo",
            Self::GetDout(_) => "getdout",
            Self::SetDout(..) => "setdout",
            Self::SetSysVar(..) => "setsysvar",
            Self::Exit => "exit",
            Self::Other(_) => "another command",
        }
    }
}

/// Speed %04d, acceleration %04d, corner %03d, kind, number of values, then each value in 14 columns.
fn encode_motion(word: &str, motion: &Motion) -> String {
    use std::fmt::Write as _;
    let Motion { speed, acceleration_percent, corner, is_linear, values } = motion;
    let mut line =
        format!("{word}:{speed:04}:{acceleration_percent:04}:{corner:03}:{}:{}", u8::from(*is_linear), values.len());
    for value in values {
        let _ = write!(line, ":{value:+014.6}");
    }
    line.push('\n');
    line
}

/// The server cuts its fields out by column, so we do.
fn parse_motion(line: &str) -> Result<Motion, MessageError> {
    /// Where the first value begins, and how far apart they are.
    const FIRST_VALUE: usize = 24;
    const VALUE_WIDTH: usize = 14;
    let wrong = || MessageError::new(line, "movep:VVVV:AAAA:CCC:M:N and N values of 14 columns");
    let number = |from: usize, to: usize| -> Option<u16> { line.get(from..to)?.trim().parse().ok() };
    let field = |from, to| number(from, to).ok_or_else(wrong);
    let num_values = usize::from(field(22, 23)?);
    let values = (0..num_values)
        .map(|idx| {
            let start = FIRST_VALUE + idx * (VALUE_WIDTH + 1);
            line.get(start..start + VALUE_WIDTH).and_then(parse_real).ok_or_else(wrong)
        })
        .collect::<Result<_, _>>()?;
    Ok(Motion {
        speed: field(6, 10)?,
        acceleration_percent: field(11, 15)?,
        corner: field(16, 19)?,
        is_linear: field(20, 21)? == 1,
        values,
    })
}

fn parse_number<N: std::str::FromStr>(line: &str, field: &str) -> Result<N, MessageError> {
    field.trim().parse().map_err(|_| MessageError::new(line, "the number of an output"))
}

fn parse_switch<N: std::str::FromStr>(line: &str, fields: &str) -> Result<(N, bool), MessageError> {
    match fields.split_once(':') {
        Some((number, value @ ("true" | "false"))) => Ok((parse_number(line, number)?, value == "true")),
        _ => Err(MessageError::new(line, "the number of an output, then true or false")),
    }
}

/// A real as the controller writes it: padded with blanks, and it may lack the zero before the point.
fn parse_real(text: &str) -> Option<f64> {
    text.trim().parse::<f64>().ok().filter(|value| value.is_finite())
}

/// A reply, split at its first colon.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Reply {
    /// Whether the code is 0.
    pub is_ok: bool,
    /// What follows the colon.
    pub message: String,
}

impl Reply {
    /// Success with something to say.
    pub fn ok(message: impl Into<String>) -> Self {
        Self { is_ok: true, message: message.into() }
    }

    /// An error.
    pub fn error(message: impl Into<String>) -> Self {
        Self { is_ok: false, message: message.into() }
    }

    /// The reply as it is sent, without an end.
    #[must_use]
    pub fn encode(&self) -> String {
        format!("{}:{}", u8::from(!self.is_ok), self.message)
    }

    /// Reads a whole reply.
    ///
    /// # Errors
    /// [`MessageError`] if there is no code.
    pub fn parse(bytes: &[u8]) -> Result<Self, MessageError> {
        let text = std::str::from_utf8(bytes).ok().filter(|text| text.is_ascii());
        match text.and_then(|text| text.trim_end().split_once(':')) {
            Some(("0", message)) => Ok(Self::ok(message)),
            Some(("1", message)) => Ok(Self::error(message)),
            _ => Err(MessageError::new(bytes, "0: or 1: and a message")),
        }
    }
}

/// Whether what has arrived is a whole reply.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Completeness {
    /// More must come.
    Partial,
    /// It may be whole; only silence tells.
    Perhaps,
    /// It is whole.
    Whole,
}

/// What tells the end of the reply to a command.
///
/// # Errors
/// [`MessageError`] where no reply begins so, or it is too long.
pub fn completeness(command: &Command, bytes: &[u8]) -> Result<Completeness, MessageError> {
    if bytes.len() > MAX_REPLY_BYTES {
        return Err(MessageError::new(bytes, format!("at most {MAX_REPLY_BYTES} bytes")));
    }
    let [code, colon, message @ ..] = bytes else {
        return match bytes {
            [] | [b'0' | b'1'] => Ok(Completeness::Partial),
            _ => Err(MessageError::new(bytes, "0: or 1:")),
        };
    };
    if !matches!(code, b'0' | b'1') || *colon != b':' {
        return Err(MessageError::new(bytes, "0: or 1:"));
    }
    if message.is_empty() {
        return Ok(Completeness::Partial);
    }
    if *code == b'1' {
        let is_known = KNOWN_ERRORS.iter().any(|error| error.as_bytes() == message);
        return Ok(if is_known { Completeness::Whole } else { Completeness::Perhaps });
    }
    let is_whole = match command {
        Command::CurPos => {
            let num_fields = message.split(|byte| *byte == b'=').count() - 1;
            let decimals = message.rsplit(|byte| *byte == b'.').next().unwrap_or_default();
            num_fields == 6 && decimals.len() == 3 && decimals.iter().all(u8::is_ascii_digit)
        }
        Command::MoveJ(_) | Command::MoveP(_) | Command::MappdkCall(_) | Command::SetSysVar(..) | Command::Exit => {
            message == SUCCESS.as_bytes()
        }
        // Nine axes; only silence tells whether the last number is whole, and so for all that answer a number.
        Command::CurJPos if message.windows(2).filter(|pair| pair == b"j=").count() < 9 => false,
        _ => return Ok(Completeness::Perhaps),
    };
    Ok(if is_whole { Completeness::Whole } else { Completeness::Partial })
}

/// The message of a reply to `curpos`: each number with three decimals in a field of at least eight, a blank before it.
#[must_use]
pub fn encode_position(position: &Xyzwpr) -> String {
    let Xyzwpr([x, y, z, w, p, r]) = position;
    let real = |value: &f64| format!(" {value:>7.3}");
    format!("x={},y={},z={},w={},p={},r={}", real(x), real(y), real(z), real(w), real(p), real(r))
}

/// Reads the message of a reply to `curpos`.
///
/// # Errors
/// [`MessageError`].
pub fn parse_position(message: &str) -> Result<Xyzwpr, MessageError> {
    let wrong = || MessageError::new(message, "x=, y=, z=, w=, p=, r= with a number each");
    let mut values = [0.0; 6];
    let mut fields = message.split(',');
    for (value, name) in values.iter_mut().zip(["x", "y", "z", "w", "p", "r"]) {
        let (found, number) = fields.next().and_then(|field| field.split_once('=')).ok_or_else(wrong)?;
        if found.trim() != name {
            return Err(wrong());
        }
        *value = parse_real(number).ok_or_else(wrong)?;
    }
    if fields.next().is_some() {
        return Err(wrong());
    }
    Ok(Xyzwpr(values))
}

/// The message of a reply to `curjpos`: nine axes, `none` where there is none.
#[must_use]
pub fn encode_joints(joints_deg: &[f64]) -> String {
    let axis = |idx: usize| joints_deg.get(idx).map_or_else(|| "j=none".to_owned(), |angle| format!("j= {angle:>7.3}"));
    (0..9).map(axis).collect::<Vec<_>>().join(",")
}

/// Reads the message of a reply to `curjpos`.
///
/// # Errors
/// [`MessageError`].
pub fn parse_joints(message: &str) -> Result<Vec<f64>, MessageError> {
    let wrong = || MessageError::new(message, "nine times j= with a number or none");
    let mut joints_deg = Vec::new();
    let fields: Vec<&str> = message.split(',').collect();
    if fields.len() != 9 {
        return Err(wrong());
    }
    for field in fields {
        match field.trim().strip_prefix("j=").map(str::trim) {
            Some("none") => {}
            Some(number) => joints_deg.push(parse_real(number).ok_or_else(wrong)?),
            None => return Err(wrong()),
        }
    }
    Ok(joints_deg)
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN_MOVE: &str = "movep:0020:0100:000:1:6:+000560.000000:-000109.750000:-000140.500000:+000179.900000:-000000.060000:+000030.500000\n";

    #[test]
    fn a_move_is_written_and_read_in_its_columns() {
        let motion = Motion {
            speed: 20,
            acceleration_percent: 100,
            corner: 0,
            is_linear: true,
            values: vec![560.0, -109.75, -140.5, 179.9, -0.06, 30.5],
        };
        assert_eq!(Command::MoveP(motion.clone()).encode(), GOLDEN_MOVE);
        assert_eq!(Command::parse(GOLDEN_MOVE), Ok(Command::MoveP(motion)));
    }

    #[test]
    fn commands_survive_the_wire() {
        let motion =
            Motion { speed: 9999, acceleration_percent: 5, corner: 100, is_linear: false, values: vec![0.5; 9] };
        for command in [
            Command::CurPos,
            Command::CurJPos,
            Command::InsPwr,
            Command::MoveJ(motion),
            Command::MappdkCall("A_PROG".to_owned()),
            Command::GetRdo(7),
            Command::SetRdo(7, true),
            Command::GetDout(42),
            Command::SetDout(42, false),
            Command::SetSysVar("$X:Y".to_owned(), true),
            Command::Exit,
            Command::Other("ver".to_owned()),
        ] {
            assert_eq!(Command::parse(&command.encode()), Ok(command));
        }
    }

    #[test]
    fn moves_with_wrong_columns_are_no_moves() {
        for line in
            ["movep", "movep:20:100:0:1:6:1:2:3:4:5:6", &GOLDEN_MOVE[..90], "movep:0020:0100:000:1:7:+000560.00000é"]
        {
            assert!(Command::parse(line).is_err(), "{line}");
        }
    }

    #[test]
    fn positions_are_read_with_blanks_and_without_leading_zeros() {
        let message = "x= 560.000,y= -110.250,z= -140.500,w= 179.900,p=    -.060,r=  30.500";
        assert_eq!(parse_position(message), Ok(Xyzwpr([560.0, -110.25, -140.5, 179.9, -0.06, 30.5])));
        let position = Xyzwpr([560.0, -110.25, -1400.5, 179.9, -0.06, 30.5]);
        assert_eq!(encode_position(&position), "x= 560.000,y= -110.250,z= -1400.500,w= 179.900,p=  -0.060,r=  30.500");
        assert_eq!(parse_position(&encode_position(&position)), Ok(position));
        for wrong in
            ["", "x=1", "x=1,y=2,z=3,w=4,p=5,r=*****", "x=1,y=2,z=3,w=4,p=5,q=6", "x=1,y=2,z=3,w=4,p=5,r=6,e=7"]
        {
            assert!(parse_position(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn joints_are_read_for_as_many_axes_as_there_are() {
        let message = encode_joints(&[0.0, -12.5, 90.0, 0.25, -45.0, 180.0]);
        assert_eq!(parse_joints(&message), Ok(vec![0.0, -12.5, 90.0, 0.25, -45.0, 180.0]));
        assert!(message.ends_with("j=none,j=none,j=none"));
        assert!(parse_joints("j=1,j=2").is_err());
    }

    #[test]
    fn the_end_of_a_reply_is_told_by_its_command() {
        use Completeness::{Partial, Perhaps, Whole};
        let move_command = Command::parse(GOLDEN_MOVE).expect("golden");
        let cases: [(&Command, &str, Completeness); 12] = [
            (&Command::CurPos, "", Partial),
            (&Command::CurPos, "0", Partial),
            (&Command::CurPos, "0:", Partial),
            (&Command::CurPos, "0:x= 1.000,y= 2.000,z= 3.000,w= 4.000,p= 5.000,r= 6.00", Partial),
            (&Command::CurPos, "0:x= 1.000,y= 2.000,z= 3.000,w= 4.000,p= 5.000,r= 6.000", Whole),
            (&move_command, "0:succes", Partial),
            (&move_command, "0:success", Whole),
            (&move_command, "1:position-is-not-reach", Perhaps),
            (&move_command, "1:position-is-not-reachable", Whole),
            (&move_command, "1:", Partial),
            (&Command::InsPwr, "0:1.", Perhaps),
            (&Command::CurJPos, "0:j=1.0,j=", Partial),
        ];
        for (command, bytes, expected) in cases {
            assert_eq!(completeness(command, bytes.as_bytes()), Ok(expected), "{bytes}");
        }
        assert!(completeness(&Command::CurPos, b"HTTP/1.0").is_err());
        assert!(completeness(&Command::CurPos, &[b'0'; 300]).is_err());
    }

    #[test]
    fn poses_survive_wpr_at_the_half_turn_and_in_gimbal_lock() {
        for angles in [
            [180.0, 0.0, 0.0],
            [-180.0, 0.0, 180.0],
            [179.999_999_9, 0.0, -30.0],
            [20.0, 90.0, 50.0],
            [0.0, -90.0, 1.0],
        ] {
            let pose = Xyzwpr([1.0, 2.0, 3.0, angles[0], angles[1], angles[2]]).pose();
            let again = Xyzwpr::from_pose(&pose).pose();
            assert!(pose.rotation().angle_to(&again.rotation()) < 1e-7, "{angles:?}");
        }
    }
}
