//! The calibration on the data of other targets, and the joint calibration of them all.

use egui::{Align2, Frame, Id, Margin, Rect, Role, Sense, Stroke, TextEdit, Ui, WidgetInfo, pos2, vec2};

use crate::app::Command;
use crate::session::Edit;
use crate::text::verify as words;
use crate::ui::actions::Action;
use crate::ui::charts::{Chart, Extent};
use crate::ui::compare::table::{RowCells, tint, tint_legend};
use crate::ui::save_picture::saveable;
use crate::ui::{PanelContext, theme, widgets};
use crate::verify::{StationError, TargetEvidence};

use super::distances::{nothing_yet, select_cell};
use super::marks::Mark;
use super::panel::View;

/// Width of the column of calibrations, points.
const NAME_WIDTH: f32 = 260.0;
/// Height of the card with the stations' errors, points.
const STATIONS_HEIGHT: f32 = 300.0;
/// Parts of a row of the joint calibration: target, σ alone, σ together, movement, probability.
const JOINT_PARTS: [f32; 5] = [0.28, 0.18, 0.18, 0.18, 0.18];
/// Refused profiles of which the reason is told.
const MOST_REASONS: usize = 8;
/// Part of a station's place that its bars take.
const BARS_PART: f64 = 0.8;

/// What the section remembers between frames.
#[derive(Debug)]
pub(super) struct CrossTargetState {
    /// The target whose stations are shown.
    target: usize,
    /// The calibration that is picked out, by its name.
    shown: Option<String>,
    /// A name as it is being typed, and of which further target.
    renaming: Option<(usize, String)>,
    is_fitted: bool,
    /// Calibrations that the bars leave out, by their names.
    hidden: Vec<String>,
}

impl Default for CrossTargetState {
    fn default() -> Self {
        Self { target: 0, shown: None, renaming: None, is_fitted: true, hidden: Vec::new() }
    }
}

/// Shows the section.
pub(super) fn show(ui: &mut Ui, view: &View<'_>, context: &mut PanelContext<'_>, state: &mut CrossTargetState) {
    let targets = &view.verification.targets;
    if targets.is_empty() {
        nothing_yet(ui, words::NO_TARGET, context);
        return;
    }
    state.target = state.target.min(targets.len() - 1);
    let chosen = view.marks.iter().position(|mark| Some(&mark.name) == state.shown.as_ref());
    let shown_idx = chosen.or_else(|| view.verification.answer_idx()).unwrap_or(0);
    ui.horizontal(|ui| {
        if widgets::primary_button(ui, words::ADD_TARGET).on_hover_text(words::ADD_TARGET_HINT).clicked() {
            context.actions.push(Action::AddFurther);
        }
        ui.add_space(8.0);
        tint_legend(ui);
    });
    table(ui, view, shown_idx, state);
    for target in targets {
        let num_refused = target.refused().count();
        if num_refused > 0 {
            let reasons: Vec<String> = (target.refused().take(MOST_REASONS))
                .map(|capture| words::refused_capture(capture.station, &capture.refusal.to_string()))
                .collect();
            let text = words::refused(&target.name, num_refused, target.num_captures());
            ui.label(theme::dim(ui, text)).on_hover_text(reasons.join("\n"));
        }
    }
    if targets.len() == 1 {
        ui.label(theme::dim(ui, words::ONLY_OWN));
    }
    joint(ui, view);
    stations(ui, view, shown_idx, state);
    further_list(ui, context, state);
}

