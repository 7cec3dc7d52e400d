//! ABB modules, `.mod`: robtargets, with the tools and work objects of the same module.

use std::borrow::Cow;
use std::collections::HashMap;

use crate::geometry::notation::{AngleUnit, LengthUnit, OrientationForm};
use crate::geometry::{Base, Flange, PoseNotation, Tcp, Transform, Vec3};
use crate::watch::Cancelled;

use super::gather::{Gathered, OwnFrames, RawPose};
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
    /// Every tool that a move names, `tool0` among them.
    used_tools: Vec<&'t str>,
    /// Every work object that a move names or leaves out, which is `wobj0`.
    used_work_objects: Vec<&'t str>,
    /// Tool and work object of the first move to a target, by its name in small letters.
    uses: HashMap<String, (&'t str, &'t str)>,
}

/// The flange and the base, as moves name them.
const OWN_TOOL: &str = "tool0";
const OWN_WORK_OBJECT: &str = "wobj0";

impl<'t> Module<'t> {
    fn tool(&self, name: &str) -> Option<Transform<Flange, Tcp>> {
        let (_, (position, quaternion)) = self.tools.iter().find(|(known, _)| is_word(known, name))?;
        tool_frame(*position, *quaternion)
    }

    fn work_object(&self, name: &str) -> Option<Transform<Base, Base>> {
        let (_, user, object) = self.work_objects.iter().find(|(known, ..)| is_word(known, name))?;
        base_from_object(user, object)
    }

    /// The one tool of all moves that are not the flange's own; without moves the only one that there is.
    fn common_tool(&self) -> Option<&'t str> {
        match (self.used_tools.is_empty(), self.tools.as_slice()) {
            (true, [(name, _)]) => Some(name),
            _ => only(&self.used_tools, OWN_TOOL),
        }
    }

    fn common_work_object(&self) -> Option<&'t str> {
        match (self.used_work_objects.is_empty(), self.work_objects.as_slice()) {
            (true, [(name, ..)]) => Some(name),
            _ => only(&self.used_work_objects, OWN_WORK_OBJECT),
        }
    }

    /// Tool and work object of a target; `None` where moves differ and none goes to this one.
    fn use_of(&self, label: Option<&str>) -> (Option<&'t str>, Option<&'t str>) {
        if let Some((tool, object)) = label.and_then(|label| self.uses.get(&label.to_ascii_lowercase())) {
            return (Some(tool), Some(object));
        }
        let of_all = |used: &[&'t str], common: Option<&'t str>, own: &'static str| match used {
            [] => Some(common.unwrap_or(own)),
            [one] => Some(*one),
            _ => None,
        };
        (
            of_all(&self.used_tools, self.common_tool(), OWN_TOOL),
            of_all(&self.used_work_objects, self.common_work_object(), OWN_WORK_OBJECT),
        )
    }

    /// What a target's own frames are, beside the common ones; those that are not known are noted.
    fn own_frames(&self, tool: Option<&str>, object: Option<&str>, unknown: &mut Unknown) -> OwnFrames {
        const NO_MOVE: &str = "that no move names";
        let mut frames = OwnFrames::default();
        let is_same = |name: &str, common: Option<&str>| common.is_some_and(|common| is_word(common, name));
        match tool {
            Some(name) if is_word(name, OWN_TOOL) => frames.is_of_flange = true,
            Some(name) => {
                let is_defined = self.tools.iter().any(|(known, _)| is_word(known, name));
                if !is_defined {
                    unknown.tool(name);
                } else if !is_same(name, self.common_tool()) {
                    frames.flange_from_tcp = self.tool(name);
                    frames.is_of_flange = frames.flange_from_tcp.is_none();
                }
            }
            None => {
                frames.is_of_flange = true;
                unknown.tool_in_any_case(NO_MOVE);
            }
        }
        match object {
            Some(name) if is_word(name, OWN_WORK_OBJECT) => frames.is_in_base = true,
            Some(name) => {
                let is_defined = self.work_objects.iter().any(|(known, ..)| is_word(known, name));
                if !is_defined {
                    unknown.frame(name);
                } else if !is_same(name, self.common_work_object()) {
                    frames.base_from_user = self.work_object(name);
                    frames.is_in_base = frames.base_from_user.is_none();
                }
            }
            None => {
                frames.is_in_base = true;
                unknown.frame_in_any_case(NO_MOVE);
            }
        }
        frames
    }
}

