//! What is set before motion, in sections that fold, each with its values in a line.

use egui::{Button, ComboBox, Frame, Margin, Role, TextEdit, Ui, WidgetInfo};

use crate::app::cell::{CellSettings, RoughMounting};
use crate::device::WorkspaceBox;
use crate::device::safety::MOST_ROTATION_SPEED_DEG_S;
use crate::device::search::{DirectionFrame, StopRule};
use crate::geometry::Vec3;
use crate::text::capture as words_of_panel;
use crate::text::capture_settings as words;
use crate::ui::theme;
use crate::ui::widgets::{card, fixed, split_row};

use super::fields::{FIELD_HEIGHT, FIELD_WIDTH, Fields, Number, hint, remark, section};
use super::mounting::{self, DIRECTIONS, FURTHEST_MM};
use super::next::Deed;
use super::panel::Desk;

/// Half the side of a workspace box that is switched on, mm.
const BOX_HALF_MM: f64 = 250.0;

/// Width of a field for a side of it, points.
const SIDE_WIDTH: f32 = 84.0;

/// Shows the card.
pub fn show(ui: &mut Ui, desk: &mut Desk<'_>) {
    let mut settings = desk.view.cell.settings;
    let mut fields = std::mem::take(&mut desk.state.fields);
    let problems = desk.view.problems();
    fields.mark(problems.iter().flat_map(|problem| problem.fields).copied().collect());
    card(
        ui,
        words::SETTINGS,
        |_| {},
        |ui| {
            Frame::new().inner_margin(Margin::symmetric(12, 8)).show(ui, |ui| {
                ui.set_width(ui.available_width());
                // A section still opens while its fields are not to be changed.
                let is_free = !desk.view.cell.are_settings_in_use();
                if !is_free {
                    hint(ui, words::IN_USE);
                }
                let summary = search_summary(&settings);
                if !desk.view.is_plate() {
                    section(ui, words::SEARCH, &summary, None, |ui| {
                        ui.add_enabled_ui(is_free, |ui| search(ui, &mut fields, &mut settings));
                    });
                }
                let limits = &settings.limits;
                let summary = words::limits_summary(
                    &fixed(limits.max_speed_mm_s, 0),
                    &fixed(limits.max_move_mm, 0),
                    limits.workspace.is_some(),
                );
                section(ui, words::LIMITS, &summary, None, |ui| {
                    ui.add_enabled_ui(is_free, |ui| limits_rows(ui, &mut fields, &mut settings, desk));
                });
                let summary = words::captures_summary(settings.settle.settle_ms, settings.settle.num_profiles);
                section(ui, words::CAPTURES, &summary, None, |ui| {
                    ui.add_enabled_ui(is_free, |ui| captures(ui, &mut fields, &mut settings));
                });
                let summary = match settings.mounting {
                    Some(_) if desk.view.has_other_mounting => words::GIVEN_ELSEWHERE,
                    Some(_) => words::GIVEN,
                    None => words::NOT_GIVEN,
                };
                let opens = std::mem::take(&mut desk.state.reveals_mounting);
                section(ui, words::MOUNTING, summary, opens.then_some(true), |ui| {
                    mounting_rows(ui, &mut fields, &mut settings, desk);
                    if opens {
                        ui.scroll_to_cursor(None);
                    }
                });
                // Below all fields, so that none moves, nor loses what is being typed, when something is to be said.
                for problem in &problems {
                    remark(ui, "✖", problem.sentence, theme::palette(ui).bad);
                }
                fields.remarks(ui, |name| !words_of_panel::OTHER_NUMBERS.contains(&name));
            });
        },
    );
    desk.state.fields = fields;
    if settings.mounting != desk.view.cell.settings.mounting && !desk.view.cell.is_practice {
        // Whoever gives or changes it means the robot that is there.
        desk.memory.mounting_of = desk.robot();
    }
    desk.set(&settings);
}

