//! What menus, buttons and shortcuts offer: wording, shortcut, and why it may be unavailable stand here once.

use egui::{Key, KeyboardShortcut, Modifiers};

use crate::app::{Document, Workbench};
use crate::scene::PartKind;
use crate::session::{Capture, Reading};
use crate::text::{
    capture as capture_words, compare_results as compare_words, document as document_words, import as import_words,
    report_panel as report_words, sequence as sequence_words, shell as words, verify as verify_words,
    workpiece as workpiece_words,
};

use super::rail::Step;

/// Something the window itself does, or passes on to the workbench as a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// Asks for a file and opens it.
    Open,
    /// Asks for the folder of an RGB-D sequence and opens it.
    OpenSequence,
    /// Opens a sample.
    OpenSample(usize),
    /// Asks for files of poses or profiles and shows the import's preview.
    Import,
    /// Asks for a folder of them.
    ImportFolder,
    /// Asks the system for the text on the clipboard and shows the preview of that.
    Paste,
    /// Asks for a session whose stations are to be added to the open one.
    AddSession,
    /// Asks for a session whose target the open one's calibration is to be verified on.
    AddFurther,
    /// Asks for the folder that a profiler's software saves profiles into.
    ChooseWatchedFolder,
    /// Starts the simulated cell and connects to it.
    Practise(Option<PartKind>),
    /// Ends it.
    EndPractice,
    /// Asks for a file and writes the poses as CSV.
    ExportPoses,
    /// Asks for a folder and writes the profiles as CSV.
    ExportProfiles,
    /// Asks for a file and writes the points of the scan on the bench.
    ExportPoints,
    /// Asks for a folder and writes the report.
    SaveReport,
    /// Asks for a file of points.
    OpenPoints,
    /// Asks for the file with the calibration that a scan is seen through.
    ChooseCalibration,
    /// Asks for the file of a side of a comparison: 0 the earlier, 1 the later.
    ChooseCompared(usize),
    /// Asks for a folder of results.
    ChooseResultFolder,
    /// Saves to the session's file, asking for one where there is none.
    Save,
    /// Asks for a file and saves there.
    SaveAs,
    /// Goes back to the start page.
    Close,
    /// Closes the window.
    Quit,
    /// Takes the last edit back.
    Undo,
    /// Brings back what was undone.
    Redo,
    /// Shows or hides the list of edits.
    History,
    /// Shows or hides the help window.
    Help,
    /// Goes to a step of the rail.
    GoTo(Step),
}

/// All actions with a shortcut. Those with more modifiers come first, as a shortcut also matches with fewer.
const WITH_SHORTCUT: [Action; 10] = [
    Action::SaveAs,
    Action::Redo,
    Action::Open,
    Action::Import,
    Action::Save,
    Action::Undo,
    Action::Close,
    Action::Quit,
    Action::History,
    Action::Help,
];

impl Action {
    /// Its shortcut, if it has one.
    #[must_use]
    pub const fn shortcut(self) -> Option<KeyboardShortcut> {
        let (modifiers, key) = match self {
            Self::Open => (Modifiers::COMMAND, Key::O),
            Self::Save => (Modifiers::COMMAND, Key::S),
            Self::SaveAs => (CTRL_SHIFT, Key::S),
            Self::Close => (Modifiers::COMMAND, Key::W),
            Self::Quit => (Modifiers::COMMAND, Key::Q),
            Self::Undo => (Modifiers::COMMAND, Key::Z),
            Self::Redo => (CTRL_SHIFT, Key::Z),
            Self::History => (Modifiers::COMMAND, Key::H),
            Self::Help => (Modifiers::NONE, Key::F1),
            Self::Import => (Modifiers::COMMAND, Key::I),
            // Pasting has a key too, but the system turns that into the text itself.
            Self::OpenSequence
            | Self::OpenSample(_)
            | Self::GoTo(_)
            | Self::ImportFolder
            | Self::Paste
            | Self::AddSession
            | Self::AddFurther
            | Self::ChooseWatchedFolder
            | Self::Practise(_)
            | Self::EndPractice
            | Self::ExportPoses
            | Self::ExportProfiles
            | Self::ExportPoints
            | Self::SaveReport
            | Self::OpenPoints
            | Self::ChooseCalibration
            | Self::ChooseCompared(_)
            | Self::ChooseResultFolder => return None,
        };
        Some(KeyboardShortcut::new(modifiers, key))
    }

