//! The bar above the pose table: in which numbers the poses are shown, and what the numbers mean.

use egui::{Align, Button, Context, Frame, Id, Layout, Modal, Panel, Ui};

use crate::app::{Command, Document};
use crate::geometry::PoseNotation;
use crate::report::figure::Orbit;
use crate::session::edit::shown_numbers;
use crate::session::{Edit, Session};
use crate::text::conventions as words;
use crate::ui::save_picture::saveable;
use crate::ui::widgets::{card_with_height, chip, number_text, primary_button};
use crate::ui::{PanelContext, theme};

use super::model::{self, Draft};
use super::picker::{self, Search};
use super::reinterpret::{Answer, Reinterpretation, numbers_text};
use super::{editor, paint};

/// Height of the picture's card below the table, points.
const PICTURE_HEIGHT: f32 = 264.0;
/// Width of the dialog, points.
const DIALOG_WIDTH: f32 = 520.0;

/// Below this width the bar keeps to its buttons, points.
const NARROW_WIDTH: f32 = 760.0;
/// Room for the other buttons of the bar, points.
const BUTTONS_WIDTH: f32 = 340.0;

/// What is open.
#[derive(Clone, Debug, Default)]
pub struct ConventionState {
    search: Search,
    shown_as: Option<ShownAs>,
    reinterpretation: Option<Reinterpretation>,
    has_picture: bool,
    camera: Orbit,
}

/// The dialog that chooses units and frame.
#[derive(Clone, Debug)]
struct ShownAs {
    draft: Draft,
    search: Search,
}

/// One row, the picture at the bottom if it is unfolded, and whatever dialog is open.
pub fn bar(ui: &mut Ui, context: &mut PanelContext<'_>, state: &mut ConventionState) {
    let Some(document) = context.workbench.document() else { return };
    let session = &*document.session;
    row(ui, session, state, context.commands);
    ui.add_space(8.0);
    if state.has_picture {
        picture(ui, session, &mut state.camera);
    }
    dialogs(ui.ctx(), document, state, context.commands);
}

fn row(ui: &mut Ui, session: &Session, state: &mut ConventionState, commands: &mut Vec<Command>) {
    let notation = session.robot.notation;
    let is_narrow = ui.available_width() < NARROW_WIDTH;
    ui.horizontal(|ui| {
        ui.label(theme::dim(ui, words::SHOWN_AS)).on_hover_text(words::SHOWN_AS_HINT);
        let room = (ui.available_width() - BUTTONS_WIDTH).max(80.0);
        if let Some(chosen) = picker::show(ui, words::SHOWN_AS, room, &notation, true, &mut state.search) {
            commands.push(Command::Edit { edit: Edit::SwitchNotation(chosen), gesture: None });
        }
        // The bar at the top has them too.
        if !is_narrow {
            chip(ui, &words::notation_units(&notation), &words::notation_units_hint(&notation));
            if let Some(frame) = words::notation_frame(&notation) {
                chip(ui, frame, words::notation_frame_hint(&notation));
            }
        }
        if ui.button(words::MORE).on_hover_text(words::SHOW_HINT).clicked() {
            state.shown_as = Some(ShownAs { draft: Draft::of(&notation), search: Search::default() });
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let picture = Button::selectable(state.has_picture, words::PICTURE).frame_when_inactive(true);
            if ui.add(picture).on_hover_text(words::PICTURE_HINT).clicked() {
                state.has_picture = !state.has_picture;
            }
            if ui.button(words::REINTERPRET).on_hover_text(words::REINTERPRET_HINT).clicked() {
                state.reinterpretation = Some(Reinterpretation::of(session));
            }
        });
    });
}

fn picture(ui: &mut Ui, session: &Session, camera: &mut Orbit) {
    let height = PICTURE_HEIGHT.min(ui.available_height() * 0.5);
    Panel::bottom("poses as frames")
        .frame(Frame::NONE)
        .resizable(false)
        .show_separator_line(false)
        .exact_size(height)
        .show(ui, |ui| {
            ui.add_space(theme::GAP);
            let height = ui.available_height();
            card_with_height(
                ui,
                words::PICTURE_TITLE,
                height,
                |ui| {
                    ui.label(theme::dim(ui, words::ORBIT_HINT).size(theme::SMALL_SIZE));
                },
                |ui| {
                    saveable(ui, words::PICTURE_TITLE, |ui| {
                        let area = ui.available_rect_before_wrap();
                        paint::show(ui, area, words::PICTURE_TITLE, &model::frames(session), camera);
                    });
                },
            );
        });
}

fn dialogs(ctx: &Context, document: &Document, state: &mut ConventionState, commands: &mut Vec<Command>) {
    let mut edit = |edit: Edit| commands.push(Command::Edit { edit, gesture: None });
    if let Some(dialog) = &mut state.shown_as
        && let Some(answer) = dialog.show(ctx, &document.session)
    {
        state.shown_as = None;
        if let Answer::Apply(notation) = answer {
            edit(Edit::SwitchNotation(notation));
        }
    }
    if let Some(dialog) = &mut state.reinterpretation
        && let Some(answer) = dialog.show(ctx, document)
    {
        state.reinterpretation = None;
        if let Answer::Apply(notation) = answer {
            edit(Edit::Reinterpret(notation));
        }
    }
}

impl ShownAs {
    fn show(&mut self, ctx: &Context, session: &Session) -> Option<Answer> {
        let mut answer = None;
        let frame = Frame::window(&ctx.global_style()).inner_margin(20);
        let response = Modal::new(Id::unique("how poses are shown")).frame(frame).show(ctx, |ui| {
            ui.set_width(DIALOG_WIDTH);
            ui.label(theme::heading(words::SHOW_TITLE));
            ui.add_space(4.0);
            ui.label(theme::dim(ui, words::SHOW_HINT));
            ui.add_space(12.0);
            editor::show(ui, &mut self.draft, None, &mut self.search);
            ui.add_space(12.0);
            let notation = self.draft.notation();
            if let Ok(notation) = &notation {
                example(ui, session, notation);
            }
            ui.add_space(12.0);
            ui.horizontal(|ui| {
                ui.add_enabled_ui(notation.is_ok(), |ui| {
                    if primary_button(ui, words::SHOW).clicked() {
                        answer = notation.ok().map(Answer::Apply);
                    }
                });
                if ui.button(words::CANCEL).clicked() {
                    answer = Some(Answer::Cancel);
                }
            });
        });
        if response.should_close() {
            answer = answer.or(Some(Answer::Cancel));
        }
        answer
    }
}

/// The first pose in the numbers that are being chosen.
fn example(ui: &mut Ui, session: &Session, notation: &PoseNotation) {
    let Some(station) = session.stations.first() else { return };
    let Some(capture) = station.captures.first() else { return };
    ui.label(theme::dim(ui, words::example(&station.label)));
    ui.label(number_text(numbers_text(&shown_numbers(capture, notation), notation)));
}
