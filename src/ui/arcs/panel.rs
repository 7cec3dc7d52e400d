//! The arcs panel: list at the left, profile and curve side by side, one sentence below.

use std::collections::BTreeSet;
use std::rc::Rc;

use egui::{Frame, Key, Margin, Modifiers, ScrollArea, Ui, UiBuilder};

use crate::app::{Document, Results};
use crate::calibrate::Sweep;
use crate::fit::CircleMethod;
use crate::report::figure::model::{Curve, Found, ball_radius_mm, sweep_of};
use crate::session::Target;
use crate::text::arcs as text;
use crate::text::edges::feature_name;
use crate::text::typeset::std_text;
use crate::ui::save_picture::saveable;
use crate::ui::{PanelContext, Selection, import, theme, widgets};

use super::list::Columns;
use super::model::{self, CaptureView, StationRow};
use super::{curve, list, profile, scan, spread, strip};

/// Width of the list, points.
const LIST_WIDTH: f32 = 184.0;
/// Below this width of the plots they stand above each other.
const SIDE_BY_SIDE_FROM: f32 = 560.0;
/// Height of each card when they stand above each other.
const STACKED_HEIGHT: f32 = 420.0;
/// Height of the strip below the plots: two lines of text.
const BOTTOM_HEIGHT: f32 = 62.0;

/// Revisions that a cached model was made from.
type Revisions = (u64, Option<u64>);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct ViewKey {
    revisions: Revisions,
    station_idx: usize,
    capture_idx: usize,
    fit: CircleMethod,
}

/// What the panel remembers between frames.
#[derive(Debug)]
pub struct ArcsState {
    fit: CircleMethod,
    expanded: BTreeSet<usize>,
    rows: Option<(Revisions, Rc<Vec<StationRow>>)>,
    view: Option<(ViewKey, Rc<CaptureView>)>,
    fitted_station: Option<(u64, usize)>,
    is_profile_fitted: bool,
    is_curve_fitted: bool,
    hovered_capture: Option<usize>,
    shows_whole_profile: bool,
    list_from_top: widgets::FromTop,
    plots_from_top: widgets::FromTop,
}

impl Default for ArcsState {
    fn default() -> Self {
        Self {
            fit: CircleMethod::Robust,
            expanded: BTreeSet::new(),
            rows: None,
            view: None,
            fitted_station: None,
            is_profile_fitted: true,
            is_curve_fitted: true,
            hovered_capture: None,
            shows_whole_profile: false,
            list_from_top: widgets::FromTop::default(),
            plots_from_top: widgets::FromTop::default(),
        }
    }
}

impl ArcsState {
    fn rows(&mut self, document: &Document, results: Option<&Results>) -> Rc<Vec<StationRow>> {
        let revisions = (document.revision, results.map(|results| results.revision));
        match &self.rows {
            Some((known, rows)) if *known == revisions => Rc::clone(rows),
            _ => {
                let rows = Rc::new(model::station_rows(&document.session, results));
                self.rows = Some((revisions, Rc::clone(&rows)));
                rows
            }
        }
    }

    fn view(
        &mut self,
        document: &Document,
        results: Option<&Results>,
        station_idx: usize,
        capture_idx: usize,
    ) -> Option<Rc<CaptureView>> {
        let key = ViewKey {
            revisions: (document.revision, results.map(|results| results.revision)),
            station_idx,
            capture_idx,
            fit: self.fit,
        };
        if let Some((known, view)) = &self.view
            && *known == key
        {
            return Some(Rc::clone(view));
        }
        let view = model::capture_view(&document.session, results, station_idx, capture_idx, self.fit)?;
        let view = Rc::new(view);
        self.view = Some((key, Rc::clone(&view)));
        Some(view)
    }
}

