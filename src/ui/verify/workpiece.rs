//! A scanned part: its cloud, regions, planes, teeth and diameters.

use egui::Ui;

use crate::ui::{PanelContext, widgets};

/// What the section remembers between frames.
#[derive(Debug, Default)]
pub(super) struct WorkpieceState {}

/// Shows the section.
pub(super) fn show(ui: &mut Ui, _context: &mut PanelContext<'_>, _state: &mut WorkpieceState) {
    widgets::nothing(ui, "");
}
