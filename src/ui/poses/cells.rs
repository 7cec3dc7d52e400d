//! The rows of the grid: their heads, their cells and what the check says of them.

use egui::{Align2, Color32, Id, Rangef, Rect, Response, Role, Sense, Stroke, Ui, UiBuilder, WidgetInfo, pos2, vec2};

use crate::app::Command;
use crate::session::edit::shown_numbers;
use crate::session::table::{self, Column, has_cell};
use crate::session::{Row, Session};
use crate::text::poses as words;
use crate::ui::widgets::{fixed, named_checkbox, symbol_button};

use super::checks::Note;
use super::cursor::Cursor;
use super::editor::CELL_PADDING;
use super::grid::{GUTTER_WIDTH, Geometry, Grid, Ink, cell_id};
use super::sheet::Sheet;

/// Size of the fold triangle, points.
const FOLD_WIDTH: f32 = 20.0;

/// Notes that a tip lists before the rest is only counted.
const MAX_LISTED_NOTES: usize = 5;
impl Grid<'_> {
    /// Draws a row.
    pub(super) fn row(
        &self,
        ui: &mut Ui,
        sheet: &mut Sheet,
        geometry: &Geometry,
        ink: &Ink,
        row_idx: usize,
        commands: &mut Vec<Command>,
    ) {
        let session = &self.document.session;
        let row = sheet.view.rows[row_idx];
        let place = row.place();
        let Some(station) = session.stations.get(place.station_idx) else { return };
        let Some(capture) = station.captures.get(place.capture_idx) else { return };
        let palette = ink.palette;
        let painter = ui.painter().clone();
        let num_columns = sheet.view.columns.len();
        let range = geometry.row_range(row_idx);
        let full = Rect::from_x_y_ranges(
            Rangef::new(geometry.origin.x, geometry.origin.x + geometry.edges[num_columns + 1]),
            range,
        );
        let is_selected = sheet.cursor.has_row(row_idx);
        if is_selected {
            let selected = sheet.cursor.columns(num_columns);
            let left = geometry.column_range(*selected.start()).min;
            let right = geometry.column_range(*selected.end()).max;
            if !sheet.cursor.is_single() {
                painter.rect_filled(Rect::from_x_y_ranges(Rangef::new(left, right), range), 0.0, palette.selected);
            }
        }
        let gutter = full.with_max_x(geometry.origin.x + GUTTER_WIDTH);
        painter.rect_filled(gutter, 0.0, if is_selected { palette.selected } else { palette.canvas });
        painter.hline(ui.clip_rect().x_range(), range.max, Stroke::new(1.0, palette.hairline));
        let numbers = shown_numbers(capture, &session.robot.notation);
        let name = match row {
            Row::Station(_) => station.label.clone(),
            Row::Capture(place) => words::capture_name(&station.label, place.capture_idx + 1),
        };
        self.gutter(ui, sheet, gutter, ink, row, is_selected);
        for column_idx in 0..num_columns {
            let column = sheet.view.columns[column_idx];
            let rect = geometry.cell(row_idx, column_idx);
            if !ui.is_rect_visible(rect) {
                continue;
            }
            let is_own = has_cell(session, row, column);
            let waiting = sheet.pending.get(session, place, column).filter(|_| is_own);
            // The pose of a folded sweep is that of its first capture: no cell of its own, but a figure like any other.
            let is_faded = !station.enabled || !is_own && matches!(row, Row::Capture(_));
            let color = if is_faded { palette.text_dim } else { palette.text };
            let mut tip = waiting.map(|waiting| waiting.reason.clone());
            let text = match (waiting, column) {
                (Some(waiting), _) => waiting.text.clone(),
                (None, Column::Used) => {
                    if is_own && checkbox(ui, rect, station.enabled, &station.label) {
                        if !sheet.cursor.has_row(row_idx) {
                            sheet.cursor = Cursor::at(row_idx, column_idx);
                        }
                        sheet.use_rows(session, !station.enabled, commands);
                        sheet.takes_keyboard = true;
                    }
                    continue;
                }
                (None, Column::Label) => match row {
                    Row::Station(_) => name.clone(),
                    Row::Capture(_) => words::capture_of(capture_number(row)),
                },
                (None, Column::Side) if is_own => words::side(station.side).to_owned(),
                (None, Column::Edge) if is_own => station.edge.map_or("", table::edge_text).to_owned(),
                (None, Column::Number(idx)) if is_own || !sheet.view.is_unfolded(&station.label) => {
                    if !is_own {
                        tip = Some(words::FIRST_OF_SWEEP.to_owned());
                    }
                    numbers
                        .get(idx)
                        .map_or_else(String::new, |value| fixed(*value, geometry.layout.decimals[column_idx]))
                }
                (None, Column::Step | Column::Point(_)) if is_own => table::number(session, place, column)
                    .map_or_else(String::new, |value| fixed(value, geometry.layout.decimals[column_idx])),
                _ => String::new(),
            };
            let color = if waiting.is_some() {
                painter.rect_filled(rect.shrink2(vec2(0.5, 0.5)), 0.0, palette.bad.gamma_multiply(0.12));
                let mark = pos2(rect.left() + 3.0, rect.center().y);
                painter.text(mark, Align2::LEFT_CENTER, "!", ink.small.clone(), palette.bad);
                palette.bad
            } else {
                color
            };
            let cell_response = cell_text(ui, rect, column, &text, color, ink, cell_id(row, column));
            cell_response.widget_info(|| {
                let mut info =
                    WidgetInfo::labeled(Role::Cell, true, words::cell_name(&session.robot.notation, column, &name));
                info.current_text_value = Some(text.clone());
                info
            });
            if let Some(tip) = tip {
                cell_response.on_hover_text(tip);
            }
            if column == Column::Label && matches!(row, Row::Station(_)) && station.captures.len() > 1 {
                sweep_mark(ui, rect, station.captures.len(), ink);
            }
        }
    }

    fn gutter(&self, ui: &mut Ui, sheet: &mut Sheet, rect: Rect, ink: &Ink, row: Row, is_selected: bool) {
        let Row::Station(station_idx) = row else { return };
        let station = &self.document.session.stations[station_idx];
        let color = if is_selected { ink.palette.accent } else { ink.palette.text_dim };
        let right = pos2(rect.right() - 6.0, rect.center().y);
        ui.painter().text(right, Align2::RIGHT_CENTER, station_idx + 1, ink.small.clone(), color);
        let response = ui.interact(rect, cell_id(row, Column::Label).with("row head"), Sense::hover());
        response.widget_info(|| WidgetInfo::labeled(Role::RowHeader, true, words::row_head(&station.label)));
        if station.captures.len() > 1 {
            let (symbol, name) = if sheet.view.is_unfolded(&station.label) {
                ("▾", words::fold_station(&station.label))
            } else {
                ("▸", words::unfold_station(&station.label))
            };
            let fold = Rect::from_min_size(rect.min, vec2(FOLD_WIDTH, rect.height())).shrink(2.0);
            let mut inside = ui.new_child(UiBuilder::new().max_rect(fold));
            inside.spacing_mut().button_padding = vec2(2.0, 0.0);
            inside.spacing_mut().interact_size = fold.size();
            if symbol_button(&mut inside, symbol, &name).clicked() {
                sheet.folds = Some(station.label.clone());
            }
        }
    }

    /// Draws what the check says of a row.
    pub(super) fn check(&self, ui: &Ui, sheet: &Sheet, rect: Rect, row: Row, session: &Session, ink: &Ink) {
        let place = row.place();
        let station = &session.stations[place.station_idx];
        let palette = ink.palette;
        let notes = self.checks.of_station(place.station_idx);
        let is_about = |note: &&Note| match row {
            Row::Station(_) => true,
            Row::Capture(place) => note.capture_idx == Some(place.capture_idx),
        };
        let mut shown: Vec<&Note> = notes.iter().filter(is_about).collect();
        shown.truncate(MAX_LISTED_NOTES);
        let waiting: Vec<&str> = match row {
            Row::Station(_) if !sheet.pending.is_empty() => {
                sheet.pending.reasons(&station.label).map(|(_, reason)| reason).collect()
            }
            _ => Vec::new(),
        };
        let num_notes = notes.iter().filter(is_about).count();
        let (text, color, mut tip) = if let Some(reason) = waiting.first() {
            (words::waiting(reason, waiting.len()), palette.bad, waiting.join("\n"))
        } else if !station.enabled {
            ("–".to_owned(), palette.text_dim, words::LEFT_OUT.to_owned())
        } else if let Some(note) = shown.first() {
            (words::check_mark(&note.word, num_notes), palette.warn, String::new())
        } else if matches!(row, Row::Station(_)) {
            ("✔".to_owned(), palette.good, words::FINE.to_owned())
        } else {
            (String::new(), palette.text_dim, String::new())
        };
        for note in &shown {
            if !tip.is_empty() {
                tip.push('\n');
            }
            tip.push_str(&note.sentence);
        }
        if num_notes > shown.len() {
            tip.push('\n');
            tip.push_str(&words::more_notes(num_notes - shown.len()));
        }
        let left = pos2(rect.left() + f32::from(CELL_PADDING), rect.center().y);
        let clip = rect.intersect(ui.clip_rect());
        ui.painter().with_clip_rect(clip).text(left, Align2::LEFT_CENTER, &text, ink.body.clone(), color);
        let id = Id::unique("pose check").with(row);
        let response = ui.interact(rect, id, Sense::hover());
        response.widget_info(|| {
            let mut info = WidgetInfo::labeled(Role::Cell, true, words::check_of(&station.label, row));
            info.current_text_value = Some(tip.clone());
            info
        });
        if !tip.is_empty() {
            response.on_hover_text(tip);
        }
    }
}

