//! The pose table: the card around the grid, and the way between its state, the window and the document.

use egui::{Align, Id, Key, Label, Layout, Modifiers, Ui, UiBuilder, vec2};

use crate::app::{Command, Document, Workbench};
use crate::calibrate::Method;
use crate::session::Place;
use crate::session::table::has_cell;
use crate::text::conventions::poses_title;
use crate::text::poses as words;
use crate::ui::widgets::card_with_height;
use crate::ui::{PanelContext, import, theme};

use super::checks::Checks;
use super::convention::{self, ConventionState};
use super::cursor::Cursor;
use super::grid::Grid;
use super::keys::{self, Keyboard};
use super::sheet::Sheet;
use super::toolbar;

/// Height of the line with the buttons, points.
const TOOLBAR_HEIGHT: f32 = 32.0;
/// Height of the line below the table, points.
const LINE_HEIGHT: f32 = 28.0;

/// The state of the step.
#[derive(Debug, Default)]
pub struct PosesState {
    convention: ConventionState,
    sheet: Sheet,
    checks: Checks,
    keyboard: Keyboard,
    /// The station and capture that the window looked at when the table last was drawn.
    seen: Option<Place>,
}

impl PosesState {
    /// Number of cells with a text that could not be read and so is not in the session.
    #[must_use]
    pub fn num_unread(&self, workbench: &Workbench) -> usize {
        workbench.document().map_or(0, |document| self.sheet.pending.count(&document.session))
    }

    /// Number of stations to look at, and of texts that are not in the session, for the rail.
    pub fn num_remarks(&mut self, workbench: &Workbench, method: Method) -> usize {
        let Some(document) = workbench.document() else { return 0 };
        self.checks.refresh(workbench, method);
        self.checks.num_stations(&document.session) + self.num_unread(workbench)
    }
}

/// Draws the step.
pub fn show(ui: &mut Ui, context: &mut PanelContext<'_>, state: &mut PosesState) {
    let Some(document) = context.workbench.document() else { return };
    state.sheet.refresh(document);
    state.sheet.carry_out_asked(ui.ctx(), document, context.commands);
    let num_commands = context.commands.len();
    convention::bar(ui, context, &mut state.convention);
    if context.commands.len() > num_commands {
        // A number is read in the notation in which it was typed.
        let changes = context.commands.split_off(num_commands);
        state.sheet.commit(context.commands);
        context.commands.extend(changes);
    }
    if document.session.target.is_pose() && document.session.stations.is_empty() {
        import::no_pairs(ui, context.actions);
        return;
    }
    show_table(ui, context, document, state);
}

fn show_table(ui: &mut Ui, context: &mut PanelContext<'_>, document: &Document, state: &mut PosesState) {
    let PosesState { sheet, checks, keyboard, seen, .. } = state;
    checks.refresh(context.workbench, context.selection.method);
    let id = Id::unique("pose table");
    follow_selection(context, sheet, *seen);
    let has_focus = take_keys(ui, id, sheet, keyboard, document, context.commands);
    let (has_sweeps, is_all_unfolded) = (sheet.view.num_sweeps() > 0, sheet.view.is_all_unfolded());
    let mut folds_all = false;
    let height = ui.available_height();
    card_with_height(
        ui,
        poses_title(&document.session.robot.notation),
        height,
        |ui| {
            folds_all = has_sweeps && toolbar::fold_button(ui, is_all_unfolded);
            let stations = &document.session.stations;
            let num_enabled = stations.iter().filter(|station| station.enabled).count();
            ui.label(theme::dim(ui, words::usage(num_enabled, stations.len())));
        },
        |ui| {
            ui.spacing_mut().item_spacing.y = 0.0;
            let width = ui.available_width();
            ui.allocate_ui_with_layout(vec2(width, TOOLBAR_HEIGHT), Layout::left_to_right(Align::Center), |ui| {
                ui.set_min_size(vec2(width, TOOLBAR_HEIGHT));
                ui.add_space(8.0);
                sheet.takes_keyboard |= toolbar::show(ui, sheet, document, context.commands);
            });
            let area = ui.available_rect_before_wrap();
            let (table, line) = area.split_top_bottom_at_y(area.bottom() - LINE_HEIGHT);
            let mut inside = ui.new_child(UiBuilder::new().max_rect(table));
            Grid { document, checks, id, has_focus }.show(&mut inside, sheet, context.commands);
            let mut inside = ui.new_child(UiBuilder::new().max_rect(line).layout(Layout::left_to_right(Align::Center)));
            show_line(&mut inside, sheet, document);
            ui.advance_cursor_after_rect(area);
        },
    );
    if folds_all {
        sheet.fold_all(!is_all_unfolded);
    }
    sheet.takes_keyboard |= keyboard.end_editor(sheet, context.commands);
    // Last of all, as a click anywhere but on the grid itself takes the keyboard away from it.
    if std::mem::take(&mut sheet.takes_keyboard) {
        ui.memory_mut(|memory| memory.request_focus(id));
        ui.ctx().request_repaint();
    }
    *seen = tell_selection(context, sheet);
}

