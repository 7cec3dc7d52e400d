//! The safety strip: what to do next, the arm switch with the limits that hold, and stop.

use egui::{
    Align, Color32, CornerRadius, Frame, Label, Layout, Margin, Role, Sense, Stroke, StrokeKind, Ui, UiBuilder,
    WidgetInfo, vec2,
};

use crate::app::cell::CellCommand;
use crate::device::LinkState;
use crate::text::capture as words;
use crate::ui::widgets::fixed;
use crate::ui::{theme, widgets};

use super::fields::{Number, TALL, filled_button};
use super::model::{self, Lamp};
use super::next::{self, Deed};
use super::panel::Desk;

/// Height of the strip, points.
const HEIGHT: f32 = 72.0;
/// Height of its buttons, points.
const BUTTON_HEIGHT: f32 = 48.0;
/// Width of the arm switch, points.
const SWITCH_WIDTH: f32 = 236.0;
/// Width of the stop button, points.
const STOP_WIDTH: f32 = 112.0;
/// Width of the field for a ball's radius, points.
const RADIUS_WIDTH: f32 = 96.0;
/// Red of the stop button in both themes.
const STOP_RED: Color32 = Color32::from_rgb(0xc6, 0x28, 0x1e);

/// Shows the strip.
pub fn show(ui: &mut Ui, desk: &mut Desk<'_>) {
    widgets::card_with_height(
        ui,
        "",
        HEIGHT,
        |_| {},
        |ui| {
            let inner = ui.max_rect().shrink2(vec2(theme::GAP, (HEIGHT - 2.0 - BUTTON_HEIGHT) / 2.0));
            let mut row = ui.new_child(UiBuilder::new().max_rect(inner).layout(Layout::right_to_left(Align::Center)));
            row.spacing_mut().item_spacing.x = theme::GAP;
            stop(&mut row, desk);
            switch(&mut row, desk);
            row.with_layout(Layout::left_to_right(Align::Center), |ui| next_thing(ui, desk));
        },
    );
}

fn stop(ui: &mut Ui, desk: &mut Desk<'_>) {
    let cell = desk.view.cell;
    // A robot that is connected may be moving although no routine knows of it.
    let can_stop = model::may_be_moving(cell) || cell.robot.state != LinkState::Off;
    if stop_button(ui, vec2(STOP_WIDTH, BUTTON_HEIGHT), words::STOP, can_stop) {
        desk.ask(CellCommand::Stop);
    }
}

/// The red button; answers whether it was pressed.
pub fn stop_button(ui: &mut Ui, size: egui::Vec2, label: &str, can_stop: bool) -> bool {
    let palette = theme::palette(ui);
    let (fill, color) = if can_stop { (STOP_RED, Color32::WHITE) } else { (palette.hovered, palette.text_dim) };
    let is_large = size.y >= BUTTON_HEIGHT;
    let text = if is_large { theme::heading(label) } else { theme::strong(label) };
    let button = egui::Button::new(text.color(color)).fill(fill).stroke((0.0, fill)).min_size(size);
    let response = ui.add_enabled(can_stop, button);
    response.widget_info(|| WidgetInfo::labeled(Role::Button, can_stop, label));
    response.on_hover_text(words::STOP_HINT).clicked()
}

/// A switch that shows its state in words and shape, with the limits that hold below.
fn switch(ui: &mut Ui, desk: &mut Desk<'_>) {
    let cell = desk.view.cell;
    let is_armed = cell.is_armed;
    let refusal = model::refusal(&desk.view, &CellCommand::Arm(!is_armed));
    let (rect, response) = ui.allocate_exact_size(vec2(SWITCH_WIDTH, BUTTON_HEIGHT), Sense::click());
    response.widget_info(|| WidgetInfo::selected(Role::CheckBox, refusal.is_none(), is_armed, words::ARM));
    let palette = theme::palette(ui);
    let painter = ui.painter();
    let color = if is_armed { palette.warn } else { palette.text_dim };
    let border = if response.hovered() || response.has_focus() || is_armed { color } else { palette.hairline };
    let fill = if is_armed { palette.warn.gamma_multiply(0.10) } else { palette.surface };
    let radius = CornerRadius::same(theme::RADIUS);
    painter.rect(rect, radius, fill, Stroke::new(if is_armed { 2.0 } else { 1.0 }, border), StrokeKind::Inside);
    let slot = egui::Rect::from_center_size(rect.left_center() + vec2(30.0, 0.0), vec2(38.0, 22.0));
    painter.rect(slot, 11.0, if is_armed { color } else { palette.hairline }, Stroke::NONE, StrokeKind::Inside);
    let knob = slot.center() + vec2(if is_armed { 8.0 } else { -8.0 }, 0.0);
    painter.circle_filled(knob, 8.0, palette.surface);
    let text_color = if refusal.is_some() && !is_armed { palette.text_dim } else { palette.text };
    let state = if is_armed { words::ARMED } else { words::NOT_ARMED };
    let left = slot.right() + 10.0;
    let at = |y: f32| egui::pos2(left, rect.center().y + y);
    painter.text(
        at(-9.0),
        egui::Align2::LEFT_CENTER,
        state,
        theme::strong_font(),
        if is_armed { color } else { text_color },
    );
    let limits = &cell.settings.limits;
    let limits_words = words::limits(&fixed(limits.max_speed_mm_s, 0), &fixed(limits.max_move_mm, 0));
    let font = egui::FontId::proportional(theme::SMALL_SIZE);
    painter.text(at(9.0), egui::Align2::LEFT_CENTER, limits_words, font, palette.text_dim);
    let hint = refusal.unwrap_or(if limits.workspace.is_some() { words::ARM_HINT_BOX } else { words::ARM_HINT });
    if response.on_hover_text(hint).clicked() && refusal.is_none() {
        desk.ask(CellCommand::Arm(!is_armed));
    }
}

/// What to do next.
fn next_thing(ui: &mut Ui, desk: &mut Desk<'_>) {
    let next = next::next(&desk.view, desk.memory);
    let mut chosen = None;
    if let Some((label, deed)) = next.button {
        let name = words::next_button(label);
        let accent = theme::palette(ui).accent;
        if filled_button(ui, label, &name, accent, vec2(0.0, BUTTON_HEIGHT), true).clicked() {
            chosen = Some(deed.clone());
        }
        if deed == Deed::NewSession {
            let radius = &mut desk.state.radius_mm;
            let field = Number::new(radius, 0.5..=500.0, " mm", 0.1).decimals(4).prefix("R ").width(RADIUS_WIDTH);
            desk.state.fields.number(ui, words::BALL_RADIUS, words::BALL_RADIUS_HINT, field);
            desk.state.fields.remarks(ui, |name| name == words::BALL_RADIUS);
        }
    }
    if let Some((label, deed)) = next.other
        && ui.add(egui::Button::new(label).min_size(vec2(0.0, TALL))).clicked()
    {
        chosen = Some(deed);
    }
    let is_failed = model::lamp(&desk.view.cell.robot.state).0 == Lamp::Bad
        || model::lamp(&desk.view.cell.sensor.state).0 == Lamp::Bad;
    let color = if is_failed { theme::palette(ui).bad } else { theme::palette(ui).text };
    let sentence = egui::RichText::new(next.sentence).color(color);
    Frame::new().inner_margin(Margin::ZERO).show(ui, |ui| ui.add(Label::new(sentence).wrap()));
    if let Some(deed) = chosen {
        desk.carry_out(deed);
    }
}
