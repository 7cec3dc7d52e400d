//! The marks of all plots.

use std::f32::consts::TAU;

use egui::{Color32, Painter, Pos2, Rect, Shape, Stroke, Vec2};
use egui_plot::MarkerShape;

/// Corners of a drawn circle or ellipse: smooth at any size that fits a screen.
const NUM_CORNERS: u16 = 180;

/// A method's marker, or any other, of a given radius.
pub fn marker(painter: &Painter, shape: MarkerShape, centre: Pos2, radius: f32, fill: Color32, stroke: Stroke) {
    let corners = |angles: &[f32], size: f32| {
        let points = angles.iter().map(|angle| centre + size * Vec2::angled(*angle)).collect();
        Shape::convex_polygon(points, fill, stroke)
    };
    painter.add(match shape {
        MarkerShape::Up => corners(&[-TAU / 4.0, TAU / 12.0, TAU * 5.0 / 12.0], radius * 1.25),
        MarkerShape::Down => corners(&[TAU / 4.0, -TAU / 12.0, -TAU * 5.0 / 12.0], radius * 1.25),
        MarkerShape::Square => Shape::Rect(egui::epaint::RectShape::new(
            Rect::from_center_size(centre, Vec2::splat(radius * 1.8)),
            0.0,
            fill,
            stroke,
            egui::StrokeKind::Middle,
        )),
        MarkerShape::Diamond => corners(&[0.0, TAU / 4.0, TAU / 2.0, -TAU / 4.0], radius * 1.2),
        _ => Shape::Circle(egui::epaint::CircleShape { center: centre, radius, fill, stroke }),
    });
}

/// A line with a head.
pub fn arrow(painter: &Painter, from: Pos2, to: Pos2, stroke: Stroke) {
    let head = 5.0 + 1.5 * stroke.width;
    let along = to - from;
    if along.length() < 1.0 {
        return;
    }
    let along = along.normalized();
    let shaft_end = to - along * head.min((to - from).length());
    painter.line_segment([from, shaft_end], stroke);
    let side = along.rot90() * head * 0.45;
    let corners = vec![to, shaft_end + side, shaft_end - side];
    painter.add(egui::Shape::convex_polygon(corners, stroke.color, Stroke::new(0.0, Color32::TRANSPARENT)));
}

/// A vertical error bar with caps.
pub fn error_bar(painter: &Painter, low: Pos2, high: Pos2, stroke: Stroke) {
    const CAP: f32 = 3.0;
    painter.line_segment([low, high], stroke);
    for end in [low, high] {
        painter.hline(end.x - CAP..=end.x + CAP, end.y, stroke);
    }
}

/// A dashed line.
pub fn dashed_line(painter: &Painter, points: &[Pos2], stroke: Stroke) {
    painter.extend(Shape::dashed_line(points, stroke, 4.0, 4.0));
}

/// A dotted line.
pub fn dotted_line(painter: &Painter, points: &[Pos2], color: Color32) {
    painter.extend(Shape::dotted_line(points, color, 4.0, 0.9));
}

/// A dashed circle.
pub fn dashed_circle(painter: &Painter, centre: Pos2, radius: f32, stroke: Stroke) {
    let mut points = outline(centre, [radius, radius], 0.0);
    points.extend(points.first().copied());
    dashed_line(painter, &points, stroke);
}

/// An ellipse; `angle` is that of the first semi-axis on the screen, clockwise.
pub fn ellipse(painter: &Painter, centre: Pos2, semi_axes: [f32; 2], angle: f32, fill: Color32, stroke: Stroke) {
    painter.add(Shape::convex_polygon(outline(centre, semi_axes, angle), fill, stroke));
}

fn outline(centre: Pos2, [along, across]: [f32; 2], angle: f32) -> Vec<Pos2> {
    let axis = Vec2::angled(angle);
    (0..NUM_CORNERS)
        .map(|corner| {
            let on_circle = Vec2::angled(TAU * f32::from(corner) / f32::from(NUM_CORNERS));
            centre + axis * (along * on_circle.x) + axis.rot90() * (across * on_circle.y)
        })
        .collect()
}

/// At most one point a cell of `cell` points: what lies under another mark costs nothing to leave out.
pub fn thinned(points: impl Iterator<Item = Pos2>, clip: Rect, cell: f32) -> Vec<Pos2> {
    let clip = clip.expand(cell);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "positive and of the size of a screen")]
    let index = |offset: f32| (offset.max(0.0) / cell) as usize;
    let (columns, rows) = (index(clip.width()) + 1, index(clip.height()) + 1);
    let mut taken = vec![false; columns * rows];
    let mut kept = Vec::new();
    for point in points.filter(|point| clip.contains(*point)) {
        let offset = point - clip.min;
        let place = index(offset.y) * columns + index(offset.x);
        if let Some(taken) = taken.get_mut(place)
            && !std::mem::replace(taken, true)
        {
            kept.push(point);
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use egui::{pos2, vec2};

    use super::*;

    #[test]
    fn crowded_points_are_thinned_and_far_ones_left_out() {
        let clip = Rect::from_min_size(Pos2::ZERO, vec2(100.0, 10.0));
        let crowd = (0..10_000_u16).map(|idx| pos2(f32::from(idx) * 0.005, 5.0));
        let kept = thinned(crowd.chain([pos2(500.0, 5.0)]), clip, 1.0);
        assert!((50..=52).contains(&kept.len()), "{}", kept.len());
    }
}
