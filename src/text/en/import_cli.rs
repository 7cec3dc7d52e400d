//! What `handeye import` and `handeye export` print.

use crate::geometry::PoseNotation;
use crate::geometry::notation::OrientationForm;
use crate::session::import::{ImportOptions, Kind, Note, Part, Separator};

use super::import_bag as bag;
use super::plural;
use super::shell::count;

/// What a source was taken for.
#[must_use]
pub const fn kind_name(kind: Kind) -> &'static str {
    match kind {
        Kind::Session => "session",
        Kind::PoseTable => "table of poses",
        Kind::PrintedTable => "printed table",
        Kind::FanucProgram => "FANUC program",
        Kind::AbbModule => "ABB module",
        Kind::KukaProgram => "KUKA program",
        Kind::UrScript => "poses of Universal Robots",
        Kind::Profile => "profile",
        Kind::ProfileColumns => "profiles, one a column",
        Kind::PosePairs => "pairs of poses",
        Kind::Yaml => "YAML",
        Kind::RosBag => "ROS 2 bag",
    }
}

/// One source and what it gave.
#[must_use]
pub fn part_line(part: &Part) -> String {
    let poses = (part.num_poses > 0).then(|| count(part.num_poses, "pose"));
    let readings = (part.num_readings > 0).then(|| count(part.num_readings, "reading"));
    let gave: Vec<String> = poses.into_iter().chain(readings).collect();
    let gave = if gave.is_empty() { String::new() } else { format!(", {}", gave.join(", ")) };
    format!("{}: {}{gave}\n", part.name, kind_name(part.kind))
}

/// Stations of a plate of which nobody has said which edge they saw.
#[must_use]
pub fn edges_missing_line(num_stations: usize) -> String {
    let stations = count(num_stations, "station");
    format!(
        "edge: found {stations} without one, which take no part until it is set; add a column edge with p or q, or set it in Poses\n"
    )
}

/// How the poses were read.
#[must_use]
pub fn options_line(options: &ImportOptions) -> String {
    let mut said = Vec::new();
    if let Some(separator) = options.separator {
        said.push(match separator {
            Separator::Comma => "separated by commas".to_owned(),
            Separator::Semicolon => "separated by semicolons".to_owned(),
            Separator::Tab => "separated by tabulators".to_owned(),
            Separator::Blanks => "separated by blanks".to_owned(),
        });
    }
    if options.decimal_comma == Some(true) {
        said.push("decimal comma".to_owned());
    }
    said.extend(options.notation.as_ref().map(notation_words));
    if options.base_from_user_frame.is_some() {
        said.push("in a user frame".to_owned());
    }
    said.extend(options.bag.axes.map(|axes| bag::axes(axes, options.profile_length_unit.unwrap_or_default())));
    if said.is_empty() { String::new() } else { format!("read as: {}\n", said.join(", ")) }
}

fn notation_words(notation: &PoseNotation) -> String {
    let orientation = match notation.orientation {
        OrientationForm::Angles => format!("{} in {}", notation.convention.label, notation.angle_unit.symbol()),
        OrientationForm::QuaternionWxyz => "quaternion w x y z".to_owned(),
        OrientationForm::QuaternionXyzw => "quaternion x y z w".to_owned(),
    };
    let of = if notation.flange_from_tcp.is_some() { ", poses of a tool point" } else { "" };
    let inverse = if notation.is_inverse { ", inverse" } else { "" };
    format!("positions in {}, {orientation}{of}{inverse}", notation.length_unit.symbol())
}

fn names_line(names: &[String]) -> String {
    /// More are counted.
    const MAX_NAMES: usize = 5;
    let listed = names.iter().take(MAX_NAMES).map(String::as_str).collect::<Vec<_>>().join(", ");
    if names.len() > MAX_NAMES { format!("{listed} and {} more", names.len() - MAX_NAMES) } else { listed }
}

