//! The evidence of the finding selected.

use egui::{Color32, Frame, Id, Margin, ProgressBar, Role, Stroke, Ui, WidgetInfo, pos2, vec2};
use egui_plot::MarkerShape;

use crate::app::Command;
use crate::diagnose::{CurveAxis, Plot, StationBar};
use crate::report::figure::model::station_bars;
use crate::text::diagnosis as fault_words;
use crate::text::diagnosis_panel as words;
use crate::text::typeset::{std_text, with_std};
use crate::ui::charts::{self, Chart, Extent, LegendEntry, LegendGlyph};
use crate::ui::save_picture::saveable;
use crate::ui::{PanelContext, Selection, theme, widgets};

use super::bars::{self, Bar};
use super::model::{Shown, View};
use super::panel::DiagnosisState;
use super::{readings, triad};

/// Shows the card.
pub fn evidence(ui: &mut Ui, height: f32, view: &View<'_>, context: &mut PanelContext<'_>, state: &mut DiagnosisState) {
    let is_fitted = &mut state.is_fitted[0];
    let found = match state.shown {
        Shown::Readings => {
            readings_asked_for(ui, height, view, context);
            return;
        }
        Shown::Finding(idx) => view.findings().get(idx),
    };
    let evidence = found.and_then(|finding| finding.evidence.plot.as_ref());
    let target = &view.session.target;
    let title =
        evidence.map_or_else(|| words::stations_agree(target).to_owned(), |plot| fault_words::plot_title(plot, target));
    // Where there is nothing of its own to show, how far each station is off the others puts the finding in scale.
    let of_all = || view.solution().and_then(|solution| station_bars(solution, found.map(|finding| &finding.fault)));
    let plot = evidence.cloned().or_else(of_all);
    let right = |ui: &mut Ui| {
        if matches!(plot, Some(Plot::Readings(_))) {
            ui.label(theme::dim(ui, words::READINGS_HINT));
        }
    };
    widgets::card_with_height(ui, &title, height, right, |ui| {
        match &plot {
            // A table, not a picture.
            Some(Plot::Readings(fits)) => readings::show(ui, fits, view.diagnosis.is_current, context),
            Some(plot) => saveable(ui, &title, |ui| show(ui, plot, view, context, is_fitted)),
            None => {
                let has_solution = view.solution().is_some();
                widgets::nothing(ui, if has_solution { words::TOO_FEW_TO_LEAVE_OUT } else { words::NO_SOLUTION });
            }
        }
    });
}

fn readings_asked_for(ui: &mut Ui, height: f32, view: &View<'_>, context: &mut PanelContext<'_>) {
    let right = |ui: &mut Ui| {
        ui.label(theme::dim(ui, words::READINGS_HINT));
        if view.readings.value.is_some() && !view.readings.is_current {
            ui.label(theme::dim(ui, words::OUT_OF_DATE).color(theme::palette(ui).warn));
        }
    };
    widgets::card_with_height(ui, words::READINGS, height, right, |ui| {
        if let Some(progress) = view.readings.progress {
            Frame::new().inner_margin(Margin::symmetric(16, 12)).show(ui, |ui| {
                ui.label(words::TRYING_READINGS);
                ui.add_space(8.0);
                ui.add(ProgressBar::new(progress.fraction()).desired_height(6.0));
                ui.add_space(8.0);
                let button = ui.button(words::CANCEL);
                button.widget_info(|| WidgetInfo::labeled(Role::Button, true, words::CANCEL_READINGS));
                if button.clicked() {
                    context.commands.push(Command::CancelReadings);
                }
            });
            return;
        }
        match view.readings.value {
            Some(fits) if fits.is_empty() => widgets::nothing(ui, words::NO_READINGS),
            Some(fits) => readings::show(ui, fits, view.readings.is_current, context),
            None => widgets::nothing(ui, words::READINGS_CANCELLED),
        }
    });
}