fn sweep_mark(ui: &Ui, rect: Rect, num_captures: usize, ink: &Ink) {
    let right = pos2(rect.right() - f32::from(CELL_PADDING), rect.center().y);
    let text = words::num_captures(num_captures);
    ui.painter().with_clip_rect(rect.intersect(ui.clip_rect())).text(
        right,
        Align2::RIGHT_CENTER,
        text,
        ink.small.clone(),
        ink.palette.text_dim,
    );
}

const fn capture_number(row: Row) -> usize {
    row.place().capture_idx + 1
}

fn checkbox(ui: &mut Ui, rect: Rect, is_enabled: bool, label: &str) -> bool {
    let mut is_checked = is_enabled;
    let box_rect = Rect::from_center_size(rect.center(), vec2(ui.spacing().icon_width, rect.height()));
    let mut inside = ui.new_child(UiBuilder::new().max_rect(box_rect));
    inside.spacing_mut().interact_size = vec2(0.0, rect.height());
    inside.spacing_mut().button_padding = vec2(0.0, 0.0);
    named_checkbox(&mut inside, &mut is_checked, &words::use_station(label)).changed()
}

fn cell_text(ui: &Ui, rect: Rect, column: Column, text: &str, color: Color32, ink: &Ink, id: Id) -> Response {
    let pad = f32::from(CELL_PADDING);
    let painter = ui.painter().with_clip_rect(rect.intersect(ui.clip_rect()));
    let is_cut = rect.right() > ui.clip_rect().right() + 1.0 || rect.left() < ui.clip_rect().left() - 1.0;
    if column.is_number() && is_cut && !text.is_empty() {
        // Half a number would be another one.
        let seen = rect.intersect(ui.clip_rect());
        painter.text(seen.center(), Align2::CENTER_CENTER, "…", ink.body.clone(), ink.palette.text_dim);
    } else if column.is_number() {
        let at = pos2(rect.right() - pad, rect.center().y);
        painter.text(at, Align2::RIGHT_CENTER, text, ink.number.clone(), color);
    } else {
        let at = pos2(rect.left() + pad, rect.center().y);
        painter.text(at, Align2::LEFT_CENTER, text, ink.body.clone(), color);
    }
    ui.interact(rect, id, Sense::hover())
}
