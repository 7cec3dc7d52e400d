//! Atomic saving: the file on disk is always either the old session or the new one, whole.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use crate::session::error::on_one_line;

use super::{Session, SessionError, file_name, parse_with_notes, to_json};

/// Saves a session, replacing the file in one step: temporary file in the same folder, flush to disk, rename.
///
/// An existing file keeps its permissions; through a symbolic link the file that it points to is replaced. What is
/// about to be written is read back first, so a session that could not be opened again never replaces one that can.
///
/// # Errors
/// [`SessionError`]; an older file of this name is then as it was.
pub fn save(session: &Session, path: &Path) -> Result<(), SessionError> {
    let json = to_json(session);
    parse_with_notes(json.as_bytes(), &file_name(path))
        .map_err(|refusal| SessionError::WouldNotReadBack { refusal: Box::new(refusal) })?;
    replace_file(path, json.as_bytes()).map_err(|error| SessionError::Unwritable {
        file: file_name(path),
        kind: error.kind(),
        problem: on_one_line(&error.to_string()),
    })
}

fn replace_file(path: &Path, bytes: &[u8]) -> io::Result<()> {
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
    let mut temporary = new_file(&folder)?;
    temporary.write_all(bytes)?;
    if let Some(metadata) = existing {
        temporary.as_file().set_permissions(metadata.permissions())?;
    }
    temporary.as_file().sync_all()?;
    temporary.persist(&target).map_err(|error| error.error)?;
    // The rename itself reaches the disk with the folder. Not every system can flush one; the data is safe already.
    if let Ok(folder) = File::open(&folder) {
        let _ = folder.sync_all();
    }
    Ok(())
}

fn new_file(folder: &Path) -> io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".handeye-").suffix(".tmp");
    // By default a temporary file is for its owner only; a session is as open as any new file (the umask applies).
    #[cfg(unix)]
    let permissions = std::os::unix::fs::PermissionsExt::from_mode(0o666);
    #[cfg(unix)]
    builder.permissions(permissions);
    builder.tempfile_in(folder)
}
