//! What is done with the cell: this station, the next one, a whole run, and the replay of a session.

use egui::{Align, Frame, Label, Layout, Margin, ProgressBar, Ui, UiBuilder, vec2};

use crate::app::cell::{CellCommand, Proposal, StationRoutine};
use crate::calibrate::verdict::GOOD_UP_TO_MM;
use crate::device::{MotionRefusal, RoutineEnd};
use crate::session::Target;
use crate::text::capture as words;
use crate::text::capture_edges as words_of_edges;
use crate::text::cell::reason_of_end;
use crate::text::typeset::std_text;
use crate::ui::theme;
use crate::ui::widgets::{card_with_height, fixed};

use super::connection::pose_line;
use super::fields::{Number, hint, remark, tall_button};
use super::model::{self, refusal};
use super::next;
use super::orientation;
use super::panel::Desk;

/// Height of each card, points.
const HEIGHT: f32 = 212.0;
/// Width of the field for the number of stations, points.
const STATIONS_WIDTH: f32 = 72.0;
/// Side of the picture of an orientation, points.
const PICTURE_SIZE: f32 = 104.0;
/// From this width on the cards stand side by side.
const SIDE_BY_SIDE_FROM: f32 = 800.0;

/// Height of all cards in so much width, points.
pub fn height(width: f32) -> f32 {
    if width >= SIDE_BY_SIDE_FROM { HEIGHT } else { 2.0f32.mul_add(HEIGHT, theme::GAP) }
}

/// Shows the cards.
pub fn show(ui: &mut Ui, desk: &mut Desk<'_>) {
    if ui.available_width() >= SIDE_BY_SIDE_FROM {
        row(ui, desk, &[(station, 0.26), (next_station, 0.4), (run, 0.34)]);
    } else {
        row(ui, desk, &[(station, 0.46), (run, 0.54)]);
        let top = ui.cursor().top();
        next_station(ui, desk);
        // A new proposal is to be looked at before it is gone to.
        let proposal = desk.view.cell.proposal.as_ref();
        let proposed = proposal.map(|proposal| proposal.station.base_from_flange.translation_mm());
        if proposed.is_some() && proposed != desk.state.seen_proposal {
            ui.scroll_to_rect(ui.min_rect().with_min_y(top), None);
        }
        desk.state.seen_proposal = proposed;
    }
}

type Card = fn(&mut Ui, &mut Desk<'_>);

/// Cards beside each other, each with its part of the width.
fn row(ui: &mut Ui, desk: &mut Desk<'_>, cards: &[(Card, f32)]) {
    let area = ui.available_rect_before_wrap();
    let area = area.with_max_y(area.top() + HEIGHT);
    let (mut left, mut part_before) = (area.left(), 0.0);
    for (card, part) in cards {
        part_before += part;
        let right = area.left() + ((area.width() + theme::GAP) * part_before).round() - theme::GAP;
        let mut inside = ui.new_child(UiBuilder::new().max_rect(area.with_min_x(left).with_max_x(right)));
        card(&mut inside, desk);
        left = right + theme::GAP;
    }
    ui.allocate_rect(area, egui::Sense::hover());
}

fn body(ui: &mut Ui, contents: impl FnOnce(&mut Ui)) {
    Frame::new().inner_margin(Margin::symmetric(12, 10)).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 6.0;
        contents(ui);
    });
}

/// A button that asks for a command, or says why it cannot be given.
fn ask(ui: &mut Ui, desk: &mut Desk<'_>, label: &str, name: &str, hint: &str, command: CellCommand) {
    let reason = refusal(&desk.view, &command);
    if tall_button(ui, label, name, hint, reason) {
        desk.ask(command);
    }
}

