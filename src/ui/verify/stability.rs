//! A known point measured many times with every calibration at hand, and the calibrations side by side.

use egui::{
    Align, Align2, Button, Color32, Frame, Layout, Margin, ScrollArea, Stroke, TextEdit, Ui, UiBuilder, WidgetInfo,
    vec2,
};

use crate::app::Command;
use crate::geometry::Vec3;
use crate::session::{Edit, Known};
use crate::text::verify as words;
use crate::ui::actions::Action;
use crate::ui::compare::table::RowCells;
use crate::ui::{PanelContext, theme, widgets};
use crate::verify::{Measurement, Stability, TargetEvidence};

use super::distances::nothing_yet;
use super::marks::Mark;
use super::matrices::{self, MatricesState};
use super::panel::View;

/// Width of the column of labels, points.
const LABEL_WIDTH: f32 = 112.0;
/// Least width of a coordinate, points: a third of the longest name of a method.
const LEAST_WIDTH: f32 = 72.0;
/// Width of a field for a coordinate, points.
const FIELD_WIDTH: f32 = 84.0;

/// What the section remembers between frames.
#[derive(Debug, Default)]
pub(super) struct StabilityState {
    /// The target in sight, by its place among the balls and tips.
    target: usize,
    /// Calibrations that are not shown, by their names.
    hidden: Vec<String>,
    typed: Typed,
    matrices: MatricesState,
}

/// The touched point as it is being typed.
#[derive(Debug, Default)]
struct Typed {
    /// What the session said when the texts were last filled in, and of which target.
    base: Option<(Option<usize>, Option<Vec3>)>,
    texts: [String; 3],
}

impl Typed {
    fn follow(&mut self, further_idx: Option<usize>, known: Option<Vec3>) {
        if self.base != Some((further_idx, known)) {
            self.base = Some((further_idx, known));
            self.texts =
                known.map_or_else(Default::default, |point| [point.x, point.y, point.z].map(|v| v.to_string()));
        }
    }

    fn point(&self) -> Option<Vec3> {
        let read = |text: &String| {
            let plain = text.trim().replace('\u{2212}', "-");
            plain.parse::<f64>().ok().filter(|value| value.is_finite())
        };
        let [x, y, z] = &self.texts;
        Some(Vec3::new(read(x)?, read(y)?, read(z)?))
    }
}

/// Shows the section.
pub(super) fn show(ui: &mut Ui, view: &View<'_>, context: &mut PanelContext<'_>, state: &mut StabilityState) {
    let places: Vec<usize> = (0..view.verification.targets.len())
        .filter(|idx| !matches!(view.verification.targets[*idx].problem, crate::calibrate::Problem::Plate(_)))
        .collect();
    if places.is_empty() && view.marks.is_empty() {
        nothing_yet(ui, words::NO_PLACE, context);
    } else if places.is_empty() {
        let body = |ui: &mut Ui| {
            hint(ui, words::NO_PLACE);
            Frame::new().inner_margin(Margin { left: 16, right: 16, top: 0, bottom: 16 }).show(ui, |ui| {
                if ui.button(words::ADD_TARGET).on_hover_text(words::ADD_TARGET_HINT).clicked() {
                    context.actions.push(Action::AddFurther);
                }
            });
        };
        widgets::card(ui, words::STABILITY_TABLE, |_| {}, body);
    } else {
        state.target = state.target.min(places.len() - 1);
        let target_idx = places[state.target];
        let target = &view.verification.targets[target_idx];
        controls(ui, view, &places, target, context, state);
        table(ui, view, target, state);
    }
    matrices::show(ui, view, context, &mut state.matrices);
}

fn hint(ui: &mut Ui, sentence: &str) {
    Frame::new().inner_margin(Margin::same(16)).show(ui, |ui| ui.label(theme::dim(ui, sentence)));
}

/// Which target, which calibrations, and where its point was touched.
fn controls(
    ui: &mut Ui,
    view: &View<'_>,
    places: &[usize],
    target: &TargetEvidence,
    context: &mut PanelContext<'_>,
    state: &mut StabilityState,
) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(5.0, 6.0);
        if places.len() > 1 {
            for (place, target_idx) in places.iter().enumerate() {
                let name = &view.verification.targets[*target_idx].name;
                if ui.selectable_label(state.target == place, name).clicked() {
                    state.target = place;
                }
            }
            ui.add_space(8.0);
        }
        touched_fields(ui, target, context, &mut state.typed);
    });
    if view.marks.len() > 2 {
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing = vec2(5.0, 6.0);
            ui.spacing_mut().button_padding.x = 8.0;
            for mark in &view.marks {
                let is_shown = !state.hidden.contains(&mark.name);
                let button = ui.add(Button::new(&mark.name).selected(is_shown));
                button.widget_info(|| {
                    WidgetInfo::selected(egui::Role::Button, true, is_shown, words::show_column(&mark.name))
                });
                if button.clicked() {
                    if is_shown {
                        state.hidden.push(mark.name.clone());
                    } else {
                        state.hidden.retain(|name| *name != mark.name);
                    }
                }
            }
        });
    }
}

