//! The state machine of the search, drawn as in the paper's Fig. 3: the box where the search is lights up.

use std::sync::Arc;

use egui::{
    Align, Align2, Color32, CornerRadius, FontId, Galley, Layout, Pos2, Rect, Role, Sense, Stroke, StrokeKind, Ui,
    WidgetInfo, pos2, vec2,
};

use crate::device::{SearchEnd, SearchPhase};
use crate::text::capture as words;
use crate::ui::widgets::{card_with_height, fixed};
use crate::ui::{charts, theme};

use super::model::{BoxState, PHASES, boxes};
use super::panel::Desk;

/// Height of the card, points.
pub const HEIGHT: f32 = 124.0;
/// Height of a box, points.
const BOX_HEIGHT: f32 = 44.0;
/// Gap between two boxes, points: room for an arrow.
const GAP: f32 = 22.0;

/// Shows the card.
pub fn show(ui: &mut Ui, desk: &Desk<'_>) {
    let search = desk.view.cell.search.as_deref();
    let is_past = desk.view.cell.is_search_past();
    let right = |ui: &mut Ui| {
        let Some(search) = search else { return };
        if is_past {
            ui.label(theme::dim(ui, words::LAST_STATION));
            return;
        }
        let travelled_mm = search.points.last().map_or(0.0, |point| point.travelled_mm);
        let words = words::search_progress(search.points.len(), &fixed(travelled_mm, 2));
        ui.label(theme::dim(ui, words));
    };
    card_with_height(ui, words::SEARCH, HEIGHT, right, |ui| {
        if is_past {
            ui.multiply_opacity(theme::PAST_OPACITY);
        }
        let states = boxes(search);
        let area = ui.available_rect_before_wrap().shrink2(vec2(theme::GAP, 0.0));
        let row = Rect::from_min_size(area.min + vec2(0.0, 10.0), vec2(area.width(), BOX_HEIGHT));
        paint(ui, row, states);
        let line = Rect::from_min_max(pos2(area.left(), row.bottom() + 6.0), area.max);
        let mut inside = ui.new_child(egui::UiBuilder::new().max_rect(line).layout(Layout::left_to_right(Align::Min)));
        end_line(&mut inside, search.and_then(|search| search.end.as_ref()));
        ui.advance_cursor_after_rect(area);
    });
}

/// Why the search ended, in the words of the ending itself.
fn end_line(ui: &mut Ui, end: Option<&SearchEnd>) {
    let Some(end) = end else { return };
    let palette = theme::palette(ui);
    let (mark, color) = if end.is_found() { ("✔", palette.good) } else { ("!", palette.warn) };
    let words = words::sentence(&end.to_string());
    ui.colored_label(color, mark);
    let line = egui::Label::new(egui::RichText::new(&words)).truncate();
    ui.add(line);
}

#[expect(clippy::cast_precision_loss, reason = "six boxes")]
fn paint(ui: &mut Ui, row: Rect, states: [BoxState; 6]) {
    let width = (row.width() - GAP * (PHASES.len() - 1) as f32) / PHASES.len() as f32;
    let rects: [Rect; 6] = std::array::from_fn(|idx| {
        Rect::from_min_size(pos2(row.left() + (width + GAP) * idx as f32, row.top()), vec2(width, row.height()))
    });
    // Where not all have room for what they do, the titles say enough.
    let font = FontId::proportional(theme::SMALL_SIZE);
    let does = PHASES.map(|phase| {
        ui.painter().layout_no_wrap(words::phase_does(phase).to_owned(), font.clone(), Color32::PLACEHOLDER)
    });
    let has_room = does.iter().all(|does| does.size().x < width - 8.0);
    for ((rect, does), (phase, state)) in rects.into_iter().zip(does).zip(PHASES.into_iter().zip(states)) {
        paint_box(ui, rect, phase, state, has_room.then_some(does));
    }
    let palette = theme::palette(ui);
    let stroke = Stroke::new(1.2, palette.text_dim);
    let arrow = |from: Pos2, to: Pos2| charts::arrow(ui.painter(), from, to, stroke);
    for pair in rects.windows(2) {
        arrow(pair[0].right_center() + vec2(3.0, 0.0), pair[1].left_center() - vec2(3.0, 0.0));
    }
    // R₂ > R₁: past the reversing box, along its upper side.
    let [_, probe, reverse, climb, ..] = rects;
    let y = reverse.top() - 5.0;
    let corners = [pos2(probe.center().x, probe.top()), pos2(probe.center().x, y), pos2(climb.center().x, y)];
    ui.painter().line(corners.to_vec(), stroke);
    arrow(pos2(climb.center().x, y), pos2(climb.center().x, climb.top()));
}

fn paint_box(ui: &mut Ui, rect: Rect, phase: SearchPhase, state: BoxState, does: Option<Arc<Galley>>) {
    let palette = theme::palette(ui);
    let title = if state == BoxState::GaveUp { words::NOT_FOUND } else { words::phase(phase) };
    let (fill, border, color) = match state {
        BoxState::Ahead => (palette.surface, palette.hairline, palette.text_dim),
        BoxState::Now => (palette.accent, palette.accent, palette.on_accent),
        BoxState::Done => (palette.selected, palette.accent, palette.text),
        BoxState::Found => (palette.good.gamma_multiply(0.16), palette.good, palette.good),
        BoxState::GaveUp => (palette.warn.gamma_multiply(0.14), palette.warn, palette.warn),
    };
    let mark = match state {
        BoxState::Done | BoxState::Found => "✔ ",
        BoxState::GaveUp => "! ",
        BoxState::Ahead | BoxState::Now => "",
    };
    let spoken = match state {
        BoxState::Ahead => words::PHASE_AHEAD,
        BoxState::Now => words::PHASE_NOW,
        BoxState::Done | BoxState::Found | BoxState::GaveUp => words::PHASE_DONE,
    };
    let response = ui.interact(rect, ui.scope_id().with(words::phase(phase)), Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(Role::Label, true, words::phase_name(title, spoken)));
    let painter = ui.painter().with_clip_rect(rect.intersect(ui.clip_rect()));
    painter.rect(rect, CornerRadius::same(theme::RADIUS), fill, Stroke::new(1.0, border), StrokeKind::Inside);
    let center = rect.center();
    let up = if does.is_some() { 8.0 } else { 0.0 };
    painter.text(center - vec2(0.0, up), Align2::CENTER_CENTER, format!("{mark}{title}"), theme::strong_font(), color);
    if let Some(does) = does {
        let dim = if state == BoxState::Now { palette.on_accent } else { palette.text_dim };
        painter.galley(center + vec2(-does.size().x / 2.0, 10.0 - does.size().y / 2.0), does, dim);
    }
}
