//! Two calibrations from files, or the open session against one: how far they are apart, and whether by chance.

use std::path::{Path, PathBuf};

use egui::{
    Align, Align2, Button, Color32, Frame, Id, Key, Layout, Margin, RichText, Sense, Stroke, TextEdit, Ui, UiBuilder,
    vec2,
};
use egui_plot::MarkerShape;

use crate::app::Command;
use crate::app::workbench::comparing::{Compared, Side, Sides};
use crate::geometry::Vec3;
use crate::report::result_history::said::remarks;
use crate::report::result_history::{Comparison, point_in};
use crate::text::compare_results as words;
use crate::ui::actions::Action;
use crate::ui::charts::{self, Chart, Extent, LegendEntry, LegendGlyph};
use crate::ui::compare::table::RowCells;
use crate::ui::save_picture::saveable;
use crate::ui::{PanelContext, theme, widgets};
use crate::verify::difference::SIGNIFICANT_P;

/// Width of the labels of rows, points.
const LABEL_WIDTH: f32 = 64.0;
/// Width of a switch beside a field, points.
const SWITCH_WIDTH: f32 = 132.0;
/// Width of a button beside a field, points.
const BUTTON_WIDTH: f32 = 84.0;
/// Height of a row with a field, points.
const FIELD_HEIGHT: f32 = 30.0;
/// Parts of a row of the table: what, along x, y and z, in all.
const PARTS: [f32; 5] = [0.26, 0.19, 0.19, 0.19, 0.17];
/// The same where a value and its σ stand in two lines.
const NARROW_PARTS: [f32; 5] = [0.3, 0.18, 0.18, 0.18, 0.16];
/// From this width, points, a value and its σ stand in one line.
const ONE_LINE_FROM: f32 = 700.0;
/// Least height of the plot's card, points.
const LEAST_PLOT_HEIGHT: f32 = 220.0;
/// Most height of it.
const MOST_PLOT_HEIGHT: f32 = 380.0;
/// Between the markers of one place, in places.
const BETWEEN_AXES: f64 = 0.16;

/// The markers of x, y and z.
pub(super) const AXIS_MARKERS: [MarkerShape; 3] = [MarkerShape::Circle, MarkerShape::Up, MarkerShape::Square];

/// What the section remembers between frames.
#[derive(Debug)]
pub(super) struct CompareResultsState {
    /// The files as they are typed: the earlier, the later.
    paths: [String; 2],
    /// Which of them is the open session instead, where one is open.
    session_idx: Option<usize>,
    points: String,
    is_fitted: bool,
}

impl Default for CompareResultsState {
    fn default() -> Self {
        // What was measured now, against what was kept.
        Self { paths: Default::default(), session_idx: Some(1), points: String::new(), is_fitted: true }
    }
}

impl CompareResultsState {
    /// Takes a file that was chosen for a side.
    pub fn take_path(&mut self, side: usize, path: &Path) {
        if let Some(text) = self.paths.get_mut(side) {
            *text = path.display().to_string();
            self.session_idx = self.session_idx.filter(|session_idx| *session_idx != side);
        }
    }

    fn side(&self, idx: usize, has_session: bool) -> Option<Side> {
        if has_session && self.session_idx == Some(idx) {
            return Some(Side::OpenSession);
        }
        let path = self.paths[idx].trim();
        (!path.is_empty()).then(|| Side::File(PathBuf::from(path)))
    }

    /// What is to be compared, or why nothing can be.
    fn sides(&self, has_session: bool) -> Result<Sides, String> {
        let texts = self.points.split(';').map(str::trim).filter(|text| !text.is_empty());
        let points: Result<Vec<Vec3>, String> =
            texts.map(|text| point_in(text).ok_or_else(|| words::not_a_point(text))).collect();
        match (self.side(0, has_session), self.side(1, has_session)) {
            (Some(from), Some(to)) => Ok(Sides { from, to, points_in_sensor_mm: points? }),
            _ => Err(words::SIDE_MISSING.to_owned()),
        }
    }
}

