//! The preview as a window over the current step: settings at the left, the table at the right, what to make of it below.

use std::sync::Arc;

use egui::{Align, Context, Frame, Id, Key, Layout, Modal, Modifiers, ProgressBar, ScrollArea, Stroke, Ui, vec2};

use crate::app::{Command, ImportDraft, ImportInto, Progress, Workbench};
use crate::session::import::{ImportError, ImportOptions, Imported, Source, check_edges};
use crate::session::table::number::parse_number;
use crate::session::{Edit, Reading, Session, SetupField, Station, Target};
use crate::text::import as words;
use crate::text::shell as shell_words;
use crate::ui::{theme, widgets};

use super::memory::{Form, ImportMemory};
use super::settings::Typed;
use super::{bag, fields, model, preview, settings};

/// Distance from the window's border, points; less where there is little room.
const MARGIN: f32 = 24.0;
const NARROW_MARGIN: f32 = 8.0;
const NARROW_WIDTH: f32 = 1200.0;
/// Width of the settings, points.
const SETTINGS_WIDTH: f32 = 312.0;
/// Height of the rows above and below, points.
const ROW_HEIGHT: f32 = 44.0;

/// What was measured, as far as it is chosen here.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum TargetKind {
    #[default]
    Ball,
    RightAnglePlate,
    Point,
    Pose,
    Workpiece,
}

const TARGETS: [TargetKind; 5] =
    [TargetKind::Ball, TargetKind::RightAnglePlate, TargetKind::Point, TargetKind::Pose, TargetKind::Workpiece];

/// What is typed in the preview of one draft.
#[derive(Debug, Default)]
pub struct ImportState {
    draft_id: u64,
    /// What the draft's text looks like before anything is set.
    form: Option<Form>,
    is_as_last_time: bool,
    typed: Typed,
    name: String,
    radius: String,
    target: TargetKind,
    had_text_focus: bool,
}

impl ImportState {
    /// Begins anew with another draft, and reads it as one that looks alike was read before.
    fn follow(&mut self, draft: &ImportDraft, memory: &ImportMemory, commands: &mut Vec<Command>) {
        if self.draft_id != draft.id {
            let radius = memory.ball_radius_mm.map(|radius_mm| radius_mm.to_string()).unwrap_or_default();
            *self = Self { draft_id: draft.id, radius, ..Self::default() };
        }
        if self.name.is_empty() && self.form.is_none() {
            self.name = words::suggested_name(&draft.sources);
        }
        let Some(outcome) = draft.outcome.as_ref().filter(|_| self.form.is_none()) else { return };
        let form = Form::of(outcome, &draft.sources);
        let recalled = memory.recall(&form).map(|options| fitting(options, outcome, draft));
        if let Some(options) = recalled.filter(|options| *options != draft.options) {
            self.is_as_last_time = true;
            commands.push(Command::SetImportOptions(Box::new(options)));
        }
        self.form = Some(form);
        if outcome.as_ref().is_ok_and(|imported| imported.has_edges()) {
            self.target = TargetKind::RightAnglePlate;
        }
        if outcome.as_ref().is_ok_and(|imported| imported.has_target_poses()) {
            self.target = TargetKind::Pose;
        }
        if self.radius.is_empty() && has_only_points(outcome) {
            USUAL_RADIUS_MM.clone_into(&mut self.radius);
        }
    }

    /// What a new session is to be, or why it cannot be made yet.
    fn new_session(&self, stations: &[Station]) -> Result<ImportInto, &'static str> {
        let name = self.name.trim().to_owned();
        if name.is_empty() {
            return Err(words::NAME_MISSING);
        }
        let target = match self.target {
            TargetKind::Ball => self.ball()?,
            TargetKind::RightAnglePlate => Target::RightAnglePlate,
            TargetKind::Point => Target::Point,
            TargetKind::Pose => Target::pose(),
            TargetKind::Workpiece => Target::Workpiece,
        };
        check_edges(stations, &target).map_err(|_| words::EDGES_OF_NO_PLATE)?;
        Ok(ImportInto::NewSession { name, target })
    }

    /// The ball, or why its radius is none that a session can have.
    fn ball(&self) -> Result<Target, &'static str> {
        let target = Target::ball(parse_number(&self.radius).map_err(|_| words::RADIUS_MISSING)?);
        let setup = Edit::Setup(SetupField::Target(target.clone()));
        setup.apply(&Session::new(Target::Point)).map_err(|_| words::RADIUS_UNUSABLE)?;
        Ok(target)
    }
}

