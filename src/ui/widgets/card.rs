//! White cards with a header row, the frame of everything in the window.

use egui::{Align, Frame, Layout, Response, RichText, Sense, Stroke, TextWrapMode, Ui, UiBuilder, vec2};

use crate::ui::theme;

/// Height of a card's header row, points.
const HEADER_HEIGHT: f32 = 32.0;

/// A white card as wide as the space available: a header row with `title` and what `right` puts at its right end,
/// a hairline, then the body without margins, so that tables reach the borders. An empty title leaves the header out.
pub fn card<R>(ui: &mut Ui, title: &str, right: impl FnOnce(&mut Ui), body: impl FnOnce(&mut Ui) -> R) -> R {
    frame(ui)
        .show(ui, |ui| {
            ui.set_width(ui.available_width());
            contents(ui, title, right, body)
        })
        .inner
}

/// The same card, of a given height over all, points.
pub fn card_with_height<R>(
    ui: &mut Ui,
    title: &str,
    height: f32,
    right: impl FnOnce(&mut Ui),
    body: impl FnOnce(&mut Ui) -> R,
) -> R {
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), height), Sense::hover());
    ui.painter().add(frame(ui).paint(rect.shrink(1.0)));
    let mut inside = ui.new_child(UiBuilder::new().max_rect(rect.shrink(1.0)).layout(Layout::top_down(Align::Min)));
    inside.set_clip_rect(rect.intersect(ui.clip_rect()));
    contents(&mut inside, title, right, body)
}

fn frame(ui: &Ui) -> Frame {
    let palette = theme::palette(ui);
    Frame::new().fill(palette.surface).stroke(Stroke::new(1.0, palette.hairline)).corner_radius(theme::RADIUS)
}

fn contents<R>(ui: &mut Ui, title: &str, right: impl FnOnce(&mut Ui), body: impl FnOnce(&mut Ui) -> R) -> R {
    ui.spacing_mut().item_spacing.y = 0.0;
    if !title.is_empty() {
        heading_row(ui, theme::strong(title), right);
    }
    ui.scope(|ui| {
        ui.spacing_mut().item_spacing.y = 4.0;
        body(ui)
    })
    .inner
}

/// A card's header row: title, what stands at the right, and a hairline below.
fn heading_row(ui: &mut Ui, title: RichText, right: impl FnOnce(&mut Ui)) {
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), HEADER_HEIGHT), Sense::hover());
    let inner = rect.shrink2(vec2(theme::GAP, 0.0));
    let mut row = ui.new_child(UiBuilder::new().max_rect(inner).layout(Layout::left_to_right(Align::Center)));
    row.label(title);
    row.with_layout(Layout::right_to_left(Align::Center), |ui| {
        // In a narrow window it gives way to the title.
        ui.style_mut().wrap_mode = Some(TextWrapMode::Truncate);
        right(ui);
    });
    let stroke = Stroke::new(1.0, theme::palette(ui).hairline);
    ui.painter().hline(rect.x_range(), rect.bottom(), stroke);
    ui.add_space(1.0);
}

/// A small plain text, e.g. for the pose convention; `explanation` shows on hover.
pub fn chip(ui: &mut Ui, text: &str, explanation: &str) -> Response {
    ui.label(theme::dim(ui, text).size(theme::SMALL_SIZE)).on_hover_text(explanation)
}
