//! The small pictures on the samples' cards, drawn from the samples' own data.

use egui::{Color32, Painter, Pos2, Rect, Shape, Stroke, vec2};

use crate::ui::theme::{self, Palette};

use super::model::{Drawn, SamplePreview};

/// Draws a sample's picture in true scale.
pub fn picture(painter: &Painter, rect: Rect, palette: &Palette, preview: Option<&SamplePreview>) {
    painter.rect_filled(rect, 0.0, palette.canvas);
    let Some(preview) = preview else { return };
    let points: Vec<[f64; 2]> = preview.strokes.iter().flatten().copied().collect();
    let Some(view) = View::around(&points, rect.shrink2(vec2(16.0, 12.0))) else { return };
    match preview.drawn {
        Drawn::Profiles => paint_profiles(painter, &view, palette, &preview.strokes),
        Drawn::Points => paint_points(painter, &view, palette, &points),
        Drawn::Boards => paint_boards(painter, &view, palette, &preview.strokes),
        Drawn::Way => paint_way(painter, &view, palette, &points),
    }
}

/// Strokes with their colour: all but the middle one are faint, and it is the last, over the others.
fn one_of_many<'a>(
    strokes: &'a [Vec<[f64; 2]>],
    palette: &Palette,
) -> impl Iterator<Item = (&'a [[f64; 2]], Color32, bool)> + use<'a> {
    let middle_idx = strokes.len() / 2;
    let faint = theme::INLIER.lerp_to_gamma(palette.canvas, 0.72);
    let others = strokes.iter().enumerate().filter(move |(idx, _)| *idx != middle_idx);
    let others = others.map(move |(_, stroke)| (stroke.as_slice(), faint, false));
    others.chain(strokes.get(middle_idx).map(|stroke| (stroke.as_slice(), theme::INLIER, true)))
}

/// The profile in the middle of the sweep in full colour, the others faint behind it.
fn paint_profiles(painter: &Painter, view: &View, palette: &Palette, strokes: &[Vec<[f64; 2]>]) {
    for (profile, color, is_middle) in one_of_many(strokes, palette) {
        let radius = if is_middle { 1.3 } else { 0.9 };
        for &point in profile {
            painter.circle_filled(view.map(point), radius, color);
        }
    }
}

/// A board with its middle, the others faint behind it.
fn paint_boards(painter: &Painter, view: &View, palette: &Palette, strokes: &[Vec<[f64; 2]>]) {
    for (board, color, is_middle) in one_of_many(strokes, palette) {
        let corners: Vec<Pos2> = board.iter().map(|corner| view.map(*corner)).collect();
        painter.add(Shape::closed_line(corners.clone(), Stroke::new(if is_middle { 1.6 } else { 1.0 }, color)));
        if let [a, b, c, d] = corners[..] {
            painter.circle_filled(a.lerp(c, 0.5), if is_middle { 2.4 } else { 1.4 }, color);
            if is_middle {
                painter.line_segment([a.lerp(b, 0.5), c.lerp(d, 0.5)], Stroke::new(0.8, color));
                painter.line_segment([b.lerp(c, 0.5), d.lerp(a, 0.5)], Stroke::new(0.8, color));
            }
        }
    }
}

/// The way with a ring where it begins.
fn paint_way(painter: &Painter, view: &View, palette: &Palette, points: &[[f64; 2]]) {
    let way: Vec<Pos2> = points.iter().map(|point| view.map(*point)).collect();
    let start = way.first().copied();
    painter.add(Shape::line(way, Stroke::new(2.0, theme::INLIER)));
    if let Some(start) = start {
        painter.circle(start, 4.0, palette.canvas, Stroke::new(1.5, theme::INLIER));
    }
}

fn paint_points(painter: &Painter, view: &View, palette: &Palette, points: &[[f64; 2]]) {
    for &point in points {
        let center = view.map(point);
        painter.circle_stroke(center, 9.0, Stroke::new(1.0, palette.hairline));
        painter.circle_filled(center, 3.0, theme::INLIER);
    }
}

/// Maps millimetres to the picture, in true scale: the second axis points down, as z does seen from a profiler.
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
