//! The report before it is written: at the left what it is to hold, at the right the page.

use std::collections::BTreeSet;
use std::sync::Arc;

use egui::{Align, Frame, Label, Layout, RichText, ScrollArea, TextEdit, Ui, UiBuilder};
use serde::{Deserialize, Serialize};

use crate::app::workbench::reporting::Gathered;
use crate::app::{Command, NoticeKind, Workbench};
use crate::report::document::{Document, Options, Section, SectionId};
use crate::text::report_panel as words;
use crate::ui::actions::Action;
use crate::ui::widgets::{self, FromTop, name_field};
use crate::ui::{PanelContext, theme};

use super::page::Page;

/// Width of what is chosen, points.
const CHOICES_WIDTH: f32 = 236.0;
/// The page is not wider than this, points: a line of text that the eye can follow.
const MOST_PAGE_WIDTH: f32 = 860.0;
/// From where a page that is out of date fades.
const OLD_OPACITY: f32 = 0.6;

/// Who answers for reports, kept between runs.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct ReportMemory {
    /// Who answers for them.
    pub operator: String,
    /// Where they are made.
    pub place: String,
}

/// What the preview remembers between frames.
#[derive(Debug)]
pub(super) struct PreviewState {
    sections: BTreeSet<SectionId>,
    date: String,
    remarks: String,
    /// The revision for which the report was asked last: once is enough, also after a cancel.
    asked_for: Option<u64>,
    shown: Option<Shown>,
    page: Page,
    list: FromTop,
}

/// The sections with the operator's words in them.
const OF_OPERATOR: [SectionId; 2] = [SectionId::Setup, SectionId::Signature];

/// What is on the page, and what it was made from.
#[derive(Debug)]
struct Shown {
    gathered: Arc<Gathered>,
    options: Options,
    /// The sections with the operator's words in them: few and short, so that they can be made anew at every key.
    of_operator: Document,
}

impl Shown {
    fn new(gathered: Arc<Gathered>, options: Options) -> Self {
        let sections = OF_OPERATOR.into_iter().filter(|section| options.sections.contains(section)).collect();
        let of_operator = gathered.document_with(&Options { sections, ..options.clone() });
        Self { gathered, options, of_operator }
    }

    /// The sections that are wanted, in order.
    fn sections(&self) -> Vec<&Section> {
        let wanted = |section: &&Section| self.options.sections.contains(&section.id);
        let own = |id: SectionId| self.of_operator.sections.iter().find(|section| section.id == id);
        let all = self.gathered.document.sections.iter().filter(wanted);
        all.map(|section| own(section.id).unwrap_or(section)).collect()
    }
}

impl Default for PreviewState {
    fn default() -> Self {
        Self {
            sections: Options::default().sections,
            date: String::new(),
            remarks: String::new(),
            asked_for: None,
            shown: None,
            page: Page::default(),
            list: FromTop::default(),
        }
    }
}

impl PreviewState {
    pub(super) fn options(&self, memory: &ReportMemory) -> Options {
        Options {
            sections: self.sections.clone(),
            operator: memory.operator.clone(),
            place: memory.place.clone(),
            date: self.date.clone(),
            notes: self.remarks.clone(),
        }
    }

    /// Whether a figure is being drawn.
    pub(super) const fn is_drawing(&self) -> bool {
        self.page.is_drawing()
    }

    /// The document with what is chosen, made anew where that has changed.
    fn update(&mut self, gathered: &Arc<Gathered>, memory: &ReportMemory) {
        let options = self.options(memory);
        let is_known = |shown: &Shown| Arc::ptr_eq(&shown.gathered, gathered);
        match &self.shown {
            Some(shown) if is_known(shown) && shown.options == options => return,
            Some(shown) if is_known(shown) => self.page.forget_heights(),
            _ => self.page = Page::default(),
        }
        self.shown = Some(Shown::new(Arc::clone(gathered), options));
    }
}

/// Shows the section.
pub(super) fn show(ui: &mut Ui, context: &mut PanelContext<'_>, state: &mut PreviewState, memory: &mut ReportMemory) {
    let workbench = context.workbench;
    let Some(document) = workbench.document() else { return };
    if document.session.is_empty() {
        widgets::nothing(ui, words::NOTHING_TO_REPORT);
        return;
    }
    let report = workbench.report();
    let is_current = report.last().is_some_and(|found| workbench.is_current(found.revision));
    let is_idle = workbench.results_are_current() && !report.is_running();
    if !is_current && is_idle && state.asked_for != Some(document.revision) {
        state.asked_for = Some(document.revision);
        context.commands.push(Command::GatherReport);
    }
    let area = ui.available_rect_before_wrap();
    let (left, right) = area.split_left_right_at_x(area.left() + CHOICES_WIDTH);
    let child = |rect| UiBuilder::new().max_rect(rect).layout(Layout::top_down(Align::Min));
    let mut left = ui.new_child(child(left));
    choices(&mut left, context, state, memory);
    let mut right = ui.new_child(child(right.with_min_x(right.left() + theme::GAP)));
    let Some(found) = report.last() else {
        if report.is_running() || workbench.solve_progress().is_some() {
            widgets::nothing(&mut right, words::GATHERING);
        } else {
            not_gathered(&mut right, context);
        }
        ui.advance_cursor_after_rect(area);
        return;
    };
    state.update(&found.value, memory);
    if !is_current {
        right.multiply_opacity(OLD_OPACITY);
    }
    paper(&mut right, state);
    ui.advance_cursor_after_rect(area);
}

