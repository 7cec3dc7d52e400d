//! The strip above the plots: the fit, the steps, and what was found in the profile.

use egui::{Align, ComboBox, Frame, Layout, Margin, Ui};

use crate::calibrate::Sweep;
use crate::fit::CircleMethod;
use crate::report::figure::model::{EdgeModel, Found, ProfileModel};
use crate::session::ScanLine;
use crate::text::arcs as text;
use crate::text::edges::feature_name;
use crate::text::typeset::with_std;
use crate::ui::{Selection, theme, widgets};

use super::model::{CaptureView, StationRow};
use super::profile;

/// Height of the strip.
const STRIP_HEIGHT: f32 = 44.0;
/// Width of the word before the step buttons and of these.
const STEPS_WIDTH: f32 = 190.0;

/// Shows the strip.
pub(super) fn show(
    ui: &mut Ui,
    station: &StationRow,
    sweep: Option<&Sweep>,
    selection: &mut Selection,
    fit: Option<&mut CircleMethod>,
    note: Option<&str>,
    is_out_of_date: bool,
) {
    widgets::card(
        ui,
        "",
        |_| {},
        |ui| {
            Frame::new().inner_margin(Margin::symmetric(12, 8)).show(ui, |ui| {
                ui.horizontal_wrapped(|ui| {
                    ui.set_min_height(STRIP_HEIGHT - 16.0);
                    let is_of_arcs = fit.is_some();
                    if let Some(fit) = fit {
                        let label = ui.label(text::FIT);
                        ComboBox::from_id_salt("arcs fit")
                            .selected_text(text::circle_method(*fit))
                            .width(148.0)
                            .show_ui(ui, |ui| {
                                for method in CircleMethod::ALL {
                                    ui.selectable_value(fit, method, text::circle_method(method));
                                }
                            })
                            .response
                            .labelled_by(label.id);
                    }
                    steps(ui, if is_of_arcs { text::STEP } else { text::PROFILE }, station, selection);
                    if let Some(note) = note {
                        ui.label(theme::dim(ui, note));
                    }
                    if let Some(sweep) = sweep {
                        let angle_deg = sweep.travel_off_normal_rad.to_degrees();
                        ui.label(theme::dim(ui, text::travel_off_normal(angle_deg)));
                    }
                    if is_out_of_date {
                        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                            ui.label(theme::dim(ui, text::OUT_OF_DATE).color(theme::palette(ui).warn));
                        });
                    }
                });
            });
        },
    );
}

fn steps(ui: &mut Ui, name: &str, station: &StationRow, selection: &mut Selection) {
    let num_steps = station.captures.len();
    // In a narrow window the buttons stay together, at the price of the word before them.
    if ui.available_size_before_wrap().x > STEPS_WIDTH {
        ui.add_space(8.0);
        ui.label(theme::dim(ui, name));
    }
    ui.scope(|ui| {
        ui.spacing_mut().button_padding.x = 8.0;
        let step_to = |ui: &mut Ui, is_possible: bool, sign: &str, name: &str| {
            let button = ui.add_enabled(is_possible, egui::Button::new(sign)).on_hover_text(name);
            button.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, is_possible, name));
            button.clicked()
        };
        if step_to(ui, selection.capture_idx > 0, "‹", text::PREVIOUS_STEP) {
            selection.capture_idx -= 1;
        }
        ui.label(widgets::number_text(text::step_of(selection.capture_idx + 1, num_steps)));
        if step_to(ui, selection.capture_idx + 1 < num_steps, "›", text::NEXT_STEP) {
            selection.capture_idx += 1;
        }
    });
}

/// What was found in the profile in sight, or what another fit than the robust one changes.
pub(super) fn note(view: Option<&CaptureView>, fit: CircleMethod) -> Option<String> {
    let Some(CaptureView::Profile(ProfileModel { found: Ok(found), .. })) = view else { return None };
    match found {
        Found::Section(section) => (fit != CircleMethod::Robust).then(|| profile::shift_words(section)),
        Found::Edge(edge) => Some(edge_words(edge)),
        Found::Scan(line) => scan_words(line),
    }
}

/// What was found, where, and how well it is known.
fn edge_words(edge: &EdgeModel) -> String {
    let [x, z] = [0, 1].map(|axis| with_std(edge.point_mm[axis], edge.std_mm[axis]));
    text::edge_found(feature_name(edge.feature), &x, &z)
}

/// How much of a profile was seen, and where.
fn scan_words(line: &ScanLine) -> Option<String> {
    let range = line.range_mm?;
    let [x, z] = [range.x_mm, range.z_mm].map(|ends| ends.map(|end| widgets::fixed(end, 2)));
    Some(text::scan_line(line.num_valid, line.num_points, &x, &z))
}
