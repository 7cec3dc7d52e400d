//! What is drawn around the points: the box with its sizes, the directions, the scale and the colours.

use egui::{Align2, Color32, FontId, Painter, Rect, Stroke, Ui, pos2, vec2};
use nalgebra::Vector3;

use crate::ui::charts::arrow;
use crate::ui::{theme, widgets};

use super::camera::{box_edges, corner_of};
use super::{Camera, Legend};

fn small() -> FontId {
    FontId::proportional(theme::SMALL_SIZE)
}

/// The box around all points.
pub(super) fn box_around(ui: &Ui, painter: &Painter, camera: &Camera, rect: Rect, bounds: [Vector3<f32>; 2]) {
    let stroke = Stroke::new(1.0, theme::palette(ui).hairline);
    for edge in box_edges(bounds) {
        painter.line_segment(edge.map(|end| camera.project(end, rect)), stroke);
    }
}

/// The directions of the base, in the lower left corner.
pub(super) fn directions(ui: &Ui, painter: &Painter, camera: &Camera, rect: Rect) {
    const LENGTH: f32 = 26.0;
    let [right, down, into] = camera.axes();
    let origin = corner_of(rect, 44.0, 52.0);
    let mut axes: Vec<(usize, Color32)> = theme::axis_colors(ui).into_iter().enumerate().collect();
    // Those that point at the viewer last, so that they are in front.
    axes.sort_by(|a, b| into[b.0].total_cmp(&into[a.0]));
    for (axis, color) in axes {
        let along = vec2(right[axis], down[axis]);
        arrow(painter, origin, origin + along * LENGTH, Stroke::new(1.6, color));
        // An axis that points at the viewer has its letter in the middle.
        let name = ["x", "y", "z"][axis];
        painter.text(origin + along * (LENGTH + 9.0), Align2::CENTER_CENTER, name, small(), color);
    }
}

/// A bar of a round length beside the directions.
pub(super) fn scale_bar(ui: &Ui, painter: &Painter, camera: &Camera, rect: Rect) {
    const LONGEST: f32 = 120.0;
    let color = theme::palette(ui).text_dim;
    let most_mm = LONGEST / camera.scale();
    let decade = 10.0_f32.powf(most_mm.log10().floor());
    let length_mm = [5.0, 2.0, 1.0].map(|step| step * decade).into_iter().find(|length| *length <= most_mm);
    let length_mm = length_mm.unwrap_or(decade);
    let width = length_mm * camera.scale();
    let left = corner_of(rect, 100.0, 22.0);
    let stroke = Stroke::new(1.0, color);
    painter.hline(left.x..=left.x + width, left.y, stroke);
    for x in [left.x, left.x + width] {
        painter.vline(x, left.y - 4.0..=left.y + 4.0, stroke);
    }
    let decimals = if length_mm >= 1.0 { 0 } else { 3 };
    let text = format!("{} mm", widgets::fixed(f64::from(length_mm), decimals));
    painter.text(pos2(left.x + width / 2.0, left.y - 6.0), Align2::CENTER_BOTTOM, text, small(), color);
}

/// What the colours stand for, at the right.
pub(super) fn legend(ui: &Ui, painter: &Painter, rect: Rect, legend: &Legend) {
    const WIDTH: f32 = 10.0;
    const HEIGHT: f32 = 132.0;
    const NUM_STRIPES: u8 = 44;
    let dim = theme::palette(ui).text_dim;
    match legend {
        Legend::Scale { title, ends, color } => {
            let top = pos2(rect.right() - 64.0, rect.top() + 34.0);
            painter.text(pos2(rect.right() - 12.0, rect.top() + 10.0), Align2::RIGHT_TOP, title, small(), dim);
            for stripe in 0..NUM_STRIPES {
                let part = f32::from(stripe) / f32::from(NUM_STRIPES);
                let min = top + vec2(0.0, HEIGHT * part);
                let size = vec2(WIDTH, HEIGHT / f32::from(NUM_STRIPES) + 0.5);
                painter.rect_filled(Rect::from_min_size(min, size), 0.0, color(1.0 - part));
            }
            for (part, value) in [(0.0, ends[1]), (0.5, f64::midpoint(ends[0], ends[1])), (1.0, ends[0])] {
                let at = top + vec2(WIDTH + 6.0, HEIGHT * part);
                let decimals = if (ends[1] - ends[0]).abs() < 5.0 { 2 } else { 1 };
                painter.text(at, Align2::LEFT_CENTER, widgets::fixed(value, decimals), theme::number_font(), dim);
            }
        }
        Legend::Names(names) => {
            for (number, (name, color)) in (0_u8..).zip(names) {
                let at = pos2(rect.right() - 14.0, rect.top() + 18.0 + 18.0 * f32::from(number));
                painter.rect_filled(Rect::from_center_size(at, vec2(10.0, 10.0)), 2.0, *color);
                painter.text(at - vec2(10.0, 0.0), Align2::RIGHT_CENTER, name, small(), theme::palette(ui).text);
            }
        }
    }
}
