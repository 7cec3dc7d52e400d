//! The bar at the top: menus, the document's title, convention and units, undo and redo.

use egui::{Align, Align2, Button, Layout, MenuBar, TextStyle, Ui, UiBuilder, containers::menu::MenuButton, vec2};

use crate::app::Workbench;
use crate::app::cell::PRACTICE_PARTS;
use crate::session::samples;
use crate::text::document::READ_ONLY;
use crate::text::start::sample_lesson;
use crate::text::{capture as capture_words, conventions, shell as words};

use super::actions::Action;
use super::persisted::{Persisted, ThemeChoice};
use super::rail::Step;
use super::{save_picture, theme, widgets};

/// Scales on offer.
const SCALES: [f32; 6] = [0.8, 0.9, 1.0, 1.25, 1.5, 2.0];

/// Draws the bar.
pub fn show(ui: &mut Ui, workbench: &Workbench, persisted: &mut Persisted, actions: &mut Vec<Action>) {
    let full = ui.max_rect();
    let child = |layout| UiBuilder::new().max_rect(full).layout(layout);
    let mut right_ui = ui.new_child(child(Layout::right_to_left(Align::Center)));
    let right = right_side(&mut right_ui, workbench, actions);
    let mut left_ui = ui.new_child(child(Layout::left_to_right(Align::Center)));
    left_ui.label(theme::strong(words::PROGRAM));
    left_ui.add_space(8.0);
    // The menu bar fills what it is given; it says itself where its last button ends.
    let left = MenuBar::new().ui(&mut left_ui, |ui| {
        menus(ui, workbench, persisted, actions);
        ui.cursor().left()
    });
    title(ui, workbench, full, left.inner..right);
}

fn menus(ui: &mut Ui, workbench: &Workbench, persisted: &mut Persisted, actions: &mut Vec<Action>) {
    MenuButton::new(words::FILE).ui(ui, |ui| {
        item(ui, workbench, Action::Open, actions);
        item(ui, workbench, Action::OpenSequence, actions);
        ui.menu_button(words::OPEN_SAMPLE, |ui| {
            for (idx, sample) in samples::ALL.iter().enumerate() {
                if ui.button(sample_lesson(sample.file_name).0).clicked() {
                    actions.push(Action::OpenSample(idx));
                    ui.close();
                }
            }
        });
        ui.separator();
        item(ui, workbench, Action::Import, actions);
        item(ui, workbench, Action::ImportFolder, actions);
        item(ui, workbench, Action::Paste, actions);
        item(ui, workbench, Action::AddSession, actions);
        ui.separator();
        item(ui, workbench, Action::Save, actions);
        item(ui, workbench, Action::SaveAs, actions);
        item(ui, workbench, Action::ExportPoses, actions);
        item(ui, workbench, Action::ExportProfiles, actions);
        save_picture::menu(ui);
        ui.separator();
        item(ui, workbench, Action::Close, actions);
        item(ui, workbench, Action::Quit, actions);
    });
    MenuButton::new(words::EDIT).ui(ui, |ui| {
        item(ui, workbench, Action::Undo, actions);
        item(ui, workbench, Action::Redo, actions);
        ui.separator();
        item(ui, workbench, Action::History, actions);
    });
    MenuButton::new(capture_words::MENU).ui(ui, |ui| {
        item(ui, workbench, Action::GoTo(Step::Capture), actions);
        ui.separator();
        for part in PRACTICE_PARTS {
            item(ui, workbench, Action::Practise(part), actions);
        }
        item(ui, workbench, Action::EndPractice, actions);
    });
    MenuButton::new(words::VIEW).ui(ui, |ui| {
        ui.label(theme::dim(ui, words::THEME));
        for (choice, name) in [
            (ThemeChoice::Light, words::LIGHT),
            (ThemeChoice::Dark, words::DARK),
            (ThemeChoice::System, words::FOLLOW_SYSTEM),
        ] {
            ui.radio_value(&mut persisted.theme, choice, name);
        }
        ui.separator();
        ui.label(theme::dim(ui, words::SCALE));
        for scale in SCALES {
            ui.radio_value(&mut persisted.scale, scale, format!("{:.0} %", scale * 100.0));
        }
        ui.separator();
        ui.checkbox(&mut persisted.inspector_open, words::INSPECTOR);
    });
    MenuButton::new(words::HELP).ui(ui, |ui| item(ui, workbench, Action::Help, actions));
}

