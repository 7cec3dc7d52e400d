//! Everything a user can ask the workbench to do.

use std::path::PathBuf;

use crate::calibrate::SideChoice;
use crate::diagnose::Remedy;
use crate::plan::Limits;

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
    /// Mends the session as a finding proposes, as one edit.
    ApplyRemedy(Remedy),
    /// Takes the last edit back.
    Undo,
    /// Brings back what was undone.
    Redo,
    /// Solves the session as it is now; needed only after a cancel, as every edit solves by itself.
    Solve,
    /// Stops the solver; the last results stay.
    CancelSolve,
    /// Examines the results as they are now; needed only after a cancel, as new results are examined by themselves.
    Diagnose,
    /// Stops the diagnosis; the last one stays.
    CancelDiagnosis,
    /// Tries the other ways to read the poses, even if those given fit.
    RankReadings,
    /// Stops trying them.
    CancelReadings,
    /// Solves many times with stations drawn with replacement.
    StartBootstrap {
        /// How many times.
        num_draws: usize,
    },
    /// Stops that; the last outcome stays.
    CancelBootstrap,
    /// Plans the next stations within other limits.
    SetPlanLimits(Limits),
    /// Removes a notice.
    DismissNotice(u64),
}
