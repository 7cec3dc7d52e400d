//! Numbers: tabular figures, right-aligned.

use egui::{
    Align, FontSelection, Label, Layout, Response, RichText, Sense, TextWrapMode, Ui, UiBuilder, WidgetText, vec2,
};

use crate::ui::theme;

pub use crate::text::typeset::{fixed, signed};

/// `text` in tabular figures.
pub fn number_text(text: impl Into<String>) -> RichText {
    RichText::new(text).font(theme::number_font())
}

/// A right-aligned label in tabular figures that fills the width available, with a small margin at its right.
pub fn number(ui: &mut Ui, text: impl Into<String>) -> Response {
    ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
        ui.add_space(4.0);
        // Set, so that a selected row does not recolour it.
        ui.label(number_text(text).color(theme::palette(ui).text))
    })
    .inner
}

/// A row of a list of figures: a dim label at the left, the value in tabular figures at the right.
pub fn value_row(ui: &mut Ui, label: &str, value: impl Into<String>) -> Response {
    split_row(ui, label, |ui| ui.add(Label::new(number_text(value)).truncate()))
}

/// A row of a list: a dim label at the left, and what `right` puts there, from right to left.
pub fn split_row<R>(ui: &mut Ui, label: &str, right: impl FnOnce(&mut Ui) -> R) -> R {
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), theme::ROW_HEIGHT), Sense::hover());
    let child = |rect, layout| UiBuilder::new().max_rect(rect).layout(layout);
    // The right side has what the label leaves to it: neither is cut as long as there is room for both.
    let galley = WidgetText::from(theme::dim(ui, label)).into_galley(
        ui,
        Some(TextWrapMode::Extend),
        f32::INFINITY,
        FontSelection::Default,
    );
    let left_width = (galley.size().x + LABEL_GAP).min(rect.width() * MOST_LABEL_PART);
    let mut right_side =
        ui.new_child(child(rect.with_min_x(rect.left() + left_width), Layout::right_to_left(Align::Center)));
    let answer = right(&mut right_side);
    // The value is never covered: a label without room is cut, and shows in full on hover.
    let free = rect.with_max_x((right_side.min_rect().left() - LABEL_GAP).max(rect.left()));
    let mut left_side = ui.new_child(child(free, Layout::left_to_right(Align::Center)));
    left_side.add(Label::new(theme::dim(ui, label)).truncate());
    answer
}

/// Least gap between a row's label and what stands at its right, points.
const LABEL_GAP: f32 = 4.0;
/// The part of a row that its label takes at most before the right side has what it needs.
const MOST_LABEL_PART: f32 = 0.6;
