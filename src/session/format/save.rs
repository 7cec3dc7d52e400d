//! Atomic saving: the file on disk is always either the old session or the new one, whole.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use crate::session::error::system_words;

use super::{Session, SessionError, Stamp, file_name, parse_with_notes, to_json};

const TEMPORARY_PREFIX: &str = ".handeye-";
const TEMPORARY_SUFFIX: &str = ".tmp";
/// A temporary file that nobody holds is removed once it is older: one that was created a moment ago may not be locked yet.
const ABANDONED_AFTER: Duration = Duration::from_mins(1);

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

/// Replaces a file in one step; answers its stamp. What is left of attempts that were killed is tidied up.
pub(crate) fn replace_file(path: &Path, bytes: &[u8]) -> io::Result<Stamp> {
    let existing = match fs::metadata(path) {
        Ok(metadata) if metadata.is_dir() => {
            return Err(io::Error::new(io::ErrorKind::IsADirectory, "it is a folder"));
        }
        Ok(metadata) => Some(metadata),
        Err(error) if error.kind() == io::ErrorKind::NotFound => None,
        Err(error) => return Err(error),
    };
    let target = if existing.is_some() { fs::canonicalize(path)? } else { path.to_path_buf() };
    let folder = match target.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent.to_path_buf(),
        _ => PathBuf::from("."),
    };
    // Dropped on the way out of an error, and so removed.
    let mut temporary = new_file(&folder)?;
    // As long as it is locked it is not abandoned. Where there are no locks, it is told by its age alone.
    let _ = temporary.as_file().try_lock();
    temporary.write_all(bytes)?;
    if let Some(metadata) = existing {
        temporary.as_file().set_permissions(metadata.permissions())?;
    }
    temporary.as_file().sync_all()?;
    let modified = temporary.as_file().metadata().and_then(|metadata| metadata.modified()).ok();
    temporary.persist(&target).map_err(|error| error.error)?;
    // The rename itself reaches the disk with the folder. Not every system can flush one; the data is safe already.
    if let Ok(folder) = File::open(&folder) {
        let _ = folder.sync_all();
    }
    sweep(&folder);
    Ok(Stamp::new(bytes, modified))
}

fn new_file(folder: &Path) -> io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(TEMPORARY_PREFIX).suffix(TEMPORARY_SUFFIX);
    // By default a temporary file is for its owner only; a session is as open as any new file (the umask applies).
    #[cfg(unix)]
    let permissions = std::os::unix::fs::PermissionsExt::from_mode(0o666);
    #[cfg(unix)]
    builder.permissions(permissions);
    builder.tempfile_in(folder)
}

/// Removes temporary files of ours that no program holds any more: it was killed while it saved.
pub(crate) fn sweep(folder: &Path) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let is_ours =
            name.to_str().is_some_and(|name| name.starts_with(TEMPORARY_PREFIX) && name.ends_with(TEMPORARY_SUFFIX));
        if is_ours && is_abandoned(&entry.path()) {
            // Where it cannot be removed, it stays: it does no harm.
            let _ = fs::remove_file(entry.path());
        }
    }
}

fn is_abandoned(temporary: &Path) -> bool {
    let Ok(file) = OpenOptions::new().write(true).open(temporary) else { return false };
    let modified = file.metadata().and_then(|metadata| metadata.modified());
    let is_old = modified
        .is_ok_and(|modified| SystemTime::now().duration_since(modified).is_ok_and(|age| age > ABANDONED_AFTER));
    is_old && !matches!(file.try_lock(), Err(TryLockError::WouldBlock))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_temporary_files_that_nobody_holds_are_swept_away() {
        let folder = tempfile::tempdir().expect("a folder");
        let long_ago = SystemTime::now() - 2 * ABANDONED_AFTER;
        let create = |name: &str, modified: SystemTime| {
            let file = File::create(folder.path().join(name)).expect("created");
            file.set_modified(modified).expect("set");
            file
        };
        drop(create(".handeye-old.tmp", long_ago));
        drop(create(".handeye-new.tmp", SystemTime::now()));
        drop(create(".other-old.tmp", long_ago));
        let held = create(".handeye-held.tmp", long_ago);
        held.try_lock().expect("nobody else has it");
        sweep(folder.path());
        let mut left: Vec<String> = fs::read_dir(folder.path())
            .expect("readable")
            .map(|entry| entry.expect("readable").file_name().to_string_lossy().into_owned())
            .collect();
        left.sort_unstable();
        assert_eq!(left, [".handeye-held.tmp", ".handeye-new.tmp", ".other-old.tmp"]);
    }
}
