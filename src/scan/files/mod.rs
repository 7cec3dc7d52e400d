//! Files of points: PLY (both kinds of binary, and text), CSV and XYZ; millimetres.
//!
//! Both ways the points stream: a file is never held as a whole, and a header that promises more than the file holds is
//! refused before anything is set aside for it.

mod ply;
mod table;
mod write;

use std::fs::File;
use std::io::{self, BufRead as _, BufReader, Read as _};
use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::geometry::Vec3;
use crate::watch::{Cancelled, Watch};

use super::{Cloud, ScanError};

pub use write::{CloudFormat, write_cloud};

/// Points farther from the first one are a mistake of units or a broken file, mm.
const LIMIT_MM: f64 = 1e5;
/// No line of numbers is as long, bytes.
const LONGEST_LINE: u64 = 1 << 16;
/// Points between two reports of progress.
const REPORT_EVERY: usize = 1 << 16;

/// Why a file of points could not be read or written.
#[derive(Debug, Error)]
pub enum CloudFileError {
    /// The operating system did not let us read it.
    #[error("cannot read {}: {problem}", file.display())]
    Unreadable {
        /// The file.
        file: PathBuf,
        /// The operating system's words.
        problem: io::Error,
    },
    /// The operating system did not let us write it; an older file of this name is as it was.
    #[error("cannot write {}: {problem}; an older file of this name is as it was", file.display())]
    Unwritable {
        /// The file.
        file: PathBuf,
        /// The operating system's words.
        problem: io::Error,
    },
    /// A line that does not belong there.
    #[error("{}, line {line}: found {found}, expected {expected}", file.display())]
    Line {
        /// The file.
        file: PathBuf,
        /// From 1.
        line: u64,
        /// What stands there.
        found: String,
        /// What should.
        expected: String,
    },
    /// A place in binary data that is wrong.
    #[error("{}, byte {byte}: found {found}, expected {expected}", file.display())]
    Byte {
        /// The file.
        file: PathBuf,
        /// From 0.
        byte: u64,
        /// What is there.
        found: String,
        /// What should be.
        expected: String,
    },
    /// Nothing tells what the file is.
    #[error("{}: found the ending {ending:?}, expected .ply or .csv", file.display())]
    UnknownEnding {
        /// The file.
        file: PathBuf,
        /// Its ending.
        ending: String,
    },
    /// Not one point.
    #[error("{}: found no point, expected at least one", file.display())]
    NoPoints {
        /// The file.
        file: PathBuf,
    },
    /// More points than are held.
    #[error("{}: {problem}", file.display())]
    TooLarge {
        /// The file.
        file: PathBuf,
        /// What is said of it.
        problem: ScanError,
    },
    /// Nobody wants it any more.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// A cloud from a file.
#[derive(Clone, Debug)]
pub struct ReadCloud {
    /// The points.
    pub cloud: Cloud,
    /// Points that were left out, as their coordinates are no numbers (NaN), which some programs write for "nothing seen".
    pub num_left_out: usize,
}

/// Reads points, mm: PLY by its first line, anything else as lines of numbers. A column or property named `profile` says
/// which profile a point is of.
///
/// # Errors
/// [`CloudFileError`]: which file, line or byte, what was found and what was expected.
pub fn read_cloud(path: &Path, watch: &mut dyn Watch) -> Result<ReadCloud, CloudFileError> {
    let mut source = Source::open(path)?;
    let is_ply = source.reader.fill_buf().map_err(|problem| source_error(path, problem))?.starts_with(b"ply");
    let mut gathered = Gathered::default();
    if is_ply {
        ply::read(&mut source, &mut gathered, watch)?;
    } else {
        table::read(&mut source, &mut gathered, watch)?;
    }
    match gathered.cloud {
        Some(cloud) => Ok(ReadCloud { cloud, num_left_out: gathered.num_left_out }),
        None => Err(CloudFileError::NoPoints { file: path.to_owned() }),
    }
}

fn source_error(path: &Path, problem: io::Error) -> CloudFileError {
    CloudFileError::Unreadable { file: path.to_owned(), problem }
}

/// A file that knows where it is.
struct Source {
    path: PathBuf,
    reader: BufReader<File>,
    /// Size of the file, bytes.
    size: u64,
    /// Bytes read.
    byte: u64,
    /// Lines read.
    line: u64,
}

impl Source {
    fn open(path: &Path) -> Result<Self, CloudFileError> {
        let unreadable = |problem| source_error(path, problem);
        let metadata = std::fs::metadata(path).map_err(unreadable)?;
        if !metadata.is_file() {
            let words = if metadata.is_dir() { "it is a folder" } else { "it is no ordinary file" };
            return Err(unreadable(io::Error::new(io::ErrorKind::InvalidInput, words)));
        }
        let reader = BufReader::with_capacity(1 << 18, File::open(path).map_err(unreadable)?);
        Ok(Self { path: path.to_owned(), reader, size: metadata.len(), byte: 0, line: 0 })
    }

