//! The list of edits, those made and those undone, to go to any of them.

use egui::{Context, Role, ScrollArea, Sense, Ui, WidgetInfo, Window, pos2, vec2};

use crate::app::{Command, Workbench};
use crate::session::History;
use crate::text::document as words;

use super::theme;

/// Width of the window, points.
const WIDTH: f32 = 320.0;
/// Room left at the window's right, where the inspector is, points.
const BESIDE_INSPECTOR: f32 = 376.0;
/// Height of the list at most, points.
const MAX_HEIGHT: f32 = 20.0 * theme::ROW_HEIGHT;

/// The window with the list; it stays open while one works.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct HistoryWindow {
    /// Whether it is shown.
    pub is_open: bool,
    /// The place in the history that was last brought into view, with the number of steps.
    seen: Option<(usize, usize)>,
    /// The place in the history to go to with the next frame, when the document has what was being typed.
    target: Option<usize>,
}

impl HistoryWindow {
    /// Shows the window if it is open.
    pub fn show(&mut self, ctx: &Context, workbench: &Workbench, commands: &mut Vec<Command>) {
        let Some(document) = workbench.document() else {
            self.is_open = false;
            return;
        };
        let mut is_open = self.is_open;
        let corner = ctx.content_rect().right_top() + vec2(-WIDTH - BESIDE_INSPECTOR, 56.0);
        Window::new(theme::strong(words::HISTORY).size(theme::BODY_SIZE))
            .open(&mut is_open)
            .resizable(false)
            .collapsible(false)
            .default_pos(pos2(corner.x.max(16.0), corner.y))
            .show(ctx, |ui| {
                ui.set_width(WIDTH);
                self.steps(ui, &document.history, commands);
            });
        self.is_open = is_open;
    }

    fn steps(&mut self, ui: &mut Ui, history: &History, commands: &mut Vec<Command>) {
        let target = self.target.take();
        let present = history.undo_labels().len();
        let num_steps = present + history.redo_labels().len();
        if let Some(steps) = target.filter(|idx| *idx <= num_steps).and_then(|idx| idx.checked_signed_diff(present))
            && steps != 0
        {
            commands.push(Command::StepHistory(steps));
        }
        if num_steps == 0 {
            ui.label(theme::dim(ui, words::NO_HISTORY));
            return;
        }
        let is_moved = self.seen.replace((present, num_steps)) != Some((present, num_steps));
        let start = if history.is_complete() { words::AS_OPENED } else { words::OLDER_FORGOTTEN };
        let labels = std::iter::once(start).chain(history.undo_labels()).chain(history.redo_labels());
        ScrollArea::vertical().max_height(MAX_HEIGHT).auto_shrink([false, true]).show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = 0.0;
            for (idx, label) in labels.enumerate() {
                if step(ui, label, idx, present, is_moved) {
                    self.target = Some(idx);
                    ui.ctx().request_repaint();
                }
            }
        });
        ui.add_space(8.0);
        ui.label(theme::dim(ui, words::HISTORY_HINT).small());
    }
}

/// A row; answers whether it was clicked. What was undone is dimmer, and the present state has an arrow.
fn step(ui: &mut Ui, label: &str, idx: usize, present: usize, is_moved: bool) -> bool {
    let palette = theme::palette(ui);
    let is_present = idx == present;
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), theme::ROW_HEIGHT), Sense::click());
    response
        .widget_info(|| WidgetInfo::selected(Role::Button, true, is_present, words::history_step(label, is_present)));
    if is_present && is_moved {
        response.scroll_to_me(None);
    }
    if ui.is_rect_visible(rect) {
        if is_present || response.hovered() || response.has_focus() {
            let ground = if is_present { palette.selected } else { palette.hovered };
            ui.painter().rect_filled(rect, theme::RADIUS, ground);
        }
        let middle = rect.left_center();
        if is_present {
            ui.painter().text(
                middle + vec2(8.0, 0.0),
                egui::Align2::LEFT_CENTER,
                "▶",
                egui::FontId::proportional(9.0),
                palette.accent,
            );
        }
        let color = if idx > present { palette.text_dim } else { palette.text };
        let text = if is_present { theme::strong(label) } else { egui::RichText::new(label) };
        let room = rect.with_min_x(rect.left() + 24.0).with_max_x(rect.right() - 8.0);
        let mut inside = ui
            .new_child(egui::UiBuilder::new().max_rect(room).layout(egui::Layout::left_to_right(egui::Align::Center)));
        inside.add(egui::Label::new(text.color(color)).truncate().selectable(false));
    }
    response.clicked() && !is_present
}
