//! Distances of several calibrations as one histogram, their bars side by side.

use egui::{FontId, Frame, Id, Margin, Rect, Role, Sense, Stroke, Ui, WidgetInfo, pos2, vec2};

use crate::text::verify as words;
use crate::ui::charts::{self, Chart, Extent};
use crate::ui::{theme, widgets};
use crate::verify::Histogram;

use super::marks::Mark;

/// Part of a bin that its bars take.
const BARS_PART: f64 = 0.84;

/// Distances of one calibration, mm.
pub struct Series<'a> {
    /// The calibration.
    pub mark: &'a Mark,
    /// Its distances.
    pub distances_mm: Vec<f64>,
}

/// Shows the histogram in the space available, with one width of bins for all.
#[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 points")]
pub fn show(ui: &mut Ui, name: &str, x_title: &str, series: &[Series<'_>], is_fitted: &mut bool) {
    let max_mm = series.iter().flat_map(|series| series.distances_mm.iter().copied()).fold(0.0, f64::max);
    let most = series.iter().map(|series| series.distances_mm.len()).max().unwrap_or_default();
    let width_mm = Histogram::round_width_mm(max_mm, most);
    let histograms: Vec<Histogram> =
        series.iter().map(|series| Histogram::of(&series.distances_mm, width_mm)).collect();
    let num_bins = histograms.iter().map(|histogram| histogram.counts.len()).max().unwrap_or(1);
    let highest = histograms.iter().flat_map(|histogram| histogram.counts.iter().copied()).max().unwrap_or(1);
    // A whole number above the highest bar, so that the axis has more than one mark.
    let extent = Extent { x: [0.0, num_bins as f64 * width_mm], y: [0.0, highest.max(2) as f64] };
    ui.add_space(6.0);
    let canvas =
        Chart::new(Id::unique(name), x_title, words::POINTS_AXIS, ui.available_height(), extent).show(ui, is_fitted);
    let baseline = canvas.at(0.0, 0.0).y;
    let bar_mm = BARS_PART * width_mm / series.len().max(1) as f64;
    let mut hovered = None;
    for (series_idx, (series, histogram)) in series.iter().zip(&histograms).enumerate() {
        for (bin, count) in histogram.counts.iter().copied().enumerate().filter(|(_, count)| *count > 0) {
            let left_mm = (bin as f64 + (1.0 - BARS_PART) / 2.0) * width_mm + series_idx as f64 * bar_mm;
            let top = canvas.at(left_mm, count as f64);
            let right = canvas.at(left_mm + bar_mm, 0.0).x;
            let bar = Rect::from_min_max(top, pos2((right - 1.0).max(top.x + 1.0), baseline));
            series.mark.paint_bar(&canvas.painter, bar);
            if canvas.response.hover_pos().is_some_and(|pointer| bar.contains(pointer)) {
                hovered = Some((bar, &series.mark.name, bin, count));
            }
        }
    }
    let palette = theme::palette(ui);
    canvas.painter.hline(canvas.rect().x_range(), baseline, Stroke::new(1.0, palette.text_dim.gamma_multiply(0.6)));
    if let Some((bar, name, bin, count)) = hovered {
        let ends = [bin, bin + 1].map(|end| widgets::fixed(end as f64 * width_mm, 3));
        let note = words::bin_readout(name, &ends[0], &ends[1], count);
        canvas.note(ui, bar.center_top(), egui::Align2::CENTER_BOTTOM, &note, palette.text);
    }
}

/// The legend above histograms.
pub fn legend(ui: &mut Ui, marks: &[&Mark]) {
    charts::legend(ui, &marks.iter().map(|mark| mark.legend_entry()).collect::<Vec<_>>());
}

/// The legend of calibrations, each of which a click hides or shows again: one that is far off would squeeze all others into one
/// bar. Whether anything was clicked.
pub fn choosing_legend(ui: &mut Ui, marks: &[&Mark], hidden: &mut Vec<String>) -> bool {
    const SIGN_WIDTH: f32 = 20.0;
    let mut is_changed = false;
    Frame::new().inner_margin(Margin { left: 12, right: 8, top: 6, bottom: 0 }).show(ui, |ui| {
        ui.spacing_mut().interact_size.y = 18.0;
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing = vec2(10.0, 0.0);
            for mark in marks {
                let is_hidden = hidden.contains(&mark.name);
                let palette = theme::palette(ui);
                let color = if is_hidden { palette.text_dim.gamma_multiply(0.5) } else { palette.text_dim };
                let font = FontId::proportional(theme::SMALL_SIZE);
                let galley = ui.painter().layout_no_wrap(mark.name.clone(), font, color);
                let (rect, response) = ui.allocate_exact_size(vec2(SIGN_WIDTH + galley.size().x, 18.0), Sense::click());
                let name = words::show_in_charts(&mark.name);
                response.widget_info(|| WidgetInfo::selected(Role::Button, true, !is_hidden, &name));
                if response.hovered() || response.has_focus() {
                    ui.painter().rect_filled(rect.expand2(vec2(3.0, 0.0)), theme::RADIUS, palette.hovered);
                }
                let at = pos2(rect.left() + SIGN_WIDTH, rect.center().y - galley.size().y / 2.0);
                let width = galley.size().x;
                ui.painter().galley(at, galley, color);
                if is_hidden {
                    ui.painter().hline(at.x..=at.x + width, rect.center().y, Stroke::new(1.0, color));
                } else {
                    mark.paint(ui.painter(), rect.left_center() + vec2(SIGN_WIDTH / 2.0 - 2.0, 0.0));
                }
                if response.on_hover_text(words::SHOW_IN_CHARTS_HINT).clicked() {
                    is_changed = true;
                    if is_hidden {
                        hidden.retain(|name| *name != mark.name);
                    } else {
                        hidden.push(mark.name.clone());
                    }
                }
            }
        });
    });
    is_changed
}
