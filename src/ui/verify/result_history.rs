//! The calibrations of a folder over time: table, drift with its trend, and what it comes to in words.

use std::path::{Path, PathBuf};

use egui::{Align2, Color32, Frame, Id, Margin, ProgressBar, RichText, Stroke, Ui, vec2};

use crate::app::workbench::comparing::FolderRead;
use crate::app::{Command, Progress};
use crate::report::result_history::said::{history_rows, history_sentences, verdict};
use crate::report::result_history::series::{Quantity, Series, series};
use crate::report::result_history::{Compared, Course, History, Order};
use crate::text::compare_results as words;
use crate::ui::actions::Action;
use crate::ui::charts::{self, Chart, Extent, LegendEntry, LegendGlyph};
use crate::ui::compare::table::RowCells;
use crate::ui::save_picture::saveable;
use crate::ui::{PanelContext, theme, widgets};

use super::compare_results::{AXIS_MARKERS, choose_button, marked, path_field, refused, row};

/// Width of the buttons beside the field of the folder, points.
const BUTTONS_WIDTH: f32 = 180.0;
/// Width of what stands beside them while a folder is read.
const PROGRESS_WIDTH: f32 = 140.0;
/// Least and most height of the plot's card, points.
const PLOT_HEIGHTS: [f32; 2] = [260.0, 360.0];
/// Height that the table and the sentences below the plot take at least, points.
const BELOW_HEIGHT: f32 = 260.0;
/// From this width, points, the table has room for all its columns.
const ALL_COLUMNS_FROM: f32 = 720.0;
/// Rows of the table that are shown; a folder may hold thousands of files.
const MOST_ROWS: usize = 400;

/// What the section remembers between frames.
#[derive(Debug)]
pub(super) struct ResultHistoryState {
    folder: String,
    quantity: Quantity,
    is_fitted: bool,
}

impl Default for ResultHistoryState {
    fn default() -> Self {
        Self { folder: String::new(), quantity: Quantity::default(), is_fitted: true }
    }
}

impl ResultHistoryState {
    /// Takes a folder that was chosen.
    pub fn take_folder(&mut self, folder: &Path) {
        self.folder = folder.display().to_string();
        self.is_fitted = true;
    }
}

/// Shows the section.
pub(super) fn show(ui: &mut Ui, context: &mut PanelContext<'_>, state: &mut ResultHistoryState) {
    controls(ui, context, state);
    let study = context.workbench.result_history();
    let Some(found) = study.last() else {
        let progress = study.progress().unwrap_or(Progress { done: 0, total: 0 });
        let reading = words::reading_folder(progress.done, progress.total);
        widgets::nothing(ui, if study.is_running() { &reading } else { words::NOTHING_READ });
        return;
    };
    if study.is_running() {
        ui.set_opacity(0.6);
    }
    let FolderRead { outcome, .. } = &found.value;
    match outcome {
        Ok(history) => {
            summary(ui, history);
            plot(ui, history, state);
            table(ui, history);
            remarks(ui, history);
        }
        Err(refusal) => refused(ui, refusal.reason()),
    }
}

fn controls(ui: &mut Ui, context: &mut PanelContext<'_>, state: &mut ResultHistoryState) {
    let study = context.workbench.result_history();
    let mut is_asked = false;
    row(ui, words::FOLDER, |ui| {
        ui.spacing_mut().item_spacing.x = 8.0;
        let beside = if study.is_running() { PROGRESS_WIDTH } else { 0.0 };
        let width = ui.available_width() - BUTTONS_WIDTH - beside;
        is_asked = path_field(ui, words::FOLDER_FIELD, words::FOLDER_EXAMPLE, &mut state.folder, width);
        if choose_button(ui, words::CHOOSE_FOLDER) {
            context.actions.push(Action::ChooseResultFolder);
        }
        ui.add_enabled_ui(!state.folder.trim().is_empty(), |ui| {
            let button = widgets::primary_button(ui, words::READ_FOLDER);
            is_asked |= button.on_disabled_hover_text(words::FOLDER_MISSING).clicked();
        });
        if let Some(progress) = study.progress() {
            if ui.button(words::STOP).clicked() {
                context.commands.push(Command::CancelResultHistory);
            }
            ui.add(ProgressBar::new(progress.fraction()).desired_width(48.0).desired_height(6.0));
        }
    });
    let folder = state.folder.trim();
    if is_asked && !folder.is_empty() {
        context.commands.push(Command::ReadResultHistory(PathBuf::from(folder)));
        state.is_fitted = true;
    }
}

