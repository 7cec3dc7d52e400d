//! The row of tabs above the sections of a step.

use egui::{Align2, FontId, Rect, Role, Sense, Stroke, Ui, WidgetInfo, pos2, vec2};

use crate::ui::theme;

/// Height of the row, points: large enough for a gloved hand.
const TABS_HEIGHT: f32 = 38.0;
/// Room at either side of a tab's name, points.
const TAB_MARGIN: f32 = 14.0;
/// The same in a narrow window.
const LEAST_TAB_MARGIN: f32 = 4.0;
/// The accent below the tab in sight, points.
const UNDERLINE: f32 = 2.5;

/// Tabs by name and hint, and at their right a note on how the work stands. Answers the one that was clicked.
pub fn tabs(ui: &mut Ui, tabs: &[(&str, &str)], current_idx: usize, note: &str, is_warning: bool) -> Option<usize> {
    let palette = theme::palette(ui);
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), TABS_HEIGHT), Sense::hover());
    ui.painter().hline(rect.x_range(), rect.bottom() - 0.5, Stroke::new(1.0, palette.hairline));
    let mut chosen_idx = None;
    let mut left = rect.left();
    // As wide as in the heavier weight, so that nothing moves when another tab is chosen.
    let strong = |name: &str| ui.painter().layout_no_wrap(name.to_owned(), theme::strong_font(), palette.accent);
    let names: f32 = tabs.iter().map(|(name, _)| strong(name).size().x).sum();
    #[expect(clippy::cast_precision_loss, reason = "a handful of tabs")]
    let margin = ((rect.width() - names) / (2.0 * tabs.len() as f32)).clamp(LEAST_TAB_MARGIN, TAB_MARGIN);
    for (idx, (name, hint)) in tabs.iter().enumerate() {
        let is_current = idx == current_idx;
        let strong = strong(name);
        let tab =
            Rect::from_min_max(pos2(left, rect.top()), pos2(left + strong.size().x + 2.0 * margin, rect.bottom()));
        left = tab.right();
        let response = ui.interact(tab, ui.scope_id().with(name), Sense::click());
        response.widget_info(|| WidgetInfo::selected(Role::Tab, true, is_current, *name));
        let is_pointed_at = response.hovered() || response.has_focus();
        if is_pointed_at && !is_current {
            ui.painter().rect_filled(tab.shrink2(vec2(2.0, 4.0)), theme::RADIUS, palette.hovered);
        }
        let middle = tab.center();
        if is_current {
            ui.painter().galley(middle - strong.size() / 2.0, strong, palette.accent);
            let underline = tab.with_min_y(tab.bottom() - UNDERLINE).shrink2(vec2(margin - LEAST_TAB_MARGIN, 0.0));
            ui.painter().rect_filled(underline, 1.0, palette.accent);
        } else {
            let font = FontId::proportional(theme::BODY_SIZE);
            ui.painter().text(middle, Align2::CENTER_CENTER, *name, font, palette.text_dim);
        }
        if response.on_hover_text(*hint).clicked() {
            chosen_idx = Some(idx);
        }
    }
    if !note.is_empty() {
        let font = FontId::proportional(theme::SMALL_SIZE);
        let color = if is_warning { palette.warn } else { palette.text_dim };
        ui.painter().text(rect.right_center() - vec2(4.0, 0.0), Align2::RIGHT_CENTER, note, font, color);
    }
    chosen_idx
}
