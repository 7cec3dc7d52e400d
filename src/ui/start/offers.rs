//! What the start page offers besides opening a file: work that another run left behind, and a new session.

use std::path::PathBuf;
use std::time::SystemTime;

use egui::{Align, Button, Frame, Label, Layout, RichText, Role, TextEdit, Ui, WidgetInfo, vec2};

use crate::app::cell::PRACTICE_PARTS;
use crate::app::{Command, Recoverable};
use crate::session::{Edit, Session, SetupField, Target, table::parse_number};
use crate::text::capture as capture_words;
use crate::text::document as document_words;
use crate::text::start as words;
use crate::ui::actions::Action;
use crate::ui::rail::Step;
use crate::ui::widgets::{card, primary_button};
use crate::ui::{PanelContext, theme};

use super::form::problem_line;
use super::form_model::{TargetKind, USUAL_RADIUS_MM};

/// What is being asked and typed here.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OffersState {
    /// The copy that the user has said to throw away, until it is said twice.
    to_discard: Option<PathBuf>,
    radius: String,
    problem: Option<String>,
}

/// Draws the card of what other runs have left behind, if they have.
pub fn recovery(ui: &mut Ui, context: &mut PanelContext<'_>, state: &mut OffersState) {
    let recoverable = context.workbench.recoverable();
    if recoverable.is_empty() {
        return;
    }
    card(
        ui,
        document_words::RECOVERY,
        |_| {},
        |ui| {
            Frame::new().inner_margin(12).show(ui, |ui| {
                for (idx, recoverable) in recoverable.iter().enumerate() {
                    if idx > 0 {
                        ui.add_space(8.0);
                    }
                    offer(ui, idx, recoverable, context.commands, state);
                }
            });
        },
    );
    ui.add_space(theme::GAP);
}

fn offer(ui: &mut Ui, idx: usize, recoverable: &Recoverable, commands: &mut Vec<Command>, state: &mut OffersState) {
    let title = match &recoverable.origin {
        Ok(origin) if origin.title.is_empty() => words::NO_NAME.to_owned(),
        Ok(origin) => origin.title.clone(),
        Err(_) => recoverable.file.display().to_string(),
    };
    ui.horizontal(|ui| {
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if state.to_discard.as_ref() == Some(&recoverable.file) {
                if ui.button(document_words::KEEP).clicked() {
                    state.to_discard = None;
                }
                if ui.button(document_words::DISCARD_FOR_GOOD).clicked() {
                    state.to_discard = None;
                    commands.push(Command::DiscardRecoverable(idx));
                }
            } else {
                let discard = ui.button(document_words::DISCARD);
                discard.widget_info(|| WidgetInfo::labeled(Role::Button, true, document_words::discard(&title)));
                if discard.clicked() {
                    state.to_discard = Some(recoverable.file.clone());
                }
                if recoverable.origin.is_ok() {
                    let words = document_words::RECOVER;
                    let recover = if idx == 0 { primary_button(ui, words) } else { ui.button(words) };
                    recover.widget_info(|| WidgetInfo::labeled(Role::Button, true, document_words::recover(&title)));
                    if recover.on_hover_text(document_words::RECOVER_HINT).clicked() {
                        commands.push(Command::Recover(idx));
                    }
                }
            }
            ui.with_layout(Layout::top_down(Align::Min), |ui| {
                ui.add(Label::new(theme::strong(&title)).truncate());
                match &recoverable.origin {
                    Ok(origin) => {
                        let age = SystemTime::now().duration_since(origin.written_at).unwrap_or_default();
                        let sentence = document_words::left_behind(age, origin.num_edits, origin.last_edit.as_deref());
                        ui.add(Label::new(theme::dim(ui, sentence)).wrap());
                    }
                    Err(error) => {
                        let color = theme::palette(ui).bad;
                        ui.add(Label::new(RichText::new(format!("✖ {error}")).color(color)).wrap());
                    }
                }
            });
        });
    });
}

/// Draws the card of the live cell: the ways to measure instead of opening what was measured.
pub fn cell(ui: &mut Ui, context: &mut PanelContext<'_>) {
    let nothing_at_right = |_: &mut Ui| {};
    card(ui, "", nothing_at_right, |ui| {
        Frame::new().inner_margin(12).show(ui, |ui| {
            ui.horizontal(|ui| {
                ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                    if ui.button(capture_words::CONNECT_CELL).clicked() {
                        context.actions.push(Action::GoTo(Step::Capture));
                    }
                    // The last one stands at the left.
                    for part in PRACTICE_PARTS.into_iter().rev() {
                        let practise = ui.button(capture_words::practise_button(part));
                        let name = capture_words::practise_on(part);
                        practise.widget_info(|| WidgetInfo::labeled(Role::Button, true, name));
                        if practise.on_hover_text(capture_words::practise_hint(part)).clicked() {
                            context.actions.push(Action::Practise(part));
                        }
                    }
                    ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                        ui.label(theme::strong(capture_words::CELL));
                        ui.add(Label::new(theme::dim(ui, capture_words::CELL_LEAD)).wrap());
                    });
                });
            });
        });
    });
}

/// Draws the row of targets to begin a session for.
pub fn new_session(ui: &mut Ui, context: &mut PanelContext<'_>, state: &mut OffersState) {
    ui.add_space(8.0);
    ui.label(theme::dim(ui, words::NEW_SESSION));
    ui.horizontal_wrapped(|ui| {
        for kind in TargetKind::ALL {
            let button = ui.add(Button::new(words::preset(kind.name(), kind == TargetKind::Ball, USUAL_RADIUS_MM)));
            if button.on_hover_text(kind.hint()).clicked() {
                context.commands.push(Command::NewSession(kind.target()));
            }
        }
        ui.add_space(8.0);
        ui.label(theme::dim(ui, words::OTHER_BALL));
        let field = TextEdit::singleline(&mut state.radius).margin(vec2(8.0, 5.0)).desired_width(56.0);
        let field = ui.add(field.align(egui::Align2::RIGHT_CENTER).font(theme::number_font()));
        let text = state.radius.clone();
        field.widget_info(|| {
            let mut info = WidgetInfo::text_edit(true, "", &text, "");
            info.label = Some(words::OTHER_BALL_NAME.to_owned());
            info
        });
        if field.changed() {
            state.problem = None;
        }
        ui.label(theme::dim(ui, "mm"));
        let is_entered = field.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
        let can_begin = !state.radius.trim().is_empty();
        if ui.add_enabled(can_begin, Button::new(words::BEGIN)).clicked() || (is_entered && can_begin) {
            match ball(&state.radius) {
                Ok(target) => context.commands.push(Command::NewSession(target)),
                Err(problem) => state.problem = Some(problem),
            }
        }
    });
    if let Some(problem) = &state.problem {
        problem_line(ui, problem);
    }
}

/// A ball of a typed radius; refused as an edit of the radius would be.
fn ball(text: &str) -> Result<Target, String> {
    let radius_mm = parse_number(text).map_err(|refusal| refusal.to_string())?;
    let target = Target::ball(radius_mm);
    let edit = Edit::Setup(SetupField::Target(target.clone()));
    edit.apply(&Session::new(TargetKind::Ball.target())).map_err(|refusal| refusal.to_string())?;
    Ok(target)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_radius_of_a_ball_will_do() {
        assert_eq!(ball("12,7"), Ok(Target::ball(12.7)));
        for bad in ["", "big", "0", "-3"] {
            assert!(ball(bad).is_err(), "{bad}");
        }
    }
}
