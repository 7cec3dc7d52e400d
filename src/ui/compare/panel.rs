//! The comparison: verdict, toggles, one card a method, plots, differences.

use std::rc::Rc;

use egui::{Align, Button, Layout, ScrollArea, Ui, UiBuilder, vec2};

use crate::app::{Document, Results};
use crate::calibrate::{Method, solution_of};
use crate::report::comparison::{COLUMN_ORDER, Column, Comparison, ErrorReference, MethodTable};
use crate::report::judgement::Judgement;
use crate::session::Target;
use crate::text::compare as text;
use crate::text::methods::{method_description, method_short_name};
use crate::ui::save_picture::saveable;
use crate::ui::verdict::{self, NextStep};
use crate::ui::{PanelContext, theme, widgets};

use super::bars::{self, BarSource};
use super::cards::{self, CardOptions};
use super::scatter::{self, ScatterView};
use super::{closed_forms, differences, published, table};

/// A card narrower than this clips its numbers, points.
const MIN_CARD_WIDTH: f32 = 440.0;
/// The same in the layout of the paper's tables.
const MIN_PAPER_CARD_WIDTH: f32 = 560.0;
/// Below this width the plots stand above each other.
const PLOTS_SIDE_BY_SIDE_FROM: f32 = 720.0;
/// Least height of a plot's card.
const MIN_PLOT_HEIGHT: f32 = 212.0;
/// Greatest height of a plot's card.
const MAX_PLOT_HEIGHT: f32 = 380.0;
/// Room kept below the plots for the difference table.
const DIFFERENCE_HEIGHT: f32 = 150.0;

/// What the panel remembers between frames.
#[derive(Debug, Default)]
pub struct CompareState {
    /// The user's choice of methods; without one, as many as fit side by side.
    shown: Option<Vec<Method>>,
    reference: ErrorReference,
    has_paper_layout: bool,
    has_matrices: bool,
    is_explained: bool,
    bar_source: BarSource,
    scatter: ScatterView,
    model: Option<((u64, u64), Rc<Comparison>)>,
    from_top: widgets::FromTop,
}

impl CompareState {
    fn model(&mut self, document: &Document, results: &Results) -> Rc<Comparison> {
        let revisions = (document.revision, results.revision);
        match &self.model {
            Some((known, model)) if *known == revisions => Rc::clone(model),
            _ => {
                let model = Rc::new(Comparison::new(&document.session, &results.methods));
                self.model = Some((revisions, Rc::clone(&model)));
                model
            }
        }
    }

    /// The paper's two methods; the bundle as well where three cards have room beside each other, or where one of
    /// the two has no table to show.
    fn shown(&self, model: &Comparison, width: f32) -> Vec<Method> {
        self.shown.clone().unwrap_or_else(|| {
            let has_failed = model.columns.iter().take(2).any(|column| column.outcome.is_err());
            let count = if has_failed || cards_a_row(width, MIN_CARD_WIDTH) >= 3 { 3 } else { 2 };
            model.columns.iter().take(count).map(|column| column.method).collect()
        })
    }
}

fn cards_a_row(width: f32, card_width: f32) -> usize {
    let mut count = 1;
    let mut used = card_width;
    while used + theme::GAP + card_width <= width && count < COLUMN_ORDER.len() {
        used += theme::GAP + card_width;
        count += 1;
    }
    count
}

