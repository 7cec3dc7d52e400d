//! What the published closed forms make of the same motions, beside the refined answer.

use egui::{Align2, Color32, Ui};

use crate::calibrate::motion::{Answered, ClosedFormAnswer};
use crate::text::closed_form_name;
use crate::text::compare as text;
use crate::ui::{theme, widgets};

use super::table::RowCells;

/// Parts of a row: name, distance and angle from the refined answer, what is left over of place and angle.
const PARTS: [f32; 5] = [232.0, 130.0, 100.0, 138.0, 100.0];

/// Shows the table.
pub fn show(ui: &mut Ui, answers: &[ClosedFormAnswer]) {
    let right = |ui: &mut Ui| {
        ui.label(theme::dim(ui, text::CLOSED_FORMS_HINT));
    };
    widgets::card(ui, text::CLOSED_FORMS, right, |ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        let scale = ui.available_width() / PARTS.iter().sum::<f32>();
        let widths = PARTS.map(|part| part * scale);
        let mut head = RowCells::new(ui, theme::ROW_HEIGHT);
        head.head(widths[0], "", Align2::LEFT_CENTER);
        for (width, name) in widths[1..].iter().zip(text::CLOSED_FORM_COLUMNS) {
            head.head(*width, name, Align2::RIGHT_CENTER);
        }
        for found in answers {
            let mut cells = RowCells::new(ui, theme::ROW_HEIGHT);
            cells.text(widths[0], closed_form_name(found.form));
            match &found.answer {
                Some(answer) => {
                    for (width, (value, decimals)) in widths[1..].iter().zip(values(answer)) {
                        cells.number(*width, value, &widgets::fixed(value, decimals), Color32::TRANSPARENT);
                    }
                }
                None => cells.text(widths[1..].iter().sum(), text::CLOSED_FORM_SINGULAR),
            }
        }
    });
}

/// The figures in the order of the columns, each with its digits behind the point.
fn values(answer: &Answered) -> [(f64, usize); 4] {
    [
        (answer.off_mm, 3),
        (answer.off_rad.to_degrees(), 4),
        (answer.residual_mm, 3),
        (answer.residual_rad.to_degrees(), 4),
    ]
}
