//! The section's radius against the step, evaluated both ways.

use egui::{Align2, Id, Rect, Stroke, Ui, pos2, vec2};
use egui_plot::MarkerShape;

use crate::calibrate::{Method, SweepPoint};
use crate::report::figure::model::{Curve, Peak, curve_extent, curve_points, residual_range};
use crate::text::arcs as text;
use crate::text::typeset::{decimals_of_std, std_text};
use crate::ui::charts::{self, Canvas, Chart, Extent, LegendEntry, LegendGlyph};
use crate::ui::{theme, widgets};

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

/// How a curve is shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurveLook<'a> {
    /// Tells its plots from those of other panels.
    pub name: &'static str,
    /// The ball's radius, mm.
    pub ball_radius_mm: f64,
    /// Title of the x axis.
    pub x_title: &'a str,
    /// The step that is filled.
    pub selected_capture: Option<usize>,
    /// The step that is ringed while the pointer is on none.
    pub hovered_capture: Option<usize>,
    /// Whether what the curve leaves stands below it.
    pub has_residuals: bool,
}

/// Shows the curve in the space available.
pub fn show(ui: &mut Ui, shown: &Curve<'_>, look: &CurveLook<'_>, is_fitted: &mut bool) -> CurveResponse {
    charts::legend(ui, &entries(ui, shown));
    let group = Id::unique((look.name, "x"));
    let part = if look.has_residuals { CURVE_PART } else { 1.0 };
    let curve_height = (ui.available_height() * part).round();
    let extent = curve_extent(shown, look.ball_radius_mm);
    let id = Id::unique((look.name, "curve"));
    let mut chart = Chart::new(id, look.x_title, text::RADIUS_AXIS, curve_height, extent);
    chart.x_group = Some(group);
    let curve = chart.show(ui, is_fitted);
    let hovered = curve.hovered(shown.points.iter().map(|point| (point, [point.travel_mm, point.section_radius_mm])));
    let stop_name = paint_curve(ui, &curve, shown, look.ball_radius_mm);
    let strip = look.has_residuals.then(|| residual_strip(ui, shown, look, extent, is_fitted));
    let in_strip = strip.as_ref().and_then(|strip| {
        strip.hovered(shown.points.iter().map(|point| (point, [point.travel_mm, point.residual_mm * 1000.0])))
    });

    let emphasised = hovered.or(in_strip).map(|point| point.capture_idx).or(look.hovered_capture);
    for point in shown.points {
        let is_selected = look.selected_capture == Some(point.capture_idx);
        let std_mm = point.section_radius_std_mm;
        let mut places = vec![(&curve, [point.travel_mm, point.section_radius_mm], std_mm)];
        places.extend(
            strip.as_ref().map(|strip| (strip, [point.travel_mm, point.residual_mm * 1000.0], std_mm * 1000.0)),
        );
        for (canvas, at, std) in places {
            paint_step(ui, canvas, at, std, is_selected);
            if emphasised == Some(point.capture_idx) {
                let ring = Stroke::new(1.5, theme::palette(ui).accent);
                canvas.painter.circle_stroke(canvas.at(at[0], at[1]), 7.0, ring);
            }
        }
    }
    if let Some(peak) = &shown.peak {
        note_peak(ui, &curve, shown.points, peak, look.ball_radius_mm, stop_name);
    }
    if let Some(point) = hovered {
        readout(ui, &curve, point, curve.at(point.travel_mm, point.section_radius_mm));
    } else if let (Some(strip), Some(point)) = (&strip, in_strip) {
        readout(ui, strip, point, strip.at(point.travel_mm, point.residual_mm * 1000.0));
    }
    let has_clicked = curve.response.clicked() || strip.is_some_and(|strip| strip.response.clicked());
    let under_pointer = hovered.or(in_strip).map(|point| point.capture_idx);
    CurveResponse { hovered: under_pointer, clicked: under_pointer.filter(|_| has_clicked) }
}

/// What the curve leaves of the radii, below it.
fn residual_strip(
    ui: &mut Ui,
    shown: &Curve<'_>,
    look: &CurveLook<'_>,
    extent: Extent,
    is_fitted: &mut bool,
) -> Canvas {
    rule(ui);
    let strip_extent = Extent { x: extent.x, y: residual_range(shown.points) };
    let height = ui.available_height();
    let id = Id::unique((look.name, "residuals"));
    let mut strip = Chart::new(id, look.x_title, text::CURVE_RESIDUAL_AXIS, height, strip_extent);
    strip.x_group = Some(Id::unique((look.name, "x")));
    strip.follows_x = true;
    let strip = strip.show(ui, is_fitted);
    let zero = Stroke::new(1.0, theme::palette(ui).text_dim.gamma_multiply(0.6));
    strip.painter.hline(strip.rect().x_range(), strip.at(0.0, 0.0).y, zero);
    strip
}

