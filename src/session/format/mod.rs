//! Session files: reading, checking and writing them.
//!
//! A file is read in two steps: JSON to a tree that is cheap for lists of numbers, then the tree to a
//! [`Session`], with every field checked once. Whatever is refused names file, place, found and expected.

mod cursor;
mod names;
mod save;
mod stamp;
mod tree;
mod v1;
mod write;

use std::fs;
use std::path::Path;
use std::time::SystemTime;

use crate::session::check::Finding;
use crate::session::error::on_one_line;

use self::cursor::{Cursor, Refusal};
use self::tree::{Node, quoted};
use super::{Session, SessionError};

pub(crate) use save::replace_file;
pub use save::{is_read_only, save, save_over};
pub use stamp::{Stamp, unix_ms};
pub use write::to_json;

/// The newest version of the format, which is also the one that is written.
pub const VERSION: u64 = 1;
/// A session of thousands of captures has tens of megabytes; beyond this it is some other file.
pub const MAX_BYTES: u64 = 512 << 20;

/// A session with what had to be mended while reading it.
#[derive(Clone, Debug, PartialEq)]
pub struct Loaded {
    /// The session.
    pub session: Session,
    /// Notes on the file itself; [`crate::session::check::findings`] has those on the session.
    pub notes: Vec<Finding>,
}

/// Reads a session file.
///
/// # Errors
/// [`SessionError`]: it cannot be read, is no JSON, or not as the format has it.
pub fn load(path: &Path) -> Result<Session, SessionError> {
    load_with_notes(path).map(|loaded| loaded.session)
}

/// Reads a session file, and says what had to be mended.
///
/// # Errors
/// As for [`load`].
pub fn load_with_notes(path: &Path) -> Result<Loaded, SessionError> {
    load_with_stamp(path).map(|(loaded, _)| loaded)
}

/// As [`load_with_notes`], with a stamp of the file by which a later change of it is noticed.
///
/// # Errors
/// As for [`load`].
pub fn load_with_stamp(path: &Path) -> Result<(Loaded, Stamp), SessionError> {
    let (bytes, modified) = read(path)?;
    // The time is from before the reading: what is written to the file meanwhile counts as a change.
    let stamp = Stamp::new(&bytes, modified);
    Ok((parse_with_notes(&bytes, &file_name(path))?, stamp))
}

/// Reads a session file, with its bytes as they are on the disk.
///
/// # Errors
/// As for [`load`].
pub fn load_with_bytes(path: &Path) -> Result<(Session, Vec<u8>), SessionError> {
    let (bytes, _) = read(path)?;
    Ok((parse(&bytes, &file_name(path))?, bytes))
}

/// The bytes of a file that may be a session, and when it was changed last, where the system tells.
fn read(path: &Path) -> Result<(Vec<u8>, Option<SystemTime>), SessionError> {
    let file = file_name(path);
    let unreadable = |error: std::io::Error| SessionError::Unreadable {
        file: file.clone(),
        kind: error.kind(),
        problem: on_one_line(&error.to_string()),
    };
    let metadata = fs::metadata(path).map_err(unreadable)?;
    if !metadata.is_file() {
        return Err(SessionError::NotAFile {
            found: if metadata.is_dir() { "a folder" } else { "a device or pipe" },
            file,
        });
    }
    if metadata.len() > MAX_BYTES {
        return Err(SessionError::TooLarge { file, found_bytes: metadata.len(), limit_bytes: MAX_BYTES });
    }
    Ok((fs::read(path).map_err(unreadable)?, metadata.modified().ok()))
}

/// Reads a session from the bytes of a file; `origin` names it in refusals.
///
/// # Errors
/// [`SessionError`]: it is no JSON, or not as the format has it.
pub fn parse(bytes: &[u8], origin: &str) -> Result<Session, SessionError> {
    parse_with_notes(bytes, origin).map(|loaded| loaded.session)
}

