//! The lists of a sequence: pictures with their times, and poses with theirs.

use std::path::{Component, Path, PathBuf};

use nalgebra::{Quaternion, Translation3, UnitQuaternion};

use crate::geometry::notation::QUATERNION_NORM_TOLERANCE;
use crate::geometry::{Rigid, Vec3};
use crate::session::error::{on_one_line, system_words};

use super::{ASSOCIATIONS, COLOR_LIST, DEPTH_LIST, FrameEntry, MOST_TIME_OFF_S, SequenceError, SequenceNote};

/// A list of a million lines has a hundred megabytes; beyond this it is something else.
const MAX_BYTES: u64 = 256 << 20;
/// What is said of single lines, for each list; of more only the first are told.
const MOST_NOTES: usize = 20;
/// Times are seconds since whenever.
const LATEST_S: f64 = 1e12;
/// Positions farther away are a mistake of units, m.
const FARTHEST_M: f64 = 1e4;

/// The frames by `associations.txt`, or by the lists of both kinds of pictures.
pub(super) fn frames(folder: &Path, notes: &mut Vec<SequenceNote>) -> Result<Vec<FrameEntry>, SequenceError> {
    let associations = folder.join(ASSOCIATIONS);
    if associations.exists() {
        let needed = "a time, a colour picture, a time and a depth picture";
        let lines = lines_of(&associations, "it lists the frames", notes, needed, associated)?;
        let frames: Vec<FrameEntry> = lines.into_iter().map(|(_, frame)| frame).collect();
        return some(&associations, frames, notes);
    }
    let (color_list, depth_list) = (folder.join(COLOR_LIST), folder.join(DEPTH_LIST));
    let needed = "a time and a picture's name within the folder";
    let color = lines_of(&color_list, "it lists the colour pictures", notes, needed, picture)?;
    let depth = lines_of(&depth_list, "it lists the depth pictures", notes, needed, picture)?;
    let total = color.len();
    let frames = paired(color, &depth);
    if frames.len() < total {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few milliseconds")]
        let limit_ms = (1000.0 * MOST_TIME_OFF_S) as u32;
        let count = total - frames.len();
        notes.push(SequenceNote::NoDepth { file: color_list.clone(), count, total, limit_ms });
    }
    some(&color_list, frames, notes)
}

fn some(file: &Path, frames: Vec<FrameEntry>, notes: &mut Vec<SequenceNote>) -> Result<Vec<FrameEntry>, SequenceError> {
    if frames.is_empty() {
        let found = "none".to_owned();
        return Err(SequenceError::NoFrames { file: file.to_owned(), found, notes: std::mem::take(notes) });
    }
    Ok(frames)
}

/// Poses with their times, mm: time tx ty tz qx qy qz qw, metres.
pub(super) fn poses(path: &Path, notes: &mut Vec<SequenceNote>) -> Result<Vec<(f64, Rigid)>, SequenceError> {
    let needed = "time tx ty tz qx qy qz qw (s, m, a unit quaternion)";
    lines_of(path, "it lists poses", notes, needed, |words| {
        let numbers: Vec<f64> = words.iter().map(|word| word.parse().ok()).collect::<Option<_>>()?;
        let [_, tx, ty, tz, qx, qy, qz, qw] = *numbers.as_slice() else { return None };
        let quaternion = Quaternion::new(qw, qx, qy, qz);
        let is_right = [tx, ty, tz].iter().all(|value| value.abs() <= FARTHEST_M)
            && (quaternion.norm() - 1.0).abs() <= QUATERNION_NORM_TOLERANCE;
        let translation_mm = Vec3::new(tx, ty, tz) * 1000.0;
        is_right
            .then(|| Rigid::from_parts(Translation3::from(translation_mm), UnitQuaternion::new_normalize(quaternion)))
    })
}

