//! Where to measure next: poses in the robot's own convention, and the limits that they keep.

use egui::{DragValue, Frame, Margin, RichText, Role, Ui, WidgetInfo, vec2};
use egui_extras::Column;

use crate::app::Command;
use crate::diagnose::Diagnosis;
use crate::plan::{Limits, Plan};
use crate::text::diagnosis_panel as words;
use crate::text::typeset::std_text;
use crate::ui::widgets::tables::{head, number_cell, number_head, table};
use crate::ui::{theme, widgets};

use super::model::{self, View};

/// Least widths of the columns: position, angles, tilt, azimuth, spin, σ; they share what is left.
const WIDTHS: [f32; 10] = [51.0, 51.0, 51.0, 49.0, 49.0, 49.0, 40.0, 50.0, 44.0, 48.0];
/// Width of the column of numbers, and with a plate's edge behind.
const NUMBER_WIDTH: f32 = 22.0;
const EDGE_WIDTH: f32 = 38.0;
/// Free room at the right end, points.
const END_MARGIN: f32 = 6.0;
/// Decimals of a planned pose: the robot need not be there more exactly.
const DECIMALS: usize = 1;
/// Most tilt that makes sense: beyond, the laser grazes what it lights.
const MAX_TILT_DEG: f64 = 80.0;

/// Shows the card.
pub fn show(ui: &mut Ui, height: f32, view: &View<'_>, commands: &mut Vec<Command>) {
    let is_sensible = view.diagnosis.value.is_none_or(Diagnosis::allows_planning);
    let plan = view.plan.value.and_then(|plan| plan.as_ref().ok()).filter(|_| is_sensible);
    let right = |ui: &mut Ui| {
        ui.spacing_mut().interact_size.y = 22.0;
        ui.spacing_mut().button_padding = vec2(8.0, 2.0);
        if let Some(plan) = plan {
            let button = ui.button(words::COPY_TABLE).on_hover_text(words::COPY_TABLE_HINT);
            button.widget_info(|| WidgetInfo::labeled(Role::Button, true, words::COPY_TABLE_NAME));
            if button.clicked() {
                ui.ctx().copy_text(model::plan_text(plan, view.session.robot.notation.convention));
            }
        }
        if view.plan.progress.is_some() {
            ui.label(theme::dim(ui, words::PLANNING));
        } else if plan.is_some() && !view.plan.is_current {
            ui.label(RichText::new(words::OUT_OF_DATE).color(theme::palette(ui).warn));
        } else if let Some(std_mm) = plan.and_then(|plan| plan.workspace_point_std_mm) {
            ui.label(theme::dim(ui, words::now_at(&std_text(std_mm))));
        }
    };
    widgets::card_with_height(ui, words::NEXT_POSES, height, right, |ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        limits(ui, view, commands);
        if !is_sensible {
            return widgets::nothing(ui, words::NO_PLAN_YET);
        }
        match (view.plan.value, plan) {
            (_, Some(plan)) => poses(ui, view, plan),
            (Some(Err(refusal)), None) if view.solution().is_some() => widgets::nothing(ui, &refusal.to_string()),
            _ if view.plan.progress.is_some() => widgets::nothing(ui, words::PLANNING),
            _ => widgets::nothing(ui, words::NO_PLAN),
        }
    });
}

