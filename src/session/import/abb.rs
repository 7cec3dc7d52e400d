//! ABB modules, `.mod`: robtargets, with the tools and work objects of the same module.

use std::borrow::Cow;

use crate::geometry::notation::{AngleUnit, LengthUnit, OrientationForm};
use crate::geometry::{PoseConvention, PoseNotation, Transform};
use crate::watch::Cancelled;

use super::gather::{Gathered, RawPose};
use super::program::{Frames, Unknown, head, show, tool_frame};
use super::read::Progress;
use super::scan::Scanner;
use super::{Preview, Source, program};

/// A pose of RAPID: a position and a quaternion, the real part first.
type Pose = ([f64; 3], [f64; 4]);

/// The tools and work objects of a module, and those that its moves use.
#[derive(Debug, Default)]
struct Module<'t> {
    tools: Vec<(&'t str, Pose)>,
    /// With the frame of the user and that of the object.
    work_objects: Vec<(&'t str, Pose, Pose)>,
    used_tools: Vec<&'t str>,
    used_work_objects: Vec<&'t str>,
}

/// Whether a text is such a module.
pub(super) fn is_program(text: &str) -> bool {
    contains_word(text, "robtarget") || contains_word(text, "jointtarget")
}

fn contains_word(text: &str, word: &str) -> bool {
    text.as_bytes().windows(word.len()).any(|window| window.eq_ignore_ascii_case(word.as_bytes()))
}

fn is_word(word: &str, wanted: &str) -> bool {
    word.eq_ignore_ascii_case(wanted)
}

/// The tool and work object that a module defines, where all its moves use one and the same.
pub(super) fn frames(text: &str) -> Frames {
    let module = survey(text);
    let tool = match module.used_tools.as_slice() {
        [] if module.tools.len() == 1 => module.tools.first(),
        [name] => module.tools.iter().find(|(known, _)| is_word(known, name)),
        _ => None,
    };
    let work_object = match module.used_work_objects.as_slice() {
        [] if module.work_objects.len() == 1 && module.used_tools.is_empty() => module.work_objects.first(),
        [name] => module.work_objects.iter().find(|(known, ..)| is_word(known, name)),
        _ => None,
    };
    Frames {
        flange_from_tcp: tool.and_then(|(_, (position, quaternion))| tool_frame(*position, *quaternion)),
        base_from_user_frame: work_object.and_then(|(_, user, object)| base_from_object(user, object)),
    }
}

/// The object's frame in the base, as three coordinates and ABB's three angles.
fn base_from_object(user: &Pose, object: &Pose) -> Option<[f64; 6]> {
    let quaternion = PoseNotation { orientation: OrientationForm::QuaternionWxyz, ..PoseNotation::default() };
    let pose = |(position, rotation): &Pose| {
        quaternion.base_from_flange(&[position.as_slice(), rotation.as_slice()].concat()).ok()
    };
    let rigid = pose(user)?.rigid() * pose(object)?.rigid();
    let angles = PoseNotation::of(PoseConvention::by_id("abb-ezeyex")?);
    let numbers = angles.numbers(&Transform::from_rigid(rigid));
    let numbers: [f64; 6] = numbers.try_into().ok()?;
    numbers.iter().any(|number| *number != 0.0).then_some(numbers)
}

pub(super) fn notation(frames: &Frames, fallback: &PoseNotation) -> PoseNotation {
    let units = (AngleUnit::Degrees, LengthUnit::Millimetres);
    program::notation("abb-ezeyex", OrientationForm::QuaternionWxyz, units, frames, fallback)
}

/// Finds tools, work objects and moves.
fn survey(text: &str) -> Module<'_> {
    let mut module = Module::default();
    let mut scanner = Scanner::new(text, "!");
    while let Some(word) = scanner.next_word() {
        if is_word(word, "tooldata") {
            let name = scanner.word();
            if let Some(pose) = value_of_tool(&mut scanner) {
                module.tools.push((name, pose));
            }
        } else if is_word(word, "wobjdata") {
            let name = scanner.word();
            if let Some((user, object)) = value_of_work_object(&mut scanner) {
                module.work_objects.push((name, user, object));
            }
        } else if is_move(word) {
            let rest = scanner.rest();
            let end = rest.find([';', '\n']).unwrap_or(rest.len());
            let arguments = &rest[..end];
            // The tool is the last argument, the work object a switch behind it.
            let last = arguments.rsplit(',').next().unwrap_or_default();
            let (tool, switches) = last.split_once('\\').unwrap_or((last, ""));
            let tool = tool.trim();
            add_once(&mut module.used_tools, tool, "tool0");
            let object = switches.split_once(":=").map_or("wobj0", |(_, name)| name.trim());
            add_once(&mut module.used_work_objects, object, "wobj0");
            scanner.jump(scanner.at() + end);
        }
    }
    module
}

fn add_once<'t>(names: &mut Vec<&'t str>, name: &'t str, own: &str) {
    let is_name = name.starts_with(|c: char| c.is_ascii_alphabetic()) && !is_word(name, own);
    if is_name && !names.iter().any(|known| is_word(known, name)) {
        names.push(name);
    }
}

