//! The view itself: the pointer and keys turn, move and zoom it; a click or a drawn rectangle chooses points.

use std::sync::Arc;

use egui::{
    Align2, Color32, ColorImage, CursorIcon, FontId, Key, PointerButton, Pos2, Rect, Response, Role, Sense, Stroke,
    StrokeKind, TextureHandle, TextureOptions, Ui, Vec2, WidgetInfo, pos2, vec2,
};
use nalgebra::Vector3;

use crate::geometry::Vec3;
use crate::scan::Cloud;
use crate::text::workpiece as words;
use crate::ui::{save_picture, theme, widgets};

use super::{AT_REST, Camera, Canvas, IN_MOTION, Thinned, draw, marks};

/// What the primary button does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tool {
    /// Turns the view.
    #[default]
    Turn,
    /// Chooses a point by a click; dragging turns the view.
    Point,
    /// Draws a rectangle around points.
    Rectangle,
}

/// What the colours stand for.
pub enum Legend {
    /// Values between two ends.
    Scale {
        /// What they are, with the unit.
        title: String,
        /// The values at the ends.
        ends: [f64; 2],
        /// The colour of a part from 0 to 1.
        color: fn(f32) -> Color32,
    },
    /// Names.
    Names(Vec<(String, Color32)>),
}

/// What is to be shown.
pub struct CloudScene<'a> {
    /// What a screen reader calls it.
    pub name: &'a str,
    /// Another number, another cloud.
    pub cloud_key: u64,
    /// Another number, other colours.
    pub color_key: u64,
    /// The points.
    pub cloud: &'a Cloud,
    /// The colour of a point, by its index.
    pub color_of: &'a dyn Fn(usize) -> Color32,
    /// What the colours stand for.
    pub legend: Option<Legend>,
    /// What the primary button does.
    pub tool: Tool,
}

/// What the user did.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CloudResponse {
    /// The point that was clicked, in the base, mm.
    pub picked_mm: Option<Vec3>,
    /// The rectangle that was drawn.
    pub rectangle: Option<CutOut>,
}

/// A rectangle of a picture: right and down in the base, and corners along them from the cloud's origin, mm.
pub type CutOut = (Vec3, Vec3, [[f64; 2]; 4]);

/// What the view remembers between frames.
#[derive(Default)]
pub struct CloudView {
    camera: Camera,
    /// The cloud that the camera was fitted to, and what is kept of it.
    seen: Option<Seen>,
    canvas: Canvas,
    picture: Option<(PictureKey, TextureHandle, Arc<ColorImage>)>,
    drag_from: Option<Pos2>,
}

impl std::fmt::Debug for CloudView {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_struct("CloudView").field("camera", &self.camera).finish_non_exhaustive()
    }
}

struct Seen {
    cloud_key: u64,
    color_key: u64,
    bounds: [Vector3<f32>; 2],
    in_motion: Thinned,
    /// Made when the view first stands still.
    at_rest: Option<Thinned>,
}

#[derive(Clone, Copy, PartialEq)]
struct PictureKey {
    camera: Camera,
    size: [usize; 2],
    keys: [u64; 2],
    is_fine: bool,
}

/// Turn and move a key press, points.
const KEY_STEP: f32 = 24.0;
/// Zoom a key press.
const KEY_ZOOM: f32 = 1.15;
/// Larger pictures are drawn coarser and stretched: no eye sees the points of a 4k screen.
const MOST_PIXELS: f32 = 1_500_000.0;