/// The only name beside that of the robot's own frame.
fn only<'t>(used: &[&'t str], own: &str) -> Option<&'t str> {
    let mut others = used.iter().filter(|name| !is_word(name, own));
    let first = others.next()?;
    others.next().is_none().then_some(*first)
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

/// The tool and work object that a module defines, where all its moves that use any use one and the same.
pub(super) fn frames(text: &str) -> Frames {
    let module = survey(text);
    Frames {
        flange_from_tcp: module.common_tool().and_then(|name| module.tool(name)),
        base_from_user: module.common_work_object().and_then(|name| module.work_object(name)),
    }
}

/// The object's frame in the base; `None` if it is the base.
fn base_from_object(user: &Pose, object: &Pose) -> Option<Transform<Base, Base>> {
    let quaternion = PoseNotation { orientation: OrientationForm::QuaternionWxyz, ..PoseNotation::default() };
    let pose = |(position, rotation): &Pose| {
        quaternion.base_from_flange(&[position.as_slice(), rotation.as_slice()].concat()).ok()
    };
    let frame: Transform<Base, Base> = Transform::from_rigid(pose(user)?.rigid() * pose(object)?.rigid());
    let is_base = frame.translation_mm() == Vec3::zeros() && frame.rotation().angle() == 0.0;
    (!is_base).then_some(frame)
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
            let arguments = Arguments::of(&mut scanner);
            let Some((tool, object)) = arguments.frames() else { continue };
            add_once(&mut module.used_tools, tool);
            add_once(&mut module.used_work_objects, object);
            for (_, target) in arguments.targets(word) {
                if target.starts_with(|c: char| c.is_ascii_alphabetic()) {
                    let name: String = target.chars().filter(|c| !c.is_whitespace()).collect();
                    module.uses.entry(name.to_ascii_lowercase()).or_insert((tool, object));
                }
            }
        }
    }
    module
}

/// The arguments of a move: the first few, which may be targets, and the last, which has the tool.
#[derive(Default)]
struct Arguments<'t> {
    /// Byte and text.
    first: Vec<(usize, &'t str)>,
    last: &'t str,
}

impl<'t> Arguments<'t> {
    /// A move ends at its semicolon, over however many lines it runs; the scanner stands behind it then.
    fn of(scanner: &mut Scanner<'t>) -> Self {
        /// Two targets and what stands behind them.
        const MAX_FIRST: usize = 3;
        let (text, offset) = (scanner.rest(), scanner.at());
        let mut arguments = Self::default();
        let (mut start, mut depth, mut end, mut is_comment) = (0, 0_usize, text.len(), false);
        let mut take = |from: usize, to: usize| {
            let argument = text[from..to].trim();
            let at = offset + from + (text[from..to].len() - text[from..to].trim_start().len());
            // A switch such as \Conc stands in front with a comma of its own.
            if !argument.starts_with('\\') && arguments.first.len() < MAX_FIRST {
                arguments.first.push((at, argument));
            }
            arguments.last = argument;
        };
        for (at, c) in text.char_indices() {
            match c {
                '\n' | '\r' => is_comment = false,
                _ if is_comment => {}
                '!' => is_comment = true,
                '[' | '(' => depth += 1,
                ']' | ')' => depth = depth.saturating_sub(1),
                ';' => {
                    end = at;
                    break;
                }
                ',' if depth == 0 => {
                    take(start, at);
                    start = at + 1;
                }
                _ => {}
            }
        }
        take(start, end);
        scanner.jump(offset + end);
        arguments
    }

