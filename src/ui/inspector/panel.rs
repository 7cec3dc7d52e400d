//! The inspector's sections, one below the other.

use egui::{Align, ComboBox, Layout, RichText, ScrollArea, Sense, Stroke, Ui, UiBuilder, vec2};

use crate::app::{Document, Results};
use crate::calibrate::{self, Method, PlatePoint, Solution, StationSolution};
use crate::fit::{ArcFit, EdgeFit, PointClass};
use crate::session::Reading;
use crate::text::edges::{edge_name, feature_hint, feature_name};
use crate::text::methods::method_short_name;
use crate::text::shell as words;
use crate::text::typeset::{all_digits, decimals_of_std, with_std};
use crate::ui::widgets::{fixed, number_text, split_row, value_row};
use crate::ui::{PanelContext, theme};

use super::{findings, model};

/// Draws the inspector.
pub fn show(ui: &mut Ui, context: &mut PanelContext<'_>) {
    let Some(document) = context.workbench.document() else { return };
    let results = context.workbench.results();
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        // Room for the scroll bar beside the figures, not over them.
        ui.set_max_width(ui.available_width() - SCROLL_BAR_WIDTH);
        ui.spacing_mut().item_spacing.y = 0.0;
        ui.add_space(16.0);
        let method = context.selection.method;
        let outcome = results.and_then(|results| results.method(method)).map(|result| &result.outcome);
        let solution = outcome.and_then(|outcome| outcome.as_ref().ok());
        capture_section(ui, context, document, results, solution);
        ui.add_space(16.0);
        method_header(ui, context, document);
        ui.add_space(4.0);
        match (outcome, results.and_then(|results| results.refusal.as_deref())) {
            (Some(Ok(solution)), _) => solution_section(ui, document, solution),
            (Some(Err(error)), _) => refusal(ui, &error.to_string()),
            // No failure: the target is none that a calibration is computed from.
            (None, Some(reason)) => {
                ui.add(egui::Label::new(theme::dim(ui, reason)).wrap());
            }
            (None, None) => {
                ui.label(theme::dim(ui, words::NO_RESULTS));
            }
        }
        ui.add_space(16.0);
    });
}

fn refusal(ui: &mut Ui, reason: &str) {
    let color = theme::palette(ui).bad;
    ui.horizontal_top(|ui| {
        ui.label(RichText::new("✖").color(color));
        ui.add(egui::Label::new(reason).wrap());
    });
}