fn length(value: &mut f64, least: f64, most: f64, decimals: usize) -> Number<'_> {
    Number::new(value, least..=most, " mm", least.max(0.01)).decimals(decimals)
}

/// A name out of some.
fn choice(ui: &mut Ui, label: &'static str, shown: &str, help: &str, offers: impl FnOnce(&mut Ui)) {
    split_row(ui, label, |ui| {
        ui.spacing_mut().interact_size.y = FIELD_HEIGHT;
        ui.spacing_mut().button_padding = egui::vec2(8.0, 2.0);
        let combo = ComboBox::from_id_salt(label).width(FIELD_WIDTH).truncate().selected_text(shown);
        let response = combo.show_ui(ui, offers).response;
        response.widget_info(|| WidgetInfo::labeled(Role::ComboBox, true, label));
        if !help.is_empty() {
            response.on_hover_text(help);
        }
    });
}

fn direction_name(direction: [f64; 3]) -> Option<usize> {
    mounting::name_of(Vec3::from(direction))
}

fn search_summary(settings: &CellSettings) -> String {
    let search = &settings.search;
    let frame = if search.frame == DirectionFrame::Tool { words::TOOL } else { words::BASE };
    let axis = direction_name(search.direction).map_or(words::VECTOR, |idx| DIRECTIONS[idx]);
    words::search_summary(&format!("{frame} {axis}"), &fixed(search.step_mm, 2), &fixed(search.max_travel_mm, 0))
}

fn search(ui: &mut Ui, fields: &mut Fields, settings: &mut CellSettings) {
    let search = &mut settings.search;
    let frame_name = |frame| if frame == DirectionFrame::Tool { words::TOOL } else { words::BASE };
    choice(ui, words::FRAME, frame_name(search.frame), "", |ui| {
        for frame in [DirectionFrame::Tool, DirectionFrame::Base] {
            ui.selectable_value(&mut search.frame, frame, frame_name(frame));
        }
    });
    let named = direction_name(search.direction);
    let shown = named.map_or(words::VECTOR, |idx| DIRECTIONS[idx]);
    choice(ui, words::DIRECTION, shown, words::DIRECTION_HINT, |ui| {
        for (idx, name) in DIRECTIONS.iter().enumerate() {
            if ui.selectable_label(named == Some(idx), *name).clicked() {
                search.direction = mounting::direction(idx).into();
            }
        }
        if ui.selectable_label(named.is_none(), words::VECTOR).clicked() && named.is_some() {
            // No axis any more, so that its parts can be typed.
            search.direction = [0.0, 1.0, 0.5];
        }
    });
    if named.is_none() {
        for (part, name) in search.direction.iter_mut().zip(words::PARTS) {
            fields.row(ui, name, "", Number::new(part, -1.0..=1.0, "", 0.01).decimals(4));
        }
    }
    fields.row(ui, words::STEP, "", length(&mut search.step_mm, 0.05, 10.0, 2));
    fields.row(ui, words::COARSE_STEP, words::COARSE_STEP_HINT, length(&mut search.coarse_step_mm, 0.05, 20.0, 2));
    fields.row(ui, words::MAX_TRAVEL, "", length(&mut search.max_travel_mm, 1.0, 200.0, 1));
    fields.row(ui, words::MAX_CAPTURES, "", Number::new(&mut search.max_captures, 3.0..=500.0, "", 0.2));
    stop_rule(ui, fields, &mut search.stop);
}

fn stop_rule(ui: &mut Ui, fields: &mut Fields, stop: &mut StopRule) {
    let usual = StopRule::PeakKnown { peak_std_mm: 0.02 };
    let is_published = *stop == StopRule::Published;
    let shown = if is_published { words::STOP_PUBLISHED } else { words::STOP_PEAK };
    choice(ui, words::STOP_RULE, shown, "", |ui| {
        if ui.selectable_label(!is_published, words::STOP_PEAK).clicked() && is_published {
            *stop = usual;
        }
        if ui.selectable_label(is_published, words::STOP_PUBLISHED).clicked() {
            *stop = StopRule::Published;
        }
    });
    if let StopRule::PeakKnown { peak_std_mm } = stop {
        fields.row(
            ui,
            words::PEAK_STD,
            "",
            Number::new(peak_std_mm, 0.001..=1.0, " mm", 0.001).decimals(3).prefix("σ "),
        );
    }
}

