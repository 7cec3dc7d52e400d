//! The import's preview: what was read, how, and what to make of it.

mod bag;
mod fields;
pub mod memory;
pub mod model;
mod panel;
mod preview;
mod settings;

pub use memory::ImportMemory;
pub use panel::{ImportState, show};

use egui::Ui;

use crate::text::import as words;

use super::actions::Action;
use super::theme;

/// The ways to import, as buttons in a row.
pub fn entries(ui: &mut Ui, actions: &mut Vec<Action>) {
    ui.add_space(8.0);
    ui.label(theme::dim(ui, words::ENTRY_HINT));
    ui.horizontal_wrapped(|ui| {
        for (action, label, hint) in [
            (Action::Paste, words::PASTE, words::PASTE_HINT),
            (Action::Import, words::IMPORT, words::IMPORT_HINT),
            (Action::ImportFolder, words::IMPORT_FOLDER, words::IMPORT_FOLDER_HINT),
        ] {
            if ui.button(label).on_hover_text(hint).clicked() {
                actions.push(action);
            }
        }
        ui.label(theme::dim(ui, words::PASTE_KEY).small());
    });
}