/// As [`parse`], and says what had to be mended.
///
/// # Errors
/// As for [`parse`].
pub fn parse_with_notes(bytes: &[u8], origin: &str) -> Result<Loaded, SessionError> {
    let file = on_one_line(origin);
    // Editors on Windows put a byte order mark in front.
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let (line, column) = line_and_column(&bytes[..error.valid_up_to()]);
        SessionError::NotUtf8 { file: file.clone(), line, column }
    })?;
    if text.trim().is_empty() {
        return Err(SessionError::Empty { file });
    }
    let tree: Node = serde_json::from_str(text).map_err(|error| syntax_error(file.clone(), text, &error))?;
    let invalid = |refusal: Refusal| SessionError::Invalid {
        file: file.clone(),
        path: refusal.path,
        found: refusal.found,
        expected: refusal.expected,
    };
    let root_cursor = Cursor::root(&tree);
    let root = root_cursor.object("a session, an object like {\"format\": \"handeye-session\", …}").map_err(invalid)?;
    let format = root.required("format", &quoted(names::FORMAT)).map_err(invalid)?;
    format.one_of(&[(names::FORMAT, ())]).map_err(invalid)?;
    let version_expected = format!("the version of the format, a whole number from 1 to {VERSION}");
    let version = root.required("version", &version_expected).map_err(invalid)?;
    match version.count() {
        Some(VERSION) => {}
        Some(found) if found > VERSION => {
            return Err(SessionError::NewerVersion { file, found, supported: VERSION });
        }
        _ => return Err(invalid(version.refuse(version_expected))),
    }
    let mut mended = v1::Mended::default();
    let session = v1::session(&root, &mut mended).map_err(invalid)?;
    Ok(Loaded { session, notes: mended.into_findings() })
}

/// The file as messages name it.
fn file_name(path: &Path) -> String {
    on_one_line(&path.display().to_string())
}

fn line_and_column(before: &[u8]) -> (usize, usize) {
    let line_start = before.iter().rposition(|byte| *byte == b'\n').map_or(0, |newline| newline + 1);
    let num_newlines = before.split(|byte| *byte == b'\n').count() - 1;
    (num_newlines + 1, before.len() - line_start + 1)
}

fn syntax_error(file: String, text: &str, error: &serde_json::Error) -> SessionError {
    /// Enough of the text to recognise the place.
    const CONTEXT_CHARS: usize = 24;
    let (line, column) = (error.line(), error.column());
    if error.is_eof() {
        return SessionError::CutOff { file, line, column };
    }
    // The column counts bytes up to and including the offending one; it may stand inside a character or a word.
    let line_text = text.lines().nth(line.saturating_sub(1)).unwrap_or_default();
    let at = (0..column).rev().find(|byte| line_text.is_char_boundary(*byte)).unwrap_or_default();
    let before = line_text.get(..at).unwrap_or_default();
    let is_of_word = |c: char| c.is_ascii_alphanumeric() || "+-.".contains(c);
    let word_start = before.trim_end_matches(is_of_word).len();
    let rest = |start: usize| line_text.get(start..).unwrap_or_default();
    let word = rest(word_start).split(|c: char| !is_of_word(c)).next().unwrap_or_default();
    let message = error.to_string();
    let is_number_word =
        ["nan", "inf", "infinity"].iter().any(|name| word.trim_start_matches(['+', '-']).eq_ignore_ascii_case(name));
    if is_number_word || message.starts_with("number out of range") {
        return SessionError::NotANumber { file, line, column, found: on_one_line(word) };
    }
    let problem = message.strip_suffix(&format!(" at line {line} column {column}")).unwrap_or(&message);
    let found = match rest(at).chars().take(CONTEXT_CHARS).collect::<String>() {
        context if context.is_empty() => "the end of the line".to_owned(),
        context => format!("`{}`", on_one_line(&context)),
    };
    // The reader's words for "something else than the beginning of any value".
    let problem = if problem == "expected value" { "a number, text in quotes, a list or an object" } else { problem };
    SessionError::Syntax { file, line, column, found, problem: on_one_line(problem) }
}
