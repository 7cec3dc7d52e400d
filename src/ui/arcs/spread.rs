//! Where in the laser plane the stations have their points, by edge: the wider they are spread, the better the sensor's plane is
//! known.

use egui::{Align2, Color32, Id, Stroke, Ui, vec2};
use egui_plot::MarkerShape;

use crate::calibrate::{Edge, Method};
use crate::session::Target;
use crate::text::arcs as text;
use crate::text::edges::edge_name;
use crate::ui::charts::{self, Chart, Extent, LegendEntry, LegendGlyph};
use crate::ui::save_picture::saveable;
use crate::ui::{Selection, theme, widgets};

use super::model::{self, SpreadPoint, StationRow};
use super::panel::empty_card;

/// Radius of a mark, points.
const MARK_RADIUS: f32 = 4.6;

/// Shows the card; a click on a point selects its station.
pub fn card(
    ui: &mut Ui,
    height: f32,
    target: &Target,
    rows: &[StationRow],
    selection: &mut Selection,
    is_fitted: &mut bool,
) {
    let points = model::spread(rows);
    let right = |ui: &mut Ui| {
        ui.label(theme::dim(ui, text::SPREAD_HINT)).on_hover_text(text::spread_hint_long(target));
    };
    widgets::card_with_height(ui, text::all_points(target), height, right, |ui| {
        if points.is_empty() {
            empty_card(ui, text::NO_POINTS, None);
        } else {
            saveable(ui, text::all_points(target), |ui| plot(ui, target, &points, selection, is_fitted));
        }
    });
}

fn plot(ui: &mut Ui, target: &Target, points: &[SpreadPoint], selection: &mut Selection, is_fitted: &mut bool) {
    charts::legend(ui, &entries(target, points));
    let mut extent = Extent::NOTHING;
    for point in points {
        extent.include(point.point_mm[0], point.point_mm[1]);
    }
    let height = ui.available_height();
    let mut chart = Chart::new(Id::unique("arcs spread"), text::X_AXIS, text::Z_AXIS, height, extent);
    chart.invert_y = extent.y[0] + extent.y[1] >= 0.0;
    chart.has_equal_scales = true;
    let canvas = chart.show(ui, is_fitted);
    let palette = theme::palette(ui);
    for point in points {
        let at = canvas.at(point.point_mm[0], point.point_mm[1]);
        let (shape, color) = look(point.edge);
        let color = if point.is_enabled { color } else { palette.text_dim.gamma_multiply(0.6) };
        let fill = if point.is_enabled { color } else { Color32::TRANSPARENT };
        charts::marker(&canvas.painter, shape, at, MARK_RADIUS, fill, Stroke::new(1.0, color));
        if (point.station_idx, point.capture_idx) == (selection.station_idx, selection.capture_idx) {
            canvas.painter.circle_stroke(at, MARK_RADIUS + 4.5, Stroke::new(1.6, palette.accent));
        }
    }
    let under_pointer = canvas.hovered(points.iter().map(|point| (point, point.point_mm)));
    if let Some(point) = under_pointer {
        let [x, z] = point.point_mm.map(|value| widgets::fixed(value, 3));
        let at = canvas.at(point.point_mm[0], point.point_mm[1]) + vec2(10.0, -8.0);
        canvas.note(ui, at, Align2::LEFT_BOTTOM, &text::spread_readout(&point.label, &x, &z), palette.text);
        if canvas.response.clicked() {
            selection.station_idx = point.station_idx;
            selection.capture_idx = point.capture_idx;
        }
    }
}

fn entries(target: &Target, points: &[SpreadPoint]) -> Vec<LegendEntry> {
    let kinds: &[Option<Edge>] =
        if *target == Target::RightAnglePlate { &[Some(Edge::P), Some(Edge::Q)] } else { &[None] };
    let entry = |edge: &Option<Edge>| {
        let count = points.iter().filter(|point| point.edge == *edge).count();
        let (shape, color) = look(*edge);
        let text = edge.map_or_else(|| text::tips(target, count), |edge| text::points_of_edge(edge_name(edge), count));
        LegendEntry { glyph: LegendGlyph::Solid(shape), color, text }
    };
    kinds.iter().map(entry).collect()
}

/// Mark and colour of an edge, told apart by either.
fn look(edge: Option<Edge>) -> (MarkerShape, Color32) {
    match edge {
        Some(Edge::Q) => (MarkerShape::Diamond, theme::method_color(Method::BallMaxArc)),
        Some(Edge::P) | None => (MarkerShape::Circle, theme::method_color(Method::BallFixedPoint)),
    }
}