fn touched_fields(ui: &mut Ui, target: &TargetEvidence, context: &mut PanelContext<'_>, typed: &mut Typed) {
    let Some(document) = context.workbench.document() else { return };
    let session = &document.session;
    let known = match target.further_idx {
        None => session.known,
        Some(further_idx) => session.further.get(further_idx).map_or_else(Known::default, |further| further.known),
    };
    typed.follow(target.further_idx, known.point_in_base_mm);
    ui.label(theme::dim(ui, words::TOUCHED)).on_hover_text(words::TOUCHED_HINT);
    for (text, axis) in typed.texts.iter_mut().zip(["x", "y", "z"]) {
        let edit = TextEdit::singleline(text)
            .hint_text(axis)
            .font(theme::number_font())
            .align(Align2::RIGHT_CENTER)
            .margin(vec2(8.0, 5.0))
            .desired_width(FIELD_WIDTH);
        let field = ui.add(edit);
        widgets::name_field(&field, &words::touched_axis(axis), text);
    }
    ui.label(theme::dim(ui, "mm"));
    let mut edit = |point_in_base_mm: Option<Vec3>| {
        let known = Known { point_in_base_mm, ..known };
        let edit = match target.further_idx {
            None => Edit::SetKnown(known),
            Some(further_idx) => Edit::SetFurtherKnown(further_idx, known),
        };
        context.commands.push(Command::Edit { edit, gesture: None });
    };
    let point = typed.point();
    let can_set = point.is_some() && point != known.point_in_base_mm;
    let set = ui.add_enabled(can_set, Button::new(words::SET_TOUCHED));
    if set.on_disabled_hover_text(words::TOUCHED_MISSING).clicked() {
        edit(point);
    }
    if known.point_in_base_mm.is_some() && ui.button(words::CLEAR_TOUCHED).clicked() {
        edit(None);
    }
}

/// A calibration with its measurements.
struct Column<'a> {
    mark: &'a Mark,
    stability: &'a Stability,
}

fn table(ui: &mut Ui, view: &View<'_>, target: &TargetEvidence, state: &StabilityState) {
    let mut rows: &[Measurement] = &[];
    let mut columns = Vec::new();
    let mut refusal = None;
    for (outcome, mark) in target.rows.iter().zip(&view.marks) {
        match outcome {
            Ok(evaluation) => {
                if let Some((measurements, stability)) = evaluation.stability() {
                    rows = measurements;
                    columns.push(Column { mark, stability });
                }
            }
            Err(reason) => refusal = Some(reason.to_string()),
        }
    }
    columns.retain(|column| !state.hidden.contains(&column.mark.name));
    let is_touched = columns.first().is_some_and(|column| column.stability.is_touched);
    let right = |ui: &mut Ui| {
        ui.label(theme::dim(ui, if is_touched { words::FROM_TOUCHED } else { words::FROM_MEAN }));
    };
    widgets::card(ui, words::STABILITY_TABLE, right, |ui| {
        if columns.is_empty() {
            let nothing = if view.marks.is_empty() { words::NO_CALIBRATION } else { words::NO_COLUMN };
            hint(ui, refusal.as_deref().unwrap_or(nothing));
            return;
        }
        // The labels stay in sight while the figures of many calibrations are scrolled.
        let area = ui.available_rect_before_wrap();
        let (left, right) = area.split_left_right_at_x(area.left() + LABEL_WIDTH);
        let mut left = ui.new_child(UiBuilder::new().max_rect(left));
        labels(&mut left, &columns, rows);
        let mut right = ui.new_child(UiBuilder::new().max_rect(right));
        #[expect(clippy::cast_precision_loss, reason = "a handful of columns")]
        let width = right.available_width().max(LEAST_WIDTH * 3.0 * columns.len() as f32);
        ScrollArea::horizontal().id_salt("stability").auto_shrink([false, true]).show(&mut right, |ui| {
            ui.set_width(width);
            figures(ui, &columns, rows);
        });
        ui.advance_cursor_after_rect(left.min_rect().union(right.min_rect()));
    });
}

/// Height of the head with the axes: a little lower than that with the calibrations.
const AXES_HEIGHT: f32 = theme::ROW_HEIGHT - 2.0;

