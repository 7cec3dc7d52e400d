//! Atomic saving: the file on disk is always either the old session or the new one, whole.

use std::fs::{self, OpenOptions};
use std::io::{self, Write as _};
use std::path::Path;

use crate::session::error::system_words;
use crate::whole_file;

use super::{Session, SessionError, Stamp, file_name, parse_with_notes, to_json};

/// Saves a session, replacing the file in one step: temporary file in the same folder, flush to disk, rename.
///
/// An existing file keeps its permissions, and one that is read-only stays; through a symbolic link the file that it
/// points to is replaced. What is about to be written is read back first, so a session that could not be opened again
/// never replaces one that can.
///
/// # Errors
/// [`SessionError`]; an older file of this name is then as it was.
pub fn save(session: &Session, path: &Path) -> Result<(), SessionError> {
    save_over(session, path, None).map(drop)
}

/// As [`save`], unless the file is there and is not `known` any more; answers the stamp of the new file.
///
/// # Errors
/// As for [`save`], and [`SessionError::ChangedOnDisk`].
pub fn save_over(session: &Session, path: &Path, known: Option<&Stamp>) -> Result<Stamp, SessionError> {
    let unwritable = |error: io::Error| SessionError::Unwritable {
        file: file_name(path),
        kind: error.kind(),
        problem: system_words(&error),
    };
    if is_read_only(path) {
        return Err(SessionError::ReadOnly { file: file_name(path) });
    }
    if let Some(known) = known {
        match Stamp::of(path) {
            Ok(found) if !found.has_contents_of(known) => {
                return Err(SessionError::ChangedOnDisk { file: file_name(path) });
            }
            Ok(_) => {}
            // It was deleted or moved: there is nothing to lose.
            Err(error) if error.kind() == io::ErrorKind::NotFound => {}
            Err(error) => return Err(unwritable(error)),
        }
    }
    let json = to_json(session);
    parse_with_notes(json.as_bytes(), &file_name(path))
        .map_err(|refusal| SessionError::WouldNotReadBack { refusal: Box::new(refusal) })?;
    replace_file(path, json.as_bytes()).map_err(unwritable)
}

/// Whether a file is there that is not to be changed. Replacing it might work all the same; it is not done.
#[must_use]
pub fn is_read_only(path: &Path) -> bool {
    let Ok(metadata) = fs::metadata(path) else { return false };
    if !metadata.is_file() {
        return false;
    }
    // The second for files of other users; the first as an administrator may write whatever is marked.
    metadata.permissions().readonly()
        || OpenOptions::new().write(true).open(path).is_err_and(|error| {
            matches!(error.kind(), io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem)
        })
}

/// Replaces a file in one step; answers its stamp.
pub(crate) fn replace_file(path: &Path, bytes: &[u8]) -> io::Result<Stamp> {
    let modified = whole_file::replace(path, |file| file.write_all(bytes))?;
    Ok(Stamp::new(bytes, modified))
}