    /// The targets of a move: one, two of a circle.
    fn targets(&self, word: &str) -> &[(usize, &'t str)] {
        let num_targets =
            if word.as_bytes().get(4).is_some_and(|byte| byte.eq_ignore_ascii_case(&b'c')) { 2 } else { 1 };
        &self.first[..num_targets.min(self.first.len())]
    }

    /// Tool and work object.
    fn frames(&self) -> Option<(&'t str, &'t str)> {
        let mut scanner = Scanner::new(self.last, "!");
        let tool = scanner.word();
        if !tool.starts_with(|c: char| c.is_ascii_alphabetic()) {
            return None;
        }
        while scanner.eat('\\') {
            let switch = scanner.word();
            let value = if assigned(&mut scanner) { scanner.word() } else { "" };
            if is_word(switch, "wobj") && !value.is_empty() {
                return Some((tool, value));
            }
        }
        Some((tool, OWN_WORK_OBJECT))
    }
}

fn add_once<'t>(names: &mut Vec<&'t str>, name: &'t str) {
    if !names.iter().any(|known| is_word(known, name)) {
        names.push(name);
    }
}

/// `MoveL`, `MoveJ` and `MoveC`, and those that set a signal or call a routine on the way.
fn is_move(word: &str) -> bool {
    const KINDS: [&str; 3] = ["movel", "movej", "movec"];
    const SUFFIXES: [&str; 5] = ["", "do", "ao", "go", "sync"];
    let lower = word.to_ascii_lowercase();
    KINDS.iter().any(|kind| lower.strip_prefix(kind).is_some_and(|suffix| SUFFIXES.contains(&suffix)))
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
    let module = survey(text);
    let mut taking = Taking { module: &module, unknown: Unknown::default(), gathered, preview };
    let mut scanner = Scanner::new(text, "!");
    while let Some(word) = scanner.next_word() {
        if is_word(word, "jointtarget") {
            taking.unknown.joint_pose();
            continue;
        }
        let is_declared = is_word(word, "robtarget");
        if !is_declared && !is_move(word) {
            continue;
        }
        progress.tick()?;
        if is_declared {
            declaration(source, &mut scanner, &mut taking);
            continue;
        }
        let arguments = Arguments::of(&mut scanner);
        let end = scanner.at();
        let (tool, object) = arguments.frames().unwrap_or((OWN_TOOL, OWN_WORK_OBJECT));
        for (byte, _) in arguments.targets(word).iter().filter(|(_, target)| target.starts_with('[')) {
            let frames = module.own_frames(Some(tool), Some(object), &mut taking.unknown);
            scanner.jump(*byte);
            target(source, &mut scanner, None, Some(frames), &mut taking);
        }
        scanner.jump(end);
    }
    let Taking { unknown, gathered, .. } = taking;
    unknown.note(gathered);
    Ok(())
}

/// Where targets go.
struct Taking<'a, 't> {
    module: &'a Module<'t>,
    unknown: Unknown,
    gathered: &'a mut Gathered,
    preview: &'a mut Preview,
}

/// `robtarget p10:=[…];` or `robtarget a{2}:=[[…],[…]];`
fn declaration(source: &Source, scanner: &mut Scanner<'_>, taking: &mut Taking<'_, '_>) {
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
        target(source, scanner, Some(name), None, taking);
    } else if scanner.eat('[') {
        for number in 1_usize.. {
            let label = format!("{name}{{{number}}}");
            if !target(source, scanner, Some(&label), None, taking) || !scanner.eat(',') {
                break;
            }
        }
    }
}

/// Takes the value of a robtarget, in the frames of its move if it stands in one; whether there is one.
fn target(
    source: &Source,
    scanner: &mut Scanner<'_>,
    label: Option<&str>,
    frames: Option<OwnFrames>,
    taking: &mut Taking<'_, '_>,
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
        taking.gathered.problem(&source.name, place, scanner.found(), "a robtarget [[x,y,z],[q1,q2,q3,q4],[…],[…]]");
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
    show(taking.preview, at.0, label.unwrap_or_default(), &numbers);
    let frames = frames.unwrap_or_else(|| {
        let (tool, object) = taking.module.use_of(label);
        taking.module.own_frames(tool, object, &mut taking.unknown)
    });
    let label = label.map(Cow::Borrowed);
    taking.gathered.take(&source.name, &RawPose { at, label, numbers: &numbers, frames, ..RawPose::default() });
    true
}