/// Shows the panel.
pub fn show(ui: &mut Ui, context: &mut PanelContext<'_>, state: &mut CompareState) {
    let workbench = context.workbench;
    let Some(document) = workbench.document() else {
        widgets::nothing(ui, text::NO_SESSION);
        return;
    };
    let Some(results) = workbench.results() else {
        widgets::nothing(ui, if workbench.solve_progress().is_some() { text::SOLVING } else { text::CANCELLED });
        return;
    };
    if let Some(refusal) = &results.refusal {
        widgets::nothing(ui, refusal);
        return;
    }
    let model = state.model(document, results);
    let is_out_of_date = !workbench.results_are_current();
    let height = ui.available_height();
    // The scroll bar gets the panel's margin, so that it covers no numbers.
    let area = ui.available_rect_before_wrap();
    let mut page = ui.new_child(UiBuilder::new().max_rect(area.with_max_x(area.right() + theme::GAP - 2.0)));
    let scroll_area = state.from_top.apply(ScrollArea::vertical().id_salt("compare").auto_shrink([false, false]));
    scroll_area.show(&mut page, |ui| {
        ui.set_max_width(area.width());
        let top = ui.cursor().top();
        ui.spacing_mut().item_spacing.y = theme::GAP;
        // The diagnosis follows the results; until it is there, or once it is out of date, the figures speak alone.
        let diagnosis = workbench.current_diagnosis();
        let plan = workbench.current_plan();
        let band = Judgement::new(&document.session, &results.methods, diagnosis);
        let next = NextStep::new(&document.session, diagnosis, plan);
        let improvement = model.improvement.as_ref();
        let is_explained = &mut state.is_explained;
        verdict::show(ui, band.as_ref(), improvement, next.as_ref(), is_out_of_date, is_explained, context);
        if let Some(motion) =
            solution_of(&results.methods, Method::Motion).and_then(|solution| solution.motion.as_ref())
        {
            closed_forms::show(ui, &motion.closed_forms);
        }
        let width = ui.available_width();
        let shown = state.shown(&model, width);
        toggles(ui, &model, &shown, state);
        if is_out_of_date {
            ui.set_opacity(0.6);
        }
        method_cards(ui, &model, &shown, context, state);
        if let Some(printed) = &model.published {
            published::show(ui, printed);
        }
        let tables: Vec<(Method, &MethodTable)> = model
            .columns
            .iter()
            .filter(|column| shown.contains(&column.method))
            .filter_map(|column| Some((column.method, column.outcome.as_ref().ok()?)))
            .collect();
        if !tables.is_empty() {
            let left_over = height - (ui.cursor().top() - top) - DIFFERENCE_HEIGHT;
            plots(ui, &model.target, &tables, left_over.clamp(MIN_PLOT_HEIGHT, MAX_PLOT_HEIGHT), state);
            // With one method for the target there is nothing to set it against.
            if model.columns.len() > 1 {
                differences::show(ui, &model.differences, shown.contains(&Method::BallMaxArcStep));
            }
        }
    });
    ui.advance_cursor_after_rect(area);
}

/// The paper's tables list poses of stations, and a way has none.
fn has_paper_layout(model: &Comparison) -> bool {
    !matches!(model.target, Target::Rgbd { .. })
}

fn toggles(ui: &mut Ui, model: &Comparison, shown: &[Method], state: &mut CompareState) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(5.0, 6.0);
        ui.spacing_mut().button_padding.x = 6.0;
        for column in &model.columns {
            let method = column.method;
            let is_shown = shown.contains(&method);
            let name = format!("{} {}", theme::method_symbol(method), method_short_name(method));
            let button = ui.add(Button::new(name).selected(is_shown)).on_hover_text(method_description(method));
            button.widget_info(|| {
                let name = text::show_method(method_short_name(method));
                egui::WidgetInfo::selected(egui::Role::Button, true, is_shown, name)
            });
            if button.clicked() {
                let chosen = |other: Method| if other == method { !is_shown } else { shown.contains(&other) };
                state.shown = Some(COLUMN_ORDER.into_iter().filter(|method| chosen(*method)).collect());
            }
        }
        // Errors at a plate are distances from its edges, relative to nothing else.
        if model.target != Target::RightAnglePlate {
            ui.add_space(2.0);
            ui.selectable_value(&mut state.reference, ErrorReference::FirstStation, text::FROM_FIRST)
                .on_hover_text(text::FROM_FIRST_HINT);
            ui.selectable_value(&mut state.reference, ErrorReference::Mean, text::ABOUT_MEAN)
                .on_hover_text(text::ABOUT_MEAN_HINT);
        }
        ui.add_space(2.0);
        if has_paper_layout(model) {
            ui.toggle_value(&mut state.has_paper_layout, text::PAPER_LAYOUT);
        }
        ui.toggle_value(&mut state.has_matrices, text::MATRICES);
        ui.add_space(2.0);
        table::tint_legend(ui);
    });
}

