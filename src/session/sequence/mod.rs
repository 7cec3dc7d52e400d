//! Recorded sequences of an RGB-D camera: folders as the TUM RGB-D benchmark has them, with a file about the camera.
//!
//! Opening reads the lists; pictures are decoded one frame at a time. What is wrong with single lines or pictures is said of
//! them, and the other frames are used.

mod camera_file;
mod error;
mod lists;
mod pictures;
mod run;
mod tracked;
mod write;

use std::path::{Path, PathBuf};

use crate::geometry::{Base, Flange, Transform};
use crate::odometry::{RgbdCamera, RgbdFrame, TimedPose};

pub use error::{FrameError, SequenceError, SequenceNote};
pub use run::{FrameRecord, FrameSummary, Looked, SequenceRun, trajectory};
pub use tracked::{FrameCounts, TrackedSequence};
pub use write::{SequenceWriter, trajectory_text};

/// The camera's file.
pub const CAMERA_FILE: &str = "camera.json";
const COLOR_LIST: &str = "rgb.txt";
const DEPTH_LIST: &str = "depth.txt";
const ASSOCIATIONS: &str = "associations.txt";
const GROUND_TRUTH: &str = "groundtruth.txt";
const FLANGE: &str = "flange.txt";

/// Colour and depth farther apart in time are not of one frame, s.
const MOST_TIME_OFF_S: f64 = 0.02;

/// A frame before its pictures are decoded.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameEntry {
    /// Time of the colour picture, s.
    pub time_s: f64,
    /// The colour picture, relative to the folder.
    pub color: PathBuf,
    /// The depth picture, relative to the folder.
    pub depth: PathBuf,
}

/// A pose of the flange and its time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimedFlange {
    /// Time, s.
    pub time_s: f64,
    /// Where the flange was.
    pub base_from_flange: Transform<Base, Flange>,
}

/// A sequence: its camera, its frames, and what else is known.
#[derive(Clone, Debug, PartialEq)]
pub struct Sequence {
    /// The folder.
    pub folder: PathBuf,
    /// The camera.
    pub camera: RgbdCamera,
    /// The frames, in order of time.
    pub frames: Vec<FrameEntry>,
    /// The true poses, in order of time.
    pub ground_truth: Option<Vec<TimedPose>>,
    /// The robot's poses, in order of time.
    pub flange: Option<Vec<TimedFlange>>,
    /// What is odd about the lists.
    pub notes: Vec<SequenceNote>,
}

impl Sequence {
    /// Reads what a folder says of its sequence.
    ///
    /// # Errors
    /// [`SequenceError`] where no frame could be read from it: file, found, needed.
    pub fn open(folder: &Path) -> Result<Self, SequenceError> {
        if !folder.is_dir() {
            return Err(SequenceError::NotAFolder { folder: folder.to_owned() });
        }
        let camera = camera_file::read(&folder.join(CAMERA_FILE))?;
        let mut notes = Vec::new();
        let frames = lists::frames(folder, &mut notes)?;
        let optional = |name: &str| Some(folder.join(name)).filter(|path| path.exists());
        let ground_truth = optional(GROUND_TRUTH).map(|path| lists::poses(&path, &mut notes)).transpose()?;
        let flange = optional(FLANGE).map(|path| lists::poses(&path, &mut notes)).transpose()?;
        Ok(Self {
            folder: folder.to_owned(),
            camera,
            frames,
            ground_truth: ground_truth.map(|poses| {
                let pose = |(time_s, pose)| TimedPose { time_s, world_from_sensor: Transform::from_rigid(pose) };
                poses.into_iter().map(pose).collect()
            }),
            flange: flange.map(|poses| {
                let pose = |(time_s, pose)| TimedFlange { time_s, base_from_flange: Transform::from_rigid(pose) };
                poses.into_iter().map(pose).collect()
            }),
            notes,
        })
    }

    /// Decodes the pictures of a frame. Sizes are checked before anything is set aside for them.
    ///
    /// # Errors
    /// [`FrameError`]: which file, found, needed.
    pub fn frame(&self, entry: &FrameEntry) -> Result<RgbdFrame, FrameError> {
        let (color, depth) = (&self.camera.color, &self.camera.depth);
        Ok(RgbdFrame {
            time_s: entry.time_s,
            color: pictures::color(&self.folder, &entry.color, [color.width, color.height])?,
            depth: pictures::depth(&self.folder, &entry.depth, [depth.width, depth.height])?,
        })
    }
}
