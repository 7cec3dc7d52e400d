//! What is wrong with a sequence: with the folder, with a line of its lists, with a picture.

use std::path::PathBuf;

use thiserror::Error;

/// Why nothing can be read from a folder.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum SequenceError {
    /// There is no folder of this name.
    #[error(
        "{}: found no folder, needed one with rgb.txt and depth.txt (or associations.txt) and camera.json",
        folder.display()
    )]
    NotAFolder {
        /// The path.
        folder: PathBuf,
    },
    /// The operating system did not let us read a file.
    #[error("cannot read {}: {problem}; {needed}", file.display())]
    Unreadable {
        /// The file.
        file: PathBuf,
        /// The operating system's words.
        problem: String,
        /// What it is needed for.
        needed: &'static str,
    },
    /// Somebody's files are where a sequence was to be written.
    #[error("{}: found files in it, needed a new or empty folder; remove it, or choose another name", folder.display())]
    NotEmpty {
        /// The folder.
        folder: PathBuf,
    },
    /// The operating system did not let us write a file.
    #[error("cannot write {}: {problem}", file.display())]
    Unwritable {
        /// The file.
        file: PathBuf,
        /// The system's words.
        problem: String,
    },
    /// The camera's file is not as it should be.
    #[error("{}: {place}: found {found}, needed {needed}", file.display())]
    Camera {
        /// The file.
        file: PathBuf,
        /// The field.
        place: String,
        /// What stands there.
        found: String,
        /// What should.
        needed: String,
    },
    /// No frame at all.
    #[error("{}: found {found}, needed at least one frame{}", file.display(), first_note(notes))]
    NoFrames {
        /// The list.
        file: PathBuf,
        /// What it holds instead.
        found: String,
        /// What is wrong with its lines.
        notes: Vec<SequenceNote>,
    },
}

fn first_note(notes: &[SequenceNote]) -> String {
    notes.first().map_or_else(String::new, |note| format!(" ({note})"))
}

/// What is odd about a list; the rest of it is used.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum SequenceNote {
    /// A line that cannot be read is left out.
    #[error("{}, line {line}: found {found}, needed {needed}; the line is left out", file.display())]
    Line {
        /// The file.
        file: PathBuf,
        /// From 1.
        line: usize,
        /// What stands there.
        found: String,
        /// What should.
        needed: String,
    },
    /// Lines out of order were sorted.
    #[error("{}, line {line}: found a time before that of the line above; the list was sorted by time", file.display())]
    Unsorted {
        /// The file.
        file: PathBuf,
        /// The first such line, from 1.
        line: usize,
    },
    /// Several lines have one time.
    #[error("{}: found {count} more lines of a time that was there already; the first of each is used", file.display())]
    SameTime {
        /// The file.
        file: PathBuf,
        /// How many.
        count: usize,
    },
    /// Colour pictures without depth of the same moment.
    #[error("{count} of {total} pictures of {} have no depth within {limit_ms} ms; they are left out", file.display())]
    NoDepth {
        /// The list of colour pictures.
        file: PathBuf,
        /// How many.
        count: usize,
        /// Of how many.
        total: usize,
        /// How near in time it has to be.
        limit_ms: u32,
    },
}

/// Why a picture of a frame could not be had. The other frames are used.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum FrameError {
    /// The operating system did not let us read it.
    #[error("cannot read {}: {problem}", file.display())]
    Unreadable {
        /// The file.
        file: PathBuf,
        /// The operating system's words.
        problem: String,
    },
    /// It is another picture than it should be.
    #[error("{}: found {found}, needed {needed}", file.display())]
    Wrong {
        /// The file.
        file: PathBuf,
        /// What it is.
        found: String,
        /// What it should be.
        needed: String,
    },
    /// It cannot be decoded.
    #[error("{}: found a picture that cannot be decoded ({problem}), needed a whole one", file.display())]
    Broken {
        /// The file.
        file: PathBuf,
        /// The decoder's words.
        problem: String,
    },
}
