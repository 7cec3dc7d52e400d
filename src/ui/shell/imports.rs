//! The ways into an import, and out by an export: files, folders and the clipboard.

use std::path::PathBuf;
use std::sync::Arc;

use egui::{Context, Event, ViewportCommand};

use crate::app::Command;
use crate::app::workbench::scans::ScanCommand;
use crate::ui::file_dialog::Purpose;
use crate::ui::rail::Step;
use crate::ui::save_file::SaveFile;

use super::Shell;

/// The clipboard's text arrives with the next frame, if there is any.
const PASTE_PATIENCE: u8 = 4;

impl Shell {
    /// Shows the system's dialog; where there is none, the path is typed.
    pub(super) fn ask_for_paths(&mut self, purpose: Purpose) {
        let suggested_name = match purpose {
            Purpose::ExportPoses => self.suggested_csv(),
            Purpose::ExportPoints => self.suggested_ply(),
            _ => String::new(),
        };
        self.file_dialog.start(purpose, suggested_name, Arc::clone(&self.wake));
    }

    /// Asks for the place of a file that a panel has made.
    pub(super) fn ask_where_to_save(&mut self, file: SaveFile) {
        if !self.file_dialog.is_open() {
            self.file_dialog.start(file.purpose, file.name.clone(), Arc::clone(&self.wake));
            self.to_write = Some(file);
        }
    }

    pub(super) fn take_paths(&mut self, purpose: Purpose, paths: Vec<PathBuf>) {
        match purpose {
            Purpose::Open => self.request(Command::to_read(paths)),
            Purpose::SequenceFolder => paths.iter().for_each(|folder| self.request(Command::to_open_sequence(folder))),
            Purpose::ImportFiles | Purpose::ImportFolder | Purpose::AddSession => self.request(Command::Import(paths)),
            Purpose::Save => self.apply_to_each(paths, Command::SaveAs),
            Purpose::AddFurther => self.apply_to_each(paths, Command::AddFurther),
            Purpose::ExportPoses => self.apply_to_each(paths, Command::ExportPoses),
            Purpose::ExportProfiles => self.apply_to_each(paths, Command::ExportProfiles),
            Purpose::ExportPoints => self.apply_to_each(paths, |path| scan(ScanCommand::Export(path))),
            Purpose::OpenPoints => self.apply_to_each(paths, |path| scan(ScanCommand::OpenPoints(path))),
            Purpose::Calibration => self.apply_to_each(paths, |path| scan(ScanCommand::UseCalibration(path))),
            Purpose::ToolFrame | Purpose::Picture | Purpose::SequenceFile => {
                if let Some(file) = self.to_write.take() {
                    let write = |path| Command::WriteFile { path, contents: Arc::clone(&file.contents) };
                    self.apply_to_each(paths, write);
                }
            }
            Purpose::ReportFolder => {
                let options = self.report.options(&self.persisted.report);
                self.apply_to_each(paths, |folder| {
                    let options = Box::new(options.clone());
                    Command::WriteReport { folder, options }
                });
            }
            Purpose::Compared(side) => paths.iter().for_each(|path| self.verify.take_compared(side, path)),
            Purpose::ResultFolder => {
                for folder in paths {
                    self.verify.take_result_folder(&folder);
                    self.workbench.apply(Command::ReadResultHistory(folder));
                }
            }
            Purpose::WatchedFolder => {
                if let Some(folder) = paths.into_iter().next() {
                    self.persisted.cell.watch(folder);
                }
            }
        }
    }

    fn apply_to_each(&mut self, paths: Vec<PathBuf>, command: impl Fn(PathBuf) -> Command) {
        for path in paths {
            self.workbench.apply(command(path));
        }
    }

    /// What the field says at first where a path is typed.
    pub(super) fn suggested_path(&self, purpose: Purpose) -> String {
        let folder = std::env::current_dir().unwrap_or_default();
        let path = match purpose {
            Purpose::ExportPoses => folder.join(self.suggested_csv()),
            Purpose::ExportPoints => folder.join(self.suggested_ply()),
            Purpose::ReportFolder => folder.join(self.suggested_report()),
            Purpose::ToolFrame | Purpose::Picture | Purpose::SequenceFile => {
                folder.join(self.to_write.as_ref().map_or("", |file| &file.name))
            }
            _ => folder,
        };
        path.display().to_string()
    }

    fn suggested_csv(&self) -> String {
        let name = self.suggested_name();
        format!("{}-poses.csv", name.strip_suffix(".json").unwrap_or(&name))
    }

    fn suggested_report(&self) -> String {
        let name = self.suggested_name();
        format!("{}-report", name.strip_suffix(".json").unwrap_or(&name))
    }

    fn suggested_ply(&self) -> String {
        let name = self.suggested_name();
        format!("{}-points.ply", name.strip_suffix(".json").unwrap_or(&name))
    }

    /// Asks the system for the clipboard's text, which then comes as if it had been pasted by key.
    pub(super) fn ask_for_clipboard(&mut self, ctx: &Context) {
        self.paste_patience = Some(PASTE_PATIENCE);
        ctx.send_viewport_cmd(ViewportCommand::RequestPaste);
        ctx.request_repaint();
    }

    /// Text that is pasted where no field wants it is a table to be imported. A clipboard without text is told in the
    /// preview, which says what could be pasted.
    pub(super) fn take_pasted_text(&mut self, ctx: &Context, commands: &mut Vec<Command>) {
        let pasted = ctx.input(|input| {
            input.events.iter().find_map(|event| match event {
                Event::Paste(text) => Some(text.clone()),
                _ => None,
            })
        });
        let was_asked_for = self.paste_patience.is_some();
        match pasted {
            Some(text) if was_asked_for || self.is_paste_an_import(ctx) => {
                self.paste_patience = None;
                // Taken: the pose table must not paste it as well.
                ctx.input_mut(|input| input.events.retain(|event| !matches!(event, Event::Paste(_))));
                commands.push(Command::ImportText(text));
            }
            _ => {
                self.paste_patience = self.paste_patience.and_then(|frames| frames.checked_sub(1));
                if self.paste_patience.is_some() {
                    ctx.request_repaint();
                } else if was_asked_for {
                    commands.push(Command::ImportText(String::new()));
                }
            }
        }
    }

    /// The pose table takes what is pasted into it; elsewhere there is nothing else that a table could be meant for.
    fn is_paste_an_import(&self, ctx: &Context) -> bool {
        if ctx.text_edit_focused() {
            return false;
        }
        if self.workbench.import().is_some() {
            return true;
        }
        let is_asking = ctx.memory(|memory| memory.top_modal_layer().is_some());
        let has_table = self.workbench.document().is_some_and(|document| !document.session.stations.is_empty());
        !is_asking && (self.step == Step::Session || !has_table)
    }
}

fn scan(command: ScanCommand) -> Command {
    Command::Scan(Box::new(command))
}
