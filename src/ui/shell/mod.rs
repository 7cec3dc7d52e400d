//! The window's frame around the panels, and what it does with actions and commands.

mod documents;
mod imports;
mod live_cell;
mod news;

use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use egui::{CentralPanel, Context, Frame, Margin, Panel, Stroke, Ui, ViewportCommand};

use crate::app::cell::CellCommand;
use crate::app::jobs::{JobOutcome, Slot, Wake};
use crate::app::{Command, NoticeKind, OnDisk, Workbench};
use crate::text::report_panel as report_words;
use crate::text::shell as words;

use self::live_cell::CellWatch;
use super::actions::{self, Action};
use super::arcs::ArcsState;
use super::capture::CaptureState;
use super::compare::CompareState;
use super::diagnosis::DiagnosisState;
use super::dialogs::SavePath;
use super::file_dialog::{FileDialog, Purpose};
use super::history::HistoryWindow;
use super::import::{self, ImportState};
use super::persisted::Persisted;
use super::poses::panel::PosesState;
use super::rail::{self, Step};
use super::report::ReportState;
use super::save_file::{self, SaveFile};
use super::save_picture::{self, Drawn};
use super::sequence::SequenceState;
use super::start::panel::StartState;
use super::verify::VerifyState;
use super::{
    PanelContext, Selection, arcs, capture, compare, diagnosis, inspector, poses, report, sequence, start, status,
    theme, top_bar, verify, widgets,
};

/// Height of the bar at the top, points.
const TOP_HEIGHT: f32 = 44.0;
/// Height of the line at the bottom, points.
const BOTTOM_HEIGHT: f32 = 40.0;
/// Width of the rail, points.
const RAIL_WIDTH: f32 = 148.0;
/// From news to the frame that shows it: poses and profiles that come in between share one.
const WAKE_AFTER: Duration = Duration::from_millis(8);
/// From one frame to the next that only shows news. What the user does is answered at once; a live profile that is drawn
/// more often looks no smoother, and a machine without a graphics card has to paint every frame by itself.
const NEWS_EVERY: Duration = Duration::from_millis(50);
/// Width of the inspector, points.
const INSPECTOR_WIDTH: f32 = 320.0;

/// Something that waits for the answer about unsaved changes.
#[derive(Clone, Debug, PartialEq)]
enum Pending {
    Command(Command),
    Quit,
}

/// When the document's file was looked at last.
#[derive(Clone, Copy, Debug, PartialEq)]
struct FileWatch {
    /// In the time of the frames, s.
    last_look: f64,
    /// Whether the window had the focus then.
    had_focus: bool,
}

/// The window without its operating-system part: a test, the screenshot and eframe drive the same thing.
pub struct Shell {
    workbench: Workbench,
    wake: Wake,
    /// When the last frame was begun.
    last_frame: Arc<Mutex<Instant>>,
    step: Step,
    selection: Selection,
    start: StartState,
    poses: PosesState,
    arcs: ArcsState,
    sequence: SequenceState,
    capture: CaptureState,
    cell_watch: CellWatch,
    compare: CompareState,
    diagnosis: DiagnosisState,
    verify: VerifyState,
    report: ReportState,
    import: ImportState,
    /// Frames until a clipboard that was asked for its text counts as empty.
    paste_patience: Option<u8>,
    persisted: Persisted,
    file_dialog: FileDialog,
    save_path: Option<SavePath>,
    /// A picture that is being drawn.
    drawing: Slot<Drawn>,
    /// What waits for its path.
    to_write: Option<SaveFile>,
    is_help_open: bool,
    history: HistoryWindow,
    /// The state of the file on disk whose strip was dismissed.
    dismissed_on_disk: Option<(u64, OnDisk)>,
    watch: FileWatch,
    is_closing_again: bool,
    unsaved_question: Option<Pending>,
    after_saving: Option<Pending>,
    is_quitting: bool,
    seen_document: u64,
    seen_results: u64,
    done_notice: Option<(u64, f64)>,
    window_title: String,
    applied_scale: f32,
}