/// Of what was set for another bag only the topics and frames that this one has.
fn fitting(
    mut options: ImportOptions,
    outcome: &Result<Arc<Imported>, ImportError>,
    draft: &ImportDraft,
) -> ImportOptions {
    let Some(bag) = draft.sources.iter().find_map(Source::bag) else { return options };
    let has_topic = |name: &String| bag.topics.iter().any(|topic| topic.name == *name && topic.kind.is_some());
    options.bag.pose_topic = options.bag.pose_topic.filter(has_topic);
    options.bag.profile_topic = options.bag.profile_topic.filter(has_topic);
    let report = outcome.as_deref().ok().and_then(bag::report_of);
    let has_frame =
        |name: &String| report.is_some_and(|report| report.listed_frames.iter().any(|frame| frame.name == *name));
    options.bag.base_frame = options.bag.base_frame.filter(has_frame);
    options.bag.flange_frame = options.bag.flange_frame.filter(has_frame);
    options
}

/// Points that are reduced already need no radius, but a session of a ball has one.
const USUAL_RADIUS_MM: &str = "15";

fn has_only_points(outcome: &Result<Arc<Imported>, ImportError>) -> bool {
    outcome.as_ref().is_ok_and(|imported| {
        let mut captures = imported.stations.iter().flat_map(|station| &station.captures).peekable();
        captures.peek().is_some() && captures.all(|capture| matches!(capture.reading, Reading::Point(_)))
    })
}

/// Shows the preview while there is one; what the user has set is remembered once it is made.
pub fn show(
    ctx: &Context,
    workbench: &Workbench,
    state: &mut ImportState,
    memory: &mut ImportMemory,
    commands: &mut Vec<Command>,
) {
    let Some(draft) = workbench.import() else { return };
    state.follow(draft, memory, commands);
    let full = ctx.content_rect();
    let margin = if full.width() < NARROW_WIDTH { NARROW_MARGIN } else { MARGIN };
    let size = full.size() - vec2(2.0 * margin, 2.0 * margin);
    let window = Frame::window(&ctx.global_style()).inner_margin(0);
    let had_text_focus = state.had_text_focus;
    let response = Modal::new(Id::unique("import preview")).frame(window).show(ctx, |ui| {
        ui.set_min_size(size);
        ui.set_max_size(size);
        contents(ui, workbench, draft, state, memory, commands);
    });
    state.had_text_focus = ctx.text_edit_focused();
    // Escape leaves a list or a field first.
    let is_free = response.is_top_modal && !response.any_popup_open && !had_text_focus;
    if is_free && ctx.input_mut(|input| input.consume_key(Modifiers::NONE, Key::Escape)) {
        commands.push(Command::CancelImport);
    }
}

