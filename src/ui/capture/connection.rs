//! The links: which driver, where, how it is; and the badge of the practice.

use std::time::Duration;

use egui::{Button, ComboBox, Frame, Label, Margin, Response, RichText, Role, TextEdit, Ui, WidgetInfo, vec2};

use crate::app::cell::CellCommand;
use crate::device::{Endpoint, LinkState, Readiness, RobotKind, SensorKind};
use crate::text::capture as words;
use crate::ui::actions::Action;
use crate::ui::theme;
use crate::ui::widgets::{card, fixed, number_text, split_row, value_row};

use super::fields::{Fields, Number, hint, lamp, remark};
use super::model;
use super::panel::Desk;

/// Width of the field for a port, points.
const PORT_WIDTH: f32 = 72.0;

/// Shows the cards.
pub fn show(ui: &mut Ui, desk: &mut Desk<'_>) {
    let cell = desk.view.cell;
    if [&cell.robot.state, &cell.sensor.state].iter().any(|state| is_waiting(state)) {
        // The time until the next attempt counts down.
        ui.ctx().request_repaint_after(Duration::from_secs(1));
    }
    if cell.is_practice {
        practice(ui, desk);
    }
    robot(ui, desk);
    profiler(ui, desk);
}

const fn is_waiting(state: &LinkState) -> bool {
    matches!(state, LinkState::Failed { retry_in: Some(_), .. })
}

fn practice(ui: &mut Ui, desk: &mut Desk<'_>) {
    let mut ends = false;
    let right = |ui: &mut Ui| ends = small_button(ui, words::END_PRACTICE, words::END_PRACTICE).clicked();
    card(ui, words::PRACTICE, right, |ui| inside(ui, |ui| hint(ui, words::PRACTICE_HINT)));
    if ends {
        desk.ask(CellCommand::EndPractice);
    }
}

fn inside(ui: &mut Ui, body: impl FnOnce(&mut Ui)) {
    Frame::new().inner_margin(Margin::symmetric(12, 8)).show(ui, |ui| {
        ui.set_width(ui.available_width());
        body(ui);
    });
}

fn small_button(ui: &mut Ui, label: &str, name: &str) -> Response {
    ui.spacing_mut().interact_size.y = 22.0;
    ui.spacing_mut().button_padding = vec2(8.0, 2.0);
    let response = ui.button(label);
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, name));
    response
}

/// Offers to connect again at once, below what happened; a simulated cell has nothing to be mended.
fn retries(ui: &mut Ui, name: &str, shape: model::Lamp, is_practice: bool) -> bool {
    shape == model::Lamp::Bad && !is_practice && ui.scope(|ui| small_button(ui, words::RETRY, name)).inner.clicked()
}

fn robot(ui: &mut Ui, desk: &mut Desk<'_>) {
    let cell = desk.view.cell;
    let (shape, word, remedy) = model::robot_lamp(cell);
    // What is replayed is shown as if it came from a robot.
    let is_replay = cell.replay.is_some();
    let is_off = cell.robot.state == LinkState::Off;
    let is_practice = cell.is_practice;
    let mut command = None;
    let mut wants_again = false;
    let right = |ui: &mut Ui| {
        if is_replay {
            ui.label(theme::dim(ui, words::RECORDED));
            return;
        }
        if !is_off && !is_practice && small_button(ui, words::DISCONNECT, words::DISCONNECT_ROBOT).clicked() {
            command = Some(CellCommand::DisconnectRobot);
        }
        lamp(ui, shape, word, words::ROBOT);
    };
    card(ui, words::ROBOT, right, |ui| {
        inside(ui, |ui| {
            if let Some(remedy) = remedy.as_ref().filter(|_| !is_replay) {
                let palette = theme::palette(ui);
                let color = if shape == model::Lamp::Bad { palette.bad } else { palette.warn };
                remark(ui, "!", remedy, color);
                wants_again = retries(ui, words::RETRY_ROBOT, shape, is_practice);
            }
            if is_off && !is_replay {
                robot_form(ui, desk);
            } else {
                robot_state(ui, desk);
            }
        });
    });
    if wants_again {
        command = cell.robot.setup.clone().map(CellCommand::ConnectRobot);
    }
    if let Some(command) = command {
        desk.ask(command);
    }
}