impl Shell {
    /// An empty window; sets the theme of `ctx`.
    #[must_use]
    pub fn new(ctx: &Context, persisted: Persisted) -> Self {
        theme::install(ctx);
        let repaint = ctx.clone();
        let last_frame = Arc::new(Mutex::new(Instant::now()));
        let seen_frame = Arc::clone(&last_frame);
        // After a moment rather than at once: that is one frame for all that arrives together, where "at once" means two.
        let wake: Wake = Arc::new(move || {
            let since_frame = seen_frame.lock().map_or(NEWS_EVERY, |at| at.elapsed());
            repaint.request_repaint_after(NEWS_EVERY.saturating_sub(since_frame).max(WAKE_AFTER));
        });
        let mut start = StartState::default();
        start.read_samples(&wake);
        ctx.set_theme(persisted.theme.preference());
        ctx.set_zoom_factor(persisted.scale);
        let applied_scale = persisted.scale;
        let mut workbench = Workbench::new(Arc::clone(&wake));
        let settings = Box::new(persisted.cell.settings);
        workbench.apply(Command::Cell(Box::new(CellCommand::SetSettings(settings))));
        Self {
            workbench,
            wake,
            last_frame,
            step: Step::default(),
            selection: Selection::default(),
            start,
            poses: PosesState::default(),
            arcs: ArcsState::default(),
            sequence: SequenceState::default(),
            capture: CaptureState::default(),
            cell_watch: CellWatch::default(),
            compare: CompareState::default(),
            diagnosis: DiagnosisState::default(),
            verify: VerifyState::default(),
            report: ReportState::default(),
            import: ImportState::default(),
            paste_patience: None,
            persisted,
            file_dialog: FileDialog::default(),
            save_path: None,
            drawing: Slot::default(),
            to_write: None,
            is_help_open: false,
            history: HistoryWindow::default(),
            dismissed_on_disk: None,
            watch: FileWatch { last_look: 0.0, had_focus: true },
            is_closing_again: false,
            unsaved_question: None,
            after_saving: None,
            is_quitting: false,
            seen_document: 0,
            seen_results: 0,
            done_notice: None,
            window_title: String::new(),
            applied_scale,
        }
    }

    /// Document, results, jobs and notices.
    #[must_use]
    pub const fn workbench(&self) -> &Workbench {
        &self.workbench
    }

    /// The same, for commands from outside the window: the command line's file, a test.
    pub const fn workbench_mut(&mut self) -> &mut Workbench {
        &mut self.workbench
    }

    /// What is remembered between runs.
    #[must_use]
    pub const fn persisted(&self) -> &Persisted {
        &self.persisted
    }

    /// The step in sight.
    #[must_use]
    pub const fn step(&self) -> Step {
        self.step
    }

    /// Goes to a step.
    pub const fn go_to(&mut self, step: Step) {
        self.step = step;
    }

    /// Whether something is being read or solved in the background.
    #[must_use]
    pub const fn is_busy(&self) -> bool {
        self.workbench.is_busy()
            || self.start.is_reading()
            || self.paste_patience.is_some()
            || self.drawing.is_running()
            || self.report.is_drawing()
    }

    /// The Verify step's state: for whoever drives the window from outside.
    pub const fn verify_mut(&mut self) -> &mut VerifyState {
        &mut self.verify
    }

    /// Takes in finished jobs; also while the window is hidden.
    pub fn logic(&mut self, ctx: &Context) {
        // What has come is drawn in the frame that follows; whoever brought it has asked for that.
        self.workbench.poll();
        self.start.poll();
        self.start.look_for_files(&self.persisted.recent_files, &self.wake);
        self.look_at_file(ctx);
        self.notice_new_document(ctx);
        self.notice_new_results();
        self.take_dialog_answer();
        self.take_drawn(ctx);
        self.go_on_after_saving(ctx);
        self.guard_closing(ctx);
        self.dismiss_done_notice(ctx);
    }