/// Shows the section.
pub(super) fn show(ui: &mut Ui, context: &mut PanelContext<'_>, state: &mut CompareResultsState) {
    controls(ui, context, state);
    let study = context.workbench.comparison();
    let Some(found) = study.last() else {
        widgets::nothing(ui, if study.is_running() { words::COMPARING } else { words::NOTHING_COMPARED });
        return;
    };
    let Compared { sides, outcome } = &found.value;
    let is_old = sides.has_open_session() && !context.workbench.is_current(found.revision);
    match outcome {
        Ok(comparison) => {
            if is_old || study.is_running() {
                ui.set_opacity(0.6);
            }
            table(ui, comparison, is_old);
            plot(ui, comparison, &mut state.is_fitted);
        }
        Err(refusal) => refused(ui, refusal.reason()),
    }
}

/// Why there is nothing to show.
pub(super) fn refused(ui: &mut Ui, reason: &str) {
    ui.horizontal_top(|ui| {
        ui.label(theme::strong("✖").color(theme::palette(ui).bad));
        ui.add(egui::Label::new(reason).wrap());
    });
}

/// The two sides, the points, and the button.
fn controls(ui: &mut Ui, context: &mut PanelContext<'_>, state: &mut CompareResultsState) {
    let has_session = context.workbench.document().is_some();
    let mut is_asked = false;
    widgets::card(
        ui,
        words::SIDES,
        |_| {},
        |ui| {
            Frame::new().inner_margin(Margin::symmetric(12, 6)).show(ui, |ui| {
                ui.spacing_mut().item_spacing = vec2(8.0, 2.0);
                is_asked |= side(ui, context, state, 0, has_session);
                is_asked |= side(ui, context, state, 1, has_session);
                is_asked |= points(ui, context, state, has_session);
            });
        },
    );
    if let Some(sides) = state.sides(has_session).ok().filter(|_| is_asked) {
        context.commands.push(Command::CompareCalibrations(Box::new(sides)));
        state.is_fitted = true;
    }
}

/// A row with a label and a field, and what stands beside it in the middle of its height.
pub(super) fn row<R>(ui: &mut Ui, label: &str, contents: impl FnOnce(&mut Ui) -> R) -> R {
    labelled(ui, label, FIELD_HEIGHT, contents)
}

fn labelled<R>(ui: &mut Ui, label: &str, height: f32, contents: impl FnOnce(&mut Ui) -> R) -> R {
    let layout = Layout::left_to_right(Align::Center);
    ui.allocate_ui_with_layout(vec2(ui.available_width(), height), layout, |ui| {
        let (rect, _) = ui.allocate_exact_size(vec2(LABEL_WIDTH, height), Sense::hover());
        let mut left = ui.new_child(UiBuilder::new().max_rect(rect).layout(layout));
        left.label(theme::dim(&left, label));
        contents(ui)
    })
    .inner
}

/// A field for a path; whether Enter was pressed in it.
pub(super) fn path_field(ui: &mut Ui, name: &str, hint: &str, text: &mut String, width: f32) -> bool {
    let edit = TextEdit::singleline(text).hint_text(hint).margin(vec2(8.0, 5.0)).desired_width(width);
    let field = ui.add(edit);
    widgets::name_field(&field, name, text);
    field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter))
}

/// A button whose name says more than its words.
pub(super) fn choose_button(ui: &mut Ui, name: &str) -> bool {
    let button = ui.add_sized(vec2(BUTTON_WIDTH, 28.0), Button::new(words::CHOOSE));
    button.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, name));
    button.on_hover_text(name).clicked()
}

