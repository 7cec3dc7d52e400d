//! The plate's points in space, with the fitted lines and plane; deviations are drawn larger than they are, and it is said how
//! much.

use egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Role, Sense, Shape, Stroke, Ui, Vec2, WidgetInfo, vec2};

use crate::calibrate::Edge;
use crate::geometry::{Mat3, Vec3};
use crate::report::figure::Orbit;
use crate::text::verify as words;
use crate::ui::eye::{self, Eye};
use crate::ui::{theme, widgets};
use crate::verify::Distances;

use super::marks::Mark;

/// From where the plate is seen at first, about its normal.
pub const AT_FIRST: Orbit = Orbit::new(-0.951, 0.62);
/// Deviations are enlarged until the largest is this part of the picture.
const DEVIATION_PART: f64 = 0.13;
/// Room between the outermost points and the border of the plane, as a part of their extent.
const MARGIN_PART: f64 = 0.07;
/// Room around the plane for letters, caption and hint, points.
const ROOM_AROUND: Vec2 = vec2(28.0, 44.0);
/// Lines of the plane's mesh each way.
const MESH_LINES: u8 = 6;

/// What is drawn, in the plate's frame about the centroid, mm.
struct Scene {
    plate_from_base: Mat3,
    /// The middle of the points, in the base.
    middle: Vec3,
    /// Half the extent of the points along the plate's axes, with a margin.
    half_mm: [f64; 2],
    enlarged: f64,
}

impl Scene {
    fn of(distances: &Distances) -> Self {
        let centroid = distances.centroid_mm;
        let up = if distances.plane.normal.z < 0.0 { -distances.plane.normal } else { distances.plane.normal };
        let along = distances.lines[0].direction - up * up.dot(&distances.lines[0].direction);
        let along = along.try_normalize(0.0).unwrap_or_else(Vec3::x);
        let plate_from_base = Mat3::from_columns(&[along, up.cross(&along), up]).transpose();
        let in_plate = || distances.points.iter().map(|point| plate_from_base * (point.point_in_base_mm - centroid));
        let range = |axis: usize| {
            in_plate()
                .map(|point| point[axis])
                .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)])
        };
        let [x, y] = [range(0), range(1)];
        let centre = Vec3::new(f64::midpoint(x[0], x[1]), f64::midpoint(y[0], y[1]), 0.0);
        let margin = MARGIN_PART * (x[1] - x[0]).max(y[1] - y[0]).max(1.0);
        let half_mm = [x, y].map(|[low, high]| (high - low) / 2.0 + margin);
        let worst_mm = distances.points.iter().map(|point| point.to_line_mm).fold(0.0, f64::max);
        let reach_mm = half_mm[0].max(half_mm[1]);
        Self {
            plate_from_base,
            middle: centroid + plate_from_base.transpose() * centre,
            half_mm,
            enlarged: enlarged(DEVIATION_PART * reach_mm, worst_mm),
        }
    }

    fn in_plate(&self, point_in_base: Vec3) -> Vec3 {
        self.plate_from_base * (point_in_base - self.middle)
    }

    /// The corners of the plane that is drawn.
    fn corners(&self) -> [Vec3; 4] {
        let [x, y] = self.half_mm;
        [[-x, -y], [x, -y], [x, y], [-x, y]].map(|[x, y]| Vec3::new(x, y, 0.0))
    }
}

/// The largest round factor (1, 2 or 5 times a power of ten) by which a deviation stays below a length.
fn enlarged(length_mm: f64, deviation_mm: f64) -> f64 {
    let factor = length_mm / deviation_mm;
    if !(factor.is_finite() && factor > 1.0) {
        return 1.0;
    }
    let decade = 10.0_f64.powf(factor.log10().floor());
    [5.0, 2.0, 1.0].into_iter().map(|step| step * decade).find(|step| *step <= factor).unwrap_or(1.0).min(1e5)
}

