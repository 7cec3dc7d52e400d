//! How well a point in the workspace is known: figures, its ellipse, and a second opinion by bootstrap.

use egui::{
    Align2, Button, FontId, Frame, Margin, Rect, RichText, Role, Sense, Stroke, StrokeKind, Ui, WidgetInfo, pos2, vec2,
};

use crate::app::Command;
use crate::calibrate::validation::Bootstrap;
use crate::calibrate::{Method, Solution, Uncertainty};
use crate::geometry::Mat3;
use crate::text::diagnosis as fault_words;
use crate::text::diagnosis_panel as words;
use crate::text::typeset::{all_digits, std_text};
use crate::ui::save_picture::saveable;
use crate::ui::widgets::{fixed, number_text, split_row, value_row};
use crate::ui::{charts, theme, widgets};

use super::model::View;

/// Draws of a bootstrap: enough to know its σ to 3 %.
const NUM_DRAWS: usize = 500;
/// A radius is easily off by this, mm.
const RADIUS_STEP_MM: f64 = 0.1;
/// Up to this ratio, either way, the bootstrap agrees with the stated σ: it is itself no better with few stations.
const AGREES_WITHIN: f64 = 1.5;
/// Rows of figures below the ellipses.
const FIGURE_ROWS: f32 = 4.0;

/// Shows the card.
pub fn show(ui: &mut Ui, height: f32, view: &View<'_>, commands: &mut Vec<Command>) {
    let uncertainty = view.solution().and_then(|solution| solution.uncertainty.as_ref());
    let right = |ui: &mut Ui| {
        ui.spacing_mut().interact_size.y = 22.0;
        ui.spacing_mut().button_padding = vec2(8.0, 2.0);
        if let Some(progress) = view.bootstrap.progress {
            let button = ui.button(words::CANCEL);
            button.widget_info(|| WidgetInfo::labeled(Role::Button, true, words::CANCEL_BOOTSTRAP));
            if button.clicked() {
                commands.push(Command::CancelBootstrap);
            }
            ui.label(theme::dim(ui, words::bootstrap_progress(progress.done, progress.total)));
        } else {
            let is_possible = uncertainty.is_some() && view.results_are_current;
            let button = ui.add_enabled(is_possible, Button::new(words::bootstrap_button(NUM_DRAWS)));
            if button.on_hover_text(words::BOOTSTRAP_HINT).clicked() {
                commands.push(Command::StartBootstrap { num_draws: NUM_DRAWS });
            }
        }
    };
    widgets::card_with_height(ui, words::ACCURACY, height, right, |ui| match (view.solution(), uncertainty) {
        (Some(solution), Some(uncertainty)) => contents(ui, view, solution, uncertainty),
        (Some(_), None) => widgets::nothing(ui, words::NO_UNCERTAINTY),
        (None, _) => widgets::nothing(ui, words::NO_SOLUTION),
    });
}

fn contents(ui: &mut Ui, view: &View<'_>, solution: &Solution, uncertainty: &Uncertainty) {
    Frame::new().inner_margin(Margin { left: 12, right: 12, top: 8, bottom: 4 }).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        let height = ui.available_height() - FIGURE_ROWS * theme::ROW_HEIGHT;
        saveable(ui, words::ACCURACY, |ui| ellipses(ui, height, uncertainty));
        figures(ui, view, solution, uncertainty);
    });
}

fn figures(ui: &mut Ui, view: &View<'_>, solution: &Solution, uncertainty: &Uncertainty) {
    let std_mm = uncertainty.workspace_point_std_mm;
    let within_mm = uncertainty.workspace_point_95_mm;
    split_row(ui, &words::point_at(&fixed(uncertainty.reference_point_in_sensor_mm.z, 0)), |ui| {
        let within = words::within_95(&std_text(within_mm));
        ui.label(theme::dim(ui, within)).on_hover_text(all_digits(within_mm));
        ui.label(theme::strong(format!("± {} mm", std_text(std_mm)))).on_hover_text(all_digits(std_mm));
    });
    let (weakest, weakest_mm) = uncertainty.weakest_direction();
    let weakest = fault_words::along(weakest, solution.mount);
    value_row(ui, &words::weakest(&weakest), format!("± {} mm", std_text(weakest_mm))).on_hover_text(&weakest);
    if Method::BALL.contains(&solution.method) {
        let moved_mm = solution.workspace_point_by_radius.norm() * RADIUS_STEP_MM;
        value_row(ui, &words::by_radius(&RADIUS_STEP_MM.to_string()), format!("{} mm", std_text(moved_mm)))
            .on_hover_text(words::BY_RADIUS_HINT);
    }
    bootstrap_row(ui, view, std_mm);
}

fn bootstrap_row(ui: &mut Ui, view: &View<'_>, stated_mm: f64) {
    let Some(bootstrap) = view.bootstrap.value else {
        value_row(ui, words::BOOTSTRAP_ROW, words::NOT_YET).on_hover_text(words::BOOTSTRAP_HINT);
        return;
    };
    let Bootstrap { distances_mm, std_mm, within_95_mm, num_failed } = bootstrap;
    let details = words::bootstrap_details(distances_mm.len() + num_failed, *num_failed, &std_text(*within_95_mm));
    split_row(ui, words::BOOTSTRAP_ROW, |ui| {
        let palette = theme::palette(ui);
        let ratio = std_mm / stated_mm.max(f64::MIN_POSITIVE);
        let agrees = (1.0 / AGREES_WITHIN..=AGREES_WITHIN).contains(&ratio);
        let (mark, color, verdict) = match (view.bootstrap.is_current, agrees) {
            (false, _) => (words::OUT_OF_DATE, palette.warn, words::OUT_OF_DATE),
            (true, true) => ("✔", palette.good, words::BOOTSTRAP_AGREES),
            (true, false) => ("!", palette.warn, words::BOOTSTRAP_DIFFERS),
        };
        ui.label(RichText::new(mark).color(color)).on_hover_text(verdict);
        let figure = words::bootstrap_result(&std_text(*std_mm));
        ui.label(number_text(figure)).on_hover_text(&details);
    });
}

