//! Why a session file could not be read or written, each in one line: which file, where in it, found, expected.

use std::io;

use thiserror::Error;

/// Why a session file could not be read or written.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum SessionError {
    /// The operating system did not let us read it.
    #[error("cannot read {file}: {problem}")]
    Unreadable {
        /// The file.
        file: String,
        /// The kind of the failure.
        kind: io::ErrorKind,
        /// The operating system's words.
        problem: String,
    },
    /// Something other than a file has this name.
    #[error("{file}: found {found}, expected a session file")]
    NotAFile {
        /// The path.
        file: String,
        /// What it is instead.
        found: &'static str,
    },
    /// No session is as large; it is not read into memory.
    #[error("{file}: found {found_bytes} bytes, expected a session of at most {limit_bytes} bytes")]
    TooLarge {
        /// The file.
        file: String,
        /// Its size.
        found_bytes: u64,
        /// The largest size that is read.
        limit_bytes: u64,
    },
    /// No text at all.
    #[error("{file}: found an empty file, expected a session (JSON)")]
    Empty {
        /// The file.
        file: String,
    },
    /// Not text in UTF-8.
    #[error("{file}, line {line}, column {column}: found bytes that are not UTF-8, expected a session (JSON in UTF-8)")]
    NotUtf8 {
        /// The file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// Column in bytes, from 1.
        column: usize,
    },
    /// Not JSON.
    #[error("{file}, line {line}, column {column}: found {found}, expected JSON: {problem}")]
    Syntax {
        /// The file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// Column in bytes, from 1.
        column: usize,
        /// The text there.
        found: String,
        /// What the JSON reader says.
        problem: String,
    },
    /// JSON that ends in the middle.
    #[error(
        "{file}, line {line}, column {column}: found the end of the file, expected more of the session: the file was cut off, and what is missing cannot be guessed; take it from a copy, or restart Handeye, which offers what it has kept of unsaved sessions"
    )]
    CutOff {
        /// The file.
        file: String,
        /// Line of the end, from 1.
        line: usize,
        /// Column of the end in bytes, from 1.
        column: usize,
    },
    /// A number that JSON does not have.
    #[error(
        "{file}, line {line}, column {column}: found {found}, expected a finite number; write null in z_mm for a point that is missing, elsewhere the number that was measured"
    )]
    NotANumber {
        /// The file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// Column in bytes, from 1.
        column: usize,
        /// What stands there.
        found: String,
    },
    /// A session of a newer program.
    #[error(
        "{file}: version: found {found}, expected at most {supported}: a newer Handeye wrote this session, open it with that one"
    )]
    NewerVersion {
        /// The file.
        file: String,
        /// Its version.
        found: u64,
        /// The newest version that this program reads.
        supported: u64,
    },
    /// A field or value that is not as the format has it.
    #[error("{file}: {path}: found {found}, expected {expected}")]
    Invalid {
        /// The file.
        file: String,
        /// Where: a path like `stations[3].captures[0].profile.z_mm[17]`.
        path: String,
        /// What stands there.
        found: String,
        /// What should stand there.
        expected: String,
    },
    /// The operating system did not let us write it; an older file of this name is as it was.
    #[error("cannot save {file}: {problem}; {}", way_out(*kind))]
    Unwritable {
        /// The file.
        file: String,
        /// The kind of the failure.
        kind: io::ErrorKind,
        /// The operating system's words.
        problem: String,
    },
    /// The file is marked as not to be changed.
    #[error("cannot save {file}: it is read-only; use \"Save as…\" to write another file")]
    ReadOnly {
        /// The file.
        file: String,
    },
    /// Another program has written the file since it was read.
    #[error(
        "did not save {file}: another program has changed it since it was opened; save over it, save as another file, or reload it"
    )]
    ChangedOnDisk {
        /// The file.
        file: String,
    },
    /// The session holds something that could not be read back; an older file of this name is as it was.
    #[error("cannot save: the session could not be opened again; {refusal}")]
    WouldNotReadBack {
        /// What reading would say.
        refusal: Box<SessionError>,
    },
}

/// What to do where a file could not be written.
const fn way_out(kind: io::ErrorKind) -> &'static str {
    match kind {
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded | io::ErrorKind::FileTooLarge => {
            "a file that was there is as it was. Free some space, or save in another place"
        }
        io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => {
            "you may not write in this folder. Save in another one"
        }
        io::ErrorKind::NotFound | io::ErrorKind::NotADirectory => "this folder is not there. Save in another one",
        _ => "a file that was there is as it was. Try again, or save in another place",
    }
}

/// The operating system's words for what went wrong, without the name of a temporary file.
#[must_use]
pub(crate) fn system_words(error: &io::Error) -> String {
    let from_system = error.raw_os_error().map(io::Error::from_raw_os_error);
    let words = match (&from_system, error.kind()) {
        (Some(from_system), _) => from_system.to_string(),
        (None, io::ErrorKind::Other) => error.to_string(),
        (None, kind) => kind.to_string(),
    };
    on_one_line(&words)
}

/// A file's name or a piece of text on one line: control characters would break the line that names them.
#[must_use]
pub(super) fn on_one_line(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { '\u{fffd}' } else { c }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_can_cross_threads_and_stay_on_one_line() {
        const fn sendable<T: Send + Sync + 'static>() {}
        const { sendable::<SessionError>() };
        assert_eq!(on_one_line("a\nb\u{1b}[0m"), "a\u{fffd}b\u{fffd}[0m");
    }
}
