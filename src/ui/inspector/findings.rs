//! Warnings as cards: what is the matter, and what to do about it.

use std::collections::BTreeMap;

use egui::{Frame, Label, Margin, RichText, Sense, Ui, vec2};

use crate::calibrate::{Solution, Warning};
use crate::text::shell as words;
use crate::text::warnings::{warning_message, warning_remedy};
use crate::ui::theme;

/// Findings of one kind listed before the rest is only counted.
const MAX_OF_A_KIND: usize = 3;

/// Draws a solution's warnings, those that cast doubt on it first.
pub fn show(ui: &mut Ui, solution: &Solution) {
    ui.label(theme::strong(words::FINDINGS));
    ui.add_space(4.0);
    if solution.warnings.is_empty() {
        ui.label(theme::dim(ui, words::NO_FINDINGS));
        return;
    }
    let mut warnings: Vec<&Warning> = solution.warnings.iter().collect();
    warnings.sort_by_key(|warning| !warning.casts_doubt());
    let mut shown: BTreeMap<&str, usize> = BTreeMap::new();
    for warning in warnings {
        let number = shown.entry(warning.code()).or_default();
        *number += 1;
        if *number <= MAX_OF_A_KIND {
            card(ui, warning);
        }
    }
    for (code, number) in shown {
        if number > MAX_OF_A_KIND {
            ui.label(theme::dim(ui, words::more_of_a_kind(number - MAX_OF_A_KIND, code)));
        }
    }
}

fn card(ui: &mut Ui, warning: &Warning) {
    let palette = theme::palette(ui);
    let color = if warning.casts_doubt() { palette.warn } else { palette.text_dim };
    let response = Frame::new()
        .fill(palette.canvas)
        .inner_margin(Margin { left: 12, right: 8, top: 8, bottom: 8 })
        .show(ui, |ui| {
            ui.set_width(ui.available_width());
            ui.add(Label::new(warning_message(warning)).wrap());
            ui.add_space(2.0);
            ui.add(Label::new(RichText::new(warning_remedy(warning)).color(palette.text_dim)).wrap());
        })
        .response;
    let bar = egui::Rect::from_min_size(response.rect.min, vec2(3.0, response.rect.height()));
    ui.painter().rect_filled(bar, 0.0, color);
    ui.interact(response.rect, response.id.with("code"), Sense::hover()).on_hover_text(warning.code());
    ui.add_space(4.0);
}
