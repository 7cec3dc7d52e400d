//! The rows and buttons that the cards of the panel are made of.

use std::cell::Cell;
use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use egui::emath::Numeric;
use egui::{
    Button, CollapsingHeader, Color32, DragValue, Label, Response, RichText, Role, Stroke, Ui, WidgetInfo, vec2,
};

use crate::session::table::parse_number;
use crate::text::capture_settings as words;
use crate::ui::{theme, widgets};

use super::model::Lamp;

/// Height of what a gloved hand presses, points.
pub const TALL: f32 = 36.0;

/// Width of what stands at the right of a row of settings, points: the same for all, so that they make a column.
pub const FIELD_WIDTH: f32 = 124.0;
/// Height of such a field, points: less than the row's, so that there is a gap to the next.
pub const FIELD_HEIGHT: f32 = 22.0;

/// A number with what it may be.
pub struct Number<'a> {
    field: DragValue<'a>,
    value: f64,
    range: RangeInclusive<f64>,
    is_whole: bool,
    unit: &'static str,
    width: f32,
}

impl<'a> Number<'a> {
    /// In a range, with the change for a point of dragging.
    pub fn new<N: Numeric>(value: &'a mut N, range: RangeInclusive<f64>, unit: &'static str, speed: f64) -> Self {
        let now = value.to_f64();
        let field = DragValue::new(value).range(range.clone()).speed(speed).suffix(unit);
        Self { field, value: now, range, is_whole: N::INTEGRAL, unit, width: FIELD_WIDTH }
    }

    /// With no more decimals.
    pub fn decimals(self, most: usize) -> Self {
        Self { field: self.field.max_decimals(most), ..self }
    }

    /// With something before the number.
    pub fn prefix(self, prefix: &str) -> Self {
        Self { field: self.field.prefix(prefix), ..self }
    }

    /// Where a whole column is too wide.
    pub fn width(self, width: f32) -> Self {
        Self { width, ..self }
    }
}

/// What was typed into fields for numbers and could not be taken: it is said why, and what was there stays.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Fields {
    refused: BTreeMap<String, String>,
    /// The fields that something else is wrong with.
    marked: Vec<&'static str>,
    /// The field that is to be typed into next.
    asked_for: Option<&'static str>,
}

impl Fields {
    /// Marks these fields as well, from now on.
    pub fn mark(&mut self, marked: Vec<&'static str>) {
        self.marked = marked;
    }

    /// Puts the cursor into a field.
    pub const fn ask_for(&mut self, name: &'static str) {
        self.asked_for = Some(name);
    }

    /// Gives the cursor to the field of this name, if it was asked for.
    pub fn hand_over(&mut self, name: &str, field: &Response) {
        if self.asked_for == Some(name) {
            self.asked_for = None;
            field.request_focus();
        }
    }

    /// Why what was typed into the fields of some names was not taken, in sentences below each other.
    pub fn remarks(&self, ui: &mut Ui, is_of: impl Fn(&str) -> bool) {
        for (_, sentence) in self.refused.iter().filter(|(name, _)| is_of(name)) {
            remark(ui, "✖", sentence, theme::palette(ui).bad);
        }
    }

    /// A row with a number: its label is also its name. Answers whether it was changed.
    pub fn row(&mut self, ui: &mut Ui, label: &str, hint: &str, number: Number<'_>) -> bool {
        widgets::split_row(ui, label, |ui| self.number(ui, label, hint, number))
    }

    /// A field for a number; answers whether it was changed.
    pub fn number(&mut self, ui: &mut Ui, name: &str, hint: &str, number: Number<'_>) -> bool {
        let Number { field, value, range, is_whole, unit, width } = number;
        let refusal = self.refused.get(name).cloned();
        let is_marked = refusal.is_some() || self.marked.contains(&name);
        // Half a number is none: it counts once it was entered or left, and only as it was typed.
        let judged = Cell::new(None);
        let parser = |text: &str| {
            let typed = text.trim();
            let parsed = parse_number(typed.strip_suffix(unit.trim()).unwrap_or(typed)).ok();
            let fits = parsed.filter(|typed| range.contains(typed) && !(is_whole && typed.fract() != 0.0));
            let refused = fits.is_none().then(|| {
                let [least, most] = [range.start(), range.end()].map(ToString::to_string);
                words::not_taken(name, typed, &least, &most, unit, &value.to_string(), is_whole)
            });
            judged.set(Some(refused));
            fits
        };
        let mut response = ui
            .scope(|ui| {
                ui.spacing_mut().interact_size = vec2(width, FIELD_HEIGHT);
                ui.spacing_mut().button_padding.x = 6.0;
                if is_marked {
                    let bad = Stroke::new(1.0, theme::palette(ui).bad);
                    let widgets = &mut ui.visuals_mut().widgets;
                    (widgets.inactive.bg_stroke, widgets.hovered.bg_stroke) = (bad, bad);
                }
                ui.add(field.update_while_editing(false).custom_parser(parser))
            })
            .inner;
        match judged.take() {
            Some(Some(sentence)) => {
                self.refused.insert(name.to_owned(), sentence);
            }
            Some(None) => {
                self.refused.remove(name);
            }
            None if response.changed() => {
                self.refused.remove(name);
            }
            None => {}
        }
        if let Some(hint) = refusal.as_deref().or((!hint.is_empty()).then_some(hint)) {
            response = response.on_hover_text(hint);
        }
        response.widget_info(|| WidgetInfo::labeled(Role::SpinButton, true, name));
        response.changed()
    }
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

/// Room between the title of a section and its summary, that beside its triangle included, points.
const SUMMARY_GAP: f32 = 4.0;

/// A section that folds; while it is folded, a short summary stands at its right.
pub fn section(ui: &mut Ui, title: &str, summary: &str, is_open: Option<bool>, body: impl FnOnce(&mut Ui)) {
    let shown = CollapsingHeader::new(theme::strong(title))
        .id_salt(("capture settings", title))
        .open(is_open)
        .show_unindented(ui, |ui| {
            ui.spacing_mut().item_spacing.y = 2.0;
            body(ui);
            ui.add_space(8.0);
        });
    if shown.openness < 0.5 {
        let header = shown.header_response.rect;
        let right = egui::pos2(ui.max_rect().right(), header.center().y);
        let font = egui::FontId::proportional(theme::SMALL_SIZE);
        let color = theme::palette(ui).text_dim;
        let title = ui.painter().layout_no_wrap(title.to_owned(), theme::strong_font(), color);
        let room = right.x - header.left() - ui.spacing().icon_width - title.size().x - SUMMARY_GAP;
        let job = egui::text::LayoutJob {
            wrap: egui::text::TextWrapping::truncate_at_width(room.max(0.0)),
            ..egui::text::LayoutJob::simple_singleline(summary.to_owned(), font, color)
        };
        let galley = ui.painter().layout_job(job);
        let at = egui::pos2(right.x - galley.size().x, right.y - galley.size().y / 2.0);
        ui.painter().galley(at, galley, color);
    }
}