/// Of one moment each: colour and depth that are nearest to each other in time, the nearest first.
fn paired(color: Vec<(f64, PathBuf)>, depth: &[(f64, PathBuf)]) -> Vec<FrameEntry> {
    let mut candidates = Vec::new();
    for (color_idx, (time_s, _)) in color.iter().enumerate() {
        let first = depth.partition_point(|(depth_s, _)| *depth_s < time_s - MOST_TIME_OFF_S);
        let near = depth[first..].iter().take_while(|(depth_s, _)| *depth_s <= time_s + MOST_TIME_OFF_S);
        candidates
            .extend(near.enumerate().map(|(idx, (depth_s, _))| ((depth_s - time_s).abs(), color_idx, first + idx)));
    }
    candidates.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut depth_of = vec![None; color.len()];
    let mut is_taken = vec![false; depth.len()];
    for (_, color_idx, depth_idx) in candidates {
        if depth_of[color_idx].is_none() && !is_taken[depth_idx] {
            depth_of[color_idx] = Some(depth_idx);
            is_taken[depth_idx] = true;
        }
    }
    let frame = |((time_s, color), depth_idx): ((f64, PathBuf), Option<usize>)| {
        Some(FrameEntry { time_s, color, depth: depth[depth_idx?].1.clone() })
    };
    color.into_iter().zip(depth_of).filter_map(frame).collect()
}

fn picture(words: &[&str]) -> Option<PathBuf> {
    let [_, name] = words else { return None };
    within(name)
}

fn associated(words: &[&str]) -> Option<FrameEntry> {
    let [first_s, first, second_s, second] = words else { return None };
    let time = |word: &str| word.parse::<f64>().ok().filter(|time| time.abs() <= LATEST_S);
    let (first, second) = ((time(first_s)?, within(first)?), (time(second_s)?, within(second)?));
    // Some sets have depth first.
    let is_depth = first.1.to_string_lossy().starts_with("depth");
    let (color, depth) = if is_depth { (second, first) } else { (first, second) };
    Some(FrameEntry { time_s: color.0, color: color.1, depth: depth.1 })
}

/// A name within the folder: a list from elsewhere cannot have other files read.
fn within(name: &str) -> Option<PathBuf> {
    let path = PathBuf::from(name.replace('\\', "/"));
    path.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir)).then_some(path)
}

/// The entries of a list in order of time. Lines that cannot be read are noted and left out.
fn lines_of<T>(
    path: &Path,
    purpose: &'static str,
    notes: &mut Vec<SequenceNote>,
    needed: &str,
    read: impl Fn(&[&str]) -> Option<T>,
) -> Result<Vec<(f64, T)>, SequenceError> {
    let unreadable = |problem: String| SequenceError::Unreadable { file: path.to_owned(), problem, needed: purpose };
    let metadata = std::fs::metadata(path).map_err(|error| unreadable(system_words(&error)))?;
    if metadata.len() > MAX_BYTES {
        return Err(unreadable(format!("it has {} bytes, a list at most {MAX_BYTES}", metadata.len())));
    }
    let bytes = std::fs::read(path).map_err(|error| unreadable(system_words(&error)))?;
    let text = String::from_utf8_lossy(&bytes);
    let mut entries: Vec<(f64, T)> = Vec::new();
    let (mut latest_s, mut unsorted_line, mut num_wrong) = (f64::NEG_INFINITY, None, 0);
    for (idx, line) in text.lines().enumerate() {
        let line = line.trim_start_matches('\u{feff}').trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let words: Vec<&str> = line.split(|c: char| c.is_whitespace() || c == ',').filter(|w| !w.is_empty()).collect();
        let time = words.first().and_then(|word| word.parse::<f64>().ok()).filter(|time| time.abs() <= LATEST_S);
        let Some((_, value)) = time.zip(read(&words)) else {
            num_wrong += 1;
            if num_wrong <= MOST_NOTES {
                notes.push(SequenceNote::Line {
                    file: path.to_owned(),
                    line: idx + 1,
                    found: shown(line),
                    needed: needed.to_owned(),
                });
            }
            continue;
        };
        let time_s = time.unwrap_or_default();
        if time_s < latest_s {
            unsorted_line.get_or_insert(idx + 1);
        }
        latest_s = latest_s.max(time_s);
        entries.push((time_s, value));
    }
    if let Some(line) = unsorted_line {
        notes.push(SequenceNote::Unsorted { file: path.to_owned(), line });
    }
    entries.sort_by(|a, b| a.0.total_cmp(&b.0));
    let before = entries.len();
    entries.dedup_by(|later, first| later.0.total_cmp(&first.0).is_eq());
    if entries.len() < before {
        notes.push(SequenceNote::SameTime { file: path.to_owned(), count: before - entries.len() });
    }
    Ok(entries)
}

fn shown(line: &str) -> String {
    const MOST: usize = 60;
    let short: String = on_one_line(line).chars().take(MOST).collect();
    if line.chars().count() > MOST { format!("\"{short}…\"") } else { format!("\"{short}\"") }
}
