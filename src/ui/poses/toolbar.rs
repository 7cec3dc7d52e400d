//! The buttons above the table, with their shortcuts.

use std::cell::Cell;

use egui::{Button, RichText, Role, Ui, WidgetInfo, vec2};

use crate::app::{Command, Document};
use crate::text::poses as words;
use crate::ui::theme;

use super::sheet::Sheet;

/// Draws the buttons in a row. Answers whether one of them was used.
pub fn show(ui: &mut Ui, sheet: &mut Sheet, document: &Document, commands: &mut Vec<Command>) -> bool {
    let session = &document.session;
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
    if button(ui, words::ADD, words::ADD_HINT, true) {
        sheet.commit(commands);
        sheet.add(session, commands);
    }
    if button(ui, words::DUPLICATE, words::DUPLICATE_HINT, has_rows) {
        sheet.duplicate(commands);
    }
    if button(ui, words::DELETE, words::DELETE_HINT, has_rows) {
        sheet.remove(commands);
    }
    ui.add_space(8.0);
    if button(ui, "↑", words::MOVE_UP_HINT, has_rows) {
        sheet.shift(session, true, commands);
    }
    if button(ui, "↓", words::MOVE_DOWN_HINT, has_rows) {
        sheet.shift(session, false, commands);
    }
    if button(ui, words::SORT, words::SORT_BUTTON_HINT, has_rows)
        && let Some((_, column)) = sheet.cell()
    {
        sheet.sort(session, column, commands);
    }
    if button(ui, words::FILL, words::FILL_HINT, has_rows) {
        sheet.fill(session, commands);
    }
    ui.add_space(8.0);
    if button(ui, words::COPY, words::COPY_HINT, has_rows) {
        ui.ctx().copy_text(sheet.copied(session));
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
