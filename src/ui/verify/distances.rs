//! Distances of edge points to the fitted lines and plane, as tables, histograms and a picture in space.

use egui::Ui;

use crate::ui::{PanelContext, widgets};

/// What the section remembers between frames.
#[derive(Debug, Default)]
pub(super) struct DistancesState {}

/// Shows the section.
pub(super) fn show(ui: &mut Ui, _context: &mut PanelContext<'_>, _state: &mut DistancesState) {
    widgets::nothing(ui, "");
}
