//! The line at the bottom: the next step, and how the solver is doing. Above it, notices.

use egui::{Align, Layout, ProgressBar, RichText, Ui, vec2};

use crate::app::cell::CellCommand;
use crate::app::{Command, Notice, NoticeKind, Progress, Workbench};
use crate::diagnose::{Finding, Severity};
use crate::session::{Reading, Target};
use crate::text::capture as capture_words;
use crate::text::diagnosis_panel as panel_words;
use crate::text::import as import_words;
use crate::text::report_panel as report_words;
use crate::text::shell as words;
use crate::text::start::{board_poses, captures as captures_text};

use super::actions::Action;
use super::capture::{self, model::may_be_moving};
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
            if widgets::primary_button(ui, &label).clicked() {
                actions.push(action);
            }
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            // The capture step has a larger one of its own.
            if step != Step::Capture && may_be_moving(workbench.cell()) {
                stop(ui, workbench, commands);
            }
            progress_or_summary(ui, workbench, commands);
        });
    });
}

/// The robot moves while another step is in sight.
fn stop(ui: &mut Ui, workbench: &Workbench, commands: &mut Vec<Command>) {
    if capture::stop_button(ui, vec2(0.0, 32.0), capture_words::STOP_ROBOT, true) {
        commands.push(Command::Cell(Box::new(CellCommand::Stop)));
    }
    if let Some(run) = workbench.cell().run {
        ui.label(capture_words::run_progress(run.num_done, run.num_stations, run.num_failed));
    }
}

/// Along the rail. A session without stations needs some; findings go first wherever one is, as they change all that follows.
fn next(workbench: &Workbench, step: Step) -> Option<(String, Action)> {
    // The capture step's own band says what comes next.
    let document = workbench.document().filter(|_| step != Step::Capture)?;
    if document.session.stations.is_empty() && !matches!(document.session.target, Target::Rgbd { .. }) {
        let (label, action) = match step {
            Step::Poses => (import_words::IMPORT, Action::Import),
            _ => (words::NEXT_POSES, Action::GoTo(Step::Poses)),
        };
        return Some((label.to_owned(), action));
    }
    if step == Step::Report {
        // The last step; what is wrong stands in the report itself.
        return None;
    }
    let is_serious = |finding: &&Finding| finding.severity != Severity::Note;
    let findings = workbench.current_diagnosis().map_or(&[][..], |diagnosis| &diagnosis.findings);
    let num_findings = findings.iter().filter(is_serious).count();
    if num_findings > 0 && step != Step::Diagnosis {
        return Some((words::next_findings(num_findings), Action::GoTo(Step::Diagnosis)));
    }
    let is_scanned = document.session.target == Target::Workpiece && step != Step::Verify;
    let (label, action) = match step {
        // Nothing is computed from it that the other steps would show.
        _ if is_scanned => (words::NEXT_VERIFY, Action::GoTo(Step::Verify)),
        Step::Session | Step::Capture => (words::next_arcs(&document.session.target), Action::GoTo(Step::Arcs)),
        // A sequence brings its own poses.
        Step::Arcs if matches!(document.session.target, Target::Rgbd { .. }) => {
            (words::NEXT_COMPARE, Action::GoTo(Step::Compare))
        }
        Step::Arcs => (words::NEXT_POSES, Action::GoTo(Step::Poses)),
        Step::Poses => (words::NEXT_COMPARE, Action::GoTo(Step::Compare)),
        Step::Compare => (words::NEXT_DIAGNOSIS, Action::GoTo(Step::Diagnosis)),
        Step::Diagnosis | Step::Verify if document.is_unsaved() => (words::NEXT_SAVE, Action::Save),
        Step::Diagnosis | Step::Verify | Step::Report => (report_words::NEXT_REPORT, Action::GoTo(Step::Report)),
    };
    Some((label.to_owned(), action))
}

/// The job that is told of: the one that the user waits for most.
fn running(workbench: &Workbench) -> Option<(Progress, String, Command)> {
    let told = |progress: Option<Progress>, words: fn(usize, usize) -> String, cancel: Command| {
        progress.map(|progress| (progress, words(progress.done, progress.total), cancel))
    };
    told(workbench.solve_progress(), words::solving_progress, Command::CancelSolve)
        .or_else(|| told(workbench.bootstrap().progress(), panel_words::bootstrap_progress, Command::CancelBootstrap))
        .or_else(|| told(workbench.report().progress(), report_words::gathering_progress, Command::CancelReport))
        .or_else(|| told(workbench.diagnosis().progress(), words::diagnosing_progress, Command::CancelDiagnosis))
}

/// From right to left, as the layout runs.
fn progress_or_summary(ui: &mut Ui, workbench: &Workbench, commands: &mut Vec<Command>) {
    if let Some((progress, words, cancel)) = running(workbench) {
        ui.label(theme::dim(ui, words));
        ui.add(ProgressBar::new(progress.fraction()).desired_width(BAR_WIDTH).desired_height(6.0));
        // Never in the corner: that is where the robot is stopped.
        if ui.button(words::CANCEL).clicked() {
            commands.push(cancel);
        }
    } else if workbench.is_loading() {
        ui.label(theme::dim(ui, words::READING_FILE));
    }
    let Some(document) = workbench.document() else { return };
    let Some(results) = workbench.results() else {
        // The first solve was cancelled.
        if workbench.solve_progress().is_none() && ui.button(words::SOLVE).clicked() {
            commands.push(Command::Solve);
        }
        return;
    };
    if workbench.results_are_current() {
        let stations = || document.session.stations.iter().filter(|station| station.enabled);
        let captures = || stations().flat_map(|station| &station.captures);
        let num_points = captures().filter(|capture| matches!(capture.reading, Reading::Point(_))).count();
        let captures = match document.session.target {
            Target::Pose { .. } => board_poses(captures().count()),
            _ => captures_text(captures().count() - num_points, num_points),
        };
        if document.session.stations.is_empty() {
            return;
        }
        let elapsed_ms = (!results.methods.is_empty()).then_some(results.elapsed.as_millis());
        let summary = words::summary(stations().count(), &captures, elapsed_ms);
        ui.label(theme::dim(ui, summary));
    } else {
        if workbench.solve_progress().is_none() && ui.button(words::SOLVE).clicked() {
            commands.push(Command::Solve);
        }
        let color = theme::palette(ui).warn;
        ui.label(RichText::new(format!("! {}", words::OUT_OF_DATE)).color(color))
            .on_hover_text(words::OUT_OF_DATE_HINT);
    }
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