/// Shows the panel.
pub fn show(ui: &mut Ui, context: &mut PanelContext<'_>, state: &mut ArcsState) {
    let workbench = context.workbench;
    let Some(document) = workbench.document() else {
        widgets::nothing(ui, text::NO_SESSION);
        return;
    };
    let results = workbench.results();
    let rows = state.rows(document, results);
    if rows.is_empty() {
        if document.session.target.is_pose() {
            import::no_pairs(ui, context.actions);
        } else {
            widgets::nothing(ui, text::NO_STATIONS);
        }
        return;
    }
    let selection = &mut *context.selection;
    let has_moved = move_selection(ui, &rows, selection);
    clamp(&rows, selection);

    let station = Some((document.revision, selection.station_idx));
    if state.fitted_station.map(|(_, station_idx)| station_idx) != station.map(|(_, station_idx)| station_idx) {
        state.fitted_station = station;
        state.is_profile_fitted = true;
        state.is_curve_fitted = true;
        state.hovered_capture = None;
    }

    let area = ui.available_rect_before_wrap();
    let (left, right) = area.split_left_right_at_x(area.left() + LIST_WIDTH.min(area.width() * 0.35));
    let mut left = ui.new_child(UiBuilder::new().max_rect(left));
    let columns = match document.session.target {
        Target::RightAnglePlate => Columns::EdgePoints,
        Target::Point | Target::Pose { .. } => Columns::Tips,
        Target::Workpiece => Columns::Scans,
        Target::Ball { .. } | Target::Rgbd { .. } => Columns::Arcs,
    };
    let hovered_in_list = widgets::card_with_height(
        &mut left,
        text::STATIONS,
        area.height(),
        |_| {},
        |ui| {
            list::show(ui, &rows, columns, &mut state.expanded, selection, has_moved, &mut state.list_from_top)
                .hovered_capture
        },
    );
    let right = right.with_min_x(right.left() + theme::GAP);
    let mut right = ui.new_child(UiBuilder::new().max_rect(right));
    right.spacing_mut().item_spacing.y = theme::GAP;
    if !workbench.results_are_current() {
        right.set_opacity(0.6);
    }
    plots(&mut right, document, results, &rows, selection, state, hovered_in_list);
    ui.advance_cursor_after_rect(area);
}

/// Up and down go through the stations, left and right through the steps.
fn move_selection(ui: &Ui, rows: &[StationRow], selection: &mut Selection) -> bool {
    // A field that is being typed into keeps its arrows.
    if ui.ctx().text_edit_focused() {
        return false;
    }
    let pressed = |key| ui.input_mut(|input| input.consume_key(Modifiers::NONE, key));
    let before = *selection;
    if pressed(Key::ArrowDown) {
        selection.station_idx += 1;
        selection.capture_idx = 0;
    }
    if pressed(Key::ArrowUp) {
        selection.station_idx = selection.station_idx.saturating_sub(1);
        selection.capture_idx = 0;
    }
    clamp(rows, selection);
    if pressed(Key::ArrowRight) {
        selection.capture_idx += 1;
    }
    if pressed(Key::ArrowLeft) {
        selection.capture_idx = selection.capture_idx.saturating_sub(1);
    }
    clamp(rows, selection);
    *selection != before
}

fn clamp(rows: &[StationRow], selection: &mut Selection) {
    selection.station_idx = selection.station_idx.min(rows.len().saturating_sub(1));
    let num_captures = rows.get(selection.station_idx).map_or(0, |row| row.captures.len());
    selection.capture_idx = selection.capture_idx.min(num_captures.saturating_sub(1));
}

