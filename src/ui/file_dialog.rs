//! The system's file dialog, on a thread of its own: it blocks until the user is done.

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, TryRecvError, sync_channel};
use std::thread;
use std::time::{Duration, Instant};

use crate::app::jobs::Wake;
use crate::text::{
    capture as capture_words, compare_results as compare_words, import as import_words, report_panel as report_words,
    sequence as sequence_words, shell as words, tool_frame as tool_frame_words, verify as verify_words,
    workpiece as workpiece_words,
};

/// Nobody cancels a dialog faster than this; so quick a "nothing chosen" means that no dialog came up.
const FASTEST_CANCEL: Duration = Duration::from_millis(500);

/// What the dialog is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// Choosing a session to open.
    Open,
    /// Choosing the folder of an RGB-D sequence to open.
    SequenceFolder,
    /// Choosing a file to save the session to.
    Save,
    /// Choosing files of poses and profiles.
    ImportFiles,
    /// Choosing a folder of them.
    ImportFolder,
    /// Choosing a session whose stations are added to the open one.
    AddSession,
    /// Choosing a session whose target is added to the open one.
    AddFurther,
    /// Choosing a file to write the poses to.
    ExportPoses,
    /// Choosing a folder to write the profiles to.
    ExportProfiles,
    /// Choosing a file to write points to.
    ExportPoints,
    /// Choosing a file of points.
    OpenPoints,
    /// Choosing a file with a calibration.
    Calibration,
    /// Choosing a file for a side of a comparison.
    Compared(usize),
    /// Choosing a folder of results.
    ResultFolder,
    /// Choosing the folder that a profiler's software saves profiles into.
    WatchedFolder,
    /// Choosing a file to write a tool frame to.
    ToolFrame,
    /// Choosing a folder to write the report into.
    ReportFolder,
    /// Choosing a file to write the picture of a plot to.
    Picture,
    /// Choosing a file to write the motion of a sequence to.
    SequenceFile,
}

/// Files of poses and profiles by their endings.
const IMPORT_ENDINGS: [&str; 14] =
    ["csv", "tsv", "txt", "ls", "mod", "src", "dat", "script", "urscript", "yaml", "yml", "json", "mcap", "db3"];

impl Purpose {
    /// The heading where a path is typed for it.
    #[must_use]
    pub const fn title(self) -> &'static str {
        match self {
            Self::Open => words::OPEN,
            Self::SequenceFolder => sequence_words::OPEN_FOLDER_TITLE,
            Self::Save => words::SAVE_AS_TITLE,
            Self::ImportFiles | Self::ImportFolder => import_words::IMPORT_PATH_TITLE,
            Self::AddSession => import_words::ADD_SESSION_PATH_TITLE,
            Self::AddFurther => verify_words::ADD_TARGET_TITLE,
            Self::ExportPoses => import_words::EXPORT_POSES_TITLE,
            Self::ExportProfiles => import_words::EXPORT_PROFILES_TITLE,
            Self::ExportPoints => workpiece_words::EXPORT_POINTS_TITLE,
            Self::OpenPoints => workpiece_words::OPEN_POINTS_TITLE,
            Self::Calibration => workpiece_words::CALIBRATION_TITLE,
            Self::Compared(_) => compare_words::CHOOSE_SIDE_TITLE,
            Self::ResultFolder => compare_words::CHOOSE_FOLDER_TITLE,
            Self::WatchedFolder => capture_words::FOLDER_TITLE,
            Self::ToolFrame => tool_frame_words::SAVE_TITLE,
            Self::Picture => report_words::PICTURE_TITLE,
            Self::SequenceFile => sequence_words::SAVE_TITLE,
            Self::ReportFolder => report_words::REPORT_FOLDER_TITLE,
        }
    }

    /// The button below that path.
    #[must_use]
    pub const fn button(self) -> &'static str {
        match self {
            Self::Open | Self::SequenceFolder | Self::OpenPoints => words::OPEN,
            Self::Calibration => workpiece_words::USE_BUTTON,
            Self::Save | Self::ToolFrame | Self::Picture | Self::SequenceFile | Self::ReportFolder => words::SAVE,
            Self::ImportFiles | Self::ImportFolder | Self::AddSession => import_words::IMPORT_BUTTON,
            Self::AddFurther => verify_words::ADD_TARGET_BUTTON,
            Self::ExportPoses | Self::ExportProfiles | Self::ExportPoints => import_words::EXPORT_BUTTON,
            Self::Compared(_) | Self::ResultFolder => compare_words::USE_PATH,
            Self::WatchedFolder => capture_words::FOLDER_BUTTON,
        }
    }

    /// Whether a file is written, so that one that is there is replaced.
    #[must_use]
    pub const fn writes_a_file(self) -> bool {
        matches!(
            self,
            Self::Save | Self::ExportPoses | Self::ExportPoints | Self::ToolFrame | Self::Picture | Self::SequenceFile
        )
    }
}

