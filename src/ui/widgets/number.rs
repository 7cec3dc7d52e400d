//! Numbers: tabular figures, fixed decimals, the true minus sign, right-aligned.

use egui::{Align, Layout, Response, RichText, Ui};

use crate::ui::theme;

/// `value` with a fixed number of decimals and the true minus sign; a dash where there is no finite value.
#[must_use]
pub fn fixed(value: f64, decimals: usize) -> String {
    if !value.is_finite() {
        return "–".to_owned();
    }
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        // "-0.00" is nothing but rounding.
        Some(digits) if digits.bytes().all(|byte| matches!(byte, b'0' | b'.')) => digits.to_owned(),
        Some(digits) => format!("−{digits}"),
        None => text,
    }
}

/// As [`fixed`], with a plus sign before positive values, for differences.
#[must_use]
pub fn signed(value: f64, decimals: usize) -> String {
    let text = fixed(value, decimals);
    if text.starts_with(['−', '–']) { text } else { format!("+{text}") }
}

/// `text` in tabular figures.
pub fn number_text(text: impl Into<String>) -> RichText {
    RichText::new(text).font(theme::number_font())
}

/// A right-aligned label in tabular figures that fills the width available, with a small margin at its right.
pub fn number(ui: &mut Ui, text: impl Into<String>) -> Response {
    ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
        ui.add_space(4.0);
        ui.label(number_text(text))
    })
    .inner
}

/// A row of a list of figures: a dim label at the left, the value in tabular figures at the right.
pub fn value_row(ui: &mut Ui, label: &str, value: impl Into<String>) -> Response {
    ui.horizontal(|ui| {
        ui.set_min_height(theme::ROW_HEIGHT);
        ui.label(theme::dim(ui, label));
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| ui.label(number_text(value))).inner
    })
    .inner
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_carry_a_true_minus_and_no_negative_zero() {
        assert_eq!(fixed(-1.25, 1), "−1.2");
        assert_eq!(fixed(-0.0004, 3), "0.000");
        assert_eq!(fixed(f64::NAN, 3), "–");
        assert_eq!(signed(0.5, 2), "+0.50");
        assert_eq!(signed(-0.5, 2), "−0.50");
    }
}
