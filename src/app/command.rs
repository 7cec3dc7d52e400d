//! Everything a user can ask the workbench to do.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::calibrate::SideChoice;
use crate::diagnose::Remedy;
use crate::plan::Limits;
use crate::report::document::Options;
use crate::session::import::ImportOptions;
use crate::session::sequence::CAMERA_FILE;
use crate::session::{Edit, Target};
use crate::text::sequence as words;
use crate::verify::Calibration;

use super::cell::CellCommand;
use super::workbench::NoticeKind;
use super::workbench::comparing::Sides;
use super::workbench::scans::ScanCommand;
use super::workbench::sequence::SequenceCommand;

impl Command {
    /// Reads what a user has pointed at: a session is opened, anything else goes to the import's preview.
    #[must_use]
    pub fn to_read(mut paths: Vec<PathBuf>) -> Self {
        match paths.pop() {
            Some(only) if paths.is_empty() && names_a_session(&only) => Self::Open(only),
            last => {
                paths.extend(last);
                Self::Import(paths)
            }
        }
    }

    /// Opens the folder of an RGB-D sequence; of any other folder it says what is missing.
    #[must_use]
    pub fn to_open_sequence(folder: &Path) -> Self {
        if is_sequence(folder) {
            Self::Open(folder.to_owned())
        } else {
            Self::Tell(NoticeKind::Error, words::no_sequence(&folder.display().to_string()))
        }
    }
}

/// A folder with a camera's file.
fn is_sequence(folder: &Path) -> bool {
    folder.join(CAMERA_FILE).is_file()
}

/// Sessions are JSON; of a file without an ending nothing else is known. A sequence is opened as one.
fn names_a_session(path: &Path) -> bool {
    if is_sequence(path) {
        return true;
    }
    match path.extension() {
        Some(ending) => ending.eq_ignore_ascii_case("json") && !path.is_dir(),
        None => !path.is_dir(),
    }
}

/// Where imported stations go.
#[derive(Clone, Debug, PartialEq)]
pub enum ImportInto {
    /// A session of their own.
    NewSession {
        /// Its name.
        name: String,
        /// What was measured.
        target: Target,
    },
    /// The session on the bench, behind its stations.
    OpenSession,
}

/// A request from a panel, a shortcut or a test; [`super::Workbench::apply`] carries them out in order.
#[derive(Clone, Debug, PartialEq)]
pub enum Command {
    /// Reads a session file in the background.
    Open(PathBuf),
    /// Begins an empty session for a target.
    NewSession(Target),
    /// Opens a sample by its index in [`crate::session::samples::ALL`].
    OpenSample(usize),
    /// Goes back to the start page.
    CloseDocument,
    /// Writes the session to its file.
    Save,
    /// Writes the session to another file.
    SaveAs(PathBuf),
    /// Writes the session to its file although another program has changed that file meanwhile.
    SaveAnyway,
    /// Leaves a file that another program has changed as it is: the save that met it is given up.
    GiveUpSaving,
    /// Looks whether another program has changed the session's file.
    CheckFile,
    /// Reads the session's file again; what was edited meanwhile can be brought back by undo.
    Reload,
    /// Opens what a run that ended badly left behind, by its index in [`super::Workbench::recoverable`].
    Recover(usize),
    /// Throws that away.
    DiscardRecoverable(usize),
    /// Changes the session. Edits that carry the same gesture, such as the strokes of one typing, are one step of undo.
    Edit {
        /// The change.
        edit: Edit,
        /// What it belongs to, if it is a part of something longer.
        gesture: Option<u64>,
    },
    /// Goes back (negative) or forth by so many steps of the history.
    StepHistory(isize),
    /// Reads files and folders of poses and profiles for a preview.
    Import(Vec<PathBuf>),
    /// Reads pasted text for a preview.
    ImportText(String),
    /// Reads what is in the preview in another way.
    SetImportOptions(Box<ImportOptions>),
    /// Ends the preview: its stations become a new session, or are added to the open one.
    FinishImport(ImportInto),
    /// Ends the preview.
    CancelImport,
    /// Writes the poses as CSV.
    ExportPoses(PathBuf),
    /// Writes the profiles as CSV, one a file, into a folder.
    ExportProfiles(PathBuf),
    /// Writes a file that the window has made: a tool frame, a picture.
    WriteFile {
        /// Where to. Whoever asked for it has asked about a file that is there.
        path: PathBuf,
        /// What stands in it.
        contents: Arc<[u8]>,
    },
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
    /// What is asked of an RGB-D sequence.
    Sequence(SequenceCommand),
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
    /// Reads another session file in the background; its target becomes a further one of the open session.
    AddFurther(PathBuf),
    /// Judges a calibration from elsewhere along with the session's own.
    GiveCalibration(Box<Calibration>),
    /// Forgets it, by its name.
    WithdrawCalibration(String),
    /// Holds two calibrations against each other.
    CompareCalibrations(Box<Sides>),
    /// Stops that; the last comparison stays.
    CancelComparison,
    /// Reads the calibrations of a folder and looks at them over time.
    ReadResultHistory(PathBuf),
    /// Stops that; the last history stays.
    CancelResultHistory,
    /// Something for scanned parts.
    Scan(Box<ScanCommand>),
    /// Something for the live cell.
    Cell(Box<CellCommand>),
    /// Gathers what a report is made of.
    GatherReport,
    /// Stops that; what was gathered last stays.
    CancelReport,
    /// Opens the page of the report that was written last in a browser.
    OpenReport,
    /// Writes the report, as a page and as Markdown, with its tables, figures and exports.
    WriteReport {
        /// The folder, made if it is missing; files of a report that is there are replaced.
        folder: PathBuf,
        /// What it is to hold.
        options: Box<Options>,
    },
    /// Says that something was done, or could not be.
    Tell(NoticeKind, String),
    /// Removes a notice.
    DismissNotice(u64),
}