/// The row of a side; whether Enter was pressed.
fn side(
    ui: &mut Ui,
    context: &mut PanelContext<'_>,
    state: &mut CompareResultsState,
    idx: usize,
    has_session: bool,
) -> bool {
    row(ui, [words::FROM, words::TO][idx], |ui| {
        let mut is_session = has_session && state.session_idx == Some(idx);
        let width = ui.available_width() - SWITCH_WIDTH - BUTTON_WIDTH - 2.0 * ui.spacing().item_spacing.x;
        let mut is_entered = false;
        ui.add_enabled_ui(!is_session, |ui| {
            let mut shown = if is_session { words::OPEN_SESSION.to_owned() } else { state.paths[idx].clone() };
            is_entered = path_field(ui, words::SIDE_FIELDS[idx], words::SIDE_EXAMPLE, &mut shown, width - 16.0);
            if !is_session {
                state.paths[idx] = shown;
            }
        });
        if choose_button(ui, words::CHOOSE_SIDES[idx]) {
            context.actions.push(Action::ChooseCompared(idx));
        }
        let switch = ui.add_enabled(has_session, egui::Checkbox::new(&mut is_session, words::OPEN_SESSION));
        switch.widget_info(|| {
            egui::WidgetInfo::selected(egui::Role::CheckBox, has_session, is_session, words::SIDE_SESSIONS[idx])
        });
        if switch.on_disabled_hover_text(words::NO_SESSION_OPEN).changed() {
            state.session_idx = is_session.then_some(idx);
        }
        is_entered
    })
}

/// The row of the points, with the button; whether it was pressed.
fn points(ui: &mut Ui, context: &mut PanelContext<'_>, state: &mut CompareResultsState, has_session: bool) -> bool {
    let study = context.workbench.comparison();
    row(ui, words::POINTS, |ui| {
        let width = ui.available_width() - SWITCH_WIDTH - BUTTON_WIDTH - 2.0 * ui.spacing().item_spacing.x;
        let mut is_asked = path_field(ui, words::POINTS_FIELD, words::POINTS_EXAMPLE, &mut state.points, width - 16.0);
        let sides = state.sides(has_session);
        ui.add_enabled_ui(sides.is_ok(), |ui| {
            let button = widgets::primary_button(ui, words::COMPARE_BUTTON);
            is_asked |= button.on_disabled_hover_text(sides.err().unwrap_or_default()).clicked();
        });
        if study.is_running() {
            if ui.button(words::STOP).clicked() {
                context.commands.push(Command::CancelComparison);
            }
            ui.spinner();
        }
        is_asked
    })
}

fn table(ui: &mut Ui, comparison: &Comparison, is_old: bool) {
    let right = |ui: &mut Ui| {
        let warn = theme::palette(ui).warn;
        if is_old {
            ui.label(RichText::new(words::OUT_OF_DATE).color(warn).small());
        } else {
            ui.label(theme::dim(ui, words::BARS_ARE_STD.trim_start_matches("bars: ")).small());
        }
    };
    widgets::card(ui, words::DIFFERENCE, right, |ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        Frame::new().inner_margin(Margin { left: 12, right: 12, top: 6, bottom: 4 }).show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = 2.0;
            for (label, calibration) in [(words::TO, &comparison.to), (words::FROM, &comparison.from)] {
                let date = calibration.date().map_or_else(String::new, |date| format!(" · {date}"));
                labelled(ui, label, 20.0, |ui| {
                    ui.add(egui::Label::new(format!("{}{date}", calibration.name)).truncate());
                });
            }
            for remark in remarks(comparison) {
                marked(ui, "!", theme::palette(ui).warn, &remark);
            }
        });
        rows(ui, comparison);
        verdicts(ui, comparison);
    });
}

/// A sentence with a sign before it.
pub(super) fn marked(ui: &mut Ui, sign: &str, color: Color32, sentence: &str) {
    ui.horizontal_top(|ui| {
        ui.add_sized(vec2(14.0, 18.0), egui::Label::new(RichText::new(sign).color(color)));
        ui.add(egui::Label::new(sentence).wrap());
    });
}

