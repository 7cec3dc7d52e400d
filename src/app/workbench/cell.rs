//! The live cell behind the window: its links, its routine, its run, and what they bring into the document.

use crate::app::cell::{CellCommand, CellView};

use super::Workbench;

impl Workbench {
    /// The live cell as it stands.
    #[must_use]
    pub const fn cell(&self) -> &CellView {
        &self.cell
    }

    pub(super) fn command_cell(&mut self, command: CellCommand) {
        if let CellCommand::SetSettings(settings) = command {
            self.cell.settings = *settings;
        }
    }
}
