//! The files of a bag: which topics they have, and their messages one after the other.

use std::fs::File;
use std::io::Read as _;
use std::path::Path;

use super::{BagError, mcap, sqlite};
use crate::session::import::ImportError;

/// How a file of a bag is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Storage {
    Mcap,
    Sqlite,
}

/// A topic of one file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct FileTopic {
    pub name: String,
    pub type_name: String,
    /// How its messages are written; `cdr` is what we read.
    pub encoding: String,
    pub num_messages: u64,
    /// When the first and the last were recorded, as far as the file tells without being read as a whole.
    pub recorded_ns: Option<[i64; 2]>,
}

/// A message of a topic.
#[derive(Clone, Copy, Debug)]
pub(super) struct RawMessage<'b> {
    /// What [`stream`] was told to call the topic.
    pub topic_idx: usize,
    /// When it was recorded.
    pub log_time_ns: i64,
    pub data: &'b [u8],
}

/// Takes messages.
pub(super) type Take<'t> = &'t mut dyn FnMut(RawMessage<'_>) -> Result<(), ImportError>;

/// What kind of bag a file is, by its first bytes.
///
/// # Errors
/// [`BagError`] for one that is compressed as a whole.
pub(super) fn recognise(path: &Path) -> Result<Option<Storage>, BagError> {
    const SQLITE: &[u8] = b"SQLite format 3\0";
    const ZSTD: &[u8] = &[0x28, 0xb5, 0x2f, 0xfd];
    let mut head = Vec::new();
    // What cannot be read is no bag: whoever reads it next says why.
    if File::open(path).and_then(|file| file.take(16).read_to_end(&mut head)).is_err() {
        return Ok(None);
    }
    if head.starts_with(::mcap::MAGIC) {
        return Ok(Some(Storage::Mcap));
    }
    if head.starts_with(SQLITE) {
        return Ok(Some(Storage::Sqlite));
    }
    let name = path.file_name().map(|name| name.to_string_lossy().to_lowercase()).unwrap_or_default();
    if head.starts_with(ZSTD) && (name.contains(".mcap.") || name.contains(".db3.")) {
        return Err(BagError {
            file: path.display().to_string(),
            found: "a file that is compressed as a whole (zstd)".to_owned(),
            needed: "an MCAP or SQLite file".to_owned(),
            remedy: "uncompress it with `zstd -d`".to_owned(),
        });
    }
    if path.extension().is_some_and(|ending| ending == "mcap" || ending == "db3") {
        let found = if head.is_empty() { "an empty file".to_owned() } else { "another file's beginning".to_owned() };
        return Err(BagError {
            file: path.display().to_string(),
            found,
            needed: "an MCAP or SQLite file, as its name says".to_owned(),
            remedy: "copy it again, or record it again".to_owned(),
        });
    }
    Ok(None)
}

/// The topics of a file, and why it could not be looked through to its end.
pub(super) fn topics(path: &Path, storage: Storage) -> Result<(Vec<FileTopic>, Option<String>), BagError> {
    match storage {
        Storage::Mcap => mcap::topics(path),
        Storage::Sqlite => sqlite::topics(path).map(|topics| (topics, None)),
    }
}

/// Hands over the messages of the topics that `wanted` has a number for, by their name and type, in the order of the file; answers why it ended
/// before the file's end.
pub(super) fn stream(
    path: &Path,
    storage: Storage,
    wanted: &dyn Fn(&str, &str) -> Option<usize>,
    take: Take<'_>,
) -> Result<Option<String>, ImportError> {
    match storage {
        Storage::Mcap => mcap::stream(path, wanted, take),
        Storage::Sqlite => sqlite::stream(path, wanted, take),
    }
}
