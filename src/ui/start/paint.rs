//! The small pictures on the samples' cards, drawn from the samples' own data.

use egui::{Color32, Painter, Pos2, Rect, Stroke, pos2, vec2};

use crate::ui::theme::{self, Palette};

use super::model::SamplePreview;

/// Draws a sample's picture: its profile in true scale with the laser above, or its reduced points.
pub fn picture(painter: &Painter, rect: Rect, palette: &Palette, preview: Option<&SamplePreview>) {
    painter.rect_filled(rect, 0.0, palette.canvas);
    let Some(preview) = preview else { return };
    let points: Vec<[f64; 2]> = preview.strokes.iter().flatten().copied().collect();
    let Some(view) = View::around(&points, rect.shrink2(vec2(16.0, 12.0))) else { return };
    if preview.is_points_only {
        paint_points(painter, &view, palette, &points);
    } else {
        paint_profile(painter, rect, &view, palette, &points);
    }
}

fn paint_profile(painter: &Painter, rect: Rect, view: &View, palette: &Palette, points: &[[f64; 2]]) {
    // The fan of laser light, faint, from above the picture to the ends of the profile.
    if let (Some(first), Some(last)) = (points.first(), points.last()) {
        let source = pos2(rect.center().x, rect.top());
        let fan = vec![source, view.map(*first), view.map(*last)];
        let light = Color32::from_rgba_unmultiplied(palette.bad.r(), palette.bad.g(), palette.bad.b(), 16);
        painter.add(egui::Shape::convex_polygon(fan, light, Stroke::NONE));
    }
    for &point in points {
        painter.circle_filled(view.map(point), 1.2, theme::INLIER);
    }
}

fn paint_points(painter: &Painter, view: &View, palette: &Palette, points: &[[f64; 2]]) {
    for &point in points {
        let center = view.map(point);
        painter.circle_stroke(center, 9.0, Stroke::new(1.0, palette.hairline));
        painter.circle_filled(center, 3.0, theme::INLIER);
    }
}

/// Maps millimetres in the laser plane to the picture, in true scale, z pointing down as seen from the sensor.
struct View {
    middle: [f64; 2],
    center: Pos2,
    points_per_mm: f32,
}

impl View {
    fn around(points: &[[f64; 2]], rect: Rect) -> Option<Self> {
        let range = |axis: usize| {
            let values = points.iter().map(|point| point[axis]);
            values.fold(None, |range: Option<(f64, f64)>, value| {
                Some(range.map_or((value, value), |(low, high)| (low.min(value), high.max(value))))
            })
        };
        let ((x_low, x_high), (z_low, z_high)) = (range(0)?, range(1)?);
        let scale = |extent: f64, available: f32| available / to_screen(extent.max(1.0));
        Some(Self {
            middle: [f64::midpoint(x_low, x_high), f64::midpoint(z_low, z_high)],
            center: rect.center(),
            points_per_mm: scale(x_high - x_low, rect.width()).min(scale(z_high - z_low, rect.height())),
        })
    }

    fn map(&self, [x, z]: [f64; 2]) -> Pos2 {
        let offset = vec2(to_screen(x - self.middle[0]), to_screen(z - self.middle[1]));
        self.center + offset * self.points_per_mm
    }
}

#[expect(clippy::cast_possible_truncation, reason = "a picture needs no more than single precision")]
const fn to_screen(value: f64) -> f32 {
    value as f32
}
