//! What the window remembers between runs.

use std::path::{Path, PathBuf};

use egui::ThemePreference;
use serde::{Deserialize, Serialize};

use super::capture::{CellMemory, memory};
use super::import::ImportMemory;
use super::report::ReportMemory;

/// Recent files kept.
const MAX_RECENT: usize = 8;

/// Light, dark, or as the system has it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum ThemeChoice {
    /// Light.
    #[default]
    Light,
    /// Dark.
    Dark,
    /// As the system.
    System,
}

impl ThemeChoice {
    /// egui's name for it.
    #[must_use]
    pub const fn preference(self) -> ThemePreference {
        match self {
            Self::Light => ThemePreference::Light,
            Self::Dark => ThemePreference::Dark,
            Self::System => ThemePreference::System,
        }
    }
}

/// What the window remembers between runs; size and position of the window are eframe's to remember.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Persisted {
    /// The theme.
    pub theme: ThemeChoice,
    /// Scale of the interface, 1 for normal.
    pub scale: f32,
    /// Files opened, the last one first.
    pub recent_files: Vec<PathBuf>,
    /// Whether the inspector is shown.
    pub inspector_open: bool,
    /// Who answers for reports, and where they are made.
    pub report: ReportMemory,
    /// How tables were read that were imported.
    pub imports: ImportMemory,
    /// Robots and profilers, and what is set before motion.
    #[serde(serialize_with = "memory::to_text", deserialize_with = "memory::from_text")]
    pub cell: CellMemory,
}

impl Default for Persisted {
    fn default() -> Self {
        Self {
            theme: ThemeChoice::default(),
            scale: 1.0,
            recent_files: Vec::new(),
            inspector_open: true,
            report: ReportMemory::default(),
            imports: ImportMemory::default(),
            cell: CellMemory::default(),
        }
    }
}

impl Persisted {
    /// The key in eframe's storage.
    pub const KEY: &'static str = "handeye";

    /// Puts a file at the head of the recent ones.
    pub fn note_recent(&mut self, path: &Path) {
        self.recent_files.retain(|known| known != path);
        self.recent_files.insert(0, path.to_owned());
        self.recent_files.truncate(MAX_RECENT);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_recent_file_is_listed_once_and_first() {
        let mut persisted = Persisted::default();
        for name in ["a", "b", "a"] {
            persisted.note_recent(Path::new(name));
        }
        assert_eq!(persisted.recent_files, [PathBuf::from("a"), PathBuf::from("b")]);
    }
}