    /// Draws one frame and carries out what the user asked for in it.
    pub fn ui(&mut self, ui: &mut Ui) {
        let ctx = ui.ctx().clone();
        if let Ok(mut at) = self.last_frame.lock() {
            *at = Instant::now();
        }
        // Before anything else, and whatever else has the keyboard.
        if live_cell::takes_stop_key(&ctx, self.workbench.cell()) {
            self.workbench.apply(live_cell::stop());
        }
        // What is typed while a question waits is its answer, and nothing for what lies below.
        let is_asking = self.is_asking();
        save_picture::begin_frame(&ctx);
        let mut actions = if is_asking { Vec::new() } else { actions::pressed(&ctx, &self.workbench) };
        let mut commands = Vec::new();
        if actions.iter().any(|action| action.takes_what_is_typed()) {
            take_what_is_typed(&ctx);
        }
        if !is_asking {
            Self::read_dropped_files(&ctx, &mut commands);
            self.take_pasted_text(&ctx, &mut commands);
        }
        if self.is_help_open {
            // What is typed over the help is not for the rail below it.
            actions.retain(|action| matches!(action, Action::Help | Action::Quit));
        }
        let is_importing = self.workbench.import().is_some();
        if is_importing {
            actions.retain(|action| *action == Action::Quit);
        }
        // Nor is what is typed into the preview.
        let is_covered = is_importing || is_asking;
        let events = if is_covered { ctx.input_mut(|input| std::mem::take(&mut input.events)) } else { Vec::new() };
        self.bars(ui, &mut actions, &mut commands);
        self.center(ui, &mut actions, &mut commands);
        if is_covered {
            ctx.input_mut(|input| input.events = events);
        }
        self.history.show(&ctx, &self.workbench, &mut commands);
        import::show(&ctx, &self.workbench, &mut self.import, &mut self.persisted.imports, &mut commands);
        self.questions(&ctx);
        if is_asking || is_importing || self.is_help_open || self.history.is_open {
            live_cell::stop_above_all(&ctx, self.workbench.cell(), &mut commands);
        }
        self.stop_first(&mut commands);
        // What was typed comes first: an action in the same frame is about it.
        for command in std::mem::take(&mut commands) {
            self.request(command);
        }
        for action in actions {
            self.perform(&ctx, action, &mut commands);
        }
        for command in commands {
            self.request(command);
        }
        if let Some((picture, wanted)) = save_picture::take(&ctx) {
            self.drawing.start("draw picture", &self.wake, move |_| save_picture::draw(&picture, wanted));
        }
        if let Some(file) = save_file::take(&ctx) {
            self.ask_where_to_save(file);
        }
        if std::mem::take(&mut self.is_closing_again) {
            ctx.send_viewport_cmd(ViewportCommand::Close);
        }
        self.remember_cell();
        self.apply_looks(&ctx);
    }

    fn bars(&mut self, ui: &mut Ui, actions: &mut Vec<Action>, commands: &mut Vec<Command>) {
        let palette = theme::palette(ui);
        let surface = Frame::new().fill(palette.surface);
        let bar = surface.inner_margin(Margin::symmetric(16, 0));
        Panel::top("top bar").exact_size(TOP_HEIGHT).frame(bar).show(ui, |ui| {
            top_bar::show(ui, &self.workbench, &mut self.persisted, actions);
        });
        Panel::bottom("status").exact_size(BOTTOM_HEIGHT).frame(bar).show(ui, |ui| {
            status::show(ui, &self.workbench, self.step, actions, commands);
        });
        if status::notices_shown(&self.workbench, self.step).next().is_some() {
            let strip = surface.inner_margin(Margin::symmetric(16, 4));
            Panel::bottom("notices").resizable(false).frame(strip).show(ui, |ui| {
                status::notices(ui, &self.workbench, self.step, commands);
            });
        }
        self.strip_of_file(ui, commands);
        Panel::left("rail").resizable(false).exact_size(RAIL_WIDTH).frame(surface).show(ui, |ui| {
            let num_pose_remarks = self.poses.num_remarks(&self.workbench, self.selection.method);
            rail::show(ui, &self.workbench, &self.selection, num_pose_remarks, self.step, actions);
        });
        // The live cell and the report need the room, and show what there is to inspect themselves.
        let has_inspector = self.persisted.inspector_open && !matches!(self.step, Step::Capture | Step::Report);
        if has_inspector && self.workbench.document().is_some() {
            let beside = surface.inner_margin(Margin { left: 16, right: 8, top: 0, bottom: 0 });
            Panel::right("inspector").resizable(false).exact_size(INSPECTOR_WIDTH).frame(beside).show(ui, |ui| {
                let mut context =
                    PanelContext { workbench: &self.workbench, selection: &mut self.selection, commands, actions };
                inspector::panel::show(ui, &mut context);
            });
        }
    }

