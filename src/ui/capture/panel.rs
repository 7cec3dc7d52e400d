//! The capture panel: the safety strip above, connection and settings at the left, what is seen and done at the right.

use std::rc::Rc;
use std::sync::Arc;

use egui::{Key, Modifiers, Rect, ScrollArea, Ui, UiBuilder};

use crate::app::Command;
use crate::app::cell::{CellCommand, CellSettings};
use crate::device::{LinkState, RobotSetup, SearchReport};
use crate::geometry::{Profile, Vec3};
use crate::report::figure::model::ProfileModel;
use crate::session::Target;
use crate::ui::actions::Action;
use crate::ui::rail::Step;
use crate::ui::{PanelContext, theme};

use super::fields::Fields;
use super::memory::CellMemory;
use super::model::{SearchCurve, View};
use super::mounting::MountingDraft;
use super::next::Deed;
use super::{connection, edges, live, machine, settings, strip, work};

/// Width of the column at the left, points.
const LEFT_WIDTH: f32 = 304.0;
/// The least of it where the window is narrow.
const LEAST_LEFT_WIDTH: f32 = 264.0;
/// Room for a scroll bar beside a column, points.
const BAR_WIDTH: f32 = 9.0;
/// The least height of the plots; below, the column scrolls.
const LEAST_PLOT_HEIGHT: f32 = 284.0;

/// What the panel remembers between frames.
#[derive(Debug)]
pub struct CaptureState {
    pub(super) profile: Option<(Arc<Profile>, bool, Rc<ProfileModel>)>,
    pub(super) view: Option<[[f64; 2]; 2]>,
    pub(super) is_profile_fitted: bool,
    pub(super) curve: Option<(Arc<SearchReport>, Rc<SearchCurve>)>,
    pub(super) is_curve_fitted: bool,
    /// Radius of the ball of a new session, mm.
    pub(super) radius_mm: f64,
    /// What was typed into fields for numbers, and not taken.
    pub(super) fields: Fields,
    /// The mounting that is being typed.
    pub(super) mounting: MountingDraft,
    /// Whether the mounting is to be seen in the next frame.
    pub(super) reveals_mounting: bool,
    /// Where the proposal of the last frame was, in the base.
    pub(super) seen_proposal: Option<Vec3>,
}

impl Default for CaptureState {
    fn default() -> Self {
        Self {
            profile: None,
            view: None,
            is_profile_fitted: true,
            curve: None,
            is_curve_fitted: true,
            radius_mm: 15.0,
            fields: Fields::default(),
            mounting: MountingDraft::default(),
            reveals_mounting: false,
            seen_proposal: None,
        }
    }
}

/// What every card draws from, and where it puts what the user asks for.
pub(super) struct Desk<'a> {
    pub view: View<'a>,
    pub memory: &'a mut CellMemory,
    pub state: &'a mut CaptureState,
    pub commands: &'a mut Vec<Command>,
    pub actions: &'a mut Vec<Action>,
}

impl Desk<'_> {
    pub fn ask(&mut self, command: CellCommand) {
        self.commands.push(Command::Cell(Box::new(command)));
    }

    pub fn set(&mut self, settings: &CellSettings) {
        if *settings != self.view.cell.settings {
            self.ask(CellCommand::SetSettings(Box::new(*settings)));
        }
    }

    /// The robot that is connected, or would be.
    pub fn robot(&self) -> Option<RobotSetup> {
        let link = &self.view.cell.robot;
        let connected = link.setup.clone().filter(|_| link.state != LinkState::Off);
        connected.or_else(|| self.memory.robot_to_connect())
    }

    /// Whose mounting it is that is remembered: that of the robot that was there when it was given, or that came first.
    fn note_mounting(&mut self) {
        let cell = self.view.cell;
        if cell.is_practice {
            return;
        }
        if cell.settings.mounting.is_none() {
            self.memory.mounting_of = None;
        } else if self.memory.mounting_of.is_none() && cell.robot.state == LinkState::Ready {
            self.memory.mounting_of.clone_from(&cell.robot.setup);
        }
        let other = self.robot().filter(|robot| self.memory.has_mounting_of_other(robot));
        self.view.has_other_mounting = other.is_some();
    }

    pub fn carry_out(&mut self, deed: Deed) {
        match deed {
            Deed::Cell(command) => self.ask(command),
            Deed::NewSession => self.commands.push(Command::NewSession(Target::ball(self.state.radius_mm))),
            Deed::Enter(field) => self.state.fields.ask_for(field),
            Deed::KeepMounting => self.memory.mounting_of = self.robot(),
            Deed::ShowMounting => self.state.reveals_mounting = true,
            Deed::Compare => self.actions.push(Action::GoTo(Step::Compare)),
        }
    }
}

/// Shows the panel of a workbench.
pub fn show(ui: &mut Ui, context: &mut PanelContext<'_>, memory: &mut CellMemory, state: &mut CaptureState) {
    let view = View::of(context.workbench);
    show_view(ui, view, memory, state, context.commands, context.actions);
}

/// Shows the panel of any view.
pub fn show_view(
    ui: &mut Ui,
    view: View<'_>,
    memory: &mut CellMemory,
    state: &mut CaptureState,
    commands: &mut Vec<Command>,
    actions: &mut Vec<Action>,
) {
    let mut desk = Desk { view, memory, state, commands, actions };
    desk.note_mounting();
    let is_typing = ui.ctx().text_edit_focused();
    if view.cell.replay.is_some() && !is_typing && ui.input_mut(|input| input.consume_key(Modifiers::NONE, Key::Escape))
    {
        desk.ask(CellCommand::EndReplay);
    }
    ui.spacing_mut().item_spacing.y = theme::GAP;
    strip::show(ui, &mut desk);
    let area = ui.available_rect_before_wrap();
    let left_width = (area.width() * 0.3).clamp(LEAST_LEFT_WIDTH, LEFT_WIDTH);
    let (left, right) = area.split_left_right_at_x(area.left() + left_width);
    column(ui, left, "capture left", |ui| {
        connection::show(ui, &mut desk);
        settings::show(ui, &mut desk);
    });
    column(ui, right.with_min_x(right.left() + theme::GAP), "capture right", |ui| {
        let below = machine::HEIGHT + work::height(ui.available_width()) + 2.0 * theme::GAP;
        let height = (area.height() - below).max(LEAST_PLOT_HEIGHT).floor();
        live::show(ui, height, &mut desk);
        if desk.view.is_of_edges() {
            edges::show(ui, &mut desk);
        } else {
            machine::show(ui, &desk);
        }
        work::show(ui, &mut desk);
    });
    ui.advance_cursor_after_rect(area);
}

/// A column that scrolls by itself; the bar gets the gap beside it, so that it covers nothing.
fn column(ui: &mut Ui, rect: Rect, name: &str, body: impl FnOnce(&mut Ui)) {
    let with_bar = rect.with_max_x(rect.right() + BAR_WIDTH);
    let mut inside = ui.new_child(UiBuilder::new().max_rect(with_bar));
    inside.set_clip_rect(with_bar.intersect(ui.clip_rect()));
    ScrollArea::vertical().id_salt(name).auto_shrink([false, false]).show(&mut inside, |ui| {
        ui.spacing_mut().item_spacing.y = theme::GAP;
        ui.set_width(rect.width());
        body(ui);
    });
}
