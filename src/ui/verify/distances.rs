//! Distances of edge points to the fitted lines and plane, as tables, histograms and a picture in space.

use egui::{Align2, Color32, Rect, Role, Sense, Ui, UiBuilder, WidgetInfo, vec2};

use crate::text::verify as words;
use crate::ui::actions::Action;
use crate::ui::compare::table::RowCells;
use crate::ui::eye::Eye;
use crate::ui::save_picture::saveable;
use crate::ui::{PanelContext, theme, widgets};
use crate::verify::{Distances, EdgePoint, Figures};

use super::histogram::{self, Series};
use super::marks::Mark;
use super::panel::View;
use super::space;

/// Parts of a row: calibration, mean, sd, maximum to the lines and to the plane, angle, gap.
const PARTS: [f32; 9] = [238.0, 70.0, 70.0, 70.0, 70.0, 70.0, 70.0, 96.0, 78.0];
/// Least height of a histogram's card, points.
const LEAST_HISTOGRAM_HEIGHT: f32 = 200.0;
/// From this width, points, the picture stands beside the histograms.
const BESIDE_FROM: f32 = 640.0;

/// What the section remembers between frames.
#[derive(Debug)]
pub(super) struct DistancesState {
    /// The plate in sight, by its place among the plates.
    plate: usize,
    /// The calibration in the picture, by its name.
    shown: Option<String>,
    eye: Eye,
    is_fitted: [bool; 2],
    /// Calibrations that the histograms leave out, by their names.
    hidden: Vec<String>,
}

impl Default for DistancesState {
    fn default() -> Self {
        Self { plate: 0, shown: None, eye: Eye::new(space::AT_FIRST), is_fitted: [true; 2], hidden: Vec::new() }
    }
}

/// A calibration with what it makes of the plate.
struct Row<'a> {
    calibration_idx: usize,
    mark: &'a Mark,
    has_seen: bool,
    outcome: Result<&'a Distances, String>,
}

/// Shows the section.
pub(super) fn show(ui: &mut Ui, view: &View<'_>, context: &mut PanelContext<'_>, state: &mut DistancesState) {
    let plates: Vec<usize> = (0..view.verification.targets.len())
        .filter(|idx| matches!(view.verification.targets[*idx].problem, crate::calibrate::Problem::Plate(_)))
        .collect();
    if plates.is_empty() {
        nothing_yet(ui, words::NO_PLATE, context);
        return;
    }
    if view.marks.is_empty() {
        nothing_yet(ui, words::NO_CALIBRATION, context);
        return;
    }
    state.plate = state.plate.min(plates.len() - 1);
    if plates.len() > 1 {
        ui.horizontal(|ui| {
            for (place, target_idx) in plates.iter().enumerate() {
                let name = &view.verification.targets[*target_idx].name;
                if ui.selectable_label(state.plate == place, name).clicked() {
                    state.plate = place;
                }
            }
        });
    }
    let rows = rows(view, plates[state.plate]);
    let shown_idx = rows
        .iter()
        .position(|row| Some(&row.mark.name) == state.shown.as_ref() && row.outcome.is_ok())
        .or_else(|| answer(view, &rows))
        .or_else(|| best(&rows));
    table(ui, &rows, shown_idx, state);
    let Some(shown) = shown_idx.and_then(|idx| rows.get(idx)) else { return };
    let Ok(distances) = &shown.outcome else { return };
    let width = ui.available_width();
    // What is left of the window, so that there is nothing to scroll where there is room.
    let left_over = ui.clip_rect().bottom() - ui.cursor().top() - 4.0;
    let height = left_over.max(2.0 * LEAST_HISTOGRAM_HEIGHT + theme::GAP);
    let each = (height - theme::GAP) / 2.0;
    if width < BESIDE_FROM {
        histograms(ui, &rows, each, state);
        picture(ui, height, shown.mark, distances, &mut state.eye);
        return;
    }
    let area = Rect::from_min_size(ui.cursor().min, vec2(width, height));
    let (left, right) = area.split_left_right_at_x(area.left() + ((width - theme::GAP) * 0.46).round());
    histograms(&mut ui.new_child(UiBuilder::new().max_rect(left)), &rows, each, state);
    let right = right.with_min_x(right.left() + theme::GAP);
    let mut beside = ui.new_child(UiBuilder::new().max_rect(right));
    picture(&mut beside, height, shown.mark, distances, &mut state.eye);
    ui.allocate_rect(area, Sense::hover());
}