fn is_move(word: &str) -> bool {
    word.len() > 4 && word.as_bytes()[..4].eq_ignore_ascii_case(b"move") && !is_word(word, "moveabsj")
}

fn assigned(scanner: &mut Scanner<'_>) -> bool {
    scanner.eat(':') && scanner.eat('=')
}

fn pose(scanner: &mut Scanner<'_>) -> Option<Pose> {
    let position = scanner.eat('[').then(|| scanner.bracketed::<3>())??;
    let quaternion = scanner.eat(',').then(|| scanner.bracketed::<4>())??;
    scanner.eat(']').then_some((position, quaternion))
}

/// `:=[TRUE,[[…],[…]],…`
fn value_of_tool(scanner: &mut Scanner<'_>) -> Option<Pose> {
    (assigned(scanner) && scanner.eat('[')).then_some(())?;
    scanner.word();
    scanner.eat(',').then(|| pose(scanner))?
}

/// `:=[FALSE,TRUE,"",[[…],[…]],[[…],[…]]]`
fn value_of_work_object(scanner: &mut Scanner<'_>) -> Option<(Pose, Pose)> {
    (assigned(scanner) && scanner.eat('[')).then_some(())?;
    for _ in 0..2 {
        scanner.word();
        scanner.eat(',').then_some(())?;
    }
    scanner.eat('"').then_some(())?;
    let rest = scanner.rest();
    scanner.jump(scanner.at() + rest.find('"')? + 1);
    let user = scanner.eat(',').then(|| pose(scanner))??;
    let object = scanner.eat(',').then(|| pose(scanner))??;
    Some((user, object))
}

/// Reads the robtargets of a module.
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
    let num_before = gathered.num_poses();
    let mut unknown = Unknown::default();
    let mut scanner = Scanner::new(text, "!");
    while let Some(word) = scanner.next_word() {
        if is_word(word, "jointtarget") {
            unknown.joint_pose();
            continue;
        }
        let is_declared = is_word(word, "robtarget");
        if !is_declared && !is_move(word) {
            continue;
        }
        progress.tick()?;
        if is_declared {
            declaration(source, &mut scanner, gathered, preview);
        } else {
            // Switches like \Conc and a comma may stand before the target.
            scanner.skip_blanks();
            if scanner.peek() == Some('[') {
                target(source, &mut scanner, None, gathered, preview);
            }
        }
    }
    let num_poses = gathered.num_poses() - num_before;
    let module = survey(text);
    for _ in 0..num_poses {
        module.used_tools.iter().for_each(|name| unknown.tool(name));
        module.used_work_objects.iter().for_each(|name| unknown.frame(name));
    }
    unknown.note(gathered);
    Ok(())
}

/// `robtarget p10:=[…];` or `robtarget a{2}:=[[…],[…]];`
fn declaration(source: &Source, scanner: &mut Scanner<'_>, gathered: &mut Gathered, preview: &mut Preview) {
    let name = scanner.word();
    let mut is_array = false;
    if scanner.eat('{') {
        is_array = true;
        while scanner.number().is_some() && scanner.eat(',') {}
        if !scanner.eat('}') {
            return;
        }
    }
    // A variable without a value, or a parameter of a procedure.
    if name.is_empty() || !assigned(scanner) {
        return;
    }
    if !is_array {
        target(source, scanner, Some(name), gathered, preview);
    } else if scanner.eat('[') {
        for number in 1_usize.. {
            let label = format!("{name}{{{number}}}");
            if !target(source, scanner, Some(&label), gathered, preview) || !scanner.eat(',') {
                break;
            }
        }
    }
}

/// Takes the value of a robtarget; whether there is one.
fn target(
    source: &Source,
    scanner: &mut Scanner<'_>,
    label: Option<&str>,
    gathered: &mut Gathered,
    preview: &mut Preview,
) -> bool {
    scanner.skip_blanks();
    let start = scanner.at();
    let parsed = scanner.eat('[').then(|| {
        let position = scanner.bracketed::<3>()?;
        let quaternion = scanner.eat(',').then(|| scanner.bracketed::<4>())??;
        Some((position, quaternion))
    });
    let Some((position, quaternion)) = parsed.flatten() else {
        let place = scanner.place(scanner.at());
        gathered.problem(&source.name, place, scanner.found(), "a robtarget [[x,y,z],[q1,q2,q3,q4],[…],[…]]");
        return false;
    };
    // The configuration and the external axes say nothing of the flange.
    let mut depth = 1;
    while depth > 0 {
        match scanner.bump() {
            Some('[') => depth += 1,
            Some(']') => depth -= 1,
            None | Some(';') => break,
            Some(_) => {}
        }
    }
    let at = scanner.place(start);
    let numbers = [position.as_slice(), quaternion.as_slice()].concat();
    show(preview, at.0, label.unwrap_or_default(), &numbers);
    gathered
        .take(&source.name, &RawPose { at, label: label.map(Cow::Borrowed), numbers: &numbers, ..RawPose::default() });
    true
}