fn capture_section(
    ui: &mut Ui,
    context: &PanelContext<'_>,
    document: &Document,
    results: Option<&Results>,
    solution: Option<&Solution>,
) {
    let (station_idx, capture_idx) = (context.selection.station_idx, context.selection.capture_idx);
    let Some(station) = document.session.stations.get(station_idx) else { return };
    let step = (station.captures.len() > 1).then_some(capture_idx + 1);
    ui.label(theme::strong(words::station_heading(&station.label, step)));
    ui.add_space(4.0);
    if let Some(capture) = station.captures.get(capture_idx) {
        let position = capture.base_from_flange.translation_mm();
        let convention = document.session.robot.notation.convention;
        let angles = convention.angles_deg_from_rotation(&capture.base_from_flange.rotation());
        triple_row(ui, words::FLANGE_POSITION, position.into(), POSE_DECIMALS, "mm");
        triple_row(ui, &words::angle_names(convention.angle_names), angles, POSE_DECIMALS, "°");
    }
    if !station.enabled {
        ui.label(theme::dim(ui, words::STATION_LEFT_OUT));
    }
    let num_points = station.captures.get(capture_idx).map_or(0, |capture| match &capture.reading {
        Reading::Profile(profile) => profile.len(),
        Reading::Point(_) | Reading::Pose(_) => 1,
    });
    let reading = results.and_then(|results| results.measured.reading(station_idx, capture_idx));
    match reading {
        Some(calibrate::Reading::Arc(arc)) => arc_rows(ui, arc, num_points),
        Some(calibrate::Reading::Refused(reason)) => refusal(ui, &reason.to_string()),
        Some(calibrate::Reading::Point(point)) => {
            let label = words::target_in_sensor(&document.session.target);
            triple_row(ui, label, (*point).into(), POSE_DECIMALS, "mm");
        }
        Some(calibrate::Reading::Pose(seen)) => {
            let label = words::target_in_sensor(&document.session.target);
            triple_row(ui, label, seen.translation_mm().into(), POSE_DECIMALS, "mm");
        }
        Some(calibrate::Reading::Edge(edge)) => edge_rows(ui, edge, num_points),
        None => {}
    }
    if let Some(line) = results.and_then(|results| results.measured.scan_line(station_idx, capture_idx)) {
        value_row(ui, words::POINTS_USED, words::points_used(line.num_valid, line.num_points));
        if let Some(range) = line.range_mm {
            let [near, far] = range.z_mm.map(|end| fixed(end, 2));
            value_row(ui, words::RANGE_SEEN, words::from_to_mm(&near, &far));
        }
    }
    if let Some(edge) = station.edge {
        value_row(ui, words::PLATE_EDGE, edge_name(edge));
    }
    let Some(solution) = solution else { return };
    if let Some(plate) = &solution.plate {
        let of_capture = |point: &&PlatePoint| (point.station_idx, point.capture_idx) == (station_idx, capture_idx);
        match plate.points.iter().find(of_capture) {
            Some(point) => plate_point_rows(ui, point),
            None if station.enabled => {
                ui.label(theme::dim(ui, words::STATION_NOT_USED));
            }
            None => {}
        }
        return;
    }
    match solution.stations.iter().find(|solved| solved.station_idx == station_idx) {
        Some(solved) => station_rows(ui, solution.method, solved),
        None if station.enabled => {
            ui.label(theme::dim(ui, words::STATION_NOT_USED));
        }
        None => {}
    }
}

fn arc_rows(ui: &mut Ui, arc: &ArcFit, num_points: usize) {
    let [_, _, radius_std_mm] = arc.std_mm();
    let radius = format!("{} mm", with_std(arc.circle.radius_mm, radius_std_mm));
    value_row(ui, words::SECTION_RADIUS, radius).on_hover_text(all_digits(arc.circle.radius_mm));
    let extent = words::arc_extent(arc.angle_rad.to_degrees(), arc.num_inliers(), num_points);
    value_row(ui, words::ARC, extent);
    value_row(ui, words::FIT, format!("{} µm RMS", fixed(arc.rms_mm * 1e3, 1)));
}

fn edge_rows(ui: &mut Ui, edge: &EdgeFit, num_points: usize) {
    let name = feature_name(edge.feature);
    let [x_std_mm, z_std_mm] = edge.std_mm();
    value_row(ui, words::FOUND, name).on_hover_text(feature_hint(edge.feature));
    for (label, value, std_mm) in
        [(words::POINT_X, edge.point_mm[0], x_std_mm), (words::POINT_Z, edge.point_mm[1], z_std_mm)]
    {
        value_row(ui, label, format!("{} mm", with_std(value, std_mm))).on_hover_text(all_digits(value));
    }
    let num_used = edge.classes.iter().filter(|class| **class == PointClass::Inlier).count();
    value_row(ui, words::POINTS_USED, words::points_used(num_used, num_points));
    value_row(ui, words::POINT_NOISE, format!("{} µm", fixed(edge.point_std_mm * 1e3, 1)));
}

fn plate_point_rows(ui: &mut Ui, point: &PlatePoint) {
    value_row(ui, words::OFF_EDGE, format!("{} mm", fixed(point.off_edge_mm.norm(), 3)))
        .on_hover_text(words::OFF_EDGE_HINT);
    if let Some(left_out_mm) = point.leave_one_out_mm {
        value_row(ui, words::LEFT_OUT, format!("{} mm", fixed(left_out_mm, 3)))
            .on_hover_text(words::OFF_EDGE_LEFT_OUT_HINT);
    }
}