/// One plot in the space available.
fn show(ui: &mut Ui, plot: &Plot, view: &View<'_>, context: &mut PanelContext<'_>, is_fitted: &mut bool) {
    let [x_title, y_title] = fault_words::plot_axes(plot);
    let axes = Axes { x_title, y_title };
    match plot {
        Plot::Stations(stations) => station_errors(ui, stations, y_title, context.selection, is_fitted),
        Plot::Readings(fits) => readings::show(ui, fits, view.diagnosis.is_current, context),
        Plot::Curve { axis, points, given, found, std } => {
            curve(ui, &axes, *axis, points, [*given, *found, *std], is_fitted);
        }
        Plot::Trend { points, line } => trend(ui, &axes, points, *line, is_fitted),
        Plot::Direction { in_flange, rotations_deg } => triad::show(ui, *in_flange, *rotations_deg, view.session.mount),
        Plot::Steps(steps) => travels(ui, &axes, steps, is_fitted),
    }
}

/// Titles of a plot's axes.
struct Axes<'a> {
    x_title: &'a str,
    y_title: &'a str,
}

impl Axes<'_> {
    fn chart(&self, ui: &Ui, name: &str, extent: Extent) -> Chart<'_> {
        Chart::new(Id::unique(("diagnosis evidence", name)), self.x_title, self.y_title, ui.available_height(), extent)
    }
}

fn entry(glyph: LegendGlyph, color: Color32, text: impl Into<String>) -> LegendEntry {
    LegendEntry { glyph, color, text: text.into() }
}

fn station_errors(
    ui: &mut Ui,
    stations: &[StationBar],
    y_title: &str,
    selection: &mut Selection,
    is_fitted: &mut bool,
) {
    let square = MarkerShape::Square;
    if stations.iter().any(|station| station.is_accused) {
        let accused = entry(LegendGlyph::Hollow(square), theme::palette(ui).bad, words::ACCUSED);
        charts::legend(ui, &[entry(LegendGlyph::Solid(square), theme::INLIER, words::OTHERS), accused]);
    }
    let bars: Vec<Bar<'_>> = stations
        .iter()
        .map(|station| Bar {
            station_idx: station.station_idx,
            label: &station.label,
            value: station.error_mm,
            is_accused: station.is_accused,
            readout: words::station_value(&station.label, &format!("{} mm", widgets::fixed(station.error_mm, 4))),
        })
        .collect();
    let frame = bars::Frame { id: Id::unique("diagnosis stations"), y_title, lines: &[] };
    bars::show(ui, &frame, &bars, selection, is_fitted);
}

fn curve(
    ui: &mut Ui,
    axes: &Axes<'_>,
    axis: CurveAxis,
    points: &[[f64; 2]],
    [given, found, std]: [f64; 3],
    is_fitted: &mut bool,
) {
    let palette = theme::palette(ui);
    let unit = match axis {
        CurveAxis::RadiusMm => " mm",
        CurveAxis::ProfileScale => "",
    };
    charts::legend(
        ui,
        &[
            entry(
                LegendGlyph::Dashed,
                palette.text_dim,
                words::given_value(&format!("{}{unit}", widgets::fixed(given, 3))),
            ),
            entry(LegendGlyph::Line, palette.accent, words::found_value(&format!("{}{unit}", with_std(found, std)))),
        ],
    );
    let mut extent = Extent::NOTHING;
    for [value, rms_mm] in points {
        extent.include(*value, *rms_mm);
        extent.include(*value, 0.0);
    }
    for value in [given, found] {
        extent.include(value, 0.0);
    }
    let canvas = axes.chart(ui, "curve", extent).show(ui, is_fitted);
    let heights = canvas.rect().y_range();
    let [low, middle, high] = [found - std, found, found + std].map(|value| canvas.at(value, 0.0).x);
    let band = egui::Rect::from_x_y_ranges(low.min(middle - 1.0)..=high.max(middle + 1.0), heights);
    canvas.painter.rect_filled(band, 0.0, palette.accent.gamma_multiply(0.25));
    canvas.painter.vline(middle, heights, Stroke::new(1.2, palette.accent));
    let given_x = canvas.at(given, 0.0).x;
    let ends = [pos2(given_x, heights.min), pos2(given_x, heights.max)];
    charts::dashed_line(&canvas.painter, &ends, Stroke::new(1.2, palette.text_dim));
    let line: Vec<_> = points.iter().map(|[value, rms_mm]| canvas.at(*value, *rms_mm)).collect();
    canvas.painter.line(line.clone(), Stroke::new(1.8, theme::INLIER));
    for point in line {
        charts::marker(&canvas.painter, MarkerShape::Circle, point, 2.5, theme::INLIER, Stroke::NONE);
    }
    if let Some([value, rms_mm]) = canvas.hovered(points.iter().map(|point| (*point, *point))) {
        let words = format!("{}{unit}: {} mm", widgets::fixed(value, 4), std_text(rms_mm));
        let at = canvas.at(value, rms_mm) + vec2(10.0, -6.0);
        canvas.note(ui, at, egui::Align2::LEFT_BOTTOM, &words, palette.text);
    }
}

