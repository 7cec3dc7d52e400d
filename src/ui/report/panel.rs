//! The step's sections.

use egui::Ui;

use crate::text::report_panel as words;
use crate::ui::{PanelContext, theme, widgets};

use super::tool_frame::{self, ToolFrameState};

/// What the step remembers between frames.
#[derive(Debug, Default)]
pub struct ReportState {
    tool_frame: ToolFrameState,
}

/// Shows the step.
pub fn show(ui: &mut Ui, context: &mut PanelContext<'_>, state: &mut ReportState) {
    let is_old = context.workbench.results().is_some() && !context.workbench.results_are_current();
    let note = if is_old { words::OUT_OF_DATE } else { "" };
    widgets::tabs(ui, &[(words::TOOL_FRAME, words::TOOL_FRAME_HINT)], 0, note, is_old);
    ui.add_space(theme::GAP);
    tool_frame::show(ui, context, &mut state.tool_frame);
}
