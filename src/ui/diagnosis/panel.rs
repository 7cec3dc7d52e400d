//! The panel: verdict, findings beside their evidence, validation, accuracy and the next poses.

use egui::{Key, Modifiers, ScrollArea, Sense, Ui, UiBuilder, vec2};

use crate::app::Command;
use crate::report::judgement::Judgement;
use crate::text::diagnosis_panel as words;
use crate::ui::verdict;
use crate::ui::{PanelContext, theme, widgets};

use super::model::{Shown, View};
use super::{accuracy, findings, plan, plots, validation};

/// From this width on, points, the cards stand beside each other.
const SIDE_BY_SIDE_FROM: f32 = 840.0;
/// Least heights of the rows of cards, points; where the window is higher, they share what is left.
const ROW_HEIGHTS: [f32; 3] = [272.0, 204.0, 226.0];
/// Heights of the cards where they stand above each other: findings, evidence, influence, halves and normality,
/// accuracy, next poses.
const STACKED_HEIGHTS: [f32; 6] = [280.0, 280.0, 220.0, 220.0, 232.0, 240.0];

/// What the panel remembers between frames.
#[derive(Debug)]
pub struct DiagnosisState {
    pub(super) shown: Shown,
    pub(super) shows_moves: bool,
    /// Whether the views of evidence, influence, halves and normality are fitted to their data.
    pub(super) is_fitted: [bool; 4],
    pub(super) list_from_top: widgets::FromTop,
    /// A finding chosen with the keys is to be brought into view.
    pub(super) reveals_shown: bool,
    seen_revision: Option<u64>,
    is_explained: bool,
    from_top: widgets::FromTop,
}

impl Default for DiagnosisState {
    fn default() -> Self {
        Self {
            shown: Shown::Finding(0),
            shows_moves: false,
            is_fitted: [true; 4],
            list_from_top: widgets::FromTop::default(),
            reveals_shown: false,
            seen_revision: None,
            is_explained: false,
            from_top: widgets::FromTop::default(),
        }
    }
}

impl DiagnosisState {
    /// Shows the evidence for something else.
    pub(super) const fn select(&mut self, shown: Shown) {
        self.shown = shown;
        self.is_fitted = [true; 4];
    }

    /// A new diagnosis begins with what it found first; readings that were asked for stay.
    fn follow(&mut self, view: &View<'_>) {
        if self.seen_revision != view.diagnosis.revision {
            self.seen_revision = view.diagnosis.revision;
            let keeps_readings = self.shown == Shown::Readings && view.readings.is_current;
            self.select(if keeps_readings { Shown::Readings } else { Shown::Finding(0) });
        }
    }
}

/// Shows the panel.
pub fn show(ui: &mut Ui, context: &mut PanelContext<'_>, state: &mut DiagnosisState) {
    let workbench = context.workbench;
    if workbench.document().is_none() {
        widgets::nothing(ui, words::NO_SESSION);
        return;
    }
    let Some(view) = View::of(workbench) else {
        let is_solving = workbench.solve_progress().is_some();
        widgets::nothing(ui, if is_solving { words::SOLVING } else { words::CANCELLED });
        return;
    };
    if let Some(refusal) = workbench.results().and_then(|results| results.refusal.as_deref()) {
        widgets::nothing(ui, refusal);
        return;
    }
    show_view(ui, &view, context, state);
}

/// The same for anything that can be drawn, whatever it was taken from.
pub fn show_view(ui: &mut Ui, view: &View<'_>, context: &mut PanelContext<'_>, state: &mut DiagnosisState) {
    state.follow(view);
    take_keys(ui, view, context, state);
    let height = ui.available_height();
    // The scroll bar gets the panel's margin, so that it covers no numbers.
    let area = ui.available_rect_before_wrap();
    let mut page = ui.new_child(UiBuilder::new().max_rect(area.with_max_x(area.right() + theme::GAP - 2.0)));
    let scroll_area = state.from_top.apply(ScrollArea::vertical().id_salt("diagnosis").auto_shrink([false, false]));
    scroll_area.show(&mut page, |ui| {
        ui.set_max_width(area.width());
        ui.spacing_mut().item_spacing.y = theme::GAP;
        let top = ui.cursor().top();
        let current = view.diagnosis.value.filter(|_| view.diagnosis.is_current);
        let band = Judgement::new(view.session, view.results, current);
        let is_explained = &mut state.is_explained;
        verdict::show(ui, band.as_ref(), None, None, !view.results_are_current, is_explained, context);
        if view.is_out_of_date() {
            ui.set_opacity(0.6);
        }
        if ui.available_width() >= SIDE_BY_SIDE_FROM {
            let left_over = height - (ui.cursor().top() - top);
            side_by_side(ui, left_over, view, context, state);
        } else {
            stacked(ui, view, context, state);
        }
    });
    ui.advance_cursor_after_rect(area);
}

