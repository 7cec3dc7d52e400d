//! Where the stations find the target: centres or tips about their mean, seen from above and from the side, or the points of
//! a plate about its edges, seen along these; with 1σ ellipses.

use egui::{Align2, Id, Stroke, Ui, UiBuilder, vec2};

use crate::calibrate::Method;
use crate::report::comparison::MethodTable;
use crate::text::compare as text;
use crate::text::methods::method_short_name;
use crate::ui::charts::{self, Canvas, Chart, Extent};
use crate::ui::{theme, widgets};

use super::bars::method_legend;

/// Whether each view is fitted to its data.
#[derive(Clone, Copy, Debug)]
pub struct ScatterView {
    is_fitted: [bool; 2],
}

impl Default for ScatterView {
    fn default() -> Self {
        Self { is_fitted: [true; 2] }
    }
}

/// Shows both views in the space available.
pub fn show(ui: &mut Ui, tables: &[(Method, &MethodTable)], view: &mut ScatterView) {
    method_legend(ui, tables.iter().map(|(method, _)| *method));
    // One reach for both views, so that a millimetre is equally long in both.
    let reach_mm = tables
        .iter()
        .flat_map(|(_, table)| [0, 1].into_iter().flat_map(|plot| table.scatter(plot)))
        .map(|(_, [across, up])| across.abs().max(up.abs()))
        .fold(0.005, f64::max)
        * 1.1;
    let extent = Extent { x: [-reach_mm, reach_mm], y: [-reach_mm, reach_mm] };
    let area = ui.available_rect_before_wrap();
    let (left, right) = area.split_left_right_at_fraction(0.5);
    let titles = if tables.iter().any(|(_, table)| table.is_of_plate) {
        [[text::ACROSS_P_AXIS, text::OFF_PLATE_AXIS], [text::ACROSS_Q_AXIS, text::OFF_PLATE_AXIS]]
    } else {
        [[text::X_AXIS, text::Y_AXIS], [text::X_AXIS, text::Z_AXIS]]
    };
    let views = [("compare xy", left), ("compare xz", right)];
    for (plot, ((is_fitted, (name, rect)), [x_title, y_title])) in
        view.is_fitted.iter_mut().zip(views).zip(titles).enumerate()
    {
        let mut half = ui.new_child(UiBuilder::new().max_rect(rect));
        let mut chart = Chart::new(Id::unique(name), x_title, y_title, rect.height(), extent);
        chart.has_equal_scales = true;
        let canvas = chart.show(&mut half, is_fitted);
        paint(&half, &canvas, tables, plot);
    }
    ui.advance_cursor_after_rect(area);
}

fn paint(ui: &Ui, canvas: &Canvas, tables: &[(Method, &MethodTable)], plot: usize) {
    for (method, table) in tables {
        if let Some(ellipse) = table.ellipse(plot) {
            let color = theme::method_color(*method);
            #[expect(clippy::cast_possible_truncation, reason = "screen coordinates")]
            let semi_axes = ellipse.semi_axes.map(|length_mm| length_mm as f32 * canvas.scale());
            // The screen's y points down, so the angle turns round.
            #[expect(clippy::cast_possible_truncation, reason = "an angle")]
            let angle = -ellipse.angle_rad as f32;
            let centre = canvas.at(ellipse.centre[0], ellipse.centre[1]);
            let stroke = Stroke::new(1.2, color);
            charts::ellipse(&canvas.painter, centre, semi_axes, angle, color.gamma_multiply(0.1), stroke);
        }
    }
    let mut items = Vec::new();
    for (method, table) in tables {
        for (row_idx, point) in table.scatter(plot) {
            let halo = Stroke::new(0.8, theme::palette(ui).surface);
            let at = canvas.at(point[0], point[1]);
            charts::marker(&canvas.painter, theme::method_marker(*method), at, 4.2, theme::method_color(*method), halo);
            items.push(((*method, &table.rows[row_idx].label, point), point));
        }
    }
    if let Some((method, label, point)) = canvas.hovered(items) {
        let figures = format!("{}, {}", widgets::signed(point[0], 3), widgets::signed(point[1], 3));
        let words = text::station_readout(label, method_short_name(method), &figures);
        let at = canvas.at(point[0], point[1]) + vec2(10.0, -6.0);
        canvas.note(ui, at, Align2::LEFT_BOTTOM, &words, theme::palette(ui).text);
    }
}
