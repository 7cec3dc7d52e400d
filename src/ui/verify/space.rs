//! The plate's points in space, with the fitted lines and plane; deviations are drawn larger than they are, and it is said how
//! much.

use egui::{Align2, Color32, FontId, Key, Painter, Pos2, Rect, Role, Sense, Shape, Stroke, Ui, Vec2, WidgetInfo, vec2};

use crate::calibrate::Edge;
use crate::geometry::{Mat3, Vec3, so3};
use crate::text::verify as words;
use crate::ui::charts::arrow;
use crate::ui::{charts, theme, widgets};
use crate::verify::Distances;

use super::marks::Mark;

/// From where the plate is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Turn about the plate's normal, rad.
    yaw: f64,
    /// Height above the plate's plane, rad.
    pitch: f64,
    zoom: f64,
}

impl Default for Camera {
    fn default() -> Self {
        Self { yaw: -0.62, pitch: 0.62, zoom: 1.0 }
    }
}

/// Turn a point of dragging, rad.
const TURN_A_POINT: f64 = 0.008;
/// Turn a press of an arrow key, rad.
const TURN_A_KEY: f64 = 0.12;
/// Deviations are enlarged until the largest is this part of the picture.
const DEVIATION_PART: f64 = 0.13;
/// Lines of the plane's mesh each way.
const MESH_LINES: u8 = 6;

/// What is drawn, in the plate's frame about the centroid, mm.
struct Scene {
    plate_from_base: Mat3,
    centroid: Vec3,
    reach_mm: f64,
    enlarged: f64,
}

impl Scene {
    fn of(distances: &Distances) -> Self {
        let centroid = distances.plane.point_mm;
        let up = if distances.plane.normal.z < 0.0 { -distances.plane.normal } else { distances.plane.normal };
        let along = distances.lines[0].direction - up * up.dot(&distances.lines[0].direction);
        let along = along.try_normalize(0.0).unwrap_or_else(Vec3::x);
        let plate_from_base = Mat3::from_columns(&[along, up.cross(&along), up]).transpose();
        let reach_mm =
            distances.points.iter().map(|point| (point.point_in_base_mm - centroid).norm()).fold(1.0, f64::max);
        let worst_mm = distances.points.iter().map(|point| point.to_line_mm).fold(0.0, f64::max);
        Self { plate_from_base, centroid, reach_mm, enlarged: enlarged(DEVIATION_PART * reach_mm, worst_mm) }
    }

    fn in_plate(&self, point_in_base: Vec3) -> Vec3 {
        self.plate_from_base * (point_in_base - self.centroid)
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
pub fn show(ui: &mut Ui, distances: &Distances, mark: &Mark, camera: &mut Camera) {
    let place = ui.available_rect_before_wrap();
    let response = ui.interact(place, ui.scope_id().with("space"), Sense::click_and_drag());
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, words::space_name(&mark.name)));
    steer(ui, &response, camera);
    let scene = Scene::of(distances);
    let view = View::new(place, &scene, camera);
    let painter = ui.painter().with_clip_rect(place.intersect(ui.clip_rect()));
    let palette = theme::palette(ui);
    paint_plane(&painter, &scene, &view, distances, palette.text_dim);
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
        charts::marker(&painter, mark.shape, *at, 4.5, mark.color, Stroke::new(0.8, palette.surface));
    }
    paint_triad(&painter, &scene, &view, place, theme::axis_colors(ui));
    let font = FontId::proportional(theme::SMALL_SIZE);
    let caption = words::enlarged(&widgets::fixed(scene.enlarged, 0));
    painter.text(place.left_top() + vec2(12.0, 8.0), Align2::LEFT_TOP, caption, font.clone(), palette.text_dim);
    let hint = place.right_bottom() - vec2(12.0, 8.0);
    painter.text(hint, Align2::RIGHT_BOTTOM, words::SPACE_HINT, font.clone(), palette.text_dim);
    let nearest = response.hover_pos().and_then(|pointer| {
        let near = seen.iter().map(|(at, idx)| (at.distance(pointer), *at, *idx));
        near.filter(|(distance, ..)| *distance < 10.0).min_by(|a, b| a.0.total_cmp(&b.0))
    });
    if let Some((_, at, idx)) = nearest {
        let point = &distances.points[idx];
        let figures = [point.to_line_mm, point.to_plane_mm].map(|distance| widgets::fixed(distance, 3));
        let note = words::point_readout(&point.label, point.edge, &figures[0], &figures[1]);
        let galley = painter.layout_no_wrap(note, font, palette.text);
        let wanted = Align2::LEFT_BOTTOM.anchor_size(at + vec2(10.0, -6.0), galley.size());
        let left = wanted.left().min(place.right() - wanted.width() - 4.0).max(place.left() + 4.0);
        let rect = wanted.translate(vec2(left - wanted.left(), 0.0));
        painter.rect_filled(rect.expand2(vec2(4.0, 2.0)), 2.0, palette.surface.gamma_multiply(0.9));
        painter.galley(rect.min, galley, palette.text);
    }
    ui.advance_cursor_after_rect(place);
}

