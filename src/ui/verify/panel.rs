//! The panel: its sections, and what each of them shows.

use egui::{Align2, FontId, Rect, Role, ScrollArea, Sense, Stroke, Ui, WidgetInfo, pos2, vec2};

use crate::app::{Workbench, study::Study};
use crate::text::verify as words;
use crate::ui::{PanelContext, theme, widgets};
use crate::verify::Verification;

use super::marks::Mark;
use super::{cross_target, distances, stability, workpiece};

/// Height of the row of tabs, points: large enough for a gloved hand.
const TABS_HEIGHT: f32 = 38.0;
/// Room at either side of a tab's name, points.
const TAB_MARGIN: f32 = 14.0;
/// The same in a narrow window.
const LEAST_TAB_MARGIN: f32 = 4.0;
/// The accent below the tab in sight, points.
const UNDERLINE: f32 = 2.5;

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

    const fn hint(self) -> &'static str {
        match self {
            Self::Distances => words::DISTANCES_HINT,
            Self::Stability => words::STABILITY_HINT,
            Self::CrossTarget => words::CROSS_TARGET_HINT,
            Self::Workpiece => words::WORKPIECE_HINT,
        }
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
}

/// The verification to be shown, with the marks of its calibrations.
pub(super) struct View<'a> {
    pub verification: &'a Verification,
    pub marks: Vec<Mark>,
}

/// Shows the panel.
pub fn show(ui: &mut Ui, context: &mut PanelContext<'_>, state: &mut VerifyState) {
    let workbench = context.workbench;
    if workbench.document().is_none() {
        widgets::nothing(ui, words::NO_SESSION);
        return;
    }
    let section = state.section.unwrap_or_else(|| first_of_use(workbench));
    if let Some(chosen) = tabs(ui, section, workbench) {
        state.section = Some(chosen);
    }
    ui.add_space(theme::GAP);
    ScrollArea::vertical().id_salt(section.name()).auto_shrink([false, false]).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = theme::GAP;
        if section == Section::Workpiece {
            workpiece::show(ui, context, &mut state.workpiece);
            return;
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
            Section::Workpiece => {}
        }
    });
}

/// Names a text field for screen readers.
pub(super) fn name_field(field: &egui::Response, name: &str, text: &str) {
    field.widget_info(|| {
        let mut info = WidgetInfo::text_edit(true, "", text, "");
        info.label = Some(name.to_owned());
        info
    });
}

/// A plate has distances, a ball or tip is measured many times, a workpiece is scanned.
fn first_of_use(workbench: &Workbench) -> Section {
    use crate::session::Target;
    match workbench.document().map(|document| &document.session.target) {
        Some(Target::Workpiece) => Section::Workpiece,
        Some(Target::Ball { .. } | Target::Point) => Section::Stability,
        _ => Section::Distances,
    }
}

/// The tabs, and at their right how the verification stands. Answers the one that was clicked.
fn tabs(ui: &mut Ui, current: Section, workbench: &Workbench) -> Option<Section> {
    let palette = theme::palette(ui);
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), TABS_HEIGHT), Sense::hover());
    ui.painter().hline(rect.x_range(), rect.bottom() - 0.5, Stroke::new(1.0, palette.hairline));
    let mut chosen = None;
    let mut left = rect.left();
    let width_of =
        |name: &str| ui.painter().layout_no_wrap(name.to_owned(), theme::strong_font(), palette.accent).size().x;
    let names: f32 = Section::ALL.iter().map(|section| width_of(section.name())).sum();
    #[expect(clippy::cast_precision_loss, reason = "a handful of tabs")]
    let margin = ((rect.width() - names) / (2.0 * Section::ALL.len() as f32)).clamp(LEAST_TAB_MARGIN, TAB_MARGIN);
    for section in Section::ALL {
        let is_current = section == current;
        // As wide as in the heavier weight, so that nothing moves when another tab is chosen.
        let name = section.name().to_owned();
        let strong = ui.painter().layout_no_wrap(name.clone(), theme::strong_font(), palette.accent);
        let tab =
            Rect::from_min_max(pos2(left, rect.top()), pos2(left + strong.size().x + 2.0 * margin, rect.bottom()));
        left = tab.right();
        let response = ui.interact(tab, ui.scope_id().with(section.name()), Sense::click());
        response.widget_info(|| WidgetInfo::selected(Role::Tab, true, is_current, section.name()));
        let is_pointed_at = response.hovered() || response.has_focus();
        if is_pointed_at && !is_current {
            ui.painter().rect_filled(tab.shrink2(vec2(2.0, 4.0)), theme::RADIUS, palette.hovered);
        }
        let middle = tab.center();
        if is_current {
            ui.painter().galley(middle - strong.size() / 2.0, strong, palette.accent);
            let underline = tab.with_min_y(tab.bottom() - UNDERLINE).shrink2(vec2(margin - LEAST_TAB_MARGIN, 0.0));
            ui.painter().rect_filled(underline, 1.0, palette.accent);
        } else {
            let font = FontId::proportional(theme::BODY_SIZE);
            ui.painter().text(middle, Align2::CENTER_CENTER, name, font, palette.text_dim);
        }
        if response.on_hover_text(section.hint()).clicked() {
            chosen = Some(section);
        }
    }
    let (state, color) = state_of(workbench.verification(), workbench);
    if !state.is_empty() {
        let font = FontId::proportional(theme::SMALL_SIZE);
        let color = if color { palette.warn } else { palette.text_dim };
        ui.painter().text(rect.right_center() - vec2(4.0, 0.0), Align2::RIGHT_CENTER, state, font, color);
    }
    chosen
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
