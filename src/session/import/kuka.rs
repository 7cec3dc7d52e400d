//! KUKA programs and data lists, `.src` and `.dat`: positions in braces, `{X 1,Y 2,Z 3,A 4,B 5,C 6,…}`.

use std::borrow::Cow;
use std::collections::HashMap;

use crate::geometry::PoseNotation;
use crate::geometry::notation::{AngleUnit, LengthUnit, OrientationForm};
use crate::watch::Cancelled;

use super::gather::{Gathered, OwnFrames, RawPose};
use super::program::{Frames, Unknown, head, show};
use super::read::Progress;
use super::scan::Scanner;
use super::{Preview, Source, program};

const COORDINATES: [&str; 6] = ["X", "Y", "Z", "A", "B", "C"];

/// Whether a text is such a program.
pub(super) fn is_program(text: &str) -> bool {
    let has_position = || {
        text.match_indices('{').any(|(at, _)| {
            let mut scanner = Scanner::new(text, ";");
            scanner.jump(at + 1);
            let word = scanner.word();
            matches!(word, "X" | "x" | "A1" | "a1") && scanner.number().is_some()
        })
    };
    ["E6POS", "E6AXIS", "&ACCESS", "DEFDAT"].iter().any(|word| text.contains(word)) || has_position()
}

pub(super) fn notation(fallback: &PoseNotation) -> PoseNotation {
    let units = (AngleUnit::Degrees, LengthUnit::Millimetres);
    program::notation("kuka-abc", OrientationForm::Angles, units, &Frames::default(), fallback)
}

/// What stands between two braces.
#[derive(Default)]
struct Group {
    coordinates: [Option<f64>; 6],
    has_joints: bool,
    tool: Option<f64>,
    base: Option<f64>,
    /// Byte of a value that is none.
    bad: Option<usize>,
}

/// Calls for every pair of braces: name before it, byte of the brace, what is inside.
fn for_each_group<'t>(
    scanner: &mut Scanner<'t>,
    mut take: impl FnMut(&mut Scanner<'t>, &'t str, usize, Group) -> Result<(), Cancelled>,
) -> Result<(), Cancelled> {
    let mut name = "";
    let mut is_assigned = false;
    loop {
        scanner.skip_blanks();
        let start = scanner.at();
        match scanner.peek() {
            None => return Ok(()),
            Some(c) if c.is_alphanumeric() || matches!(c, '_' | '$') => {
                name = scanner.word();
                is_assigned = false;
            }
            Some('[') => {
                // An index belongs to the name.
                let rest = scanner.rest();
                let end = rest.find([']', '\n', '\r']).unwrap_or(rest.len());
                scanner.jump(start + end);
            }
            Some('=') => {
                scanner.bump();
                is_assigned = true;
            }
            Some('{') => {
                scanner.bump();
                let group = group(scanner);
                take(scanner, if is_assigned { name } else { "" }, start, group)?;
                (name, is_assigned) = ("", false);
            }
            Some(_) => {
                scanner.bump();
            }
        }
    }
}

fn group(scanner: &mut Scanner<'_>) -> Group {
    let mut group = Group::default();
    loop {
        scanner.skip_blanks();
        match scanner.peek() {
            None | Some('}' | '{' | '=') => return group,
            Some(c) if c.is_ascii_alphabetic() => {
                let key = scanner.word();
                // `{FRAME: X 1, …}` names its type.
                if scanner.eat(':') {
                    continue;
                }
                scanner.skip_blanks();
                let at = scanner.at();
                let value = scanner.number();
                // KRL does not tell small letters from capitals.
                match key.to_ascii_uppercase().as_str() {
                    "TOOL_NO" => group.tool = value,
                    "BASE_NO" => group.base = value,
                    "A1" => group.has_joints = true,
                    _ => {
                        if let Some(idx) = COORDINATES.iter().position(|name| key.eq_ignore_ascii_case(name)) {
                            group.coordinates[idx] = value;
                            if value.is_none() {
                                group.bad.get_or_insert(at);
                            }
                        }
                    }
                }
            }
            Some(_) => {
                scanner.bump();
            }
        }
    }
}

/// Reads the positions of a program or data list.
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
    let mut frames_of: HashMap<&str, (Option<f64>, Option<f64>)> = HashMap::new();
    for_each_group(&mut Scanner::new(text, ";"), |_, name, _, group| {
        if group.tool.is_some() || group.base.is_some() {
            frames_of.insert(name.get(1..).unwrap_or_default(), (group.tool, group.base));
        }
        Ok(())
    })?;
    let mut unknown = Unknown::default();
    for_each_group(&mut Scanner::new(text, ";"), |scanner, name, start, group| {
        progress.tick()?;
        if group.has_joints {
            unknown.joint_pose();
            return Ok(());
        }
        // Tools and bases are frames too, but no poses of the robot.
        let is_frame = ["TOOL", "BASE", "$TOOL", "$BASE", "$NULLFRAME", "$WORLD", "$ROBROOT", "LOAD"];
        let is_none = group.coordinates.iter().all(Option::is_none);
        if is_none || is_frame.iter().any(|prefix| name.to_uppercase().starts_with(prefix)) {
            return Ok(());
        }
        if let Some(byte) = group.bad {
            let place = scanner.place(byte);
            gathered.problem(&source.name, place, text[byte..].lines().next().unwrap_or_default(), "a number");
            return Ok(());
        }
        let at = scanner.place(start);
        if let Some(missing) = group.coordinates.iter().position(Option::is_none) {
            let found = format!("a position without {}", COORDINATES[missing]);
            gathered.problem(&source.name, at, &found, "X, Y, Z, A, B and C");
            return Ok(());
        }
        let numbers = group.coordinates.map(Option::unwrap_or_default);
        // The point P1 of a program is the variable XP1, its frames are in FP1.
        let point = name.strip_prefix(['X', 'x']).filter(|point| !point.is_empty()).unwrap_or(name);
        let (tool, base) = frames_of.get(point).copied().unwrap_or_default();
        if let Some(tool) = tool.filter(|number| *number != 0.0) {
            unknown.tool(&format!("TOOL_DATA[{tool}]"));
        }
        if let Some(base) = base.filter(|number| *number != 0.0) {
            unknown.frame(&format!("BASE_DATA[{base}]"));
        }
        show(preview, at.0, point, &numbers);
        let label = (!point.is_empty()).then_some(point);
        gathered.take(
            &source.name,
            &RawPose {
                at,
                label: label.map(Cow::Borrowed),
                numbers: &numbers,
                frames: OwnFrames {
                    is_in_base: base == Some(0.0),
                    is_of_flange: tool == Some(0.0),
                    ..OwnFrames::default()
                },
                ..RawPose::default()
            },
        );
        Ok(())
    })?;
    unknown.note(gathered);
    Ok(())
}
