//! The eye of pictures in space: dragged, scrolled, and steered with the arrow keys.

use egui::{Align2, Color32, FontId, Key, Modifiers, Painter, Rect, Response, Stroke, Ui, Vec2, vec2};

use crate::geometry::Vec3;
use crate::report::figure::Orbit;

use super::charts::arrow;
use super::theme;

/// A press of an arrow key turns like a drag by so many points.
const KEY_STEP: f32 = 12.0;
/// Nobody needs to see closer or more than this many times the whole.
const ZOOMS: [f64; 2] = [0.3, 30.0];
/// From the lower left corner of a picture to the axes drawn there, points.
const TRIAD_AT: Vec2 = vec2(44.0, -40.0);
/// Length of those axes, points.
const TRIAD_LENGTH: f64 = 26.0;
/// From the corners of a picture to what is written there, points.
const CORNER_ROOM: Vec2 = vec2(12.0, 8.0);

/// From where something is seen, without perspective, and how large.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eye {
    orbit: Orbit,
    at_first: Orbit,
    zoom: f64,
}

impl Eye {
    /// An eye that begins with a direction, and comes back to it with a double click.
    #[must_use]
    pub const fn new(at_first: Orbit) -> Self {
        Self { orbit: at_first, at_first, zoom: 1.0 }
    }

    /// How much larger than the whole.
    #[must_use]
    pub const fn zoom(&self) -> f64 {
        self.zoom
    }

    /// Goes round as if what is seen were dragged by so many points.
    pub fn turn(&mut self, drag: Vec2) {
        self.orbit.turn(drag.into());
    }

    /// A vector as seen, to the right and down; as long as it is, without the zoom.
    #[must_use]
    #[expect(clippy::cast_possible_truncation, reason = "screen coordinates")]
    pub fn on_screen(&self, vector: Vec3) -> Vec2 {
        let seen = self.orbit.seen(vector);
        vec2(seen.x as f32, -seen.y as f32)
    }

    /// Goes where a picture is dragged, scrolled or clicked twice; with the arrow keys while it has the focus.
    pub fn steer(&mut self, ui: &Ui, response: &Response) {
        if response.dragged() {
            self.turn(response.drag_delta());
        }
        if response.clicked() {
            response.request_focus();
        }
        if response.has_focus() {
            for (key, step) in [
                (Key::ArrowLeft, vec2(-KEY_STEP, 0.0)),
                (Key::ArrowRight, vec2(KEY_STEP, 0.0)),
                (Key::ArrowUp, vec2(0.0, KEY_STEP)),
                (Key::ArrowDown, vec2(0.0, -KEY_STEP)),
            ] {
                // Taken: what else listens to arrows must not follow.
                if ui.input_mut(|input| input.consume_key(Modifiers::NONE, key)) {
                    self.turn(step);
                }
            }
        }
        if response.hovered() {
            // What is scrolled over the picture is not for the page below it.
            let scrolled = ui.ctx().input_mut(|input| std::mem::take(&mut input.smooth_scroll_delta).y);
            let zoom = ui.input(egui::InputState::zoom_delta);
            self.zoom *= f64::from(zoom) * (f64::from(scrolled) * 0.004).exp();
        }
        self.zoom = self.zoom.clamp(ZOOMS[0], ZOOMS[1]);
        if response.double_clicked() {
            *self = Self::new(self.at_first);
        }
    }

    /// Draws three directions, named x, y and z, in the lower left corner of a picture.
    pub fn triad(&self, painter: &Painter, place: Rect, axes: [Vec3; 3], colors: [Color32; 3]) {
        let origin = place.left_bottom() + TRIAD_AT;
        for ((axis, name), color) in axes.into_iter().zip(["x", "y", "z"]).zip(colors) {
            let tip = self.on_screen(axis * TRIAD_LENGTH);
            arrow(painter, origin, origin + tip, Stroke::new(1.5, color));
            let beside = if tip.length() > 4.0 { tip + tip.normalized() * 8.0 } else { vec2(8.0, 8.0) };
            painter.text(origin + beside, Align2::CENTER_CENTER, name, FontId::proportional(theme::SMALL_SIZE), color);
        }
    }
}

/// Writes what is seen into the upper left corner of a picture, and how to steer it into the lower right one.
pub fn captions(painter: &Painter, place: Rect, caption: String, hint: &str, color: Color32) {
    let font = FontId::proportional(theme::SMALL_SIZE);
    painter.text(place.left_top() + CORNER_ROOM, Align2::LEFT_TOP, caption, font.clone(), color);
    painter.text(place.right_bottom() - CORNER_ROOM, Align2::RIGHT_BOTTOM, hint, font, color);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn up_in_space_is_up_on_the_screen_from_wherever_it_is_seen() {
        let mut eye = Eye::new(Orbit::FRONT);
        for drag in [[0.0, 0.0], [130.0, 20.0], [-700.0, 90.0]] {
            eye.turn(drag.into());
            let up = eye.on_screen(Vec3::z());
            assert!(up.y <= 0.0 && up.x.abs() < 1e-6, "{up}");
        }
    }
}
