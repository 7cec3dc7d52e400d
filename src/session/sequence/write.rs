//! Writing a sequence: a folder that this program and those of others read.

use std::fmt::Write as _;
use std::fs::{self, File};
use std::io::{BufWriter, Write as _};
use std::path::{Path, PathBuf};

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder as _};

use crate::geometry::{Frame, Sensor, Transform, World};
use crate::odometry::{RgbdCamera, RgbdFrame};
use crate::session::error::{on_one_line, system_words};

use super::{
    ASSOCIATIONS, CAMERA_FILE, COLOR_LIST, DEPTH_LIST, FLANGE, GROUND_TRUTH, SequenceError, TimedFlange, camera_file,
};

/// Writes a sequence frame by frame; the lists are complete with [`SequenceWriter::finish`].
#[derive(Debug)]
pub struct SequenceWriter {
    folder: PathBuf,
    color: String,
    depth: String,
    associations: String,
    ground_truth: String,
    flange: String,
}

impl SequenceWriter {
    /// Begins a sequence in a folder, which is made.
    ///
    /// # Errors
    /// [`SequenceError::NotEmpty`] for a folder with files in it, which stays as it is; [`SequenceError::Unwritable`].
    pub fn create(folder: &Path, camera: &RgbdCamera) -> Result<Self, SequenceError> {
        if fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_some()) {
            return Err(SequenceError::NotEmpty { folder: folder.to_owned() });
        }
        for part in ["rgb", "depth"] {
            let path = folder.join(part);
            fs::create_dir_all(&path).map_err(|error| unwritable(&path, &system_words(&error)))?;
        }
        let text = format!("{:#}\n", camera_file::written(camera));
        write_file(&folder.join(CAMERA_FILE), text.as_bytes())?;
        let head = |what: &str| format!("# {what}\n");
        Ok(Self {
            folder: folder.to_owned(),
            color: head("time, s; colour picture"),
            depth: head("time, s; depth picture"),
            associations: head("time, s; colour picture; time, s; depth picture"),
            ground_truth: String::new(),
            flange: String::new(),
        })
    }

    /// Adds a frame, with the pose of the camera and of the flange where they are known; that has a time of its own.
    ///
    /// # Errors
    /// [`SequenceError::Unwritable`].
    pub fn push(
        &mut self,
        frame: &RgbdFrame,
        world_from_sensor: Option<&Transform<World, Sensor>>,
        flange: Option<&TimedFlange>,
    ) -> Result<(), SequenceError> {
        let time = format!("{:.6}", frame.time_s);
        let (color, depth) = (format!("rgb/{time}.png"), format!("depth/{time}.png"));
        let (width, height) = frame.color.dimensions();
        write_png(&self.folder.join(&color), frame.color.as_raw(), [width, height], ExtendedColorType::Rgb8)?;
        let (width, height) = frame.depth.dimensions();
        // The encoder takes sixteen bits in the machine's order.
        let bytes: Vec<u8> = frame.depth.iter().flat_map(|value| value.to_ne_bytes()).collect();
        write_png(&self.folder.join(&depth), &bytes, [width, height], ExtendedColorType::L16)?;
        // Writing to a string does not fail.
        writeln!(self.color, "{time} {color}").ok();
        writeln!(self.depth, "{time} {depth}").ok();
        writeln!(self.associations, "{time} {color} {time} {depth}").ok();
        if let Some(pose) = world_from_sensor {
            self.ground_truth.push_str(&pose_line(frame.time_s, pose));
        }
        if let Some(TimedFlange { time_s, base_from_flange }) = flange {
            self.flange.push_str(&pose_line(*time_s, base_from_flange));
        }
        Ok(())
    }

    /// Writes the lists.
    ///
    /// # Errors
    /// [`SequenceError::Unwritable`].
    pub fn finish(self) -> Result<(), SequenceError> {
        let lists = [
            (COLOR_LIST, self.color),
            (DEPTH_LIST, self.depth),
            (ASSOCIATIONS, self.associations),
            (GROUND_TRUTH, self.ground_truth),
            (FLANGE, self.flange),
        ];
        lists
            .iter()
            .filter(|(_, text)| !text.is_empty())
            .try_for_each(|(name, text)| write_file(&self.folder.join(name), text.as_bytes()))
    }
}

/// Poses as the benchmark has them: time tx ty tz qx qy qz qw, metres.
#[must_use]
pub fn trajectory_text<Dst: Frame, Src: Frame>(poses: impl Iterator<Item = (f64, Transform<Dst, Src>)>) -> String {
    poses.map(|(time_s, pose)| pose_line(time_s, &pose)).collect()
}

fn pose_line<Dst: Frame, Src: Frame>(time_s: f64, pose: &Transform<Dst, Src>) -> String {
    let t = pose.translation_mm() / 1000.0;
    let [w, x, y, z] = pose.quaternion_wxyz();
    format!("{time_s:.6} {:.9} {:.9} {:.9} {x:.12} {y:.12} {z:.12} {w:.12}\n", t.x, t.y, t.z)
}

fn write_png(
    path: &Path,
    bytes: &[u8],
    [width, height]: [u32; 2],
    kind: ExtendedColorType,
) -> Result<(), SequenceError> {
    let file = File::create(path).map_err(|error| unwritable(path, &system_words(&error)))?;
    let mut writer = BufWriter::new(file);
    // A depth camera's few distances repeat, and take a quarter less without the differences that suit colours.
    let filter = if kind == ExtendedColorType::L16 { FilterType::NoFilter } else { FilterType::Adaptive };
    PngEncoder::new_with_quality(&mut writer, CompressionType::Default, filter)
        .write_image(bytes, width, height, kind)
        .map_err(|error| unwritable(path, &on_one_line(&error.to_string())))?;
    writer.flush().map_err(|error| unwritable(path, &system_words(&error)))
}

fn write_file(path: &Path, bytes: &[u8]) -> Result<(), SequenceError> {
    fs::write(path, bytes).map_err(|error| unwritable(path, &system_words(&error)))
}

fn unwritable(path: &Path, problem: &str) -> SequenceError {
    SequenceError::Unwritable { file: path.to_owned(), problem: problem.to_owned() }
}
