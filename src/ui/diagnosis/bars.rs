//! One bar a station; those that a finding names are hatched as well as coloured.

use egui::{Align2, Color32, Id, Painter, Rect, Stroke, StrokeKind, Ui, pos2, vec2};

use crate::text::diagnosis_panel as words;
use crate::ui::charts::{self, Chart, Extent};
use crate::ui::{Selection, theme};

/// Part of a station's place that its bar takes.
const BAR_WIDTH: f64 = 0.62;
/// Distance between the lines of a hatched bar, points.
const HATCH_SPACING: f32 = 5.0;

/// Room above the plot, so that the uppermost label is not cut, points.
pub const TOP_ROOM: f32 = 6.0;

/// A bar.
pub struct Bar<'a> {
    /// Index of the station in the session.
    pub station_idx: usize,
    /// The user's name for it.
    pub label: &'a str,
    /// Its height.
    pub value: f64,
    /// Whether the finding is about it.
    pub is_accused: bool,
    /// What is shown under the pointer.
    pub readout: String,
}

/// What the bars are drawn against.
pub struct Frame<'a> {
    /// Unique name in the window.
    pub id: Id,
    /// Title of the y axis.
    pub y_title: &'a str,
    /// Dashed lines across.
    pub lines: &'a [f64],
}

/// Shows the bars in the space available; a click selects the station.
pub fn show(ui: &mut Ui, frame: &Frame<'_>, bars: &[Bar<'_>], selection: &mut Selection, is_fitted: &mut bool) {
    let place = |idx: usize| f64::from(u32::try_from(idx).unwrap_or(u32::MAX));
    let names: Vec<String> = bars.iter().map(|bar| bar.label.to_owned()).collect();
    let mut extent = Extent { x: [-0.6, place(names.len()) - 0.4], y: [0.0, 0.0] };
    for value in bars.iter().map(|bar| bar.value).chain(frame.lines.iter().copied()) {
        extent.include(0.0, value);
    }
    if extent.y[1] <= extent.y[0] {
        extent.y[1] = 0.01;
    }
    ui.add_space(TOP_ROOM);
    let height = ui.available_height();
    let mut chart = Chart::new(frame.id, words::STATION_AXIS, frame.y_title, height, extent);
    chart.x_names = Some(&names);
    let canvas = chart.show(ui, is_fitted);
    let palette = theme::palette(ui);
    let baseline = canvas.at(0.0, 0.0).y;
    let mut hovered = None;
    for (idx, bar) in bars.iter().enumerate() {
        let end = canvas.at(place(idx) - BAR_WIDTH / 2.0, bar.value);
        let right = canvas.at(place(idx) + BAR_WIDTH / 2.0, 0.0).x;
        // A value of nothing still shows that there is one.
        let (top, bottom) =
            if bar.value < 0.0 { (baseline, end.y.max(baseline + 1.5)) } else { (end.y.min(baseline - 1.5), baseline) };
        let rect = Rect::from_min_max(pos2(end.x, top), pos2(right, bottom));
        if bar.is_accused {
            hatched(&canvas.painter, rect, palette.bad);
        } else {
            canvas.painter.rect_filled(rect, 1.0, theme::INLIER);
        }
        if selection.station_idx == bar.station_idx {
            canvas.painter.rect_stroke(rect, 1.0, Stroke::new(1.5, palette.accent), StrokeKind::Outside);
        }
        let column = Rect::from_x_y_ranges(rect.x_range(), canvas.rect().y_range());
        if canvas.response.hover_pos().is_some_and(|pointer| column.contains(pointer)) {
            hovered = Some((bar, rect));
        }
    }
    canvas.painter.hline(canvas.rect().x_range(), baseline, Stroke::new(1.0, palette.text_dim.gamma_multiply(0.6)));
    for line in frame.lines {
        let y = canvas.at(0.0, *line).y;
        let ends = [pos2(canvas.rect().left(), y), pos2(canvas.rect().right(), y)];
        charts::dashed_line(&canvas.painter, &ends, Stroke::new(1.0, palette.warn));
    }
    if let Some((bar, rect)) = hovered {
        if canvas.response.clicked() {
            (selection.station_idx, selection.capture_idx) = (bar.station_idx, 0);
        }
        let at = rect.center_top() - vec2(0.0, 4.0);
        canvas.note(ui, at, Align2::CENTER_BOTTOM, &bar.readout, palette.text);
    }
}

fn hatched(painter: &Painter, rect: Rect, color: Color32) {
    let inside = painter.with_clip_rect(rect.intersect(painter.clip_rect()));
    inside.rect_filled(rect, 1.0, color.gamma_multiply(0.12));
    let mut offset = -rect.height();
    while offset < rect.width() {
        let from = pos2(rect.left() + offset, rect.bottom());
        inside.line_segment([from, from + vec2(rect.height(), -rect.height())], Stroke::new(1.2, color));
        offset += HATCH_SPACING;
    }
    painter.rect_stroke(rect, 1.0, Stroke::new(1.5, color), StrokeKind::Inside);
}