impl CloudView {
    /// Shows a cloud in the space available.
    pub fn show(&mut self, ui: &mut Ui, scene: &CloudScene<'_>) -> CloudResponse {
        let (rect, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
        response.widget_info(|| WidgetInfo::labeled(Role::Image, true, scene.name));
        self.look_at(scene, rect.size());
        let before = self.camera;
        let mut answer = CloudResponse::default();
        self.take_pointer(ui, &response, scene, rect, &mut answer);
        self.take_keys(ui, &response, scene, rect, &mut answer);
        let Some(seen) = &mut self.seen else { return answer };
        let is_moving = self.camera != before || response.dragged();
        let painter = ui.painter().with_clip_rect(rect.intersect(ui.clip_rect()));
        marks::box_around(ui, &painter, &self.camera, rect, seen.bounds);
        let key = PictureKey {
            camera: self.camera,
            size: pixels_of(rect.size(), ui.pixels_per_point()),
            keys: [scene.cloud_key, scene.color_key],
            is_fine: !is_moving,
        };
        let num_shown = if is_moving { seen.in_motion.points.len() } else { seen.fine(scene).points.len() };
        if self.picture.as_ref().is_none_or(|(known, ..)| *known != key) {
            let thinned = if is_moving { &seen.in_motion } else { seen.fine(scene) };
            #[expect(clippy::cast_precision_loss, reason = "the width of a picture")]
            let pixels_per_point = key.size[0] as f32 / rect.width().max(1.0);
            let image = Arc::new(draw(thinned, &self.camera, key.size, pixels_per_point, &mut self.canvas));
            let shown = Arc::clone(&image);
            let texture = match self.picture.take() {
                Some((_, mut texture, _)) => {
                    texture.set(shown, TextureOptions::LINEAR);
                    texture
                }
                None => ui.ctx().load_texture("cloud", shown, TextureOptions::LINEAR),
            };
            self.picture = Some((key, texture, image));
        }
        if is_moving {
            // Once more when it stands still, with all that the screen can show.
            ui.ctx().request_repaint();
        }
        if let Some((_, texture, image)) = &self.picture {
            save_picture::keep_image(ui.ctx(), texture.id(), || Arc::clone(image));
            let uv = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
            painter.image(texture.id(), rect, uv, Color32::WHITE);
        }
        marks::directions(ui, &painter, &self.camera, rect);
        marks::scale_bar(ui, &painter, &self.camera, rect);
        if let Some(legend) = &scene.legend {
            marks::legend(ui, &painter, rect, legend);
        }
        let font = FontId::proportional(theme::SMALL_SIZE);
        let dim = theme::palette(ui).text_dim;
        let shown = words::showing(num_shown, scene.cloud.len());
        painter.text(rect.left_top() + vec2(12.0, 10.0), Align2::LEFT_TOP, shown, font.clone(), dim);
        if let Some(pointer) = response.hover_pos().filter(|_| !response.dragged())
            && let Some(point) = self.nearest(pointer, rect, scene.cloud)
        {
            let [x, y, z] = [point.x, point.y, point.z].map(|value| widgets::fixed(value, 2));
            let text = words::point_readout(&x, &y, &z);
            painter.text(rect.right_bottom() - vec2(12.0, 10.0), Align2::RIGHT_BOTTOM, text, theme::number_font(), dim);
        }
        if let (Some(from), Some(to)) = (self.drag_from, response.interact_pointer_pos()) {
            let accent = theme::palette(ui).accent;
            let drawn = Rect::from_two_pos(from, to);
            painter.rect(drawn, 0.0, accent.gamma_multiply(0.12), Stroke::new(1.0, accent), StrokeKind::Middle);
        }
        if response.has_focus() {
            let focus = Stroke::new(1.0, theme::palette(ui).accent);
            painter.rect_stroke(rect.shrink(1.0), f32::from(theme::RADIUS), focus, StrokeKind::Inside);
            // What Enter would take.
            match scene.tool {
                Tool::Turn => {}
                Tool::Point => cross(&painter, rect.center(), focus),
                Tool::Rectangle => {
                    let faint = Stroke::new(1.0, focus.color.gamma_multiply(0.5));
                    painter.rect_stroke(middle_of(rect), 0.0, faint, StrokeKind::Middle);
                }
            }
        }
        answer
    }

    /// Looks along an axis of the base, everything in sight.
    pub fn look_along(&mut self, axis: usize, size: Vec2) {
        self.camera.look_along(axis);
        self.fit(size);
    }

    fn fit(&mut self, size: Vec2) {
        if let Some(seen) = &self.seen {
            self.camera.fit(seen.bounds, size);
        }
    }

    /// Keeps what is drawn of the cloud; a new one is looked at as a whole.
    fn look_at(&mut self, scene: &CloudScene<'_>, size: Vec2) {
        let is_new = self.seen.as_ref().is_none_or(|seen| seen.cloud_key != scene.cloud_key);
        if is_new || self.seen.as_ref().is_none_or(|seen| seen.color_key != scene.color_key) {
            let origin = scene.cloud.origin_mm();
            let corner = |end: Vec3| (end - origin).cast::<f32>();
            self.seen = scene.cloud.bounds_mm().map(|bounds| Seen {
                cloud_key: scene.cloud_key,
                color_key: scene.color_key,
                bounds: bounds.map(corner),
                in_motion: Thinned::new(scene.cloud, IN_MOTION, scene.color_of),
                at_rest: None,
            });
        }
        if is_new {
            self.fit(size);
        }
    }

    fn take_pointer(
        &mut self,
        ui: &Ui,
        response: &Response,
        scene: &CloudScene<'_>,
        rect: Rect,
        answer: &mut CloudResponse,
    ) {
        let (drag, is_shifted) = (response.drag_delta(), ui.input(|input| input.modifiers.shift));
        if response.clicked() || response.drag_started() {
            response.request_focus();
        }
        if response.double_clicked() {
            self.fit(rect.size());
        } else if response.clicked()
            && scene.tool == Tool::Point
            && let Some(pointer) = response.interact_pointer_pos()
        {
            answer.picked_mm = self.nearest(pointer, rect, scene.cloud);
        }
        let draws = scene.tool == Tool::Rectangle && !is_shifted;
        if draws && response.drag_started_by(PointerButton::Primary) {
            self.drag_from = ui.input(|input| input.pointer.press_origin());
        }
        if response.dragged_by(PointerButton::Primary) && self.drag_from.is_none() {
            if is_shifted { self.camera.pan(drag) } else { self.camera.turn(drag) }
        } else if response.dragged_by(PointerButton::Secondary) || response.dragged_by(PointerButton::Middle) {
            self.camera.pan(drag);
        }
        if response.drag_stopped()
            && let (Some(from), Some(to)) = (self.drag_from.take(), response.interact_pointer_pos())
            && (to - from).abs().min_elem() > 3.0
        {
            answer.rectangle = Some(self.cut_out(Rect::from_two_pos(from, to), rect));
        }
        if let Some(pointer) = response.hover_pos() {
            let (scrolled, pinched) = ui.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()));
            let factor = pinched * (scrolled / 240.0).exp();
            if (factor - 1.0).abs() > 1e-4 {
                self.camera.zoom(factor, pointer, rect);
                // The page around does not scroll along.
                ui.input_mut(|input| input.smooth_scroll_delta = Vec2::ZERO);
            }
            ui.ctx().set_cursor_icon(match scene.tool {
                Tool::Turn => CursorIcon::Grab,
                Tool::Point | Tool::Rectangle => CursorIcon::Crosshair,
            });
        }
    }

    fn take_keys(
        &mut self,
        ui: &Ui,
        response: &Response,
        scene: &CloudScene<'_>,
        rect: Rect,
        answer: &mut CloudResponse,
    ) {
        if !response.has_focus() {
            return;
        }
        // Arrows turn the view while it has the focus; they do not go to the next control.
        let filter =
            egui::EventFilter { horizontal_arrows: true, vertical_arrows: true, ..egui::EventFilter::default() };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, filter));
        let pressed = |key: Key| ui.input(|input| input.key_pressed(key));
        let is_shifted = ui.input(|input| input.modifiers.shift);
        let arrows = [
            (Key::ArrowLeft, vec2(-KEY_STEP, 0.0)),
            (Key::ArrowRight, vec2(KEY_STEP, 0.0)),
            (Key::ArrowUp, vec2(0.0, -KEY_STEP)),
            (Key::ArrowDown, vec2(0.0, KEY_STEP)),
        ];
        for (key, step) in arrows {
            if pressed(key) {
                if is_shifted { self.camera.pan(step) } else { self.camera.turn(step) }
            }
        }
        if pressed(Key::Plus) || pressed(Key::Equals) {
            self.camera.zoom(KEY_ZOOM, rect.center(), rect);
        }
        if pressed(Key::Minus) {
            self.camera.zoom(1.0 / KEY_ZOOM, rect.center(), rect);
        }
        if pressed(Key::Home) || pressed(Key::F) {
            self.fit(rect.size());
        }
        if pressed(Key::Enter) {
            match scene.tool {
                Tool::Turn => {}
                Tool::Point => answer.picked_mm = self.nearest(rect.center(), rect, scene.cloud),
                Tool::Rectangle => answer.rectangle = Some(self.cut_out(middle_of(rect), rect)),
            }
        }
    }

    /// What a rectangle of the picture cuts out of the cloud.
    fn cut_out(&self, drawn: Rect, rect: Rect) -> CutOut {
        let [right, down, _] = self.camera.axes().map(Vector3::cast::<f64>);
        let corners = [drawn.left_top(), drawn.right_top(), drawn.right_bottom(), drawn.left_bottom()];
        (right, down, corners.map(|corner| self.camera.unproject(corner, rect).map(f64::from)))
    }

    /// The point that is seen nearest to the pointer; of several there, the one in front.
    fn nearest(&self, pointer: Pos2, rect: Rect, cloud: &Cloud) -> Option<Vec3> {
        const REACH: f32 = 7.0;
        let seen = self.seen.as_ref()?;
        let into = self.camera.axes()[2];
        let near = seen.in_motion.points.iter().zip(&seen.in_motion.idx).filter_map(|(point, idx)| {
            let point = Vector3::from(*point);
            let distance = self.camera.project(point, rect).distance(pointer);
            // A point's distance on the screen counts as if it were depth, so that what is in front wins.
            (distance <= REACH).then(|| (into.dot(&point) + distance / self.camera.scale(), *idx))
        });
        near.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, idx)| cloud.point_mm(idx as usize))
    }
}

/// The rectangle that Enter takes.
fn middle_of(rect: Rect) -> Rect {
    Rect::from_center_size(rect.center(), rect.size() / 3.0)
}

fn cross(painter: &egui::Painter, at: Pos2, stroke: Stroke) {
    const ARM: f32 = 7.0;
    painter.hline(at.x - ARM..=at.x + ARM, at.y, stroke);
    painter.vline(at.x, at.y - ARM..=at.y + ARM, stroke);
}

impl Seen {
    fn fine(&mut self, scene: &CloudScene<'_>) -> &Thinned {
        self.at_rest.get_or_insert_with(|| Thinned::new(scene.cloud, AT_REST, scene.color_of))
    }
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "sides of a picture")]
fn pixels_of(size: Vec2, pixels_per_point: f32) -> [usize; 2] {
    let pixels = size * pixels_per_point;
    let shrink = (MOST_PIXELS / (pixels.x * pixels.y).max(1.0)).sqrt().min(1.0);
    [(pixels.x * shrink).max(1.0) as usize, (pixels.y * shrink).max(1.0) as usize]
}
