//! The profiles of a scan one beside the other: how near and how far the points of each are, and where nothing was seen.

use egui::{Align2, Id, Stroke, Ui, vec2};
use egui_plot::MarkerShape;

use crate::session::ScanLine;
use crate::text::arcs as text;
use crate::ui::charts::{self, Canvas, Chart, Extent, LegendEntry, LegendGlyph};
use crate::ui::save_picture::saveable;
use crate::ui::{Selection, theme, widgets};

use super::model::StationRow;
use super::panel::empty_card;

/// Bars of this many profiles and more touch each other, points.
const MOST_BAR_WIDTH: f32 = 5.0;

/// Shows the card; a click selects the profile.
pub fn card(ui: &mut Ui, height: f32, station: &StationRow, selection: &mut Selection, is_fitted: &mut bool) {
    let lines: Vec<Option<ScanLine>> = station.captures.iter().map(|capture| capture.scan).collect();
    let right = |ui: &mut Ui| {
        ui.label(theme::dim(ui, text::RANGES_HINT)).on_hover_text(text::RANGES_HINT_LONG);
    };
    widgets::card_with_height(ui, text::RANGES, height, right, |ui| {
        if lines.iter().flatten().any(|line| line.range_mm.is_some()) {
            saveable(ui, text::RANGES, |ui| plot(ui, &lines, selection, is_fitted));
        } else {
            empty_card(ui, text::NO_RANGES, None);
        }
    });
}

#[expect(clippy::cast_precision_loss, reason = "a scan has far fewer than 2^52 profiles")]
fn number_of(capture_idx: usize) -> f64 {
    (capture_idx + 1) as f64
}

fn plot(ui: &mut Ui, lines: &[Option<ScanLine>], selection: &mut Selection, is_fitted: &mut bool) {
    let ranges: Vec<(usize, [f64; 2])> = lines
        .iter()
        .enumerate()
        .filter_map(|(capture_idx, line)| Some((capture_idx, (*line)?.range_mm?.z_mm)))
        .collect();
    let glyph = LegendGlyph::Solid(MarkerShape::Square);
    let text = text::ranges(ranges.len(), lines.len());
    charts::legend(ui, &[LegendEntry { glyph, color: theme::INLIER, text }]);
    let mut extent = Extent::NOTHING;
    for (capture_idx, ends) in &ranges {
        for end in ends {
            extent.include(number_of(*capture_idx), *end);
        }
    }
    let height = ui.available_height();
    let mut chart = Chart::new(Id::unique("arcs ranges"), text::PROFILE_AXIS, text::Z_AXIS, height, extent);
    chart.invert_y = extent.y[0] + extent.y[1] >= 0.0;
    let canvas = chart.show(ui, is_fitted);
    let palette = theme::palette(ui);
    let width = (canvas.scale() * 0.8).clamp(1.0, MOST_BAR_WIDTH);
    for (capture_idx, [near, far]) in &ranges {
        let ends = [*near, *far].map(|end| canvas.at(number_of(*capture_idx), end));
        let is_selected = *capture_idx == selection.capture_idx;
        let color = if is_selected { palette.accent } else { theme::INLIER };
        // A face that the line lies along level is seen as well.
        let ends = [ends[0] - vec2(0.0, 1.0), ends[1] + vec2(0.0, 1.0)];
        canvas.painter.line_segment(ends, Stroke::new(width, color));
        if is_selected {
            canvas.painter.vline(ends[0].x, canvas.rect().y_range(), Stroke::new(1.0, color.gamma_multiply(0.5)));
        }
    }
    if let Some((capture_idx, ends)) = under_pointer(&canvas, &ranges) {
        let [near, far] = ends.map(|end| widgets::fixed(end, 2));
        let at = canvas.at(number_of(capture_idx), ends[0]) + vec2(10.0, -8.0);
        let words = text::range_readout(capture_idx + 1, &near, &far);
        canvas.note(ui, at, Align2::LEFT_BOTTOM, &words, palette.text);
        if canvas.response.clicked() {
            selection.capture_idx = capture_idx;
        }
    }
}

/// The profile nearest to the pointer along the scan.
fn under_pointer(canvas: &Canvas, ranges: &[(usize, [f64; 2])]) -> Option<(usize, [f64; 2])> {
    let pointer = canvas.response.hover_pos()?;
    let away =
        |(capture_idx, [near, _]): &(usize, [f64; 2])| (canvas.at(number_of(*capture_idx), *near).x - pointer.x).abs();
    ranges.iter().copied().min_by(|a, b| away(a).total_cmp(&away(b)))
}
