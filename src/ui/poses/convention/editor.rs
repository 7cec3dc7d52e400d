//! The form in which a notation is put together.

use egui::{Button, ComboBox, DragValue, Grid, Ui, WidgetInfo};

use crate::geometry::notation::{AngleUnit, LengthUnit, OrientationForm};
use crate::geometry::{AngleOrder, PoseConvention, PoseNotation};
use crate::session::table::number::parse_number;
use crate::text::conventions as words;
use crate::ui::theme;

use super::model::Draft;
use super::picker::{self, Search};

/// Room for the names of the rows, points.
const NAMES_WIDTH: f32 = 84.0;
/// Room for the name of a convention, points.
const MAX_NAME_WIDTH: f32 = 180.0;
/// A tool is no longer than this, mm.
const MAX_TOOL_MM: f64 = 1e4;

/// Shows the form. Where the numbers are given, only notations of `num_numbers` numbers can be chosen.
pub fn show(ui: &mut Ui, draft: &mut Draft, num_numbers: Option<usize>, search: &mut Search) {
    Grid::new("notation").num_columns(2).min_col_width(NAMES_WIDTH).spacing([12.0, 4.0]).show(ui, |ui| {
        orientation(ui, draft, num_numbers);
        if draft.without_tool().orientation == OrientationForm::Angles || draft.has_tool_point {
            convention(ui, draft, search);
        }
        units(ui, draft);
        frame(ui, draft);
    });
}

fn row(ui: &mut Ui, name: &str, contents: impl FnOnce(&mut Ui)) {
    ui.label(theme::dim(ui, name));
    ui.horizontal(|ui| {
        ui.spacing_mut().button_padding.x = 8.0;
        ui.spacing_mut().item_spacing.x = 4.0;
        contents(ui);
    });
    ui.end_row();
}

/// One of a few; named after its row as well, as the same word may stand in two.
fn choice(ui: &mut Ui, row: &str, name: &str, is_chosen: bool) -> egui::Response {
    let response = ui.add(Button::selectable(is_chosen, name));
    let full_name = words::choice_name(row, name);
    response.widget_info(|| WidgetInfo::selected(egui::Role::RadioButton, ui.is_enabled(), is_chosen, &full_name));
    response
}

fn orientation(ui: &mut Ui, draft: &mut Draft, num_numbers: Option<usize>) {
    let notation = *draft.without_tool();
    row(ui, words::ORIENTATION, |ui| {
        for form in [OrientationForm::Angles, OrientationForm::QuaternionWxyz, OrientationForm::QuaternionXyzw] {
            let changed = PoseNotation { orientation: form, ..notation };
            let is_possible = num_numbers.is_none_or(|count| count == changed.num_numbers());
            ui.add_enabled_ui(is_possible, |ui| {
                let name = words::orientation_form(form);
                let response = choice(ui, words::ORIENTATION, name, notation.orientation == form);
                if response.on_disabled_hover_text(words::OTHER_COUNT).clicked() {
                    draft.set(changed);
                }
            });
        }
    });
}

fn convention(ui: &mut Ui, draft: &mut Draft, search: &mut Search) {
    let notation = *draft.without_tool();
    let angles = PoseNotation { orientation: OrientationForm::Angles, ..notation };
    row(ui, words::ANGLES_OF, |ui| {
        if let Some(chosen) = picker::show(ui, words::ANGLES_OF, MAX_NAME_WIDTH, &angles, false, search) {
            // The units are chosen in their own rows.
            draft.set(PoseNotation { convention: chosen.convention, ..notation });
        }
        ui.label(theme::dim(ui, notation.convention.formula).size(theme::SMALL_SIZE));
    });
    row(ui, words::ORDER, |ui| {
        let order = notation.convention.order;
        let mut chosen = order;
        let combo = ComboBox::from_id_salt("order of axes")
            .width(108.0)
            .selected_text(words::axes_name(order))
            .show_ui(ui, |ui| {
                for other in orders_turning_like(order) {
                    ui.selectable_value(&mut chosen, other, words::axes_name(other));
                }
            })
            .response;
        combo.widget_info(|| WidgetInfo::labeled(egui::Role::ComboBox, true, words::ORDER));
        if let AngleOrder::Intrinsic(axes) | AngleOrder::Extrinsic(axes) = order {
            for (name, other) in
                [(words::FIXED_AXES, AngleOrder::Extrinsic(axes)), (words::MOVING_AXES, AngleOrder::Intrinsic(axes))]
            {
                if choice(ui, words::AXES, name, order == other).clicked() {
                    chosen = other;
                }
            }
        }
        if chosen != order {
            draft.set(PoseNotation { convention: PoseConvention::neutral(chosen), ..notation });
        }
    });
}

