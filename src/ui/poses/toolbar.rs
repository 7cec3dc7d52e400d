//! The buttons above the table, with their shortcuts.

use std::cell::Cell;

use egui::{Button, RichText, Role, Ui, WidgetInfo, vec2};

use crate::app::{Command, Document};
use crate::text::poses as words;
use crate::ui::theme;

use super::ask::Ask;
use super::sheet::Sheet;

/// Draws the buttons in a row. Answers whether one of them was used.
pub fn show(ui: &mut Ui, sheet: &mut Sheet, document: &Document, commands: &mut Vec<Command>) -> bool {
    let has_rows = !sheet.view.rows.is_empty();
    ui.spacing_mut().item_spacing.x = 4.0;
    ui.spacing_mut().interact_size.y = theme::ROW_HEIGHT;
    ui.spacing_mut().button_padding = vec2(8.0, 2.0);
    let is_used = Cell::new(false);
    let button = |ui: &mut Ui, label: &str, hint: &str, is_enabled: bool| {
        let button = Button::new(RichText::new(label).small()).min_size(vec2(theme::ROW_HEIGHT, theme::ROW_HEIGHT));
        let response = ui.add_enabled(is_enabled, button);
        response.widget_info(|| WidgetInfo::labeled(Role::Button, is_enabled, hint.split(" (").next().unwrap_or(hint)));
        let is_clicked = response.on_hover_text(hint).on_disabled_hover_text(hint).clicked();
        is_used.set(is_used.get() || is_clicked);
        is_clicked
    };
    let mut asked = None;
    let mut offer = |ui: &mut Ui, label: &str, hint: &str, is_enabled: bool, ask: Option<Ask>| {
        if button(ui, label, hint, is_enabled) {
            asked = ask;
        }
    };
    let sorting = sheet.cell().map(|(_, column)| Ask::Sort(column));
    offer(ui, words::ADD, words::ADD_HINT, true, Some(Ask::Add));
    offer(ui, words::DUPLICATE, words::DUPLICATE_HINT, has_rows, Some(Ask::Duplicate));
    offer(ui, words::DELETE, words::DELETE_HINT, has_rows, Some(Ask::Remove));
    ui.add_space(8.0);
    offer(ui, "↑", words::MOVE_UP_HINT, has_rows, Some(Ask::Shift { is_up: true }));
    offer(ui, "↓", words::MOVE_DOWN_HINT, has_rows, Some(Ask::Shift { is_up: false }));
    offer(ui, words::SORT, words::SORT_BUTTON_HINT, has_rows, sorting);
    offer(ui, words::FILL, words::FILL_HINT, has_rows, Some(Ask::Fill));
    ui.add_space(8.0);
    offer(ui, words::COPY, words::COPY_HINT, has_rows, Some(Ask::Copy));
    if let Some(ask) = asked {
        sheet.ask(ui.ctx(), document, ask, commands);
    }
    if button(ui, words::PASTE, words::PASTE_HINT, true) {
        ui.ctx().send_viewport_cmd(egui::ViewportCommand::RequestPaste);
    }
    is_used.get()
}

/// Draws the button that folds or unfolds all sweeps. Answers whether it was clicked.
pub fn fold_button(ui: &mut Ui, is_all_unfolded: bool) -> bool {
    ui.spacing_mut().interact_size.y = theme::ROW_HEIGHT;
    ui.spacing_mut().button_padding = vec2(8.0, 2.0);
    let label = if is_all_unfolded { words::FOLD_ALL } else { words::UNFOLD_ALL };
    ui.add(Button::new(RichText::new(label).small()).min_size(vec2(0.0, theme::ROW_HEIGHT))).clicked()
}