fn speed<'a>(value: &'a mut f64, unit: &'static str, most: f64) -> Number<'a> {
    Number::new(value, 1.0..=most, unit, 0.5).decimals(1)
}

fn limits_rows(ui: &mut Ui, fields: &mut Fields, settings: &mut CellSettings, desk: &Desk<'_>) {
    let limits = &mut settings.limits;
    fields.row(ui, words::SPEED_CAP, "", speed(&mut limits.max_speed_mm_s, " mm/s", 500.0));
    fields.row(ui, words::TURN_CAP, "", speed(&mut limits.max_rotation_speed_deg_s, " °/s", MOST_ROTATION_SPEED_DEG_S));
    fields.row(ui, words::TRANSIT_SPEED, "", speed(&mut limits.transit_speed_mm_s, " mm/s", 500.0));
    fields.row(ui, words::SEARCH_SPEED, "", speed(&mut limits.search_speed_mm_s, " mm/s", 500.0));
    fields.row(ui, words::MAX_MOVE, "", length(&mut limits.max_move_mm, 1.0, 2000.0, 0));
    let turn = Number::new(&mut limits.max_turn_deg, 1.0..=180.0, "°", 0.5).decimals(0);
    fields.row(ui, words::MAX_TURN, "", turn);
    ui.add_space(4.0);
    let mut has_box = limits.workspace.is_some();
    if ui.checkbox(&mut has_box, words::WORKSPACE).on_hover_text(words::WORKSPACE_HINT).changed() {
        let report = desk.view.cell.robot.latest.as_ref();
        let place = report.map_or_else(Vec3::zeros, |report| report.base_from_flange.translation_mm());
        let corner = |side: f64| [place.x, place.y, place.z].map(|part| (part + side * BOX_HALF_MM).round());
        limits.workspace = has_box.then(|| WorkspaceBox { min_mm: corner(-1.0), max_mm: corner(1.0) });
    }
    if let Some(workspace) = &mut limits.workspace {
        for (axis, names) in words::SIDES.iter().enumerate() {
            split_row(ui, ["x", "y", "z"][axis], |ui| {
                let mut side = |ui: &mut Ui, name, value| {
                    let number = Number::new(value, -5000.0..=5000.0, " mm", 1.0).decimals(0).width(SIDE_WIDTH);
                    fields.number(ui, name, words::WORKSPACE_HINT, number);
                };
                side(ui, names[1], &mut workspace.max_mm[axis]);
                ui.label(theme::dim(ui, "…"));
                side(ui, names[0], &mut workspace.min_mm[axis]);
            });
        }
    }
}

fn captures(ui: &mut Ui, fields: &mut Fields, settings: &mut CellSettings) {
    let settle = &mut settings.settle;
    fields.row(ui, words::SETTLE, "", Number::new(&mut settle.settle_ms, 0.0..=10_000.0, " ms", 5.0));
    fields.row(ui, words::STILL, "", Number::new(&mut settle.still_mm, 0.001..=1.0, " mm", 0.001).decimals(3));
    fields.row(ui, words::STILL_TURN, "", Number::new(&mut settle.still_deg, 0.001..=1.0, "°", 0.001).decimals(3));
    fields.row(ui, words::AVERAGED, "", Number::new(&mut settle.num_profiles, 1.0..=64.0, "", 0.05));
    fields.row(ui, words::RETRIES, "", Number::new(&mut settle.num_retries, 0.0..=20.0, "", 0.05));
}