fn plots(
    ui: &mut Ui,
    document: &Document,
    results: Option<&Results>,
    rows: &[StationRow],
    selection: &mut Selection,
    state: &mut ArcsState,
    hovered_in_list: Option<usize>,
) {
    let height = ui.available_height();
    if document.session.target.is_pose() {
        // The camera's software has seen the images; what is left to look at is where the boards were.
        points_card(ui, height, &document.session.target, rows, selection, &mut state.is_curve_fitted);
        return;
    }
    let station = &rows[selection.station_idx];
    let sweep = results.and_then(|results| sweep_of(&results.methods, selection.station_idx)).map(|(_, sweep)| sweep);
    let shown_capture = state
        .hovered_capture
        .filter(|capture_idx| *capture_idx < station.captures.len())
        .unwrap_or(selection.capture_idx);
    let view = state.view(document, results, selection.station_idx, shown_capture);
    let is_out_of_date = results.is_some_and(|results| results.revision < document.data_revision);
    let is_of_arcs = matches!(document.session.target, Target::Ball { .. });
    let note = strip::note(view.as_deref(), state.fit);
    let fit = is_of_arcs.then_some(&mut state.fit);
    strip::show(ui, station, sweep, selection, fit, note.as_deref(), is_out_of_date);

    let bottom_height = sweep.map_or(0.0, |_| BOTTOM_HEIGHT + theme::GAP);
    let height = ui.available_height() - bottom_height;
    let title = text::profile_title(&station.label, shown_capture + 1);
    let ball_radius_mm = ball_radius_mm(&document.session);
    let width = ui.available_width();
    let hovered_before = state.hovered_capture;
    if width >= SIDE_BY_SIDE_FROM {
        let profile_width = ((width - theme::GAP) * 0.56).round();
        let area = ui.available_rect_before_wrap();
        let (left, right) = area.split_left_right_at_x(area.left() + profile_width);
        let right = right.with_min_x(right.left() + theme::GAP);
        let mut left = ui.new_child(UiBuilder::new().max_rect(left));
        profile_card(&mut left, &title, height, &document.session.target, view.as_deref(), state);
        let mut right = ui.new_child(UiBuilder::new().max_rect(right));
        if is_of_arcs {
            curve_card(&mut right, height, station, sweep, ball_radius_mm, selection, state, hovered_in_list);
        } else {
            points_card(&mut right, height, &document.session.target, rows, selection, &mut state.is_curve_fitted);
        }
        ui.advance_cursor_after_rect(area.with_max_y(area.top() + height));
        bottom_strip(ui, sweep);
    } else {
        // The scroll bar gets the panel's margin, so that it covers no plot.
        let area = ui.available_rect_before_wrap();
        let mut page = ui.new_child(UiBuilder::new().max_rect(area.with_max_x(area.right() + theme::GAP - 2.0)));
        let scroll_area = ScrollArea::vertical().id_salt("arcs plots").auto_shrink([false, false]);
        let scroll_area = state.plots_from_top.apply(scroll_area);
        scroll_area.show(&mut page, |ui| {
            ui.set_max_width(area.width());
            ui.spacing_mut().item_spacing.y = theme::GAP;
            profile_card(ui, &title, STACKED_HEIGHT, &document.session.target, view.as_deref(), state);
            if is_of_arcs {
                curve_card(ui, STACKED_HEIGHT, station, sweep, ball_radius_mm, selection, state, hovered_in_list);
            } else {
                let target = &document.session.target;
                points_card(ui, STACKED_HEIGHT, target, rows, selection, &mut state.is_curve_fitted);
            }
            bottom_strip(ui, sweep);
        });
    }
    if state.hovered_capture != hovered_before {
        ui.ctx().request_repaint();
    }
}

/// Beside a profile without a curve: all profiles of its scan, or all points of the target.
fn points_card(
    ui: &mut Ui,
    height: f32,
    target: &Target,
    rows: &[StationRow],
    selection: &mut Selection,
    is_fitted: &mut bool,
) {
    if *target == Target::Workpiece {
        scan::card(ui, height, &rows[selection.station_idx], selection, is_fitted);
    } else {
        spread::card(ui, height, target, rows, selection, is_fitted);
    }
}

