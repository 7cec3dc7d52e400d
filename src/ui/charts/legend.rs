//! The legend: one row above a plot, where it covers no data.

use egui::{Color32, Pos2, Role, Sense, Stroke, Ui, WidgetInfo, pos2, vec2};
use egui_plot::MarkerShape;

use crate::ui::theme;

use super::marks;

/// Room for a sign, points.
const SIGN_WIDTH: f32 = 14.0;

/// The sign of a legend entry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LegendGlyph {
    /// A solid marker.
    Solid(MarkerShape),
    /// A hollow marker.
    Hollow(MarkerShape),
    /// A line.
    Line,
    /// A dashed line.
    Dashed,
}

/// One entry of a legend.
#[derive(Clone, Debug, PartialEq)]
pub struct LegendEntry {
    /// Its sign.
    pub glyph: LegendGlyph,
    /// The sign's colour.
    pub color: Color32,
    /// What it stands for.
    pub text: String,
}

/// A row of entries, wrapped where it does not fit.
pub fn legend(ui: &mut Ui, entries: &[LegendEntry]) {
    egui::Frame::new().inner_margin(egui::Margin { left: 12, right: 8, top: 6, bottom: 0 }).show(ui, |ui| {
        ui.spacing_mut().interact_size.y = 16.0;
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing = vec2(12.0, 0.0);
            for entry in entries {
                let font = egui::FontId::proportional(theme::SMALL_SIZE);
                let galley = ui.painter().layout_no_wrap(entry.text.clone(), font, theme::palette(ui).text_dim);
                // Sign and words are one piece, so that a line never breaks between them.
                let size = vec2(SIGN_WIDTH + 4.0 + galley.size().x, 16.0);
                let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
                response.widget_info(|| WidgetInfo::labeled(Role::Label, true, &entry.text));
                let at = pos2(rect.left() + SIGN_WIDTH + 4.0, rect.center().y - galley.size().y / 2.0);
                ui.painter().galley(at, galley, entry.color);
                sign(ui, pos2(rect.left() + SIGN_WIDTH / 2.0, rect.center().y), entry);
            }
        });
    });
}

fn sign(ui: &Ui, centre: Pos2, entry: &LegendEntry) {
    let painter = ui.painter();
    let stroke = Stroke::new(1.5, entry.color);
    let ends = [centre - vec2(SIGN_WIDTH / 2.0, 0.0), centre + vec2(SIGN_WIDTH / 2.0, 0.0)];
    match entry.glyph {
        LegendGlyph::Solid(shape) => marks::marker(painter, shape, centre, 3.5, entry.color, Stroke::NONE),
        LegendGlyph::Hollow(shape) => {
            marks::marker(painter, shape, centre, 3.5, Color32::TRANSPARENT, Stroke::new(1.2, entry.color));
        }
        LegendGlyph::Line => {
            painter.line_segment(ends, stroke);
        }
        LegendGlyph::Dashed => marks::dashed_line(painter, &ends, stroke),
    }
}
