//! How the calibrations differ, pair by pair.

use egui::{Align2, Color32, Frame, Margin, Ui};

use crate::calibrate::Method;
use crate::report::comparison::DifferenceRow;
use crate::text::compare as text;
use crate::text::methods::method_short_name;
use crate::ui::{theme, widgets};

use super::table::RowCells;

/// Up to this many standard deviations two calibrations agree.
const AGREE_WITHIN_STDS: f64 = 2.0;
/// Parts of a row: pair, Δx Δy Δz, rotation, workspace point, significance.
const PARTS: [f32; 7] = [210.0, 96.0, 96.0, 96.0, 96.0, 130.0, 110.0];
/// The same where the card is narrow.
const NARROW_PARTS: [f32; 7] = [120.0, 56.0, 56.0, 56.0, 56.0, 86.0, 82.0];
/// Below this width, points, the longest texts stand in two lines.
const NARROW_BELOW: f32 = 800.0;
/// Height of a row with two lines.
const TWO_LINES_HEIGHT: f32 = 38.0;

/// What the width allows.
struct Shape {
    widths: [f32; 7],
    row_height: f32,
    is_narrow: bool,
}

impl Shape {
    fn of(ui: &Ui) -> Self {
        let width = ui.available_width();
        let is_narrow = width < NARROW_BELOW;
        let parts = if is_narrow { NARROW_PARTS } else { PARTS };
        let scale = width / parts.iter().sum::<f32>();
        Self {
            widths: parts.map(|part| part * scale),
            row_height: if is_narrow { TWO_LINES_HEIGHT } else { theme::ROW_HEIGHT },
            is_narrow,
        }
    }
}

/// Shows the table in the space available; pairs with the published stop only if it is shown.
pub fn show(ui: &mut Ui, rows: &[DifferenceRow], shows_published_stop: bool) {
    let rows: Vec<&DifferenceRow> = rows
        .iter()
        .filter(|row| shows_published_stop || ![row.first, row.second].contains(&Method::BallMaxArcStep))
        .collect();
    let right = |ui: &mut Ui| {
        ui.label(theme::dim(ui, text::DIFFERENCE_HINT));
    };
    widgets::card(ui, text::DIFFERENCE, right, |ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        if rows.is_empty() {
            Frame::new().inner_margin(Margin::same(16)).show(ui, |ui| {
                ui.label(theme::dim(ui, text::NOTHING_TO_COMPARE));
            });
            return;
        }
        let shape = Shape::of(ui);
        let widths = &shape.widths;
        let mut head = RowCells::new(ui, shape.row_height);
        head.head(widths[0], "", Align2::LEFT_CENTER);
        for (width, name) in widths[1..].iter().zip([
            "Δx / mm",
            "Δy / mm",
            "Δz / mm",
            text::ROTATION,
            if shape.is_narrow { text::AT_WORKSPACE_POINT_NARROW } else { text::AT_WORKSPACE_POINT },
            text::WITHIN,
        ]) {
            head.head(*width, name, Align2::RIGHT_CENTER);
        }
        for row in rows {
            pair(ui, row, &shape);
        }
    });
}

fn pair(ui: &mut Ui, row: &DifferenceRow, shape: &Shape) {
    let palette = theme::palette(ui);
    let difference = &row.difference;
    let widths = &shape.widths;
    let mut cells = RowCells::new(ui, shape.row_height);
    let (first, second) = (method_short_name(row.first), method_short_name(row.second));
    let names = if shape.is_narrow { text::pair_in_two_lines(first, second) } else { text::pair(first, second) };
    cells.text(widths[0], &names);
    for axis in 0..3 {
        let value = difference.translation_mm[axis];
        cells.number(widths[1 + axis], value, &widgets::signed(value, 3), Color32::TRANSPARENT);
    }
    let rotation_deg = format!("{}°", widgets::fixed(difference.rotation_rad.to_degrees(), 3));
    cells.word(widths[4], &rotation_deg, palette.text);
    let distance = difference.workspace_point_mm;
    cells.number(widths[5], distance, &format!("{} mm", widgets::fixed(distance, 3)), Color32::TRANSPARENT);
    match difference.in_stds {
        Some(in_stds) => {
            let is_within = in_stds <= AGREE_WITHIN_STDS;
            let color = if is_within { palette.good } else { palette.warn };
            cells.word(widths[6], &text::within(is_within, &widgets::fixed(in_stds, 1)), color);
        }
        None => cells.word(widths[6], text::NO_STD, palette.text_dim),
    }
}
