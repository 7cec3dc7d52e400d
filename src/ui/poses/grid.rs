//! The grid: head, row heads and cells, painted for the rows in sight only, and what the pointer does on it.

use egui::scroll_area::ScrollSource;
use egui::{
    Align2, CursorIcon, FontId, Id, Pos2, Rangef, Rect, Role, ScrollArea, Sense, Stroke, StrokeKind, TextStyle, Ui,
    UiBuilder, WidgetInfo, pos2, vec2,
};

use crate::app::{Command, Document};
use crate::session::table::Column;
use crate::session::{Row, Target};
use crate::text::conventions::poses_title;
use crate::text::poses as words;
use crate::ui::theme::{self, Palette, ROW_HEIGHT};

use super::ask::Ask;
use super::checks::Checks;
use super::editor::{CELL_PADDING, ChoiceAnswer};
use super::sheet::Sheet;
use super::view::Layout;

/// Width of the row heads, points.
pub(super) const GUTTER_WIDTH: f32 = 40.0;
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
pub(super) struct Geometry {
    pub layout: Layout,
    /// Left edges of the columns and of the check, and the right border, from the left of the contents.
    pub edges: Vec<f32>,
    /// Of the contents, scrolled.
    pub origin: Pos2,
    viewport: Rect,
}

impl Geometry {
    pub fn column_range(&self, column: usize) -> Rangef {
        Rangef::new(self.origin.x + self.edges[column], self.origin.x + self.edges[column + 1])
    }

    pub fn row_range(&self, row: usize) -> Rangef {
        #[expect(clippy::cast_precision_loss, reason = "rows are some thousands")]
        let top = self.origin.y + row as f32 * ROW_HEIGHT;
        Rangef::new(top, top + ROW_HEIGHT)
    }

    /// The check stays in sight while the columns scroll behind it.
    pub fn check_range(&self) -> Rangef {
        let num_columns = self.edges.len() - 2;
        let natural = self.column_range(num_columns);
        let left = natural.min.min(self.viewport.right() - SCROLL_BAR_ROOM - natural.span());
        Rangef::new(left, self.viewport.right())
    }

