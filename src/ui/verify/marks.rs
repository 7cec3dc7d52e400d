//! The colour, marker and name that a calibration has in every table and picture of this step.

use egui::{Align2, Color32, Pos2, Rect, Stroke, Ui, vec2};
use egui_plot::MarkerShape;

use crate::report::figure::palette::{CalibrationLook, calibration_look};
use crate::text::verify as words;
use crate::ui::charts::{self, LegendEntry, LegendGlyph};
use crate::ui::theme;
use crate::verify::{Origin, Verification};

/// A calibration as it is shown.
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    /// Its name.
    pub name: String,
    /// Its colour.
    pub color: Color32,
    /// Its marker.
    pub shape: MarkerShape,
    /// Which of the targets it was computed from, if not the first: the same method on another target looks hollow.
    further: Option<usize>,
}

impl Mark {
    /// One entry a calibration, in their order.
    pub fn all(verification: &Verification) -> Vec<Self> {
        let of = |origin: &Origin| {
            let CalibrationLook { color, marker, further } = calibration_look(origin);
            let name = words::calibration_name(origin, verification);
            Self { name, color: theme::color_of(color), shape: theme::marker_shape(marker), further }
        };
        verification.calibrations.iter().map(|calibration| of(&calibration.origin)).collect()
    }

    /// Of something else than a calibration, in the same charts.
    pub const fn plain(name: String, color: Color32) -> Self {
        Self { name, color, shape: MarkerShape::Square, further: None }
    }

    /// The marker.
    pub fn paint(&self, painter: &egui::Painter, at: Pos2) {
        charts::marker(painter, self.shape, at, 4.5, self.fill(), self.stroke());
    }

    /// A bar of a chart.
    pub fn paint_bar(&self, painter: &egui::Painter, bar: Rect) {
        painter.rect(bar, 1.0, self.fill(), self.stroke(), egui::StrokeKind::Inside);
    }

    /// Solid on the first target, and fainter with each further one.
    fn fill(&self) -> Color32 {
        match self.further {
            None => self.color,
            Some(1) => self.color.gamma_multiply(0.28),
            Some(_) => Color32::TRANSPARENT,
        }
    }

    fn stroke(&self) -> Stroke {
        if self.further.is_some() { Stroke::new(1.2, self.color) } else { Stroke::NONE }
    }

    /// The marker and the name at the left of a cell, cut where there is no room.
    pub fn paint_in(&self, ui: &Ui, cell: Rect, color: Color32) {
        self.paint(ui.painter(), cell.left_center() + vec2(16.0, 0.0));
        let painter = ui.painter().with_clip_rect(cell.shrink2(vec2(2.0, 0.0)).intersect(ui.clip_rect()));
        let font = egui::FontId::proportional(theme::BODY_SIZE);
        painter.text(cell.left_center() + vec2(28.0, 0.0), Align2::LEFT_CENTER, &self.name, font, color);
    }

    /// Its entry in a legend.
    pub fn legend_entry(&self) -> LegendEntry {
        let glyph =
            if self.further.is_some() { LegendGlyph::Hollow(self.shape) } else { LegendGlyph::Solid(self.shape) };
        LegendEntry { glyph, color: self.color, text: self.name.clone() }
    }
}
