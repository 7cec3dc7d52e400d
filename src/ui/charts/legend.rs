//! The legend: one row above a plot, where it covers no data.

use egui::{Color32, Sense, Stroke, Ui, vec2};
use egui_plot::MarkerShape;

use crate::ui::theme;

use super::marks;

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
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing = vec2(4.0, 0.0);
            ui.spacing_mut().interact_size.y = 16.0;
            for entry in entries {
                let (rect, _) = ui.allocate_exact_size(vec2(16.0, 16.0), Sense::hover());
                let (painter, centre) = (ui.painter(), rect.center());
                let stroke = Stroke::new(1.5, entry.color);
                let ends = marks::cross(centre, 8.0)[0];
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
                ui.label(theme::dim(ui, entry.text.as_str()).size(theme::SMALL_SIZE));
                ui.add_space(8.0);
            }
        });
    });
}
