//! The ways to read the poses as bars on a logarithmic scale, each with its name, what it ties with, and a button.

use egui::{
    Align, Align2, FontId, Label, Layout, Rect, Role, ScrollArea, Sense, Stroke, Ui, UiBuilder, WidgetInfo, vec2,
};

use crate::app::Command;
use crate::diagnose::{ReadingFit, Remedy};
use crate::text::diagnosis::pose_reading;
use crate::text::diagnosis_panel as words;
use crate::text::typeset::std_text;
use crate::ui::{PanelContext, theme};

/// Height of a way, points: its name, and below it what it ties with and its bar.
const ROW_HEIGHT: f32 = 40.0;
/// Room for a way's button, points.
const BUTTON_WIDTH: f32 = 76.0;
/// Room for its residual, points.
const FIGURE_WIDTH: f32 = 68.0;
/// Part of the width that its name takes.
const NAME_PART: f32 = 0.50;
/// Height of a bar, points.
const BAR_HEIGHT: f32 = 12.0;

/// Decades from a little below the least residual to the greatest.
struct Scale {
    low: f64,
    high: f64,
}

impl Scale {
    fn of(fits: &[ReadingFit]) -> Self {
        let logs = || fits.iter().map(|fit| fit.rms_mm.max(1e-6).log10()).filter(|log| log.is_finite());
        let low = logs().fold(f64::INFINITY, f64::min);
        let high = logs().fold(f64::NEG_INFINITY, f64::max);
        // No way leaves anything to compare.
        let low = if low.is_finite() { low } else { 0.0 };
        // The least bar keeps a length, too.
        Self { low: (low - 0.3).floor(), high: high.max(low + 0.5) }
    }

    #[expect(clippy::cast_possible_truncation, reason = "a part of a screen's width")]
    fn part(&self, rms_mm: f64) -> f32 {
        ((rms_mm.max(1e-6).log10() - self.low) / (self.high - self.low)).clamp(0.0, 1.0) as f32
    }

    /// The decades within.
    fn decades(&self) -> impl Iterator<Item = f64> {
        let (first, last) = (self.low.ceil(), self.high.floor());
        (0..20).map(move |step| first + f64::from(step)).take_while(move |decade| *decade <= last)
    }
}

/// Shows the ways in the space available, best first; `is_current` lets their buttons act.
pub fn show(ui: &mut Ui, fits: &[ReadingFit], is_current: bool, context: &mut PanelContext<'_>) {
    let scale = Scale::of(fits);
    ScrollArea::vertical().id_salt("readings").auto_shrink([false, false]).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        for (idx, fit) in fits.iter().enumerate() {
            way(ui, idx, fit, &scale, is_current, context);
        }
    });
}

fn way(ui: &mut Ui, idx: usize, fit: &ReadingFit, scale: &Scale, is_current: bool, context: &mut PanelContext<'_>) {
    let palette = theme::palette(ui);
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), ROW_HEIGHT), Sense::hover());
    ui.painter().hline(rect.x_range(), rect.bottom(), Stroke::new(1.0, palette.hairline));
    let inner = rect.shrink2(vec2(theme::GAP, 2.0));
    let (names, rest) = inner.split_left_right_at_fraction(NAME_PART);
    let (chart, rest) = rest.split_left_right_at_x(inner.right() - BUTTON_WIDTH - FIGURE_WIDTH);
    let (figure, button) = rest.split_left_right_at_x(inner.right() - BUTTON_WIDTH);
    let name = pose_reading(&fit.reading);
    name_and_ties(ui, names, fit, &name);

    let chart = chart.shrink2(vec2(8.0, 0.0));
    for decade in scale.decades() {
        let x = chart.left() + scale.part(10.0_f64.powf(decade)) * chart.width();
        ui.painter().vline(x, rect.y_range(), Stroke::new(1.0, palette.hairline));
    }
    let end = chart.left() + (scale.part(fit.rms_mm) * chart.width()).max(2.0);
    let heights = chart.center().y - BAR_HEIGHT / 2.0..=chart.center().y + BAR_HEIGHT / 2.0;
    let bar = Rect::from_x_y_ranges(chart.left()..=end, heights);
    // The session as it is stands hollow among the others.
    if fit.is_as_given {
        ui.painter().rect_stroke(bar, 1.0, Stroke::new(1.5, palette.warn), egui::StrokeKind::Inside);
    } else {
        ui.painter().rect_filled(bar, 1.0, theme::INLIER.gamma_multiply(if idx == 0 { 1.0 } else { 0.6 }));
    }
    let at = figure.right_center() - vec2(4.0, 0.0);
    ui.painter().text(at, Align2::RIGHT_CENTER, std_text(fit.rms_mm), theme::number_font(), palette.text);

    if fit.is_as_given {
        let font = FontId::proportional(theme::SMALL_SIZE);
        ui.painter().text(button.center(), Align2::CENTER_CENTER, words::AS_GIVEN, font, palette.text_dim);
        return;
    }
    let centred = Layout::right_to_left(Align::Center);
    let mut inside = ui.new_child(UiBuilder::new().id_salt(("way", idx)).max_rect(button).layout(centred));
    inside.spacing_mut().button_padding.x = 8.0;
    inside.spacing_mut().interact_size.y = 24.0;
    let button = inside.add_enabled(is_current, egui::Button::new(words::READ_SO));
    button.widget_info(|| WidgetInfo::labeled(Role::Button, is_current, words::read_poses_as(&name)));
    if button.clicked() {
        context.commands.push(Command::ApplyRemedy(Remedy::ReadPosesAs(fit.reading.clone())));
    }
}

fn name_and_ties(ui: &mut Ui, place: Rect, fit: &ReadingFit, name: &str) {
    let mut inside = ui.new_child(UiBuilder::new().max_rect(place).layout(Layout::top_down(Align::Min)));
    inside.spacing_mut().item_spacing.y = 0.0;
    if fit.ties.is_empty() {
        inside.add_space((place.height() - 17.0) / 2.0);
    }
    inside.add(Label::new(name).truncate()).on_hover_text(name);
    if !fit.ties.is_empty() {
        let ties = words::same_as(&fit.ties.iter().map(pose_reading).collect::<Vec<_>>().join(", "));
        let label = Label::new(theme::dim(&inside, &ties).small()).truncate();
        inside.add(label).on_hover_text(&ties);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::PoseReading;

    #[test]
    fn every_way_has_a_bar_within_the_scale() {
        let fit =
            |rms_mm: f64| ReadingFit { reading: PoseReading::default(), ties: Vec::new(), rms_mm, is_as_given: false };
        let scale = Scale::of(&[fit(0.018), fit(3.0), fit(0.0), fit(f64::INFINITY)]);
        let parts = [0.0, 0.018, 3.0, f64::INFINITY].map(|rms_mm| scale.part(rms_mm));
        assert!(parts.windows(2).all(|pair| pair[0] <= pair[1]) && parts[0] > 0.0 && parts[3] <= 1.0, "{parts:?}");
        assert!(scale.decades().count() >= 6);
    }
}