fn rows(ui: &mut Ui, comparison: &Comparison) {
    let width = ui.available_width();
    let is_wide = width >= ONE_LINE_FROM;
    let mut widths = if is_wide { PARTS } else { NARROW_PARTS }.map(|part| part * width);
    // As far from the border as the title.
    widths[4] -= 6.0;
    let mut head = RowCells::new(ui, theme::ROW_HEIGHT);
    for (idx, (width, name)) in widths.iter().zip(words::DIFFERENCE_COLUMNS).enumerate() {
        head.head(*width, name, if idx == 0 { Align2::LEFT_CENTER } else { Align2::RIGHT_CENTER });
    }
    let difference = &comparison.difference;
    let degrees = |v: Vec3| v.map(f64::to_degrees);
    let mut line = |label: &str, value: Vec3, std: Option<Vec3>, decimals: usize| {
        let mut cells = RowCells::new(ui, if is_wide { theme::ROW_HEIGHT } else { 38.0 });
        cells.next(6.0);
        cells.text(widths[0] - 6.0, label);
        for axis in 0..3 {
            let text = words::with_std(value[axis], std.map(|std| std[axis]), decimals).replace('-', "−");
            with_std(&mut cells, widths[1 + axis], &text, is_wide);
        }
        let color = theme::palette(cells.ui()).text;
        cells.word(widths[4], &format!("{:.decimals$}", value.norm()), color);
    };
    line(words::TRANSLATION, difference.translation_mm, difference.translation_std_mm, 4);
    line(words::ROTATION, degrees(difference.rotation_rad), difference.rotation_std_rad.map(degrees), 5);
    if let Some(shift) = &comparison.points.reference {
        line(words::REFERENCE_ROW, shift.shift_mm, shift.std_mm, 4);
    }
    for shift in &comparison.points.given {
        line(&words::point_row(shift.point_in_sensor_mm), shift.shift_mm, shift.std_mm, 4);
    }
}

/// A value with its σ, in two lines where there is little room.
fn with_std(cells: &mut RowCells<'_>, width: f32, text: &str, is_wide: bool) {
    let color = theme::palette(cells.ui()).text;
    let Some((value, std)) = text.split_once(" ± ").filter(|_| !is_wide) else {
        cells.word(width, text, color);
        return;
    };
    let cell = cells.next(width);
    let dim = theme::palette(cells.ui()).text_dim;
    let painter = cells.ui().painter().clone();
    for (offset, text, color) in [(-8.0, value.to_owned(), color), (8.0, format!("± {std}"), dim)] {
        let at = cell.right_center() + vec2(-6.0, offset);
        painter.text(at, Align2::RIGHT_CENTER, text, theme::number_font(), color);
    }
    cells.name(cell, text, None);
}

/// What of it chance explains, in words.
fn verdicts(ui: &mut Ui, comparison: &Comparison) {
    let known = comparison.difference.known;
    let palette = *theme::palette(ui);
    let sign = |p_value: Option<f64>| match p_value {
        Some(p) if p < SIGNIFICANT_P => ("!", palette.warn),
        Some(_) => ("✔", palette.good),
        None => ("–", palette.text_dim),
    };
    Frame::new().inner_margin(Margin { left: 12, right: 12, top: 8, bottom: 8 }).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 2.0;
        let mut verdict = |what: &str, p_value: Option<f64>| {
            let (sign, color) = sign(p_value);
            marked(ui, sign, color, &words::verdict_on(what, &words::significance(p_value, known)));
        };
        verdict(words::AS_A_WHOLE, comparison.difference.p_value);
        if let Some(shift) = &comparison.points.reference {
            verdict(words::REFERENCE_POINT, shift.p_value);
        }
        for shift in &comparison.points.given {
            verdict(&words::point_place(shift.point_in_sensor_mm), shift.p_value);
        }
        if let Some((mean_mm, max_mm)) = comparison.points.measured_mm() {
            let sentence = words::measured_line(comparison.points.measured.len(), mean_mm, max_mm);
            marked(ui, "·", palette.text_dim, &sentence);
        }
    });
}

/// A place in the plot: what it is called, how far it is, and σ.
type Place = (String, Vec3, Option<Vec3>);