fn mounting_rows(ui: &mut Ui, fields: &mut Fields, settings: &mut CellSettings, desk: &mut Desk<'_>) {
    hint(ui, if desk.view.has_solution { words::MOUNTING_SOLVED } else { words::MOUNTING_WHY });
    ui.add_space(4.0);
    hint(ui, words::MOUNTING_ORIGIN);
    ui.add_space(4.0);
    if let Some(given) = &mut settings.mounting {
        if desk.view.has_other_mounting
            && let Some(robot) = &desk.memory.mounting_of
        {
            let sentence = words_of_panel::mounting_of(words_of_panel::robot_kind(robot.kind), &robot.endpoint.host);
            remark(ui, "!", &sentence, theme::palette(ui).warn);
            if ui.button(words_of_panel::KEEP_MOUNTING).clicked() {
                desk.carry_out(Deed::KeepMounting);
            }
        }
        given_rows(ui, fields, given, desk);
        if ui.button(words::FORGET_MOUNTING).clicked() {
            settings.mounting = None;
        }
        return;
    }
    let draft = &mut desk.state.mounting;
    axes_rows(ui, &mut draft.axes);
    for (text, name) in draft.place_mm.iter_mut().zip(["x", "y", "z"]) {
        let name = words::mounting_number(name);
        split_row(ui, &name, |ui| {
            let field =
                ui.add(TextEdit::singleline(text).hint_text(words::MILLIMETRES).desired_width(FIELD_WIDTH - 8.0));
            let shown = text.clone();
            field.widget_info(|| {
                let mut info = WidgetInfo::text_edit(true, "", &shown, words::MILLIMETRES);
                info.label = Some(name.clone());
                info
            });
        });
    }
    ui.add_space(4.0);
    let typed = draft.typed();
    let button = ui.add_enabled(typed.is_some(), Button::new(words::USE_MOUNTING));
    if button.on_disabled_hover_text(words::MOUNTING_MISSING).clicked() {
        settings.mounting = typed;
    }
}

/// What the sensor looks along, and how its line lies.
fn axes_rows(ui: &mut Ui, given: &mut RoughMounting) {
    let [look, line] = mounting::look_and_line(given);
    for (label, named, is_look) in [(words::LOOKS_ALONG, look, true), (words::LINE_ALONG, line, false)] {
        let named = mounting::name_of(named);
        let shown = named.map_or_else(|| words::OBLIQUE.to_owned(), |idx| words::of_flange(DIRECTIONS[idx]));
        choice(ui, label, &shown, "", |ui| {
            for (idx, name) in DIRECTIONS.iter().enumerate() {
                if ui.selectable_label(named == Some(idx), words::of_flange(name)).clicked() {
                    let chosen = mounting::direction(idx);
                    *given = if is_look {
                        mounting::turned(*given, chosen, line)
                    } else {
                        mounting::turned(*given, look, chosen)
                    };
                }
            }
        });
    }
}

fn given_rows(ui: &mut Ui, fields: &mut Fields, given: &mut RoughMounting, desk: &Desk<'_>) {
    axes_rows(ui, given);
    for (value, name) in given.translation_mm.iter_mut().zip(["x", "y", "z"]) {
        fields.row(ui, &words::mounting_number(name), "", length(value, -FURTHEST_MM, FURTHEST_MM, 1));
    }
    let convention = desk.view.notation().convention;
    let before = convention.angles_deg_from_rotation(&mounting::rotation(given));
    let mut angles_deg = before.map(|angle| (angle * 10.0).round() / 10.0);
    let mut has_changed = false;
    for (angle, name) in angles_deg.iter_mut().zip(convention.angle_names) {
        let field = Number::new(angle, -360.0..=360.0, "°", 0.5).decimals(1);
        has_changed |= fields.row(ui, &words::mounting_number(name), "", field);
    }
    if has_changed {
        *given = mounting::with_rotation(*given, &convention.rotation_from_angles_deg(angles_deg));
    }
}
