//! Writing points: streamed into a temporary file that takes the place of the old one in one step.

use std::fs;
use std::io::{self, BufWriter, Write};
use std::path::Path;

use crate::scan::Cloud;
use crate::watch::{Cancelled, Watch};
use crate::whole_file;

use super::{CloudFileError, REPORT_EVERY};

/// What a file of points is written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CloudFormat {
    /// Binary PLY, little endian: what most programs read quickest.
    Ply,
    /// PLY in text.
    PlyText,
    /// A line a point.
    Csv,
}

impl CloudFormat {
    /// By the ending of a file's name.
    ///
    /// # Errors
    /// [`CloudFileError::UnknownEnding`].
    pub fn of(path: &Path) -> Result<Self, CloudFileError> {
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default();
        match ending.as_str() {
            "ply" => Ok(Self::Ply),
            "csv" => Ok(Self::Csv),
            _ => Err(CloudFileError::UnknownEnding { file: path.to_owned(), ending }),
        }
    }
}

/// Writes all points in the base, mm, with the profile that each is of. An older file of this name is replaced once the new
/// one is whole on the disk; cancelled or failed, it is as it was.
///
/// # Errors
/// [`CloudFileError::Unwritable`] or [`CloudFileError::Cancelled`].
pub fn write_cloud(
    cloud: &Cloud,
    path: &Path,
    format: CloudFormat,
    watch: &mut dyn Watch,
) -> Result<(), CloudFileError> {
    let unwritable = |problem: io::Error| CloudFileError::Unwritable { file: path.to_owned(), problem };
    if fs::metadata(path).is_ok_and(|metadata| metadata.permissions().readonly() || !metadata.is_file()) {
        return Err(unwritable(io::Error::new(io::ErrorKind::PermissionDenied, "it is read-only, or no file")));
    }
    let written = whole_file::replace(path, |file| {
        let mut out = BufWriter::with_capacity(1 << 18, file);
        write_points(cloud, &mut out, format, watch)?;
        Ok(out.flush()?)
    });
    written.map(drop).map_err(|failure| match failure {
        Failure::System(problem) => unwritable(problem),
        Failure::Cancelled(cancelled) => CloudFileError::Cancelled(cancelled),
    })
}

enum Failure {
    System(io::Error),
    Cancelled(Cancelled),
}

impl From<io::Error> for Failure {
    fn from(problem: io::Error) -> Self {
        Self::System(problem)
    }
}

fn write_points(
    cloud: &Cloud,
    out: &mut impl Write,
    format: CloudFormat,
    watch: &mut dyn Watch,
) -> Result<(), Failure> {
    let num_points = cloud.len();
    match format {
        CloudFormat::Ply => write_ply_header(out, "binary_little_endian", num_points)?,
        CloudFormat::PlyText => write_ply_header(out, "ascii", num_points)?,
        CloudFormat::Csv => writeln!(out, "x_mm,y_mm,z_mm,profile")?,
    }
    for (idx, profile) in cloud.profile_idx().iter().enumerate() {
        if idx % REPORT_EVERY == 0 {
            watch.report(idx, num_points).map_err(Failure::Cancelled)?;
        }
        let point = cloud.point_mm(idx);
        match format {
            CloudFormat::Ply => {
                for value in point.iter() {
                    out.write_all(&value.to_le_bytes())?;
                }
                out.write_all(&profile.to_le_bytes())?;
            }
            CloudFormat::PlyText => writeln!(out, "{:.5} {:.5} {:.5} {profile}", point.x, point.y, point.z)?,
            CloudFormat::Csv => writeln!(out, "{:.5},{:.5},{:.5},{profile}", point.x, point.y, point.z)?,
        }
    }
    Ok(())
}

fn write_ply_header(out: &mut impl Write, format: &str, num_points: usize) -> io::Result<()> {
    write!(
        out,
        "ply\nformat {format} 1.0\ncomment points in the robot's base, mm\nelement vertex {num_points}\n\
         property double x\nproperty double y\nproperty double z\nproperty uint profile\nend_header\n"
    )
}
