//! The line at the bottom: the next step, and how the solver is doing. Above it, notices.

use egui::{Align, Layout, ProgressBar, RichText, Ui};

use crate::app::{Command, Notice, NoticeKind, Workbench};
use crate::session::Reading;
use crate::text::shell as words;
use crate::text::start::captures as captures_text;

use super::actions::Action;
use super::rail::Step;
use super::{theme, widgets};

/// Width of the progress bar, points.
const BAR_WIDTH: f32 = 160.0;

/// Draws the line.
pub fn show(ui: &mut Ui, workbench: &Workbench, step: Step, actions: &mut Vec<Action>, commands: &mut Vec<Command>) {
    ui.horizontal_centered(|ui| {
        if let Some((label, action)) = next(workbench, step) {
            ui.label(words::NEXT);
            ui.add_space(4.0);
            if widgets::primary_button(ui, label).clicked() {
                actions.push(action);
            }
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            progress_or_summary(ui, workbench, commands);
        });
    });
}

fn next(workbench: &Workbench, step: Step) -> Option<(&'static str, Action)> {
    let document = workbench.document()?;
    match step {
        Step::Session => Some((words::NEXT_ARCS, Action::GoTo(Step::Arcs))),
        Step::Arcs => Some((words::NEXT_POSES, Action::GoTo(Step::Poses))),
        Step::Poses => Some((words::NEXT_COMPARE, Action::GoTo(Step::Compare))),
        Step::Compare => document.is_unsaved().then_some((words::NEXT_SAVE, Action::Save)),
    }
}

/// From right to left, as the layout runs.
fn progress_or_summary(ui: &mut Ui, workbench: &Workbench, commands: &mut Vec<Command>) {
    if let Some(progress) = workbench.solve_progress() {
        if ui.button(words::CANCEL).clicked() {
            commands.push(Command::CancelSolve);
        }
        ui.add(ProgressBar::new(fraction(progress.done, progress.total)).desired_width(BAR_WIDTH).desired_height(6.0));
        ui.label(theme::dim(ui, words::solving_progress(progress.done, progress.total)));
    } else if workbench.is_loading() {
        ui.label(theme::dim(ui, words::READING_FILE));
    }
    let Some(document) = workbench.document() else { return };
    let Some(results) = workbench.results() else {
        // The first solve was cancelled.
        if !workbench.is_busy() && ui.button(words::SOLVE).clicked() {
            commands.push(Command::Solve);
        }
        return;
    };
    if workbench.results_are_current() {
        let stations = || document.session.stations.iter().filter(|station| station.enabled);
        let captures = || stations().flat_map(|station| &station.captures);
        let num_points = captures().filter(|capture| matches!(capture.reading, Reading::Point(_))).count();
        let captures = captures_text(captures().count() - num_points, num_points);
        let summary = words::summary(stations().count(), &captures, results.elapsed.as_millis());
        ui.label(theme::dim(ui, summary));
    } else {
        if !workbench.is_busy() && ui.button(words::SOLVE).clicked() {
            commands.push(Command::Solve);
        }
        let color = theme::palette(ui).warn;
        ui.label(RichText::new(format!("! {}", words::OUT_OF_DATE)).color(color))
            .on_hover_text(words::OUT_OF_DATE_HINT);
    }
}

#[expect(clippy::cast_precision_loss, reason = "a progress bar is a few hundred points wide")]
fn fraction(done: usize, total: usize) -> f32 {
    if total == 0 { 0.0 } else { done as f32 / total as f32 }
}

/// The notices that stand above the line: on the Session page, errors of opening stand beside the path field instead.
pub fn notices_shown(workbench: &Workbench, step: Step) -> impl Iterator<Item = &Notice> {
    workbench.notices().iter().filter(move |notice| step != Step::Session || !notice.is_of_opening)
}

/// Draws these notices, newest last, each with a button to dismiss it.
pub fn notices(ui: &mut Ui, workbench: &Workbench, step: Step, commands: &mut Vec<Command>) {
    for notice in notices_shown(workbench, step) {
        let palette = theme::palette(ui);
        let (mark, color) = match notice.kind {
            NoticeKind::Done => ("✔", palette.good),
            NoticeKind::Error => ("✖", palette.bad),
        };
        ui.horizontal(|ui| {
            ui.label(RichText::new(mark).color(color));
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                if widgets::symbol_button(ui, "×", words::DISMISS).clicked() {
                    commands.push(Command::DismissNotice(notice.id));
                }
                ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                    ui.add(egui::Label::new(&notice.message).wrap());
                });
            });
        });
    }
}
