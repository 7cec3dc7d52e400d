//! Cells of the comparison's tables: aligned on the decimal point, tinted by the size of the error, named for screen
//! readers, all digits on hover.

use egui::{Align2, Color32, FontId, Rect, Role, Sense, Stroke, Ui, WidgetInfo, pos2, vec2};

use crate::text::compare as text;
use crate::text::typeset::all_digits;
use crate::ui::{theme, widgets};

/// Upper ends of the classes of errors, mm; beyond the last is the strongest tint. The same in every table, so that
/// equal tints are equal errors.
pub const TINT_STEPS_MM: [f64; 4] = [0.05, 0.1, 0.2, 0.5];
/// Opacity of the tint of each class.
const TINT_OPACITY: [f32; 5] = [0.0, 0.12, 0.26, 0.42, 0.62];
/// Ground of errors: a tint of the warning's hue, told apart by the number itself as well.
const TINT: Color32 = Color32::from_rgb(0xe0, 0x8a, 0x1e);

/// The tint of a class of errors.
pub fn class_tint(class: usize) -> Color32 {
    TINT.gamma_multiply(TINT_OPACITY[class.min(TINT_OPACITY.len() - 1)])
}

/// The tint of an error.
pub fn tint(error_mm: f64) -> Color32 {
    class_tint(TINT_STEPS_MM.iter().filter(|step| error_mm.abs() >= **step).count())
}

/// A row whose cells are filled from left to right.
pub struct RowCells<'u> {
    ui: &'u mut Ui,
    rect: Rect,
    left: f32,
    color: Color32,
}

/// The right margin of a number in its cell.
const CELL_MARGIN: f32 = 6.0;

impl<'u> RowCells<'u> {
    /// A row of `height` as wide as the space available, with a hairline below.
    pub fn new(ui: &'u mut Ui, height: f32) -> Self {
        let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), height), Sense::hover());
        let palette = theme::palette(ui);
        ui.painter().hline(rect.x_range(), rect.bottom(), Stroke::new(1.0, palette.hairline));
        Self { left: rect.left(), rect, color: palette.text, ui }
    }

    /// Faded, for stations that take no part.
    pub fn faded(mut self) -> Self {
        self.color = theme::palette(self.ui).text_dim.gamma_multiply(0.8);
        self
    }

    /// The whole row.
    pub const fn rect(&self) -> Rect {
        self.rect
    }

    /// The `Ui` of the row, for widgets put into a cell.
    pub fn ui(&mut self) -> &mut Ui {
        self.ui
    }

    /// The next cell's rectangle.
    pub fn next(&mut self, width: f32) -> Rect {
        let cell = Rect::from_min_max(pos2(self.left, self.rect.top()), pos2(self.left + width, self.rect.bottom()));
        self.left += width;
        cell
    }

    /// A dim head, centred over its columns.
    pub fn head(&mut self, width: f32, text: &str, align: Align2) {
        let cell = self.next(width).shrink2(vec2(CELL_MARGIN, 0.0));
        let color = theme::palette(self.ui).text_dim;
        let at = align.pos_in_rect(&cell);
        let painter = self.ui.painter().with_clip_rect(cell.expand(CELL_MARGIN).intersect(self.ui.clip_rect()));
        painter.text(at, align, text, FontId::proportional(theme::SMALL_SIZE), color);
    }

    /// Text at the left.
    pub fn text(&mut self, width: f32, text: &str) {
        let cell = self.next(width).shrink2(vec2(CELL_MARGIN, 0.0));
        let painter = self.ui.painter().with_clip_rect(cell.intersect(self.ui.clip_rect()));
        painter.text(cell.left_center(), Align2::LEFT_CENTER, text, FontId::proportional(theme::BODY_SIZE), self.color);
        self.name(cell, text, None);
    }

    /// A number in tabular figures, with all its digits on hover.
    pub fn number(&mut self, width: f32, value: f64, text: &str, ground: Color32) {
        let cell = self.next(width);
        self.ui.painter().rect_filled(cell.shrink2(vec2(0.0, 0.5)), 0.0, ground);
        let at = cell.right_center() - vec2(CELL_MARGIN, 0.0);
        self.ui.painter().text(at, Align2::RIGHT_CENTER, text, theme::number_font(), self.color);
        self.name(cell, text, Some(&format!("{} mm", all_digits(value))));
    }

    /// A right-aligned word in a column of numbers.
    pub fn word(&mut self, width: f32, text: &str, color: Color32) {
        let cell = self.next(width);
        let at = cell.right_center() - vec2(CELL_MARGIN, 0.0);
        self.ui.painter().text(at, Align2::RIGHT_CENTER, text, theme::number_font(), color);
        self.name(cell, text, None);
    }

    /// A number that is wrong, with the reason on hover.
    pub fn flagged(&mut self, width: f32, text: &str, reason: &str) {
        let cell = self.next(width);
        let color = theme::palette(self.ui).bad;
        let at = cell.right_center() - vec2(CELL_MARGIN, 0.0);
        self.ui.painter().text(at, Align2::RIGHT_CENTER, text, theme::number_font(), color);
        self.name(cell, text, Some(reason));
    }

    /// Names a cell for screen readers; `hover` shows under the pointer.
    pub fn name(&self, cell: Rect, text: &str, hover: Option<&str>) {
        let id = self.ui.scope_id().with(("cell", cell.min.x.to_bits(), cell.min.y.to_bits()));
        let response = self.ui.interact(cell, id, Sense::hover());
        response.widget_info(|| WidgetInfo::labeled(Role::Label, true, text));
        if let Some(hover) = hover {
            response.on_hover_text(hover);
        }
    }
}

