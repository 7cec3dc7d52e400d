//! The step's sections.

use egui::Ui;

use crate::report::document::Options;
use crate::text::report_panel as words;
use crate::ui::{PanelContext, theme, widgets};

use super::preview::{self, PreviewState, ReportMemory};
use super::tool_frame::{self, ToolFrameState};

/// What the step remembers between frames.
#[derive(Debug, Default)]
pub struct ReportState {
    shows_tool_frame: bool,
    preview: PreviewState,
    tool_frame: ToolFrameState,
}

impl ReportState {
    /// Whether a figure is being drawn.
    #[must_use]
    pub const fn is_drawing(&self) -> bool {
        self.preview.is_drawing()
    }

    /// What the report is to hold.
    #[must_use]
    pub fn options(&self, memory: &ReportMemory) -> Options {
        self.preview.options(memory)
    }
}

/// Shows the step.
pub fn show(ui: &mut Ui, context: &mut PanelContext<'_>, state: &mut ReportState, memory: &mut ReportMemory) {
    let is_old = context.workbench.results().is_some() && !context.workbench.results_are_current();
    let note = if is_old { words::OUT_OF_DATE } else { "" };
    let names = [(words::REPORT, words::REPORT_HINT), (words::TOOL_FRAME, words::TOOL_FRAME_HINT)];
    if let Some(chosen_idx) = widgets::tabs(ui, &names, usize::from(state.shows_tool_frame), note, is_old) {
        state.shows_tool_frame = chosen_idx == 1;
    }
    ui.add_space(theme::GAP);
    if state.shows_tool_frame {
        tool_frame::show(ui, context, &mut state.tool_frame);
    } else {
        preview::show(ui, context, &mut state.preview, memory);
    }
}
