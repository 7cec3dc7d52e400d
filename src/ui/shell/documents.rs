//! Opening, saving and closing, and the questions asked before changes are lost.

use std::sync::Arc;

use egui::{Context, ViewportCommand};

use crate::app::{Command, Document, ImportInto, NoticeKind};
use crate::text::shell as words;
use crate::ui::dialogs::{self, SavePath, SavePathAnswer, UnsavedAnswer};
use crate::ui::file_dialog::{Answer, Purpose};
use crate::ui::rail::Step;

use super::{Pending, Shell};

impl Shell {
    /// Applies a command; one that puts another document on the bench asks first if changes would be lost.
    pub fn request(&mut self, command: Command) {
        let command = match command {
            Command::Open(path) => Command::to_read(vec![path]),
            other => other,
        };
        let replaces = matches!(
            command,
            Command::Open(_)
                | Command::OpenSample(_)
                | Command::CloseDocument
                | Command::FinishImport(ImportInto::NewSession { .. })
        );
        if replaces && self.workbench.document().is_some_and(Document::is_unsaved) {
            self.unsaved_question = Some(Pending::Command(command));
            return;
        }
        self.carry_out_command(command);
    }

    pub(super) fn carry_out(&mut self, ctx: &Context, pending: Pending) {
        match pending {
            Pending::Command(command) => self.carry_out_command(command),
            Pending::Quit => {
                self.is_quitting = true;
                ctx.send_viewport_cmd(ViewportCommand::Close);
            }
        }
    }

    pub(super) fn carry_out_command(&mut self, command: Command) {
        if matches!(command, Command::Open(_) | Command::OpenSample(_)) {
            // What went wrong with the last file does not concern this one.
            let stale: Vec<u64> = self.workbench.notices().iter().map(|notice| notice.id).collect();
            for id in stale {
                self.workbench.apply(Command::DismissNotice(id));
            }
            self.step = Step::Session;
        }
        if matches!(command, Command::FinishImport(_)) {
            self.step = Step::Poses;
        }
        self.workbench.apply(command);
    }

    pub(super) fn save(&mut self) {
        match self.workbench.document() {
            Some(document) if document.path.is_none() => self.save_as(),
            _ => self.workbench.apply(Command::Save),
        }
    }

    pub(super) fn save_as(&mut self) {
        let name = self.suggested_name();
        self.file_dialog.start(Purpose::Save, name, Arc::clone(&self.wake));
    }

    pub(super) fn suggested_name(&self) -> String {
        let Some(document) = self.workbench.document() else { return String::new() };
        if document.path.is_some() {
            return document.title();
        }
        let name: String = document
            .session
            .name
            .chars()
            .map(|letter| if letter.is_alphanumeric() || "-_.".contains(letter) { letter } else { '-' })
            .collect();
        format!("{name}.json")
    }

    pub(super) fn take_dialog_answer(&mut self) {
        match self.file_dialog.poll() {
            Some(Answer::Chosen(purpose, paths)) => self.take_paths(purpose, paths),
            Some(Answer::Unavailable(Purpose::Open)) => {
                self.step = Step::Session;
                self.start.ask_for_path(words::NO_FILE_DIALOG);
            }
            Some(Answer::Unavailable(Purpose::Save)) => {
                let folder = std::env::current_dir().unwrap_or_default();
                let suggestion = folder.join(self.suggested_name());
                let own_file = self.workbench.document().and_then(|document| document.path.clone());
                self.save_path = Some(SavePath::new(suggestion.display().to_string(), own_file));
            }
            Some(Answer::Unavailable(purpose)) => {
                self.save_path = Some(SavePath::to(purpose, self.suggested_path(purpose)));
            }
            Some(Answer::Cancelled) => self.after_saving = None,
            None => {}
        }
    }

    /// Once the changes are in the file, does what waited for it; if saving failed, forgets it: the user sees why.
    pub(super) fn go_on_after_saving(&mut self, ctx: &Context) {
        if self.after_saving.is_none() || self.file_dialog.is_open() || self.save_path.is_some() {
            return;
        }
        if self.workbench.is_saving() {
            return;
        }
        let has_failed = (self.workbench.notices().last())
            .is_some_and(|notice| notice.kind == NoticeKind::Error && !notice.is_of_opening);
        let is_saved = !has_failed && !self.workbench.document().is_some_and(Document::is_unsaved);
        if is_saved {
            if let Some(pending) = self.after_saving.take() {
                self.carry_out(ctx, pending);
            }
        } else if !self.workbench.is_busy() {
            self.after_saving = None;
        }
    }

    pub(super) fn guard_closing(&mut self, ctx: &Context) {
        if !ctx.input(|input| input.viewport().close_requested()) {
            return;
        }
        if self.workbench.is_saving() {
            // The file is on its way: the window closes when it has arrived, and stays if it cannot.
            ctx.send_viewport_cmd(ViewportCommand::CancelClose);
            self.is_quitting = false;
            self.after_saving = Some(Pending::Quit);
        } else if self.workbench.document().is_some_and(Document::is_unsaved) && !self.is_quitting {
            ctx.send_viewport_cmd(ViewportCommand::CancelClose);
            self.unsaved_question = Some(Pending::Quit);
        }
    }

    pub(super) fn questions(&mut self, ctx: &Context) {
        dialogs::help(ctx, &self.workbench, &mut self.is_help_open);
        if let Some((purpose, answer)) =
            self.save_path.as_mut().and_then(|save_path| Some((save_path.purpose(), save_path.ask(ctx)?)))
        {
            self.save_path = None;
            match answer {
                SavePathAnswer::Save(path) => self.take_paths(purpose, vec![path]),
                SavePathAnswer::Cancel => self.after_saving = None,
            }
        }
        let Some(document) = self.workbench.document().filter(|_| self.unsaved_question.is_some()) else {
            self.unsaved_question = None;
            return;
        };
        let Some(answer) = dialogs::ask_unsaved(ctx, &document.title()) else { return };
        let Some(pending) = self.unsaved_question.take() else { return };
        match answer {
            UnsavedAnswer::Save => {
                self.after_saving = Some(pending);
                self.save();
            }
            UnsavedAnswer::Discard => self.carry_out(ctx, pending),
            UnsavedAnswer::Cancel => {}
        }
    }
}
