//! A recording as a sequence folder, with the truth and the flange poses.

use std::path::Path;

use thiserror::Error;

use crate::session::sequence::{SequenceError, SequenceWriter};
use crate::watch::{Cancelled, Watch};

use super::RoomRecording;

/// Why a recording was not written.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum FolderError {
    /// The folder could not be written.
    #[error(transparent)]
    Sequence(#[from] SequenceError),
    /// Nobody wants it any more.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Writes a recording, one frame after the other.
///
/// # Errors
/// [`FolderError`]; a folder with files in it is not touched.
pub fn write_folder(recording: RoomRecording, folder: &Path, watch: &mut dyn Watch) -> Result<(), FolderError> {
    let mut writer = SequenceWriter::create(folder, &recording.options().camera)?;
    let total = recording.len();
    for (idx, frame) in recording.enumerate() {
        watch.report(idx, total)?;
        writer.push(&frame.images, Some(&frame.world_from_sensor), frame.flange.as_ref())?;
    }
    Ok(writer.finish()?)
}