fn station(ui: &mut Ui, desk: &mut Desk<'_>) {
    let num_stations = desk.view.num_stations();
    let target = desk.view.target();
    let is_of_edges = desk.view.is_of_edges();
    card_with_height(
        ui,
        words::STATION,
        HEIGHT,
        |_| {},
        |ui| {
            body(ui, |ui| {
                ui.with_layout(Layout::top_down_justified(Align::Center), |ui| {
                    match target {
                        Some(Target::RightAnglePlate) => {}
                        Some(Target::Point) => {
                            let (find, hint) = (words_of_edges::FIND, words_of_edges::FIND_HINT);
                            ask(ui, desk, find, find, hint, CellCommand::FindTip);
                        }
                        _ => ask(ui, desk, words::FIND, words::FIND, words::FIND_HINT, CellCommand::FindLargestArc),
                    }
                    let name = target.map_or(words::CAPTURE, words::capture_name);
                    ask(ui, desk, words::CAPTURE_SHORT, name, words::CAPTURE_HINT, CellCommand::CaptureStation);
                });
                let live = desk.view.cell.live.as_ref();
                if is_of_edges && live.is_some_and(|live| live.found.is_err()) {
                    remark(ui, "!", words_of_edges::NOT_SEEN, theme::palette(ui).warn);
                }
                hint(ui, &words::num_stations(num_stations));
                if let Some(outlook) = desk.view.outlook.filter(|_| !model::is_running(desk.view.cell)) {
                    hint(ui, &words::outlook(&std_text(outlook.std_mm), outlook.num_to_good, GOOD_UP_TO_MM));
                }
                if let Some(std_mm) = desk.view.cell.repeat_std_mm {
                    hint(ui, &words::repeat_noise(&fixed(std_mm * 1000.0, 1)));
                }
                match &desk.view.cell.last_end {
                    // How a search ended stands below its boxes.
                    Some(end) if !matches!(end, RoutineEnd::Searched(_)) => {
                        let palette = theme::palette(ui);
                        match reason_of_end(end) {
                            None => remark(ui, "✔", words::CAPTURED, palette.good),
                            Some(reason) => remark(ui, "!", &words::sentence(&reason), palette.warn),
                        }
                    }
                    _ => {}
                }
            });
        },
    );
}

fn next_station(ui: &mut Ui, desk: &mut Desk<'_>) {
    card_with_height(ui, words::NEXT_STATION, HEIGHT, |_| {}, |ui| body(ui, |ui| proposal(ui, desk)));
}

fn proposal(ui: &mut Ui, desk: &mut Desk<'_>) {
    let Some(proposal) = desk.view.cell.proposal.as_ref() else {
        let sentence = if desk.view.knows_mounting() { words::NO_PROPOSAL } else { words::NEEDS_MOUNTING };
        hint(ui, sentence);
        ask(ui, desk, words::PROPOSE, words::PROPOSE_NAME, "", CellCommand::ProposeStation);
        return;
    };
    let area = ui.available_rect_before_wrap().with_max_y(ui.cursor().top() + PICTURE_SIZE);
    let (left, right) = area.split_left_right_at_x(area.right() - PICTURE_SIZE);
    let mut beside = ui.new_child(UiBuilder::new().max_rect(left));
    proposed(&mut beside, desk, proposal);
    orientation::show(ui, right, &desk.view, proposal);
    ui.advance_cursor_after_rect(area);
    ui.horizontal(|ui| {
        let refused = proposal.refusal.as_ref().map(ToString::to_string);
        let reason = refused.as_deref().or_else(|| refusal(&desk.view, &CellCommand::AcceptProposal));
        if tall_button(ui, words::ACCEPT, words::ACCEPT, words::ACCEPT_HINT, reason) {
            desk.ask(CellCommand::AcceptProposal);
        }
        ask(ui, desk, words::ANOTHER, words::ANOTHER_NAME, "", CellCommand::SkipProposal);
        ask(ui, desk, words::FORGET, words::FORGET_NAME, "", CellCommand::DropProposal);
    });
}

fn proposed(ui: &mut Ui, desk: &Desk<'_>, proposal: &Proposal) {
    /// A planned pose need not be reached more exactly.
    const RESOLUTION_MM: f64 = 0.1;
    let station = &proposal.station;
    ui.spacing_mut().item_spacing.y = 2.0;
    pose_line(ui, &model::pose_rows(&desk.view.notation(), &station.base_from_flange, RESOLUTION_MM));
    let way = words::way(&fixed(proposal.distance_mm, 0), &fixed(proposal.turn_deg, 0));
    ui.label(theme::dim(ui, way));
    match &proposal.refusal {
        // Of the arm switch the band speaks already.
        None | Some(MotionRefusal::NotArmed) => {
            ui.add(Label::new(&proposal.reason).wrap());
        }
        Some(refusal) => remark(ui, "✖", &refusal.to_string(), theme::palette(ui).bad),
    }
}

