//! Universal Robots: poses `p[x, y, z, rx, ry, rz]` wherever they stand, in scripts, lists and logs.

use std::borrow::Cow;

use crate::geometry::PoseNotation;
use crate::geometry::notation::{AngleUnit, LengthUnit, OrientationForm};
use crate::geometry::{Tcp, Transform};
use crate::watch::Cancelled;

use super::gather::{Gathered, RawPose};
use super::program::{Frames, head, show};
use super::read::Progress;
use super::scan::Scanner;
use super::{Preview, Source, program};

/// The robots reach not much more than a metre; larger numbers are millimetres.
const LARGEST_METRES: f64 = 10.0;

/// The bytes at which `p[` stands, not in a comment and not as the end of a longer word.
fn places(text: &str) -> impl Iterator<Item = usize> + '_ {
    let mut from = 0;
    let mut is_comment = false;
    text.match_indices("p[").map(|(at, _)| at).filter(move |at| {
        let between = &text[from..*at];
        from = *at;
        is_comment = match between.rfind(['\n', '\r']) {
            Some(end) => has_comment(&between[end..]),
            None => is_comment || has_comment(between),
        };
        let is_word = between.chars().next_back().is_some_and(|c| c.is_alphanumeric() || c == '_');
        !is_word && !is_comment
    })
}

/// Whether a comment begins; a number sign before a digit is part of a name, as in `Waypoint #1`.
fn has_comment(text: &str) -> bool {
    text.match_indices('#').any(|(at, _)| {
        let is_in_a_name = !text[..at].trim().is_empty() && text[at + 1..].starts_with(|c: char| c.is_ascii_digit());
        !is_in_a_name
    })
}

/// Whether a text has such poses.
pub(super) fn is_script(text: &str) -> bool {
    places(text).any(|at| numbers(&mut scanner_at(text, at)).is_some())
}

fn scanner_at(text: &str, at: usize) -> Scanner<'_> {
    let mut scanner = Scanner::new(text, "");
    scanner.jump(at + 1);
    scanner
}

fn numbers(scanner: &mut Scanner<'_>) -> Option<[f64; 6]> {
    scanner.bracketed::<6>()
}

fn is_tool(text: &str, at: usize) -> bool {
    text[..at].trim_end().ends_with("set_tcp(")
}

/// The tool that a script sets, and the unit of its positions.
pub(super) fn notation(text: &str, fallback: &PoseNotation) -> PoseNotation {
    let mut length_unit = LengthUnit::Metres;
    let mut tools: Vec<[f64; 6]> = Vec::new();
    for at in places(text) {
        if let Some(numbers) = numbers(&mut scanner_at(text, at)) {
            if numbers[..3].iter().any(|value| value.abs() > LARGEST_METRES) {
                length_unit = LengthUnit::Millimetres;
            }
            if is_tool(text, at) && !tools.contains(&numbers) && tools.len() < 2 {
                tools.push(numbers);
            }
        }
    }
    let plain = program::notation(
        "ur-rotvec",
        OrientationForm::Angles,
        (AngleUnit::Radians, length_unit),
        &Frames::default(),
        &PoseNotation { flange_from_tcp: None, ..*fallback },
    );
    let tool = match tools.as_slice() {
        [numbers] if numbers.iter().any(|number| *number != 0.0) => plain.base_from_flange(numbers).ok(),
        _ => None,
    };
    let flange_from_tcp = tool.map(|frame| Transform::<_, Tcp>::from_rigid(*frame.rigid()));
    PoseNotation { flange_from_tcp: flange_from_tcp.or(fallback.flange_from_tcp), ..plain }
}

/// Reads the poses of a script or list.
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
    let mut scanner = Scanner::new(text, "");
    for at in places(text).filter(|at| !is_tool(text, *at)) {
        progress.tick()?;
        scanner.jump(at + 1);
        let place = scanner.place(at);
        let Some(numbers) = numbers(&mut scanner) else {
            let byte = scanner.at();
            let column_of = scanner.place(byte);
            gathered.problem(&source.name, column_of, scanner.found(), "six numbers p[x, y, z, rx, ry, rz]");
            continue;
        };
        let label = label(&text[..at]);
        show(preview, place.0, label.unwrap_or_default(), &numbers);
        gathered.take(
            &source.name,
            &RawPose { at: place, label: label.map(Cow::Borrowed), numbers: &numbers, ..RawPose::default() },
        );
    }
    Ok(())
}

/// The name that a pose is given to: `Waypoint_1_p=p[…]`, `"A": "p[…]"`.
fn label(before: &str) -> Option<&str> {
    let before = before.trim_end_matches([' ', '\t', '"', '\'']);
    let before = before.strip_suffix('=').or_else(|| before.strip_suffix(':'))?;
    let before = before.trim_end_matches([' ', '\t', '"', '\'', ':']);
    let start = before
        .rfind(|c: char| !(c.is_alphanumeric() || matches!(c, '_' | '-' | '.')))
        .map_or(0, |at| at + before[at..].chars().next().map_or(1, char::len_utf8));
    Some(&before[start..]).filter(|name| !name.is_empty())
}
