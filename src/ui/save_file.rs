//! Files that the window makes at the press of a button: a panel hands the contents over as it hands a text to the
//! clipboard, and the window asks where they go.

use std::sync::Arc;

use egui::{Context, Id};

use super::file_dialog::Purpose;

/// A file that waits for its place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SaveFile {
    /// What it is.
    pub purpose: Purpose,
    /// The suggested name, with its ending.
    pub name: String,
    /// What stands in it.
    pub contents: Arc<[u8]>,
}

fn id() -> Id {
    Id::unique("file to be saved")
}

/// Asks for a place for a file; what was asked before in the same frame is forgotten.
pub fn ask(ctx: &Context, file: SaveFile) {
    ctx.data_mut(|data| data.insert_temp(id(), Some(file)));
}

/// The file for which a place was asked in this frame, once.
#[must_use]
pub fn take(ctx: &Context) -> Option<SaveFile> {
    ctx.data_mut(|data| data.remove_temp::<Option<SaveFile>>(id())).flatten()
}