/// Where something is missing: what, and the way to it.
pub(super) fn nothing_yet(ui: &mut Ui, sentence: &str, context: &mut PanelContext<'_>) {
    ui.vertical_centered(|ui| {
        ui.add_space((ui.available_height() * 0.34).max(48.0));
        ui.set_max_width(520.0);
        ui.label(theme::dim(ui, sentence));
        ui.add_space(8.0);
        if widgets::primary_button(ui, words::ADD_TARGET).on_hover_text(words::ADD_TARGET_HINT).clicked() {
            context.actions.push(Action::AddFurther);
        }
    });
}

fn rows<'a>(view: &'a View<'_>, target_idx: usize) -> Vec<Row<'a>> {
    let calibrations = view.marks.iter().enumerate();
    calibrations
        .filter_map(|(calibration_idx, mark)| {
            let outcome = match view.verification.cell(calibration_idx, target_idx)? {
                Ok(evaluation) => Ok(evaluation.distances()?),
                Err(refusal) => Err(refusal.to_string()),
            };
            Some(Row {
                calibration_idx,
                mark,
                has_seen: view.verification.has_seen(calibration_idx, target_idx),
                outcome,
            })
        })
        .collect()
}

/// The session's answer, which is what the evidence is about.
fn answer(view: &View<'_>, rows: &[Row<'_>]) -> Option<usize> {
    let answer_idx = view.verification.answer_idx()?;
    rows.iter().position(|row| row.calibration_idx == answer_idx && row.outcome.is_ok())
}

/// The one with the least RMS to its lines.
fn best(rows: &[Row<'_>]) -> Option<usize> {
    let with_rms =
        rows.iter().enumerate().filter_map(|(idx, row)| Some((idx, row.outcome.as_ref().ok()?.to_line.rms_mm)));
    with_rms.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(idx, _)| idx)
}

fn table(ui: &mut Ui, rows: &[Row<'_>], shown_idx: Option<usize>, state: &mut DistancesState) {
    let right = |ui: &mut Ui| {
        ui.label(theme::dim(ui, words::DISTANCES_OF));
    };
    widgets::card(ui, words::DISTANCES_TABLE, right, |ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        let scale = ui.available_width() / PARTS.iter().sum::<f32>();
        let widths = PARTS.map(|part| part * scale);
        let mut head = RowCells::new(ui, theme::ROW_HEIGHT);
        head.head(widths[0], "", Align2::LEFT_CENTER);
        head.head(widths[1..4].iter().sum(), words::TO_LINES, Align2::CENTER_CENTER);
        head.head(widths[4..7].iter().sum(), words::TO_PLANE, Align2::CENTER_CENTER);
        head.head(widths[7..].iter().sum(), words::BETWEEN_LINES, Align2::CENTER_CENTER);
        let mut head = RowCells::new(ui, theme::ROW_HEIGHT - 2.0);
        head.head(widths[0], words::CALIBRATION, Align2::LEFT_CENTER);
        let figures = [words::MEAN, words::SPREAD, words::MAXIMUM];
        for (width, name) in widths[1..].iter().zip(figures.iter().chain(&figures).chain(&[words::ANGLE, words::GAP])) {
            head.head(*width, name, Align2::RIGHT_CENTER);
        }
        for (idx, row) in rows.iter().enumerate() {
            ui.push_id(row.calibration_idx, |ui| table_row(ui, row, &widths, shown_idx == Some(idx), state));
        }
    });
}

fn table_row(ui: &mut Ui, row: &Row<'_>, widths: &[f32; 9], is_shown: bool, state: &mut DistancesState) {
    let mut cells = RowCells::new(ui, theme::ROW_HEIGHT);
    if select_cell(&mut cells, widths[0], row.mark, row.has_seen, is_shown) {
        state.shown = Some(row.mark.name.clone());
    }
    match &row.outcome {
        Ok(distances) => {
            for (figures, start) in [(&distances.to_line, 1), (&distances.to_plane, 4)] {
                let Figures { mean_mm, std_mm, max_mm, .. } = *figures;
                for (value, width) in [mean_mm, std_mm, max_mm].into_iter().zip(&widths[start..]) {
                    cells.number(*width, value, &widgets::fixed(value, 3), Color32::TRANSPARENT);
                }
            }
            let color = theme::palette(cells.ui()).text;
            cells.word(widths[7], &format!("{}°", widgets::fixed(distances.angle_rad.to_degrees(), 3)), color);
            cells.number(widths[8], distances.gap_mm, &widgets::fixed(distances.gap_mm, 3), Color32::TRANSPARENT);
        }
        Err(refusal) => cells.text(widths[1..].iter().sum(), refusal),
    }
}

