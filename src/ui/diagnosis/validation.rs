//! How much the result can be relied on: the influence of each station, two halves, and the residuals' distribution.

use egui::{Align2, Button, Id, Stroke, Ui, pos2, vec2};
use egui_plot::MarkerShape;

use crate::calibrate::validation::{SplitHalf, Validation};
use crate::text::diagnosis_panel as words;
use crate::text::typeset::std_text;
use crate::ui::charts::{self, Chart, Extent, LegendEntry, LegendGlyph};
use crate::ui::save_picture::saveable;
use crate::ui::{Selection, theme, widgets};

use super::bars::{self, Bar};
use super::model::View;
use super::panel::DiagnosisState;

/// Residuals beyond these are rare, and hardly chance.
const RARE: [f64; 2] = [2.0, 3.0];
/// Half-size of a dot, points.
const DOT: f32 = 2.5;

fn validation<'a>(view: &View<'a>) -> Option<&'a Validation> {
    view.diagnosis.value?.validation.as_ref()
}

/// Says why there is nothing to show: not yet, or never.
fn missing(ui: &mut Ui, view: &View<'_>, reason: &str) {
    let is_running = view.diagnosis.value.is_none() && view.diagnosis.progress.is_some();
    let sentence = match view.solution() {
        None => words::NO_SOLUTION,
        Some(_) if is_running => words::EXAMINING,
        Some(_) => reason,
    };
    widgets::nothing(ui, sentence);
}

/// A test's probability with the digits that matter.
fn p_text(p_value: f64) -> String {
    if p_value < 0.001 { "< 0.001".to_owned() } else { widgets::fixed(p_value, 3) }
}

/// Shows what each station means for the result.
pub fn influence(ui: &mut Ui, height: f32, view: &View<'_>, selection: &mut Selection, state: &mut DiagnosisState) {
    let shows_moves = state.shows_moves;
    let mut chosen = None;
    let right = |ui: &mut Ui| {
        ui.spacing_mut().interact_size.y = 22.0;
        ui.spacing_mut().button_padding = vec2(8.0, 2.0);
        ui.spacing_mut().item_spacing.x = 4.0;
        for (moves, name, hint) in
            [(true, words::MOVES, words::MOVES_HINT), (false, words::RESIDUALS, words::RESIDUALS_HINT)]
        {
            if ui.add(Button::selectable(shows_moves == moves, name)).on_hover_text(hint).clicked() {
                chosen = Some(moves);
            }
        }
    };
    let is_fitted = &mut state.is_fitted[1];
    widgets::card_with_height(ui, words::INFLUENCE, height, right, |ui| {
        let Some(influence) = validation(view).map(|validation| &validation.influence).filter(|all| !all.is_empty())
        else {
            missing(ui, view, words::NOT_VALIDATED);
            return;
        };
        let bars: Vec<Bar<'_>> = influence
            .iter()
            .map(|station| Bar {
                station_idx: station.station_idx,
                label: &station.label,
                value: if shows_moves { station.moves_workspace_point_mm } else { station.studentised_residual },
                is_accused: !shows_moves && station.studentised_residual.abs() > RARE[1],
                readout: words::influence_readout(
                    &station.label,
                    &widgets::fixed(station.studentised_residual, 2),
                    &p_text(station.p_value),
                    &std_text(station.moves_workspace_point_mm),
                ),
            })
            .collect();
        let has_negative = bars.iter().any(|bar| bar.value < 0.0);
        let lines: &[f64] = match (shows_moves, has_negative) {
            (true, _) => &[],
            (false, true) => &[-RARE[1], -RARE[0], RARE[0], RARE[1]],
            (false, false) => &RARE,
        };
        let y_title = if shows_moves { words::MOVES_AXIS } else { words::STUDENTISED_AXIS };
        let frame = bars::Frame { id: Id::unique("diagnosis influence"), y_title, lines };
        saveable(ui, words::INFLUENCE, |ui| bars::show(ui, &frame, &bars, selection, is_fitted));
    });
    if let Some(moves) = chosen {
        state.shows_moves = moves;
        state.is_fitted[1] = true;
    }
}