fn robot_form(ui: &mut Ui, desk: &mut Desk<'_>) {
    let mut kind = desk.memory.robot_kind;
    chooser(ui, words::ROBOT_DRIVER, words::robot_kind(kind), |ui| {
        for offered in RobotKind::ALL {
            ui.selectable_value(&mut kind, offered, words::robot_kind(offered));
        }
    });
    desk.memory.robot_kind = kind;
    let is_entered =
        endpoint(ui, &mut desk.state.fields, &mut desk.memory.robot().endpoint, words::ROBOT_HOST, words::ROBOT_PORT);
    hint(ui, words::robot_kind_hint(kind));
    let setup = desk.memory.robot_to_connect();
    let refusal = setup.is_none().then_some(words::NO_HOST);
    let is_clicked = connect(ui, words::CONNECT_ROBOT, refusal);
    if let Some(setup) = setup.filter(|_| is_clicked || is_entered) {
        desk.ask(CellCommand::ConnectRobot(setup));
    }
}

fn robot_state(ui: &mut Ui, desk: &Desk<'_>) {
    let cell = desk.view.cell;
    ui.spacing_mut().item_spacing.y = 0.0;
    if let Some(setup) = cell.robot.setup.as_ref().filter(|_| cell.replay.is_none()) {
        hint(ui, &words::at_address(words::robot_kind(setup.kind), &setup.endpoint.host, setup.endpoint.port));
        if setup.kind == RobotKind::FanucPage {
            remark(ui, "!", words::COARSE_POSES, theme::palette(ui).warn);
        }
    }
    let Some(report) = &cell.robot.latest else { return };
    if cell.replay.is_none() && cell.robot.state != LinkState::Ready {
        ui.multiply_opacity(theme::PAST_OPACITY);
    }
    ui.add_space(4.0);
    pose(ui, &model::pose_rows(&desk.view.notation(), &report.base_from_flange, report.resolution_mm));
    if cell.replay.is_some() {
        return;
    }
    value_row(ui, words::MOTION, words::motion(report.is_moving));
    let color = match report.readiness {
        Readiness::NotReady { .. } => theme::palette(ui).warn,
        _ => theme::palette(ui).text,
    };
    let readiness = RichText::new(words::readiness(&report.readiness)).color(color);
    split_row(ui, words::READINESS, |ui| ui.add(Label::new(readiness).truncate()));
    let tool = if report.tool.is_empty() { words::TOOL_NOT_TOLD } else { &report.tool };
    value_row(ui, words::TOOL, tool).on_hover_text(words::TOOL_HINT);
}

/// Position and orientation beside each other.
fn pose(ui: &mut Ui, rows: &[(String, String)]) {
    ui.columns(2, |columns| {
        let (position, orientation) = rows.split_at(rows.len().min(3));
        for (column, rows) in columns.iter_mut().zip([position, orientation]) {
            column.spacing_mut().item_spacing.y = 0.0;
            for (name, value) in rows {
                value_row(column, name, value.as_str());
            }
        }
    });
}

fn profiler(ui: &mut Ui, desk: &mut Desk<'_>) {
    let cell = desk.view.cell;
    let (shape, word, remedy) = model::sensor_lamp(cell);
    let is_replay = cell.replay.is_some();
    let is_off = cell.sensor.state == LinkState::Off;
    let is_practice = cell.is_practice;
    let mut command = None;
    let mut wants_again = false;
    let right = |ui: &mut Ui| {
        if is_replay {
            ui.label(theme::dim(ui, words::RECORDED));
            return;
        }
        if !is_off && !is_practice && small_button(ui, words::DISCONNECT, words::DISCONNECT_PROFILER).clicked() {
            command = Some(CellCommand::DisconnectSensor);
        }
        lamp(ui, shape, word, words::PROFILER);
    };
    card(ui, words::PROFILER, right, |ui| {
        inside(ui, |ui| {
            if let Some(remedy) = remedy.as_ref().filter(|_| !is_replay) {
                remark(ui, "!", remedy, theme::palette(ui).bad);
                wants_again = retries(ui, words::RETRY_PROFILER, shape, is_practice);
            }
            if is_off && !is_replay {
                profiler_form(ui, desk);
                return;
            }
            ui.spacing_mut().item_spacing.y = 0.0;
            if let Some(setup) = cell.sensor.setup.as_ref().filter(|_| !is_replay) {
                let kind = words::sensor_kind(setup.kind);
                hint(
                    ui,
                    &match setup.kind {
                        SensorKind::Folder => words::watching(&setup.folder.display().to_string()),
                        _ => words::at_address(kind, &setup.endpoint.host, setup.endpoint.port),
                    },
                );
            }
            if let Some(live) = &cell.live {
                if !is_replay && cell.sensor.state != LinkState::Ready {
                    ui.multiply_opacity(theme::PAST_OPACITY);
                }
                let profile = &live.reading.profile;
                value_row(ui, words::POINTS, words::valid_of(profile.valid_points().count(), profile.len()));
                value_row(ui, words::RATE, words::rate(&fixed(live.rate_hz, 0)));
            }
        });
    });
    if wants_again {
        command = cell.sensor.setup.clone().map(CellCommand::ConnectSensor);
    }
    if let Some(command) = command {
        desk.ask(command);
    }
}