/// Coordinates with three decimals.
pub fn coordinate(value_mm: f64) -> String {
    widgets::fixed(value_mm, 3)
}

/// The legend of the tints: one piece, so that a line never breaks inside it.
pub fn tint_legend(ui: &mut Ui) {
    /// Size of the ground of one class.
    const CLASS_SIZE: egui::Vec2 = vec2(28.0, 18.0);
    let color = theme::palette(ui).text_dim;
    let words = |ui: &Ui, text: &str| {
        ui.painter().layout_no_wrap(text.to_owned(), FontId::proportional(theme::SMALL_SIZE), color)
    };
    let (title, unit) = (words(ui, text::TINT_LEGEND), words(ui, text::TINT_UNIT));
    let classes: Vec<_> = TINT_STEPS_MM.iter().map(|step_mm| words(ui, &step_mm.to_string())).collect();
    let width = title.size().x + unit.size().x + 8.0 + TINT_STEPS_MM.iter().map(|_| CLASS_SIZE.x + 2.0).sum::<f32>();
    let (rect, response) = ui.allocate_exact_size(vec2(width, CLASS_SIZE.y), Sense::hover());
    response.widget_info(|| {
        let steps = TINT_STEPS_MM.map(|step_mm| step_mm.to_string()).join(", ");
        WidgetInfo::labeled(Role::Label, true, format!("{} {steps} {}", text::TINT_LEGEND, text::TINT_UNIT))
    });
    let centred = |galley: &egui::Galley| rect.center().y - galley.size().y / 2.0;
    let mut left = rect.left();
    ui.painter().galley(pos2(left, centred(&title)), title.clone(), color);
    left += title.size().x + 4.0;
    for (class, galley) in classes.into_iter().enumerate() {
        let ground = Rect::from_min_size(pos2(left, rect.top()), CLASS_SIZE);
        ui.painter().rect_filled(ground, 2.0, class_tint(class + 1));
        ui.painter().galley(ground.center() - galley.size() / 2.0, galley, color);
        left += CLASS_SIZE.x + 2.0;
    }
    ui.painter().galley(pos2(left + 2.0, centred(&unit)), unit, color);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn larger_errors_have_stronger_tints_whatever_their_sign() {
        let tints = [0.01, -0.06, 0.15, -0.3, 7.0].map(|error| tint(error).a());
        assert!(tints.windows(2).all(|pair| pair[0] < pair[1]), "{tints:?}");
        assert_eq!(tint(0.211), tint(-0.211));
    }
}
