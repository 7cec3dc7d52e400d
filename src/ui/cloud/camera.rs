//! How a cloud is seen: from where, what is in the middle, and how large.

use egui::{Pos2, Rect, Vec2, pos2};
use nalgebra::Vector3;

use crate::report::figure::Orbit;

/// The view of a cloud. Points are offsets from the cloud's origin, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// The direction of view.
    orbit: Orbit,
    /// What is in the middle of the picture.
    centre: Vector3<f32>,
    /// Length of a millimetre on the screen, points.
    scale: f32,
}

impl Default for Camera {
    fn default() -> Self {
        Self { orbit: Orbit::new(-0.9, 0.55), centre: Vector3::zeros(), scale: 1.0 }
    }
}

/// Part of the picture that a fitted cloud takes.
const FILL: f32 = 0.82;
/// Nobody needs to see closer or more, points a mm.
const SCALES: [f32; 2] = [1e-3, 1e4];

impl Camera {
    /// Right, down and into the picture.
    #[must_use]
    pub fn axes(&self) -> [Vector3<f32>; 3] {
        let [right, up, towards] = self.orbit.axes().map(Vector3::cast::<f32>);
        [right, -up, -towards]
    }

    /// Length of a millimetre on the screen, points.
    #[must_use]
    pub const fn scale(&self) -> f32 {
        self.scale
    }

    /// What is in the middle of the picture, mm.
    #[must_use]
    pub const fn centre(&self) -> Vector3<f32> {
        self.centre
    }

    /// Where a point is on the screen.
    #[must_use]
    pub fn project(&self, point: Vector3<f32>, rect: Rect) -> Pos2 {
        let [right, down, _] = self.axes();
        let from_centre = (point - self.centre) * self.scale;
        rect.center() + egui::vec2(right.dot(&from_centre), down.dot(&from_centre))
    }

    /// The place of the screen along right and down, mm from the cloud's origin.
    #[must_use]
    pub fn unproject(&self, at: Pos2, rect: Rect) -> [f32; 2] {
        let [right, down, _] = self.axes();
        let from_centre = (at - rect.center()) / self.scale;
        [right.dot(&self.centre) + from_centre.x, down.dot(&self.centre) + from_centre.y]
    }

    /// Turns as if the cloud were dragged.
    pub fn turn(&mut self, drag: Vec2) {
        self.orbit.turn(drag.into());
    }

    /// Moves the cloud along with the pointer.
    pub fn pan(&mut self, drag: Vec2) {
        let [right, down, _] = self.axes();
        self.centre -= (right * drag.x + down * drag.y) / self.scale;
    }

    /// Zooms about a place of the screen, which stays where it is.
    pub fn zoom(&mut self, factor: f32, about: Pos2, rect: Rect) {
        let from_centre = about - rect.center();
        self.pan(-from_centre);
        self.scale = (self.scale * factor).clamp(SCALES[0], SCALES[1]);
        self.pan(from_centre);
    }

    /// Looks along an axis: from above, from the front (along y), or from the right (along −x).
    pub const fn look_along(&mut self, axis: usize) {
        self.orbit = match axis {
            2 => Orbit::ABOVE,
            1 => Orbit::FRONT,
            _ => Orbit::RIGHT,
        };
    }

    /// Shows all between two corners in a picture of this size.
    pub fn fit(&mut self, bounds: [Vector3<f32>; 2], size: Vec2) {
        self.centre = (bounds[0] + bounds[1]) / 2.0;
        let [right, down, _] = self.axes();
        let half = (bounds[1] - bounds[0]) / 2.0;
        // The outline of a box is as wide as its half diagonals laid one after the other.
        let reach = |axis: Vector3<f32>| axis.abs().dot(&half).max(1e-3);
        let scale = (size.x / reach(right)).min(size.y / reach(down)) * FILL / 2.0;
        self.scale = scale.clamp(SCALES[0], SCALES[1]);
    }
}

/// The corners of a box, and which of them are joined by edges.
pub(super) fn box_edges(bounds: [Vector3<f32>; 2]) -> [[Vector3<f32>; 2]; 12] {
    let corner = |number: usize| Vector3::from_fn(|axis, _| bounds[(number >> axis) & 1][axis]);
    let mut edges = [[Vector3::zeros(); 2]; 12];
    let mut count = 0;
    for number in 0..8 {
        for axis in (0..3).filter(|axis| number & (1 << axis) == 0) {
            edges[count] = [corner(number), corner(number | (1 << axis))];
            count += 1;
        }
    }
    edges
}

/// The middle of a rectangle that nothing may be drawn outside of.
#[must_use]
pub(super) const fn corner_of(rect: Rect, right: f32, up: f32) -> Pos2 {
    pos2(rect.min.x + right, rect.max.y - up)
}

#[cfg(test)]
mod tests {
    use egui::Rect;

    use super::*;

    const RECT: Rect = Rect { min: pos2(10.0, 20.0), max: pos2(810.0, 620.0) };

    #[test]
    fn a_zoom_keeps_the_place_under_the_pointer() {
        let mut camera = Camera::default();
        let pointer = pos2(300.0, 500.0);
        let before = camera.unproject(pointer, RECT);
        camera.zoom(3.0, pointer, RECT);
        let after = camera.unproject(pointer, RECT);
        assert!((0..2).all(|axis| (before[axis] - after[axis]).abs() < 1e-3), "{before:?} {after:?}");
    }

    #[test]
    fn a_fitted_box_fills_the_picture_and_stays_inside() {
        let bounds = [Vector3::new(-30.0, -10.0, 2.0), Vector3::new(70.0, 15.0, 40.0)];
        let mut camera = Camera::default();
        camera.fit(bounds, RECT.size());
        let places = box_edges(bounds).map(|[from, _]| camera.project(from, RECT));
        assert!(places.iter().all(|place| RECT.contains(*place)), "{places:?}");
        let width = places.iter().map(|place| place.x).fold(0.0, f32::max)
            - places.iter().map(|place| place.x).fold(1e9, f32::min);
        let height = places.iter().map(|place| place.y).fold(0.0, f32::max)
            - places.iter().map(|place| place.y).fold(1e9, f32::min);
        assert!(width > 0.6 * RECT.width() || height > 0.6 * RECT.height(), "{width} {height}");
    }
}
