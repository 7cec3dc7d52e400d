//! Everything a user can ask the workbench to do.

use std::path::PathBuf;

use crate::calibrate::SideChoice;

/// A request from a panel, a shortcut or a test; [`super::Workbench::apply`] carries them out in order.
#[derive(Clone, Debug, PartialEq)]
pub enum Command {
    /// Reads a session file in the background.
    Open(PathBuf),
    /// Opens a sample by its index in [`crate::session::samples::ALL`].
    OpenSample(usize),
    /// Goes back to the start page.
    CloseDocument,
    /// Writes the session to its file.
    Save,
    /// Writes the session to another file.
    SaveAs(PathBuf),
    /// Lets a station take part or not.
    SetStationEnabled {
        /// Index of the station.
        station_idx: usize,
        /// Whether it takes part.
        enabled: bool,
    },
    /// Says on which side of the laser plane the ball's centre is.
    SetStationSide {
        /// Index of the station.
        station_idx: usize,
        /// The side.
        side: SideChoice,
    },
    /// Takes the last edit back.
    Undo,
    /// Brings back what was undone.
    Redo,
    /// Solves the session as it is now; needed only after a cancel, as every edit solves by itself.
    Solve,
    /// Stops the solver; the last results stay.
    CancelSolve,
    /// Removes a notice.
    DismissNotice(u64),
}
