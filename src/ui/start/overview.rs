//! What the open session is, edited in place, and what it holds, at a glance.

use std::path::Path;

use egui::{Frame, Label, Margin, RichText, Ui, UiBuilder, vec2};

use crate::app::{Document, Workbench};
use crate::session::{Reading, Target};
use crate::text::conventions::notation_in_full;
use crate::text::import as import_words;
use crate::text::start as words;
use crate::ui::actions::Action;
use crate::ui::rail::Step;
use crate::ui::widgets::{card, split_row, value_row};
use crate::ui::{PanelContext, import, theme};

use super::form::{FormState, mount_row, target_row};
use super::form_model::Field;

/// Below this width the two cards stand above each other, so that names and numbers have room, points.
const SIDE_BY_SIDE_FROM: f32 = 620.0;
/// Rows that each of two cards side by side has room for.
const NUM_ROWS: f32 = 10.0;

/// Draws the overview: two cards of fields and figures, and the notes below.
pub fn show(ui: &mut Ui, document: &Document, context: &mut PanelContext<'_>, form: &mut FormState) {
    let width = ui.available_width();
    if width < SIDE_BY_SIDE_FROM {
        column(ui, width, 0.0, words::SETUP, |ui| setup(ui, document, context, form));
        ui.add_space(theme::GAP);
        column(ui, width, 0.0, words::TARGET_AND_DATA, |ui| target_and_data(ui, document, context, form));
    } else {
        let width = (width - theme::GAP) / 2.0;
        ui.horizontal_top(|ui| {
            ui.spacing_mut().item_spacing.x = theme::GAP;
            column(ui, width, NUM_ROWS, words::SETUP, |ui| setup(ui, document, context, form));
            column(ui, width, NUM_ROWS, words::TARGET_AND_DATA, |ui| target_and_data(ui, document, context, form));
        });
    }
    ui.add_space(theme::GAP);
    if document.session.target.is_pose() && document.session.stations.is_empty() {
        card(
            ui,
            import_words::PAIRS_TITLE,
            |_| {},
            |ui| {
                Frame::new().inner_margin(12).show(ui, |ui| import::pairs(ui, context.actions));
            },
        );
        ui.add_space(theme::GAP);
    }
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

/// A card of rows, with room for so many of them: two side by side have lower borders that line up.
fn column(ui: &mut Ui, width: f32, least_rows: f32, title: &str, rows: impl FnOnce(&mut Ui)) {
    let top = ui.available_rect_before_wrap().min;
    let place = egui::Rect::from_min_size(top, vec2(width, 0.0));
    let mut inside = ui.new_child(UiBuilder::new().max_rect(place).layout(egui::Layout::top_down(egui::Align::Min)));
    card(
        &mut inside,
        title,
        |_| {},
        |ui| {
            Frame::new().inner_margin(Margin::symmetric(12, 4)).show(ui, |ui| {
                ui.set_min_height(least_rows * (theme::ROW_HEIGHT + 4.0));
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
    let has_profiles = !matches!(document.session.target, Target::Pose { .. } | Target::Rgbd { .. });
    let is_asked = |field: &Field| has_profiles || !field.is_of_a_profiler();
    for field in
        [Field::PositionStd, Field::OrientationStd, Field::SensorModel, Field::ProfileStd, Field::ReferenceDistance]
            .into_iter()
            .filter(is_asked)
    {
        form.row(ui, document, field, context.commands);
    }
    mount_row(ui, document, context.commands);
    if is_asked(&Field::RoughMounting) {
        let rough = form.row(ui, document, Field::RoughMounting, context.commands);
        rough.on_hover_text(words::rough_mounting_hint(document.session.robot.notation.convention.angle_names));
    }
}

fn target_and_data(ui: &mut Ui, document: &Document, context: &mut PanelContext<'_>, form: &mut FormState) {
    target_row(ui, document, context.commands);
    for field in Field::of_target(&document.session.target) {
        form.row(ui, document, *field, context.commands);
    }
    for (label, value) in data(document, context.workbench) {
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

fn data(document: &Document, workbench: &Workbench) -> Vec<(&'static str, String)> {
    let session = &document.session;
    if let Target::Rgbd { .. } = session.target {
        let Some(sequence) = workbench.sequence().sequence() else {
            return vec![(words::FRAMES, words::NOT_READ.to_owned())];
        };
        let in_folder = |is_there: bool| if is_there { words::IN_FOLDER } else { words::NONE }.to_owned();
        return vec![
            (words::FRAMES, sequence.frames.len().to_string()),
            (words::GROUND_TRUTH, in_folder(sequence.ground_truth.is_some())),
            (words::FLANGE_POSES, in_folder(sequence.flange.is_some())),
        ];
    }
    let truth = if session.truth.is_some() { words::KNOWN } else { words::NOT_KNOWN }.to_owned();
    let num_enabled = session.stations.iter().filter(|station| station.enabled).count();
    let readings = || session.stations.iter().flat_map(|station| &station.captures).map(|capture| &capture.reading);
    let num_points = readings().filter(|reading| matches!(reading, Reading::Point(_))).count();
    let num_boards = readings().filter(|reading| matches!(reading, Reading::Pose(_))).count();
    let num_profiles = session.num_captures() - num_points - num_boards;
    let captures = match (session.num_captures(), num_boards) {
        (0, _) => words::NONE.to_owned(),
        (_, 0) => words::captures(num_profiles, num_points),
        (_, number) => words::board_poses(number),
    };
    vec![
        (words::STATIONS, words::stations_in_use(num_enabled, session.stations.len())),
        (words::CAPTURES, captures),
        (words::TRUTH, truth),
        (words::PUBLISHED, session.published.as_ref().map_or(words::NONE, |_| words::YES).to_owned()),
    ]
}