fn contents(
    ui: &mut Ui,
    workbench: &Workbench,
    draft: &ImportDraft,
    state: &mut ImportState,
    memory: &mut ImportMemory,
    commands: &mut Vec<Command>,
) {
    ui.spacing_mut().item_spacing.y = 0.0;
    let full = ui.max_rect();
    let hairline = Stroke::new(1.0, theme::palette(ui).hairline);
    let head = full.with_max_y(full.top() + ROW_HEIGHT);
    let foot = full.with_min_y(full.bottom() - ROW_HEIGHT - 8.0);
    let middle = full.with_min_y(head.bottom()).with_max_y(foot.top());
    let split = middle.left() + SETTINGS_WIDTH;
    ui.painter().rect_filled(middle.with_min_x(split), 0.0, theme::palette(ui).canvas);
    ui.painter().hline(full.x_range(), head.bottom(), hairline);
    ui.painter().hline(full.x_range(), foot.top(), hairline);
    ui.painter().vline(split, middle.y_range(), hairline);
    let child = |rect, layout| egui::UiBuilder::new().max_rect(rect).layout(layout);
    let row = Layout::left_to_right(Align::Center);
    let inside = |rect: egui::Rect| rect.shrink2(vec2(16.0, 0.0));
    heading(&mut ui.new_child(child(inside(head), row)), workbench, draft, state, memory, commands);
    let left = middle.with_max_x(split).shrink2(vec2(0.0, 8.0));
    let mut left_ui = ui.new_child(child(left.with_min_x(left.left() + 16.0), Layout::top_down(Align::Min)));
    let right = middle.with_min_x(split).shrink(12.0);
    let mut right_ui = ui.new_child(child(right, Layout::top_down(Align::Min)));
    right_ui.set_clip_rect(right.intersect(ui.clip_rect()));
    let by_settings = ScrollArea::vertical()
        .id_salt("import settings")
        .auto_shrink(false)
        .show(&mut left_ui, |ui| {
            ui.set_max_width(ui.available_width() - 16.0);
            ui.spacing_mut().item_spacing.y = 4.0;
            settings::show(ui, draft, &mut state.typed)
        })
        .inner;
    right_ui.spacing_mut().item_spacing.y = 4.0;
    if let Some(bag) = draft.sources.iter().find_map(Source::bag) {
        bag::overview(&mut right_ui, bag, draft.outcome.as_ref().and_then(|outcome| outcome.as_deref().ok()));
        right_ui.add_space(theme::GAP - 4.0);
    }
    let by_table = match &draft.outcome {
        Some(Ok(imported)) => preview::show(&mut right_ui, draft, imported),
        Some(Err(error)) => {
            preview::show_error(&mut right_ui, draft, error);
            None
        }
        None => {
            widgets::nothing(&mut right_ui, words::READING);
            None
        }
    };
    if let Some(options) = by_settings.or(by_table) {
        state.is_as_last_time = false;
        commands.push(Command::SetImportOptions(Box::new(options)));
    }
    footer(&mut ui.new_child(child(inside(foot), row)), workbench, draft, state, memory, commands);
    ui.advance_cursor_after_rect(full);
}

/// What this is, what will come of it, and whether it is read as something was read before.
fn heading(
    ui: &mut Ui,
    workbench: &Workbench,
    draft: &ImportDraft,
    state: &mut ImportState,
    memory: &mut ImportMemory,
    commands: &mut Vec<Command>,
) {
    ui.label(theme::heading(words::TITLE));
    ui.add_space(8.0);
    let palette = theme::palette(ui);
    match &draft.outcome {
        Some(Ok(imported)) if !imported.stations.is_empty() => {
            let (mark, color) = if imported.num_problems == 0 { ("✔", palette.good) } else { ("!", palette.warn) };
            ui.label(egui::RichText::new(mark).color(color));
            ui.label(words::outcome(imported));
        }
        Some(Err(ImportError::Cancelled)) | None => {}
        Some(_) => {
            ui.label(egui::RichText::new("✖").color(palette.bad));
            ui.label(words::NOTHING);
        }
    }
    if workbench.is_reading_import() {
        let fraction = workbench.import_progress().map_or(0.0, Progress::fraction);
        ui.add(ProgressBar::new(fraction).desired_width(72.0).desired_height(6.0));
        ui.label(theme::dim(ui, words::READING));
    }
    ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
        if draft.options == ImportOptions::default() {
            return;
        }
        let mut back_to_recognised = false;
        if state.is_as_last_time {
            if ui.button(words::FORGET).clicked() {
                if let Some(form) = &state.form {
                    memory.forget(form);
                }
                back_to_recognised = true;
            }
            ui.label(theme::dim(ui, words::AS_LAST_TIME)).on_hover_text(words::AS_LAST_TIME_HINT);
        } else {
            back_to_recognised = ui.button(words::RESET).on_hover_text(words::RESET_HINT).clicked();
        }
        if back_to_recognised {
            state.is_as_last_time = false;
            commands.push(Command::SetImportOptions(Box::default()));
        }
    });
}

