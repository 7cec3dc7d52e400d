//! The calibration on the data of other targets, and the joint calibration of them all.

use egui::Ui;

use crate::ui::{PanelContext, widgets};

/// What the section remembers between frames.
#[derive(Debug, Default)]
pub(super) struct CrossTargetState {}

/// Shows the section.
pub(super) fn show(ui: &mut Ui, _context: &mut PanelContext<'_>, _state: &mut CrossTargetState) {
    widgets::nothing(ui, "");
}