fn table(ui: &mut Ui, view: &View<'_>, shown_idx: usize, state: &mut CrossTargetState) {
    let targets = &view.verification.targets;
    let right = |ui: &mut Ui| {
        ui.label(theme::dim(ui, words::CROSS_TABLE_HINT));
    };
    widgets::card(ui, words::CROSS_TABLE, right, |ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        if view.marks.is_empty() {
            Frame::new().inner_margin(Margin::same(16)).show(ui, |ui| ui.label(theme::dim(ui, words::NO_CALIBRATION)));
            return;
        }
        #[expect(clippy::cast_precision_loss, reason = "a handful of targets")]
        let width = (ui.available_width() - NAME_WIDTH) / targets.len() as f32;
        let mut head = RowCells::new(ui, theme::ROW_HEIGHT + 4.0);
        head.head(NAME_WIDTH, words::CALIBRATION, Align2::LEFT_CENTER);
        for (target_idx, target) in targets.iter().enumerate() {
            let cell = head.next(width);
            if target_head(head.ui(), cell, target, target_idx == state.target) {
                state.target = target_idx;
                state.is_fitted = true;
            }
        }
        let mut head = RowCells::new(ui, theme::ROW_HEIGHT - 2.0);
        head.head(NAME_WIDTH, "", Align2::LEFT_CENTER);
        for _ in targets {
            for name in [words::RMS, words::MEAN, words::MAXIMUM] {
                head.head(width / 3.0, name, Align2::RIGHT_CENTER);
            }
        }
        for (idx, mark) in view.marks.iter().enumerate() {
            ui.push_id(idx, |ui| {
                let mut cells = RowCells::new(ui, theme::ROW_HEIGHT);
                if select_cell(&mut cells, NAME_WIDTH, mark, false, idx == shown_idx) {
                    state.shown = Some(mark.name.clone());
                }
                for (target_idx, target) in targets.iter().enumerate() {
                    match target.rows.get(idx) {
                        Some(Ok(evaluation)) => {
                            let has_seen = view.verification.has_seen(idx, target_idx);
                            figures(&mut cells, width / 3.0, &evaluation.figures, has_seen);
                        }
                        Some(Err(refusal)) => cells.text(width, &refusal.to_string()),
                        None => {
                            cells.next(width);
                        }
                    }
                }
            });
        }
    });
}

/// How well all targets together know the sensor, and whether they contradict each other.
fn joint(ui: &mut Ui, view: &View<'_>) {
    let Some(joint) = &view.verification.joint else { return };
    widgets::card(
        ui,
        words::JOINT,
        |ui| {
            ui.add(egui::Label::new(theme::dim(ui, words::JOINT_HINT)).truncate()).on_hover_text(words::JOINT_HINT);
        },
        |ui| {
            ui.spacing_mut().item_spacing.y = 0.0;
            let solution = match &joint.outcome {
                Ok(solution) => solution,
                Err(error) => {
                    let words = error.to_string();
                    Frame::new().inner_margin(Margin::same(16)).show(ui, |ui| ui.add(egui::Label::new(words).wrap()));
                    return;
                }
            };
            let widths = JOINT_PARTS.map(|part| part * ui.available_width());
            let mut head = RowCells::new(ui, theme::ROW_HEIGHT);
            let heads = [words::TARGET, words::STD_ALONE, words::STD_JOINT, words::MOVED, words::P_VALUE];
            for (idx, (width, name)) in widths.iter().zip(heads).enumerate() {
                head.head(*width, name, if idx == 0 { Align2::LEFT_CENTER } else { Align2::RIGHT_CENTER });
            }
            for (target_idx, target) in joint.target_idxs.iter().zip(&solution.targets) {
                let mut cells = RowCells::new(ui, theme::ROW_HEIGHT);
                cells.text(widths[0], view.verification.targets.get(*target_idx).map_or("", |target| &target.name));
                let alone = target.alone.uncertainty.as_ref().map_or(f64::NAN, |known| known.workspace_point_std_mm);
                let together = solution.uncertainty.workspace_point_std_mm;
                for (value, width) in [alone, together, target.moved_mm].into_iter().zip(&widths[1..]) {
                    cells.number(*width, value, &widgets::fixed(value, 3), egui::Color32::TRANSPARENT);
                }
                let palette = theme::palette(cells.ui());
                let (words, color) = if target.p_value < words::CONTRADICTED_BELOW {
                    (words::contradicts(&widgets::fixed(target.p_value, 4)), palette.warn)
                } else {
                    (widgets::fixed(target.p_value, 2), palette.text)
                };
                cells.word(widths[4], &words, color);
            }
        },
    );
}

