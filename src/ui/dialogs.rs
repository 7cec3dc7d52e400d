//! Questions and windows over the panels: unsaved changes, a path to save to, help.

use std::path::{Path, PathBuf};

use egui::{Context, Frame, Grid, Id, Key, Modal, ScrollArea, TextEdit, Ui, WidgetInfo};

use crate::app::Workbench;
use crate::text::{capture as capture_words, document as document_words, import as import_words, shell as words};

use super::actions::{Action, OTHER_REDO};
use super::file_dialog::Purpose;
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

/// Asks what is to become of unsaved changes, and says how many cells hold a text that no file can.
#[must_use]
pub fn ask_unsaved(ctx: &Context, title: &str, num_unread: usize) -> Option<UnsavedAnswer> {
    let mut answer = None;
    let response = modal(ctx, "unsaved changes").show(ctx, |ui| {
        question_heading(ui, &words::save_changes_to(title));
        ui.label(theme::dim(ui, words::SAVE_CHANGES_HINT));
        if num_unread > 0 {
            ui.label(egui::RichText::new(words::unread_cells(num_unread)).color(theme::palette(ui).warn));
        }
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

/// What to do with a file that another program has changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChangedAnswer {
    /// Replace it.
    SaveOver,
    /// Write another file.
    SaveAs,
    /// Read it.
    Reload,
    /// Leave it.
    Cancel,
}

/// Asks what is to become of a file that another program has changed, before it is saved.
#[must_use]
pub fn ask_changed(ctx: &Context, title: &str) -> Option<ChangedAnswer> {
    let mut answer = None;
    let response = modal(ctx, "changed on disk").show(ctx, |ui| {
        question_heading(ui, &document_words::changed_title(title));
        ui.label(theme::dim(ui, document_words::CHANGED_HINT));
        ui.add_space(16.0);
        ui.horizontal(|ui| {
            if widgets::primary_button(ui, words::SAVE_AS).clicked() {
                answer = Some(ChangedAnswer::SaveAs);
            }
            for (name, meaning) in [
                (document_words::SAVE_OVER, ChangedAnswer::SaveOver),
                (document_words::RELOAD, ChangedAnswer::Reload),
                (words::CANCEL, ChangedAnswer::Cancel),
            ] {
                if ui.button(name).clicked() {
                    answer = Some(meaning);
                }
            }
        });
    });
    if response.should_close() {
        answer = answer.or(Some(ChangedAnswer::Cancel));
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

/// A path being typed because there is no system dialog to choose it with.
#[derive(Clone, Debug)]
pub struct SavePath {
    purpose: Purpose,
    text: String,
    own_file: Option<PathBuf>,
    to_replace: Option<PathBuf>,
    is_new: bool,
}

/// What came of typing a path.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SavePathAnswer {
    /// Save there, or read it: what it was asked for.
    Save(PathBuf),
    /// Thought better of it.
    Cancel,
}

impl SavePath {
    /// Starts with a suggestion; `own_file` is the document's, which is replaced without a question.
    #[must_use]
    pub const fn new(suggestion: String, own_file: Option<PathBuf>) -> Self {
        Self { purpose: Purpose::Save, text: suggestion, own_file, to_replace: None, is_new: true }
    }

    /// Starts with a suggestion for something else than saving.
    #[must_use]
    pub const fn to(purpose: Purpose, suggestion: String) -> Self {
        Self { purpose, text: suggestion, own_file: None, to_replace: None, is_new: true }
    }

    /// What the path is for.
    #[must_use]
    pub const fn purpose(&self) -> Purpose {
        self.purpose
    }

    /// Asks for the path, and again before another file is replaced.
    pub fn ask(&mut self, ctx: &Context) -> Option<SavePathAnswer> {
        if let Some(path) = self.to_replace.clone() {
            let is_agreed = ask_replace(ctx, &path)?;
            self.to_replace = None;
            self.is_new = true;
            return is_agreed.then_some(SavePathAnswer::Save(path));
        }
        let answer = self.ask_path(ctx)?;
        match answer {
            SavePathAnswer::Save(path) if self.purpose.writes_a_file() && path.exists() && !self.is_own_file(&path) => {
                self.to_replace = Some(path);
                ctx.request_repaint();
                None
            }
            answer => Some(answer),
        }
    }

    fn is_own_file(&self, path: &Path) -> bool {
        // Two spellings may name the same file.
        let resolved = |path: &Path| path.canonicalize().unwrap_or_else(|_| path.to_owned());
        self.own_file.as_deref().is_some_and(|own_file| resolved(own_file) == resolved(path))
    }

    fn ask_path(&mut self, ctx: &Context) -> Option<SavePathAnswer> {
        let mut answer = None;
        let response = modal(ctx, "save as").show(ctx, |ui| {
            question_heading(ui, self.purpose.title());
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
                if widgets::primary_button(ui, self.purpose.button()).clicked() || entered {
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

/// Asks whether a file that exists is to be replaced.
fn ask_replace(ctx: &Context, path: &Path) -> Option<bool> {
    let mut answer = None;
    let response = modal(ctx, "replace file").show(ctx, |ui| {
        question_heading(ui, words::REPLACE_TITLE);
        ui.add(egui::Label::new(path.display().to_string()).wrap());
        ui.label(theme::dim(ui, words::REPLACE_HINT));
        ui.add_space(16.0);
        ui.horizontal(|ui| {
            if ui.button(words::REPLACE).clicked() {
                answer = Some(true);
            }
            if ui.button(words::CANCEL).clicked() {
                answer = Some(false);
            }
        });
    });
    if response.should_close() {
        answer = answer.or(Some(false));
    }
    answer
}

/// Height of all of the help but its list, and the window around it, points.
const HELP_BESIDE_LIST: f32 = 180.0;

/// Shows the shortcuts and what this program is; clears `open` when closed.
pub fn help(ctx: &Context, workbench: &Workbench, open: &mut bool) {
    if !*open {
        return;
    }
    let response = modal(ctx, "help").show(ctx, |ui| {
        question_heading(ui, words::SHORTCUTS);
        // Heading, button and margins keep their place in a low window; what is between them scrolls.
        let room = ctx.content_rect().height() - HELP_BESIDE_LIST;
        ScrollArea::vertical().max_height(room).show(ui, |ui| {
            Grid::new("shortcuts").num_columns(2).spacing([24.0, 4.0]).show(ui, |ui| {
                for action in [
                    Action::Open,
                    Action::Import,
                    Action::Save,
                    Action::SaveAs,
                    Action::Close,
                    Action::Quit,
                    Action::Undo,
                    Action::Redo,
                    Action::History,
                    Action::Help,
                ] {
                    if let Some(shortcut) = action.shortcut() {
                        let mut keys = ctx.format_shortcut(&shortcut);
                        if action == Action::Redo {
                            keys = words::either_key(&keys, &ctx.format_shortcut(&OTHER_REDO));
                        }
                        key_row(ui, &keys, &action.label(workbench));
                    }
                }
                key_row(ui, import_words::PASTE_KEYS, import_words::PASTE);
                key_row(ui, "1 … 8", words::KEYS_RAIL);
                key_row(ui, capture_words::STOP_KEYS, capture_words::STOP_KEYS_HINT);
                key_row(ui, "↑ ↓", words::KEYS_LIST);
                key_row(ui, "← →", words::KEYS_STEPS);
                key_row(ui, words::TAB, words::KEYS_TAB);
                key_row(ui, words::SPACE, words::KEYS_SPACE);
                key_row(ui, words::ESCAPE, words::KEYS_ESCAPE);
                key_row(ui, "Ctrl + / Ctrl −", words::KEYS_SCALE);
                key_row(ui, "Ctrl 0", words::KEYS_SCALE_BACK);
                key_row(ui, words::DRAG, words::KEYS_PAN);
                key_row(ui, words::CTRL_WHEEL, words::KEYS_ZOOM);
                key_row(ui, words::RIGHT_DRAG, words::KEYS_BOX_ZOOM);
                key_row(ui, words::DOUBLE_CLICK, words::KEYS_PLOT);
            });
            ui.add_space(16.0);
            ui.label(theme::heading(words::ABOUT));
            ui.add_space(8.0);
            ui.label(words::ABOUT_TEXT);
            ui.label(theme::dim(ui, words::version(env!("CARGO_PKG_VERSION"))));
        });
        ui.add_space(16.0);
        widgets::primary_button(ui, words::CLOSE).clicked()
    });
    if response.inner || response.should_close() {
        *open = false;
    }
}

fn key_row(ui: &mut Ui, keys: &str, meaning: &str) {
    ui.label(widgets::number_text(keys));
    ui.label(theme::dim(ui, meaning));
    ui.end_row();
}
