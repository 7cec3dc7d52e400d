//! Opening, saving and closing, and the questions asked before changes are lost.

use std::sync::Arc;

use egui::{Align, Context, Frame, Layout, Margin, Panel, Ui, ViewportCommand};

use crate::app::{Command, Document, ImportInto, NoticeKind, OnDisk};
use crate::text::{document as document_words, shell as words};
use crate::ui::dialogs::{self, ChangedAnswer, SavePath, SavePathAnswer, UnsavedAnswer};
use crate::ui::file_dialog::{Answer, Purpose};
use crate::ui::rail::Step;
use crate::ui::{theme, widgets};

use super::{Pending, Shell, live_cell};

/// Seconds between two looks at the file while frames come.
const LOOK_SECONDS: f64 = 5.0;

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
                | Command::NewSession(_)
                | Command::Recover(_)
                | Command::CloseDocument
                | Command::FinishImport(ImportInto::NewSession { .. })
        ) || live_cell::is_practise(&command);
        if replaces && self.would_lose_something() {
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
        let begins_a_capture = matches!(command, Command::NewSession(_)) && self.step == Step::Capture;
        if live_cell::is_practise(&command) {
            self.step = Step::Capture;
        }
        if matches!(command, Command::NewSession(_) | Command::FinishImport(_)) && !begins_a_capture {
            // The next thing to do there: look at the poses, or import, paste and add some.
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
            .name_or_untitled()
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
        if self.workbench.is_saving() || self.workbench.conflict().is_some() {
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
        if ctx.memory(|memory| memory.focused().is_some()) {
            // A field hands in what was typed, then the window asks again.
            ctx.send_viewport_cmd(ViewportCommand::CancelClose);
            super::take_what_is_typed(ctx);
            self.is_closing_again = true;
        } else if self.workbench.is_saving() {
            // The file is on its way: the window closes when it has arrived, and stays if it cannot.
            ctx.send_viewport_cmd(ViewportCommand::CancelClose);
            self.is_quitting = false;
            self.after_saving = Some(Pending::Quit);
        } else if self.would_lose_something() && !self.is_quitting {
            ctx.send_viewport_cmd(ViewportCommand::CancelClose);
            self.unsaved_question = Some(Pending::Quit);
        }
    }

    /// The window closes: what is unsaved by now was given up, unless nobody was asked.
    pub fn end(&mut self) {
        if self.is_quitting || !self.workbench.document().is_some_and(Document::is_unsaved) {
            self.workbench.end();
        }
    }

    /// Whether there are changes that no file holds, or texts in cells that none can hold.
    fn would_lose_something(&self) -> bool {
        self.workbench.document().is_some_and(Document::is_unsaved) || self.poses.num_unread(&self.workbench) > 0
    }

    /// Whether a question waits for its answer.
    pub(super) fn is_asking(&self) -> bool {
        self.unsaved_question.is_some() || self.save_path.is_some() || self.workbench.conflict().is_some()
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
        self.question_of_changed_file(ctx);
        let Some(document) = self.workbench.document().filter(|_| self.unsaved_question.is_some()) else {
            self.unsaved_question = None;
            return;
        };
        let Some(answer) = dialogs::ask_unsaved(ctx, &document.title(), self.poses.num_unread(&self.workbench)) else {
            return;
        };
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

    fn question_of_changed_file(&mut self, ctx: &Context) {
        let Some(document) = self.workbench.document().filter(|_| self.workbench.conflict().is_some()) else { return };
        // The path that "Save as…" asks for stands above the question.
        if self.save_path.is_some() || self.file_dialog.is_open() {
            return;
        }
        let Some(answer) = dialogs::ask_changed(ctx, &document.title()) else { return };
        match answer {
            ChangedAnswer::SaveOver => self.workbench.apply(Command::SaveAnyway),
            ChangedAnswer::SaveAs => {
                self.workbench.apply(Command::GiveUpSaving);
                self.save_as();
            }
            ChangedAnswer::Reload => {
                self.after_saving = None;
                self.workbench.apply(Command::GiveUpSaving);
                self.workbench.apply(Command::Reload);
            }
            ChangedAnswer::Cancel => {
                self.after_saving = None;
                self.workbench.apply(Command::GiveUpSaving);
            }
        }
    }

    /// Files may have come or gone while the user was elsewhere.
    pub fn look_again(&mut self) {
        self.start.look_again();
    }

    /// Looks at the file when the user comes back from another program, and now and then while they work: frames come
    /// only when something happens, so an idle window stays idle.
    pub(super) fn look_at_file(&mut self, ctx: &Context) {
        let (now, has_focus) = ctx.input(|input| (input.time, input.focused));
        let has_come_back = has_focus && !std::mem::replace(&mut self.watch.had_focus, has_focus);
        if has_come_back {
            self.look_again();
        }
        if has_come_back || now - self.watch.last_look > LOOK_SECONDS {
            self.watch.last_look = now;
            self.workbench.apply(Command::CheckFile);
        }
    }

    /// The strip that says that the file is another than the one opened.
    pub(super) fn strip_of_file(&mut self, ui: &mut Ui, commands: &mut Vec<Command>) {
        let Some(document) = self.workbench.document() else { return };
        let state = (document.id(), document.on_disk);
        if document.on_disk == OnDisk::Same {
            self.dismissed_on_disk = None;
            return;
        }
        if self.dismissed_on_disk == Some(state) {
            return;
        }
        let sentence = match document.on_disk {
            OnDisk::Gone => document_words::gone_strip(&document.title()),
            _ => document_words::changed_strip(&document.title()),
        };
        let palette = theme::palette(ui);
        let frame = Frame::new().fill(palette.surface).inner_margin(Margin::symmetric(16, 4));
        Panel::bottom("file on disk").resizable(false).frame(frame).show(ui, |ui| {
            ui.horizontal(|ui| {
                ui.label(theme::strong("!").color(palette.warn));
                ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                    if widgets::symbol_button(ui, "×", words::DISMISS).clicked() {
                        self.dismissed_on_disk = Some(state);
                    }
                    if state.1 == OnDisk::Changed && ui.button(document_words::RELOAD).clicked() {
                        commands.push(Command::Reload);
                    }
                    ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                        ui.add(egui::Label::new(sentence).wrap());
                    });
                });
            });
        });
    }
}
