//! What a paper printed, with the errors that follow from its own centres beside the printed ones.

use egui::{Align, Align2, Color32, Layout, Ui};

use crate::calibrate::Method;
use crate::report::comparison::PublishedTable;
use crate::text::compare as text;
use crate::ui::{theme, widgets};

use super::table::{RowCells, coordinate, tint};

/// Parts of a row: station, three centres, three printed errors, three recomputed errors.
const PARTS: [f32; 10] = [60.0, 72.0, 72.0, 72.0, 76.0, 76.0, 76.0, 66.0, 66.0, 66.0];

/// Shows the card in the space available.
pub fn show(ui: &mut Ui, table: &PublishedTable) {
    let has_errors = table.rows.iter().any(|row| row.printed_error_mm.is_some());
    let right = |ui: &mut Ui| {
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if has_errors {
                let palette = theme::palette(ui);
                match table.num_misprints() {
                    0 => ui.label(theme::dim(ui, text::NO_MISPRINTS)),
                    count => ui.label(theme::strong(format!("≠ {}", text::misprints(count))).color(palette.bad)),
                };
            }
            ui.add_space(12.0);
            // The paper's own language is kept in the file; letters that the window has none of would be boxes.
            let font = egui::TextStyle::Body.resolve(ui.style());
            let has_letters = ui.fonts_mut(|fonts| fonts.has_glyphs(&font, &table.caption));
            let caption = if has_letters { table.caption.as_str() } else { text::CAPTION_IN_OTHER_LETTERS };
            ui.add(egui::Label::new(theme::dim(ui, caption)).truncate()).on_hover_text(caption);
        });
    };
    widgets::card(ui, text::AS_PUBLISHED, right, |ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        let scale = ui.available_width() / PARTS.iter().sum::<f32>();
        let widths = PARTS.map(|part| part * scale);
        let mut row = RowCells::new(ui, theme::ROW_HEIGHT);
        row.head(widths[0], text::STATION, Align2::LEFT_CENTER);
        row.head(widths[1..4].iter().sum(), text::in_base(Method::BallFixedPoint), Align2::CENTER_CENTER);
        row.head(widths[4..7].iter().sum(), text::PRINTED_ERROR, Align2::CENTER_CENTER);
        row.head(widths[7..].iter().sum(), text::RECOMPUTED_ERROR, Align2::CENTER_CENTER);
        for (row_idx, printed) in table.rows.iter().enumerate() {
            let mut row = RowCells::new(ui, theme::ROW_HEIGHT);
            let label = table.labels.get(row_idx).cloned().unwrap_or_else(|| (row_idx + 1).to_string());
            row.text(widths[0], &label);
            for axis in 0..3 {
                let value = printed.target_in_base_mm[axis];
                row.number(widths[1 + axis], value, &coordinate(value), Color32::TRANSPARENT);
            }
            for axis in 0..3 {
                let width = widths[4 + axis];
                let Some(error_mm) = printed.printed_error_mm else {
                    row.head(width, "–", Align2::RIGHT_CENTER);
                    continue;
                };
                let words = widgets::signed(error_mm[axis], 3);
                if printed.is_misprint[axis] {
                    let recomputed = widgets::signed(printed.recomputed_error_mm[axis], 3);
                    row.flagged(width, &format!("≠ {words}"), &text::misprint(&words, &recomputed));
                } else {
                    row.number(width, error_mm[axis], &words, Color32::TRANSPARENT);
                }
            }
            for axis in 0..3 {
                let value = printed.recomputed_error_mm[axis];
                row.number(widths[7 + axis], value, &widgets::signed(value, 3), tint(value));
            }
        }
    });
}
