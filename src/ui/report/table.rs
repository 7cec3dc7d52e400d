//! A report's table: columns as wide as they need, figures aligned on the right, set smaller where they would not fit.

use std::sync::Arc;

use egui::{Align2, Color32, FontId, Galley, Label, Rect, Role, Sense, Stroke, Ui, WidgetInfo, pos2, vec2};

use crate::report::document::{Cell, Column, Table};
use crate::ui::theme;

/// Between two columns, as a part of the type size.
const COLUMN_GAP: f32 = 1.2;
/// Height of a row, as a part of the type size.
const ROW_HEIGHT: f32 = 1.7;
/// Smaller type is not read any more, points.
const LEAST_SIZE: f32 = 6.5;
/// A column of words is not made narrower than this, in type sizes.
const LEAST_WORDS: f32 = 9.0;

/// The texts of a table, laid out.
struct Laid<'a> {
    table: &'a Table,
    size: f32,
    widths: Vec<f32>,
    gap: f32,
}

/// Paints a table in the width available.
pub(super) fn paint(ui: &mut Ui, table: &Table) {
    ui.label(theme::strong(&table.title));
    ui.add_space(4.0);
    let laid = Laid::new(ui, table, ui.available_width());
    let palette = theme::palette(ui);
    laid.head(ui);
    for row in &table.rows {
        laid.row(ui, row);
    }
    let (line, _) = ui.allocate_exact_size(vec2(laid.width(), 1.0), Sense::hover());
    ui.painter().hline(line.x_range(), line.center().y, Stroke::new(1.0, palette.hairline));
    if let Some(note) = &table.note {
        ui.add_space(3.0);
        ui.add(Label::new(theme::dim(ui, note).size(theme::SMALL_SIZE)).wrap());
    }
    ui.add_space(4.0);
}

impl<'a> Laid<'a> {
    fn new(ui: &Ui, table: &'a Table, room: f32) -> Self {
        let natural = |size: f32| -> Vec<f32> {
            let widest = |(idx, column): (usize, &Column)| {
                let cells = table.rows.iter().filter_map(|row| row.get(idx));
                let cells = cells.map(|cell| width_of(ui, &cell.text, &font(size, cell.is_strong)));
                cells.fold(width_of(ui, &heading(column), &font(size, false)), f32::max)
            };
            table.columns.iter().enumerate().map(widest).collect()
        };
        let mut size = theme::SMALL_SIZE;
        let mut widths = natural(size);
        #[expect(clippy::cast_precision_loss, reason = "a handful of columns")]
        let gaps = (widths.len().max(1) - 1) as f32;
        // Words wrap first; then the type becomes smaller.
        let excess = |widths: &[f32], size: f32| widths.iter().sum::<f32>() + gaps * size * COLUMN_GAP - room;
        let narrow = |widths: &mut [f32], size: f32| {
            let too_wide = excess(widths, size);
            let least = LEAST_WORDS * size;
            let spare: f32 = (widths.iter().zip(&table.columns))
                .filter(|(_, column)| !column.is_number)
                .map(|(width, _)| (width - least).max(0.0))
                .sum();
            if too_wide > 0.0 && spare > 0.0 {
                let part = (too_wide / spare).min(1.0);
                for (width, column) in widths.iter_mut().zip(&table.columns) {
                    if !column.is_number {
                        *width -= (*width - least).max(0.0) * part;
                    }
                }
            }
        };
        narrow(&mut widths, size);
        if excess(&widths, size) > 0.5 {
            let shrink = room / (room + excess(&widths, size));
            size = (size * shrink).max(LEAST_SIZE);
            widths = natural(size);
            narrow(&mut widths, size);
        }
        Self { table, size, gap: size * COLUMN_GAP, widths }
    }

    fn width(&self) -> f32 {
        #[expect(clippy::cast_precision_loss, reason = "a handful of columns")]
        let gaps = (self.widths.len().max(1) - 1) as f32;
        self.widths.iter().sum::<f32>() + gaps * self.gap
    }

