//! The session's own fields, edited in place.
//!
//! Text is taken over with every stroke, as one step of undo for each stay in a field. A number is taken over when the
//! field is left, or with Enter; one that cannot stand there stays in sight with the reason until it is mended or
//! Escape brings the old one back. A field whose value has changed meanwhile, by an undo for instance, drops its text.

use std::collections::HashMap;

use egui::{Align, Align2, ComboBox, Id, Key, Label, Layout, Response, Role, TextEdit, Ui, WidgetInfo, vec2};

use crate::app::{Command, Document};
use crate::session::{Edit, SetupField, new_gesture};
use crate::text::start as words;
use crate::ui::theme;
use crate::ui::widgets::{number_text, split_row, value_row};

use super::form_model::{Field, MOUNTS, TargetKind};

/// Width of a field for text at most, points.
const TEXT_WIDTH: f32 = 220.0;
/// Width of a field for several numbers, points.
const NUMBERS_WIDTH: f32 = 300.0;
/// Width of a field for a number, points.
const NUMBER_WIDTH: f32 = 96.0;
/// Rows of the notes in sight when they are few.
const NOTES_ROWS: usize = 3;
/// Width of a unit, points.
const UNIT_WIDTH: f32 = 24.0;

/// A number that is not in the document.
#[derive(Clone, Debug, PartialEq)]
struct Draft {
    text: String,
    /// What the document held when typing began.
    base: String,
    problem: Option<String>,
}

/// What is being typed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FormState {
    drafts: HashMap<Field, Draft>,
    typing: Option<(Field, u64)>,
}

impl FormState {
    /// The row of a field: its label at the left, the field and its unit at the right, and what is wrong with it below.
    pub fn row(&mut self, ui: &mut Ui, document: &Document, field: Field, commands: &mut Vec<Command>) -> Response {
        let response = split_row(ui, field.label(), |ui| {
            let unit = unit_column(ui);
            if field.is_text() {
                let width = TEXT_WIDTH.min(ui.available_width() * 0.66);
                self.text_field(ui, document, field, width, commands)
            } else {
                let words = theme::dim(ui, field.unit());
                let layout = Layout::left_to_right(Align::Center);
                ui.new_child(egui::UiBuilder::new().max_rect(unit).layout(layout)).label(words);
                self.number_field(ui, document, field, commands)
            }
        });
        if let Some(problem) = self.drafts.get(&field).and_then(|draft| draft.problem.as_ref()) {
            problem_line(ui, problem);
        }
        response
    }

    /// A field for text; every stroke goes to the document.
    pub fn text_field(
        &mut self,
        ui: &mut Ui,
        document: &Document,
        field: Field,
        width: f32,
        commands: &mut Vec<Command>,
    ) -> Response {
        let mut text = field.text(&document.session);
        let edit = match field {
            Field::Notes => TextEdit::multiline(&mut text).desired_rows(NOTES_ROWS),
            _ => TextEdit::singleline(&mut text).align(Align2::LEFT_CENTER),
        };
        let edit = edit.id(id_of(field)).hint_text(field.hint()).margin(vec2(8.0, 3.0)).desired_width(width);
        let response = ui.add(edit);
        name_field(&response, field, &text);
        if response.changed() {
            let gesture = match self.typing {
                Some((typing, gesture)) if typing == field => gesture,
                _ => new_gesture(),
            };
            self.typing = Some((field, gesture));
            if let Ok(edit) = field.edit(&text, &document.session) {
                commands.push(Command::Edit { edit, gesture: Some(gesture) });
            }
        }
        if response.lost_focus() && self.typing.is_some_and(|(typing, _)| typing == field) {
            self.typing = None;
        }
        response
    }

