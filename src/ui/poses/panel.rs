//! The pose table.

use std::collections::{BTreeMap, BTreeSet};

use egui::{Key, Modifiers, RichText, Sense, Ui, vec2};
use egui_extras::{Column, TableRow};

use crate::app::{Command, Document};
use crate::text::conventions::poses_title;
use crate::text::poses as words;
use crate::ui::widgets::tables::{faded_number_cell, head, number_cell, number_column, number_head, table};
use crate::ui::widgets::{card_with_height, fixed, named_checkbox, symbol_button};
use crate::ui::{PanelContext, theme};

use super::convention::{self, ConventionState};
use super::model::{self, Row};

/// Below this width, points, the columns that other places show as well give way, and figures lose a digit.
const NARROW_WIDTH: f32 = 700.0;

/// What the width allows.
#[derive(Clone, Copy)]
struct Density {
    is_narrow: bool,
    /// Of positions in mm and angles in degrees; controllers report three.
    decimals: usize,
}

impl Density {
    fn of(ui: &Ui) -> Self {
        let is_narrow = ui.available_width() < NARROW_WIDTH;
        Self { is_narrow, decimals: if is_narrow { 2 } else { 3 } }
    }
}

/// What is unfolded, and what the check of the session says of its stations.
#[derive(Debug, Default)]
pub struct PosesState {
    convention: ConventionState,
    unfolded: BTreeSet<usize>,
    checks: BTreeMap<String, Vec<String>>,
    checked_revision: Option<u64>,
}

impl PosesState {
    /// Checks the session anew if it has changed.
    fn check(&mut self, document: &Document) {
        if self.checked_revision != Some(document.revision) {
            self.checked_revision = Some(document.revision);
            self.checks = model::checks(&document.session);
        }
    }
}

/// Draws the step.
pub fn show(ui: &mut Ui, context: &mut PanelContext<'_>, state: &mut PosesState) {
    let Some(document) = context.workbench.document() else { return };
    state.check(document);
    convention::bar(ui, context, &mut state.convention);
    let num_stations = document.session.stations.len();
    let num_enabled = document.session.stations.iter().filter(|station| station.enabled).count();
    let rows = model::rows(&document.session, &state.unfolded);
    let moved_to = move_by_keys(ui, context, &rows);
    let is_all_unfolded = state.unfolded.len() >= num_stations;
    let mut toggle_all = false;
    let height = ui.available_height();
    card_with_height(
        ui,
        poses_title(&document.session.robot.notation),
        height,
        |ui| {
            let label = if is_all_unfolded { words::FOLD_ALL } else { words::UNFOLD_ALL };
            let button = egui::Button::new(RichText::new(label).small()).min_size(vec2(0.0, theme::ROW_HEIGHT));
            ui.spacing_mut().interact_size.y = theme::ROW_HEIGHT;
            ui.spacing_mut().button_padding = vec2(8.0, 2.0);
            toggle_all = ui.add(button).clicked();
            ui.label(theme::dim(ui, words::usage(num_enabled, num_stations)));
        },
        |ui| {
            if rows.is_empty() {
                ui.centered_and_justified(|ui| ui.label(theme::dim(ui, words::NO_STATIONS)));
            } else {
                show_table(ui, context, document, state, &rows, moved_to);
            }
        },
    );
    if toggle_all {
        state.unfolded = if is_all_unfolded { BTreeSet::new() } else { (0..num_stations).collect() };
    }
}

/// Moves the selection with the arrow keys; answers the row to be brought into view.
fn move_by_keys(ui: &Ui, context: &mut PanelContext<'_>, rows: &[Row]) -> Option<usize> {
    if ui.ctx().egui_wants_keyboard_input() {
        return None;
    }
    let pressed = |key| ui.input_mut(|input| input.consume_key(Modifiers::NONE, key));
    let (up, down) = (pressed(Key::ArrowUp), pressed(Key::ArrowDown));
    if up == down {
        return None;
    }
    let current = rows.iter().position(|row| is_selected(context, *row)).unwrap_or(0);
    let row_idx = if up { current.saturating_sub(1) } else { (current + 1).min(rows.len().checked_sub(1)?) };
    select(context, *rows.get(row_idx)?);
    Some(row_idx)
}

/// A station's row stands for its first capture; further captures are selected in their own rows, where unfolded.
fn is_selected(context: &PanelContext<'_>, row: Row) -> bool {
    let selection = &context.selection;
    match row {
        Row::Station(station_idx) => selection.station_idx == station_idx && selection.capture_idx == 0,
        Row::Capture { station_idx, capture_idx } => {
            selection.station_idx == station_idx && selection.capture_idx == capture_idx && capture_idx > 0
        }
    }
}

fn select(context: &mut PanelContext<'_>, row: Row) {
    (context.selection.station_idx, context.selection.capture_idx) = match row {
        Row::Station(station_idx) => (station_idx, 0),
        Row::Capture { station_idx, capture_idx } => (station_idx, capture_idx),
    };
}

