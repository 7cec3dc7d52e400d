//! ROS 2 bags: poses and profiles that were recorded as messages, in MCAP files and in the `SQLite` files of rosbag2.
//!
//! A bag is never in memory as a whole: its topics are listed when it is opened, and its messages are streamed when it is
//! read, first those with poses, then those with profiles. Poses and profiles are brought together by their times.

mod cdr;
mod frames;
mod line;
mod mcap;
mod messages;
mod read;
mod settle;
mod sqlite;
mod storage;
mod sweeps;

use std::path::{Path, PathBuf};

use thiserror::Error;

pub use frames::ListedFrame;
pub use line::{ProfileAxes, SignedAxis};
pub use messages::MessageKind;
pub(super) use read::read;

/// A bag whose topics are known.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Bag {
    /// Its files, in the order of the recording.
    files: Vec<(PathBuf, storage::Storage)>,
    /// Its topics, by name.
    pub topics: Vec<Topic>,
}

/// A topic of a bag.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Topic {
    /// As nodes know it.
    pub name: String,
    /// The message type.
    pub type_name: String,
    /// What its messages are; `None` if we cannot read them.
    pub kind: Option<MessageKind>,
    /// How many there are.
    pub num_messages: u64,
    /// When the first and the last of them were recorded, as far as the files tell without being read as a whole.
    pub recorded_ns: Option<[i64; 2]>,
}

/// What is wrong with a bag.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{file}: found {found}, needed {needed}; {remedy}")]
pub struct BagError {
    /// The file or folder.
    pub file: String,
    /// What is there.
    pub found: String,
    /// What should be.
    pub needed: String,
    /// What to do.
    pub remedy: String,
}

/// Which time of a message counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Clock {
    /// That of its header, and where this is 0 that of the recording.
    #[default]
    Header,
    /// That of the recording.
    Recording,
}

/// What becomes a capture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Taking {
    /// Every stay of the robot, with the median of the profiles in it: a station each.
    SettledMedian,
    /// Every stay of the robot, with the first profile in it: a station each.
    SettledFirst,
    /// Every profile; those of one orientation that follow each other are one station.
    EveryProfile,
}

/// How a bag is read.
#[derive(Clone, Debug, PartialEq)]
pub struct BagOptions {
    /// The topic of the poses.
    pub pose_topic: Option<String>,
    /// The topic of the profiles.
    pub profile_topic: Option<String>,
    /// The frame that poses are in, where they come as transforms.
    pub base_frame: Option<String>,
    /// The frame that poses are of, likewise.
    pub flange_frame: Option<String>,
    /// The axes of profiles.
    pub axes: Option<ProfileAxes>,
    /// Which time counts.
    pub clock: Clock,
    /// A pose and a profile belong together if no more lies between them.
    pub pair_within_ms: f64,
    /// What becomes a capture.
    pub taking: Option<Taking>,
    /// The robot stands still if it does so for as long, ...
    pub still_for_s: f64,
    /// ... does not move further, ...
    pub still_within_mm: f64,
    /// ... and does not turn further.
    pub still_within_deg: f64,
    /// Whether stays along a line, with one orientation, are a sweep.
    pub joins_stays: bool,
}

impl Default for BagOptions {
    fn default() -> Self {
        Self {
            pose_topic: None,
            profile_topic: None,
            base_frame: None,
            flange_frame: None,
            axes: None,
            clock: Clock::default(),
            pair_within_ms: 50.0,
            taking: None,
            still_for_s: 0.5,
            still_within_mm: 0.05,
            still_within_deg: 0.02,
            joins_stays: true,
        }
    }
}

/// Messages of a topic that could not be read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unreadable {
    /// The topic.
    pub topic: String,
    /// How many.
    pub num_messages: usize,
    /// What was found in the first of them, and what was needed.
    pub first: String,
}

/// What became of the messages of a bag.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct BagReport {
    /// Where the poses came from.
    pub pose_topic: String,
    /// The frames between which, where they came as transforms: base, flange.
    pub frames: Option<[String; 2]>,
    /// All frames of the bag, where poses came as transforms.
    pub listed_frames: Vec<ListedFrame>,
    /// The frame that poses are in by their headers, where they came as poses.
    pub pose_frame: Option<String>,
    /// Poses that were read.
    pub num_poses: usize,
    /// Poses at the time of another, left out.
    pub num_of_same_time: usize,
    /// Transforms that hang a frame below another parent than before, or fix one that moves, left out.
    pub num_contradicting: usize,
    /// Times of poses at which a frame of the chain was not sent for too long, left out.
    pub num_in_gaps: usize,
    /// Where the profiles came from.
    pub profile_topic: Option<String>,
    /// Profiles that were read.
    pub num_profiles: usize,
    /// Stays of the robot, where they were looked for.
    pub num_stays: Option<usize>,
    /// Stays without a profile, left out.
    pub num_stays_without_profile: usize,
    /// Sweeps that stays were joined into, ...
    pub num_sweeps: usize,
    /// ... and the stays of them.
    pub num_joined_stays: usize,
    /// Profiles that were paired with a pose.
    pub num_paired: usize,
    /// Profiles taken while the robot moved, left out.
    pub num_moving: usize,
    /// Profiles without a pose in reach, left out.
    pub num_without_pose: usize,
    /// How far away the nearest pose of these is, ms.
    pub nearest_pose_ms: Option<i64>,
    /// Poses and profiles beyond what is kept in memory, left out.
    pub num_beyond: usize,
    /// Messages that could not be read.
    pub unreadable: Vec<Unreadable>,
    /// Files that end too early or are damaged, and how: what stands before was read.
    pub cut_short: Vec<(String, String)>,
}