/// The point's 1σ ellipse seen along the flange's z and along its y, both to one scale.
fn ellipses(ui: &mut Ui, height: f32, uncertainty: &Uncertainty) {
    let (area, response) = ui.allocate_exact_size(vec2(ui.available_width(), height), Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, words::ELLIPSE_HINT));
    response.on_hover_text(words::ELLIPSE_HINT);
    let covariance = &uncertainty.workspace_point_covariance;
    let (weakest, weakest_mm) = uncertainty.weakest_direction();
    // Half of the smaller side of a view, and some room around the longest axis.
    let (left, right) = area.split_left_right_at_fraction(0.5);
    let (left, right) = (left.with_max_x(left.right() - 4.0), right.with_min_x(right.left() + 4.0));
    let scale = f64::from(left.width().min(left.height()) * 0.40) / weakest_mm.max(1e-9);
    for (place, axes, names) in [(left, [0, 1], ["x", "y"]), (right, [0, 2], ["x", "z"])] {
        let direction = axes.map(|axis| weakest[axis] * weakest_mm * scale);
        view_along(ui, place, &block(covariance, axes), scale, direction, names);
    }
}

/// Variances along two axes and their covariance.
fn block(covariance: &Mat3, [a, b]: [usize; 2]) -> [f64; 3] {
    [covariance[(a, a)], covariance[(b, b)], covariance[(a, b)]]
}

#[expect(clippy::cast_possible_truncation, reason = "screen coordinates")]
fn view_along(ui: &Ui, place: Rect, variances: &[f64; 3], scale: f64, [right, up]: [f64; 2], names: [&str; 2]) {
    let palette = theme::palette(ui);
    let painter = ui.painter().with_clip_rect(place.intersect(ui.clip_rect()));
    painter.rect_stroke(place, 2.0, Stroke::new(1.0, palette.hairline), StrokeKind::Inside);
    let centre = place.center();
    painter.hline(place.x_range(), centre.y, Stroke::new(1.0, palette.hairline));
    painter.vline(centre.x, place.y_range(), Stroke::new(1.0, palette.hairline));
    let font = FontId::proportional(theme::SMALL_SIZE);
    let at = place.right_bottom() - vec2(6.0, 2.0);
    painter.text(at, Align2::RIGHT_BOTTOM, format!("{} →", names[0]), font.clone(), palette.text_dim);
    let at = place.left_top() + vec2(8.0, 3.0);
    painter.text(at, Align2::LEFT_TOP, format!("{} ↑", names[1]), font.clone(), palette.text_dim);

    let [xx, yy, xy] = *variances;
    // Eigenvalues of the symmetric 2 × 2 matrix, in closed form.
    let (middle, half_gap) = (f64::midpoint(xx, yy), ((xx - yy) / 2.0).hypot(xy));
    let semi_axes = [middle + half_gap, middle - half_gap].map(|variance| (variance.max(0.0).sqrt() * scale) as f32);
    // The screen's y points down, so the angle turns round.
    let angle = -(0.5 * (2.0 * xy).atan2(xx - yy)) as f32;
    let fill = theme::INLIER.gamma_multiply(0.12);
    charts::ellipse(&painter, centre, semi_axes, angle, fill, Stroke::new(1.2, theme::INLIER));
    charts::arrow(&painter, centre, centre + vec2(right as f32, -up as f32), Stroke::new(1.8, palette.bad));

    let (length_mm, length) = scale_bar(scale, f64::from(place.width()) * 0.3);
    let left = place.left() + 8.0;
    let y = place.bottom() - 7.0;
    painter.hline(left..=left + length as f32, y, Stroke::new(1.5, palette.text_dim));
    let at = pos2(left, y - 2.0);
    painter.text(at, Align2::LEFT_BOTTOM, format!("{length_mm} mm"), font, palette.text_dim);
}

/// A round length (1, 2 or 5 times a power of ten, mm) that takes no more than `most` points, and what it takes.
fn scale_bar(scale: f64, most: f64) -> (f64, f64) {
    let longest_mm = most / scale;
    let decade = 10.0_f64.powf(longest_mm.log10().floor());
    let length_mm = [5.0, 2.0, 1.0].into_iter().map(|factor| factor * decade).find(|length| *length <= longest_mm);
    let length_mm = length_mm.unwrap_or(decade);
    // Rounded, so that 0.02 is not shown as 0.020000000000000004.
    let digits = 10.0_f64.powf(-decade.log10().min(0.0) + 1.0);
    ((length_mm * digits).round() / digits, length_mm * scale)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scale_bar_is_round_and_fits() {
        for scale in [3.0, 470.0, 1e4, 2.2e6] {
            let (length_mm, points) = scale_bar(scale, 50.0);
            assert!(points <= 50.0 + 1e-9 && points > 50.0 / 2.6, "{scale}: {points}");
            assert!(length_mm.to_string().trim_start_matches(['0', '.']).len() <= 3, "{length_mm}");
        }
    }
}
