//! The band above the columns: the verdict in a word, the headline figure, and which method is better by how much.

use egui::{Align, Button, Frame, Layout, Margin, Ui, vec2};

use crate::app::compare::Improvement;
use crate::calibrate::verdict::{GOOD_UP_TO_MM, USABLE_UP_TO_MM};
use crate::text::compare as text;
use crate::text::methods::{method_name, method_short_name, verdict_mark, verdict_name};
use crate::ui::figures::std_text;
use crate::ui::{theme, widgets};

use super::model::{Band, CompareModel};

/// Shows the band; `is_explained` toggles the reasons.
pub fn show(ui: &mut Ui, model: &CompareModel, is_out_of_date: bool, is_explained: &mut bool) {
    widgets::card(
        ui,
        "",
        |_| {},
        |ui| {
            Frame::new().inner_margin(Margin::symmetric(16, 10)).show(ui, |ui| {
                let Some(band) = &model.band else {
                    ui.horizontal(|ui| {
                        ui.set_min_size(vec2(ui.available_width(), 28.0));
                        ui.label(theme::dim(ui, text::NO_METHOD));
                    });
                    return;
                };
                let is_wide = fits_one_line(ui, model, band, is_out_of_date);
                ui.horizontal(|ui| {
                    ui.set_min_height(30.0);
                    verdict_words(ui, band);
                    ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                        if ui.add(Button::new(text::WHY).selected(*is_explained)).clicked() {
                            *is_explained = !*is_explained;
                        }
                        if is_out_of_date {
                            ui.label(theme::strong(text::OUT_OF_DATE).color(theme::palette(ui).warn));
                        }
                        if let (Some(improvement), true) = (&model.improvement, is_wide) {
                            ui.with_layout(Layout::right_to_left(Align::Center), |ui| better_by(ui, improvement, true));
                        }
                    });
                });
                if let (Some(improvement), false) = (&model.improvement, is_wide) {
                    ui.horizontal_wrapped(|ui| better_by(ui, improvement, false));
                }
                if *is_explained {
                    reasons(ui, band);
                }
            });
        },
    );
}

/// Whether verdict and comparison have room beside each other.
fn fits_one_line(ui: &Ui, model: &CompareModel, band: &Band, is_out_of_date: bool) -> bool {
    /// The verdict's mark, the button and the gaps between all these, points.
    const OTHERS: f32 = 134.0;
    let width = |text: &str, size: f32| {
        let font = egui::FontId::proportional(size);
        ui.painter().layout_no_wrap(text.to_owned(), font, egui::Color32::PLACEHOLDER).size().x
    };
    let comparison = model.improvement.as_ref().map_or(0.0, |improvement| {
        let words = text::maximum_error(text::compared_method(improvement.method))
            + &text::against(method_short_name(improvement.baseline), "0.000")
            + " 0.000 mm, −00 % ";
        width(&words, theme::BODY_SIZE)
    });
    let headline = text::headline("100") + " " + &text::headline_figure("0.000");
    let verdict = width(verdict_name(band.verdict), theme::HEADING_SIZE) + width(&headline, theme::BODY_SIZE);
    let note = if is_out_of_date { width(text::OUT_OF_DATE, theme::BODY_SIZE) + 8.0 } else { 0.0 };
    verdict + comparison + note + OTHERS <= ui.available_width()
}

fn verdict_words(ui: &mut Ui, band: &Band) {
    let color = theme::verdict_color_in(theme::palette(ui), band.verdict);
    ui.label(theme::heading(verdict_mark(band.verdict)).color(color));
    ui.label(theme::heading(verdict_name(band.verdict)));
    ui.add_space(4.0);
    if let Some((distance_mm, std_mm)) = band.workspace_point {
        let distance = widgets::fixed(distance_mm, 0);
        ui.label(theme::dim(ui, text::headline(&distance))).on_hover_text(text::verdict_of(method_name(band.method)));
        ui.label(theme::strong(text::headline_figure(&std_text(std_mm))))
            .on_hover_text(text::verdict_of(method_name(band.method)));
    }
}

/// The comparison; `is_reversed` where the layout runs from the right.
fn better_by(ui: &mut Ui, improvement: &Improvement, is_reversed: bool) {
    ui.spacing_mut().item_spacing.x = 5.0;
    let palette = theme::palette(ui);
    let change = improvement.percent().map(|percent| {
        let color = if percent < 0.0 { palette.good } else { palette.warn };
        theme::strong(format!("{} %", widgets::signed(percent, 0))).color(color)
    });
    let baseline =
        text::against(method_short_name(improvement.baseline), &widgets::fixed(improvement.baseline_error_mm, 3));
    let mut words = vec![
        egui::RichText::new(text::maximum_error(text::compared_method(improvement.method))),
        theme::strong(format!("{} mm,", widgets::fixed(improvement.error_mm, 3))),
    ];
    words.extend(change);
    words.push(egui::RichText::new(baseline));
    if is_reversed {
        words.reverse();
    }
    for part in words {
        ui.label(part).on_hover_text(text::MAXIMUM_ERROR_HINT);
    }
}

fn reasons(ui: &mut Ui, band: &Band) {
    let palette = theme::palette(ui);
    ui.add_space(6.0);
    ui.label(format!("{}: {}", text::verdict_of(method_name(band.method)), band.reason));
    ui.label(theme::dim(ui, text::verdict_scale(GOOD_UP_TO_MM, USABLE_UP_TO_MM)));
    for (sentence, remedy) in &band.warnings {
        ui.horizontal_wrapped(|ui| {
            ui.label(theme::strong("!").color(palette.warn));
            ui.label(sentence);
            ui.label(theme::dim(ui, *remedy));
        });
    }
}
