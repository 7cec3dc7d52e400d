//! The list of conventions behind a button, with a search.

use egui::{Button, Frame, Popup, PopupCloseBehavior, Response, RichText, ScrollArea, TextEdit, Ui, WidgetInfo, vec2};

use crate::geometry::PoseNotation;
use crate::text::conventions as words;
use crate::ui::theme;

use super::model;

/// Width of the list, points.
const WIDTH: f32 = 400.0;
/// Height of the list, points.
const HEIGHT: f32 = 400.0;

/// What is searched for in the list.
#[derive(Clone, Debug, Default)]
pub struct Search {
    text: String,
    wants_focus: bool,
}

/// A button with the notation's name, cut where it would be wider than `max_width`; answers what is chosen from the list
/// below it. `row` names the button for a screen reader.
pub fn show(
    ui: &mut Ui,
    row: &str,
    max_width: f32,
    notation: &PoseNotation,
    with_quaternions: bool,
    search: &mut Search,
) -> Option<PoseNotation> {
    let name = words::notation_name(notation);
    let button = ui
        .scope(|ui| {
            ui.set_max_width(max_width);
            ui.add(Button::new(format!("{name} ▾")).truncate())
        })
        .inner;
    button.widget_info(|| WidgetInfo::labeled(egui::Role::ComboBox, ui.is_enabled(), words::choice_name(row, name)));
    if button.clicked() {
        *search = Search { text: String::new(), wants_focus: true };
    }
    let mut chosen = None;
    let list = Popup::from_toggle_button_response(&button)
        .close_behavior(PopupCloseBehavior::CloseOnClickOutside)
        .width(WIDTH)
        .frame(Frame::popup(ui.style()).inner_margin(8))
        .show(|ui| {
            let field = search_field(ui, search);
            ui.add_space(4.0);
            let entered = field.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
            ScrollArea::vertical().max_height(HEIGHT).auto_shrink([false, true]).show(ui, |ui| {
                ui.spacing_mut().item_spacing.y = 0.0;
                ui.spacing_mut().interact_size.y = theme::ROW_HEIGHT;
                ui.spacing_mut().button_padding = vec2(8.0, 2.0);
                let groups = model::choices(&search.text, with_quaternions);
                if groups.is_empty() {
                    ui.label(theme::dim(ui, words::NOTHING_FOUND));
                }
                for (group_idx, (group, choices)) in groups.iter().enumerate() {
                    ui.add_space(4.0);
                    ui.label(theme::strong(*group));
                    ui.add_space(2.0);
                    for (idx, choice) in choices.iter().enumerate() {
                        let is_first = group_idx == 0 && idx == 0;
                        if entry(ui, choice, notation).clicked() || (entered && is_first) {
                            chosen = Some(choice.applied_to(notation));
                        }
                    }
                    ui.add_space(8.0);
                }
            });
            if chosen.is_some() {
                ui.close();
            }
        });
    if let Some(list) = list {
        // A click that is pressed and let go within one frame brings the dialog up over its own list.
        ui.ctx().move_to_top(list.response.layer_id);
    }
    chosen
}

fn search_field(ui: &mut Ui, search: &mut Search) -> Response {
    let field = ui.add(TextEdit::singleline(&mut search.text).hint_text(words::SEARCH).desired_width(f32::INFINITY));
    field.widget_info(|| {
        let mut info = WidgetInfo::text_edit(true, "", search.text.as_str(), "");
        info.label = Some(words::SEARCH.to_owned());
        info
    });
    // Over a dialog a list that has just opened does not get the focus at once.
    search.wants_focus &= !field.has_focus();
    if search.wants_focus {
        field.request_focus();
        ui.ctx().request_repaint();
    }
    field
}

fn entry(ui: &mut Ui, choice: &model::Choice, notation: &PoseNotation) -> Response {
    let detail = RichText::new(&choice.detail).color(theme::palette(ui).text_dim).size(theme::SMALL_SIZE);
    let button = Button::selectable(choice.is_that_of(notation), choice.label).right_text(detail);
    let response = ui.add_sized([ui.available_width(), theme::ROW_HEIGHT], button);
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, choice.label));
    response
}
