//! Files and the files of folders, read into memory.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::sheet::natural_key;

use super::{Bag, Content, ImportError, Source, bag};

/// No file of poses or of a profile is as large.
pub const MAX_FILE_BYTES: u64 = 64 << 20;
/// All files of one import together.
pub const MAX_TOTAL_BYTES: u64 = 512 << 20;
/// Files of one import.
pub const MAX_FILES: usize = 20_000;
/// Folders in folders.
const MAX_DEPTH: usize = 4;

/// Endings of files that are certainly something else; others of a folder are looked into.
const NOT_OURS: [&str; 17] = [
    "png", "jpg", "jpeg", "bmp", "tif", "tiff", "pdf", "zip", "gz", "7z", "xls", "xlsx", "doc", "docx", "exe", "dll",
    "svg",
];

fn unreadable(path: &Path, error: &std::io::Error) -> ImportError {
    ImportError::Unreadable { file: path.display().to_string(), problem: error.to_string() }
}

/// Reads what `paths` name; see [`super::read_paths`].
pub(super) fn read_paths(paths: &[PathBuf]) -> Result<Vec<Source>, ImportError> {
    let mut files: Vec<(PathBuf, String)> = Vec::new();
    for path in paths {
        let metadata = fs::metadata(path).map_err(|error| unreadable(path, &error))?;
        if metadata.is_dir() {
            list(path, path, 0, &mut files)?;
        } else {
            let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
            files.push((path.clone(), name));
        }
    }
    let (files, bags) = split_bags(files)?;
    let mut total = 0;
    let mut sources = Vec::with_capacity(files.len() + bags.len());
    for (name, files) in bags {
        sources.push(Source { name, content: Content::Bag(Arc::new(Bag::open(&files)?)) });
    }
    for (path, name) in files {
        let metadata = fs::metadata(&path).map_err(|error| unreadable(&path, &error))?;
        let file = path.display().to_string();
        if !metadata.is_file() {
            return Err(ImportError::Unreadable { file, problem: "it is a device or pipe".to_owned() });
        }
        total += metadata.len();
        for (found_bytes, limit_bytes) in [(metadata.len(), MAX_FILE_BYTES), (total, MAX_TOTAL_BYTES)] {
            if found_bytes > limit_bytes {
                return Err(ImportError::TooLarge { file, found_bytes, limit_bytes });
            }
        }
        let bytes = fs::read(&path).map_err(|error| unreadable(&path, &error))?;
        sources.push(Source::from_bytes(name, bytes));
    }
    Ok(sources)
}

/// Files, and how messages name them.
type Named = Vec<(PathBuf, String)>;
/// Bags with their names and files.
type Bags = Vec<(String, Vec<PathBuf>)>;

/// Takes the bags out of a list of files: those beside one `metadata.yaml` are one recording, which is named as its folder.
fn split_bags(files: Named) -> Result<(Named, Bags), ImportError> {
    const METADATA: &str = "metadata.yaml";
    let mut bags: Vec<(PathBuf, String, Vec<PathBuf>)> = Vec::new();
    let mut others = Vec::with_capacity(files.len());
    for (path, name) in files {
        if !path.is_file() || !bag::is_bag(&path)? {
            others.push((path, name));
            continue;
        }
        let folder = path.parent().filter(|folder| folder.join(METADATA).is_file()).map(Path::to_path_buf);
        if let Some((_, _, files)) = bags.iter_mut().find(|(known, _, _)| folder.as_ref() == Some(known)) {
            files.push(path);
        } else {
            let folder_name = folder.as_deref().and_then(Path::file_name);
            let name = folder_name.map_or(name, |folder| folder.to_string_lossy().into_owned());
            bags.push((folder.unwrap_or_else(|| path.clone()), name, vec![path]));
        }
    }
    let is_metadata = |path: &Path| path.ends_with(METADATA) && bags.iter().any(|bag| path.parent() == Some(&bag.0));
    others.retain(|(path, _)| !is_metadata(path));
    if bags.is_empty()
        && let [(path, _)] = others.as_slice()
        && let Some(error) = bag::only_metadata(path)
    {
        return Err(error.into());
    }
    Ok((others, bags.into_iter().map(|(_, name, files)| (name, files)).collect()))
}

/// The files of a folder and of those in it, numbers in their names in their order.
fn list(folder: &Path, root: &Path, depth: usize, files: &mut Vec<(PathBuf, String)>) -> Result<(), ImportError> {
    let mut entries: Vec<PathBuf> = fs::read_dir(folder)
        .map_err(|error| unreadable(folder, &error))?
        .map(|entry| entry.map(|entry| entry.path()).map_err(|error| unreadable(folder, &error)))
        .collect::<Result<_, _>>()?;
    entries.sort_by_cached_key(|path| natural_key(&path.to_string_lossy()));
    for path in entries {
        let is_hidden = path.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'));
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
        if is_hidden || ending.is_some_and(|ending| NOT_OURS.contains(&ending.as_str())) {
            continue;
        }
        if path.is_dir() {
            if depth < MAX_DEPTH {
                list(&path, root, depth + 1, files)?;
            }
        } else {
            if files.len() >= MAX_FILES {
                return Err(ImportError::NotRecognised {
                    file: root.display().to_string(),
                    found: format!("more than {MAX_FILES} files"),
                });
            }
            let name = path.strip_prefix(root).unwrap_or(&path).to_string_lossy().replace('\\', "/");
            files.push((path, name));
        }
    }
    Ok(())
}
