//! The panel: its sections, and what each of them shows.

use egui::{ScrollArea, Ui};

use crate::text::verify as words;
use crate::ui::{PanelContext, theme, widgets};

use super::{cross_target, distances, stability, workpiece};

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
}

impl Section {
    /// All sections in the order in which they are shown.
    pub const ALL: [Self; 4] = [Self::Distances, Self::Stability, Self::CrossTarget, Self::Workpiece];

    /// Its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Distances => words::DISTANCES,
            Self::Stability => words::STABILITY,
            Self::CrossTarget => words::CROSS_TARGET,
            Self::Workpiece => words::WORKPIECE,
        }
    }
}

/// What the panel remembers between frames.
#[derive(Debug, Default)]
pub struct VerifyState {
    section: Section,
    pub(super) distances: distances::DistancesState,
    pub(super) stability: stability::StabilityState,
    pub(super) cross_target: cross_target::CrossTargetState,
    pub(super) workpiece: workpiece::WorkpieceState,
}

/// Shows the panel.
pub fn show(ui: &mut Ui, context: &mut PanelContext<'_>, state: &mut VerifyState) {
    if context.workbench.document().is_none() {
        widgets::nothing(ui, words::NO_SESSION);
        return;
    }
    ui.horizontal(|ui| {
        for section in Section::ALL {
            ui.selectable_value(&mut state.section, section, section.name());
        }
    });
    ui.add_space(theme::GAP);
    ScrollArea::vertical().id_salt(state.section.name()).auto_shrink([false, false]).show(ui, |ui| {
        match state.section {
            Section::Distances => distances::show(ui, context, &mut state.distances),
            Section::Stability => stability::show(ui, context, &mut state.stability),
            Section::CrossTarget => cross_target::show(ui, context, &mut state.cross_target),
            Section::Workpiece => workpiece::show(ui, context, &mut state.workpiece),
        }
    });
}
