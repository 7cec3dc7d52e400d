//! The section's radius against the step, evaluated both ways.

use egui::{Align2, Id, Rect, Stroke, Ui, pos2, vec2};
use egui_plot::MarkerShape;

use crate::calibrate::{Method, Sweep, SweepPoint};
use crate::text::arcs as text;
use crate::ui::charts::{self, Canvas, Chart, Extent, LegendEntry, LegendGlyph};
use crate::ui::figures::{decimals_of_std, std_text};
use crate::ui::{theme, widgets};

use super::model::curve_points;
use super::profile::rule;

/// The part of the height that the curve takes; its residuals get the rest.
const CURVE_PART: f32 = 0.62;
/// Radius of a step's mark, points.
const STEP_RADIUS: f32 = 3.2;
/// Half the width of the published stop's label with some room, points.
const STOP_LABEL_HALF_WIDTH: f32 = 62.0;

/// What the pointer does.
#[derive(Clone, Copy, Debug, Default)]
pub struct CurveResponse {
    /// The capture under the pointer.
    pub hovered: Option<usize>,
    /// The capture clicked.
    pub clicked: Option<usize>,
}

/// Shows the curve and its residuals in the space available.
pub fn show(
    ui: &mut Ui,
    sweep: &Sweep,
    ball_radius_mm: f64,
    selected_capture: usize,
    hovered_capture: Option<usize>,
    is_fitted: &mut bool,
) -> CurveResponse {
    charts::legend(ui, &entries(ui));
    let group = Id::unique("arcs curve x");
    let curve_height = (ui.available_height() * CURVE_PART).round();
    let extent = curve_extent(sweep, ball_radius_mm);
    let mut chart = Chart::new(Id::unique("arcs curve"), text::TRAVEL_AXIS, text::RADIUS_AXIS, curve_height, extent);
    chart.x_group = Some(group);
    let curve = chart.show(ui, is_fitted);
    let hovered = curve.hovered(sweep.points.iter().map(|point| (point, [point.travel_mm, point.section_radius_mm])));
    let stop_name = paint_curve(ui, &curve, sweep, ball_radius_mm);

    rule(ui);
    let strip_extent = Extent { x: extent.x, y: residual_range(sweep) };
    let height = ui.available_height();
    let mut strip = Chart::new(
        Id::unique("arcs curve residuals"),
        text::TRAVEL_AXIS,
        text::CURVE_RESIDUAL_AXIS,
        height,
        strip_extent,
    );
    strip.x_group = Some(group);
    strip.follows_x = true;
    let strip = strip.show(ui, is_fitted);
    let in_strip =
        strip.hovered(sweep.points.iter().map(|point| (point, [point.travel_mm, point.residual_mm * 1000.0])));
    let zero = Stroke::new(1.0, theme::palette(ui).text_dim.gamma_multiply(0.6));
    strip.painter.hline(strip.rect().x_range(), strip.at(0.0, 0.0).y, zero);

    let emphasised = hovered.or(in_strip).map(|point| point.capture_idx).or(hovered_capture);
    for point in &sweep.points {
        let is_selected = point.capture_idx == selected_capture;
        paint_step(ui, &curve, [point.travel_mm, point.section_radius_mm], point.section_radius_std_mm, is_selected);
        let (residual_um, std_um) = (point.residual_mm * 1000.0, point.section_radius_std_mm * 1000.0);
        paint_step(ui, &strip, [point.travel_mm, residual_um], std_um, is_selected);
        if emphasised == Some(point.capture_idx) {
            let ring = Stroke::new(1.5, theme::palette(ui).accent);
            curve.painter.circle_stroke(curve.at(point.travel_mm, point.section_radius_mm), 7.0, ring);
            strip.painter.circle_stroke(strip.at(point.travel_mm, residual_um), 7.0, ring);
        }
    }
    note_peak(ui, &curve, sweep, ball_radius_mm, stop_name);
    if let Some(point) = hovered {
        readout(ui, &curve, point, curve.at(point.travel_mm, point.section_radius_mm));
    } else if let Some(point) = in_strip {
        readout(ui, &strip, point, strip.at(point.travel_mm, point.residual_mm * 1000.0));
    }
    let under_pointer = hovered.or(in_strip).map(|point| point.capture_idx);
    CurveResponse {
        hovered: under_pointer,
        clicked: under_pointer.filter(|_| curve.response.clicked() || strip.response.clicked()),
    }
}