fn station_rows(ui: &mut Ui, method: Method, solved: &StationSolution) {
    if Method::BALL.contains(&method) {
        let ratio = solved.side_cost_ratio.map_or_else(String::new, |ratio| format!("  ({} : 1)", fixed(ratio, 0)));
        let side = match solved.side {
            calibrate::Side::Plus => "+",
            calibrate::Side::Minus => "−",
        };
        value_row(ui, words::SIDE_OF_BALL, format!("{side}{ratio}")).on_hover_text(words::SIDE_HINT);
    }
    if let Some(sweep) = &solved.sweep {
        let peak = format!("{} mm", with_std(sweep.peak_mm, sweep.peak_std_mm));
        value_row(ui, words::LARGEST_ARC_AT, peak).on_hover_text(all_digits(sweep.peak_mm));
    }
    if let Some(left_out_mm) = solved.leave_one_out_mm {
        value_row(ui, words::LEFT_OUT, format!("{} mm", fixed(left_out_mm, 3)))
            .on_hover_text(words::left_out_hint(method));
    }
}

fn method_header(ui: &mut Ui, context: &mut PanelContext<'_>, document: &Document) {
    ui.horizontal(|ui| {
        ui.label(theme::strong(words::transform_name(document.session.mount)));
        let methods = shown_methods(context);
        if methods.is_empty() {
            return;
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let current = context.selection.method;
            let combo = ComboBox::from_id_salt("method shown")
                .selected_text(method_text(ui, current))
                .show_ui(ui, |ui| {
                    for method in methods {
                        let text = method_text(ui, method);
                        ui.selectable_value(&mut context.selection.method, method, text);
                    }
                })
                .response;
            combo.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, words::METHOD));
        });
    });
}

fn method_text(ui: &Ui, method: Method) -> RichText {
    RichText::new(format!("{} {}", theme::method_symbol(method), method_short_name(method)))
        .color(theme::method_text_color(ui, method))
}

fn solution_section(ui: &mut Ui, document: &Document, solution: &Solution) {
    matrix(ui, solution);
    ui.add_space(12.0);
    let convention = document.session.robot.notation.convention;
    ui.label(theme::strong(convention.label)).on_hover_text(words::convention_hint(convention.formula));
    ui.add_space(4.0);
    let translation = solution.flange_from_sensor.translation_mm();
    let angles = convention.angles_deg_from_rotation(&solution.flange_from_sensor.rotation());
    let translation: [f64; 3] = translation.into();
    let translation_std: Option<[f64; 3]> =
        solution.uncertainty.as_ref().map(|uncertainty| uncertainty.translation_std_mm.into());
    let angle_std = model::angle_std_deg(solution, convention);
    // One number of decimals a row, so that its figures can be compared: that of the best known of the three.
    let decimals = |std: Option<[f64; 3]>| {
        std.map_or(POSE_DECIMALS, |std| std.into_iter().map(decimals_of_std).max().unwrap_or(POSE_DECIMALS))
    };
    let (length_decimals, angle_decimals) = (decimals(translation_std), decimals(angle_std));
    triple_row(ui, words::TRANSLATION, translation, length_decimals, "mm");
    triple_row(ui, &words::angle_names(convention.angle_names), angles, angle_decimals, "°");
    if let (Some(translation_std), Some(angle_std)) = (translation_std, angle_std) {
        triple_row(ui, words::TRANSLATION_STD, translation_std, length_decimals, "mm");
        let label = words::angle_std_names(convention.angle_names);
        triple_row(ui, &label, angle_std, angle_decimals, "°");
    } else {
        ui.add(egui::Label::new(theme::dim(ui, words::NO_UNCERTAINTY)).wrap());
    }
    ui.add_space(8.0);
    ui.horizontal(|ui| copy_menu(ui, document, solution));
    ui.add_space(16.0);
    findings::show(ui, solution);
}