fn entries(ui: &Ui, shown: &Curve<'_>) -> Vec<LegendEntry> {
    let mut entries = vec![LegendEntry {
        glyph: LegendGlyph::Hollow(MarkerShape::Circle),
        color: theme::palette(ui).text,
        text: text::MEASURED.to_owned(),
    }];
    if let Some(peak) = shown.peak {
        let color = theme::method_color(Method::BallMaxArc);
        // Along the laser's normal the factor is 1, and not written.
        let is_along_normal = (peak.curvature - 1.0).abs() < 0.0005;
        let text = if is_along_normal { text::FITTED.to_owned() } else { text::fitted_at_slant(peak.curvature) };
        entries.push(LegendEntry { glyph: LegendGlyph::Line, color, text });
    }
    entries
}

/// Paints everything but the steps and the peak's name; answers where the published stop's name stands.
fn paint_curve(ui: &Ui, canvas: &Canvas, shown: &Curve<'_>, ball_radius_mm: f64) -> Option<Rect> {
    let palette = theme::palette(ui);
    let rect = canvas.rect();
    if let Some(peak) = &shown.peak {
        paint_peak(canvas, peak, ball_radius_mm);
    }
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
    let (stop_mm, peak) = (shown.published_stop_mm?, shown.peak.as_ref()?);
    Some(paint_published_stop(ui, canvas, stop_mm, peak, ball_radius_mm))
}

/// The band of ±σ around the peak, and the curve.
fn paint_peak(canvas: &Canvas, peak: &Peak, ball_radius_mm: f64) {
    let color = theme::method_color(Method::BallMaxArc);
    let [left, right] =
        [peak.travel_mm - peak.std_mm, peak.travel_mm + peak.std_mm].map(|travel| canvas.at(travel, ball_radius_mm).x);
    let middle = f32::midpoint(left, right);
    // However sharp the peak, its band stays visible.
    let half = ((right - left) / 2.0).max(2.0);
    let band = Rect::from_x_y_ranges(middle - half..=middle + half, canvas.rect().y_range());
    canvas.painter.rect_filled(band, 0.0, color.gamma_multiply(0.28));

    let bounds = canvas.transform.bounds().range_x();
    let curve = curve_points(peak, ball_radius_mm, [*bounds.start(), *bounds.end()]);
    let curve = curve.into_iter().map(|[travel, radius]| canvas.at(travel, radius)).collect();
    canvas.painter.line(curve, Stroke::new(1.5, color));
}

fn paint_published_stop(ui: &Ui, canvas: &Canvas, stop_mm: f64, peak: &Peak, ball_radius_mm: f64) -> Rect {
    let palette = theme::palette(ui);
    let on_curve = |travel_mm: f64| canvas.at(travel_mm, peak.section_radius_mm(travel_mm, ball_radius_mm));
    let stop = on_curve(stop_mm) + vec2(0.0, 16.0);
    let stop_color = theme::method_color(Method::BallMaxArcStep);
    charts::marker(&canvas.painter, MarkerShape::Down, stop, 5.0, palette.surface, Stroke::new(1.4, stop_color));
    let words = text::published_stop(&widgets::signed(stop_mm, 2));
    // The label stands where the curve leaves room for it on both sides, but not out of sight of its mark.
    let half_width_mm = f64::from(STOP_LABEL_HALF_WIDTH) / f64::from(canvas.scale().max(f32::MIN_POSITIVE));
    let flanks = [-half_width_mm, half_width_mm].map(|side| on_curve(stop_mm + side).y);
    let top = (flanks[0].max(flanks[1]) + 6.0).clamp(stop.y + 9.0, stop.y + 60.0);
    let anchor = pos2(stop.x, top);
    canvas.note(ui, anchor, Align2::CENTER_TOP, &words, palette.text_dim);
    canvas.note_rect(ui, anchor, Align2::CENTER_TOP, &words)
}

/// Names the peak beside its band, at the first height, from below, where neither steps nor curve nor `taken` are.
fn note_peak(ui: &Ui, canvas: &Canvas, points: &[SweepPoint], peak: &Peak, ball_radius_mm: f64, taken: Option<Rect>) {
    /// How far apart the heights tried are, points.
    const TRY_EVERY: f32 = 12.0;
    const NUM_TRIES: u8 = 16;
    let words = text::peak(&widgets::signed(peak.travel_mm, decimals_of_std(peak.std_mm)), &std_text(peak.std_mm));
    let [left, right] =
        [-peak.std_mm, peak.std_mm].map(|offset_mm| canvas.at(peak.travel_mm + offset_mm, ball_radius_mm).x);
    let rect = canvas.rect();
    let bounds = canvas.transform.bounds().range_x();
    let mut marks: Vec<_> = curve_points(peak, ball_radius_mm, [*bounds.start(), *bounds.end()])
        .into_iter()
        .map(|[travel, radius]| Rect::from_center_size(canvas.at(travel, radius), vec2(4.0, 4.0)))
        .collect();
    let side = vec2(STEP_RADIUS + 4.0, STEP_RADIUS + 4.0) * 2.0;
    marks.extend(
        points.iter().map(|point| Rect::from_center_size(canvas.at(point.travel_mm, point.section_radius_mm), side)),
    );
    marks.extend(taken.map(|taken| taken.expand(3.0)));
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
