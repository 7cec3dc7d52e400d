//! The way of the camera against the truth: in plan with axes, and in space.

use egui::{Align2, Color32, Id, Painter, Pos2, Rect, Role, Sense, Shape, Stroke, Ui, Vec2, WidgetInfo, vec2};
use egui_plot::MarkerShape;

use crate::geometry::Vec3;
use crate::report::figure::model::Ways;
use crate::report::figure::{Orbit, round_step};
use crate::text::sequence as words;
use crate::ui::charts::{self, Chart, Extent, LegendEntry, LegendGlyph, marker};
use crate::ui::eye::{self, Eye};
use crate::ui::{theme, widgets};

/// The camera at one frame: where, and how its axes lie; in the first camera's frame, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct CameraPose {
    /// Its place.
    pub at_m: Vec3,
    /// Right, down and forward.
    pub axes: [Vec3; 3],
}

/// From where the way is seen at first.
pub(super) const AT_FIRST: Orbit = Orbit::new(-2.2, 0.6);
/// Room around the way, points.
const ROOM_AROUND: Vec2 = vec2(36.0, 40.0);
/// The part of a plan's extent that is left free around the way.
const ROOM_FOR_CAMERA: f64 = 0.06;
/// Shorter ways are not enlarged beyond this, m.
const LEAST_REACH_M: f64 = 1e-3;

/// Right and forward: what a plan shows of a point of the first camera's frame.
fn in_plan(point_m: Vec3) -> [f64; 2] {
    [point_m.x, point_m.z]
}

/// The first camera's frame turned so that up is z, as pictures in space have it.
fn upright(point: Vec3) -> Vec3 {
    Vec3::new(point.x, point.z, -point.y)
}

fn legend(ui: &mut Ui, ways: &Ways) {
    let mut entries =
        vec![LegendEntry { glyph: LegendGlyph::Line, color: theme::INLIER, text: words::TRACKED_WAY.to_owned() }];
    if !ways.truth.is_empty() {
        let color = theme::palette(ui).text;
        entries.push(LegendEntry { glyph: LegendGlyph::Dashed, color, text: words::TRUE_WAY.to_owned() });
    }
    charts::legend(ui, &entries);
}

/// Shows the plan in the space available; answers the frame that was clicked.
pub(super) fn plan(ui: &mut Ui, ways: &Ways, camera: Option<&CameraPose>, is_fitted: &mut bool) -> Option<usize> {
    legend(ui, ways);
    let mut extent = Extent::NOTHING;
    for [x, y] in ways.tracked.iter().flatten().chain(&ways.truth).map(|point| in_plan(*point)) {
        extent.include(x, y);
    }
    // Room for the camera beyond the ends of the way.
    let margin = ROOM_FOR_CAMERA * (extent.x[1] - extent.x[0]).max(extent.y[1] - extent.y[0]).max(LEAST_REACH_M);
    for (x, y) in [(extent.x[0] - margin, extent.y[0] - margin), (extent.x[1] + margin, extent.y[1] + margin)] {
        extent.include(x, y);
    }
    let height = ui.available_height();
    let mut chart = Chart::new(Id::unique("sequence plan"), words::RIGHT_AXIS, words::FORWARD_AXIS, height, extent);
    chart.has_equal_scales = true;
    let canvas = chart.show(ui, is_fitted);
    let at = |point: Vec3| {
        let [x, y] = in_plan(point);
        canvas.at(x, y)
    };
    paint_ways(ui, &canvas.painter, ways, &at);
    if let Some(camera) = camera {
        paint_camera(ui, &canvas.painter, camera, &at, f64::from(CAMERA_SIZE / canvas.scale().max(1e-6)));
    }
    let hovered = canvas.hovered(ways.frames.iter().map(|(number, point)| ((*number, *point), in_plan(*point))));
    if let Some((number, point)) = hovered {
        let [x, y] = in_plan(point).map(|value| widgets::fixed(value, 3));
        let note = words::place_readout(number + 1, &x, &y);
        canvas.note(ui, at(point) + vec2(10.0, -6.0), Align2::LEFT_BOTTOM, &note, theme::palette(ui).text);
    }
    hovered.map(|(number, _)| number).filter(|_| canvas.response.clicked())
}

/// Size of the camera's sign, points.
const CAMERA_SIZE: f32 = 22.0;

/// Shows the way in space; answers the frame that was clicked.
pub(super) fn space(ui: &mut Ui, ways: &Ways, camera: Option<&CameraPose>, eye: &mut Eye) -> Option<usize> {
    legend(ui, ways);
    let place = ui.available_rect_before_wrap();
    let response = ui.interact(place, ui.scope_id().with("way in space"), Sense::click_and_drag());
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, words::SPACE_NAME));
    eye.steer(ui, &response);
    let view = View::new(place, ways, *eye);
    let painter = ui.painter().with_clip_rect(place.intersect(ui.clip_rect()));
    let palette = theme::palette(ui);
    paint_floor(&painter, &view, palette.text_dim);
    let at = |point: Vec3| view.at(upright(point));
    paint_ways(ui, &painter, ways, &at);
    if let Some(camera) = camera {
        paint_camera(ui, &painter, camera, &at, f64::from(CAMERA_SIZE) / view.points_a_m);
    }
    // The first camera's axes.
    eye.triad(&painter, place, [Vec3::x(), Vec3::y(), Vec3::z()].map(upright), theme::axis_colors(ui));
    let caption = words::mesh_of(&widgets::fixed(view.mesh_m, decimals_of(view.mesh_m)));
    eye::captions(&painter, place, caption, words::SPACE_HINT, palette.text_dim);
    ui.advance_cursor_after_rect(place);
    let pointer = response.hover_pos().filter(|_| response.clicked())?;
    let near = ways.frames.iter().map(|(number, point)| (at(*point).distance(pointer), *number));
    near.filter(|(distance, _)| *distance < 10.0).min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, number)| number)
}