    pub fn cell(&self, row: usize, column: usize) -> Rect {
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
pub(super) struct Ink {
    pub palette: &'static Palette,
    pub body: FontId,
    pub small: FontId,
    pub number: FontId,
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
                self.checks(ui, sheet, &geometry, &ink);
                ui.set_clip_rect(ui.clip_rect().with_max_x(geometry.check_range().min.min(ui.clip_rect().right())));
                self.body(ui, sheet, &geometry, &ink, commands);
                if std::mem::take(&mut sheet.brings_into_view) && num_rows > 0 {
                    // Clear of the check.
                    let mut cell = geometry.cell(sheet.cursor.row, sheet.cursor.column);
                    cell.max.x += layout.widths.last().copied().unwrap_or_default() + SCROLL_BAR_ROOM;
                    ui.scroll_to_rect(cell, None);
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
        let title = poses_title(&self.document.session.robot.notation);
        response.widget_info(|| WidgetInfo::labeled(Role::Grid, true, title));
        let (position, is_pressed, modifiers) =
            ui.input(|input| (input.pointer.interact_pos(), input.pointer.primary_pressed(), input.modifiers));
        // A quick click is over within the frame in which it began.
        let is_on_grid = response.is_pointer_button_down_on() || response.clicked();
        let Some(position) = position.filter(|_| is_on_grid || response.double_clicked()) else { return };
        if num_rows == 0 {
            return;
        }
        let row = geometry.row_at(position.y, num_rows);
        let column = geometry.column_at(position.x, num_columns);
        if is_pressed && is_on_grid {
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
            Self::rules(ui, sheet, geometry, ink, first, last);
        }
        if num_rows == 0 {
            let at = geometry.viewport.center() - vec2(0.0, ROW_HEIGHT);
            let is_sequence =
                sheet.view.session.as_ref().is_some_and(|session| matches!(session.target, Target::Rgbd { .. }));
            let [empty, hint] = if is_sequence {
                [words::NO_POSES_OF_SEQUENCE, words::POSES_OF_SEQUENCE]
            } else {
                [words::EMPTY, words::NO_STATIONS]
            };
            ui.painter().text(at, Align2::CENTER_BOTTOM, empty, ink.body.clone(), ink.palette.text);
            let hint = hint.to_owned();
            // The check column stands over the others, so there is less room than the grid is wide.
            let clip = ui.clip_rect();
            let width = 2.0 * ((clip.right() - at.x).min(at.x - clip.left()) - theme::GAP).max(0.0);
            let galley = ui.painter().layout(hint, ink.small.clone(), ink.palette.text_dim, width);
            let rect = Align2::CENTER_TOP.anchor_size(at + vec2(0.0, 4.0), galley.size());
            ui.painter().galley(rect.min, galley, ink.palette.text_dim);
        }
        self.cursor(ui, sheet, geometry, ink);
        Self::editor(ui, sheet, geometry, commands);
    }

    fn checks(&self, ui: &Ui, sheet: &Sheet, geometry: &Geometry, ink: &Ink) {
        let num_rows = sheet.view.rows.len();
        let Some(last) = num_rows.checked_sub(1) else { return };
        let first = geometry.row_at(geometry.viewport.top(), num_rows);
        let last = geometry.row_at(geometry.viewport.bottom(), num_rows).min(last);
        let hairline = Stroke::new(1.0, ink.palette.hairline);
        let range = geometry.check_range();
        for row in first..=last {
            let rect = Rect::from_x_y_ranges(range, geometry.row_range(row));
            self.check(ui, sheet, rect, sheet.view.rows[row], &self.document.session, ink);
            ui.painter().hline(rect.x_range(), rect.bottom(), hairline);
        }
        let rows = Rangef::new(geometry.row_range(first).min, geometry.row_range(last).max);
        ui.painter().vline(range.min, rows, hairline);
    }

    /// The hairlines between columns, once for all rows.
    fn rules(ui: &Ui, sheet: &Sheet, geometry: &Geometry, ink: &Ink, first: usize, last: usize) {
        let hairline = Stroke::new(1.0, ink.palette.hairline);
        let range = Rangef::new(geometry.row_range(first).min, geometry.row_range(last).max);
        for edge in &geometry.edges[..=sheet.view.columns.len()] {
            ui.painter().vline(geometry.origin.x + edge, range, hairline);
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

    fn editor(ui: &mut Ui, sheet: &mut Sheet, geometry: &Geometry, commands: &mut Vec<Command>) {
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
        let check_width = layout.widths.last().copied().unwrap_or_default();
        let check_left =
            (rect.left() + edges[num_columns] - offset_x).min(rect.right() - SCROLL_BAR_ROOM - check_width);
        let columns = rect.with_max_x(check_left);
        let mut clicked = None;
        for (idx, column) in sheet.view.columns.iter().copied().enumerate() {
            let left = rect.left() + edges[idx] - offset_x;
            let cell = Rect::from_min_size(pos2(left, rect.top()), vec2(layout.widths[idx], rect.height()));
            let seen = cell.intersect(columns);
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
            clip.vline(cell.left(), rect.y_range(), Stroke::new(1.0, palette.hairline));
            response.widget_info(|| WidgetInfo::labeled(Role::ColumnHeader, true, words::sort_by(&head)));
            if response.on_hover_text(words::SORT_HINT).clicked() {
                clicked = Some(column);
            }
        }
        painter.vline(check_left, rect.y_range(), Stroke::new(1.0, palette.hairline));
        let at = pos2(check_left + f32::from(CELL_PADDING), rect.center().y);
        painter.text(at, Align2::LEFT_CENTER, words::CHECK, ink.small.clone(), palette.text_dim);
        if let Some(column) = clicked {
            sheet.ask(ui.ctx(), self.document, Ask::Sort(column), commands);
            sheet.takes_keyboard = true;
        }
    }
}

/// Room at the right for the scroll bar, points.
const SCROLL_BAR_ROOM: f32 = 10.0;

/// The name of a cell for egui.
pub(super) fn cell_id(row: Row, column: Column) -> Id {
    Id::unique("pose cell").with((row, column))
}