/// A cell that names a calibration and selects it; whether it was computed from this target's data is said at its right.
pub(super) fn select_cell(
    cells: &mut RowCells<'_>,
    width: f32,
    mark: &Mark,
    has_seen: bool,
    is_selected: bool,
) -> bool {
    let cell = cells.next(width);
    let row_rect = cells.rect();
    let ui = cells.ui();
    let palette = theme::palette(ui);
    let response = ui.interact(cell, ui.scope_id().with("calibration"), Sense::click());
    response.widget_info(|| WidgetInfo::selected(Role::Button, true, is_selected, words::show_calibration(&mark.name)));
    if response.hovered() || response.has_focus() {
        ui.painter().rect_filled(cell.shrink2(vec2(0.0, 1.0)), 0.0, palette.hovered);
    }
    if is_selected {
        let marker = Rect::from_min_size(row_rect.min, vec2(3.0, row_rect.height()));
        ui.painter().rect_filled(marker, 0.0, palette.accent);
    }
    let mut room = cell;
    if has_seen {
        let font = egui::FontId::proportional(theme::SMALL_SIZE);
        let galley = ui.painter().layout_no_wrap(words::OWN_DATA.to_owned(), font, palette.text_dim);
        let at = cell.right_center() - vec2(galley.size().x + 4.0, galley.size().y / 2.0);
        room.set_right(at.x - 4.0);
        ui.painter().galley(at, galley, palette.text_dim);
    }
    mark.paint_in(ui, room, palette.text);
    response.on_hover_text(if has_seen { words::OWN_DATA_HINT } else { words::OTHER_DATA_HINT }).clicked()
}

fn histograms(ui: &mut Ui, rows: &[Row<'_>], height: f32, state: &mut DistancesState) {
    let DistancesState { is_fitted, hidden, .. } = state;
    let mut is_changed = false;
    let to_line: fn(&EdgePoint) -> f64 = |point| point.to_line_mm;
    let to_plane: fn(&EdgePoint) -> f64 = |point| point.to_plane_mm;
    let cards =
        [(words::LINE_HISTOGRAM, words::LINE_AXIS, to_line), (words::PLANE_HISTOGRAM, words::PLANE_AXIS, to_plane)];
    ui.spacing_mut().item_spacing.y = theme::GAP;
    for ((title, axis, distance), is_fitted) in cards.into_iter().zip(is_fitted.iter_mut()) {
        let seen = rows.iter().filter_map(|row| Some((row.mark, row.outcome.as_ref().ok()?)));
        let seen: Vec<(&Mark, &Distances)> = seen.map(|(mark, found)| (mark, *found)).collect();
        widgets::card_with_height(
            ui,
            title,
            height,
            |_| {},
            |ui| {
                let marks: Vec<&Mark> = seen.iter().map(|(mark, _)| *mark).collect();
                saveable(ui, title, |ui| {
                    is_changed |= ui.push_id(title, |ui| histogram::choosing_legend(ui, &marks, hidden)).inner;
                    let series: Vec<Series<'_>> = (seen.iter().filter(|(mark, _)| !hidden.contains(&mark.name)))
                        .map(|(mark, found)| Series { mark, distances_mm: found.points.iter().map(distance).collect() })
                        .collect();
                    if series.is_empty() {
                        widgets::nothing(ui, words::ALL_HIDDEN);
                    } else {
                        histogram::show(ui, title, axis, &series, is_fitted);
                    }
                });
            },
        );
    }
    if is_changed {
        *is_fitted = [true; 2];
    }
}

fn picture(ui: &mut Ui, height: f32, mark: &Mark, distances: &Distances, eye: &mut Eye) {
    let right = |ui: &mut Ui| {
        ui.label(theme::dim(ui, &mark.name));
    };
    widgets::card_with_height(ui, words::IN_SPACE, height, right, |ui| {
        saveable(ui, words::IN_SPACE, |ui| space::show(ui, distances, mark, eye));
    });
}
