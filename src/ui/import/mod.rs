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

use egui::{Label, Rect, Ui, UiBuilder, vec2};

use crate::text::import as words;
use crate::text::sequence as sequence_words;

use super::actions::Action;
use super::theme;

/// How a session of a board or marker gets its pairs of poses, and the button that begins it.
pub fn pairs(ui: &mut Ui, actions: &mut Vec<Action>) {
    ui.add(Label::new(theme::dim(ui, words::PAIRS_HINT)).wrap());
    ui.add_space(8.0);
    ui.horizontal_wrapped(|ui| {
        // The status bar has the primary one, which does the same.
        if ui.button(words::PAIRS).on_hover_text(words::PAIRS_COLUMNS).clicked() {
            actions.push(Action::Import);
        }
        ui.add(Label::new(theme::dim(ui, words::PASTE_KEY).small()).extend());
    });
}

/// The same in the middle of a step that has nothing else to show.
pub fn no_pairs(ui: &mut Ui, actions: &mut Vec<Action>) {
    /// Longer lines are hard to read, points.
    const WIDTH: f32 = 520.0;
    let area = ui.available_rect_before_wrap();
    let place = Rect::from_center_size(area.center(), vec2(WIDTH.min(area.width()), area.height() / 3.0));
    let mut inside = ui.new_child(UiBuilder::new().max_rect(place));
    inside.label(theme::heading(words::PAIRS_TITLE));
    inside.add_space(8.0);
    pairs(&mut inside, actions);
    ui.advance_cursor_after_rect(area);
}

/// The ways to take data from elsewhere, as buttons in a row.
pub fn entries(ui: &mut Ui, actions: &mut Vec<Action>) {
    ui.add_space(8.0);
    ui.label(theme::dim(ui, words::ENTRY_HINT));
    ui.horizontal_wrapped(|ui| {
        for (action, label, hint) in [
            (Action::Paste, words::PASTE, words::PASTE_HINT),
            (Action::Import, words::IMPORT, words::IMPORT_HINT),
            (Action::ImportFolder, words::IMPORT_FOLDER, words::IMPORT_FOLDER_HINT),
            (Action::OpenSequence, sequence_words::OPEN_FOLDER, sequence_words::OPEN_FOLDER_HINT),
        ] {
            if ui.button(label).on_hover_text(hint).clicked() {
                actions.push(action);
            }
        }
        ui.add(Label::new(theme::dim(ui, words::PASTE_KEY).small()).extend());
    });
}