/// The rows below the measurements: label, value, and whether it has a sign.
type Foot = (&'static str, fn(&Stability) -> Vec3, bool);

fn feet(columns: &[Column<'_>]) -> Vec<Foot> {
    let mean: Foot = (words::MEAN, |stability| stability.mean_mm, true);
    let three_delta: Foot = (words::THREE_DELTA, Stability::three_std_mm, false);
    let is_touched = columns.iter().any(|column| column.stability.is_touched);
    is_touched.then_some(mean).into_iter().chain([three_delta]).collect()
}

/// The ground of a row below the measurements.
fn foot_ground(ui: &Ui) {
    let rect = egui::Rect::from_min_size(ui.cursor().min, vec2(ui.available_width(), theme::ROW_HEIGHT));
    ui.painter().rect_filled(rect, 0.0, theme::palette(ui).hovered);
}

/// The column of labels.
fn labels(ui: &mut Ui, columns: &[Column<'_>], rows: &[Measurement]) {
    ui.spacing_mut().item_spacing.y = 0.0;
    RowCells::new(ui, theme::ROW_HEIGHT);
    RowCells::new(ui, AXES_HEIGHT).head(LABEL_WIDTH, words::NUMBER, Align2::LEFT_CENTER);
    for measurement in rows {
        RowCells::new(ui, theme::ROW_HEIGHT).text(LABEL_WIDTH, &measurement.name());
    }
    for (label, ..) in feet(columns) {
        foot_ground(ui);
        RowCells::new(ui, theme::ROW_HEIGHT).text(LABEL_WIDTH, label);
    }
    RowCells::new(ui, theme::ROW_HEIGHT).text(LABEL_WIDTH, words::THREE_DELTA_3D);
}

/// Three columns of figures a calibration.
fn figures(ui: &mut Ui, columns: &[Column<'_>], rows: &[Measurement]) {
    ui.spacing_mut().item_spacing.y = 0.0;
    #[expect(clippy::cast_precision_loss, reason = "a handful of columns")]
    let width = ui.available_width() / (3.0 * columns.len() as f32);
    let top = ui.cursor().top();
    let mut head = RowCells::new(ui, theme::ROW_HEIGHT);
    for column in columns {
        let cell = head.next(3.0 * width);
        let ui = head.ui();
        column.mark.paint_in(ui, cell, theme::palette(ui).text);
        head.name(cell, &column.mark.name, None);
    }
    let mut head = RowCells::new(ui, AXES_HEIGHT);
    for _ in columns {
        for axis in ["Δx / mm", "Δy / mm", "Δz / mm"] {
            head.head(width, axis, Align2::RIGHT_CENTER);
        }
    }
    for idx in 0..rows.len() {
        let mut cells = RowCells::new(ui, theme::ROW_HEIGHT);
        for column in columns {
            let deviation = column.stability.deviations_mm.get(idx).copied().unwrap_or_else(Vec3::zeros);
            vector(&mut cells, width, deviation, true);
        }
    }
    for (_, value, is_signed) in feet(columns) {
        foot_ground(ui);
        let mut cells = RowCells::new(ui, theme::ROW_HEIGHT);
        for column in columns {
            vector(&mut cells, width, value(column.stability), is_signed);
        }
    }
    let mut cells = RowCells::new(ui, theme::ROW_HEIGHT);
    for column in columns {
        cells.next(2.0 * width);
        let value = column.stability.three_std_3d_mm();
        cells.number(width, value, &widgets::fixed(value, 3), Color32::TRANSPARENT);
    }
    // A hairline before each calibration.
    let (left, bottom) = (ui.min_rect().left(), ui.cursor().top());
    let stroke = Stroke::new(1.0, theme::palette(ui).hairline);
    for number in 0..columns.len() {
        #[expect(clippy::cast_precision_loss, reason = "a handful of columns")]
        let x = left + 3.0 * width * number as f32;
        ui.painter().vline(x, top..=bottom, stroke);
    }
}

fn vector(cells: &mut RowCells<'_>, width: f32, value: Vec3, is_signed: bool) {
    for axis in 0..3 {
        let number = value[axis];
        let text = if is_signed { widgets::signed(number, 3) } else { widgets::fixed(number, 3) };
        cells.number(width, number, &text, Color32::TRANSPARENT);
    }
}

/// A row whose parts stand at the left, one row high.
pub(super) fn row(ui: &mut Ui, contents: impl FnOnce(&mut Ui)) {
    ui.allocate_ui_with_layout(
        vec2(ui.available_width(), theme::ROW_HEIGHT),
        Layout::left_to_right(Align::Center),
        contents,
    );
}