fn matrix(ui: &mut Ui, solution: &Solution) {
    let exact = solution.flange_from_sensor.matrix();
    let hairline = Stroke::new(1.0, theme::palette(ui).hairline);
    for (row, cells) in model::matrix_cells(solution).into_iter().enumerate() {
        let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), theme::ROW_HEIGHT), Sense::hover());
        ui.painter().hline(rect.x_range(), rect.bottom(), hairline);
        let width = rect.width() / 4.0;
        for ((column, cell), right) in cells.into_iter().enumerate().zip([1.0, 2.0, 3.0, 4.0]) {
            let min = egui::pos2(rect.left() + width * (right - 1.0), rect.top());
            let layout = Layout::right_to_left(Align::Center);
            let inside = egui::Rect::from_min_size(min, vec2(width - 4.0, rect.height()));
            let mut ui = ui.new_child(UiBuilder::new().max_rect(inside).layout(layout));
            ui.label(number_text(cell)).on_hover_text(all_digits(exact[(row, column)]));
        }
    }
}

/// Room at the right for the scroll bar, points.
const SCROLL_BAR_WIDTH: f32 = 8.0;
/// Decimals of a pose in mm and degrees, where no uncertainty says otherwise: what controllers report.
const POSE_DECIMALS: usize = 3;
/// Width of one of three figures in a row, points: room for seven digits, sign and point.
const FIGURE_WIDTH: f32 = 68.0;
/// Least gap between a row's label and the first figure's column, points.
const LABEL_GAP: f32 = 2.0;
/// Width of a row's unit, points.
const UNIT_WIDTH: f32 = 28.0;

/// Three figures with their unit, each right-aligned in a column of its own, the unit in a dimmer tone.
/// Hovering a figure shows all its digits.
fn triple_row(ui: &mut Ui, label: &str, values: [f64; 3], decimals: usize, unit: &str) {
    let font = egui::TextStyle::Body.resolve(ui.style());
    let label_width = ui.painter().layout_no_wrap(label.to_owned(), font, egui::Color32::PLACEHOLDER).size().x;
    let figures_width = 3.0 * FIGURE_WIDTH + UNIT_WIDTH;
    // A label too long to stand beside the figures stands above them.
    let has_own_line = label_width + LABEL_GAP > ui.available_width() - figures_width;
    if has_own_line {
        split_row(ui, label, |_| {});
    }
    split_row(ui, if has_own_line { "" } else { label }, |ui| {
        ui.spacing_mut().item_spacing.x = 0.0;
        let cell = |width| egui::vec2(width, theme::ROW_HEIGHT);
        ui.allocate_ui_with_layout(cell(UNIT_WIDTH), Layout::left_to_right(Align::Center), |ui| {
            ui.set_min_width(UNIT_WIDTH);
            ui.add_space(4.0);
            ui.label(theme::dim(ui, unit));
        });
        for value in values.into_iter().rev() {
            ui.allocate_ui_with_layout(cell(FIGURE_WIDTH), Layout::right_to_left(Align::Center), |ui| {
                ui.set_min_width(FIGURE_WIDTH);
                ui.label(number_text(fixed(value, decimals))).on_hover_text(all_digits(value));
            });
        }
    });
}

fn copy_menu(ui: &mut Ui, document: &Document, solution: &Solution) {
    ui.menu_button(format!("{} ▾", words::COPY), |ui| {
        let convention = document.session.robot.notation.convention;
        if ui.button(words::COPY_MATRIX).clicked() {
            ui.ctx().copy_text(model::matrix_text(solution));
            ui.close();
        }
        if ui.button(words::COPY_POSE).clicked() {
            ui.ctx().copy_text(model::pose_text(solution, convention));
            ui.close();
        }
        if ui.button(words::COPY_QUATERNION).clicked() {
            ui.ctx().copy_text(model::quaternion_text(solution));
            ui.close();
        }
    });
}

/// The methods for the session's target.
fn shown_methods(context: &PanelContext<'_>) -> Vec<Method> {
    context.workbench.results().map_or_else(Vec::new, |results| results.methods.iter().map(|r| r.method).collect())
}