/// The verdict, and by what the order is.
fn summary(ui: &mut Ui, history: &History) {
    let palette = *theme::palette(ui);
    let (sign, color) = match history.course() {
        Course::Steady => ("✔", palette.good),
        Course::Moved => ("!", palette.warn),
        Course::Unknown => ("–", palette.text_dim),
    };
    ui.horizontal_top(|ui| {
        ui.label(theme::strong(sign).color(color));
        ui.vertical(|ui| {
            ui.spacing_mut().item_spacing.y = 2.0;
            ui.add(egui::Label::new(theme::strong(verdict(history))).wrap());
            let head = words::history_head(history.calibrations.len(), history.order == Order::Dates);
            ui.add(egui::Label::new(theme::dim(ui, head).small()).wrap());
        });
    });
}

fn plot(ui: &mut Ui, history: &History, state: &mut ResultHistoryState) {
    let left_over = ui.clip_rect().bottom() - ui.cursor().top() - BELOW_HEIGHT;
    let height = left_over.clamp(PLOT_HEIGHTS[0], PLOT_HEIGHTS[1]);
    let mut chosen = state.quantity;
    let is_fitted = &mut state.is_fitted;
    let quantity = state.quantity;
    widgets::card_with_height(
        ui,
        words::DRIFT_PLOT,
        height,
        |ui| {
            for (choice, name) in Quantity::ALL.into_iter().zip(words::QUANTITIES).rev() {
                if ui.selectable_label(quantity == choice, name).clicked() {
                    chosen = choice;
                }
            }
        },
        |ui| saveable(ui, words::DRIFT_PLOT, |ui| drift(ui, history, quantity, is_fitted)),
    );
    if chosen != quantity {
        state.quantity = chosen;
        state.is_fitted = true;
    }
}

fn legend(ui: &mut Ui, series: &[Series; 3], colors: [Color32; 3], has_jumps: bool) {
    let mut entries: Vec<LegendEntry> = (0..3)
        .map(|axis| {
            let name = ["x", "y", "z"][axis];
            let is_drift = series[axis].is_drift == Some(true);
            let text = if is_drift { format!("{name} {}", words::DRIFT_LEGEND) } else { name.to_owned() };
            LegendEntry { glyph: LegendGlyph::Solid(AXIS_MARKERS[axis]), color: colors[axis], text }
        })
        .collect();
    let dim = theme::palette(ui).text_dim;
    if series.iter().any(|series| !series.lines.is_empty()) {
        entries.push(LegendEntry { glyph: LegendGlyph::Line, color: dim, text: words::TREND_LEGEND.to_owned() });
    }
    if has_jumps {
        let (color, text) = (theme::palette(ui).warn, words::JUMP_LEGEND.to_owned());
        entries.push(LegendEntry { glyph: LegendGlyph::Dashed, color, text });
    }
    if series.iter().any(|series| series.stds.iter().any(Option::is_some)) {
        entries.push(LegendEntry {
            glyph: LegendGlyph::Line,
            color: Color32::TRANSPARENT,
            text: words::BARS_ARE_STD.to_owned(),
        });
    }
    charts::legend(ui, &entries);
}