fn entries(ui: &Ui) -> [LegendEntry; 2] {
    [
        LegendEntry {
            glyph: LegendGlyph::Hollow(MarkerShape::Circle),
            color: theme::palette(ui).text,
            text: text::MEASURED.to_owned(),
        },
        LegendEntry {
            glyph: LegendGlyph::Line,
            color: theme::method_color(Method::BallMaxArc),
            text: text::FITTED.to_owned(),
        },
    ]
}

fn curve_extent(sweep: &Sweep, ball_radius_mm: f64) -> Extent {
    let mut extent = Extent::NOTHING;
    for point in &sweep.points {
        extent.include(point.travel_mm, point.section_radius_mm);
    }
    let steps = extent.x[1] - extent.x[0];
    // A peak far beyond the steps would squeeze them into a corner.
    if (extent.x[0] - steps..=extent.x[1] + steps).contains(&sweep.peak_mm) {
        extent.include(sweep.peak_mm, ball_radius_mm);
    }
    extent.include(sweep.published_stop_mm, ball_radius_mm);
    // Room for the label above the line l = R, and for the published stop below the curve.
    let height = (extent.y[1] - extent.y[0]).max(ball_radius_mm * 1e-3);
    extent.include(extent.x[0], extent.y[1] + height * 0.08);
    extent
}

fn residual_range(sweep: &Sweep) -> [f64; 2] {
    let largest = sweep
        .points
        .iter()
        .map(|point| (point.residual_mm.abs() + point.section_radius_std_mm) * 1000.0)
        .fold(1.0, f64::max);
    [-largest * 1.1, largest * 1.1]
}

/// Paints everything but the steps and the peak's name; answers where the published stop's name stands.
fn paint_curve(ui: &Ui, canvas: &Canvas, sweep: &Sweep, ball_radius_mm: f64) -> Rect {
    let palette = theme::palette(ui);
    let color = theme::method_color(Method::BallMaxArc);
    let rect = canvas.rect();

    let [left, right] = [sweep.peak_mm - sweep.peak_std_mm, sweep.peak_mm + sweep.peak_std_mm]
        .map(|travel| canvas.at(travel, ball_radius_mm).x);
    let middle = f32::midpoint(left, right);
    // However sharp the peak, its band stays visible.
    let half = ((right - left) / 2.0).max(2.0);
    let band = Rect::from_x_y_ranges(middle - half..=middle + half, rect.y_range());
    canvas.painter.rect_filled(band, 0.0, color.gamma_multiply(0.28));

    let line_y = canvas.at(0.0, ball_radius_mm).y;
    let line = [pos2(rect.left(), line_y), pos2(rect.right(), line_y)];
    charts::dotted_line(&canvas.painter, &line, palette.text_dim);
    canvas.note(
        ui,
        pos2(rect.left() + 8.0, line_y - 3.0),
        Align2::LEFT_BOTTOM,
        text::BALL_RADIUS_LINE,
        palette.text_dim,
    );

    let bounds = canvas.transform.bounds().range_x();
    let curve = curve_points(sweep.peak_mm, ball_radius_mm, [*bounds.start(), *bounds.end()]);
    let curve = curve.into_iter().map(|[travel, radius]| canvas.at(travel, radius)).collect();
    canvas.painter.line(curve, Stroke::new(1.5, color));

    let on_curve = |travel_mm: f64| {
        let offset_mm = travel_mm - sweep.peak_mm;
        canvas.at(travel_mm, (ball_radius_mm * ball_radius_mm - offset_mm * offset_mm).max(0.0).sqrt())
    };
    let stop = on_curve(sweep.published_stop_mm) + vec2(0.0, 16.0);
    let stop_color = theme::method_color(Method::BallMaxArcStep);
    let surface = palette.surface;
    charts::marker(&canvas.painter, MarkerShape::Down, stop, 5.0, surface, Stroke::new(1.4, stop_color));
    let words = text::published_stop(&widgets::signed(sweep.published_stop_mm, 2));
    // The label stands where the curve leaves room for it on both sides, but not out of sight of its mark.
    let half_width_mm = f64::from(STOP_LABEL_HALF_WIDTH) / f64::from(canvas.scale().max(f32::MIN_POSITIVE));
    let flanks = [-half_width_mm, half_width_mm].map(|side| on_curve(sweep.published_stop_mm + side).y);
    let top = (flanks[0].max(flanks[1]) + 6.0).clamp(stop.y + 9.0, stop.y + 60.0);
    let anchor = pos2(stop.x, top);
    canvas.note(ui, anchor, Align2::CENTER_TOP, &words, palette.text_dim);
    canvas.note_rect(ui, anchor, Align2::CENTER_TOP, &words)
}