fn poses(ui: &mut Ui, view: &View<'_>, plan: &Plan) {
    let convention = view.session.robot.notation.convention;
    ui.spacing_mut().item_spacing.x = 0.0;
    let has_edges = plan.stations.iter().any(|station| station.edge.is_some());
    let first_width = if has_edges { EDGE_WIDTH } else { NUMBER_WIDTH };
    let mut builder = table(ui, "next poses").column(Column::exact(first_width));
    for width in WIDTHS {
        builder = builder.column(widgets::tables::number_column(width));
    }
    builder = builder.column(Column::exact(END_MARGIN));
    builder
        .header(theme::ROW_HEIGHT, |mut row| {
            head(&mut row, if has_edges { words::EDGE } else { "" });
            for name in model::plan_heads(convention) {
                number_head(&mut row, &name);
            }
            head(&mut row, "");
        })
        .body(|body| {
            body.rows(theme::ROW_HEIGHT, plan.stations.len(), |mut row| {
                row.set_overline(true);
                let idx = row.index();
                let Some(station) = plan.stations.get(idx) else { return };
                row.col(|ui| {
                    ui.add_space(8.0);
                    ui.label(theme::dim(ui, (idx + 1).to_string()));
                    if has_edges {
                        ui.add_space(6.0);
                        ui.label(model::edge_symbol(station));
                    }
                });
                for cell in model::plan_row(station, convention, DECIMALS) {
                    number_cell(&mut row, cell);
                }
                row.col(|_| {});
            });
        });
}

fn limits(ui: &mut Ui, view: &View<'_>, commands: &mut Vec<Command>) {
    let mut limits = view.limits;
    Frame::new().inner_margin(Margin { left: 12, right: 12, top: 6, bottom: 6 }).show(ui, |ui| {
        ui.spacing_mut().interact_size = vec2(44.0, 22.0);
        ui.spacing_mut().button_padding.x = 6.0;
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing = vec2(6.0, 4.0);
            let degrees =
                |value, most| DragValue::new(value).range(0.0..=most).speed(1.0).fixed_decimals(0).suffix("°");
            let hint = words::limits_hint(&view.session.target);
            named(ui, words::MAX_TILT, &hint, degrees(&mut limits.max_tilt_deg, MAX_TILT_DEG));
            named(ui, words::MAX_SPIN, &hint, degrees(&mut limits.max_spin_deg, 180.0));
            standoff(ui, view, &hint, &mut limits);
        });
    });
    if limits != view.limits {
        commands.push(Command::SetPlanLimits(limits));
    }
}

/// A field with its word before it, which is also its name.
fn named(ui: &mut Ui, name: &str, hint: &str, field: DragValue<'_>) {
    let label = ui.label(theme::dim(ui, name)).on_hover_text(hint);
    ui.add(field).labelled_by(label.id).on_hover_text(hint);
}

fn standoff(ui: &mut Ui, view: &View<'_>, hint: &str, limits: &mut Limits) {
    let mut is_set = limits.standoff_mm.is_some();
    let is_toggled = ui.checkbox(&mut is_set, words::STANDOFF).on_hover_text(hint).changed();
    if is_toggled {
        limits.standoff_mm = is_set.then(|| measured_standoff_mm(view));
    }
    let Some([low, high]) = &mut limits.standoff_mm else {
        ui.label(theme::dim(ui, words::STANDOFF_AS_MEASURED));
        return;
    };
    let field = |ui: &mut Ui, value: &mut f64, name: &str| {
        let field = DragValue::new(value).range(0.0..=2000.0).speed(1.0).fixed_decimals(0).suffix(" mm");
        let field = ui.add(field).on_hover_text(hint);
        field.widget_info(|| WidgetInfo::labeled(Role::SpinButton, true, name));
    };
    field(ui, low, words::STANDOFF_FROM);
    ui.label(theme::dim(ui, words::TO));
    field(ui, high, words::STANDOFF_TO);
    *high = high.max(*low);
}

/// As the stations had it: where the user's own limits begin.
fn measured_standoff_mm(view: &View<'_>) -> [f64; 2] {
    let distances = || {
        let of_stations = view.solution().into_iter().flat_map(|solution| &solution.stations);
        let of_points = view.solution().and_then(|solution| solution.plate.as_ref()).into_iter();
        of_stations
            .map(|station| station.target_in_sensor_mm.z)
            .chain(of_points.flat_map(|plate| &plate.points).map(|point| point.point_in_sensor_mm.z))
    };
    let (low, high) = (distances().fold(f64::INFINITY, f64::min), distances().fold(f64::NEG_INFINITY, f64::max));
    if low <= high { [low.floor(), high.ceil()] } else { [50.0, 100.0] }
}