fn side_by_side(ui: &mut Ui, height: f32, view: &View<'_>, context: &mut PanelContext<'_>, state: &mut DiagnosisState) {
    let least: f32 = ROW_HEIGHTS.iter().sum();
    // Three rows have two gaps between them.
    let share = ((height - 2.0 * theme::GAP) / least).max(1.0);
    let [top, middle, bottom] = ROW_HEIGHTS.map(|least| (least * share).floor());
    let [mut left, mut right] = row(ui, top, [0.40, 0.60]);
    findings::show(&mut left, top, view, context, state);
    plots::evidence(&mut right, top, view, context, state);
    let [mut left, mut centre, mut right] = row(ui, middle, [0.40, 0.30, 0.30]);
    validation::influence(&mut left, middle, view, context.selection, state);
    validation::halves(&mut centre, middle, view, &mut state.is_fitted[2]);
    validation::normality(&mut right, middle, view, &mut state.is_fitted[3]);
    let [mut left, mut right] = row(ui, bottom, [0.40, 0.60]);
    accuracy::show(&mut left, bottom, view, context.commands);
    plan::show(&mut right, bottom, view, context.commands);
}

fn stacked(ui: &mut Ui, view: &View<'_>, context: &mut PanelContext<'_>, state: &mut DiagnosisState) {
    let [list, evidence, influence, distributions, accuracy_height, poses] = STACKED_HEIGHTS;
    findings::show(ui, list, view, context, state);
    plots::evidence(ui, evidence, view, context, state);
    plan::show(ui, poses, view, context.commands);
    accuracy::show(ui, accuracy_height, view, context.commands);
    validation::influence(ui, influence, view, context.selection, state);
    let [mut left, mut right] = row(ui, distributions, [0.5, 0.5]);
    validation::halves(&mut left, distributions, view, &mut state.is_fitted[2]);
    validation::normality(&mut right, distributions, view, &mut state.is_fitted[3]);
}

/// Places beside each other, as wide as their parts say. Each part is that of a place with its gap, so that the edges of
/// rows with different numbers of places line up.
fn row<const N: usize>(ui: &mut Ui, height: f32, parts: [f32; N]) -> [Ui; N] {
    let (area, _) = ui.allocate_exact_size(vec2(ui.available_width(), height), Sense::hover());
    let whole = area.width() + theme::GAP;
    let mut left = area.left();
    parts.map(|part| {
        let place = area.with_min_x(left).with_max_x((left + whole * part - theme::GAP).round());
        left = place.right() + theme::GAP;
        ui.new_child(UiBuilder::new().max_rect(place))
    })
}

/// Up and down choose a finding, Enter mends it, Esc stops the bootstrap.
fn take_keys(ui: &Ui, view: &View<'_>, context: &mut PanelContext<'_>, state: &mut DiagnosisState) {
    let pressed = |key| ui.input_mut(|input| input.consume_key(Modifiers::NONE, key));
    if view.bootstrap.progress.is_some() && pressed(Key::Escape) {
        context.commands.push(Command::CancelBootstrap);
    }
    // A field that is being typed into keeps its keys.
    if ui.ctx().text_edit_focused() || view.findings().is_empty() {
        return;
    }
    let last_idx = view.findings().len() - 1;
    let moved_to = match (state.shown, pressed(Key::ArrowUp), pressed(Key::ArrowDown)) {
        (Shown::Finding(idx), true, false) => Some(idx.saturating_sub(1)),
        (Shown::Finding(idx), false, true) => Some((idx + 1).min(last_idx)),
        (Shown::Readings, true, false) => Some(last_idx),
        (Shown::Readings, false, true) => Some(0),
        _ => None,
    };
    if let Some(idx) = moved_to {
        state.select(Shown::Finding(idx));
        state.reveals_shown = true;
    }
    // A control with the focus takes Enter for itself.
    let is_free = ui.memory(|memory| memory.focused().is_none());
    if let Shown::Finding(idx) = state.shown
        && let Some(remedy) = view.remedy(idx)
        && is_free
        && pressed(Key::Enter)
    {
        context.commands.push(Command::ApplyRemedy(remedy.clone()));
    }
}