fn profile_card(
    ui: &mut Ui,
    title: &str,
    height: f32,
    target: &Target,
    view: Option<&CaptureView>,
    state: &mut ArcsState,
) {
    let found = match view {
        Some(CaptureView::Profile(model)) => model.found.as_ref().ok(),
        _ => None,
    };
    let shows_whole = state.shows_whole_profile;
    let mut chosen = None;
    let right = |ui: &mut Ui| {
        ui.spacing_mut().interact_size.y = 22.0;
        ui.spacing_mut().button_padding = egui::vec2(8.0, 2.0);
        ui.spacing_mut().item_spacing.x = 4.0;
        // Where nothing was found, or all points count, all are shown anyway.
        let near = found.and_then(|found| match found {
            Found::Section(_) => Some((text::ARC_ONLY, text::ARC_ONLY_HINT)),
            Found::Edge(edge) => Some((feature_name(edge.feature), text::EDGE_ONLY_HINT)),
            Found::Scan(_) => None,
        });
        if let Some((near_name, near_hint)) = near {
            let whole_hint = text::whole_profile_hint(target);
            for (is_whole, name, hint) in [(true, text::WHOLE_PROFILE, whole_hint), (false, near_name, near_hint)] {
                let button = ui.add(egui::Button::selectable(shows_whole == is_whole, name)).on_hover_text(hint);
                if button.clicked() {
                    chosen = Some(is_whole);
                }
            }
        }
        ui.label(theme::dim(ui, text::TRUE_SCALE));
    };
    let is_fitted = &mut state.is_profile_fitted;
    widgets::card_with_height(ui, title, height, right, |ui| match view {
        Some(CaptureView::Profile(model)) => {
            saveable(ui, title, |ui| profile::show(ui, model, shows_whole, is_fitted));
        }
        Some(CaptureView::Point([x, y, z])) => {
            let [x, y, z] = [x, y, z].map(|value| widgets::fixed(*value, 3));
            empty_card(ui, text::point_reading(target), Some(&text::point_coordinates(target, &x, &y, &z)));
        }
        None => {}
    });
    if let Some(is_whole) = chosen {
        state.shows_whole_profile = is_whole;
        state.is_profile_fitted = true;
    }
}

pub(super) fn empty_card(ui: &mut Ui, sentence: &str, figures: Option<&str>) {
    Frame::new().inner_margin(Margin::same(24)).show(ui, |ui| {
        ui.add_space((ui.available_height() * 0.3).max(0.0));
        ui.vertical_centered(|ui| {
            ui.label(theme::dim(ui, sentence));
            if let Some(figures) = figures {
                ui.add_space(8.0);
                ui.label(widgets::number_text(figures));
            }
        });
    });
}

#[expect(clippy::too_many_arguments, reason = "a card's place, its data and its state, each of another owner")]
fn curve_card(
    ui: &mut Ui,
    height: f32,
    station: &StationRow,
    sweep: Option<&Sweep>,
    ball_radius_mm: Option<f64>,
    selection: &mut Selection,
    state: &mut ArcsState,
    hovered_in_list: Option<usize>,
) {
    widgets::card_with_height(
        ui,
        text::RADIUS_AGAINST_STEP,
        height,
        |_| {},
        |ui| {
            let (Some(sweep), Some(ball_radius_mm)) = (sweep, ball_radius_mm) else {
                state.hovered_capture = None;
                let sentence = if station.captures.len() < 2 {
                    text::NO_SWEEP
                } else if station.is_enabled {
                    text::SWEEP_NOT_EVALUATED
                } else {
                    text::STATION_LEFT_OUT
                };
                empty_card(ui, sentence, None);
                return;
            };
            let look = curve::CurveLook {
                name: "arcs",
                ball_radius_mm,
                x_title: text::TRAVEL_AXIS,
                selected_capture: Some(selection.capture_idx),
                hovered_capture: hovered_in_list,
                has_residuals: true,
            };
            let is_fitted = &mut state.is_curve_fitted;
            let response =
                saveable(ui, text::RADIUS_AGAINST_STEP, |ui| curve::show(ui, &Curve::of(sweep), &look, is_fitted));
            state.hovered_capture = response.hovered.or(hovered_in_list);
            if let Some(capture_idx) = response.clicked {
                selection.capture_idx = capture_idx;
            }
        },
    );
}

fn bottom_strip(ui: &mut Ui, sweep: Option<&Sweep>) {
    let Some(sweep) = sweep else { return };
    widgets::card_with_height(
        ui,
        "",
        BOTTOM_HEIGHT,
        |_| {},
        |ui| {
            Frame::new().inner_margin(Margin::symmetric(12, 9)).show(ui, |ui| {
                ui.horizontal_wrapped(|ui| {
                    ui.label(theme::strong(text::RULE_AND_CURVE));
                    let sentence = text::rule_and_curve(
                        &std_text(sweep.published_stop_std_mm),
                        sweep.points.len(),
                        &std_text(sweep.peak_std_mm),
                    );
                    ui.label(theme::dim(ui, sentence));
                });
            });
        },
    );
}
