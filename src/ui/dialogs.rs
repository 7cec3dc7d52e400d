//! Questions and windows over the panels: unsaved changes, a path to save to, help.

use std::path::PathBuf;

use egui::{Context, Frame, Grid, Id, Key, Modal, TextEdit, Ui, WidgetInfo};

use crate::app::Workbench;
use crate::text::shell as words;

use super::actions::Action;
use super::{theme, widgets};

/// Width of a question, points.
const WIDTH: f32 = 420.0;

/// What to do with unsaved changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UnsavedAnswer {
    /// Write them, then go on.
    Save,
    /// Let them go.
    Discard,
    /// Go on working.
    Cancel,
}

/// Asks what is to become of unsaved changes.
#[must_use]
pub fn ask_unsaved(ctx: &Context, title: &str) -> Option<UnsavedAnswer> {
    let mut answer = None;
    let response = modal(ctx, "unsaved changes").show(ctx, |ui| {
        question_heading(ui, &words::save_changes_to(title));
        ui.label(theme::dim(ui, words::SAVE_CHANGES_HINT));
        ui.add_space(16.0);
        ui.horizontal(|ui| {
            if widgets::primary_button(ui, words::SAVE).clicked() {
                answer = Some(UnsavedAnswer::Save);
            }
            if ui.button(words::DISCARD).clicked() {
                answer = Some(UnsavedAnswer::Discard);
            }
            if ui.button(words::CANCEL).clicked() {
                answer = Some(UnsavedAnswer::Cancel);
            }
        });
    });
    if response.should_close() {
        answer = answer.or(Some(UnsavedAnswer::Cancel));
    }
    answer
}

fn modal(ctx: &Context, name: &str) -> Modal {
    Modal::new(Id::unique(name)).frame(Frame::window(&ctx.global_style()).inner_margin(20))
}

fn question_heading(ui: &mut Ui, text: &str) {
    ui.set_width(WIDTH);
    ui.label(theme::heading(text));
    ui.add_space(8.0);
}

/// A path being typed because there is no system dialog to save with.
#[derive(Clone, Debug)]
pub struct SavePath {
    text: String,
    is_new: bool,
}

/// What came of typing a path.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SavePathAnswer {
    /// Save there.
    Save(PathBuf),
    /// Thought better of it.
    Cancel,
}

impl SavePath {
    /// Starts with a suggestion.
    #[must_use]
    pub const fn new(suggestion: String) -> Self {
        Self { text: suggestion, is_new: true }
    }

    /// Asks for the path.
    pub fn ask(&mut self, ctx: &Context) -> Option<SavePathAnswer> {
        let mut answer = None;
        let response = modal(ctx, "save as").show(ctx, |ui| {
            question_heading(ui, words::SAVE_AS_TITLE);
            ui.label(theme::dim(ui, words::NO_FILE_DIALOG));
            ui.add_space(8.0);
            let field = ui.add(TextEdit::singleline(&mut self.text).desired_width(f32::INFINITY));
            field.widget_info(|| {
                let mut info = WidgetInfo::text_edit(true, "", &self.text, "");
                info.label = Some(words::FILE_PATH.to_owned());
                info
            });
            if std::mem::take(&mut self.is_new) {
                field.request_focus();
            }
            let entered = field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
            ui.add_space(16.0);
            ui.horizontal(|ui| {
                if widgets::primary_button(ui, words::SAVE).clicked() || entered {
                    answer = Some(SavePathAnswer::Save(PathBuf::from(self.text.trim())));
                }
                if ui.button(words::CANCEL).clicked() {
                    answer = Some(SavePathAnswer::Cancel);
                }
            });
        });
        if response.should_close() {
            answer = answer.or(Some(SavePathAnswer::Cancel));
        }
        answer
    }
}

/// Shows the shortcuts and what this program is; clears `open` when closed.
pub fn help(ctx: &Context, workbench: &Workbench, open: &mut bool) {
    if !*open {
        return;
    }
    let response = modal(ctx, "help").show(ctx, |ui| {
        question_heading(ui, words::SHORTCUTS);
        Grid::new("shortcuts").num_columns(2).spacing([24.0, 4.0]).show(ui, |ui| {
            for action in [
                Action::Open,
                Action::Save,
                Action::SaveAs,
                Action::Close,
                Action::Quit,
                Action::Undo,
                Action::Redo,
                Action::Help,
            ] {
                if let Some(shortcut) = action.shortcut() {
                    key_row(ui, &ctx.format_shortcut(&shortcut), &action.label(workbench));
                }
            }
            key_row(ui, "1 2 3 4", words::KEYS_RAIL);
            key_row(ui, "↑ ↓", words::KEYS_LIST);
            key_row(ui, "Ctrl + / Ctrl −", words::KEYS_SCALE);
            key_row(ui, words::DOUBLE_CLICK, words::KEYS_PLOT);
        });
        ui.add_space(16.0);
        ui.label(theme::heading(words::ABOUT));
        ui.add_space(8.0);
        ui.label(words::ABOUT_TEXT);
        ui.label(theme::dim(ui, words::version(env!("CARGO_PKG_VERSION"))));
        ui.add_space(16.0);
        if widgets::primary_button(ui, words::CLOSE).clicked() {
            ui.close();
        }
    });
    if response.should_close() {
        *open = false;
    }
}

fn key_row(ui: &mut Ui, keys: &str, meaning: &str) {
    ui.label(widgets::number_text(keys));
    ui.label(theme::dim(ui, meaning));
    ui.end_row();
}