/// What to make of it.
fn footer(
    ui: &mut Ui,
    workbench: &Workbench,
    draft: &ImportDraft,
    state: &mut ImportState,
    memory: &mut ImportMemory,
    commands: &mut Vec<Command>,
) {
    let imported = draft.outcome.as_ref().and_then(|outcome| outcome.as_deref().ok());
    if imported.is_none_or(|imported| imported.session.is_none()) {
        new_session_fields(ui, state);
    }
    let not_ready = match imported {
        _ if workbench.is_reading_import() => Some(words::STILL_READING),
        Some(imported) if !imported.stations.is_empty() => None,
        Some(imported) if model::has_profiles(imported) => Some(words::PROFILES_ONLY),
        _ => Some(words::NOTHING_READ),
    };
    let stations = imported.map_or(&[][..], |imported| imported.stations.as_slice());
    let new_session = match imported {
        Some(Imported { session: Some(session), .. }) => {
            Ok(ImportInto::NewSession { name: session.name.clone(), target: session.target.clone() })
        }
        _ => state.new_session(stations),
    };
    let new_session = not_ready.map_or(new_session, Err);
    let is_open = workbench.document().is_some();
    let add = match (not_ready, workbench.document()) {
        (Some(reason), _) => Err(reason),
        (None, None) => Err(words::NOTHING_OPEN),
        (None, Some(document)) => check_edges(stations, &document.session.target)
            .map(|()| ImportInto::OpenSession)
            .map_err(|_| words::EDGES_OF_NO_PLATE),
    };
    ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
        let mut made = None;
        let mut button = |ui: &mut Ui, label: &str, is_primary: bool, into: Result<ImportInto, &'static str>| {
            let response = ui.add_enabled_ui(into.is_ok(), |ui| {
                if is_primary { widgets::primary_button(ui, label) } else { ui.button(label) }
            });
            match into {
                Ok(into) if response.inner.clicked() => made = Some(into),
                Ok(_) => {}
                Err(reason) => {
                    response.inner.on_disabled_hover_text(reason);
                }
            }
        };
        // The next action stands at the right end, as in all dialogs; which one it is depends on what is open.
        if is_open {
            button(ui, words::ADD, true, add);
            button(ui, words::NEW_SESSION, false, new_session);
        } else {
            button(ui, words::NEW_SESSION, true, new_session);
            button(ui, words::ADD, false, add);
        }
        if ui.button(shell_words::CANCEL).clicked() {
            commands.push(Command::CancelImport);
        }
        if let Some(into) = made {
            remember(draft, state, &into, memory);
            commands.push(Command::FinishImport(into));
        }
    });
}

fn new_session_fields(ui: &mut Ui, state: &mut ImportState) {
    ui.label(theme::dim(ui, words::NAME));
    let width = if ui.available_width() < NARROW_WIDTH { 136.0 } else { 240.0 };
    fields::text_field(ui, words::NAME_FIELD, "", &mut state.name, width);
    ui.add_space(8.0);
    ui.label(theme::dim(ui, words::TARGET));
    let named = |target| {
        match target {
            TargetKind::Ball => words::BALL,
            TargetKind::RightAnglePlate => words::PLATE,
            TargetKind::Point => words::POINT,
            TargetKind::Pose => words::POSE,
            TargetKind::Workpiece => words::WORKPIECE,
        }
        .to_owned()
    };
    ui.scope(|ui| {
        ui.set_max_width(128.0);
        if let Some(target) = fields::choice(ui, words::TARGET_FIELD, state.target, &TARGETS, named) {
            state.target = target;
        }
    });
    if state.target == TargetKind::Ball {
        ui.add_space(8.0);
        ui.label(theme::dim(ui, words::RADIUS));
        fields::text_field(ui, words::RADIUS_FIELD, "", &mut state.radius, 64.0);
        ui.label(theme::dim(ui, words::MM));
        if let Err(reason) = state.ball() {
            let needed = egui::RichText::new(words::NEEDED).color(theme::palette(ui).warn);
            ui.label(needed).on_hover_text(reason);
        }
    }
}

fn remember(draft: &ImportDraft, state: &ImportState, into: &ImportInto, memory: &mut ImportMemory) {
    if let Some(form) = &state.form {
        memory.remember(form, &draft.options);
    }
    if let ImportInto::NewSession { target: Target::Ball { radius_mm, .. }, .. } = into {
        memory.ball_radius_mm = Some(*radius_mm);
    }
}
