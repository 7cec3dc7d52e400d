//! A known point measured many times with every calibration at hand, and the calibrations side by side.

use egui::Ui;

use crate::ui::{PanelContext, widgets};

/// What the section remembers between frames.
#[derive(Debug, Default)]
pub(super) struct StabilityState {}

/// Shows the section.
pub(super) fn show(ui: &mut Ui, _context: &mut PanelContext<'_>, _state: &mut StabilityState) {
    widgets::nothing(ui, "");
}