/// What came of a dialog.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Answer {
    /// At least one path was chosen; more than one only for [`Purpose::ImportFiles`].
    Chosen(Purpose, Vec<PathBuf>),
    /// The user thought better of it.
    Cancelled,
    /// The system has no dialog to offer.
    Unavailable(Purpose),
}

/// At most one dialog at a time.
#[derive(Debug, Default)]
pub struct FileDialog {
    waiting: Option<(Purpose, Receiver<Answer>)>,
}

impl FileDialog {
    /// Shows a dialog unless one is up; `suggested_name` is for saving.
    pub fn start(&mut self, purpose: Purpose, suggested_name: String, wake: Wake) {
        if self.waiting.is_some() {
            return;
        }
        let (sender, receiver) = sync_channel(1);
        self.waiting = Some((purpose, receiver));
        if !is_available() {
            // Room for one answer, and the receiver is at hand.
            sender.send(Answer::Unavailable(purpose)).ok();
            wake();
            return;
        }
        // If no thread is to be had, the sender is dropped, which `poll` reads as no dialog.
        thread::Builder::new()
            .name("file dialog".to_owned())
            .spawn(move || {
                // The window may have been closed meanwhile; then nobody wants the answer.
                sender.send(ask(purpose, &suggested_name)).ok();
                wake();
            })
            .ok();
    }

    /// The answer, once.
    pub fn poll(&mut self) -> Option<Answer> {
        let (purpose, receiver) = self.waiting.as_ref()?;
        let answer = match receiver.try_recv() {
            Ok(answer) => answer,
            Err(TryRecvError::Empty) => return None,
            Err(TryRecvError::Disconnected) => Answer::Unavailable(*purpose),
        };
        self.waiting = None;
        Some(answer)
    }

    /// Whether a dialog is up.
    #[must_use]
    pub const fn is_open(&self) -> bool {
        self.waiting.is_some()
    }
}

fn ask(purpose: Purpose, suggested_name: &str) -> Answer {
    let start = Instant::now();
    let dialog = rfd::FileDialog::new();
    let sessions = |dialog: rfd::FileDialog| dialog.add_filter(words::FILE_FILTER, &["json"]);
    let all = |dialog: rfd::FileDialog| dialog.add_filter(import_words::ALL_FILTER, &["*"]);
    let one = |path: PathBuf| vec![path];
    let chosen = match purpose {
        Purpose::Open => all(sessions(dialog)).pick_file().map(one),
        Purpose::Save => sessions(dialog).set_file_name(suggested_name).save_file().map(one),
        Purpose::ImportFiles => all(dialog.add_filter(import_words::IMPORT_FILTER, &IMPORT_ENDINGS)).pick_files(),
        Purpose::AddSession | Purpose::AddFurther => sessions(dialog).pick_file().map(one),
        Purpose::ExportPoses => {
            let dialog = dialog.add_filter(import_words::CSV_FILTER, &["csv"]);
            dialog.set_file_name(suggested_name).save_file().map(one)
        }
        Purpose::ExportPoints => {
            let dialog = dialog.add_filter(workpiece_words::POINTS_FILTER, &["ply", "csv"]);
            dialog.set_file_name(suggested_name).save_file().map(one)
        }
        Purpose::OpenPoints => {
            let dialog = dialog.add_filter(workpiece_words::POINTS_FILTER, &["ply", "csv", "xyz", "txt", "asc", "pts"]);
            all(dialog).pick_file().map(one)
        }
        Purpose::Calibration | Purpose::Compared(_) => all(dialog).pick_file().map(one),
        Purpose::ToolFrame | Purpose::Picture | Purpose::SequenceFile => {
            all(dialog).set_file_name(suggested_name).save_file().map(one)
        }
        Purpose::SequenceFolder
        | Purpose::ImportFolder
        | Purpose::ExportProfiles
        | Purpose::WatchedFolder
        | Purpose::ReportFolder
        | Purpose::ResultFolder => dialog.pick_folder().map(one),
    };
    match chosen.filter(|paths| !paths.is_empty()) {
        Some(paths) => Answer::Chosen(purpose, paths),
        None if start.elapsed() < FASTEST_CANCEL => Answer::Unavailable(purpose),
        None => Answer::Cancelled,
    }
}

/// Whether a dialog can be expected to come up: a message bus for the portal, or the program `zenity`.
#[cfg(target_os = "linux")]
fn is_available() -> bool {
    let has_bus = std::env::var_os("DBUS_SESSION_BUS_ADDRESS").is_some_and(|address| !address.is_empty())
        || std::env::var_os("XDG_RUNTIME_DIR").is_some_and(|dir| PathBuf::from(dir).join("bus").exists());
    let has_zenity = || {
        std::env::var_os("PATH").is_some_and(|path| std::env::split_paths(&path).any(|dir| dir.join("zenity").exists()))
    };
    has_bus || has_zenity()
}

#[cfg(not(target_os = "linux"))]
const fn is_available() -> bool {
    true
}