/// A target's head; a click shows its stations.
fn target_head(ui: &Ui, cell: Rect, target: &TargetEvidence, is_shown: bool) -> bool {
    let palette = theme::palette(ui);
    let response = ui.interact(cell, ui.scope_id().with(("target", &target.name)), Sense::click());
    response.widget_info(|| WidgetInfo::selected(Role::Button, true, is_shown, words::show_target(&target.name)));
    if response.hovered() || response.has_focus() {
        ui.painter().rect_filled(cell.shrink(1.0), 0.0, palette.hovered);
    }
    let color = if is_shown { palette.accent } else { palette.text };
    let painter = ui.painter().with_clip_rect(cell.intersect(ui.clip_rect()));
    painter.text(cell.right_center() - vec2(6.0, 0.0), Align2::RIGHT_CENTER, &target.name, theme::strong_font(), color);
    if is_shown {
        let line = Rect::from_min_max(pos2(cell.left() + 6.0, cell.bottom() - 2.0), cell.right_bottom());
        ui.painter().rect_filled(line, 0.0, palette.accent);
    }
    response.clicked()
}

/// Errors on other data are tinted by their size; those on a calibration's own data are faint, as they prove nothing.
fn figures(cells: &mut RowCells<'_>, width: f32, figures: &crate::verify::Figures, has_seen: bool) {
    for value in [figures.rms_mm, figures.mean_mm, figures.max_mm] {
        let text = widgets::fixed(value, 3);
        if has_seen {
            let color = theme::palette(cells.ui()).text_dim;
            cells.word(width, &text, color);
        } else {
            cells.number(width, value, &text, tint(value));
        }
    }
}

/// The errors of every station of the target in sight, all calibrations beside each other.
fn stations(ui: &mut Ui, view: &View<'_>, shown_idx: usize, state: &mut CrossTargetState) {
    let target = &view.verification.targets[state.target];
    let seen: Vec<SeenStations<'_>> = target
        .rows
        .iter()
        .zip(&view.marks)
        .enumerate()
        .filter_map(|(idx, (row, mark))| Some((mark, row.as_ref().ok()?.stations.as_slice(), idx == shown_idx)))
        .collect();
    let Some(names) =
        seen.first().map(|(_, stations, _)| stations.iter().map(|station| station.label.clone()).collect::<Vec<_>>())
    else {
        return;
    };
    let title = words::errors_per_station(&target.name);
    widgets::card_with_height(
        ui,
        &title,
        STATIONS_HEIGHT,
        |_| {},
        |ui| {
            let marks: Vec<&Mark> = seen.iter().map(|(mark, ..)| *mark).collect();
            saveable(ui, &title, |ui| {
                state.is_fitted |= super::histogram::choosing_legend(ui, &marks, &mut state.hidden);
                let seen: Vec<_> = seen.into_iter().filter(|(mark, ..)| !state.hidden.contains(&mark.name)).collect();
                if seen.is_empty() {
                    widgets::nothing(ui, words::ALL_HIDDEN);
                    return;
                }
                station_bars(ui, &names, &seen, &mut state.is_fitted);
            });
        },
    );
}

/// A calibration's errors at each station, and whether it is the one in sight.
type SeenStations<'a> = (&'a Mark, &'a [StationError], bool);