fn plot(ui: &mut Ui, comparison: &Comparison, is_fitted: &mut bool) {
    let difference = &comparison.difference;
    let origin = (words::TRANSLATION_PLACE.to_owned(), difference.translation_mm, difference.translation_std_mm);
    let reference = comparison.points.reference.as_ref();
    let mut places: Vec<Place> = vec![origin];
    places.extend(reference.map(|shift| (words::REFERENCE_POINT.to_owned(), shift.shift_mm, shift.std_mm)));
    let given = comparison.points.given.iter();
    places.extend(given.map(|shift| (words::point_place(shift.point_in_sensor_mm), shift.shift_mm, shift.std_mm)));
    let left_over = ui.clip_rect().bottom() - ui.cursor().top() - 4.0;
    let height = left_over.clamp(LEAST_PLOT_HEIGHT, MOST_PLOT_HEIGHT);
    widgets::card_with_height(
        ui,
        words::DIFFERENCE_PLOT,
        height,
        |ui| {
            ui.label(theme::dim(ui, words::BARS_ARE_STD).small());
        },
        |ui| saveable(ui, words::DIFFERENCE_PLOT, |ui| differences(ui, &places, is_fitted)),
    );
}

fn differences(ui: &mut Ui, places: &[Place], is_fitted: &mut bool) {
    let colors = theme::axis_colors(ui);
    let entry = |axis: usize| LegendEntry {
        glyph: LegendGlyph::Solid(AXIS_MARKERS[axis]),
        color: colors[axis],
        text: ["x", "y", "z"][axis].to_owned(),
    };
    charts::legend(ui, &[0, 1, 2].map(entry));
    let names: Vec<String> = places.iter().map(|(name, ..)| name.clone()).collect();
    let at = |idx: usize| f64::from(u32::try_from(idx).unwrap_or(u32::MAX));
    let mut extent = Extent { x: [-0.5, at(places.len()) - 0.5], y: [-1e-3, 1e-3] };
    for (_, shift, std) in places {
        for axis in 0..3 {
            let std = std.map_or(0.0, |std| std[axis]);
            extent.include(0.0, shift[axis] - std);
            extent.include(0.0, shift[axis] + std);
        }
    }
    let height = ui.available_height();
    let mut chart = Chart::new(Id::unique("difference of results"), "", words::DIFFERENCE_AXIS, height, extent);
    chart.x_names = Some(&names);
    let canvas = chart.show(ui, is_fitted);
    let palette = theme::palette(ui);
    let zero = canvas.at(0.0, 0.0).y;
    canvas.painter.hline(canvas.rect().x_range(), zero, Stroke::new(1.0, palette.text_dim.gamma_multiply(0.6)));
    let mut marks = Vec::new();
    for (idx, (name, shift, std)) in places.iter().enumerate() {
        for axis in 0..3 {
            let x = BETWEEN_AXES.mul_add(at(axis) - 1.0, at(idx));
            if let Some(std) = std {
                let ends = [shift[axis] - std[axis], shift[axis] + std[axis]].map(|y| canvas.at(x, y));
                charts::error_bar(&canvas.painter, ends[1], ends[0], Stroke::new(1.2, colors[axis]));
            }
            let centre = canvas.at(x, shift[axis]);
            charts::marker(&canvas.painter, AXIS_MARKERS[axis], centre, 4.5, colors[axis], Stroke::NONE);
            let std = std.map(|std| std[axis]);
            marks.push(((name, ["x", "y", "z"][axis], shift[axis], std), [x, shift[axis]]));
        }
    }
    if let Some((name, axis, value, std)) = canvas.hovered(marks) {
        let note = words::difference_readout(name, axis, &words::with_std(value, std, 4).replace('-', "−"));
        let pointer = canvas.response.hover_pos().unwrap_or_default() - vec2(0.0, 12.0);
        canvas.note(ui, pointer, Align2::CENTER_BOTTOM, &note, palette.text);
    }
}
