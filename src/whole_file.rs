//! Files that are replaced in one step: on the disk is always either the old one or the new one, whole.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

const TEMPORARY_PREFIX: &str = ".handeye-";
const TEMPORARY_SUFFIX: &str = ".tmp";
/// A temporary file that nobody holds is removed once it is older: one that was created a moment ago may not be locked yet.
const ABANDONED_AFTER: Duration = Duration::from_mins(1);

/// Replaces a file in one step by what `write` puts into it; answers when it was written, where the system tells. An existing
/// file keeps its permissions; through a symbolic link the file that it points to is replaced. What is left of attempts that
/// were killed is tidied up.
///
/// # Errors
/// Those of the system and of `write`; an older file of this name is then as it was.
pub(crate) fn replace<E: From<io::Error>>(
    path: &Path,
    write: impl FnOnce(&mut File) -> Result<(), E>,
) -> Result<Option<SystemTime>, E> {
    let existing = match fs::metadata(path) {
        Ok(metadata) if metadata.is_dir() => {
            return Err(io::Error::new(io::ErrorKind::IsADirectory, "it is a folder").into());
        }
        Ok(metadata) => Some(metadata),
        Err(error) if error.kind() == io::ErrorKind::NotFound => None,
        Err(error) => return Err(error.into()),
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
    write(temporary.as_file_mut())?;
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
    Ok(modified)
}

fn new_file(folder: &Path) -> io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(TEMPORARY_PREFIX).suffix(TEMPORARY_SUFFIX);
    // By default a temporary file is for its owner only; a session is as open as any new file (the umask applies).
    #[cfg(unix)]
    let permissions = std::os::unix::fs::PermissionsExt::from_mode(0o666);
    #[cfg(unix)]
    builder.permissions(permissions);
    // The name of the temporary file, which comes with the error, is nothing that anybody asked for.
    builder.tempfile_in(folder).map_err(|error| io::Error::new(error.kind(), without_place(&error.to_string())))
}

/// What is wrong, of a sentence that ends with where.
fn without_place(said: &str) -> String {
    said.rsplit_once(" at path ").map_or(said, |(problem, _)| problem).to_owned()
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
    fn a_refusal_does_not_name_the_temporary_file() {
        let folder = tempfile::tempdir().expect("a folder");
        let place = folder.path().join("missing").join("a.json");
        let refused = replace(&place, |_| Ok::<(), io::Error>(())).expect_err("there is no such folder");
        assert_eq!(refused.kind(), io::ErrorKind::NotFound);
        assert!(!refused.to_string().contains(TEMPORARY_PREFIX), "{refused}");
    }

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