/// Shows the picture in the space available.
pub fn show(ui: &mut Ui, distances: &Distances, mark: &Mark, eye: &mut Eye) {
    let place = ui.available_rect_before_wrap();
    let response = ui.interact(place, ui.scope_id().with("space"), Sense::click_and_drag());
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, words::space_name(&mark.name)));
    eye.steer(ui, &response);
    let scene = Scene::of(distances);
    let view = View::new(place, &scene, *eye);
    let painter = ui.painter().with_clip_rect(place.intersect(ui.clip_rect()));
    let palette = theme::palette(ui);
    paint_plane(&painter, &scene, &view, palette.text_dim);
    paint_lines(&painter, &scene, &view, distances, palette.text);
    let mut seen: Vec<(Pos2, usize)> = Vec::with_capacity(distances.points.len());
    for (idx, point) in distances.points.iter().enumerate() {
        let line = &distances.lines[usize::from(point.edge == Edge::Q)];
        let offset = line.offset_mm(point.point_in_base_mm);
        let foot = view.at(scene.in_plate(point.point_in_base_mm - offset));
        let at = view.at(scene.in_plate(point.point_in_base_mm - offset + offset * scene.enlarged));
        painter.line_segment([foot, at], Stroke::new(1.2, mark.color.gamma_multiply(0.7)));
        seen.push((at, idx));
    }
    for (at, _) in &seen {
        painter.circle_filled(*at, 5.0, palette.surface.gamma_multiply(0.7));
        mark.paint(&painter, *at);
    }
    // The base's axes.
    let axes = [Vec3::x(), Vec3::y(), Vec3::z()].map(|axis| scene.plate_from_base * axis);
    eye.triad(&painter, place, axes, theme::axis_colors(ui));
    let caption = words::enlarged(&widgets::fixed(scene.enlarged, 0));
    eye::captions(&painter, place, caption, words::SPACE_HINT, palette.text_dim);
    let nearest = response.hover_pos().and_then(|pointer| {
        let near = seen.iter().map(|(at, idx)| (at.distance(pointer), *at, *idx));
        near.filter(|(distance, ..)| *distance < 10.0).min_by(|a, b| a.0.total_cmp(&b.0))
    });
    if let Some((_, at, idx)) = nearest {
        let point = &distances.points[idx];
        let figures = [point.to_line_mm, point.to_plane_mm].map(|distance| widgets::fixed(distance, 3));
        let note = words::point_readout(&point.label, point.edge, &figures[0], &figures[1]);
        let font = FontId::proportional(theme::SMALL_SIZE);
        let galley = painter.layout_no_wrap(note, font, palette.text);
        let wanted = Align2::LEFT_BOTTOM.anchor_size(at + vec2(10.0, -6.0), galley.size());
        let left = wanted.left().min(place.right() - wanted.width() - 4.0).max(place.left() + 4.0);
        let rect = wanted.translate(vec2(left - wanted.left(), 0.0));
        painter.rect_filled(rect.expand2(vec2(4.0, 2.0)), 2.0, palette.surface.gamma_multiply(0.9));
        painter.galley(rect.min, galley, palette.text);
    }
    ui.advance_cursor_after_rect(place);
}

/// From the plate's frame to the screen, without perspective: parallel edges stay parallel.
struct View {
    eye: Eye,
    centre: Pos2,
    points_a_mm: f64,
}

impl View {
    fn new(place: Rect, scene: &Scene, eye: Eye) -> Self {
        // As large as the plane fits as it is seen at first, so that turning does not make it grow or shrink.
        let half =
            |axis: usize| scene.corners().iter().map(|corner| AT_FIRST.seen(*corner)[axis].abs()).fold(1.0, f64::max);
        let room = place.shrink2(ROOM_AROUND).size() / 2.0;
        let fitted = (f64::from(room.x.max(1.0)) / half(0)).min(f64::from(room.y.max(1.0)) / half(1));
        Self { eye, centre: place.center(), points_a_mm: fitted * eye.zoom() }
    }

    /// Where a point of the plate's frame is on the screen.
    fn at(&self, in_plate: Vec3) -> Pos2 {
        self.centre + self.eye.on_screen(in_plate * self.points_a_mm)
    }
}

fn paint_plane(painter: &Painter, scene: &Scene, view: &View, color: Color32) {
    let corners = scene.corners().map(|corner| view.at(corner));
    let outline = Stroke::new(1.0, color.gamma_multiply(0.4));
    painter.add(Shape::convex_polygon(corners.to_vec(), color.gamma_multiply(0.07), outline));
    let [a, b, c, d] = corners;
    for number in 1..MESH_LINES {
        let part = f32::from(number) / f32::from(MESH_LINES);
        let stroke = Stroke::new(1.0, color.gamma_multiply(0.16));
        painter.line_segment([a.lerp(b, part), d.lerp(c, part)], stroke);
        painter.line_segment([a.lerp(d, part), b.lerp(c, part)], stroke);
    }
}

fn paint_lines(painter: &Painter, scene: &Scene, view: &View, distances: &Distances, color: Color32) {
    for (line, edge) in distances.lines.iter().zip([Edge::P, Edge::Q]) {
        let along = |point: &Vec3| line.direction.dot(&(point - line.point_mm));
        let on_edge = distances.points.iter().filter(|point| point.edge == edge);
        let (low, high) = on_edge
            .map(|point| along(&point.point_in_base_mm))
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
        let margin = 0.5 * MARGIN_PART * scene.half_mm[0].max(scene.half_mm[1]);
        let ends = [low - margin, high + margin]
            .map(|length| view.at(scene.in_plate(line.point_mm + line.direction * length)));
        painter.line_segment(ends, Stroke::new(1.8, color));
        // Beside the end that is farther from the middle of the plate.
        let [near, far] =
            if ends[0].distance(view.centre) > ends[1].distance(view.centre) { [ends[1], ends[0]] } else { ends };
        let outwards = (far - near).normalized() * 12.0;
        let font = FontId::proportional(theme::BODY_SIZE);
        painter.text(far + outwards, Align2::CENTER_CENTER, words::edge_letter(edge), font, color);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn deviations_are_enlarged_by_round_factors_and_never_made_smaller() {
        for (length_mm, deviation_mm, factor) in [(10.0, 0.09, 100.0), (10.0, 0.03, 200.0), (10.0, 50.0, 1.0)] {
            assert!((enlarged(length_mm, deviation_mm) - factor).abs() < 1e-9);
        }
        assert!(enlarged(10.0, 0.0).is_finite());
    }
}