fn not_gathered(ui: &mut Ui, context: &mut PanelContext<'_>) {
    ui.vertical_centered(|ui| {
        ui.add_space(ui.available_height() * 0.35);
        ui.label(theme::dim(ui, words::NOT_GATHERED));
        ui.add_space(8.0);
        if ui.button(words::GATHER).clicked() {
            context.commands.push(Command::GatherReport);
        }
    });
}

/// What the report is to hold, who answers for it, and where it goes.
fn choices(ui: &mut Ui, context: &mut PanelContext<'_>, state: &mut PreviewState, memory: &mut ReportMemory) {
    let height = ui.available_height();
    let (workbench, actions) = (context.workbench, &mut *context.actions);
    let button = |ui: &mut Ui| save_button(ui, workbench, actions);
    let mut command = None;
    widgets::card_with_height(ui, words::SECTIONS, height, button, |ui| {
        let area = state.list.apply(ScrollArea::vertical().id_salt("report choices").auto_shrink(false));
        area.show(ui, |ui| {
            Frame::new().inner_margin(egui::Margin::symmetric(12, 8)).show(ui, |ui| {
                ui.spacing_mut().item_spacing.y = 2.0;
                command = written(ui, workbench);
                for section in SectionId::ALL {
                    let mut is_wanted = state.sections.contains(&section);
                    if ui.checkbox(&mut is_wanted, section.title()).changed() {
                        if is_wanted {
                            state.sections.insert(section);
                        } else {
                            state.sections.remove(&section);
                        }
                    }
                }
                ui.add_space(8.0);
                field(ui, words::OPERATOR, "", &mut memory.operator);
                field(ui, words::PLACE, "", &mut memory.place);
                field(ui, words::DATE, words::DATE_HINT, &mut state.date);
                remarks(ui, &mut state.remarks);
            });
        });
    });
    context.commands.extend(command);
}

/// The next action of the step; not while what is shown is no longer so.
fn save_button(ui: &mut Ui, workbench: &Workbench, actions: &mut Vec<Action>) {
    let is_current = workbench.report().last().is_some_and(|found| workbench.is_current(found.revision));
    if workbench.is_writing_report() {
        ui.label(theme::dim(ui, words::WRITING));
        return;
    }
    ui.add_enabled_ui(is_current, |ui| {
        if widgets::primary_button(ui, words::SAVE_REPORT).on_hover_text(words::SAVE_REPORT_HINT).clicked() {
            actions.push(Action::SaveReport);
        }
    });
}

/// Where the report was written last, and what can be done with it.
fn written(ui: &mut Ui, workbench: &Workbench) -> Option<Command> {
    let page = workbench.written_report()?;
    let path = page.display().to_string();
    ui.add(Label::new(theme::dim(ui, words::WRITTEN_TO).size(theme::SMALL_SIZE)));
    ui.add(Label::new(RichText::new(&path).size(theme::SMALL_SIZE)).wrap());
    let command = ui.horizontal(|ui| {
        if ui.button(words::OPEN_IN_BROWSER).clicked() {
            return Some(Command::OpenReport);
        }
        ui.button(words::COPY_PATH).clicked().then(|| {
            ui.ctx().copy_text(path);
            Command::Tell(NoticeKind::Done, words::COPIED_TEXT.to_owned())
        })
    });
    ui.add_space(8.0);
    command.inner
}

fn field(ui: &mut Ui, name: &str, hint: &str, text: &mut String) {
    ui.label(theme::dim(ui, name).size(theme::SMALL_SIZE));
    let field = ui.add(TextEdit::singleline(text).hint_text(hint).desired_width(f32::INFINITY));
    name_field(&field, name, text);
    ui.add_space(4.0);
}

fn remarks(ui: &mut Ui, text: &mut String) {
    ui.label(theme::dim(ui, words::REMARKS).size(theme::SMALL_SIZE));
    let field = ui.add(TextEdit::multiline(text).desired_rows(2).desired_width(f32::INFINITY));
    name_field(&field, words::REMARKS, text);
}

/// The page on the desk.
fn paper(ui: &mut Ui, state: &mut PreviewState) {
    let Some(shown) = &state.shown else { return };
    let sections = shown.sections();
    if sections.is_empty() {
        widgets::nothing(ui, words::NO_SECTIONS);
        return;
    }
    let area = ScrollArea::vertical().id_salt("report page").auto_shrink(false);
    area.show(ui, |ui| {
        let width = ui.available_width().min(MOST_PAGE_WIDTH);
        let left = (ui.available_width() - width) / 2.0;
        ui.horizontal_top(|ui| {
            ui.spacing_mut().item_spacing.x = 0.0;
            ui.add_space(left);
            ui.allocate_ui_with_layout(egui::vec2(width, 0.0), Layout::top_down(Align::Min), |ui| {
                state.page.show(ui, &shown.gathered.document, &sections);
            });
        });
    });
}
