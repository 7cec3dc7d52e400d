//! Imports on their way to the bench, and exports.

use std::path::PathBuf;
use std::sync::Arc;

use crate::session::import::{ImportError, ImportOptions, Imported, Source};

use super::Workbench;
use crate::app::ImportInto;

/// An import that the user looks at before it is made.
#[derive(Clone, Debug)]
pub struct ImportDraft {
    /// What was read from disk or pasted.
    pub sources: Arc<Vec<Source>>,
    /// What the user has set.
    pub options: ImportOptions,
    /// What came of it; `None` while it is being read.
    pub outcome: Option<Result<Arc<Imported>, ImportError>>,
}

impl Workbench {
    pub(super) fn start_import(&mut self, _paths: Vec<PathBuf>) {}

    pub(super) fn start_import_of_text(&mut self, _text: String) {}

    pub(super) fn set_import_options(&mut self, _options: ImportOptions) {}

    pub(super) fn finish_import(&mut self, _into: ImportInto) {}

    pub(super) fn cancel_import(&mut self) {
        self.import = None;
    }

    pub(super) fn export_poses(&mut self, _path: PathBuf) {}

    pub(super) fn export_profiles(&mut self, _folder: PathBuf) {}
}
