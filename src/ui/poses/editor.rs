//! The field in which a cell is edited, and the list of choices that opens in its place where there are but a few.

use egui::text::{CCursor, CCursorRange};
use egui::text_edit::TextEditState;
use egui::{
    Align, Align2, Context, EventFilter, Frame, Id, Layout, Margin, Popup, PopupAnchor, Rect, Response, Stroke,
    StrokeKind, TextEdit, TextStyle, Ui, UiBuilder, vec2,
};

use crate::session::Place;
use crate::session::table::{self, Column};
use crate::text::poses as words;
use crate::ui::theme;

/// Left and right of the text in a cell, points.
pub const CELL_PADDING: i8 = 6;

/// A cell being edited.
#[derive(Clone, Debug)]
pub struct Editor {
    /// Its row.
    pub place: Place,
    /// Its column.
    pub column: Column,
    /// The text as it is typed.
    pub text: String,
    /// The text before.
    pub present: String,
    /// Whether it began with typing over the cell: the arrow keys then leave it.
    pub is_replacing: bool,
    /// Whether it was not drawn yet.
    pub is_new: bool,
    /// The revision of the document that it was opened on.
    pub revision: u64,
    /// Tells it from those before, as egui keeps the caret by the name.
    pub number: u64,
}

impl Editor {
    fn id(&self) -> Id {
        Id::unique("pose cell editor").with(self.number)
    }

    /// Draws the field in the cell's own rectangle, in its font and alignment.
    pub fn show(&mut self, ui: &mut Ui, rect: Rect, label_id: Id) -> Response {
        let palette = theme::palette(ui);
        ui.painter().rect_filled(rect, 0.0, palette.surface);
        let id = self.id();
        if self.is_new {
            self.is_new = false;
            let mut state = TextEditState::default();
            let end = CCursor::new(self.text.chars().count());
            state.cursor.set_char_range(Some(CCursorRange::one(end)));
            state.store(ui.ctx(), id);
            ui.memory_mut(|memory| memory.request_focus(id));
        }
        let is_number = self.column.is_number();
        let font = if is_number { theme::number_font() } else { TextStyle::Body.resolve(ui.style()) };
        let keys = EventFilter { tab: true, horizontal_arrows: true, vertical_arrows: true, escape: true };
        let field = TextEdit::singleline(&mut self.text)
            .id(id)
            .frame(Frame::NONE.inner_margin(Margin::symmetric(CELL_PADDING, 0)))
            .font(font)
            .align(if is_number { Align2::RIGHT_CENTER } else { Align2::LEFT_CENTER })
            .desired_width(rect.width())
            .min_size(vec2(rect.width(), 0.0))
            .event_filter(keys);
        // In the line of the cell's own text, to the point.
        let mut inside = ui.new_child(UiBuilder::new().max_rect(rect).layout(Layout::left_to_right(Align::Center)));
        inside.spacing_mut().interact_size.y = 0.0;
        let response = inside.add(field).labelled_by(label_id);
        ui.painter().rect_stroke(rect, 0.0, Stroke::new(2.0, palette.accent), StrokeKind::Inside);
        response
    }
}

/// An open list of choices.
#[derive(Clone, Debug)]
pub struct Choice {
    /// The cell's row.
    pub place: Place,
    /// The cell's column.
    pub column: Column,
    /// The entry that Enter takes.
    pub picked: usize,
    /// The revision of the document that it was opened on.
    pub revision: u64,
}

/// What a list of choices was answered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChoiceAnswer {
    /// Nothing yet.
    Open,
    /// The picked entry.
    Taken,
    /// Nothing; a click went elsewhere.
    Closed,
}

impl Choice {
    /// The next entry, or the one before.
    pub fn step(&mut self, by: isize) {
        let last = table::choices(self.column).len().saturating_sub(1);
        self.picked = self.picked.saturating_add_signed(by).min(last);
    }

    /// Draws the list below its cell.
    pub fn show(&mut self, ctx: &Context, anchor: Rect, layer: egui::LayerId) -> ChoiceAnswer {
        let mut is_open = true;
        let mut answer = ChoiceAnswer::Open;
        Popup::new(Id::unique("pose cell choices"), ctx.clone(), PopupAnchor::ParentRect(anchor), layer)
            .open_bool(&mut is_open)
            .gap(0.0)
            .width(anchor.width().max(64.0))
            .show(|ui| {
                ui.spacing_mut().item_spacing.y = 0.0;
                for (idx, choice) in table::choices(self.column).iter().enumerate() {
                    let text = words::choice(choice);
                    if ui.selectable_label(idx == self.picked, text).clicked() {
                        self.picked = idx;
                        answer = ChoiceAnswer::Taken;
                    }
                }
            });
        if is_open || answer == ChoiceAnswer::Taken { answer } else { ChoiceAnswer::Closed }
    }
}