fn method_cards(
    ui: &mut Ui,
    model: &Comparison,
    shown: &[Method],
    context: &mut PanelContext<'_>,
    state: &CompareState,
) {
    // Tables stand beside each other; a card with nothing but a reason needs little room, below them.
    let (tables, refusals): (Vec<&Column>, Vec<&Column>) =
        model.columns.iter().filter(|column| shown.contains(&column.method)).partition(|column| column.outcome.is_ok());
    let options = CardOptions {
        reference: state.reference,
        has_paper_layout: state.has_paper_layout && has_paper_layout(model),
        has_matrix: state.has_matrices,
    };
    let width = ui.available_width();
    let min_width = if options.has_paper_layout { MIN_PAPER_CARD_WIDTH } else { MIN_CARD_WIDTH };
    for (columns, most) in
        [(tables, cards_a_row(width, min_width)), (refusals, cards_a_row(width, MIN_CARD_WIDTH).min(2))]
    {
        rows_of_cards(ui, &columns, most, options, context);
    }
}

fn rows_of_cards(
    ui: &mut Ui,
    columns: &[&Column],
    most_a_row: usize,
    options: CardOptions,
    context: &mut PanelContext<'_>,
) {
    let per_row = most_a_row.min(columns.len()).max(1);
    #[expect(clippy::cast_precision_loss, reason = "at most four cards")]
    let card_width = (ui.available_width() - theme::GAP * (per_row - 1) as f32) / per_row as f32;
    for row in columns.chunks(per_row) {
        ui.horizontal_top(|ui| {
            ui.spacing_mut().item_spacing.x = theme::GAP;
            for column in row {
                ui.allocate_ui_with_layout(vec2(card_width, 0.0), Layout::top_down(Align::Min), |ui| {
                    ui.set_width(card_width);
                    cards::show(ui, column, options, context.selection, context.commands);
                });
            }
        });
    }
}

fn plots(ui: &mut Ui, target: &Target, tables: &[(Method, &MethodTable)], height: f32, state: &mut CompareState) {
    let width = ui.available_width();
    if width < PLOTS_SIDE_BY_SIDE_FROM {
        bars_card(ui, target, tables, height, state);
        scatter_card(ui, target, tables, height, &mut state.scatter);
        return;
    }
    let area = egui::Rect::from_min_size(ui.cursor().min, vec2(width, height));
    let (left, right) = area.split_left_right_at_x(area.left() + ((width - theme::GAP) * 0.455).round());
    bars_card(&mut ui.new_child(UiBuilder::new().max_rect(left)), target, tables, height, state);
    let right = right.with_min_x(right.left() + theme::GAP);
    scatter_card(&mut ui.new_child(UiBuilder::new().max_rect(right)), target, tables, height, &mut state.scatter);
    ui.allocate_rect(area, egui::Sense::hover());
}

fn bars_card(ui: &mut Ui, target: &Target, tables: &[(Method, &MethodTable)], height: f32, state: &mut CompareState) {
    let has_left_out = tables.iter().any(|(_, table)| table.leave_one_out_rms_mm.is_some());
    let source = if has_left_out { state.bar_source } else { BarSource::InSample };
    let reference = state.reference;
    let right = |ui: &mut Ui| {
        ui.spacing_mut().interact_size.y = 22.0;
        ui.spacing_mut().button_padding = vec2(8.0, 2.0);
        ui.spacing_mut().item_spacing.x = 4.0;
        let choose = |ui: &mut Ui, choice: BarSource, is_possible: bool, name: &str, hint: &str| {
            let button = Button::selectable(source == choice, name);
            ui.add_enabled(is_possible, button).on_hover_text(hint).clicked()
        };
        if choose(ui, BarSource::InSample, true, text::BARS_IN_SAMPLE, text::BARS_IN_SAMPLE_HINT) {
            state.bar_source = BarSource::InSample;
        }
        if choose(ui, BarSource::LeftOut, has_left_out, text::BARS_LEFT_OUT, text::BARS_LEFT_OUT_HINT) {
            state.bar_source = BarSource::LeftOut;
        }
    };
    let title = text::error_per_station(target);
    widgets::card_with_height(ui, title, height, right, |ui| {
        saveable(ui, title, |ui| bars::show(ui, tables, source, reference));
    });
}

fn scatter_card(ui: &mut Ui, target: &Target, tables: &[(Method, &MethodTable)], height: f32, view: &mut ScatterView) {
    let right = |ui: &mut Ui| {
        ui.label(theme::dim(ui, text::scatter_hint(target)));
    };
    let title = text::scatter_title(target);
    widgets::card_with_height(ui, title, height, right, |ui| {
        saveable(ui, title, |ui| scatter::show(ui, tables, view));
    });
}
