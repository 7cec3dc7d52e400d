//! Directions, stations and sizes in words.

use crate::calibrate::Mount;
use crate::diagnose::Axis;
use crate::geometry::Vec3;
use crate::session::{Reading, Session, Target};
use crate::text::digits::{decimals_for, fixed};

/// A direction of the frame that the sensor is mounted on, as an adverb: "along the flange's z".
#[must_use]
pub fn along(direction: Vec3, mount: Mount) -> String {
    along_axis_of(direction, carrier_frame(mount))
}

pub(super) fn along_axis_of(direction: Vec3, frame: &str) -> String {
    let words = direction_words(direction, frame);
    if words.starts_with('(') { format!("along {words} of the {frame}") } else { format!("along {words}") }
}

/// The same as a noun: "the flange's z".
pub(super) fn axis_in_words(axis: Vec3, mount: Mount) -> String {
    let frame = carrier_frame(mount);
    let words = direction_words(axis, frame);
    if words.starts_with('(') { format!("{words} in the {frame}") } else { words }
}

/// The nearest axis where there is one within 15°, otherwise the components. A direction without its sense.
pub(super) fn direction_words(direction: Vec3, frame: &str) -> String {
    /// The cosine of 15°.
    const NEAR: f64 = 0.966;
    let unit = direction.try_normalize(0.0).unwrap_or(direction);
    let largest = unit.iamax();
    if unit[largest].abs() >= NEAR {
        return format!("the {frame}'s {}", ["x", "y", "z"][largest]);
    }
    let unit = if unit[largest] < 0.0 { -unit } else { unit };
    format!("({}, {}, {})", fixed(unit.x, 2), fixed(unit.y, 2), fixed(unit.z, 2))
}

pub(super) const fn carrier_frame(mount: Mount) -> &'static str {
    match mount {
        Mount::OnFlange => "flange",
        Mount::Fixed => "base",
    }
}

pub(super) const fn target_frame(mount: Mount) -> &'static str {
    match mount {
        Mount::OnFlange => "base",
        Mount::Fixed => "flange",
    }
}

pub(super) const fn axis_name(axis: Axis) -> &'static str {
    match axis {
        Axis::X => "x",
        Axis::Z => "z",
    }
}

/// An error or a σ: two digits of it, and no more than a tenth of a micrometre.
pub(super) fn size(value: f64) -> String {
    fixed(value, decimals_for(Some(value.abs())).min(4))
}

pub(super) fn with_std(value: f64, std: f64) -> String {
    let decimals = decimals_for(Some(std)).min(5);
    format!("{} ± {}", fixed(value, decimals), fixed(std, decimals))
}

/// How often something happens by chance.
pub(super) fn chance(p_value: f64) -> String {
    /// No test is right about rarer things.
    const RARE: f64 = 1e-3;
    if p_value < RARE { "less than once in 1000".to_owned() } else { format!("about once in {:.0}", 1.0 / p_value) }
}

pub(super) fn station_label(session: &Session, station_idx: usize) -> &str {
    session.stations.get(station_idx).map_or("?", |station| station.label.as_str())
}

/// "station 4", "stations 2, 4 and 7", and of a long list the first ones.
pub(super) fn stations(session: &Session, station_idxs: &[usize]) -> String {
    /// More than this no one reads.
    const MOST: usize = 6;
    let labels: Vec<&str> = station_idxs.iter().map(|station_idx| station_label(session, *station_idx)).collect();
    match labels.as_slice() {
        [] => "no station".to_owned(),
        [only] => format!("station {only}"),
        [before @ .., last] if labels.len() <= MOST => format!("stations {} and {last}", before.join(", ")),
        _ => format!("stations {} and {} more", labels[..MOST - 1].join(", "), labels.len() - MOST + 1),
    }
}

pub(super) fn exchanged_poses(session: &Session, poses_from: &[(usize, usize)]) -> String {
    /// More than this no one reads.
    const MOST: usize = 4;
    let mut parts: Vec<String> = poses_from
        .iter()
        .take(MOST)
        .map(|(to, from)| {
            format!(
                "station {} fits the pose of station {}",
                station_label(session, *to),
                station_label(session, *from)
            )
        })
        .collect();
    if let Some(more @ 1..) = poses_from.len().checked_sub(MOST) {
        parts.push(format!("and {more} more"));
    }
    parts.join(", ")
}

pub(super) fn capitalised(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// The target, as a word.
pub(in super::super) const fn target_word(target: &Target) -> &'static str {
    match target {
        Target::Ball { .. } => "ball",
        Target::RightAnglePlate => "plate",
        Target::Point => "tip",
        Target::Pose { .. } | Target::Workpiece | Target::Rgbd { .. } => "target",
    }
}

/// What a station sees of it.
pub(super) const fn seen_word(target: &Target) -> &'static str {
    match target {
        Target::RightAnglePlate => "point on the edge",
        other => target_word(other),
    }
}

/// What was read at a station.
pub(super) fn reading_word(session: &Session, station_idx: usize) -> &'static str {
    let capture = session.stations.get(station_idx).and_then(|station| station.captures.first());
    match capture.map(|capture| &capture.reading) {
        Some(Reading::Point(_)) => "point",
        Some(Reading::Pose(_)) => "target's pose",
        _ => "profile",
    }
}
