//! What the pointer asks of the table, put off by a frame where a cell is still being edited.

use egui::Context;

use crate::app::{Command, Document};
use crate::session::table::Column;

use super::sheet::Sheet;

/// Something that reads the document as a whole, so that it has to hold what was typed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ask {
    /// A station below.
    Add,
    /// The selected rows once more.
    Duplicate,
    /// The selected rows taken out.
    Remove,
    /// The selected stations one place up, or down.
    Shift {
        /// Which of both.
        is_up: bool,
    },
    /// The order of a column.
    Sort(Column),
    /// The first selected row filled down.
    Fill,
    /// The selected cells to the clipboard.
    Copy,
}

impl Sheet {
    /// Does what was asked, or puts it off until the document has what this frame has taken over: the places of an edit
    /// are those of the document before it.
    pub fn ask(&mut self, ctx: &Context, document: &Document, ask: Ask, commands: &mut Vec<Command>) {
        self.commit(commands);
        if commands.is_empty() {
            self.carry_out(ctx, document, ask, commands);
        } else {
            self.asked = Some(ask);
            ctx.request_repaint();
        }
    }

    /// Does what was put off in the frame before.
    pub fn carry_out_asked(&mut self, ctx: &Context, document: &Document, commands: &mut Vec<Command>) {
        if let Some(ask) = self.asked.take() {
            self.ask(ctx, document, ask, commands);
        }
    }

    fn carry_out(&mut self, ctx: &Context, document: &Document, ask: Ask, commands: &mut Vec<Command>) {
        let session = &document.session;
        match ask {
            Ask::Add => self.add(session, commands),
            Ask::Duplicate => self.duplicate(commands),
            Ask::Remove => self.remove(commands),
            Ask::Shift { is_up } => self.shift(session, is_up, commands),
            Ask::Sort(column) => self.sort(session, column, commands),
            Ask::Fill => self.fill(session, commands),
            Ask::Copy => ctx.copy_text(self.copied(session)),
        }
    }
}