    fn center(&mut self, ui: &mut Ui, actions: &mut Vec<Action>, commands: &mut Vec<Command>) {
        let canvas = Frame::new().fill(theme::palette(ui).canvas).inner_margin(12);
        CentralPanel::default().frame(canvas).show(ui, |ui| {
            if self.workbench.document().is_none() && !matches!(self.step, Step::Session | Step::Capture | Step::Verify)
            {
                empty_state(ui, actions);
                return;
            }
            let mut context =
                PanelContext { workbench: &self.workbench, selection: &mut self.selection, commands, actions };
            match self.step {
                Step::Session => {
                    start::panel::show(ui, &mut context, &mut self.start, &mut self.persisted.recent_files);
                }
                Step::Capture => {
                    capture::show(ui, &mut context, &mut self.persisted.cell, &mut self.capture);
                }
                Step::Poses => poses::panel::show(ui, &mut context, &mut self.poses),
                Step::Arcs if rail::is_sequence(context.workbench) => {
                    sequence::show(ui, &mut context, &mut self.sequence);
                }
                Step::Arcs => arcs::show(ui, &mut context, &mut self.arcs),
                Step::Compare => compare::show(ui, &mut context, &mut self.compare),
                Step::Diagnosis => diagnosis::show(ui, &mut context, &mut self.diagnosis),
                Step::Verify => verify::show(ui, &mut context, &mut self.verify),
                Step::Report => report::show(ui, &mut context, &mut self.report, &mut self.persisted.report),
            }
        });
    }

    /// A picture has been drawn: it goes to the clipboard, or to a file.
    fn take_drawn(&mut self, ctx: &Context) {
        match self.drawing.poll() {
            Some(JobOutcome::Done(Drawn::File(file))) => self.ask_where_to_save(file),
            Some(JobOutcome::Done(Drawn::Image(image))) => {
                ctx.copy_image(image);
                let copied = report_words::COPIED_PICTURE.to_owned();
                self.workbench.apply(Command::Tell(NoticeKind::Done, copied));
            }
            Some(JobOutcome::Panicked | JobOutcome::NotStarted(_)) => {
                let failed = report_words::NO_PICTURE.to_owned();
                self.workbench.apply(Command::Tell(NoticeKind::Error, failed));
            }
            None => {}
        }
    }

    fn read_dropped_files(ctx: &Context, commands: &mut Vec<Command>) {
        let (dropped, is_hovering) = ctx.input(|input| {
            let paths: Vec<_> = input.raw.dropped_files.iter().map(|file| file.path().to_owned()).collect();
            (paths, !input.raw.hovered_files.is_empty())
        });
        if is_hovering {
            drop_overlay(ctx);
        }
        if !dropped.is_empty() {
            commands.push(Command::to_read(dropped));
        }
    }

