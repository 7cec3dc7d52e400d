//! The flange's axes as they are and as they would be, seen in the robot's base: how a proposed station is turned.

use egui::{Align2, FontId, Rect, Role, Sense, Stroke, Ui, WidgetInfo};

use crate::app::cell::Proposal;
use crate::geometry::{Base, Flange, Transform, Vec3};
use crate::text::capture as words;
use crate::ui::charts::arrow;
use crate::ui::diagnosis::triad::projected;
use crate::ui::theme;
use crate::ui::widgets::fixed;

use super::model::View;

/// Length of an axis as a part of the picture's side.
const AXIS_PART: f32 = 0.36;

/// Draws both into `rect`.
pub fn show(ui: &mut Ui, rect: Rect, view: &View<'_>, proposal: &Proposal) {
    let station = &proposal.station;
    let [tilt, azimuth, spin] = [station.tilt_deg, station.azimuth_deg, station.spin_deg].map(|angle| fixed(angle, 0));
    let name = words::picture(&tilt, &azimuth, &spin);
    let response = ui.interact(rect, ui.scope_id().with("orientation"), Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, &name));
    response.on_hover_text(&name);
    if let Some(report) = &view.cell.robot.latest {
        axes(ui, rect, &report.base_from_flange, false);
    }
    axes(ui, rect, &station.base_from_flange, true);
}

fn axes(ui: &Ui, rect: Rect, base_from_flange: &Transform<Base, Flange>, is_target: bool) {
    let rotation = base_from_flange.rotation();
    let length = rect.width().min(rect.height()) * AXIS_PART;
    let painter = ui.painter().with_clip_rect(rect.intersect(ui.clip_rect()));
    let centre = rect.center();
    for ((axis, name), color) in
        [(Vec3::x(), "x"), (Vec3::y(), "y"), (Vec3::z(), "z")].into_iter().zip(theme::axis_colors(ui))
    {
        let tip = projected(rotation * axis) * length;
        let (width, color) = if is_target { (2.0, color) } else { (1.2, color.gamma_multiply(0.35)) };
        arrow(&painter, centre, centre + tip, Stroke::new(width, color));
        if is_target {
            let beside = centre + tip + tip.normalized() * 8.0;
            painter.text(beside, Align2::CENTER_CENTER, name, FontId::proportional(theme::SMALL_SIZE), color);
        }
    }
    painter.circle_filled(centre, 2.5, theme::palette(ui).text);
}