/// Names the peak beside its band, at the first height, from below, where neither steps nor curve nor `taken` are.
fn note_peak(ui: &Ui, canvas: &Canvas, sweep: &Sweep, ball_radius_mm: f64, taken: Rect) {
    /// How far apart the heights tried are, points.
    const TRY_EVERY: f32 = 12.0;
    const NUM_TRIES: u8 = 16;
    let words =
        text::peak(&widgets::signed(sweep.peak_mm, decimals_of_std(sweep.peak_std_mm)), &std_text(sweep.peak_std_mm));
    let [left, right] =
        [-sweep.peak_std_mm, sweep.peak_std_mm].map(|offset_mm| canvas.at(sweep.peak_mm + offset_mm, ball_radius_mm).x);
    let rect = canvas.rect();
    let bounds = canvas.transform.bounds().range_x();
    let mut marks: Vec<_> = curve_points(sweep.peak_mm, ball_radius_mm, [*bounds.start(), *bounds.end()])
        .into_iter()
        .map(|[travel, radius]| Rect::from_center_size(canvas.at(travel, radius), vec2(4.0, 4.0)))
        .collect();
    let side = vec2(STEP_RADIUS + 4.0, STEP_RADIUS + 4.0) * 2.0;
    marks.extend(
        sweep
            .points
            .iter()
            .map(|point| Rect::from_center_size(canvas.at(point.travel_mm, point.section_radius_mm), side)),
    );
    marks.push(taken.expand(3.0));
    let places = (0..NUM_TRIES).flat_map(|idx| {
        let y = rect.bottom() - 12.0 - f32::from(idx) * TRY_EVERY;
        [(pos2(right + 6.0, y), Align2::LEFT_BOTTOM), (pos2(left - 6.0, y), Align2::RIGHT_BOTTOM)]
    });
    let is_free = |(anchor, align): &(egui::Pos2, Align2)| {
        let place = canvas.note_rect(ui, *anchor, *align, &words);
        rect.contains_rect(place) && marks.iter().all(|mark| !mark.intersects(place))
    };
    let first = (pos2(right + 6.0, rect.bottom() - 12.0), Align2::LEFT_BOTTOM);
    let (anchor, align) = places.into_iter().find(is_free).unwrap_or(first);
    canvas.note(ui, anchor, align, &words, theme::palette(ui).text);
}

fn paint_step(ui: &Ui, canvas: &Canvas, [x, y]: [f64; 2], std: f64, is_selected: bool) {
    let palette = theme::palette(ui);
    let at = canvas.at(x, y);
    let stroke = Stroke::new(1.0, palette.text);
    charts::error_bar(&canvas.painter, canvas.at(x, y - std), canvas.at(x, y + std), stroke);
    if is_selected {
        canvas.painter.circle(at, STEP_RADIUS + 2.0, palette.accent, stroke);
    } else {
        canvas.painter.circle(at, STEP_RADIUS, palette.surface, Stroke::new(1.2, palette.text));
    }
}

fn readout(ui: &Ui, canvas: &Canvas, point: &SweepPoint, at: egui::Pos2) {
    let std = point.section_radius_std_mm;
    let words = text::step_readout(
        point.capture_idx + 1,
        &widgets::signed(point.travel_mm, 3),
        &widgets::fixed(point.section_radius_mm, decimals_of_std(std)),
        &std_text(std),
        &widgets::signed(point.residual_mm * 1000.0, 1),
    );
    canvas.note(ui, at + vec2(10.0, 12.0), Align2::LEFT_TOP, &words, theme::palette(ui).text);
}