/// A series an axis with error bars, the trends between the jumps, and the jumps.
fn drift(ui: &mut Ui, history: &History, quantity: Quantity, is_fitted: &mut bool) {
    let series = series(history, quantity);
    let colors = theme::axis_colors(ui);
    let jumps = &history.drift.jumps;
    legend(ui, &series, colors, !jumps.is_empty());
    let (unit, y_title, least) = match quantity {
        Quantity::Point | Quantity::Translation => ("mm", words::WAY_AXIS, 1e-3),
        Quantity::Rotation => ("°", words::TURN_AXIS, 1e-4),
    };
    let last = history.times.last().copied().unwrap_or_default().max(1.0);
    let mut extent = Extent { x: [-0.02 * last, 1.02 * last], y: [-least, least] };
    for series in &series {
        for ([_, y], std) in series.values.iter().zip(&series.stds) {
            extent.include(0.0, y - std.unwrap_or_default());
            extent.include(0.0, y + std.unwrap_or_default());
        }
    }
    let x_title = match (history.order, history.calibrations.first().and_then(Compared::date)) {
        (Order::Dates, Some(first)) => words::days_axis(&first),
        _ => words::NUMBER_AXIS.to_owned(),
    };
    let chart = Chart::new(Id::unique("drift of results"), &x_title, y_title, ui.available_height(), extent);
    let canvas = chart.show(ui, is_fitted);
    let palette = theme::palette(ui);
    let painter = &canvas.painter;
    let zero = canvas.at(0.0, 0.0).y;
    painter.hline(canvas.rect().x_range(), zero, Stroke::new(1.0, palette.text_dim.gamma_multiply(0.6)));
    for jump in jumps {
        let (Some(before), Some(at)) = (history.times.get(jump - 1), history.times.get(*jump)) else { continue };
        let x = canvas.at(f64::midpoint(*before, *at), 0.0).x;
        let ends = [canvas.rect().top(), canvas.rect().bottom()].map(|y| egui::pos2(x, y));
        charts::dashed_line(painter, &ends, Stroke::new(1.2, palette.warn));
    }
    let mut marks = Vec::new();
    for (axis, series) in series.iter().enumerate() {
        let color = colors[axis];
        // What is no more than chance is drawn faintly.
        let width = if series.is_drift == Some(true) { 2.2 } else { 1.0 };
        let opacity = if series.is_drift == Some(true) { 1.0 } else { 0.55 };
        for line in &series.lines {
            let ends = line.map(|[x, y]| canvas.at(x, y));
            painter.line_segment(ends, Stroke::new(width, color.gamma_multiply(opacity)));
        }
        for (idx, ([x, y], std)) in series.values.iter().zip(&series.stds).enumerate() {
            if let Some(std) = std {
                let stroke = Stroke::new(1.0, color.gamma_multiply(0.7));
                charts::error_bar(painter, canvas.at(*x, y + std), canvas.at(*x, y - std), stroke);
            }
            charts::marker(painter, AXIS_MARKERS[axis], canvas.at(*x, *y), 3.5, color, Stroke::NONE);
            marks.push(((idx, axis, *y, *std), [*x, *y]));
        }
    }
    if let Some((idx, axis, value, std)) = canvas.hovered(marks) {
        let name = history.calibrations.get(idx).map_or("", |calibration| calibration.name.as_str());
        let decimals = if quantity == Quantity::Rotation { 5 } else { 4 };
        let value = words::with_std(value, std, decimals).replace('-', "−");
        let note = words::history_readout(name, ["x", "y", "z"][axis], &value, unit);
        let pointer = canvas.response.hover_pos().unwrap_or_default() - vec2(0.0, 12.0);
        canvas.note(ui, pointer, Align2::CENTER_BOTTOM, &note, palette.text);
    }
}

fn table(ui: &mut Ui, history: &History) {
    widgets::card(
        ui,
        words::HISTORY_TABLE,
        |_| {},
        |ui| {
            ui.spacing_mut().item_spacing.y = 0.0;
            let width = ui.available_width();
            // A narrow table names a calibration by its date where all have one, and leaves out the turn.
            let is_wide = width >= ALL_COLUMNS_FROM;
            let first = usize::from(history.order == Order::Dates);
            let columns: Vec<(usize, f32)> = if is_wide {
                vec![(0, 0.27), (1, 0.11), (2, 0.1), (3, 0.1), (4, 0.1), (5, 0.1), (6, 0.1), (7, 0.12)]
            } else {
                vec![(first, 0.24), (2, 0.145), (3, 0.145), (4, 0.145), (6, 0.145), (7, 0.18)]
            };
            let mut head = RowCells::new(ui, theme::ROW_HEIGHT);
            for (column, part) in &columns {
                let align = if *column < 2 { Align2::LEFT_CENTER } else { Align2::RIGHT_CENTER };
                head.head(part * width, words::HISTORY_HEADS[*column], align);
            }
            for (idx, row) in history_rows(history).into_iter().enumerate().take(MOST_ROWS) {
                let is_jump = history.drift.jumps.contains(&idx);
                let mut cells = RowCells::new(ui, theme::ROW_HEIGHT);
                let palette = *theme::palette(cells.ui());
                for (column, part) in &columns {
                    let text = &row[*column];
                    if *column < 2 {
                        cells.text(part * width, text);
                    } else {
                        let color = if is_jump && *column == 7 { palette.warn } else { palette.text };
                        let text = if text == "-" { "–".to_owned() } else { text.replace('-', "−") };
                        cells.word(part * width, &text, color);
                    }
                }
            }
            ui.add_space(4.0);
        },
    );
}

fn remarks(ui: &mut Ui, history: &History) {
    widgets::card(
        ui,
        words::HISTORY_REMARKS,
        |_| {},
        |ui| {
            Frame::new().inner_margin(Margin::symmetric(12, 6)).show(ui, |ui| {
                ui.spacing_mut().item_spacing.y = 2.0;
                let palette = *theme::palette(ui);
                for sentence in history_sentences(history) {
                    let (sign, color) =
                        if sentence.is_remarkable { ("!", palette.warn) } else { ("·", palette.text_dim) };
                    marked(ui, sign, color, &sentence.text);
                }
            });
        },
    );
    let hidden = history.calibrations.len().saturating_sub(MOST_ROWS);
    if hidden > 0 {
        ui.label(RichText::new(words::more_rows(hidden)).small());
    }
}
