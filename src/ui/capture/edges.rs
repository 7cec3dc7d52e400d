//! Of a plate: which edge the line is on, how many captures each edge has, and what is still needed. Of a tip the same by its
//! poses. It stands where a ball has its search.

use egui::{
    Align, Align2, CornerRadius, FontId, Key, Layout, Modifiers, Role, Sense, Stroke, StrokeKind, Ui, UiBuilder,
    WidgetInfo, pos2, vec2,
};

use crate::app::cell::CellCommand;
use crate::session::Edge;
use crate::text::capture_edges as words;
use crate::text::edges::edge_name;
use crate::ui::arcs::{model, spread};
use crate::ui::theme;
use crate::ui::widgets::{card_with_height, nothing};

use super::fields::{hint, tall_button};
use super::model::{FEWEST_ON_EDGE, FEWEST_TIPS, View, refusal};
use super::panel::Desk;

/// Height of the card, points: that of the search's.
const HEIGHT: f32 = super::machine::HEIGHT;
/// Height and width of an edge's box, points.
const BOX_SIZE: egui::Vec2 = vec2(196.0, 48.0);

/// Width from which the pendant's buttons have room for a label, points.
const LEAST_FOR_LABEL: f32 = 250.0;

/// Shows the card.
pub fn show(ui: &mut Ui, desk: &mut Desk<'_>) {
    let is_plate = desk.view.is_plate();
    let title = if is_plate { words::EDGES } else { words::TIP };
    card_with_height(
        ui,
        title,
        HEIGHT,
        |_| {},
        |ui| {
            let inner = ui.available_rect_before_wrap().shrink2(vec2(theme::GAP, 10.0));
            let mut inside = ui.new_child(UiBuilder::new().max_rect(inner).layout(Layout::top_down(Align::Min)));
            inside.spacing_mut().item_spacing = vec2(8.0, 6.0);
            inside.horizontal(|ui| {
                if is_plate {
                    edge_boxes(ui, desk);
                    pendant(ui, desk);
                } else {
                    let count = desk.view.num_on(None);
                    ui.label(theme::heading(words::count(count, FEWEST_TIPS)));
                }
            });
            hint(&mut inside, &still_needed(&desk.view));
            ui.advance_cursor_after_rect(inner);
        },
    );
}

/// What is still needed, in a sentence.
fn still_needed(view: &View<'_>) -> String {
    if view.is_plate() {
        let missing = [Edge::P, Edge::Q].map(|edge| FEWEST_ON_EDGE.saturating_sub(view.num_on(Some(edge))));
        words::needed_on_edges(missing)
    } else {
        words::needed_of_tip(FEWEST_TIPS.saturating_sub(view.num_on(None)))
    }
}

/// One box an edge, that chooses it.
fn edge_boxes(ui: &mut Ui, desk: &mut Desk<'_>) {
    let is_free = !desk.view.cell.is_busy();
    let mut settings = desk.view.cell.settings;
    for edge in [Edge::P, Edge::Q] {
        let key = if edge == Edge::P { Key::P } else { Key::Q };
        let is_typing = ui.ctx().text_edit_focused();
        let is_pressed = !is_typing && ui.input_mut(|input| input.consume_key(Modifiers::NONE, key));
        let count = desk.view.num_on(Some(edge));
        let is_chosen = settings.edge == edge;
        if (edge_box(ui, edge, count, is_chosen, is_free) || is_pressed) && is_free {
            settings.edge = edge;
        }
    }
    desk.set(&settings);
}

fn edge_box(ui: &mut Ui, edge: Edge, count: usize, is_chosen: bool, is_free: bool) -> bool {
    let (rect, response) = ui.allocate_exact_size(BOX_SIZE, Sense::click());
    let name = words::choose(edge_name(edge), count);
    response.widget_info(|| WidgetInfo::selected(Role::RadioButton, is_free, is_chosen, &name));
    let palette = theme::palette(ui);
    let is_hot = is_free && (response.hovered() || response.has_focus());
    let (fill, border) = match (is_chosen, is_hot) {
        (true, _) => (palette.selected, palette.accent),
        (false, true) => (palette.hovered, palette.accent),
        (false, false) => (palette.surface, palette.hairline),
    };
    let painter = ui.painter();
    let stroke = Stroke::new(if is_chosen { 2.0 } else { 1.0 }, border);
    painter.rect(rect, CornerRadius::same(theme::RADIUS), fill, stroke, StrokeKind::Inside);
    let left = rect.left() + 14.0;
    let mark = pos2(left + 5.0, rect.center().y);
    painter.circle_stroke(mark, 6.0, Stroke::new(1.5, if is_chosen { palette.accent } else { palette.text_dim }));
    if is_chosen {
        painter.circle_filled(mark, 3.0, palette.accent);
    }
    let text = left + 24.0;
    let at = |y: f32| pos2(text, rect.center().y + y);
    let title = words::line_on(edge_name(edge), is_chosen);
    painter.text(at(-9.0), Align2::LEFT_CENTER, title, theme::strong_font(), palette.text);
    let font = FontId::proportional(theme::SMALL_SIZE);
    let (told, color) = if count >= FEWEST_ON_EDGE {
        (format!("✔ {}", words::count(count, FEWEST_ON_EDGE)), palette.good)
    } else {
        (words::count(count, FEWEST_ON_EDGE), palette.text_dim)
    };
    painter.text(at(9.0), Align2::LEFT_CENTER, told, font, color);
    response.on_hover_text(words::CHOOSE_HINT).clicked()
}

/// The simulated robot has a pendant of its own.
fn pendant(ui: &mut Ui, desk: &mut Desk<'_>) {
    if !desk.view.cell.is_practice {
        return;
    }
    ui.add_space(12.0);
    // In a narrow window the buttons' hints say whose they are.
    if ui.available_width() >= LEAST_FOR_LABEL {
        ui.label(theme::dim(ui, words::PENDANT));
    }
    for edge in [Edge::P, Edge::Q] {
        let command = CellCommand::JogToEdge(edge);
        let name = words::jog_to(edge);
        let reason = refusal(&desk.view, &command);
        if tall_button(ui, words::jog_button(edge), name, words::PENDANT_HINT, reason) {
            desk.ask(command);
        }
    }
}

/// Where in the laser plane the captures have their points.
pub fn spread(ui: &mut Ui, height: f32, desk: &mut Desk<'_>) {
    let Some(session) = desk.view.session else {
        return nothing(ui, words::NO_POINTS);
    };
    let rows = model::station_rows(session, desk.view.results);
    // Nothing else in this panel follows what is clicked here.
    let mut selection = crate::ui::Selection { station_idx: usize::MAX, ..crate::ui::Selection::default() };
    spread::card(ui, height, &session.target, &rows, &mut selection, &mut desk.state.is_curve_fitted);
}
