//! The rows and buttons that the cards of the panel are made of.

use egui::{Button, CollapsingHeader, Color32, DragValue, Label, Response, RichText, Role, Ui, WidgetInfo, vec2};

use crate::ui::{theme, widgets};

use super::model::Lamp;

/// Height of what a gloved hand presses, points.
pub const TALL: f32 = 36.0;

/// A row with a number: its label is also its name. Answers whether it was changed.
pub fn number_row(ui: &mut Ui, label: &str, hint: &str, field: DragValue<'_>) -> bool {
    widgets::split_row(ui, label, |ui| number(ui, label, hint, field))
}

/// A field for a number; answers whether it was changed.
pub fn number(ui: &mut Ui, name: &str, hint: &str, field: DragValue<'_>) -> bool {
    ui.spacing_mut().interact_size = vec2(72.0, 22.0);
    ui.spacing_mut().button_padding.x = 6.0;
    // Half a number is none: it counts once it was entered or left.
    let mut response = ui.add(field.update_while_editing(false));
    if !hint.is_empty() {
        response = response.on_hover_text(hint);
    }
    response.widget_info(|| WidgetInfo::labeled(Role::SpinButton, true, name));
    response.changed()
}

/// A lamp with its word: every state has a shape of its own.
pub fn lamp(ui: &mut Ui, lamp: Lamp, word: &str, name: &str) {
    let palette = theme::palette(ui);
    let (shape, color) = match lamp {
        Lamp::Off => ("○", palette.text_dim),
        Lamp::Waiting => ("◌", palette.text_dim),
        Lamp::Good => ("●", palette.good),
        Lamp::Look => ("▲", palette.warn),
        Lamp::Bad => ("✖", palette.bad),
    };
    let response = ui.label(RichText::new(format!("{shape} {word}")).color(color));
    response.widget_info(|| WidgetInfo::labeled(Role::Label, true, format!("{name}: {word}")));
}

/// A button for a gloved hand, that says why where it cannot be pressed.
pub fn tall_button(ui: &mut Ui, label: &str, name: &str, hint: &str, refusal: Option<&str>) -> bool {
    let button = Button::new(label).min_size(vec2(0.0, TALL));
    let mut response = ui.add_enabled(refusal.is_none(), button);
    response.widget_info(|| WidgetInfo::labeled(Role::Button, refusal.is_none(), name));
    response = match refusal {
        Some(reason) => response.on_disabled_hover_text(reason),
        None if hint.is_empty() => response,
        None => response.on_hover_text(hint),
    };
    response.clicked()
}

/// A filled button for a gloved hand.
pub fn filled_button(
    ui: &mut Ui,
    label: &str,
    name: &str,
    fill: Color32,
    size: egui::Vec2,
    is_enabled: bool,
) -> Response {
    let palette = theme::palette(ui);
    let (fill, text) = if is_enabled { (fill, palette.on_accent) } else { (palette.hovered, palette.text_dim) };
    let button = Button::new(theme::strong(label).color(text)).fill(fill).stroke((0.0, fill)).min_size(size);
    let response = ui.add_enabled(is_enabled, button);
    response.widget_info(|| WidgetInfo::labeled(Role::Button, is_enabled, name));
    response
}

/// A sentence in the dimmer tone, wrapped.
pub fn hint(ui: &mut Ui, sentence: &str) {
    let words = theme::dim(ui, sentence).size(theme::SMALL_SIZE);
    ui.add(Label::new(words).wrap());
}

/// A sentence with a mark that says how it is meant.
pub fn remark(ui: &mut Ui, mark: &str, sentence: &str, color: Color32) {
    ui.add(Label::new(RichText::new(format!("{mark} {sentence}")).color(color)).wrap());
}

/// A section that folds; while it is folded, a short summary stands at its right.
pub fn section(ui: &mut Ui, title: &str, summary: &str, is_open: Option<bool>, body: impl FnOnce(&mut Ui)) {
    let shown = CollapsingHeader::new(theme::strong(title))
        .id_salt(("capture settings", title))
        .open(is_open)
        .show_unindented(ui, |ui| {
            ui.spacing_mut().item_spacing.y = 0.0;
            body(ui);
            ui.add_space(8.0);
        });
    if shown.openness < 0.5 {
        let header = shown.header_response.rect;
        let right = egui::pos2(ui.max_rect().right(), header.center().y);
        let font = egui::FontId::proportional(theme::SMALL_SIZE);
        let color = theme::palette(ui).text_dim;
        let room = right.x - header.left() - 110.0;
        let job = egui::text::LayoutJob {
            wrap: egui::text::TextWrapping::truncate_at_width(room.max(0.0)),
            ..egui::text::LayoutJob::simple_singleline(summary.to_owned(), font, color)
        };
        let galley = ui.painter().layout_job(job);
        let at = egui::pos2(right.x - galley.size().x, right.y - galley.size().y / 2.0);
        ui.painter().galley(at, galley, color);
    }
}