fn unreadable(path: &Path, found: &str) -> BagError {
    BagError {
        file: path.display().to_string(),
        found: found.to_owned(),
        needed: "a bag as rosbag2 writes it".to_owned(),
        remedy: "check the disk and the copy, or write it anew with `ros2 bag convert`".to_owned(),
    }
}

/// What is wrong where of a recording there is nothing but its `metadata.yaml`; `None` if that is another file.
pub(super) fn only_metadata(path: &Path) -> Option<BagError> {
    /// A recording in many parts names each of them.
    const MAX_BYTES: u64 = 1 << 20;
    const MAX_NAMED: usize = 3;
    let is_small = path.metadata().is_ok_and(|metadata| metadata.len() <= MAX_BYTES);
    let text =
        std::fs::read_to_string(path).ok().filter(|text| is_small && text.contains("rosbag2_bagfile_information"))?;
    let listed = text.lines().skip_while(|line| !line.contains("relative_file_paths")).skip(1);
    let names: Vec<&str> = listed.map_while(|line| line.trim().strip_prefix("- ")).take(MAX_NAMED).collect();
    let needed = if names.is_empty() { "its .mcap or .db3 files".to_owned() } else { names.join(", ") };
    Some(BagError {
        file: path.display().to_string(),
        found: "the description of a recording, and none of its files".to_owned(),
        needed: format!("{needed} beside it"),
        remedy: "copy the whole folder of the recording".to_owned(),
    })
}

/// Whether a file is part of a bag, by its first bytes.
///
/// # Errors
/// [`BagError`] for one that is named so and is none.
pub(super) fn is_bag(path: &Path) -> Result<bool, BagError> {
    storage::recognise(path).map(|storage| storage.is_some())
}

impl Bag {
    /// Lists the topics of a bag, whose files are in the order of the recording.
    ///
    /// # Errors
    /// [`BagError`] for a file that cannot be read at all.
    pub fn open(paths: &[PathBuf]) -> Result<Self, BagError> {
        let mut bag = Self { files: Vec::new(), topics: Vec::new() };
        for path in paths {
            let Some(storage) = storage::recognise(path)? else {
                return Err(unreadable(path, "neither an MCAP nor an SQLite file"));
            };
            // Why a file ends early is said when it is read.
            let (topics, _) = storage::topics(path, storage)?;
            for storage::FileTopic { name, type_name, encoding, num_messages, recorded_ns } in topics {
                let kind = MessageKind::of_type(&type_name).filter(|_| encoding == "cdr");
                let topic = Topic { name, type_name, kind, num_messages, recorded_ns };
                match bag.topics.iter_mut().find(|known| known.name == topic.name) {
                    Some(known) if known.type_name == topic.type_name => {
                        known.num_messages += num_messages;
                        known.recorded_ns = match (known.recorded_ns, recorded_ns) {
                            (Some([a, b]), Some([c, d])) => Some([a.min(c), b.max(d)]),
                            (one, other) => one.or(other),
                        };
                    }
                    // Of two types under one name the one that we can read.
                    Some(known) if known.kind.is_none() && topic.kind.is_some() => *known = topic,
                    Some(_) => {}
                    None => bag.topics.push(topic),
                }
            }
            bag.files.push((path.clone(), storage));
        }
        bag.topics.sort_by(|a, b| a.name.cmp(&b.name));
        Ok(bag)
    }

    /// When the recording began, as far as that is known.
    #[must_use]
    pub fn start_ns(&self) -> Option<i64> {
        self.topics.iter().filter_map(|topic| topic.recorded_ns).map(|[first, _]| first).min()
    }

    /// The topics that poses, or profiles, can come from.
    pub fn topics_with(&self, poses: bool) -> impl Iterator<Item = &Topic> {
        self.topics.iter().filter(move |topic| topic.kind.is_some_and(|kind| kind.has_poses() == poses))
    }
}
