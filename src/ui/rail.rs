//! The rail at the left: the steps in the order of work, each with its state. It leads; nothing is locked.

use egui::{Align2, CornerRadius, Rect, Role, Sense, TextStyle, Ui, WidgetInfo, vec2};

use crate::app::{CellView, Results, Workbench};
use crate::calibrate::Verdict;
use crate::device::LinkState;
use crate::diagnose::{Severity, verdict_with};
use crate::session::sequence::TrackedSequence;
use crate::session::{Session, Target};
use crate::text::capture as capture_words;
use crate::text::methods::verdict_mark;
use crate::text::report_panel as report_words;
use crate::text::sequence as sequence_words;
use crate::text::shell as words;

use super::actions::Action;
use super::capture::model::is_running;
use super::{Selection, theme};

/// Longer marks are words.
const MOST_SIGNS: usize = 4;
/// Height of a step, points: large enough for a gloved hand.
const STEP_HEIGHT: f32 = 40.0;

/// A step of the rail.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Step {
    /// Opening a session and its overview.
    #[default]
    Session,
    /// The live cell.
    Capture,
    /// Profiles with their circles and sweeps.
    Arcs,
    /// The pose table.
    Poses,
    /// Methods side by side.
    Compare,
    /// What is wrong, and what to do next.
    Diagnosis,
    /// What the calibration is worth on other data.
    Verify,
    /// What leaves the program.
    Report,
}

impl Step {
    /// All steps in the order of the rail.
    pub const ALL: [Self; 8] = [
        Self::Session,
        Self::Capture,
        Self::Arcs,
        Self::Poses,
        Self::Compare,
        Self::Diagnosis,
        Self::Verify,
        Self::Report,
    ];

    /// The step's name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Session => words::STEP_SESSION,
            Self::Capture => capture_words::STEP,
            Self::Arcs => words::STEP_ARCS,
            Self::Poses => words::STEP_POSES,
            Self::Compare => words::STEP_COMPARE,
            Self::Diagnosis => words::STEP_DIAGNOSIS,
            Self::Verify => words::STEP_VERIFY,
            Self::Report => report_words::STEP,
        }
    }

    /// Its name with what is on the bench: a sequence has no arcs.
    fn name_with(self, workbench: &Workbench) -> &'static str {
        if self == Self::Arcs && is_sequence(workbench) { sequence_words::STEP } else { self.name() }
    }

    fn hint_with(self, workbench: &Workbench) -> &'static str {
        if self == Self::Arcs && is_sequence(workbench) { sequence_words::STEP_HINT } else { self.hint() }
    }

    const fn hint(self) -> &'static str {
        match self {
            Self::Session => words::STEP_SESSION_HINT,
            Self::Capture => capture_words::STEP_HINT,
            Self::Arcs => words::STEP_ARCS_HINT,
            Self::Poses => words::STEP_POSES_HINT,
            Self::Compare => words::STEP_COMPARE_HINT,
            Self::Diagnosis => words::STEP_DIAGNOSIS_HINT,
            Self::Verify => words::STEP_VERIFY_HINT,
            Self::Report => report_words::STEP_HINT,
        }
    }
}

/// Whether an RGB-D sequence is on the bench.
#[must_use]
pub fn is_sequence(workbench: &Workbench) -> bool {
    workbench.document().is_some_and(|document| matches!(document.session.target, Target::Rgbd { .. }))
}

/// What stands at a step's right: the shape says it, the colour only repeats it.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Mark {
    None,
    Fine(String),
    Look(String),
    Bad(String),
}

/// Draws the rail; what there is to remark of the poses is known to their table.
pub fn show(
    ui: &mut Ui,
    workbench: &Workbench,
    selection: &Selection,
    num_pose_remarks: usize,
    current: Step,
    actions: &mut Vec<Action>,
) {
    ui.spacing_mut().item_spacing.y = 0.0;
    ui.add_space(theme::GAP);
    for (idx, step) in Step::ALL.into_iter().enumerate() {
        let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), STEP_HEIGHT), Sense::click());
        let is_current = step == current;
        response.widget_info(|| WidgetInfo::selected(Role::Tab, true, is_current, step.name_with(workbench)));
        let inner = Rect::from_min_max(rect.min + vec2(8.0, 2.0), rect.max - vec2(8.0, 2.0));
        paint_step(
            ui,
            inner,
            idx + 1,
            step.name_with(workbench),
            is_current,
            response.hovered() || response.has_focus(),
        );
        paint_mark(ui, inner, &mark(workbench, selection, num_pose_remarks, step));
        if response.on_hover_text(step.hint_with(workbench)).clicked() {
            actions.push(Action::GoTo(step));
        }
    }
}

fn paint_step(ui: &Ui, rect: Rect, number: usize, name: &str, is_current: bool, is_hovered: bool) {
    let palette = theme::palette(ui);
    let painter = ui.painter();
    if is_current || is_hovered {
        let fill = if is_current { palette.selected } else { palette.hovered };
        painter.rect_filled(rect, CornerRadius::same(theme::RADIUS), fill);
    }
    let font = TextStyle::Body.resolve(ui.style());
    let strong = theme::strong_font();
    let left = rect.left_center();
    let number_color = if is_current { palette.accent } else { palette.text_dim };
    painter.text(left + vec2(12.0, 0.0), Align2::LEFT_CENTER, number, font.clone(), number_color);
    let (name_font, name_color) = if is_current { (strong, palette.accent) } else { (font, palette.text) };
    painter.text(left + vec2(32.0, 0.0), Align2::LEFT_CENTER, name, name_font, name_color);
}