/// The orders about fixed axes, or those about moving ones, and the rotation vector.
fn orders_turning_like(order: AngleOrder) -> impl Iterator<Item = AngleOrder> {
    let is_intrinsic = matches!(order, AngleOrder::Intrinsic(_));
    AngleOrder::ALL.into_iter().filter(move |other| match other {
        AngleOrder::Intrinsic(_) => is_intrinsic,
        AngleOrder::Extrinsic(_) => !is_intrinsic,
        AngleOrder::RotationVector => true,
    })
}

fn units(ui: &mut Ui, draft: &mut Draft) {
    let notation = *draft.without_tool();
    row(ui, words::ANGLE_UNIT, |ui| {
        for unit in [AngleUnit::Degrees, AngleUnit::Radians] {
            if choice(ui, words::ANGLE_UNIT, words::angle_unit(unit), notation.angle_unit == unit).clicked() {
                draft.set(PoseNotation { angle_unit: unit, ..notation });
            }
        }
    });
    row(ui, words::LENGTH_UNIT, |ui| {
        for unit in [LengthUnit::Millimetres, LengthUnit::Metres] {
            if choice(ui, words::LENGTH_UNIT, words::length_unit(unit), notation.length_unit == unit).clicked() {
                draft.set(PoseNotation { length_unit: unit, ..notation });
            }
        }
    });
}

fn frame(ui: &mut Ui, draft: &mut Draft) {
    row(ui, words::FRAME, |ui| {
        for (name, has_tool_point) in [(words::FLANGE, false), (words::TOOL_POINT, true)] {
            if choice(ui, words::FRAME, name, draft.has_tool_point == has_tool_point).clicked() {
                draft.has_tool_point = has_tool_point;
            }
        }
    });
    if draft.has_tool_point {
        let notation = *draft.without_tool();
        let (length, angle) = (notation.length_unit, notation.angle_unit);
        let names = ["x", "y", "z"].into_iter().chain(notation.convention.angle_names);
        let mut fields = names.zip(&mut draft.tool_numbers).enumerate();
        for (row_name, count) in [(words::TOOL_IN_FLANGE, 3), ("", 3)] {
            row(ui, row_name, |ui| {
                for (idx, (name, number)) in fields.by_ref().take(count) {
                    let field = if idx < 3 {
                        let limit = MAX_TOOL_MM / length.in_mm();
                        DragValue::new(number)
                            .range(-limit..=limit)
                            .speed(1.0 / length.in_mm())
                            .suffix(format!(" {}", length.symbol()))
                    } else {
                        let limit = 360.0 / angle.in_degrees();
                        let suffix =
                            if angle == AngleUnit::Degrees { "°".to_owned() } else { format!(" {}", angle.symbol()) };
                        DragValue::new(number).range(-limit..=limit).speed(0.5 / angle.in_degrees()).suffix(suffix)
                    };
                    ui.label(theme::dim(ui, name));
                    let field = ui.add(field.max_decimals(6).custom_parser(|text| parse_number(text).ok()));
                    field.widget_info(|| WidgetInfo::labeled(egui::Role::SpinButton, true, words::tool_number(name)));
                }
            });
        }
    }
    let notation = *draft.without_tool();
    row(ui, words::DIRECTION, |ui| {
        for (name, is_inverse) in [(words::NOT_INVERSE, false), (words::INVERSE, true)] {
            if choice(ui, words::DIRECTION, name, notation.is_inverse == is_inverse).clicked() {
                draft.set(PoseNotation { is_inverse, ..notation });
            }
        }
    });
}
