//! What the window itself does about the live cell: stop comes first, and what was set is remembered.

use egui::{Align2, Area, Context, Event, Frame, Id, Key, Order, vec2};

use crate::app::Command;
use crate::app::cell::{CellCommand, CellView};
use crate::text::capture as words;
use crate::ui::capture::model::may_be_moving;
use crate::ui::capture::stop_button;
use crate::ui::theme;

use super::Shell;

/// Where the stop stands above a question, points below the window's edge.
const DISTANCE_FROM_TOP: f32 = 56.0;

/// How the cell was in the last frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CellWatch {
    /// Whether it was the simulated one.
    was_practice: bool,
}

/// The command that stops.
pub fn stop() -> Command {
    Command::Cell(Box::new(CellCommand::Stop))
}

/// Whether a command starts the simulated cell, with a session of its own.
pub fn is_practise(command: &Command) -> bool {
    matches!(command, Command::Cell(command) if matches!(**command, CellCommand::Practise(_)))
}

/// Whether a key was pressed that stops the robot, which nothing else gets then: Escape always, the space bar unless it
/// is being typed.
pub fn takes_stop_key(ctx: &Context, cell: &CellView) -> bool {
    if !may_be_moving(cell) {
        return false;
    }
    let is_typing = ctx.text_edit_focused();
    ctx.input_mut(|input| {
        let num_before = input.events.len();
        input.events.retain(|event| match event {
            Event::Key { key, pressed: true, .. } => *key != Key::Escape && (is_typing || *key != Key::Space),
            _ => true,
        });
        input.events.len() < num_before
    })
}

/// What covers the window leaves the robot's stop in reach, and says why it is there.
pub fn stop_above_all(ctx: &Context, cell: &CellView, commands: &mut Vec<Command>) {
    if !may_be_moving(cell) {
        return;
    }
    let area = Area::new(Id::unique("stop above all"))
        .order(Order::Tooltip)
        .anchor(Align2::CENTER_TOP, vec2(0.0, DISTANCE_FROM_TOP))
        .movable(false);
    area.show(ctx, |ui| {
        Frame::window(ui.style()).inner_margin(12).show(ui, |ui| {
            ui.horizontal(|ui| {
                if stop_button(ui, vec2(0.0, 36.0), words::STOP_ROBOT, true) {
                    commands.push(stop());
                }
                ui.label(theme::strong(words::STILL_AT_WORK));
            });
        });
    });
}

impl Shell {
    /// Whatever else was asked for in the same frame waits.
    pub(super) fn stop_first(&mut self, commands: &mut Vec<Command>) {
        let num_before = commands.len();
        commands.retain(|command| *command != stop());
        if commands.len() < num_before {
            self.workbench.apply(stop());
        }
    }

    /// Keeps what is set for the next run. What is set for the simulated cell is not for a real one: when practice ends,
    /// the settings are again what they were before.
    pub(super) fn remember_cell(&mut self) {
        let cell = self.workbench.cell();
        let is_practice = cell.is_practice;
        let has_ended = std::mem::replace(&mut self.cell_watch.was_practice, is_practice) && !is_practice;
        if has_ended {
            let settings = Box::new(self.persisted.cell.settings);
            self.workbench.apply(Command::Cell(Box::new(CellCommand::SetSettings(settings))));
        } else if !is_practice {
            self.persisted.cell.settings = cell.settings;
        }
    }
}
