//! What the open session is, edited in place, and what it holds, at a glance.

use std::path::Path;

use egui::{Frame, Label, Margin, RichText, Ui, UiBuilder, vec2};

use crate::app::Document;
use crate::session::Reading;
use crate::text::conventions::notation_in_full;
use crate::text::start as words;
use crate::ui::actions::Action;
use crate::ui::rail::Step;
use crate::ui::widgets::{card, split_row, value_row};
use crate::ui::{PanelContext, theme};

use super::form::{FormState, mount_row, target_row};
use super::form_model::Field;

/// Draws the overview: two cards of fields and figures, and the notes below.
pub fn show(ui: &mut Ui, document: &Document, context: &mut PanelContext<'_>, form: &mut FormState) {
    let width = (ui.available_width() - theme::GAP) / 2.0;
    ui.horizontal_top(|ui| {
        ui.spacing_mut().item_spacing.x = theme::GAP;
        column(ui, width, words::SETUP, |ui| setup(ui, document, context, form));
        column(ui, width, words::TARGET_AND_DATA, |ui| target_and_data(ui, document, context, form));
    });
    ui.add_space(theme::GAP);
    card(
        ui,
        words::NOTES,
        |_| {},
        |ui| {
            Frame::new().inner_margin(12).show(ui, |ui| {
                form.text_field(ui, document, Field::Notes, f32::INFINITY, context.commands);
            });
        },
    );
}

/// A card of rows; the two are as high as the higher one, so that their lower borders line up.
fn column(ui: &mut Ui, width: f32, title: &str, rows: impl FnOnce(&mut Ui)) {
    let top = ui.available_rect_before_wrap().min;
    let place = egui::Rect::from_min_size(top, vec2(width, 0.0));
    let mut inside = ui.new_child(UiBuilder::new().max_rect(place).layout(egui::Layout::top_down(egui::Align::Min)));
    card(
        &mut inside,
        title,
        |_| {},
        |ui| {
            Frame::new().inner_margin(Margin::symmetric(12, 4)).show(ui, |ui| {
                ui.set_min_height(10.0 * (theme::ROW_HEIGHT + 4.0));
                rows(ui);
            });
        },
    );
    let used = inside.min_rect();
    ui.advance_cursor_after_rect(used);
}

fn setup(ui: &mut Ui, document: &Document, context: &mut PanelContext<'_>, form: &mut FormState) {
    for field in [Field::Name, Field::RobotModel] {
        form.row(ui, document, field, context.commands);
    }
    split_row(ui, words::CONVENTION, |ui| {
        if ui.link(words::CHANGE_CONVENTION).on_hover_text(words::CHANGE_CONVENTION_HINT).clicked() {
            context.actions.push(Action::GoTo(Step::Poses));
        }
        ui.label(notation_in_full(&document.session.robot.notation));
    });
    for field in
        [Field::PositionStd, Field::OrientationStd, Field::SensorModel, Field::ProfileStd, Field::ReferenceDistance]
    {
        form.row(ui, document, field, context.commands);
    }
    mount_row(ui, document, context.commands);
    let rough = form.row(ui, document, Field::RoughMounting, context.commands);
    rough.on_hover_text(words::rough_mounting_hint(document.session.robot.notation.convention.angle_names));
}

fn target_and_data(ui: &mut Ui, document: &Document, context: &mut PanelContext<'_>, form: &mut FormState) {
    target_row(ui, document, context.commands);
    for field in Field::of_target(&document.session.target) {
        form.row(ui, document, *field, context.commands);
    }
    for (label, value) in data(document) {
        value_row(ui, label, value);
    }
    if !document.session.further.is_empty() {
        split_row(ui, words::FURTHER, |ui| {
            if ui.link(words::CHANGE_FURTHER).on_hover_text(words::CHANGE_FURTHER_HINT).clicked() {
                context.actions.push(Action::GoTo(Step::Verify));
            }
        });
    }
    for further in &document.session.further {
        let figures = words::further(further);
        value_row(ui, &further.name, figures.as_str()).on_hover_text(figures);
    }
    let path = document.path.as_deref();
    split_row(ui, words::FILE, |ui| {
        let name = path.and_then(Path::file_name).map(|name| name.to_string_lossy().into_owned());
        let text = RichText::new(name.unwrap_or_else(|| words::NOT_SAVED.to_owned()));
        let response = ui.add(Label::new(text).truncate());
        if let Some(path) = path {
            response.on_hover_text(path.display().to_string());
        }
    });
}

fn data(document: &Document) -> Vec<(&'static str, String)> {
    let session = &document.session;
    let num_enabled = session.stations.iter().filter(|station| station.enabled).count();
    let captures = session.stations.iter().flat_map(|station| &station.captures);
    let num_points = captures.filter(|capture| matches!(capture.reading, Reading::Point(_))).count();
    vec![
        (words::STATIONS, words::stations_in_use(num_enabled, session.stations.len())),
        (words::CAPTURES, words::captures(session.num_captures() - num_points, num_points)),
        (words::TRUTH, if session.truth.is_some() { words::KNOWN } else { words::NOT_KNOWN }.to_owned()),
        (words::PUBLISHED, session.published.as_ref().map_or(words::NONE, |_| words::YES).to_owned()),
    ]
}
