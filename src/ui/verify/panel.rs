//! The panel: its sections, and what each of them shows.

use std::path::Path;

use egui::{ScrollArea, Ui};

use crate::app::{Workbench, study::Study};
use crate::text::compare_results as result_words;
use crate::text::verify as words;
use crate::ui::{PanelContext, theme, widgets};
use crate::verify::Verification;

use super::marks::Mark;
use super::{compare_results, cross_target, distances, result_history, stability, workpiece};

/// A kind of evidence.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Section {
    /// Distances of a plate's points to the fitted lines and plane (Chen et al. 2023, Figs. 3 and 4).
    #[default]
    Distances,
    /// A known point measured many times (their Table 3), and the matrices side by side (Table 2).
    Stability,
    /// The calibration on other targets' data.
    CrossTarget,
    /// A scanned part (Figs. 6 to 8).
    Workpiece,
    /// Two calibrations from files, or the session against one.
    CompareResults,
    /// The calibrations of a folder over time.
    ResultHistory,
}

impl Section {
    /// All sections in the order in which they are shown.
    pub const ALL: [Self; 6] = [
        Self::Distances,
        Self::Stability,
        Self::CrossTarget,
        Self::Workpiece,
        Self::CompareResults,
        Self::ResultHistory,
    ];

    /// Its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Distances => words::DISTANCES,
            Self::Stability => words::STABILITY,
            Self::CrossTarget => words::CROSS_TARGET,
            Self::Workpiece => words::WORKPIECE,
            Self::CompareResults => result_words::COMPARE,
            Self::ResultHistory => result_words::HISTORY,
        }
    }

    const fn hint(self) -> &'static str {
        match self {
            Self::Distances => words::DISTANCES_HINT,
            Self::Stability => words::STABILITY_HINT,
            Self::CrossTarget => words::CROSS_TARGET_HINT,
            Self::Workpiece => words::WORKPIECE_HINT,
            Self::CompareResults => result_words::COMPARE_HINT,
            Self::ResultHistory => result_words::HISTORY_HINT,
        }
    }

    /// Whether it needs no session: it reads files.
    const fn is_of_files(self) -> bool {
        matches!(self, Self::CompareResults | Self::ResultHistory)
    }
}

/// What the panel remembers between frames.
#[derive(Debug, Default)]
pub struct VerifyState {
    /// The section in sight; until one is chosen, the first that has something to show.
    section: Option<Section>,
    pub(super) distances: distances::DistancesState,
    pub(super) stability: stability::StabilityState,
    pub(super) cross_target: cross_target::CrossTargetState,
    pub(super) workpiece: workpiece::WorkpieceState,
    compare_results: compare_results::CompareResultsState,
    result_history: result_history::ResultHistoryState,
}

impl VerifyState {
    /// Goes to a section.
    pub const fn go_to(&mut self, section: Section) {
        self.section = Some(section);
    }

    /// Takes the file that was chosen for a side of the comparison: 0 the earlier, 1 the later.
    pub fn take_compared(&mut self, side: usize, path: &Path) {
        self.compare_results.take_path(side, path);
    }

    /// Takes the folder of results that was chosen.
    pub fn take_result_folder(&mut self, folder: &Path) {
        self.result_history.take_folder(folder);
    }
}

/// The verification to be shown, with the marks of its calibrations.
pub(super) struct View<'a> {
    pub verification: &'a Verification,
    pub marks: Vec<Mark>,
}

/// Shows the panel.
pub fn show(ui: &mut Ui, context: &mut PanelContext<'_>, state: &mut VerifyState) {
    let workbench = context.workbench;
    let section = state.section.unwrap_or_else(|| first_of_use(workbench));
    let names = Section::ALL.map(|section| (section.name(), section.hint()));
    let current_idx = Section::ALL.iter().position(|known| *known == section).unwrap_or(0);
    let (note, is_warning) = state_of(workbench.verification(), workbench);
    if let Some(chosen_idx) = widgets::tabs(ui, &names, current_idx, &note, is_warning) {
        state.section = Some(Section::ALL[chosen_idx]);
    }
    ui.add_space(theme::GAP);
    if workbench.document().is_none() && !section.is_of_files() {
        widgets::nothing(ui, words::NO_SESSION);
        return;
    }
    ScrollArea::vertical().id_salt(section.name()).auto_shrink([false, false]).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = theme::GAP;
        match section {
            Section::Workpiece => return workpiece::show(ui, context, &mut state.workpiece),
            Section::CompareResults => return compare_results::show(ui, context, &mut state.compare_results),
            Section::ResultHistory => return result_history::show(ui, context, &mut state.result_history),
            Section::Distances | Section::Stability | Section::CrossTarget => {}
        }
        let Some(found) = workbench.verification().last() else {
            let is_under_way = workbench.verification().is_running() || workbench.solve_progress().is_some();
            widgets::nothing(ui, if is_under_way { words::VERIFYING } else { words::NOT_VERIFIED });
            return;
        };
        if !workbench.is_current(found.revision) {
            ui.set_opacity(0.6);
        }
        let view = View { verification: &found.value, marks: Mark::all(&found.value) };
        match section {
            Section::Distances => distances::show(ui, &view, context, &mut state.distances),
            Section::Stability => stability::show(ui, &view, context, &mut state.stability),
            Section::CrossTarget => cross_target::show(ui, &view, context, &mut state.cross_target),
            Section::Workpiece | Section::CompareResults | Section::ResultHistory => {}
        }
    });
}

/// A plate has distances, a ball or tip is measured many times, a workpiece is scanned.
fn first_of_use(workbench: &Workbench) -> Section {
    use crate::session::Target;
    match workbench.document().map(|document| &document.session.target) {
        Some(Target::Workpiece) => Section::Workpiece,
        Some(Target::Ball { .. } | Target::Point) => Section::Stability,
        None => Section::CompareResults,
        _ => Section::Distances,
    }
}

/// What is said beside the tabs, and whether it is a warning.
fn state_of(study: &Study<Verification>, workbench: &Workbench) -> (String, bool) {
    if let Some(progress) = study.progress() {
        return (words::progress(progress.done, progress.total), false);
    }
    if workbench.is_adding_further() {
        return (words::ADDING.to_owned(), false);
    }
    let is_old = study.last().is_some_and(|found| !workbench.is_current(found.revision));
    (if is_old { words::OUT_OF_DATE.to_owned() } else { String::new() }, is_old)
}