/// Shows how far apart two halves of the stations are.
pub fn halves(ui: &mut Ui, height: f32, view: &View<'_>, is_fitted: &mut bool) {
    let title_hint = |ui: &mut Ui| {
        ui.label(theme::dim(ui, "?")).on_hover_text(words::HALVES_HINT);
    };
    widgets::card_with_height(ui, words::HALVES, height, title_hint, |ui| {
        match validation(view).and_then(|validation| validation.split_half.as_ref()) {
            Some(split) => saveable(ui, words::HALVES, |ui| splits(ui, split, is_fitted)),
            None => missing(ui, view, words::TOO_FEW_FOR_HALVES),
        }
    });
}

fn splits(ui: &mut Ui, split: &SplitHalf, is_fitted: &mut bool) {
    let palette = theme::palette(ui);
    let entry = |glyph, color, text| LegendEntry { glyph, color, text };
    charts::legend(
        ui,
        &[
            entry(LegendGlyph::Line, palette.text, words::median(&std_text(split.median_mm))),
            entry(LegendGlyph::Dashed, palette.warn, words::expected(&std_text(split.expected_mm))),
        ],
    );
    let mut points = Vec::with_capacity(split.disagreements_mm.len());
    let mut extent = Extent::NOTHING;
    extent.include(0.0, 0.0);
    extent.include(0.0, split.expected_mm);
    for (rank, apart_mm) in (1_u32..).zip(&split.disagreements_mm) {
        extent.include(f64::from(rank), *apart_mm);
        points.push([f64::from(rank), *apart_mm]);
    }
    let height = ui.available_height();
    let id = Id::unique("diagnosis halves");
    let canvas = Chart::new(id, words::SPLIT_AXIS, words::APART_AXIS, height, extent).show(ui, is_fitted);
    let across = |value: f64| {
        let y = canvas.at(0.0, value).y;
        [pos2(canvas.rect().left(), y), pos2(canvas.rect().right(), y)]
    };
    canvas.painter.line_segment(across(split.median_mm), Stroke::new(1.2, palette.text));
    charts::dashed_line(&canvas.painter, &across(split.expected_mm), Stroke::new(1.2, palette.warn));
    let dots = points.iter().map(|[rank, apart_mm]| canvas.at(*rank, *apart_mm));
    for at in charts::thinned(dots, canvas.rect(), 1.5) {
        charts::marker(&canvas.painter, MarkerShape::Circle, at, DOT, theme::INLIER, Stroke::NONE);
    }
    if let Some([rank, apart_mm]) = canvas.hovered(points.iter().map(|point| (*point, *point))) {
        let words = format!("{} mm", std_text(apart_mm));
        canvas.note(ui, canvas.at(rank, apart_mm) - vec2(8.0, 6.0), Align2::RIGHT_BOTTOM, &words, palette.text);
    }
}

/// Shows whether the residuals are normally distributed.
pub fn normality(ui: &mut Ui, height: f32, view: &View<'_>, is_fitted: &mut bool) {
    let normality = validation(view).and_then(|validation| validation.normality.as_ref());
    let right = |ui: &mut Ui| {
        let words = normality.map_or_else(|| "?".to_owned(), |normality| words::p_value(&p_text(normality.p_value)));
        ui.label(theme::dim(ui, words)).on_hover_text(words::NORMALITY_HINT);
    };
    widgets::card_with_height(ui, words::NORMALITY, height, right, |ui| match normality {
        Some(normality) => {
            saveable(ui, words::NORMALITY, |ui| quantiles(ui, &normality.quantiles, is_fitted));
        }
        None => missing(ui, view, words::TOO_FEW_RESIDUALS),
    });
}

fn quantiles(ui: &mut Ui, quantiles: &[[f64; 2]], is_fitted: &mut bool) {
    let palette = theme::palette(ui);
    let mut extent = Extent::NOTHING;
    for [expected, found] in quantiles {
        extent.include(*expected, *found);
        extent.include(*expected, *expected);
    }
    ui.add_space(bars::TOP_ROOM);
    let height = ui.available_height();
    let id = Id::unique("diagnosis normality");
    let canvas = Chart::new(id, words::QUANTILE_AXIS, words::RESIDUAL_AXIS, height, extent).show(ui, is_fitted);
    let [low, high] = extent.x;
    let ends = [canvas.at(low, low), canvas.at(high, high)];
    charts::dashed_line(&canvas.painter, &ends, Stroke::new(1.2, palette.text_dim));
    let dots = quantiles.iter().map(|[expected, found]| canvas.at(*expected, *found));
    for at in charts::thinned(dots, canvas.rect(), 1.5) {
        charts::marker(&canvas.painter, MarkerShape::Circle, at, DOT, theme::INLIER, Stroke::NONE);
    }
}
