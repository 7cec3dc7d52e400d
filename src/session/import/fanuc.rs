//! FANUC programs, `.ls`: the positions of the section `/POS`.

use crate::geometry::PoseNotation;
use crate::geometry::notation::{AngleUnit, LengthUnit, OrientationForm};
use crate::sheet::text::number;
use crate::watch::Cancelled;

use super::gather::{Gathered, OwnFrames, RawPose};
use super::program::{Frames, Unknown, head, show};
use super::read::Progress;
use super::scan::Scanner;
use super::{Preview, Source, program};

const COORDINATES: [&str; 6] = ["X", "Y", "Z", "W", "P", "R"];

/// Whether a text is such a program.
pub(super) fn is_program(text: &str) -> bool {
    text.contains("GP1") && text.contains("P[")
}

pub(super) fn notation(fallback: &PoseNotation) -> PoseNotation {
    let units = (AngleUnit::Degrees, LengthUnit::Millimetres);
    program::notation("fanuc-wpr", OrientationForm::Angles, units, &Frames::default(), fallback)
}

/// A position as it stands in the program.
#[derive(Default)]
struct Position<'t> {
    user_frame: &'t str,
    tool: &'t str,
    coordinates: [Option<f64>; 6],
    has_joints: bool,
    num_groups: usize,
    /// A value that is none: where it stands, and its text.
    bad: Option<(usize, &'t str)>,
}

/// Reads the positions of a program.
///
/// # Errors
/// [`Cancelled`].
pub(super) fn read(
    source: &Source,
    text: &str,
    gathered: &mut Gathered,
    preview: &mut Preview,
    progress: &mut Progress<'_>,
) -> Result<(), Cancelled> {
    head(preview, gathered.notation());
    let mut unknown = Unknown::default();
    let mut scanner = Scanner::new(text, "");
    scanner.jump(text.find("/POS").unwrap_or_default());
    while let Some(offset) = scanner.rest().find("P[") {
        progress.tick()?;
        let start = scanner.at() + offset;
        scanner.jump(start + 2);
        let Some(label) = label(&mut scanner) else { continue };
        let at = scanner.place(start);
        let position = body(&mut scanner);
        if position.num_groups > 1 {
            unknown.other_group();
        }
        if let Some((byte, found)) = position.bad {
            let place = scanner.place(byte);
            gathered.problem(&source.name, place, found, "a number, as X = 562.415 mm");
            continue;
        }
        if position.has_joints && position.coordinates.iter().all(Option::is_none) {
            unknown.joint_pose();
            continue;
        }
        if let Some(missing) = position.coordinates.iter().position(Option::is_none) {
            let found = format!("P[{label}] without {}", COORDINATES[missing]);
            gathered.problem(&source.name, at, &found, "X, Y, Z, W, P and R");
            continue;
        }
        let numbers = position.coordinates.map(Option::unwrap_or_default);
        let frames = OwnFrames {
            is_in_base: position.user_frame == "0",
            is_of_flange: position.tool == "0",
            ..OwnFrames::default()
        };
        if !frames.is_in_base {
            unknown.frame(&format!("UFRAME {}", position.user_frame));
        }
        if !frames.is_of_flange {
            unknown.tool(&format!("UTOOL {}", position.tool));
        }
        show(preview, at.0, label, &numbers);
        gathered.take(
            &source.name,
            &RawPose { at, label: Some(label.into()), numbers: &numbers, frames, ..RawPose::default() },
        );
    }
    unknown.note(gathered);
    Ok(())
}

/// The comment or the number of a position, up to and with its brace; `None` if it is one in a move.
fn label<'t>(scanner: &mut Scanner<'t>) -> Option<&'t str> {
    const MAX_BYTES: usize = 100;
    let rest = scanner.rest();
    let end = rest.bytes().take(MAX_BYTES).position(|byte| byte == b']')?;
    let inside = &rest[..end];
    let (number, comment) = inside.split_once(':').unwrap_or((inside, ""));
    number.trim().parse::<u32>().ok()?;
    let after = scanner.at() + end + 1;
    scanner.jump(after);
    if !scanner.eat('{') {
        scanner.jump(after);
        return None;
    }
    let comment = comment.trim().trim_matches(['"', '\'']).trim();
    Some(if comment.is_empty() { number.trim() } else { comment })
}

/// What stands between the braces; of several groups the first.
fn body<'t>(scanner: &mut Scanner<'t>) -> Position<'t> {
    let mut position = Position { user_frame: "0", tool: "0", ..Position::default() };
    loop {
        scanner.skip_blanks();
        match scanner.peek() {
            None | Some('}' | '{' | '/') => return position,
            Some('\'') => {
                scanner.bump();
                let rest = scanner.rest();
                let end = rest.find(['\'', '\n', '}']).unwrap_or(rest.len());
                scanner.jump(scanner.at() + end);
                if scanner.peek() == Some('\'') {
                    scanner.bump();
                }
            }
            Some(c) if c.is_ascii_alphabetic() => {
                let key = scanner.word();
                if !(scanner.eat(':') || scanner.eat('=')) {
                    continue;
                }
                if key.starts_with("GP") {
                    position.num_groups += 1;
                    continue;
                }
                if position.num_groups > 1 || key == "CONFIG" {
                    continue;
                }
                scanner.skip_blanks();
                let rest = scanner.rest();
                let value = rest[..rest.find([',', '\n', '\r', '}', ';', '\t']).unwrap_or(rest.len())].trim();
                match key {
                    "UF" => position.user_frame = value,
                    "UT" => position.tool = value,
                    _ => position.take(key, value, scanner.at()),
                }
                scanner.jump(scanner.at() + value.len());
            }
            Some(_) => {
                scanner.bump();
            }
        }
    }
}

impl<'t> Position<'t> {
    fn take(&mut self, key: &str, value: &'t str, byte: usize) {
        let is_joint = key.strip_prefix('J').is_some_and(|number| number.parse::<u8>().is_ok());
        self.has_joints |= is_joint;
        if let Some(idx) = COORDINATES.iter().position(|name| *name == key) {
            self.coordinates[idx] = number(value, false);
            if self.coordinates[idx].is_none() {
                self.bad.get_or_insert((byte, value));
            }
        }
    }
}