fn paint_mark(ui: &Ui, rect: Rect, mark: &Mark) {
    let palette = theme::palette(ui);
    let (text, color) = match mark {
        Mark::None => return,
        Mark::Fine(text) => (text, palette.good),
        Mark::Look(text) => (text, palette.warn),
        Mark::Bad(text) => (text, palette.bad),
    };
    // A word has less room than a sign.
    let style = if text.chars().count() > MOST_SIGNS { TextStyle::Small } else { TextStyle::Body };
    let font = style.resolve(ui.style());
    ui.painter().text(rect.right_center() - vec2(12.0, 0.0), Align2::RIGHT_CENTER, text, font, color);
}

/// Broken, moving, or ready; nothing where no cell is wanted.
fn capture_mark(cell: &CellView) -> Mark {
    let states = [&cell.robot.state, &cell.sensor.state];
    if states.iter().any(|state| matches!(state, LinkState::Failed { .. })) {
        Mark::Bad("✖".to_owned())
    } else if is_running(cell) {
        Mark::Look("▶".to_owned())
    } else if cell.is_armed {
        // In a word, as it is seen in every step and after every run.
        Mark::Look(capture_words::ARMED_MARK.to_owned())
    } else if states.iter().all(|state| **state == LinkState::Ready) {
        Mark::Fine("✔".to_owned())
    } else {
        Mark::None
    }
}

/// Whether data that the answer was not computed from speak for it or against it; nothing where there are none.
fn verify_mark(workbench: &Workbench) -> Mark {
    let found = workbench.verification().last().filter(|found| workbench.is_current(found.revision));
    match found.and_then(|found| found.value.is_borne_out()) {
        Some(true) => Mark::Fine("✔".to_owned()),
        Some(false) => Mark::Look("!".to_owned()),
        None => Mark::None,
    }
}

/// Whether nothing is seen of the target that the answer comes from.
fn has_nothing(session: &Session) -> bool {
    session.stations.is_empty() && !matches!(session.target, Target::Rgbd { .. })
}

/// Frames of a sequence that were to be tracked and have no pose.
fn num_untracked(results: &Results) -> usize {
    results.measured.sequence().map(TrackedSequence::counts).map_or(0, |counts| counts.lost + counts.unreadable)
}

fn mark(workbench: &Workbench, selection: &Selection, num_pose_remarks: usize, step: Step) -> Mark {
    if step == Step::Capture {
        return capture_mark(workbench.cell());
    }
    let (Some(document), Some(results)) = (workbench.document(), workbench.results()) else {
        return match (step, workbench.document()) {
            (Step::Session, Some(_)) => Mark::Fine("✔".to_owned()),
            _ => Mark::None,
        };
    };
    let counted = |number: usize| match number {
        0 => Mark::Fine("✔".to_owned()),
        number @ 1..=9 => Mark::Look(format!("{number} !")),
        _ => Mark::Look("9+ !".to_owned()),
    };
    match step {
        Step::Session => Mark::Fine("✔".to_owned()),
        Step::Capture | Step::Report => Mark::None,
        Step::Verify => verify_mark(workbench),
        // Nothing is no reason for a tick, nor for a cross.
        Step::Arcs if is_sequence(workbench) => counted(num_untracked(results)),
        Step::Poses if document.session.stations.is_empty() => Mark::None,
        Step::Arcs | Step::Compare | Step::Diagnosis if has_nothing(&document.session) => Mark::None,
        Step::Arcs => counted(super::poses::model::num_refused(&document.session, results)),
        Step::Poses => counted(num_pose_remarks),
        Step::Compare => match results.method(selection.method).map(|result| &result.outcome) {
            Some(Ok(solution)) => {
                let (verdict, _) = verdict_with(solution, workbench.current_diagnosis());
                let shape = verdict_mark(verdict).to_owned();
                match verdict {
                    Verdict::Good => Mark::Fine(shape),
                    Verdict::Usable => Mark::Look(shape),
                    Verdict::NotUsable => Mark::Bad(shape),
                }
            }
            Some(Err(_)) => Mark::Bad("✖".to_owned()),
            // A target that no calibration is computed from has no methods.
            None => Mark::None,
        },
        // Nothing while it is under way: a mark of an earlier diagnosis would be believed.
        Step::Diagnosis => workbench.current_diagnosis().map_or(Mark::None, |diagnosis| {
            if diagnosis.findings.iter().any(|finding| finding.severity == Severity::Wrong) {
                Mark::Bad("✖".to_owned())
            } else {
                counted(diagnosis.findings.len())
            }
        }),
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;
    use std::time::{Duration, Instant};

    use super::*;
    use crate::app::Command;

    #[test]
    fn a_session_without_stations_is_no_failure() {
        let mut workbench = Workbench::new(Arc::new(|| {}));
        workbench.apply(Command::NewSession(Target::ball(15.0)));
        let start = Instant::now();
        while workbench.results().is_none() {
            assert!(start.elapsed() < Duration::from_mins(2), "it is solved, or refused");
            workbench.poll();
            std::thread::sleep(Duration::from_millis(2));
        }
        let selection = Selection::default();
        for step in Step::ALL.into_iter().filter(|step| *step != Step::Session) {
            assert_eq!(mark(&workbench, &selection, 0, step), Mark::None, "{}", step.name());
        }
    }
}