    /// What menus and the help window call it.
    #[must_use]
    pub fn label(self, workbench: &Workbench) -> String {
        let history = workbench.document().map(|document| &document.history);
        match self {
            Self::Open => words::OPEN.to_owned(),
            Self::OpenSequence => sequence_words::OPEN_FOLDER.to_owned(),
            Self::OpenSample(_) => words::OPEN_SAMPLE.to_owned(),
            Self::Import => import_words::IMPORT.to_owned(),
            Self::ImportFolder => import_words::IMPORT_FOLDER.to_owned(),
            Self::Paste => import_words::PASTE.to_owned(),
            Self::AddSession => import_words::ADD_SESSION.to_owned(),
            Self::AddFurther => verify_words::ADD_TARGET.to_owned(),
            Self::ChooseWatchedFolder => capture_words::FOLDER_TITLE.to_owned(),
            Self::Practise(part) => capture_words::practise_on(part).to_owned(),
            Self::EndPractice => capture_words::END_PRACTICE.to_owned(),
            Self::ExportPoses => import_words::EXPORT_POSES.to_owned(),
            Self::ExportProfiles => import_words::EXPORT_PROFILES.to_owned(),
            Self::ExportPoints => workpiece_words::EXPORT_POINTS.to_owned(),
            Self::SaveReport => report_words::SAVE_REPORT.to_owned(),
            Self::OpenPoints => workpiece_words::OPEN_POINTS.to_owned(),
            Self::ChooseCalibration => workpiece_words::CHOOSE_CALIBRATION.to_owned(),
            Self::ChooseCompared(_) => compare_words::CHOOSE_SIDE_TITLE.to_owned(),
            Self::ChooseResultFolder => compare_words::CHOOSE_FOLDER_TITLE.to_owned(),
            Self::Save => words::SAVE.to_owned(),
            Self::SaveAs => words::SAVE_AS.to_owned(),
            Self::Close => words::CLOSE.to_owned(),
            Self::Quit => words::QUIT.to_owned(),
            Self::Undo => history
                .and_then(|history| history.undo_label())
                .map_or_else(|| words::UNDO.to_owned(), words::undo_label),
            Self::Redo => history
                .and_then(|history| history.redo_label())
                .map_or_else(|| words::REDO.to_owned(), words::redo_label),
            Self::History => document_words::HISTORY_ENTRY.to_owned(),
            Self::Help => words::SHORTCUTS_AND_ABOUT.to_owned(),
            Self::GoTo(step) => step.name().to_owned(),
        }
    }

    /// Whether it concerns what is being typed, which is taken over first.
    #[must_use]
    pub const fn takes_what_is_typed(self) -> bool {
        !matches!(self, Self::Help | Self::History | Self::GoTo(_))
    }

    /// Why it cannot be done now; `None` if it can.
    #[must_use]
    pub fn refusal(self, workbench: &Workbench) -> Option<&'static str> {
        let document = workbench.document();
        match self {
            Self::Save | Self::SaveAs | Self::Close | Self::History | Self::AddSession | Self::AddFurther => {
                document.is_none().then_some(words::NO_DOCUMENT)
            }
            Self::ExportPoses | Self::ExportProfiles => export_refusal(self, document),
            Self::SaveReport => workbench.report().last().is_none().then_some(report_words::NOTHING_TO_REPORT),
            Self::Undo => document
                .is_none_or(|document| document.history.undo_label().is_none())
                .then_some(words::NOTHING_TO_UNDO),
            Self::Redo => document
                .is_none_or(|document| document.history.redo_label().is_none())
                .then_some(words::NOTHING_TO_REDO),
            Self::Practise(_) => workbench.cell().is_practice.then_some(capture_words::PRACTICE),
            Self::EndPractice => (!workbench.cell().is_practice).then_some(capture_words::NO_PRACTICE),
            Self::Open
            | Self::OpenSequence
            | Self::OpenSample(_)
            | Self::Import
            | Self::ImportFolder
            | Self::Paste
            | Self::ChooseWatchedFolder
            | Self::ExportPoints
            | Self::OpenPoints
            | Self::ChooseCalibration
            | Self::ChooseCompared(_)
            | Self::ChooseResultFolder
            | Self::Quit
            | Self::Help
            | Self::GoTo(_) => None,
        }
    }
}

fn export_refusal(action: Action, document: Option<&Document>) -> Option<&'static str> {
    let Some(document) = document else { return Some(words::NO_DOCUMENT) };
    let stations = &document.session.stations;
    let is_profile = |capture: &Capture| matches!(capture.reading, Reading::Profile(_));
    if stations.is_empty() {
        return Some(import_words::NO_STATIONS);
    }
    let needs_profiles = action == Action::ExportProfiles;
    let lacks_profiles = || !stations.iter().any(|station| station.captures.iter().any(is_profile));
    (needs_profiles && lacks_profiles()).then_some(import_words::NO_PROFILES)
}

/// What other programs use for redo works as well.
pub const OTHER_REDO: KeyboardShortcut = KeyboardShortcut::new(Modifiers::COMMAND, Key::Y);

const CTRL_SHIFT: Modifiers = Modifiers::COMMAND.plus(Modifiers::SHIFT);

/// The actions whose keys were pressed in this frame.
#[must_use]
pub fn pressed(ctx: &egui::Context, workbench: &Workbench) -> Vec<Action> {
    // A text that is being typed has an undo of its own.
    let is_typing = ctx.text_edit_focused();
    let mut pressed: Vec<Action> = WITH_SHORTCUT
        .into_iter()
        .filter(|action| !(is_typing && matches!(action, Action::Undo | Action::Redo)))
        .filter(|action| {
            let other = (*action == Action::Redo).then_some(OTHER_REDO);
            let mut shortcuts = action.shortcut().into_iter().chain(other);
            ctx.input_mut(|input| shortcuts.any(|shortcut| input.consume_shortcut(&shortcut)))
        })
        .filter(|action| action.refusal(workbench).is_none())
        .collect();
    // Plain digits belong to a text field while it has the focus.
    if !ctx.egui_wants_keyboard_input() {
        let digits = [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5, Key::Num6, Key::Num7, Key::Num8];
        pressed.extend(Step::ALL.into_iter().zip(digits).filter_map(|(step, key)| {
            ctx.input_mut(|input| input.consume_key(Modifiers::NONE, key)).then_some(Action::GoTo(step))
        }));
    }
    pressed
}