/// Something to know about what was read.
#[must_use]
pub fn note_line(note: &Note) -> String {
    let text = match note {
        Note::UserFrameTakenAsBase { frame, num_poses } => format!(
            "{} in {frame}, taken as the base; if it is another frame give it with --base-from-user-frame",
            count(*num_poses, "pose")
        ),
        Note::ToolTakenAsFlange { tool, num_poses } => format!(
            "{} of {tool}, taken as the flange; if it is another frame give it with --flange-from-tcp",
            count(*num_poses, "pose")
        ),
        Note::PosesWithoutReading { num_poses } => {
            format!("{} without a profile or point", count(*num_poses, "pose"))
        }
        Note::ProfilesWithoutPose { names } => {
            format!("{} without a pose, left out: {}", count(names.len(), "profile"), names_line(names))
        }
        Note::QuaternionsNormalised { num_poses } => {
            format!("{} with a rounded quaternion, normalised", count(*num_poses, "pose"))
        }
        Note::OtherTablesLeftOut { caption, num_tables } => {
            let first = if caption.is_empty() { "the first table".to_owned() } else { format!("\"{caption}\"") };
            format!("read {first}; {} further table{} left out", num_tables, plural(*num_tables))
        }
        Note::SourcesLeftOut { names } => {
            format!("{} without poses or profiles, left out: {}", count(names.len(), "file"), names_line(names))
        }
        Note::OtherGroups { num_poses } => {
            format!("{} for several groups of axes, the first was read", count(*num_poses, "position"))
        }
        Note::JointPoses { num_poses } => {
            format!("{} given as joint angles only, left out", count(*num_poses, "pose"))
        }
        Note::Bag(report) => bag::report(report),
    };
    format!("note: {text}\n")
}

/// What was left out.
#[must_use]
pub fn left_out_line(problem: &dyn std::fmt::Display) -> String {
    format!("left out: {problem}\n")
}

/// Problems that are not listed.
#[must_use]
pub fn more_left_out_line(num_more: usize) -> String {
    format!("left out: {num_more} more\n")
}

/// Why nothing is written.
#[must_use]
pub fn problem_refusal(problem: &dyn std::fmt::Display, num_more: usize) -> String {
    let more = if num_more > 0 { format!(" ({num_more} more like this)") } else { String::new() };
    format!("{problem}{more}; with --skip-problems the rest is imported")
}

/// What was written.
#[must_use]
pub fn imported_line(file: &str, num_stations: usize, num_captures: usize) -> String {
    format!("{file}: {}, {}\n", count(num_stations, "station"), count(num_captures, "capture"))
}

/// What was written.
#[must_use]
pub fn exported_line(file: &str, number: usize, noun: &str) -> String {
    format!("{file}: {}\n", count(number, noun))
}

/// A ball of unknown size.
pub const RADIUS_MISSING: &str =
    "--radius-mm: found none, expected the ball's radius in mm, or --target plate or point";

/// Another target than a ball has no radius.
pub const RADIUS_OF_NO_BALL: &str =
    "--radius-mm: found a radius beside another target than a ball, expected --target ball or no radius";

/// Poses of a plate that are to become another target's.
pub const EDGES_OF_NO_PLATE: &str = "edge: found a column edge with p and q, which only a plate has: did you mean --target plate? \
     For another target pass the column over with - in --columns";

/// The comma cannot be both.
pub const COMMA_TWICE: &str =
    "--decimal-comma: found commas between the cells too, expected --separator semicolon or tab";

/// A file that is in the way.
#[must_use]
pub fn out_exists(file: &str) -> String {
    format!("--out: found the file {file}, expected a new one; --force overwrites it")
}

/// There are no topics to list.
#[must_use]
pub fn no_bag(file: &str) -> String {
    format!("{file}: found no ROS 2 bag, expected an .mcap or .db3 file, or the folder of one")
}

/// Nothing came of it.
#[must_use]
pub fn no_stations(file: &str) -> String {
    format!("{file}: found profiles but no poses, expected a table or program with poses as well")
}

/// A table is not written in place of a session.
#[must_use]
pub fn over_a_session(file: &str) -> String {
    format!("{file}: found a session file, expected another name for the table of poses")
}
