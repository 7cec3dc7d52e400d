//! Teeth and diameters against their nominal values.

use egui::{Rect, Sense, Ui, UiBuilder, vec2};

use crate::app::workbench::scans::ExaminedScan;
use crate::scan::{Deviation, Measured, Round, Teeth};
use crate::session::Known;
use crate::text::workpiece as words;
use crate::ui::widgets::tables::{head, number_cell, number_column, number_head, table};
use crate::ui::{theme, widgets};

/// Width of the figures beside the teeth.
const FIGURES_WIDTH: f32 = 300.0;

/// Shows what was looked for, side by side.
pub(super) fn show(ui: &mut Ui, scan: &ExaminedScan, height: f32) {
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), height), Sense::hover());
    let (left, right) = rect.split_left_right_at_x(rect.right() - FIGURES_WIDTH);
    let has_teeth = scan.shapes.teeth.is_some();
    let within = |ui: &mut Ui, rect: Rect| ui.new_child(UiBuilder::new().max_rect(rect));
    if let Some(found) = &scan.shapes.teeth {
        let mut left = within(ui, left.with_max_x(left.right() - theme::GAP));
        widgets::card_with_height(
            &mut left,
            words::TEETH,
            height,
            |_| {},
            |ui| match found {
                Ok(teeth) => teeth_table(ui, teeth, &scan.known),
                Err(error) => widgets::nothing(ui, &error.to_string()),
            },
        );
    }
    let mut right = within(ui, if has_teeth { right } else { rect });
    widgets::card_with_height(
        &mut right,
        words::AGAINST_NOMINAL,
        height,
        |_| {},
        |ui| {
            egui::Frame::new().inner_margin(egui::Margin::symmetric(12, 4)).show(ui, |ui| {
                ui.spacing_mut().item_spacing.y = 0.0;
                if let Some(Ok(teeth)) = &scan.shapes.teeth {
                    deviation_rows(ui, words::PITCH, teeth.pitches().collect(), scan.known.pitch_mm);
                    deviation_rows(ui, words::HEIGHT, teeth.heights().collect(), scan.known.height_mm);
                }
                match &scan.shapes.round {
                    Some(Ok(round)) => round_rows(ui, round, scan.known.diameter_mm),
                    Some(Err(error)) => {
                        ui.add(egui::Label::new(theme::dim(ui, error.to_string())).wrap());
                    }
                    None => {}
                }
            });
        },
    );
}

fn teeth_table(ui: &mut Ui, teeth: &Teeth, known: &Known) {
    ui.push_id("teeth", |ui| {
        let builder = table(ui, "teeth").column(egui_extras::Column::exact(56.0)).columns(number_column(62.0), 7);
        let header = builder.header(theme::ROW_HEIGHT, |mut row| {
            head(&mut row, words::TOOTH_COLUMN);
            for name in words::TEETH_COLUMNS {
                number_head(&mut row, name);
            }
        });
        header.body(|body| {
            body.rows(theme::ROW_HEIGHT, teeth.teeth.len(), |mut row| {
                let idx = row.index();
                let tooth = &teeth.teeth[idx];
                row.col(|ui| {
                    ui.add_space(12.0);
                    ui.label(widgets::number_text((idx + 1).to_string()));
                });
                number_cell(&mut row, widgets::fixed(tooth.place_mm, 3));
                for (measured, nominal_mm) in [(tooth.pitch, known.pitch_mm), (tooth.height, known.height_mm)] {
                    let value = measured.map_or(f64::NAN, |measured| measured.value_mm);
                    number_cell(&mut row, widgets::fixed(value, 3));
                    number_cell(&mut row, widgets::fixed(measured.map_or(f64::NAN, |measured| measured.std_mm), 3));
                    let error = nominal_mm.map_or(f64::NAN, |nominal_mm| value - nominal_mm);
                    number_cell(&mut row, widgets::signed(error, 3));
                }
            });
        });
    });
}

fn deviation_rows(ui: &mut Ui, name: &str, values: Vec<Measured>, nominal_mm: Option<f64>) {
    let Some(nominal_mm) = nominal_mm else { return };
    let Some(deviation) = Deviation::of(values.into_iter(), nominal_mm) else { return };
    widgets::value_row(ui, &words::mean_label(name, nominal_mm), words::mm(deviation.mean_value_mm));
    widgets::value_row(ui, words::MEAN_ERROR, words::mm(deviation.mean_error_mm));
    widgets::value_row(ui, words::GREATEST_ERROR, words::mm(deviation.max_error_mm));
}

fn round_rows(ui: &mut Ui, round: &Round, nominal_mm: Option<f64>) {
    let name = words::round_name(round.kind);
    widgets::value_row(ui, &words::diameter_label(name), words::plus_minus(round.diameter_mm, round.diameter_std_mm));
    if let Some(nominal_mm) = nominal_mm {
        widgets::value_row(ui, words::CERTIFIED, words::mm(nominal_mm));
        widgets::value_row(ui, words::DIFFERENCE, format!("{} mm", widgets::signed(round.diameter_mm - nominal_mm, 3)));
    }
    widgets::value_row(ui, words::ROUND_RMS, words::mm(round.rms_mm));
    widgets::value_row(ui, words::ROUND_POINTS, words::grouped(round.num_used));
}
