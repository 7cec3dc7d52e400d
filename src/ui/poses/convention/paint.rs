//! Frames as three arrows each, seen from where the camera is.

use egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Role, Sense, Stroke, Ui, WidgetInfo, vec2};

use crate::geometry::Vec3;
use crate::report::figure::Orbit;
use crate::text::conventions as words;
use crate::ui::charts::arrow;
use crate::ui::theme;

use super::model::{Extent, NamedFrame};

/// Length of a frame's arrows as a part of the picture's smaller side.
const ARROW_PART: f32 = 0.12;
/// The arrows of the base are longer by this.
const BASE_FACTOR: f32 = 1.3;
/// Wider than high by this, a picture has its spare room at the side.
const WIDE: f32 = 1.4;
/// Letters of an arrow that comes towards the eye would stand on each other.
const LEAST_SEEN: f32 = 8.0;

/// Draws the frames into a rectangle; a drag goes round them.
pub fn show(ui: &mut Ui, rect: Rect, title: &str, frames: &[NamedFrame], camera: &mut Orbit) {
    let response = ui.allocate_rect(rect, Sense::click_and_drag());
    let name = words::picture_name(title, frames.len());
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, &name));
    if response.dragged() {
        camera.turn(response.drag_delta().into());
    }
    if response.double_clicked() {
        *camera = Orbit::default();
    }
    response.on_hover_cursor(egui::CursorIcon::Grab).on_hover_text(words::ORBIT_HINT);
    let picture = Picture::new(ui, rect, frames, camera);
    picture.base();
    let mut by_depth: Vec<&NamedFrame> = frames.iter().collect();
    let depth = |frame: &NamedFrame| camera.seen(frame.base_from_flange.translation_mm()).z;
    by_depth.sort_by(|first, second| depth(first).total_cmp(&depth(second)));
    for frame in by_depth {
        picture.frame(frame);
    }
}

struct Picture<'a> {
    painter: Painter,
    camera: &'a Orbit,
    extent: Extent,
    rect: Rect,
    /// Where the base's directions do not stand.
    free: Rect,
    points_per_mm: f32,
    arrow: f32,
    colors: [Color32; 3],
    text: Color32,
}

impl<'a> Picture<'a> {
    fn new(ui: &Ui, rect: Rect, frames: &[NamedFrame], camera: &'a Orbit) -> Self {
        let size = rect.width().min(rect.height());
        let arrow = (size * ARROW_PART).clamp(18.0, 44.0);
        let extent = Extent::of(frames, camera);
        let corner = if extent.has_base { 0.0 } else { arrow * 2.0 * BASE_FACTOR };
        let is_wide = rect.width() > rect.height() * WIDE;
        let free =
            if is_wide { rect.with_min_x(rect.left() + corner) } else { rect.with_max_y(rect.bottom() - corner) };
        // Room for the arrows at the border, and for their letters.
        let room = (free.size() - egui::Vec2::splat(2.0 * (arrow + 14.0))).max(vec2(16.0, 16.0));
        let [width_mm, height_mm] = extent.size_mm.map(to_screen);
        Self {
            painter: ui.painter().with_clip_rect(rect.intersect(ui.clip_rect())),
            camera,
            extent,
            rect,
            free,
            points_per_mm: (room.x / width_mm).min(room.y / height_mm),
            arrow,
            colors: theme::axis_colors(ui),
            text: theme::palette(ui).text_dim,
        }
    }

    fn place(&self, in_base_mm: Vec3) -> Pos2 {
        let seen = self.camera.seen(in_base_mm);
        let [right, up] = self.extent.middle;
        self.free.center() + vec2(to_screen(seen.x - right), -to_screen(seen.y - up)) * self.points_per_mm
    }

    fn base(&self) {
        let length = self.arrow * BASE_FACTOR;
        let corner = self.rect.left_bottom();
        let (origin, name, below) = if self.extent.has_base {
            let origin = self.place(Vec3::zeros());
            (origin, words::BASE, origin + vec2(0.0, length + 4.0))
        } else {
            (corner + vec2(length + 12.0, -length - 22.0), words::BASE_DIRECTIONS, corner + vec2(10.0, -12.0))
        };
        self.triad(origin, [Vec3::x(), Vec3::y(), Vec3::z()], length, 1.0);
        let font = FontId::proportional(theme::SMALL_SIZE);
        self.painter.text(below, Align2::LEFT_CENTER, name, font, self.text);
    }

    fn frame(&self, frame: &NamedFrame) {
        let rotation = frame.base_from_flange.rotation();
        let axes = [Vec3::x(), Vec3::y(), Vec3::z()].map(|axis| rotation * axis);
        let origin = self.place(frame.base_from_flange.translation_mm());
        self.triad(origin, axes, self.arrow, 2.0);
        self.painter.circle_filled(origin, 2.5, self.text);
        // Where the arrows do not run.
        let seen = self.camera.seen(axes[0] + axes[1] + axes[2]);
        let away = vec2(-to_screen(seen.x), to_screen(seen.y)).normalized() * 11.0;
        let font = FontId::proportional(theme::SMALL_SIZE);
        self.painter.text(origin + away, Align2::CENTER_CENTER, &frame.label, font, self.text);
    }

    fn triad(&self, origin: Pos2, axes: [Vec3; 3], length: f32, width: f32) {
        let mut seen: Vec<(Vec3, usize)> = axes.iter().map(|axis| self.camera.seen(*axis)).zip(0..).collect();
        seen.sort_by(|first, second| first.0.z.total_cmp(&second.0.z));
        for (axis, idx) in seen {
            let along = vec2(to_screen(axis.x), -to_screen(axis.y)) * length;
            let color = self.colors[idx];
            arrow(&self.painter, origin, origin + along, Stroke::new(width, color));
            if along.length() >= LEAST_SEEN {
                let tip = origin + along + along.normalized() * 7.0;
                let font = FontId::proportional(theme::SMALL_SIZE);
                self.painter.text(tip, Align2::CENTER_CENTER, ["x", "y", "z"][idx], font, color);
            }
        }
    }
}

#[expect(clippy::cast_possible_truncation, reason = "a picture needs no more than single precision")]
const fn to_screen(value: f64) -> f32 {
    value as f32
}