    fn perform(&mut self, ctx: &Context, action: Action, commands: &mut Vec<Command>) {
        match action {
            Action::Open => self.ask_for_paths(Purpose::Open),
            Action::OpenSequence => self.ask_for_paths(Purpose::SequenceFolder),
            Action::Import => self.ask_for_paths(Purpose::ImportFiles),
            Action::ImportFolder => self.ask_for_paths(Purpose::ImportFolder),
            Action::AddSession => self.ask_for_paths(Purpose::AddSession),
            Action::AddFurther => self.ask_for_paths(Purpose::AddFurther),
            Action::ExportPoses => self.ask_for_paths(Purpose::ExportPoses),
            Action::ExportProfiles => self.ask_for_paths(Purpose::ExportProfiles),
            Action::ExportPoints => self.ask_for_paths(Purpose::ExportPoints),
            Action::SaveReport => self.ask_for_paths(Purpose::ReportFolder),
            Action::OpenPoints => self.ask_for_paths(Purpose::OpenPoints),
            Action::ChooseCalibration => self.ask_for_paths(Purpose::Calibration),
            Action::ChooseCompared(side) => self.ask_for_paths(Purpose::Compared(side)),
            Action::ChooseResultFolder => self.ask_for_paths(Purpose::ResultFolder),
            Action::ChooseWatchedFolder => self.ask_for_paths(Purpose::WatchedFolder),
            Action::Practise(target) => commands.push(Command::Cell(Box::new(CellCommand::Practise(target)))),
            Action::EndPractice => commands.push(Command::Cell(Box::new(CellCommand::EndPractice))),
            Action::Paste => self.ask_for_clipboard(ctx),
            Action::OpenSample(sample_idx) => commands.push(Command::OpenSample(sample_idx)),
            Action::Save => self.save(),
            Action::SaveAs => self.save_as(),
            Action::Close => commands.push(Command::CloseDocument),
            Action::Quit => ctx.send_viewport_cmd(ViewportCommand::Close),
            Action::Undo => commands.push(Command::Undo),
            Action::Redo => commands.push(Command::Redo),
            Action::History => self.history.is_open = !self.history.is_open,
            Action::Help => self.is_help_open = !self.is_help_open,
            Action::GoTo(step) => self.step = step,
        }
    }

    /// Theme and scale as chosen in the menu; a scale set with the keyboard is taken over.
    fn apply_looks(&mut self, ctx: &Context) {
        ctx.set_theme(self.persisted.theme.preference());
        let menu_scale = self.persisted.scale;
        if (self.applied_scale - menu_scale).abs() > f32::EPSILON {
            ctx.set_zoom_factor(menu_scale);
            self.applied_scale = menu_scale;
        } else if (ctx.zoom_factor() - menu_scale).abs() > f32::EPSILON {
            self.persisted.scale = ctx.zoom_factor();
            self.applied_scale = self.persisted.scale;
        }
    }
}

/// Takes the focus from what has it: a field hands in what was typed.
fn take_what_is_typed(ctx: &Context) {
    ctx.memory_mut(|memory| {
        if let Some(id) = memory.focused() {
            memory.surrender_focus(id);
        }
    });
}

fn empty_state(ui: &mut Ui, actions: &mut Vec<Action>) {
    ui.vertical_centered(|ui| {
        ui.add_space(ui.available_height() / 3.0);
        ui.label(theme::heading(words::EMPTY_TITLE));
        ui.add_space(8.0);
        ui.label(theme::dim(ui, words::EMPTY_HINT));
        ui.add_space(16.0);
        if widgets::primary_button(ui, words::CHOOSE_SESSION).clicked() {
            actions.push(Action::GoTo(Step::Session));
        }
    });
}

fn drop_overlay(ctx: &Context) {
    let layer = egui::LayerId::new(egui::Order::Foreground, egui::Id::unique("drop overlay"));
    let painter = ctx.layer_painter(layer);
    let rect = ctx.content_rect();
    let accent = theme::palette_of(&ctx.global_style().visuals).accent;
    painter.rect_filled(rect, 0.0, accent.gamma_multiply(0.15));
    painter.rect_stroke(rect.shrink(8.0), 4.0, Stroke::new(2.0, accent), egui::StrokeKind::Inside);
    let text = crate::text::start::DROP_HERE;
    painter.text(rect.center(), egui::Align2::CENTER_CENTER, text, theme::strong_font(), accent);
}
