//! A recording as a sequence folder: the images of the TUM format, with the cameras, the truth and the flange poses.

use std::fmt::Write as _;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use image::ImageError;
use serde_json::{Value, json};
use thiserror::Error;

use crate::geometry::{Frame, Transform};
use crate::odometry::{Intrinsics, RgbdCamera};
use crate::watch::{Cancelled, Watch};

use super::RoomRecording;

/// Why a folder was not written.
#[derive(Debug, Error)]
pub enum FolderError {
    /// Somebody's files are there.
    #[error("{}: found files in it, needed a new or empty folder; remove it, or choose another name", folder.display())]
    NotEmpty {
        /// The folder.
        folder: PathBuf,
    },
    /// The system did not let us.
    #[error("{}: it could not be written: {source}", path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// An image could not be written.
    #[error("{}: the image could not be written: {source}", path.display())]
    Image {
        /// The file.
        path: PathBuf,
        /// Why.
        source: ImageError,
    },
    /// Nobody wants it any more.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Writes a recording, one frame after the other.
///
/// # Errors
/// [`FolderError`]: a folder with files in it is not touched.
pub fn write_folder(recording: RoomRecording, folder: &Path, watch: &mut dyn Watch) -> Result<(), FolderError> {
    let not_written = |path: &Path| {
        let path = path.to_path_buf();
        move |source| FolderError::Io { path, source }
    };
    for name in ["rgb", "depth"] {
        let inner = folder.join(name);
        if name == "rgb" && fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_some()) {
            return Err(FolderError::NotEmpty { folder: folder.to_path_buf() });
        }
        fs::create_dir_all(&inner).map_err(not_written(&inner))?;
    }
    let write = |name: &str, text: &str| {
        let path = folder.join(name);
        fs::write(&path, text).map_err(not_written(&path))
    };
    write("camera.json", &format!("{:#}\n", camera_json(&recording.options().camera)))?;
    let total = recording.len();
    let mut lists = Lists::default();
    for (idx, frame) in recording.enumerate() {
        watch.report(idx, total)?;
        let [color, depth] = ["rgb", "depth"].map(|kind| format!("{kind}/{idx:04}.png"));
        let path = folder.join(&color);
        frame.images.color.save(&path).map_err(|source| FolderError::Image { path, source })?;
        let path = folder.join(&depth);
        frame.images.depth.save(&path).map_err(|source| FolderError::Image { path, source })?;
        lists.add(frame.images.time_s, &color, &depth);
        line(&mut lists.truth, &pose_line(frame.images.time_s, &frame.world_from_sensor));
        if let Some((time_s, base_from_flange)) = &frame.flange {
            line(&mut lists.flange, &pose_line(*time_s, base_from_flange));
        }
    }
    write("rgb.txt", &format!("# time file\n{}", lists.color))?;
    write("depth.txt", &format!("# time file\n{}", lists.depth))?;
    write("associations.txt", &lists.both)?;
    write("groundtruth.txt", &format!("# world_from_sensor: time tx ty tz qx qy qz qw\n{}", lists.truth))?;
    if !lists.flange.is_empty() {
        write("flange.txt", &format!("# base_from_flange: time tx ty tz qx qy qz qw\n{}", lists.flange))?;
    }
    watch.report(total, total)?;
    Ok(())
}

#[derive(Default)]
struct Lists {
    color: String,
    depth: String,
    both: String,
    truth: String,
    flange: String,
}

impl Lists {
    fn add(&mut self, time_s: f64, color: &str, depth: &str) {
        line(&mut self.color, &format!("{time_s:.6} {color}"));
        line(&mut self.depth, &format!("{time_s:.6} {depth}"));
        line(&mut self.both, &format!("{time_s:.6} {color} {time_s:.6} {depth}"));
    }
}

fn line(text: &mut String, line: &str) {
    // Writing to a string does not fail.
    let _ = writeln!(text, "{line}");
}

/// Time, translation in metres, quaternion with its scalar last.
fn pose_line<Dst: Frame, Src: Frame>(time_s: f64, pose: &Transform<Dst, Src>) -> String {
    let [x, y, z] = <[f64; 3]>::from(pose.translation_mm()).map(|value| value / 1000.0 + 0.0);
    let [qw, qx, qy, qz] = pose.quaternion_wxyz();
    format!("{time_s:.6} {x:.6} {y:.6} {z:.6} {qx:.9} {qy:.9} {qz:.9} {qw:.9}")
}

fn camera_json(camera: &RgbdCamera) -> Value {
    let intrinsics = |camera: &Intrinsics| {
        let Intrinsics { width, height, fx, fy, cx, cy } = camera;
        json!({ "width": width, "height": height, "fx": fx, "fy": fy, "cx": cx, "cy": cy })
    };
    let translation_mm: [f64; 3] = camera.color_from_depth.translation_mm().into();
    json!({
        "color": intrinsics(&camera.color),
        "depth": intrinsics(&camera.depth),
        "color_from_depth": {
            "translation_mm": translation_mm,
            "quaternion_wxyz": camera.color_from_depth.quaternion_wxyz(),
        },
        "depth_scale": camera.depth_units_per_m,
    })
}
