//! The step's panel.

use crate::ui::PanelContext;

/// The panel's own state.
#[derive(Debug, Default)]
pub struct ArcsState;

/// Draws the step.
pub fn show(ui: &mut egui::Ui, _context: &mut PanelContext<'_>, _state: &mut ArcsState) {
    ui.label("Arcs");
}
