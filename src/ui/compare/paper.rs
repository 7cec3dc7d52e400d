//! A method's table in the layout of Tables 1 and 2 of Lin & Mu: four lines a station, every coordinate with its name.

use egui::{Align2, Color32, FontId, Ui, pos2, vec2};

use crate::app::Command;
use crate::calibrate::Method;
use crate::report::comparison::{ErrorReference, MethodTable, Row};
use crate::text::compare as text;
use crate::ui::{Selection, theme, widgets};

use super::cards::station_cell;
use super::table::{RowCells, coordinate, tint};

/// Height of one of a station's four lines.
const LINE_HEIGHT: f32 = 18.0;
/// From the right end of a number to its name, points: near enough to read them as one.
const NAME_OFFSET: f32 = 92.0;
/// Parts of a row: number, translation, quaternion, ball in sensor, ball in base, error.
const PARTS: [f32; 6] = [52.0, 92.0, 92.0, 96.0, 96.0, 84.0];

/// Shows the table in the space available.
pub fn show(
    ui: &mut Ui,
    method: Method,
    table: &MethodTable,
    reference: ErrorReference,
    selection: &mut Selection,
    commands: &mut Vec<Command>,
) {
    let scale = ui.available_width() / PARTS.iter().sum::<f32>();
    let widths = PARTS.map(|part| part * scale);
    let error = if table.is_of_plate { text::OFF_EDGE } else { text::ERROR };
    let (in_sensor, in_base) = (text::in_sensor(method), text::in_base(method));
    let heads = [text::NUMBER, text::TRANSLATION, text::QUATERNION, in_sensor, in_base, error];
    let mut row = RowCells::new(ui, theme::ROW_HEIGHT);
    for (idx, (width, head)) in widths.iter().zip(heads).enumerate() {
        row.head(*width, head, if idx == 0 { Align2::LEFT_CENTER } else { Align2::RIGHT_CENTER });
    }
    for (row_idx, station) in table.rows.iter().enumerate() {
        ui.push_id((method, row_idx, "paper"), |ui| {
            let mut row = RowCells::new(ui, 4.0 * LINE_HEIGHT + 8.0);
            if !station.is_enabled {
                row = row.faded();
            }
            station_cell(&mut row, widths[0], method, station, selection, commands);
            blocks(&mut row, &widths, station, reference);
        });
    }
}

fn blocks(row: &mut RowCells<'_>, widths: &[f32; 6], station: &Row, reference: ErrorReference) {
    let faded = !station.is_enabled;
    let translation: Option<[f64; 3]> = station.translation_mm.map(Into::into);
    let lines = ["t1", "t2", "t3"].into_iter().zip(translation.into_iter().flatten());
    block(row, widths[1], faded, lines.map(|(name, value)| (name, value, coordinate(value), false)));
    let lines = ["q0", "q1", "q2", "q3"].into_iter().zip(station.quaternion_wxyz.into_iter().flatten());
    block(row, widths[2], faded, lines.map(|(name, value)| (name, value, widgets::fixed(value, 5), false)));
    let Some(used) = &station.used else {
        let words = if station.is_enabled { text::NOT_USED } else { text::LEFT_OUT };
        row.text(widths[3..].iter().sum(), words);
        return;
    };
    for (width, point, names) in [
        (widths[3], used.target_in_sensor_mm, ["xs", "ys", "zs"]),
        (widths[4], used.target_in_base_mm, ["xb", "yb", "zb"]),
    ] {
        let lines = names.into_iter().zip(point.iter().copied());
        block(row, width, faded, lines.map(|(name, value)| (name, value, coordinate(value), false)));
    }
    let error_mm = used.error_mm(reference);
    let lines = ["Δx", "Δy", "Δz"].into_iter().zip(error_mm.iter().copied());
    block(row, widths[5], faded, lines.map(|(name, value)| (name, value, widgets::signed(value, 3), true)));
}

fn block<'n>(
    row: &mut RowCells<'_>,
    width: f32,
    is_faded: bool,
    lines: impl Iterator<Item = (&'n str, f64, String, bool)>,
) {
    let cell = row.next(width);
    let palette = theme::palette(row.ui());
    let color = if is_faded { palette.text_dim } else { palette.text };
    let mut top = cell.top() + 4.0;
    for (name, value, words, is_error) in lines {
        let line = egui::Rect::from_min_size(pos2(cell.left(), top), vec2(width, LINE_HEIGHT));
        let painter = row.ui().painter().clone();
        let ground = if is_error && !is_faded { tint(value) } else { Color32::TRANSPARENT };
        painter.rect_filled(line.shrink2(vec2(1.0, 0.0)), 0.0, ground);
        let at = pos2(line.right() - NAME_OFFSET.min(width - 8.0), line.center().y);
        painter.text(at, Align2::LEFT_CENTER, name, FontId::proportional(theme::SMALL_SIZE), palette.text_dim);
        let at = line.right_center() - vec2(6.0, 0.0);
        painter.text(at, Align2::RIGHT_CENTER, &words, theme::number_font(), color);
        row.name(line, &format!("{name} {words}"), Some(&crate::text::typeset::all_digits(value)));
        top += LINE_HEIGHT;
    }
}