/// From the upright frame to the screen, without perspective.
struct View {
    eye: Eye,
    middle: Vec3,
    half: Vec3,
    centre: Pos2,
    points_a_m: f64,
    /// Width of a mesh of the floor, m.
    mesh_m: f64,
}

impl View {
    fn new(place: Rect, ways: &Ways, eye: Eye) -> Self {
        let mut low = Vec3::repeat(f64::INFINITY);
        let mut high = Vec3::repeat(f64::NEG_INFINITY);
        for point in ways.tracked.iter().flatten().chain(&ways.truth) {
            low = low.inf(&upright(*point));
            high = high.sup(&upright(*point));
        }
        if low.x > high.x {
            [low, high] = [Vec3::repeat(-1.0), Vec3::repeat(1.0)];
        }
        let half = (high - low) / 2.0;
        // As the ball around it fits, so that turning does not make it grow or shrink.
        let reach = half.norm().max(LEAST_REACH_M);
        let room = place.shrink2(ROOM_AROUND).size() / 2.0;
        let points_a_m = f64::from(room.min_elem().max(1.0)) / reach * eye.zoom();
        let mesh_m = round_step(reach / 2.5).unwrap_or(1.0);
        Self { eye, middle: (low + high) / 2.0, half, centre: place.center(), points_a_m, mesh_m }
    }

    fn at(&self, upright_m: Vec3) -> Pos2 {
        self.centre + self.eye.on_screen((upright_m - self.middle) * self.points_a_m)
    }
}

/// Digits behind the point of a round length.
fn decimals_of(length: f64) -> usize {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few digits")]
    let decimals = (-length.log10().floor()).clamp(0.0, 6.0) as usize;
    decimals
}

/// A mesh below the way, at the height of its lowest point.
fn paint_floor(painter: &Painter, view: &View, color: Color32) {
    let stroke = Stroke::new(1.0, color.gamma_multiply(0.18));
    let height = view.middle.z - view.half.z;
    let ends = [0, 1].map(|axis| {
        let reach = view.half[axis] + 0.5 * view.mesh_m;
        [view.middle[axis] - reach, view.middle[axis] + reach].map(|end| (end / view.mesh_m).round() * view.mesh_m)
    });
    let lines = |[low, high]: [f64; 2]| {
        /// A floor has few meshes; more would come of rounding only.
        const MOST: u32 = 60;
        (0..=MOST).map(move |number| low + f64::from(number) * view.mesh_m).take_while(move |at| *at <= high + 1e-9)
    };
    for x in lines(ends[0]) {
        painter.line_segment(ends[1].map(|y| view.at(Vec3::new(x, y, height))), stroke);
    }
    for y in lines(ends[1]) {
        painter.line_segment(ends[0].map(|x| view.at(Vec3::new(x, y, height))), stroke);
    }
}

fn paint_ways(ui: &Ui, painter: &Painter, ways: &Ways, at: &impl Fn(Vec3) -> Pos2) {
    let palette = theme::palette(ui);
    for stretch in &ways.tracked {
        let points: Vec<Pos2> = stretch.iter().map(|point| at(*point)).collect();
        painter.add(Shape::line(points, Stroke::new(3.0, theme::INLIER)));
    }
    // On top, so that it is seen where both agree.
    let truth: Vec<Pos2> = ways.truth.iter().map(|point| at(*point)).collect();
    charts::dashed_line(painter, &truth, Stroke::new(1.2, palette.text));
    if let Some(start) = ways.tracked.first().and_then(|stretch| stretch.first()) {
        let ring = Stroke::new(1.5, theme::INLIER);
        marker(painter, MarkerShape::Circle, at(*start), 4.0, palette.surface, ring);
    }
}

/// A pyramid that opens to where the camera looks.
fn paint_camera(ui: &Ui, painter: &Painter, camera: &CameraPose, at: &impl Fn(Vec3) -> Pos2, size_m: f64) {
    let color = theme::palette(ui).accent;
    let [right, down, forward] = camera.axes;
    let corner = |x: f64, y: f64| at(camera.at_m + (forward + right * (0.6 * x) + down * (0.45 * y)) * size_m);
    let corners = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    let eye = at(camera.at_m);
    let stroke = Stroke::new(1.3, color);
    painter.add(Shape::closed_line(corners.to_vec(), stroke));
    for far in corners {
        painter.line_segment([eye, far], stroke);
    }
    painter.circle_filled(eye, 3.0, color);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn up_in_the_picture_is_up_for_the_camera() {
        // The camera's y points down.
        assert_eq!(upright(Vec3::new(0.0, -1.0, 0.0)), Vec3::z());
        assert_eq!(upright(Vec3::z()), Vec3::y());
    }

    #[test]
    fn a_way_of_any_length_stays_in_its_place() {
        let place = Rect::from_min_size(Pos2::ZERO, vec2(400.0, 300.0));
        for length in [1e-6, 0.3, 250.0] {
            let way = vec![Vec3::zeros(), Vec3::new(length, 0.2 * length, -length)];
            let ways = Ways { tracked: vec![way.clone()], ..Ways::default() };
            for turn in 0..20_u8 {
                let mut eye = Eye::new(AT_FIRST);
                eye.turn(vec2(f32::from(turn) * 31.0, f32::from(turn) * 7.0));
                let view = View::new(place, &ways, eye);
                assert!(way.iter().all(|point| place.contains(view.at(upright(*point)))), "{length} {turn}");
            }
        }
    }
}
