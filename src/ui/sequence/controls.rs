//! The card above the pictures: the player, how the sequence is tracked, and what came of it.

use egui::{Align, ComboBox, DragValue, Label, Layout, Role, Ui, WidgetInfo, vec2};

use crate::app::workbench::sequence::{SequenceBench, SequenceCommand, TrackOptions};
use crate::app::{Command, Workbench};
use crate::odometry::{Estimator, Tracking};
use crate::report::odometry_file::frames_csv;
use crate::session::sequence::{Sequence, TrackedSequence, trajectory, trajectory_text};
use crate::text::odometry::{failure_message, tracking_word};
use crate::text::sequence as words;
use crate::ui::file_dialog::Purpose;
use crate::ui::save_file::{self, SaveFile};
use crate::ui::{PanelContext, theme, widgets};

use super::model::Model;
use super::player::Player;

/// Periods that make sense, s.
const PERIODS_S: std::ops::RangeInclusive<f64> = 0.0..=60.0;

/// Buttons, slider and what is known of the frame; how the sequence is tracked and what came of it. As high as that needs.
pub(super) fn card(
    ui: &mut Ui,
    context: &mut PanelContext<'_>,
    sequence: &Sequence,
    model: &Model,
    player: &mut Player,
    typed: &mut Option<TrackOptions>,
) {
    const OPTIONS_WIDTH: f32 = 330.0;
    widgets::card(
        ui,
        "",
        |_| {},
        |ui| {
            egui::Frame::new().inner_margin(egui::Margin::symmetric(10, 6)).show(ui, |ui| {
                ui.spacing_mut().item_spacing = vec2(6.0, 4.0);
                ui.horizontal(|ui| {
                    ui.set_min_height(28.0);
                    let width = (ui.available_width() - OPTIONS_WIDTH).max(160.0);
                    player.show(ui, &model.journey.times_s, width);
                    ui.with_layout(Layout::right_to_left(Align::Center), |ui| options(ui, context, typed));
                });
                let sentence =
                    frame_sentence(context.workbench.sequence(), sequence, &model.journey.times_s, player.frame_idx);
                ui.add(Label::new(&sentence).truncate());
                ui.horizontal(|ui| summary(ui, context.workbench, sequence, model));
            });
        },
    );
}

/// How the sequence is tracked, and the button for what waits to be done; from right to left.
fn options(ui: &mut Ui, context: &mut PanelContext<'_>, typed: &mut Option<TrackOptions>) {
    let workbench = context.workbench;
    let known = workbench.sequence().options();
    let mut options = typed.unwrap_or(known);
    if workbench.solve_progress().is_some() {
        if ui.button(words::STOP).clicked() {
            context.commands.push(Command::CancelSolve);
        }
    } else {
        let is_done = workbench.sequence().tracked().is_some() && options == known;
        let again = ui.add_enabled(!is_done, egui::Button::new(words::TRACK));
        if again.on_disabled_hover_text(words::TRACKED_ALREADY).clicked() {
            context.commands.push(Command::Sequence(SequenceCommand::Track(options)));
            *typed = None;
            return;
        }
    }
    let mut period_s = options.period_s.unwrap_or(0.0);
    let field = ui.add(DragValue::new(&mut period_s).range(PERIODS_S).speed(0.01).max_decimals(3).custom_formatter(
        |value, _| {
            if value > 0.0 { words::seconds(&widgets::fixed(value, 2)) } else { words::EVERY_FRAME.to_owned() }
        },
    ));
    field.widget_info(|| WidgetInfo::drag_value(true, period_s));
    let field = field.on_hover_text(words::PERIOD_HINT);
    options.period_s = Some(period_s).filter(|period_s| *period_s > 0.0);
    let label = ui.label(theme::dim(ui, words::PERIOD));
    field.labelled_by(label.id);
    let combo =
        ComboBox::from_id_salt("estimator").selected_text(words::estimator(options.estimator)).show_ui(ui, |ui| {
            for estimator in [Estimator::Ours, Estimator::Published] {
                ui.selectable_value(&mut options.estimator, estimator, words::estimator(estimator))
                    .on_hover_text(words::estimator_hint(estimator));
            }
        });
    combo.response.widget_info(|| {
        let mut info = WidgetInfo::labeled(Role::ComboBox, true, words::ESTIMATOR);
        info.current_text_value = Some(words::estimator(options.estimator).to_owned());
        info
    });
    *typed = Some(options).filter(|options| *options != known);
}

/// What is known of the frame in sight.
fn frame_sentence(bench: &SequenceBench, sequence: &Sequence, times_s: &[f64], frame_idx: usize) -> String {
    let Some(frame) = bench.seen().get(frame_idx) else { return words::OPENING.to_owned() };
    let time_s = times_s.get(frame_idx).copied().unwrap_or(0.0);
    let head = words::frame_head(frame_idx + 1, sequence.frames.len(), &widgets::fixed(time_s, 3));
    let found = match &frame.record.outcome {
        Err(error) => error.to_string(),
        Ok(summary) => match &summary.tracking {
            Tracking::Lost(failure) => failure_message(failure),
            Tracking::Tracked(motion) => words::tracked(
                tracking_word(&summary.tracking),
                motion.num_inliers,
                motion.num_matches,
                &widgets::fixed(frame.record.motion_ms, 1),
            ),
            other => tracking_word(other).to_owned(),
        },
    };
    format!("{head} · {found}")
}

/// What came of the sequence, and its files.
fn summary(ui: &mut Ui, workbench: &Workbench, sequence: &Sequence, model: &Model) {
    let bench = workbench.sequence();
    let Some(tracked) = bench.tracked() else {
        if let Some(progress) = workbench.solve_progress() {
            ui.label(theme::dim(ui, words::progress(progress.done, progress.total)));
        }
        return;
    };
    let travel = tracked.records.iter().rev().find_map(|record| record.outcome.as_ref().ok()).map(|last| last.travel);
    let text = words::summary(
        model.journey.ways.frames.len(),
        tracked.records.len(),
        travel.map(|travel| [travel.distance_mm / 1000.0, travel.turn_rad.to_degrees()]),
        tracked.evaluation.map(|found| [found.ate_rmse_mm, found.rpe_translation_rmse_mm]),
    );
    ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
        files(ui, tracked);
        ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
            let words = theme::dim(ui, text);
            let response = ui.add(Label::new(words).wrap());
            if !sequence.notes.is_empty() {
                let notes: Vec<String> = sequence.notes.iter().map(ToString::to_string).collect();
                response.on_hover_text(notes.join("\n"));
            }
        });
    });
}

/// The files that can be had of it.
fn files(ui: &mut Ui, tracked: &TrackedSequence) {
    ui.menu_button(words::SAVE, |ui| {
        let save = |ui: &mut Ui, label: &str, name: &str, contents: &dyn Fn() -> String| {
            if ui.button(label).clicked() {
                let contents = contents().into_bytes().into();
                save_file::ask(ui.ctx(), SaveFile { purpose: Purpose::SequenceFile, name: name.to_owned(), contents });
                ui.close();
            }
        };
        save(ui, words::SAVE_TRAJECTORY, "trajectory.txt", &|| {
            trajectory_text(trajectory(&tracked.records).iter().map(|pose| (pose.time_s, pose.world_from_sensor)))
        });
        save(ui, words::SAVE_FRAMES, "frames.csv", &|| frames_csv(&tracked.records));
    });
}