fn profiler_form(ui: &mut Ui, desk: &mut Desk<'_>) {
    let mut kind = desk.memory.sensor_kind;
    chooser(ui, words::PROFILER_DRIVER, words::sensor_kind(kind), |ui| {
        for offered in SensorKind::ALL {
            ui.selectable_value(&mut kind, offered, words::sensor_kind(offered));
        }
    });
    desk.memory.sensor_kind = kind;
    let setup = desk.memory.sensor();
    let is_entered = if kind == SensorKind::Folder {
        let mut folder = setup.folder.display().to_string();
        let mut is_entered = false;
        ui.horizontal(|ui| {
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                if ui.button(words::BROWSE).clicked() {
                    desk.actions.push(Action::ChooseWatchedFolder);
                }
                let field = text_field(ui, &mut folder, words::FOLDER, words::FOLDER_HINT);
                desk.state.fields.hand_over(words::FOLDER, &field);
                if field.changed() {
                    setup.folder = folder.as_str().into();
                }
                is_entered = is_entered_in(ui, &field);
            });
        });
        is_entered
    } else {
        endpoint(ui, &mut desk.state.fields, &mut setup.endpoint, words::PROFILER_HOST, words::PROFILER_PORT)
    };
    ui.checkbox(&mut setup.is_z_inverted, words::INVERT_Z).on_hover_text(words::INVERT_Z_HINT);
    hint(ui, words::sensor_kind_hint(kind));
    let setup = desk.memory.sensor_to_connect();
    let missing = if kind == SensorKind::Folder { words::NO_FOLDER } else { words::NO_HOST };
    let is_clicked = connect(ui, words::CONNECT_PROFILER, setup.is_none().then_some(missing));
    if let Some(setup) = setup.filter(|_| is_clicked || is_entered) {
        desk.ask(CellCommand::ConnectSensor(setup));
    }
}

fn chooser(ui: &mut Ui, name: &'static str, chosen: &str, offers: impl FnOnce(&mut Ui)) {
    let response =
        ComboBox::from_id_salt(name).width(ui.available_width()).selected_text(chosen).show_ui(ui, offers).response;
    response.widget_info(|| WidgetInfo::labeled(Role::ComboBox, true, name));
}

/// Host and port in a row; answers whether Enter was pressed.
fn endpoint(ui: &mut Ui, fields: &mut Fields, endpoint: &mut Endpoint, host_name: &str, port_name: &str) -> bool {
    let mut is_entered = false;
    ui.horizontal(|ui| {
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let port = Number::new(&mut endpoint.port, 1.0..=65535.0, "", 0.2).width(PORT_WIDTH);
            fields.number(ui, port_name, "", port);
            let field = text_field(ui, &mut endpoint.host, host_name, words::HOST_HINT);
            fields.hand_over(host_name, &field);
            is_entered = is_entered_in(ui, &field);
        });
    });
    fields.remarks(ui, |name| name == port_name);
    is_entered
}

fn is_entered_in(ui: &Ui, field: &Response) -> bool {
    field.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter))
}

fn text_field(ui: &mut Ui, text: &mut String, name: &str, hint: &str) -> Response {
    let field = TextEdit::singleline(text).hint_text(hint).margin(vec2(8.0, 5.0)).desired_width(f32::INFINITY);
    let response = ui.add(field);
    let shown = text.clone();
    response.widget_info(|| {
        let mut info = WidgetInfo::text_edit(true, "", &shown, hint);
        info.label = Some(name.to_owned());
        info
    });
    response
}

fn connect(ui: &mut Ui, name: &str, refusal: Option<&str>) -> bool {
    let button = Button::new(words::CONNECT).min_size(vec2(0.0, 32.0));
    let response = ui.vertical_centered_justified(|ui| ui.add_enabled(refusal.is_none(), button)).inner;
    response.widget_info(|| WidgetInfo::labeled(Role::Button, refusal.is_none(), name));
    match refusal {
        Some(reason) => response.on_disabled_hover_text(reason).clicked(),
        None => response.clicked(),
    }
}

/// A pose in one line, for a proposal.
pub fn pose_line(ui: &mut Ui, rows: &[(String, String)]) {
    let words: Vec<String> = rows.iter().map(|(name, value)| format!("{name} {value}")).collect();
    let (position, orientation) = words.split_at(words.len().min(3));
    for part in [position, orientation] {
        ui.add(egui::Label::new(number_text(part.join("   "))).wrap());
    }
}