fn trend(ui: &mut Ui, axes: &Axes<'_>, points: &[[f64; 2]], line: [f64; 2], is_fitted: &mut bool) {
    let palette = theme::palette(ui);
    charts::legend(
        ui,
        &[
            entry(LegendGlyph::Solid(MarkerShape::Circle), theme::INLIER, words::STATION_AXIS),
            entry(LegendGlyph::Line, palette.bad, words::TREND_LINE),
        ],
    );
    let mut extent = Extent::NOTHING;
    for [number, shift_mm] in points {
        extent.include(*number, *shift_mm);
    }
    let (first, last) = (extent.x[0], extent.x[1]);
    extent.include(first, line[0]);
    extent.include(last, line[1]);
    let canvas = axes.chart(ui, "trend", extent).show(ui, is_fitted);
    canvas.painter.line_segment([canvas.at(first, line[0]), canvas.at(last, line[1])], Stroke::new(1.8, palette.bad));
    for [number, shift_mm] in points {
        let at = canvas.at(*number, *shift_mm);
        charts::marker(&canvas.painter, MarkerShape::Circle, at, 4.0, theme::INLIER, Stroke::NONE);
    }
    if let Some([number, shift_mm]) = canvas.hovered(points.iter().map(|point| (*point, *point))) {
        let shift = format!("{} mm", widgets::signed(shift_mm, 3));
        let words = words::station_value(&widgets::fixed(number, 0), &shift);
        canvas.note(
            ui,
            canvas.at(number, shift_mm) + vec2(10.0, -6.0),
            egui::Align2::LEFT_BOTTOM,
            &words,
            palette.text,
        );
    }
}

fn travels(ui: &mut Ui, axes: &Axes<'_>, steps: &[[f64; 2]], is_fitted: &mut bool) {
    let palette = theme::palette(ui);
    charts::legend(
        ui,
        &[
            entry(LegendGlyph::Hollow(MarkerShape::Circle), theme::INLIER, words::STEP),
            entry(LegendGlyph::Dashed, palette.text_dim, words::ONE_TO_ONE),
        ],
    );
    let mut extent = Extent::NOTHING;
    for [commanded_mm, moved_mm] in steps {
        extent.include(*commanded_mm, *moved_mm);
        extent.include(*commanded_mm, *commanded_mm);
    }
    let mut chart = axes.chart(ui, "steps", extent);
    chart.has_equal_scales = true;
    let canvas = chart.show(ui, is_fitted);
    let [low, high] = extent.x;
    let ends = [canvas.at(low, low), canvas.at(high, high)];
    charts::dashed_line(&canvas.painter, &ends, Stroke::new(1.2, palette.text_dim));
    let points = steps.iter().map(|[commanded_mm, moved_mm]| canvas.at(*commanded_mm, *moved_mm));
    let stroke = Stroke::new(1.2, theme::INLIER);
    for at in charts::thinned(points, canvas.rect(), 1.0) {
        charts::marker(&canvas.painter, MarkerShape::Circle, at, 3.0, Color32::TRANSPARENT, stroke);
    }
    if let Some([commanded_mm, moved_mm]) = canvas.hovered(steps.iter().map(|step| (*step, *step))) {
        let words = words::step_readout(&widgets::fixed(commanded_mm, 3), &widgets::fixed(moved_mm, 3));
        let at = canvas.at(commanded_mm, moved_mm) + vec2(10.0, -6.0);
        canvas.note(ui, at, egui::Align2::LEFT_BOTTOM, &words, palette.text);
    }
}