    /// Left ends of the columns.
    fn lefts(&self) -> impl Iterator<Item = f32> + '_ {
        self.widths.iter().scan(0.0, |left, width| {
            let own = *left;
            *left += width + self.gap;
            Some(own)
        })
    }

    fn head(&self, ui: &mut Ui) {
        let palette = theme::palette(ui);
        let columns = &self.table.columns;
        let height = self.size * ROW_HEIGHT;
        if columns.iter().any(|column| column.group.is_some()) {
            let (rect, _) = ui.allocate_exact_size(vec2(self.width(), height), Sense::hover());
            let mut idx = 0;
            while idx < columns.len() {
                let num = columns[idx..].iter().take_while(|column| column.group == columns[idx].group).count();
                if let Some(group) = &columns[idx].group {
                    let left = rect.left() + self.lefts().nth(idx).unwrap_or(0.0);
                    let last = idx + num - 1;
                    let right = rect.left() + self.lefts().nth(last).unwrap_or(0.0) + self.widths[last];
                    let middle = pos2(f32::midpoint(left, right), rect.center().y);
                    ui.painter().text(middle, Align2::CENTER_CENTER, group, font(self.size, false), palette.text_dim);
                    ui.painter().hline(left..=right, rect.bottom() - 1.0, Stroke::new(1.0, palette.hairline));
                }
                idx += num;
            }
        }
        let titles: Vec<Cell> = columns.iter().map(|column| Cell::words(heading(column))).collect();
        self.cells(ui, &titles, palette.text_dim);
        let (line, _) = ui.allocate_exact_size(vec2(self.width(), 3.0), Sense::hover());
        ui.painter().hline(line.x_range(), line.top(), Stroke::new(1.0, palette.text_dim));
    }

    fn row(&self, ui: &mut Ui, cells: &[Cell]) {
        self.cells(ui, cells, theme::palette(ui).text);
    }

    /// Cells beside each other, as high as the highest; read as one line.
    fn cells(&self, ui: &mut Ui, cells: &[Cell], color: Color32) {
        let galleys: Vec<Arc<Galley>> = (cells.iter().zip(&self.widths))
            .map(|(cell, width)| {
                let font = font(self.size, cell.is_strong);
                ui.painter().layout(cell.text.clone(), font, color, width + 0.5)
            })
            .collect();
        let padding = self.size * (ROW_HEIGHT - 1.25);
        let height = galleys.iter().map(|galley| galley.size().y).fold(self.size * 1.25, f32::max) + padding;
        let (rect, response) = ui.allocate_exact_size(vec2(self.width(), height), Sense::hover());
        response.widget_info(|| {
            let words: Vec<&str> = cells.iter().map(|cell| cell.text.as_str()).collect();
            WidgetInfo::labeled(Role::Label, true, words.join(", "))
        });
        for ((left, width), (galley, column)) in
            self.lefts().zip(&self.widths).zip(galleys.into_iter().zip(&self.table.columns))
        {
            let place = Rect::from_min_size(rect.min + vec2(left, padding / 2.0), vec2(*width, rect.height()));
            let x = if column.is_number { place.right() - galley.size().x } else { place.left() };
            ui.painter().galley(pos2(x, place.top()), galley, color);
        }
    }
}

fn heading(column: &Column) -> String {
    match column.unit {
        Some(unit) => format!("{} / {unit}", column.title),
        None => column.title.clone(),
    }
}

fn font(size: f32, is_strong: bool) -> FontId {
    if is_strong { FontId::new(size, theme::strong_font().family) } else { FontId::proportional(size) }
}

fn width_of(ui: &Ui, text: &str, font: &FontId) -> f32 {
    ui.painter().layout_no_wrap(text.to_owned(), font.clone(), Color32::PLACEHOLDER).size().x.ceil()
}
