//! The grid: head, row heads and cells, painted for the rows in sight only, and what the pointer does on it.

use egui::scroll_area::ScrollSource;
use egui::{
    Align2, Color32, CursorIcon, FontId, Id, Pos2, Rangef, Rect, Response, Role, ScrollArea, Sense, Stroke, StrokeKind,
    TextStyle, Ui, UiBuilder, WidgetInfo, pos2, vec2,
};

use crate::app::{Command, Document};
use crate::session::edit::shown_numbers;
use crate::session::table::{Column, has_cell};
use crate::session::{Row, Session};
use crate::text::poses as words;
use crate::ui::theme::{self, Palette, ROW_HEIGHT};
use crate::ui::widgets::{fixed, named_checkbox, symbol_button};

use super::checks::{Checks, Note};
use super::editor::{CELL_PADDING, ChoiceAnswer};
use super::sheet::Sheet;
use super::view::Layout;

/// Width of the row heads, points.
const GUTTER_WIDTH: f32 = 40.0;
/// Size of the fold triangle, points.
const FOLD_WIDTH: f32 = 20.0;

/// What the grid needs besides its state.
pub struct Grid<'a> {
    /// The document.
    pub document: &'a Document,
    /// What there is to look at.
    pub checks: &'a Checks,
    /// The name under which it has the keyboard.
    pub id: Id,
    /// Whether it has the keyboard.
    pub has_focus: bool,
}

/// Where things are in this frame.
struct Geometry {
    layout: Layout,
    /// Left edges of the columns and of the check, and the right border, from the left of the contents.
    edges: Vec<f32>,
    /// Of the contents, scrolled.
    origin: Pos2,
    viewport: Rect,
}

impl Geometry {
    fn column_range(&self, column: usize) -> Rangef {
        Rangef::new(self.origin.x + self.edges[column], self.origin.x + self.edges[column + 1])
    }

    fn row_range(&self, row: usize) -> Rangef {
        #[expect(clippy::cast_precision_loss, reason = "rows are some thousands")]
        let top = self.origin.y + row as f32 * ROW_HEIGHT;
        Rangef::new(top, top + ROW_HEIGHT)
    }

    fn cell(&self, row: usize, column: usize) -> Rect {
        Rect::from_x_y_ranges(self.column_range(column), self.row_range(row))
    }

    fn row_at(&self, y: f32, num_rows: usize) -> usize {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "not negative")]
        let row = ((y - self.origin.y) / ROW_HEIGHT).max(0.0) as usize;
        row.min(num_rows.saturating_sub(1))
    }

    /// `None` over the row heads.
    fn column_at(&self, x: f32, num_columns: usize) -> Option<usize> {
        let x = x - self.origin.x;
        (x >= GUTTER_WIDTH).then(|| {
            (0..num_columns).find(|column| x < self.edges[column + 1]).unwrap_or(num_columns.saturating_sub(1))
        })
    }
}

/// Fonts and colours, looked up once a frame.
struct Ink {
    palette: &'static Palette,
    body: FontId,
    small: FontId,
    number: FontId,
}

