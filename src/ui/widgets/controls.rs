//! Small controls whose visible text is shorter than the name that a screen reader needs.

use egui::{Align, Button, Layout, Response, RichText, Role, ScrollArea, Ui, UiBuilder, WidgetInfo};

use crate::ui::theme;

/// A checkbox without visible text, named `name`.
pub fn named_checkbox(ui: &mut Ui, checked: &mut bool, name: &str) -> Response {
    let response = ui.checkbox(checked, "");
    let is_checked = *checked;
    response.widget_info(|| WidgetInfo::selected(Role::CheckBox, ui.is_enabled(), is_checked, name));
    response
}

/// A button without frame that shows a symbol, named `name`.
pub fn symbol_button(ui: &mut Ui, symbol: &str, name: &str) -> Response {
    let text = RichText::new(symbol).color(theme::palette(ui).text_dim);
    let response = ui.add(Button::new(text).frame(false));
    response.widget_info(|| WidgetInfo::labeled(Role::Button, ui.is_enabled(), name));
    response
}

/// Names a text field for screen readers.
pub fn name_field(field: &Response, name: &str, text: &str) {
    field.widget_info(|| {
        let mut info = WidgetInfo::text_edit(true, "", text, "");
        info.label = Some(name.to_owned());
        info
    });
}

/// The button of the next action, in the accent colour. At most one is in sight.
pub fn primary_button(ui: &mut Ui, text: &str) -> Response {
    let palette = theme::palette(ui);
    ui.add(Button::new(theme::strong(text).color(palette.on_accent)).fill(palette.accent).stroke((0.0, palette.accent)))
}

/// One sentence in the middle of the space available, where there is nothing else to show.
pub fn nothing(ui: &mut Ui, sentence: &str) {
    let area = ui.available_rect_before_wrap();
    let mut inside =
        ui.new_child(UiBuilder::new().max_rect(area.shrink(theme::GAP)).layout(Layout::top_down(Align::Center)));
    inside.add_space((area.height() * 0.4 - theme::GAP).max(0.0));
    let words = theme::dim(&inside, sentence);
    inside.label(words);
    ui.advance_cursor_after_rect(area);
}

/// Makes a scroll area begin at its top; new with every document, as egui keeps the place of the one before.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FromTop {
    is_done: bool,
}

impl FromTop {
    /// The scroll area, at its top if it is shown for the first time.
    pub fn apply(&mut self, area: ScrollArea) -> ScrollArea {
        if std::mem::replace(&mut self.is_done, true) { area } else { area.vertical_scroll_offset(0.0) }
    }
}
