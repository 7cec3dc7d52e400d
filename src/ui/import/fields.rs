//! Rows of the import's settings: a label at the left, and a list, a switch or numbers beside it.

use egui::{Align, ComboBox, Label, Layout, Role, Sense, TextEdit, Ui, UiBuilder, WidgetInfo, vec2};

use crate::session::table::number::parse_number;
use crate::text::import as words;
use crate::ui::{theme, widgets};

/// Width of the labels, points.
const LABEL_WIDTH: f32 = 104.0;
/// Room for a mark before a sentence, points.
const MARK_WIDTH: f32 = 12.0;
/// Height of a line below a row, points.
const REMARK_HEIGHT: f32 = 16.0;
/// Height of a row with a control, points.
pub const CONTROL_HEIGHT: f32 = 28.0;

/// A row with a control that fills it beside its label.
pub fn row<R>(ui: &mut Ui, label: &str, control: impl FnOnce(&mut Ui) -> R) -> R {
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), CONTROL_HEIGHT), Sense::hover());
    let child = |rect| UiBuilder::new().max_rect(rect).layout(Layout::left_to_right(Align::Center));
    let split = rect.left() + LABEL_WIDTH;
    ui.new_child(child(rect.with_max_x(split))).add(Label::new(theme::dim(ui, label)).truncate());
    control(&mut ui.new_child(child(rect.with_min_x(split))))
}

/// A row with a list of which one entry is chosen; answers another one that was picked.
pub fn row_choice<T: Copy + PartialEq>(
    ui: &mut Ui,
    label: &str,
    current: T,
    choices: &[T],
    text: impl Fn(T) -> String,
) -> Option<T> {
    row(ui, label, |ui| choice(ui, &words::setting(label), current, choices, text))
}

/// A list of which one entry is chosen; answers another one that was picked.
pub fn choice<T: Copy + PartialEq>(
    ui: &mut Ui,
    name: &str,
    current: T,
    choices: &[T],
    text: impl Fn(T) -> String,
) -> Option<T> {
    let width = ui.available_width();
    list(ui, name, &text(current), width, |ui| {
        let mut picked = None;
        for &choice in choices {
            if ui.selectable_label(choice == current, text(choice)).clicked() && choice != current {
                picked = Some(choice);
            }
        }
        picked
    })
}

/// A list named `name` that shows `text`; `entries` draws what it offers.
pub fn list<R>(
    ui: &mut Ui,
    name: &str,
    text: &str,
    width: f32,
    entries: impl FnOnce(&mut Ui) -> Option<R>,
) -> Option<R> {
    let combo = ComboBox::from_id_salt(name).selected_text(text).width(width).height(420.0).truncate();
    let shown = combo.show_ui(ui, |ui| {
        ui.set_min_width(width.max(176.0));
        entries(ui)
    });
    shown.response.widget_info(|| {
        let mut info = WidgetInfo::labeled(Role::ComboBox, ui.is_enabled(), name);
        info.current_text_value = Some(text.to_owned());
        info
    });
    shown.inner.flatten()
}

/// A text field named `name`.
pub fn text_field(ui: &mut Ui, name: &str, hint: &str, text: &mut String, width: f32) -> egui::Response {
    let field = TextEdit::singleline(text).hint_text(hint).margin(vec2(8.0, 5.0)).desired_width(width);
    let response = ui.add(field);
    let text = text.clone();
    response.widget_info(|| {
        let mut info = WidgetInfo::text_edit(ui.is_enabled(), "", &text, hint);
        info.label = Some(name.to_owned());
        info
    });
    response
}

/// Between the fields of numbers, points.
const NUMBER_GAP: f32 = 8.0;

/// Six numbers of a frame as they are being typed: three lengths and three angles.
#[derive(Clone, Debug, Default)]
pub struct SixNumbers {
    texts: [String; 6],
    shown: Option<[f64; 6]>,
}

impl SixNumbers {
    /// Draws them, two rows of three; answers all six once one was changed to a number. What is no number stays as it
    /// was typed, and says why.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        names: &[String; 6],
        frame: impl Fn(&str) -> String,
        values: [f64; 6],
    ) -> Option<[f64; 6]> {
        if self.shown != Some(values) {
            self.shown = Some(values);
            self.texts = values.map(as_typed);
        }
        let mut has_ended = false;
        let mut refusal = None;
        let width = (ui.available_width() - 2.0 * NUMBER_GAP) / 3.0;
        for (names, texts) in names.chunks(3).zip(self.texts.chunks_mut(3)) {
            ui.horizontal(|ui| {
                ui.spacing_mut().item_spacing.x = NUMBER_GAP;
                for (name, text) in names.iter().zip(texts) {
                    ui.vertical(|ui| {
                        ui.spacing_mut().item_spacing.y = 2.0;
                        ui.label(theme::dim(ui, name).small());
                        let field = text_field(ui, &frame(name), "", text, width);
                        has_ended |= field.lost_focus();
                    });
                }
            });
        }
        let mut numbers = values;
        for (text, number) in self.texts.iter().zip(&mut numbers) {
            match parse_number(text) {
                Ok(value) => *number = value,
                Err(problem) => refusal = refusal.or(Some(problem)),
            }
        }
        if let Some(refusal) = refusal {
            ui.label(egui::RichText::new(format!("! {refusal}")).color(theme::palette(ui).warn).small());
            return None;
        }
        (has_ended && numbers.map(f64::to_bits) != values.map(f64::to_bits)).then(|| {
            self.shown = Some(numbers);
            numbers
        })
    }
}

/// A number without the digits that rounding has put behind it.
fn as_typed(value: f64) -> String {
    let text = format!("{value:.6}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

/// A heading among the settings.
pub fn heading(ui: &mut Ui, text: &str) {
    ui.add_space(8.0);
    ui.label(theme::strong(text));
}

/// A dim line below a row, in line with its control.
pub fn remark(ui: &mut Ui, text: &str) {
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), REMARK_HEIGHT), Sense::hover());
    let beside = rect.with_min_x(rect.left() + LABEL_WIDTH);
    let text = Label::new(theme::dim(ui, text).small()).truncate();
    ui.new_child(UiBuilder::new().max_rect(beside).layout(Layout::left_to_right(Align::Center))).add(text);
}

/// A sentence with a mark before it, wrapped beside it.
pub fn marked(ui: &mut Ui, mark: &str, color: egui::Color32, sentence: &str) {
    ui.horizontal_top(|ui| {
        let (rect, _) = ui.allocate_exact_size(vec2(MARK_WIDTH, REMARK_HEIGHT), Sense::hover());
        let in_rect = UiBuilder::new().max_rect(rect).layout(Layout::left_to_right(Align::Min));
        ui.new_child(in_rect).label(egui::RichText::new(mark).color(color));
        ui.add(Label::new(widgets::number_text(sentence)).wrap());
    });
}

#[cfg(test)]
mod tests {
    use super::as_typed;

    #[test]
    fn numbers_are_shown_as_people_type_them() {
        for (value, text) in [(150.0, "150"), (-0.25, "-0.25"), (1e-12, "0"), (-1e-12, "0"), (0.1 + 0.2, "0.3")] {
            assert_eq!(as_typed(value), text);
        }
    }
}