impl Grid<'_> {
    /// Draws the grid in what room there is.
    pub fn show(&self, ui: &mut Ui, sheet: &mut Sheet, commands: &mut Vec<Command>) {
        let area = ui.available_rect_before_wrap();
        let (head, body) = area.split_top_bottom_at_y(area.top() + ROW_HEIGHT);
        let layout = sheet.view.layout(area.width() - GUTTER_WIDTH - SCROLL_BAR_ROOM);
        let mut edges = vec![GUTTER_WIDTH];
        for width in &layout.widths {
            edges.push(edges.last().copied().unwrap_or(GUTTER_WIDTH) + width);
        }
        let full_width = edges.last().copied().unwrap_or(GUTTER_WIDTH);
        let ink = Ink {
            palette: theme::palette(ui),
            body: TextStyle::Body.resolve(ui.style()),
            small: TextStyle::Small.resolve(ui.style()),
            number: theme::number_font(),
        };
        let num_rows = sheet.view.rows.len();
        let mut below = ui.new_child(UiBuilder::new().max_rect(body));
        let source = ScrollSource { drag: egui::containers::scroll_area::DragScroll::Never, ..ScrollSource::default() };
        let shown = ScrollArea::both().id_salt("pose grid").auto_shrink(false).scroll_source(source).show_viewport(
            &mut below,
            |ui, viewport| {
                #[expect(clippy::cast_precision_loss, reason = "rows are some thousands")]
                let size = vec2(full_width, num_rows as f32 * ROW_HEIGHT + 1.0);
                let (contents, _) = ui.allocate_exact_size(size, Sense::hover());
                let geometry = Geometry {
                    layout: layout.clone(),
                    edges: edges.clone(),
                    origin: contents.min,
                    viewport: viewport.translate(contents.min.to_vec2()),
                };
                self.pointer(ui, sheet, &geometry, commands);
                self.body(ui, sheet, &geometry, &ink, commands);
                if std::mem::take(&mut sheet.brings_into_view) && num_rows > 0 {
                    ui.scroll_to_rect(geometry.cell(sheet.cursor.row, sheet.cursor.column), None);
                }
            },
        );
        // Not before the rows are drawn, which it changes.
        if let Some(label) = sheet.folds.take() {
            sheet.fold(&label);
        }
        let offset_x = shown.state.clamped_offset().x;
        self.head(ui, sheet, &layout, &edges, head, offset_x, &ink, commands);
        ui.advance_cursor_after_rect(area);
    }

    fn pointer(&self, ui: &Ui, sheet: &mut Sheet, geometry: &Geometry, commands: &mut Vec<Command>) {
        let (num_rows, num_columns) = (sheet.view.rows.len(), sheet.view.columns.len());
        let response = ui.interact(ui.clip_rect(), self.id, Sense::click_and_drag());
        response.widget_info(|| WidgetInfo::labeled(Role::Grid, true, words::TITLE));
        let (position, is_pressed, modifiers) =
            ui.input(|input| (input.pointer.interact_pos(), input.pointer.primary_pressed(), input.modifiers));
        let Some(position) = position.filter(|_| response.is_pointer_button_down_on() || response.double_clicked())
        else {
            return;
        };
        if num_rows == 0 {
            return;
        }
        let row = geometry.row_at(position.y, num_rows);
        let column = geometry.column_at(position.x, num_columns);
        if is_pressed && response.is_pointer_button_down_on() {
            sheet.commit(commands);
            sheet.said = None;
            sheet.choice = None;
            ui.memory_mut(|memory| memory.request_focus(self.id));
            match column {
                _ if modifiers.command => sheet.cursor.toggle_row(row),
                None if modifiers.shift => sheet.cursor.extend_rows_to(row),
                None => sheet.cursor = super::cursor::Cursor::over_rows(&(row..=row), sheet.cursor.column),
                Some(column) => sheet.cursor.go_to(row, column, modifiers.shift),
            }
        } else if response.dragged() && !modifiers.command {
            if sheet.cursor.has_whole_rows {
                sheet.cursor.extend_rows_to(row);
            } else if let Some(column) = column.or(Some(0)) {
                sheet.cursor.go_to(row, column, true);
            }
            sheet.brings_into_view = !geometry.viewport.contains(position);
        }
        if response.double_clicked() && column.is_some() {
            sheet.edit(self.document, None, commands);
        }
    }

    fn body(&self, ui: &mut Ui, sheet: &mut Sheet, geometry: &Geometry, ink: &Ink, commands: &mut Vec<Command>) {
        let num_rows = sheet.view.rows.len();
        if num_rows > 0 {
            let first = geometry.row_at(geometry.viewport.top(), num_rows);
            let last = geometry.row_at(geometry.viewport.bottom(), num_rows);
            for row in first..=last {
                self.row(ui, sheet, geometry, ink, row, commands);
            }
            self.rules(ui, sheet, geometry, ink, first, last);
        }
        self.cursor(ui, sheet, geometry, ink);
        self.editor(ui, sheet, geometry, commands);
    }

    /// The hairlines between columns, once for all rows.
    fn rules(&self, ui: &Ui, sheet: &Sheet, geometry: &Geometry, ink: &Ink, first: usize, last: usize) {
        let hairline = Stroke::new(1.0, ink.palette.hairline);
        let range = Rangef::new(geometry.row_range(first).min, geometry.row_range(last).max);
        for edge in &geometry.edges[..sheet.view.columns.len() + 1] {
            ui.painter().vline(geometry.origin.x + edge, range, hairline);
        }
    }

    fn row(
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
        painter.hline(full.x_range(), range.max, Stroke::new(1.0, palette.hairline));
        let numbers = shown_numbers(capture, &session.robot.notation);
        let name = match row {
            Row::Station(_) => station.label.clone(),
            Row::Capture(place) => words::capture_name(&station.label, place.capture_idx + 1),
        };
        self.gutter(ui, sheet, gutter, ink, row, &name, is_selected);
        for column_idx in 0..num_columns {
            let column = sheet.view.columns[column_idx];
            let rect = geometry.cell(row_idx, column_idx);
            if !ui.is_rect_visible(rect) {
                continue;
            }
            let is_own = has_cell(session, row, column);
            let waiting = sheet.pending.get(session, place, column).filter(|_| is_own);
            let is_faded = !station.enabled || !is_own;
            let color = if is_faded { palette.text_dim } else { palette.text };
            let mut tip = waiting.map(|waiting| waiting.reason.clone());
            let text = match (waiting, column) {
                (Some(waiting), _) => waiting.text.clone(),
                (None, Column::Used) => {
                    if is_own && checkbox(ui, rect, station.enabled, &station.label) {
                        if !sheet.cursor.has_row(row_idx) {
                            sheet.cursor = super::cursor::Cursor::at(row_idx, column_idx);
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
                (None, Column::Edge) if is_own => station.edge.map_or("", crate::session::table::edge_text).to_owned(),
                (None, Column::Number(idx)) if is_own || !sheet.view.is_unfolded(&station.label) => {
                    if !is_own {
                        tip = Some(words::FIRST_OF_SWEEP.to_owned());
                    }
                    numbers
                        .get(idx)
                        .map_or_else(String::new, |value| fixed(*value, geometry.layout.decimals[column_idx]))
                }
                (None, Column::Step | Column::Point(_)) if is_own => {
                    crate::session::table::number(session, place, column)
                        .map_or_else(String::new, |value| fixed(value, geometry.layout.decimals[column_idx]))
                }
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
                self.sweep_mark(ui, rect, station.captures.len(), ink);
            }
        }
        let check = geometry.cell(row_idx, num_columns);
        if ui.is_rect_visible(check) {
            self.check(ui, sheet, check, row, session, ink);
        }
    }

    fn gutter(&self, ui: &mut Ui, sheet: &mut Sheet, rect: Rect, ink: &Ink, row: Row, name: &str, is_selected: bool) {
        let Row::Station(station_idx) = row else { return };
        let station = &self.document.session.stations[station_idx];
        let color = if is_selected { ink.palette.accent } else { ink.palette.text_dim };
        let right = pos2(rect.right() - 6.0, rect.center().y);
        ui.painter().text(right, Align2::RIGHT_CENTER, station_idx + 1, ink.small.clone(), color);
        let response = ui.interact(rect, cell_id(row, Column::Label).with("row head"), Sense::hover());
        response.widget_info(|| WidgetInfo::labeled(Role::RowHeader, true, words::row_head(name)));
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

    fn sweep_mark(&self, ui: &Ui, rect: Rect, num_captures: usize, ink: &Ink) {
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

    fn check(&self, ui: &Ui, sheet: &Sheet, rect: Rect, row: Row, session: &Session, ink: &Ink) {
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

    fn cursor(&self, ui: &Ui, sheet: &Sheet, geometry: &Geometry, ink: &Ink) {
        if sheet.view.rows.is_empty() || sheet.view.columns.is_empty() {
            return;
        }
        let rect = geometry.cell(sheet.cursor.row, sheet.cursor.column);
        let (width, color) =
            if self.has_focus { (2.0, ink.palette.accent) } else { (1.0, ink.palette.accent.gamma_multiply(0.6)) };
        ui.painter().rect_stroke(rect, 0.0, Stroke::new(width, color), StrokeKind::Inside);
    }

    fn editor(&self, ui: &mut Ui, sheet: &mut Sheet, geometry: &Geometry, commands: &mut Vec<Command>) {
        let rect_of = |sheet: &Sheet, place, column| {
            let row = sheet.view.row_of(place)?;
            let column = sheet.view.columns.iter().position(|there| *there == column)?;
            Some((geometry.cell(row, column), cell_id(sheet.view.rows[row], sheet.view.columns[column])))
        };
        if let Some(mut editor) = sheet.editor.take() {
            let Some((rect, label_id)) = rect_of(sheet, editor.place, editor.column) else { return };
            let response = editor.show(ui, rect, label_id);
            sheet.editor = Some(editor);
            // A click elsewhere takes what was typed, as in every spreadsheet.
            if response.lost_focus() {
                sheet.commit(commands);
            }
        }
        if let Some(mut choice) = sheet.choice.take() {
            let Some((rect, _)) = rect_of(sheet, choice.place, choice.column) else { return };
            let answer = choice.show(ui.ctx(), rect, ui.layer_id());
            if answer != ChoiceAnswer::Closed {
                sheet.choice = Some(choice);
            }
            if answer == ChoiceAnswer::Taken {
                sheet.choose(commands);
                sheet.takes_keyboard = true;
            }
        }
    }

    #[expect(clippy::too_many_arguments, reason = "all of it is one frame's geometry")]
    fn head(
        &self,
        ui: &mut Ui,
        sheet: &mut Sheet,
        layout: &Layout,
        edges: &[f32],
        rect: Rect,
        offset_x: f32,
        ink: &Ink,
        commands: &mut Vec<Command>,
    ) {
        let palette = ink.palette;
        let session = &self.document.session;
        let painter = ui.painter().with_clip_rect(rect.intersect(ui.clip_rect()));
        painter.rect_filled(rect, 0.0, palette.canvas);
        painter.hline(rect.x_range(), rect.bottom(), Stroke::new(1.0, palette.hairline));
        let num_columns = sheet.view.columns.len();
        let selected = sheet.cursor.columns(num_columns);
        let mut clicked = None;
        for (idx, column) in sheet.view.columns.iter().copied().enumerate() {
            let left = rect.left() + edges[idx] - offset_x;
            let cell = Rect::from_min_size(pos2(left, rect.top()), vec2(layout.widths[idx], rect.height()));
            let seen = cell.intersect(rect);
            if !seen.is_positive() {
                continue;
            }
            let id = Id::unique("pose head").with(column);
            let response = ui.interact(seen, id, Sense::click()).on_hover_cursor(CursorIcon::PointingHand);
            let head = words::column_head(&session.robot.notation, column);
            let arrow = match sheet.view.sorted {
                Some((by, false)) if by == column => " ▲",
                Some((by, true)) if by == column => " ▼",
                _ => "",
            };
            let color = if selected.contains(&idx) && self.has_focus {
                palette.accent
            } else if response.hovered() {
                palette.text
            } else {
                palette.text_dim
            };
            let text = format!("{head}{arrow}");
            let clip = painter.with_clip_rect(seen);
            let pad = f32::from(CELL_PADDING);
            if column.is_number() {
                let at = pos2(cell.right() - pad, cell.center().y);
                clip.text(at, Align2::RIGHT_CENTER, text, ink.small.clone(), color);
            } else {
                let at = pos2(cell.left() + pad, cell.center().y);
                clip.text(at, Align2::LEFT_CENTER, text, ink.small.clone(), color);
            }
            painter.vline(cell.left(), rect.y_range(), Stroke::new(1.0, palette.hairline));
            response.widget_info(|| WidgetInfo::labeled(Role::ColumnHeader, true, words::sort_by(&head)));
            if response.on_hover_text(words::SORT_HINT).clicked() {
                clicked = Some(column);
            }
        }
        let check_left = rect.left() + edges[num_columns] - offset_x;
        painter.vline(check_left, rect.y_range(), Stroke::new(1.0, palette.hairline));
        let at = pos2(check_left + f32::from(CELL_PADDING), rect.center().y);
        painter.text(at, Align2::LEFT_CENTER, words::CHECK, ink.small.clone(), palette.text_dim);
        if let Some(column) = clicked {
            sheet.commit(commands);
            sheet.sort(session, column, commands);
            sheet.takes_keyboard = true;
        }
    }
}

/// Notes that a tip lists before the rest is only counted.
const MAX_LISTED_NOTES: usize = 5;
/// Room at the right for the scroll bar, points.
const SCROLL_BAR_ROOM: f32 = 10.0;

/// The name of a cell for egui.
fn cell_id(row: Row, column: Column) -> Id {
    Id::unique("pose cell").with((row, column))
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
    if column.is_number() {
        let at = pos2(rect.right() - pad, rect.center().y);
        painter.text(at, Align2::RIGHT_CENTER, text, ink.number.clone(), color);
    } else {
        let at = pos2(rect.left() + pad, rect.center().y);
        painter.text(at, Align2::LEFT_CENTER, text, ink.body.clone(), color);
    }
    ui.interact(rect, id, Sense::hover())
}
