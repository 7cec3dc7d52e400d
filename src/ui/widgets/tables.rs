//! Tables with one row height, a sticky header and right-aligned numeric columns.

use egui::{Align, Layout, Ui};
use egui_extras::{Column, TableBuilder, TableRow};

use crate::ui::theme;

use super::number::{number, number_text};

/// Begins a table as the whole window has them: cells centred in height, selectable rows, and no stripes.
/// Set the columns, then `.header(theme::ROW_HEIGHT, …)` and `.body(…)`.
pub fn table(ui: &mut Ui, id_salt: impl egui::AsIdSalt) -> TableBuilder<'_> {
    ui.spacing_mut().item_spacing.y = 0.0;
    TableBuilder::new(ui)
        .id_salt(id_salt)
        .striped(false)
        .resizable(false)
        .cell_layout(Layout::left_to_right(Align::Center))
        .auto_shrink([false, false])
}

/// A column for numbers, at least `width` points wide; all columns share what is left.
#[must_use]
pub fn number_column(width: f32) -> Column {
    Column::remainder().at_least(width).clip(true)
}

/// A head cell of a text column, in the dimmer tone.
pub fn head(row: &mut TableRow<'_, '_>, text: &str) {
    row.col(|ui| {
        ui.add_space(4.0);
        ui.label(theme::dim(ui, text).small());
    });
}

/// A head cell of a column of numbers: right-aligned, in the dimmer tone, unit included.
pub fn number_head(row: &mut TableRow<'_, '_>, text: &str) {
    row.col(|ui| {
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            ui.add_space(4.0);
            ui.label(theme::dim(ui, text).small());
        });
    });
}

/// A cell with a right-aligned number in tabular figures.
pub fn number_cell(row: &mut TableRow<'_, '_>, text: impl Into<String>) {
    row.col(|ui| {
        number(ui, text);
    });
}

/// A cell with a right-aligned number in tabular figures, faded because its row does not take part.
pub fn faded_number_cell(row: &mut TableRow<'_, '_>, text: impl Into<String>) {
    row.col(|ui| {
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            ui.add_space(4.0);
            ui.label(number_text(text).color(theme::palette(ui).text_dim));
        });
    });
}
