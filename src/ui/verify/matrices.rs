//! Two calibrations as matrices beside each other with their difference, and a matrix from elsewhere: whether it is one.

use egui::{Align2, Button, ComboBox, Frame, Margin, Rect, RichText, Sense, TextEdit, Ui, UiBuilder, WidgetInfo, vec2};
use nalgebra::Matrix4;

use crate::app::Command;
use crate::geometry::{Flange, Sensor, Transform};
use crate::text::typeset::std_text;
use crate::text::verify as words;
use crate::ui::compare::table::RowCells;
use crate::ui::{PanelContext, theme, widgets};
use crate::verify::{Calibration, GivenMatrix, MatrixCheck, MatrixDifference, MatrixRefusal, Origin, parse_matrix};

use super::panel::View;

/// Room between the two matrices, points.
const BETWEEN: f32 = 24.0;
/// Width of a matrix from which its rotation has room for five decimals, points.
const LEAST_FOR_FIVE: f32 = 300.0;
/// Height of the card for a matrix from elsewhere, points.
const PASTE_HEIGHT: f32 = 316.0;
/// Rows of its field.
const FIELD_ROWS: usize = 4;

/// What the cards remember between frames.
#[derive(Debug, Default)]
pub(super) struct MatricesState {
    /// The two in sight, by their names.
    chosen: [Option<String>; 2],
    pasted: String,
    name: String,
    read: Option<Result<(GivenMatrix, MatrixCheck), MatrixRefusal>>,
}

/// Shows both cards.
pub(super) fn show(ui: &mut Ui, view: &View<'_>, context: &mut PanelContext<'_>, state: &mut MatricesState) {
    side_by_side(ui, view, &mut state.chosen);
    pasted(ui, context, state);
}

fn side_by_side(ui: &mut Ui, view: &View<'_>, chosen: &mut [Option<String>; 2]) {
    let calibrations = &view.verification.calibrations;
    if calibrations.len() < 2 {
        return;
    }
    let place = |name: &Option<String>, otherwise: usize| {
        view.marks.iter().position(|mark| Some(&mark.name) == name.as_ref()).unwrap_or(otherwise)
    };
    // The published method beside the one to use, which is the last of its target.
    let of_first = |calibration: &Calibration| matches!(calibration.origin, Origin::Solved { target_idx: 0, .. });
    let last = calibrations.iter().rposition(of_first).unwrap_or(0).max(1);
    let places = [place(&chosen[0], 0), place(&chosen[1], last)];
    widgets::card(
        ui,
        words::MATRICES,
        |_| {},
        |ui| {
            ui.spacing_mut().item_spacing.y = 0.0;
            ui.add_space(6.0);
            let width = ui.available_width();
            let half = (width - BETWEEN) / 2.0;
            let (rect, _) = ui.allocate_exact_size(vec2(width, theme::ROW_HEIGHT + 8.0), Sense::hover());
            for (side, (place, name)) in places.into_iter().zip(chosen.iter_mut()).enumerate() {
                let left = if side == 0 { rect.left() } else { rect.left() + half + BETWEEN };
                let cell = Rect::from_min_size(egui::pos2(left, rect.top()), vec2(half, rect.height()));
                let mut inside = ui.new_child(UiBuilder::new().max_rect(cell.shrink2(vec2(12.0, 2.0))));
                view.marks[place].paint(inside.painter(), cell.left_center() + vec2(18.0, 0.0));
                inside.add_space(0.0);
                inside.horizontal(|ui| {
                    ui.add_space(18.0);
                    let combo = ComboBox::from_id_salt(("matrix", side))
                        .selected_text(&view.marks[place].name)
                        .width(half - 80.0);
                    let shown = combo.show_ui(ui, |ui| {
                        for (idx, mark) in view.marks.iter().enumerate() {
                            if ui.selectable_label(idx == place, &mark.name).clicked() {
                                *name = Some(mark.name.clone());
                            }
                        }
                    });
                    shown
                        .response
                        .widget_info(|| WidgetInfo::labeled(egui::Role::ComboBox, true, words::MATRIX_CHOICE[side]));
                });
            }
            let matrices = places.map(|place| calibrations[place].flange_from_sensor.matrix());
            for line in 0..4 {
                let mut row = RowCells::new(ui, theme::ROW_HEIGHT);
                matrix_line(&mut row, half, &matrices[0], line);
                row.next(BETWEEN);
                matrix_line(&mut row, half, &matrices[1], line);
            }
            let point = view.verification.reference_point_in_sensor_mm();
            let [first, second] = places.map(|place| &calibrations[place].flange_from_sensor);
            let difference = MatrixDifference::between(first, second, point);
            let shift = difference.translation_mm;
            let shift = [shift.x, shift.y, shift.z].map(|value| widgets::signed(value, 3));
            let sentence = words::matrix_difference(
                &shift,
                &widgets::fixed(difference.rotation_rad.to_degrees(), 3),
                &widgets::fixed(difference.at_point_mm, 3),
                &widgets::fixed(point.z, 0),
            );
            Frame::new().inner_margin(Margin::symmetric(12, 8)).show(ui, |ui| ui.label(sentence));
        },
    );
}

fn matrix_line(row: &mut RowCells<'_>, width: f32, matrix: &Matrix4<f64>, line: usize) {
    // One hundred-thousandth is a micrometre at 100 mm from the flange; a narrow window has no room for that.
    let decimals = if width < LEAST_FOR_FIVE { 4 } else { 5 };
    for column in 0..4 {
        let value = matrix[(line, column)];
        let text = match (line, column) {
            (3, _) => widgets::fixed(value, 0),
            (_, 3) => widgets::fixed(value, 3),
            _ => widgets::fixed(value, decimals),
        };
        let color = theme::palette(row.ui()).text;
        row.word(width / 4.0, &text, color);
    }
}