    fn number_field(
        &mut self,
        ui: &mut Ui,
        document: &Document,
        field: Field,
        commands: &mut Vec<Command>,
    ) -> Response {
        let base = field.text(&document.session);
        if self.drafts.get(&field).is_some_and(|draft| draft.base != base) {
            self.drafts.remove(&field);
        }
        let draft = self.drafts.get(&field);
        let mut text = draft.map_or_else(|| base.clone(), |draft| draft.text.clone());
        let has_problem = draft.is_some_and(|draft| draft.problem.is_some());
        if has_problem {
            let bad = egui::Stroke::new(1.0, theme::palette(ui).bad);
            let widgets = &mut ui.visuals_mut().widgets;
            (widgets.inactive.bg_stroke, widgets.hovered.bg_stroke) = (bad, bad);
            ui.visuals_mut().selection.stroke = bad;
        }
        let width =
            if field.has_several_numbers() { NUMBERS_WIDTH.min(ui.available_width() * 0.9) } else { NUMBER_WIDTH };
        let edit = TextEdit::singleline(&mut text)
            .id(id_of(field))
            .hint_text(number_text(field.hint()))
            .font(theme::number_font())
            .align(Align2::RIGHT_CENTER)
            .margin(vec2(8.0, 3.0))
            .desired_width(width);
        let response = ui.add(edit);
        name_field(&response, field, &text);
        if response.changed() {
            // A reason that was given is kept up to date; a new one is given only when the field is left.
            let problem = if has_problem { field.edit(&text, &document.session).err() } else { None };
            self.drafts.insert(field, Draft { text, base, problem });
        }
        if !response.lost_focus() {
            return response;
        }
        if ui.input(|input| input.key_pressed(Key::Escape)) {
            self.drafts.remove(&field);
        } else if let Some(draft) = self.drafts.get_mut(&field) {
            match field.edit(&draft.text, &document.session) {
                Ok(edit) => {
                    commands.push(Command::Edit { edit, gesture: None });
                    self.drafts.remove(&field);
                }
                Err(problem) => draft.problem = Some(problem),
            }
        }
        response
    }
}

/// The kind of target and the ball's size.
pub fn target_row(ui: &mut Ui, document: &Document, commands: &mut Vec<Command>) {
    let target = &document.session.target;
    let Some(present) = TargetKind::of(target) else {
        value_row(ui, words::TARGET, words::target(target));
        return;
    };
    split_row(ui, words::TARGET, |ui| {
        unit_column(ui);
        let choices = TargetKind::ALL.map(|kind| (kind.name(), kind));
        if let Some(kind) = choice(ui, words::TARGET, present, &choices) {
            commands.push(setup(SetupField::Target(kind.target())));
        }
    });
}

/// Where the sensor is.
pub fn mount_row(ui: &mut Ui, document: &Document, commands: &mut Vec<Command>) {
    split_row(ui, words::MOUNT, |ui| {
        unit_column(ui);
        let choices = MOUNTS.map(|mount| (words::mount(mount), mount));
        if let Some(mount) = choice(ui, words::MOUNT, document.session.mount, &choices) {
            commands.push(setup(SetupField::Mount(mount)));
        }
    });
}

const fn setup(field: SetupField) -> Command {
    Command::Edit { edit: Edit::Setup(field), gesture: None }
}

/// A list to choose from, named `name`; answers what was chosen, if it is another.
fn choice<T: Copy + PartialEq>(ui: &mut Ui, name: &str, present: T, choices: &[(&str, T)]) -> Option<T> {
    let mut chosen = present;
    let shown = choices.iter().find(|(_, value)| *value == present).map_or("", |(shown, _)| *shown);
    ui.spacing_mut().button_padding.y = 2.0;
    let width = (ui.available_width() * 0.5).min(TEXT_WIDTH - 44.0);
    let combo = ComboBox::from_id_salt(name).selected_text(shown).width(width).show_ui(ui, |ui| {
        for (shown, value) in choices {
            ui.selectable_value(&mut chosen, *value, *shown);
        }
    });
    combo.response.widget_info(|| WidgetInfo::labeled(Role::ComboBox, true, name));
    (chosen != present).then_some(chosen)
}

/// The room for units at the right of a row, so that all fields end at one line; fields are as high as rows.
fn unit_column(ui: &mut Ui) -> egui::Rect {
    ui.spacing_mut().item_spacing.x = 4.0;
    ui.spacing_mut().interact_size.y = theme::ROW_HEIGHT;
    ui.allocate_exact_size(vec2(UNIT_WIDTH, theme::ROW_HEIGHT), egui::Sense::hover()).0
}

/// Stable, so that the focus outlives another document's layout.
fn id_of(field: Field) -> Id {
    Id::unique(("session form", field))
}

fn name_field(response: &Response, field: Field, text: &str) {
    response.widget_info(|| {
        let mut info = WidgetInfo::text_edit(true, "", text, field.hint());
        info.label = Some(words::field_name(field.label(), field.unit()));
        info
    });
}

/// Why a text cannot stand in its field, right below it.
pub fn problem_line(ui: &mut Ui, problem: &str) {
    let color = theme::palette(ui).bad;
    ui.with_layout(Layout::right_to_left(Align::Min), |ui| {
        ui.add_space(UNIT_WIDTH + 4.0);
        ui.add(Label::new(egui::RichText::new(format!("✖ {problem}")).color(color).small()).wrap().halign(Align::Max));
    });
}