/// The bars of each station, a calibration each.
fn station_bars(ui: &mut Ui, names: &[String], seen: &[SeenStations<'_>], is_fitted: &mut bool) {
    ui.add_space(6.0);
    let place = |idx: usize| f64::from(u32::try_from(idx).unwrap_or(u32::MAX));
    let mut extent = Extent { x: [-0.6, place(names.len()) - 0.4], y: [0.0, 0.01] };
    for station in seen.iter().flat_map(|(_, stations, _)| stations.iter()) {
        extent.include(0.0, station.error_mm);
    }
    let mut chart =
        Chart::new(Id::unique("cross target"), words::STATION_AXIS, words::ERROR_AXIS, ui.available_height(), extent);
    chart.x_names = Some(names);
    let canvas = chart.show(ui, is_fitted);
    let baseline = canvas.at(0.0, 0.0).y;
    let bar_width = BARS_PART / place(seen.len().max(1));
    let mut hovered = None;
    for (series, (mark, stations, is_shown)) in seen.iter().enumerate() {
        for (idx, station) in stations.iter().enumerate() {
            let left = place(idx) - BARS_PART / 2.0 + place(series) * bar_width;
            let top = canvas.at(left, station.error_mm);
            let right = canvas.at(left + bar_width, 0.0).x;
            let bar = Rect::from_min_max(
                pos2(top.x, top.y.min(baseline - 1.5)),
                pos2((right - 0.5).max(top.x + 1.0), baseline),
            );
            mark.paint_bar(&canvas.painter, bar);
            if *is_shown {
                let stroke = Stroke::new(1.2, theme::palette(ui).text);
                canvas.painter.rect_stroke(bar, 0.0, stroke, egui::StrokeKind::Inside);
            }
            let column = Rect::from_x_y_ranges(bar.x_range(), canvas.rect().y_range());
            if canvas.response.hover_pos().is_some_and(|pointer| column.contains(pointer)) {
                hovered = Some((bar, &mark.name, station));
            }
        }
    }
    let palette = theme::palette(ui);
    canvas.painter.hline(canvas.rect().x_range(), baseline, Stroke::new(1.0, palette.text_dim.gamma_multiply(0.6)));
    if let Some((bar, name, station)) = hovered {
        let note = words::station_readout(&station.label, name, &widgets::fixed(station.error_mm, 3));
        canvas.note(ui, bar.center_top(), Align2::CENTER_BOTTOM, &note, palette.text);
    }
}

/// The further targets, to be renamed and removed.
fn further_list(ui: &mut Ui, context: &mut PanelContext<'_>, state: &mut CrossTargetState) {
    let Some(document) = context.workbench.document().filter(|document| !document.session.further.is_empty()) else {
        return;
    };
    widgets::card(
        ui,
        words::FURTHER,
        |_| {},
        |ui| {
            ui.spacing_mut().item_spacing.y = 0.0;
            ui.add_space(4.0);
            for (further_idx, further) in document.session.further.iter().enumerate() {
                let mut text = match &state.renaming {
                    Some((renamed, text)) if *renamed == further_idx => text.clone(),
                    _ => further.name.clone(),
                };
                ui.push_id(further_idx, |ui| {
                    Frame::new().inner_margin(Margin::symmetric(12, 2)).show(ui, |ui| {
                        ui.horizontal(|ui| {
                            let field =
                                ui.add(TextEdit::singleline(&mut text).margin(vec2(8.0, 4.0)).desired_width(220.0));
                            widgets::name_field(&field, &words::name_of(&further.name), &text);
                            if field.changed() {
                                state.renaming = Some((further_idx, text.clone()));
                            }
                            if field.lost_focus() && state.renaming.take().is_some() && text.trim() != further.name {
                                let edit = Edit::RenameFurther(further_idx, text.trim().to_owned());
                                context.commands.push(Command::Edit { edit, gesture: None });
                            }
                            let used = further.stations.iter().filter(|station| station.enabled).count();
                            let what = words::further_figures(&further.target, used, further.stations.len());
                            ui.label(theme::dim(ui, what));
                            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                                if ui.button(words::REMOVE).on_hover_text(words::REMOVE_HINT).clicked() {
                                    let edit = Edit::RemoveFurther(further_idx);
                                    context.commands.push(Command::Edit { edit, gesture: None });
                                }
                            });
                        });
                    });
                });
            }
            ui.add_space(4.0);
        },
    );
}