    /// The next line without its end; `None` at the end of the file.
    fn next_line(&mut self, into: &mut Vec<u8>) -> Result<bool, CloudFileError> {
        into.clear();
        let mut limited = self.reader.by_ref().take(LONGEST_LINE);
        let num = limited.read_until(b'\n', into).map_err(|problem| source_error(&self.path, problem))?;
        if num == 0 {
            return Ok(false);
        }
        self.byte += num as u64;
        self.line += 1;
        if num as u64 == LONGEST_LINE && into.last() != Some(&b'\n') {
            return Err(self.wrong_line(&format!("a line of more than {LONGEST_LINE} bytes"), "lines of numbers"));
        }
        while matches!(into.last(), Some(b'\n' | b'\r')) {
            into.pop();
        }
        Ok(true)
    }

    fn wrong_line(&self, found: &str, expected: &str) -> CloudFileError {
        let (file, found, expected) = (self.path.clone(), found.to_owned(), expected.to_owned());
        CloudFileError::Line { file, line: self.line.max(1), found, expected }
    }

    fn wrong_byte(&self, found: &str, expected: &str) -> CloudFileError {
        let (file, found, expected) = (self.path.clone(), found.to_owned(), expected.to_owned());
        CloudFileError::Byte { file, byte: self.byte, found, expected }
    }

    /// Progress by bytes, in thousandths.
    fn report(&self, watch: &mut dyn Watch) -> Result<(), Cancelled> {
        let done = u128::from(self.byte) * 1000 / u128::from(self.size.max(1));
        watch.report(usize::try_from(done).unwrap_or(1000).min(1000), 1000)
    }
}

/// What was read so far.
#[derive(Default)]
struct Gathered {
    cloud: Option<Cloud>,
    num_left_out: usize,
}

impl Gathered {
    /// Takes a point; a wrong one comes back as what was found.
    fn take(&mut self, point_mm: Vec3, profile_idx: u32) -> Result<(), Refused> {
        if point_mm.iter().any(|value| value.is_nan()) {
            self.num_left_out += 1;
            return Ok(());
        }
        // Round, so that the same cloud written again reads the same.
        let cloud = self.cloud.get_or_insert_with(|| Cloud::about(point_mm.map(f64::round)));
        let offset = (point_mm - cloud.origin_mm()).amax();
        // An infinite first point makes an origin from which nothing has a distance.
        if !(offset <= LIMIT_MM && point_mm.amax() < f64::INFINITY) {
            return Err(Refused::TooFar(format!("{} {} {}", point_mm.x, point_mm.y, point_mm.z)));
        }
        cloud.push(point_mm, profile_idx).map_err(Refused::TooMany)
    }
}

enum Refused {
    TooFar(String),
    TooMany(ScanError),
}

/// What is expected of every point.
const WITHIN_LIMIT: &str = "a point in mm, within 100 m of the first one";

/// What stands in a line, short enough to be said.
fn said(line: &[u8]) -> String {
    const MOST: usize = 40;
    let text = String::from_utf8_lossy(line);
    let mut short: String = text.chars().take(MOST).map(|c| if c.is_control() { '�' } else { c }).collect();
    if text.chars().count() > MOST {
        short.push('…');
    }
    if short.is_empty() { "an empty line".to_owned() } else { format!("\"{short}\"") }
}