fn pasted(ui: &mut Ui, context: &mut PanelContext<'_>, state: &mut MatricesState) {
    widgets::card_with_height(
        ui,
        words::PASTED,
        PASTE_HEIGHT,
        |_| {},
        |ui| {
            let area = ui.available_rect_before_wrap().shrink(theme::GAP);
            let (left, right) = area.split_left_right_at_x(area.left() + (area.width() * 0.5).round());
            let mut left = ui.new_child(UiBuilder::new().max_rect(left.with_max_x(left.right() - theme::GAP)));
            entry(&mut left, context, state);
            let mut right = ui.new_child(UiBuilder::new().max_rect(right));
            match &state.read {
                None => {
                    right.add(egui::Label::new(theme::dim(&right, words::PASTE_HINT)).wrap());
                }
                Some(Err(refusal)) => {
                    let bad = theme::palette(&right).bad;
                    right.horizontal_top(|ui| {
                        ui.label(RichText::new("✖").color(bad));
                        ui.add(egui::Label::new(refusal.to_string()).wrap());
                    });
                }
                Some(Ok((_, check))) => checked(&mut right, check),
            }
        },
    );
}

fn entry(ui: &mut Ui, context: &mut PanelContext<'_>, state: &mut MatricesState) {
    let field = TextEdit::multiline(&mut state.pasted)
        .hint_text(words::PASTE_EXAMPLE)
        .font(theme::number_font())
        .margin(vec2(8.0, 5.0))
        .desired_rows(FIELD_ROWS)
        .desired_width(f32::INFINITY);
    let field = ui.add(field);
    widgets::name_field(&field, words::PASTED_FIELD, &state.pasted);
    if field.changed() {
        let is_empty = state.pasted.trim().is_empty();
        state.read = (!is_empty).then(|| {
            parse_matrix(&state.pasted).map(|given| {
                let check = given.check();
                (given, check)
            })
        });
    }
    ui.add_space(4.0);
    let nearest: Option<Transform<Flange, Sensor>> =
        state.read.as_ref().and_then(|read| read.as_ref().ok()).and_then(|(given, _)| given.nearest());
    ui.horizontal(|ui| {
        let name = TextEdit::singleline(&mut state.name)
            .hint_text(words::GIVEN_NAME)
            .margin(vec2(8.0, 5.0))
            .desired_width(140.0);
        let field = ui.add(name);
        widgets::name_field(&field, words::GIVEN_NAME_FIELD, &state.name);
        let button = ui.add_enabled(nearest.is_some(), Button::new(words::GIVE));
        let button = button.on_hover_text(words::GIVE_HINT).on_disabled_hover_text(words::GIVE_MISSING);
        if let Some(flange_from_sensor) = nearest.filter(|_| button.clicked()) {
            let name = match state.name.trim() {
                "" => words::GIVEN_NAME.to_owned(),
                name => name.to_owned(),
            };
            let is_nearest =
                state.read.as_ref().and_then(|read| read.as_ref().ok()).is_some_and(|(_, check)| !check.is_rotation());
            let origin = Origin::Given { name, is_nearest };
            let calibration = Calibration { origin, flange_from_sensor, workspace_point_std_mm: None };
            context.commands.push(Command::GiveCalibration(Box::new(calibration)));
        }
    });
    ui.horizontal_wrapped(|ui| {
        for given in context.workbench.given_calibrations() {
            let Origin::Given { name, .. } = &given.origin else { continue };
            ui.label(name);
            if widgets::symbol_button(ui, "×", &words::withdraw(name)).clicked() {
                context.commands.push(Command::WithdrawCalibration(name.clone()));
            }
        }
    });
}

fn checked(ui: &mut Ui, check: &MatrixCheck) {
    let palette = theme::palette(ui);
    ui.spacing_mut().item_spacing.y = 0.0;
    let (sign, color) = if check.is_rotation() { ("✔", palette.good) } else { ("✖", palette.bad) };
    super::stability::row(ui, |ui| {
        ui.label(RichText::new(sign).color(color));
        ui.label(theme::strong(words::matrix_verdict(check)));
    });
    if let Some(suspects) = words::suspects_sentence(check) {
        ui.add(egui::Label::new(RichText::new(suspects).color(palette.warn)).wrap());
    }
    let decimals = words::matrix_decimals(check);
    let three = |values: [f64; 3]| values.map(|value| widgets::fixed(value, decimals)).join("   ");
    widgets::value_row(ui, words::DEFECT, words::defect(&std_text(check.defect), &std_text(check.rounding)));
    widgets::value_row(ui, words::COLUMN_LENGTHS, three(check.column_norms));
    widgets::value_row(ui, words::COLUMN_PRODUCTS, three(check.dot_products));
    widgets::value_row(ui, words::DETERMINANT, widgets::fixed(check.determinant, decimals));
    if let Some(angle) = check.angle_rad {
        widgets::value_row(ui, words::TO_NEAREST, words::matrix_angle(check, angle).replace('-', "−"));
    }
    if let Some(nearest) = &check.nearest {
        let rotation = nearest.to_rotation_matrix();
        for line in 0..3 {
            let mut row = RowCells::new(ui, theme::ROW_HEIGHT - 4.0);
            let width = row.rect().width();
            row.head(width * 0.28, if line == 0 { words::NEAREST } else { "" }, Align2::LEFT_CENTER);
            for column in 0..3 {
                let value = rotation[(line, column)];
                let color = theme::palette(row.ui()).text;
                row.word(width * 0.24, &widgets::fixed(value, decimals), color);
            }
        }
    }
}