fn show_table(
    ui: &mut Ui,
    context: &mut PanelContext<'_>,
    document: &Document,
    state: &mut PosesState,
    rows: &[Row],
    moved_to: Option<usize>,
) {
    let angle_names = document.session.robot.notation.convention.angle_names;
    // Cells touch, so that the hairlines between rows run through.
    ui.spacing_mut().item_spacing.x = 0.0;
    let density = Density::of(ui);
    let mut builder = table(ui, if density.is_narrow { "narrow poses" } else { "poses" })
        .sense(Sense::click())
        .column(Column::exact(if density.is_narrow { 36.0 } else { 44.0 }))
        .column(Column::exact(28.0))
        .column(Column::initial(if density.is_narrow { 48.0 } else { 96.0 }).at_least(48.0).clip(true));
    if !density.is_narrow {
        builder = builder.column(Column::exact(48.0));
    }
    builder = builder.columns(number_column(56.0), 6);
    if !density.is_narrow {
        builder = builder.column(Column::exact(80.0));
    }
    builder = builder.column(Column::exact(if density.is_narrow { 52.0 } else { 72.0 }));
    if let Some(row_idx) = moved_to {
        builder = builder.scroll_to_row(row_idx, None);
    }
    builder
        .header(theme::ROW_HEIGHT, |mut header| {
            head(&mut header, words::USED);
            head(&mut header, "");
            head(&mut header, words::STATION);
            if !density.is_narrow {
                head(&mut header, words::SIDE);
            }
            for name in ["x", "y", "z"] {
                number_head(&mut header, &format!("{name} / mm"));
            }
            for name in angle_names {
                number_head(&mut header, &format!("{name} / °"));
            }
            if !density.is_narrow {
                number_head(&mut header, words::CAPTURES);
            }
            head(&mut header, words::CHECK);
        })
        .body(|body| {
            body.rows(theme::ROW_HEIGHT, rows.len(), |mut table_row| {
                let Some(&row) = rows.get(table_row.index()) else { return };
                table_row.set_overline(true);
                table_row.set_selected(is_selected(context, row));
                match row {
                    Row::Station(station_idx) => {
                        show_station(&mut table_row, context, document, state, station_idx, density);
                    }
                    Row::Capture { station_idx, capture_idx } => {
                        show_capture(&mut table_row, context, document, [station_idx, capture_idx], density);
                    }
                }
                if table_row.response().clicked() {
                    select(context, row);
                }
            });
        });
}

fn show_station(
    row: &mut TableRow<'_, '_>,
    context: &mut PanelContext<'_>,
    document: &Document,
    state: &mut PosesState,
    station_idx: usize,
    density: Density,
) {
    let Some(station) = document.session.stations.get(station_idx) else { return };
    row.col(|ui| {
        ui.add_space(8.0);
        let mut enabled = station.enabled;
        if named_checkbox(ui, &mut enabled, &words::use_station(&station.label)).changed() {
            context.commands.push(Command::SetStationEnabled { station_idx, enabled });
        }
    });
    row.col(|ui| {
        if station.captures.len() > 1 {
            let is_unfolded = state.unfolded.contains(&station_idx);
            let (symbol, name) = if is_unfolded {
                ("▾", words::fold_station(&station.label))
            } else {
                ("▸", words::unfold_station(&station.label))
            };
            if symbol_button(ui, symbol, &name).clicked() && !state.unfolded.remove(&station_idx) {
                state.unfolded.insert(station_idx);
            }
        }
    });
    row.col(|ui| {
        ui.add_space(4.0);
        let color = if station.enabled { theme::palette(ui).text } else { theme::palette(ui).text_dim };
        ui.label(RichText::new(&station.label).color(color));
    });
    if !density.is_narrow {
        row.col(|ui| {
            ui.add_space(4.0);
            ui.label(theme::dim(ui, words::side(station.side)));
        });
    }
    let figures = model::pose_figures(&document.session, station_idx, 0);
    pose_cells(row, figures, density, station.enabled);
    if !density.is_narrow {
        number_cell(row, station.captures.len().to_string());
    }
    row.col(|ui| {
        ui.add_space(12.0);
        if station.enabled {
            let mut findings = state.checks.get(&station.label).cloned().unwrap_or_default();
            if let Some(results) = context.workbench.results() {
                findings.extend(model::findings(&document.session, results, context.selection.method, station_idx));
            }
            check_mark(ui, &findings);
        } else {
            ui.label(theme::dim(ui, "–")).on_hover_text(words::LEFT_OUT);
        }
    });
}

fn show_capture(
    row: &mut TableRow<'_, '_>,
    context: &PanelContext<'_>,
    document: &Document,
    [station_idx, capture_idx]: [usize; 2],
    density: Density,
) {
    let Some(station) = document.session.stations.get(station_idx) else { return };
    row.col(|_| {});
    row.col(|_| {});
    row.col(|ui| {
        ui.add_space(16.0);
        ui.label(theme::dim(ui, words::capture_name(&station.label, capture_idx + 1)));
    });
    if !density.is_narrow {
        row.col(|_| {});
    }
    pose_cells(row, model::pose_figures(&document.session, station_idx, capture_idx), density, false);
    if !density.is_narrow {
        row.col(|_| {});
    }
    row.col(|ui| {
        let refusal = context.workbench.results().and_then(|results| model::refusal(results, station_idx, capture_idx));
        if let Some(reason) = refusal {
            ui.add_space(12.0);
            ui.label(RichText::new("!").color(theme::palette(ui).warn)).on_hover_text(reason);
        }
    });
}

fn pose_cells(row: &mut TableRow<'_, '_>, figures: Option<[f64; 6]>, density: Density, takes_part: bool) {
    for figure in figures.into_iter().flatten() {
        let text = fixed(figure, density.decimals);
        if takes_part {
            number_cell(row, text);
        } else {
            faded_number_cell(row, text);
        }
    }
}

fn check_mark(ui: &mut Ui, findings: &[String]) {
    let palette = theme::palette(ui);
    if findings.is_empty() {
        ui.label(RichText::new("✔").color(palette.good)).on_hover_text(words::FINE);
    } else {
        let text = RichText::new(format!("{} !", findings.len())).color(palette.warn);
        ui.label(text).on_hover_text(findings.join("\n"));
    }
}
