//! What the open session holds, at a glance.

use egui::{Frame, Ui, UiBuilder, vec2};

use crate::app::Document;
use crate::session::{Reading, Session};
use crate::text::conventions::notation_in_full;
use crate::text::start as words;
use crate::ui::theme;
use crate::ui::widgets::{card_with_height, fixed, value_row};

/// Height of the cards, points: a header and eight rows.
const HEIGHT: f32 = 32.0 + 8.0 * (theme::ROW_HEIGHT + 4.0) + 16.0;

/// Draws the overview: two cards of figures, and the notes below.
pub fn show(ui: &mut Ui, document: &Document) {
    let session = &document.session;
    ui.add_space(4.0);
    ui.label(theme::heading(&session.name));
    ui.add_space(8.0);
    let width = (ui.available_width() - theme::GAP) / 2.0;
    ui.horizontal_top(|ui| {
        ui.spacing_mut().item_spacing.x = theme::GAP;
        column(ui, width, words::SETUP, &setup(session));
        column(ui, width, words::DATA, &data(document));
    });
    ui.add_space(theme::GAP);
    crate::ui::widgets::card(
        ui,
        words::NOTES,
        |_| {},
        |ui| {
            Frame::new().inner_margin(12).show(ui, |ui| {
                ui.set_width(ui.available_width());
                if session.notes.is_empty() {
                    ui.label(theme::dim(ui, words::NO_NOTES));
                } else {
                    ui.label(&session.notes);
                }
            });
        },
    );
}

fn column(ui: &mut Ui, width: f32, title: &str, rows: &[(&str, String)]) {
    let (rect, _) = ui.allocate_exact_size(vec2(width, HEIGHT), egui::Sense::hover());
    let mut ui = ui.new_child(UiBuilder::new().max_rect(rect));
    card_with_height(
        &mut ui,
        title,
        HEIGHT,
        |_| {},
        |ui| {
            Frame::new().inner_margin(egui::Margin::symmetric(12, 4)).show(ui, |ui| {
                for (label, value) in rows {
                    value_row(ui, label, value);
                }
            });
        },
    );
}

fn setup(session: &Session) -> Vec<(&'static str, String)> {
    let stated = |value: Option<f64>, decimals: usize, unit: &str| {
        value.map_or_else(|| words::NOT_STATED.to_owned(), |value| format!("{} {unit}", fixed(value, decimals)))
    };
    let or_not_stated = |text: &str| if text.is_empty() { words::NOT_STATED.to_owned() } else { text.to_owned() };
    vec![
        (words::ROBOT, or_not_stated(&session.robot.model)),
        (words::CONVENTION, notation_in_full(&session.robot.notation)),
        (words::POSITION_STD, stated(session.robot.position_std_mm, 3, "mm")),
        (words::ORIENTATION_STD, stated(session.robot.orientation_std_deg, 4, "°")),
        (words::SENSOR, or_not_stated(&session.sensor.model)),
        (words::PROFILE_STD, stated(session.sensor.profile_std_mm, 4, "mm")),
        (words::REFERENCE_DISTANCE, stated(session.sensor.reference_distance_mm, 1, "mm")),
        (words::MOUNT, words::mount(session.mount).to_owned()),
    ]
}

fn data(document: &Document) -> Vec<(&'static str, String)> {
    let session = &document.session;
    let num_enabled = session.stations.iter().filter(|station| station.enabled).count();
    let captures = session.stations.iter().flat_map(|station| &station.captures);
    let num_points = captures.filter(|capture| matches!(capture.reading, Reading::Point(_))).count();
    let file = document.path.as_deref().and_then(std::path::Path::file_name);
    vec![
        (words::TARGET, words::target(&session.target)),
        (words::STATIONS, words::stations_in_use(num_enabled, session.stations.len())),
        (words::CAPTURES, words::captures(session.num_captures() - num_points, num_points)),
        (words::TRUTH, if session.truth.is_some() { words::KNOWN } else { words::NOT_KNOWN }.to_owned()),
        (words::PUBLISHED, session.published.as_ref().map_or(words::NONE, |_| words::YES).to_owned()),
        (words::FILE, file.map_or_else(|| words::NOT_SAVED.to_owned(), |name| name.to_string_lossy().into_owned())),
    ]
}