fn item(ui: &mut Ui, workbench: &Workbench, action: Action, actions: &mut Vec<Action>) {
    let refusal = action.refusal(workbench);
    let mut button = Button::new(action.label(workbench));
    if let Some(shortcut) = action.shortcut() {
        button = button.shortcut_text(ui.ctx().format_shortcut(&shortcut));
    }
    let mut response = ui.add_enabled(refusal.is_none(), button);
    if let Some(reason) = refusal {
        response = response.on_disabled_hover_text(reason);
    }
    if response.clicked() {
        actions.push(action);
        ui.close();
    }
}

/// From right to left, as the layout runs; answers where it ends at the left.
fn right_side(ui: &mut Ui, workbench: &Workbench, actions: &mut Vec<Action>) -> f32 {
    for (action, name) in [(Action::Redo, words::REDO), (Action::Undo, words::UNDO)] {
        let refusal = action.refusal(workbench);
        let response = ui.add_enabled(refusal.is_none(), Button::new(name));
        let response = match refusal {
            Some(reason) => response.on_disabled_hover_text(reason),
            None => response.on_hover_text(action.label(workbench)),
        };
        if response.clicked() {
            actions.push(action);
        }
    }
    if let Some(document) = workbench.document() {
        let notation = &document.session.robot.notation;
        ui.add_space(8.0);
        widgets::chip(ui, &conventions::notation_units(notation), &conventions::notation_units_hint(notation));
        if let Some(frame) = conventions::notation_frame(notation) {
            ui.add_space(8.0);
            widgets::chip(ui, frame, conventions::notation_frame_hint(notation));
        }
        ui.add_space(8.0);
        widgets::chip(ui, conventions::notation_name(notation), &conventions::notation_hint(notation));
    }
    ui.cursor().right()
}

/// The document's title in the middle of the window, or as near to it as the room between menus and chips allows.
fn title(ui: &Ui, workbench: &Workbench, full: egui::Rect, free: std::ops::Range<f32>) {
    let palette = theme::palette(ui);
    let (text, color, is_unsaved) = match workbench.document() {
        Some(document) if document.is_read_only => {
            (words::title_with(&document.title(), READ_ONLY), palette.text, document.is_unsaved())
        }
        Some(document) => (document.title(), palette.text, document.is_unsaved()),
        None => (words::NO_TITLE.to_owned(), palette.text_dim, false),
    };
    let dot_room = if is_unsaved { 20.0 } else { 0.0 };
    let room = free.end - free.start - 32.0 - dot_room;
    if room < 40.0 {
        return;
    }
    let font = TextStyle::Body.resolve(ui.style());
    let job = egui::text::LayoutJob {
        wrap: egui::text::TextWrapping::truncate_at_width(room),
        ..egui::text::LayoutJob::simple_singleline(text, font, color)
    };
    let galley = ui.painter().layout_job(job);
    let half = f32::midpoint(galley.size().x, dot_room);
    let center_x = full.center().x.clamp(free.start + 16.0 + half, free.end - 16.0 - half);
    let left_center = egui::pos2(center_x - half, full.center().y);
    let rect = Align2::LEFT_CENTER.anchor_size(left_center, galley.size());
    let name = galley.text().to_owned();
    ui.painter().galley(rect.min, galley, color);
    let response = ui.interact(rect, ui.scope_id().with("title"), egui::Sense::hover());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, &name));
    if let Some(path) = workbench.document().and_then(|document| document.path.as_deref()) {
        response.on_hover_text(path.display().to_string());
    }
    if is_unsaved {
        let dot = rect.right_center() + vec2(12.0, 0.0);
        ui.painter().circle_filled(dot, 5.0, palette.warn);
        let dot_rect = egui::Rect::from_center_size(dot, vec2(16.0, 16.0));
        let response = ui.interact(dot_rect, ui.scope_id().with("unsaved"), egui::Sense::hover());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, words::UNSAVED));
        response.on_hover_text(words::UNSAVED);
    }
}