fn steer(ui: &Ui, response: &egui::Response, camera: &mut Camera) {
    let mut turn = Vec2::ZERO;
    if response.dragged() {
        turn = response.drag_delta();
    }
    camera.yaw += f64::from(turn.x) * TURN_A_POINT;
    camera.pitch += f64::from(turn.y) * TURN_A_POINT;
    if response.clicked() {
        response.request_focus();
    }
    if response.has_focus() {
        ui.input(|input| {
            for (key, yaw, pitch) in [
                (Key::ArrowLeft, -1.0, 0.0),
                (Key::ArrowRight, 1.0, 0.0),
                (Key::ArrowUp, 0.0, 1.0),
                (Key::ArrowDown, 0.0, -1.0),
            ] {
                if input.key_pressed(key) {
                    camera.yaw += yaw * TURN_A_KEY;
                    camera.pitch += pitch * TURN_A_KEY;
                }
            }
        });
    }
    if response.hovered() {
        // What is scrolled over the picture is not for the page below it.
        let scrolled = ui.ctx().input_mut(|input| std::mem::take(&mut input.smooth_scroll_delta).y);
        let zoom = ui.input(egui::InputState::zoom_delta);
        camera.zoom *= f64::from(zoom) * (f64::from(scrolled) * 0.004).exp();
    }
    camera.pitch = camera.pitch.clamp(-1.55, 1.55);
    camera.zoom = camera.zoom.clamp(0.3, 30.0);
    if response.double_clicked() {
        *camera = Camera::default();
    }
}

/// From the plate's frame to the screen, without perspective: parallel edges stay parallel.
struct View {
    screen_from_plate: Mat3,
    centre: Pos2,
    points_a_mm: f64,
}

impl View {
    fn new(place: Rect, scene: &Scene, camera: &Camera) -> Self {
        let pitched = so3::exp(Vec3::x() * (camera.pitch - std::f64::consts::FRAC_PI_2));
        let turned = pitched * so3::exp(Vec3::z() * camera.yaw);
        let room = f64::from(place.width().min(place.height() * 1.35)) * 0.46;
        Self {
            screen_from_plate: turned.to_rotation_matrix().into_inner(),
            centre: place.center() + vec2(0.0, 6.0),
            points_a_mm: room * camera.zoom / scene.reach_mm,
        }
    }

    /// Where a point of the plate's frame is on the screen.
    fn at(&self, in_plate: Vec3) -> Pos2 {
        self.centre + self.direction(in_plate * self.points_a_mm)
    }

    #[expect(clippy::cast_possible_truncation, reason = "screen coordinates")]
    fn direction(&self, in_plate: Vec3) -> Vec2 {
        let seen = self.screen_from_plate * in_plate;
        vec2(seen.x as f32, -seen.y as f32)
    }
}

fn paint_plane(painter: &Painter, scene: &Scene, view: &View, distances: &Distances, color: Color32) {
    let in_plate = || distances.points.iter().map(|point| scene.in_plate(point.point_in_base_mm));
    let range = |axis: usize| {
        let (low, high) = in_plate()
            .map(|point| point[axis])
            .fold((0.0_f64, 0.0_f64), |(low, high), value| (low.min(value), high.max(value)));
        let margin = 0.08 * scene.reach_mm;
        [low - margin, high + margin]
    };
    let [x, y] = [range(0), range(1)];
    let corner = |x: f64, y: f64| view.at(Vec3::new(x, y, 0.0));
    let corners = vec![corner(x[0], y[0]), corner(x[1], y[0]), corner(x[1], y[1]), corner(x[0], y[1])];
    painter.add(Shape::convex_polygon(
        corners,
        color.gamma_multiply(0.07),
        Stroke::new(1.0, color.gamma_multiply(0.4)),
    ));
    for number in 1..MESH_LINES {
        let part = f64::from(number) / f64::from(MESH_LINES);
        let at = |[low, high]: [f64; 2]| low + part * (high - low);
        let stroke = Stroke::new(1.0, color.gamma_multiply(0.16));
        painter.line_segment([corner(at(x), y[0]), corner(at(x), y[1])], stroke);
        painter.line_segment([corner(x[0], at(y)), corner(x[1], at(y))], stroke);
    }
}

fn paint_lines(painter: &Painter, scene: &Scene, view: &View, distances: &Distances, color: Color32) {
    for (line, edge) in distances.lines.iter().zip([Edge::P, Edge::Q]) {
        let along = |point: &Vec3| line.direction.dot(&(point - line.point_mm));
        let on_edge = distances.points.iter().filter(|point| point.edge == edge);
        let (low, high) = on_edge
            .map(|point| along(&point.point_in_base_mm))
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
        let margin = 0.05 * scene.reach_mm;
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

/// The base's axes, in a corner.
fn paint_triad(painter: &Painter, scene: &Scene, view: &View, place: Rect, colors: [Color32; 3]) {
    let origin = place.left_bottom() + vec2(44.0, -40.0);
    for ((axis, name), color) in [(Vec3::x(), "x"), (Vec3::y(), "y"), (Vec3::z(), "z")].into_iter().zip(colors) {
        let tip = view.direction(scene.plate_from_base * axis * 26.0);
        arrow(painter, origin, origin + tip, Stroke::new(1.5, color));
        let beside = if tip.length() > 4.0 { tip + tip.normalized() * 8.0 } else { vec2(8.0, 8.0) };
        painter.text(origin + beside, Align2::CENTER_CENTER, name, FontId::proportional(theme::SMALL_SIZE), color);
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