/// Gives the table what was pressed, if it has the keyboard. Without it, the arrows take it.
fn take_keys(
    ui: &Ui,
    id: Id,
    sheet: &mut Sheet,
    keyboard: &mut Keyboard,
    document: &Document,
    commands: &mut Vec<Command>,
) -> bool {
    let has_focus = ui.memory(|memory| memory.has_focus(id));
    if has_focus || sheet.editor.is_some() {
        keys::lock_focus(ui.ctx(), id);
        keyboard.handle(ui, sheet, document, commands);
        return true;
    }
    if ui.ctx().egui_wants_keyboard_input() {
        return false;
    }
    let arrows = [Key::ArrowUp, Key::ArrowDown, Key::ArrowLeft, Key::ArrowRight];
    let is_wanted = ui.input(|input| {
        let takes = |key: &Key| input.modifiers == Modifiers::NONE && input.key_pressed(*key);
        arrows.iter().any(takes)
    });
    if is_wanted {
        ui.memory_mut(|memory| memory.request_focus(id));
        keyboard.handle(ui, sheet, document, commands);
    }
    is_wanted
}

/// The cursor goes to the row of what the user looks at elsewhere.
fn follow_selection(context: &PanelContext<'_>, sheet: &mut Sheet, seen: Option<Place>) {
    let selection = &context.selection;
    let place = Place { station_idx: selection.station_idx, capture_idx: selection.capture_idx };
    if seen != Some(place)
        && let Some(row) = sheet.view.row_of(place)
        && sheet.cursor.row != row
    {
        sheet.cursor = Cursor::at(row, sheet.cursor.column);
        sheet.brings_into_view = true;
    }
}

/// The user looks at the row of the cursor. A folded sweep stands for whichever of its captures was looked at.
fn tell_selection(context: &mut PanelContext<'_>, sheet: &Sheet) -> Option<Place> {
    let (row, _) = sheet.cell()?;
    let selection = &mut *context.selection;
    let present = Place { station_idx: selection.station_idx, capture_idx: selection.capture_idx };
    if sheet.view.row_of(present) != Some(sheet.cursor.row) {
        let place = row.place();
        (selection.station_idx, selection.capture_idx) = (place.station_idx, place.capture_idx);
    }
    Some(Place { station_idx: selection.station_idx, capture_idx: selection.capture_idx })
}

/// The line below the table: why the cell under the cursor is not in the document, or what was just done.
fn show_line(ui: &mut Ui, sheet: &mut Sheet, document: &Document) {
    let palette = theme::palette(ui);
    let session = &document.session;
    ui.painter().hline(ui.max_rect().x_range(), ui.max_rect().top(), (1.0, palette.hairline));
    ui.set_max_width(ui.available_width() - theme::GAP);
    ui.add_space(theme::GAP);
    let num_waiting = sheet.pending.count(session);
    let here = sheet.cell().filter(|(row, column)| has_cell(session, *row, *column));
    let waiting = here.and_then(|(row, column)| sheet.pending.get(session, row.place(), column));
    if let Some(waiting) = waiting {
        ui.label(egui::RichText::new("!").color(palette.bad));
        ui.add(Label::new(words::not_taken(&waiting.text, &waiting.reason)).truncate());
    } else if let Some(said) = &sheet.said {
        ui.add(Label::new(theme::dim(ui, said)).truncate());
    } else if num_waiting > 0 {
        ui.label(egui::RichText::new("!").color(palette.bad));
        ui.label(words::refused_cells(num_waiting));
        if ui.small_button(words::GO_THERE).clicked()
            && let Some((place, column)) = sheet.pending.first(session)
        {
            sheet.go_to(place, column);
        }
    } else {
        ui.add(Label::new(theme::dim(ui, words::KEYS_HINT).small()).truncate());
    }
}
