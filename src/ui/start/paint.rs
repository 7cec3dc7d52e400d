//! The small pictures on the samples' cards, drawn from the samples' own data.

use egui::{Painter, Pos2, Rect, Stroke, vec2};

use crate::ui::theme::{self, Palette};

use super::model::SamplePreview;

/// Draws a sample's picture: its profiles in true scale, or its reduced points.
pub fn picture(painter: &Painter, rect: Rect, palette: &Palette, preview: Option<&SamplePreview>) {
    painter.rect_filled(rect, 0.0, palette.canvas);
    let Some(preview) = preview else { return };
    let points: Vec<[f64; 2]> = preview.strokes.iter().flatten().copied().collect();
    let Some(view) = View::around(&points, rect.shrink2(vec2(16.0, 12.0))) else { return };
    if preview.is_points_only {
        paint_points(painter, &view, palette, &points);
    } else {
        paint_profiles(painter, &view, palette, &preview.strokes);
    }
}

/// The profile in the middle of the sweep in full colour, the others faint behind it.
fn paint_profiles(painter: &Painter, view: &View, palette: &Palette, strokes: &[Vec<[f64; 2]>]) {
    let middle_idx = strokes.len() / 2;
    let faint = theme::INLIER.lerp_to_gamma(palette.canvas, 0.72);
    let mut order: Vec<usize> = (0..strokes.len()).filter(|idx| *idx != middle_idx).collect();
    order.push(middle_idx);
    for idx in order {
        let (color, radius) = if idx == middle_idx { (theme::INLIER, 1.3) } else { (faint, 0.9) };
        for &point in strokes.get(idx).into_iter().flatten() {
            painter.circle_filled(view.map(point), radius, color);
        }
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
