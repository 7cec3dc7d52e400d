//! The flange as a small triad with the direction that is known least, and how much the stations turn about each axis.

use egui::{
    Align2, FontId, Frame, Label, Margin, Pos2, Rect, Role, Sense, Stroke, Ui, UiBuilder, Vec2, WidgetInfo, vec2,
};

use crate::calibrate::Mount;
use crate::geometry::Vec3;
use crate::text::diagnosis as fault_words;
use crate::text::diagnosis_panel as words;
use crate::ui::charts::arrow;
use crate::ui::theme;
use crate::ui::widgets::fixed;

/// Length of an axis as a part of the picture's smaller side.
const AXIS_PART: f32 = 0.36;
/// Points of the flange's disc.
const NUM_CORNERS: u16 = 60;

/// Shows both in the space available.
pub fn show(ui: &mut Ui, in_flange: Vec3, rotations_deg: [f64; 3], mount: Mount) {
    let area = ui.available_rect_before_wrap();
    let (left, right) = area.split_left_right_at_x(area.left() + area.height().min(area.width() * 0.5));
    let name = words::unknown_direction(&fault_words::along(in_flange, mount));
    let response = ui.allocate_rect(left, Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, &name));
    picture(ui, left.shrink(theme::GAP), in_flange);
    let mut inside = ui.new_child(UiBuilder::new().max_rect(right));
    Frame::new().inner_margin(Margin::same(16)).show(&mut inside, |ui| {
        ui.add(Label::new(theme::strong(&name)).wrap());
        let [x, y, z] = [in_flange.x, in_flange.y, in_flange.z].map(|part| fixed(part, 3));
        ui.label(theme::dim(ui, words::unit_vector(&x, &y, &z)));
        ui.add_space(16.0);
        ui.label(theme::dim(ui, words::ROTATIONS_ABOUT));
        ui.add_space(4.0);
        let most_deg = rotations_deg.into_iter().fold(f64::MIN_POSITIVE, f64::max);
        for (name, rotation_deg) in words::PRINCIPAL_AXES.into_iter().zip(rotations_deg) {
            rotation_bar(ui, name, rotation_deg, most_deg);
        }
    });
    ui.advance_cursor_after_rect(area);
}

fn rotation_bar(ui: &mut Ui, name: &str, rotation_deg: f64, most_deg: f64) {
    /// Room for a name, points.
    const NAME_WIDTH: f32 = 64.0;
    /// Room for a figure, points.
    const FIGURE_WIDTH: f32 = 56.0;
    let palette = theme::palette(ui);
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), theme::ROW_HEIGHT), Sense::hover());
    let figure = format!("{}°", fixed(rotation_deg, 2));
    response.widget_info(|| WidgetInfo::labeled(Role::Label, true, format!("{name}: {figure}")));
    let painter = ui.painter();
    let font = FontId::proportional(theme::BODY_SIZE);
    painter.text(rect.left_center(), Align2::LEFT_CENTER, name, font, palette.text_dim);
    let room =
        rect.with_min_x(rect.left() + NAME_WIDTH).with_max_x(rect.right() - FIGURE_WIDTH).shrink2(vec2(0.0, 7.0));
    #[expect(clippy::cast_possible_truncation, reason = "a part of a screen's width")]
    let part = (rotation_deg / most_deg).clamp(0.0, 1.0) as f32;
    let bar = room.with_max_x(room.left() + (room.width() * part).max(2.0));
    painter.rect_filled(bar, 1.0, theme::INLIER);
    painter.text(rect.right_center(), Align2::RIGHT_CENTER, figure, theme::number_font(), palette.text);
}

/// Seen from the front, the right and above, so that no axis hides another.
#[expect(clippy::cast_possible_truncation, reason = "screen coordinates")]
#[must_use]
pub fn projected(point: Vec3) -> Vec2 {
    let (x, y, z) = (point.x as f32, point.y as f32, point.z as f32);
    vec2(-0.62 * x + 0.90 * y, 0.45 * x + 0.16 * y - 0.92 * z)
}

fn picture(ui: &Ui, place: Rect, in_flange: Vec3) {
    let palette = theme::palette(ui);
    let painter = ui.painter().with_clip_rect(place.expand(theme::GAP).intersect(ui.clip_rect()));
    let centre = place.center() + vec2(0.0, place.height() * 0.06);
    let length = place.width().min(place.height()) * AXIS_PART;
    let at = |point: Vec3| centre + projected(point) * length;
    let disc: Vec<Pos2> = (0..NUM_CORNERS)
        .map(|corner| {
            let (sin, cos) = (std::f64::consts::TAU * f64::from(corner) / f64::from(NUM_CORNERS)).sin_cos();
            at(Vec3::new(cos, sin, 0.0) * 0.62)
        })
        .collect();
    let fill = palette.text_dim.gamma_multiply(0.10);
    painter.add(egui::Shape::convex_polygon(disc, fill, Stroke::new(1.0, palette.text_dim.gamma_multiply(0.5))));
    for (axis, name) in [(Vec3::x(), "x"), (Vec3::y(), "y"), (Vec3::z(), "z")] {
        arrow(&painter, centre, at(axis), Stroke::new(1.5, palette.text_dim));
        let font = FontId::proportional(theme::BODY_SIZE);
        // Beside the tip, where an arrow along the axis does not run over it.
        let beside = projected(axis).normalized().rot90() * 9.0;
        painter.text(at(axis) + beside, Align2::CENTER_CENTER, name, font, palette.text_dim);
    }
    // Which way along it makes no difference, so it points both ways.
    let direction = in_flange.try_normalize(0.0).unwrap_or_else(Vec3::zeros) * 1.32;
    let stroke = Stroke::new(3.0, palette.bad);
    arrow(&painter, centre, at(direction), stroke);
    arrow(&painter, centre, at(-direction), stroke);
    painter.circle_filled(centre, 3.0, palette.text);
}