fn run(ui: &mut Ui, desk: &mut Desk<'_>) {
    card_with_height(
        ui,
        words::RUN,
        HEIGHT,
        |_| {},
        |ui| {
            body(ui, |ui| {
                if desk.view.cell.replay.is_some() {
                    replay(ui, desk);
                } else if model::is_running(desk.view.cell) && desk.view.cell.run.is_some() {
                    run_under_way(ui, desk);
                } else {
                    run_settings(ui, desk);
                }
            });
        },
    );
}

fn run_settings(ui: &mut Ui, desk: &mut Desk<'_>) {
    ui.spacing_mut().item_spacing.y = 2.0;
    let field = Number::new(&mut desk.memory.num_stations.0, 1.0..=60.0, "", 0.05).width(STATIONS_WIDTH);
    desk.state.fields.row(ui, words::RUN_STATIONS, "", field);
    desk.state.fields.remarks(ui, |name| name == words::RUN_STATIONS);
    let mut settings = desk.view.cell.settings;
    // Of a plate it is always one profile.
    let has_choice = !desk.view.is_plate();
    let search = if desk.view.is_of_edges() { words_of_edges::SEARCHED_TIP } else { words::LARGEST_ARC };
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = theme::GAP;
        for (routine, name) in [(StationRoutine::LargestArc, search), (StationRoutine::FixedPoint, words::FIXED_POINT)]
        {
            if has_choice {
                ui.radio_value(&mut settings.routine, routine, name);
            }
        }
    });
    ui.checkbox(&mut settings.asks_before_motion, words::ASKS);
    desk.set(&settings);
    ui.add_space(4.0);
    ui.horizontal(|ui| {
        let num_stations = desk.memory.num_stations.0;
        let start = CellCommand::StartRun { num_stations };
        ask(ui, desk, words::START_RUN, words::START_RUN, words::START_RUN_HINT, start);
        ask(ui, desk, words::REPLAY, words::REPLAY, words::REPLAY_HINT, CellCommand::StartReplay);
    });
    if let Some(run) = desk.view.cell.run {
        hint(ui, &words::run_progress(run.num_done, run.num_stations, run.num_failed));
    }
}

fn run_under_way(ui: &mut Ui, desk: &mut Desk<'_>) {
    let Some(run) = desk.view.cell.run else { return };
    let part = f32::from(run.num_done + run.num_failed) / f32::from(run.num_stations.max(1));
    ui.label(theme::strong(words::run_progress(run.num_done, run.num_stations, run.num_failed)));
    let accent = theme::palette(ui).accent;
    // The track is to be seen before anything is done.
    ui.visuals_mut().extreme_bg_color = theme::palette(ui).hairline;
    ui.add(ProgressBar::new(part).desired_height(8.0).fill(accent));
    let state = match (run.is_asking, run.is_paused) {
        (true, _) => words::RUN_ASKS,
        (_, true) => words::RUN_PAUSED,
        _ => "",
    };
    hint(ui, state);
    ui.horizontal(|ui| {
        if run.is_paused {
            ask(ui, desk, words::RESUME, words::RESUME_NAME, "", CellCommand::ResumeRun);
        } else {
            ask(ui, desk, words::PAUSE, words::PAUSE_NAME, words::PAUSE_HINT, CellCommand::PauseRun);
        }
    });
}

fn replay(ui: &mut Ui, desk: &mut Desk<'_>) {
    let is_over = desk.view.cell.replay.is_some_and(|replay| replay.is_over);
    let sentence = if is_over { Some(words::REPLAY_OVER.to_owned()) } else { next::replay_words(&desk.view) };
    ui.add(Label::new(sentence.unwrap_or_default()).wrap());
    ui.allocate_space(vec2(0.0, 4.0));
    ask(ui, desk, words::END_REPLAY, words::END_REPLAY, "", CellCommand::EndReplay);
}
