//! The regions with their planes, the angles between them, and the distances of points drawn at random.

use egui::{
    Align2, Color32, Margin, Rect, Role, ScrollArea, Sense, Stroke, StrokeKind, TextEdit, Ui, UiBuilder, WidgetInfo,
    vec2,
};
use egui_extras::Column;

use crate::app::workbench::scans::{ExaminedScan, ScanCommand};
use crate::scan::PlaneFit;
use crate::text::workpiece as words;
use crate::ui::save_picture::saveable;
use crate::ui::verify::histogram::{self, Series};
use crate::ui::verify::marks::Mark;
use crate::ui::widgets::tables::{head, number_cell, number_head, table};
use crate::ui::{PanelContext, theme, widgets};
use crate::verify::Figures;

use super::ask;
use super::colors::region_color;

/// Width of the histogram, as a part of the whole.
const HISTOGRAM_PART: f32 = 0.3;
/// Width from which the histogram has room beside the planes.
const SIDE_BY_SIDE_FROM: f32 = 860.0;
/// Width from which two angles have room side by side.
const TWO_ANGLES_FROM: f32 = 600.0;
/// Width from which σ and the number of points have columns beside a whole equation.
const ALL_COLUMNS_FROM: f32 = 680.0;
/// Rows of angles that are seen at once; the others are reached by scrolling.
const MOST_ANGLE_ROWS: usize = 3;
/// Height of one, with the gap below it.
const ANGLE_ROW_HEIGHT: f32 = 20.0;

/// What the tables remember between frames.
#[derive(Debug, Default)]
pub(super) struct PlanesState {
    /// The region whose distances are shown; all of them without.
    region_idx: Option<usize>,
    is_unfitted: bool,
}

/// Shows both cards in a row.
pub(super) fn show(
    ui: &mut Ui,
    context: &mut PanelContext<'_>,
    scan: &ExaminedScan,
    height: f32,
    state: &mut PlanesState,
) {
    let room = vec2(ui.available_width(), height);
    let (rect, _) = ui.allocate_exact_size(room, Sense::hover());
    // In a narrow window the histogram stands below, so that no equation is cut.
    let (left, right) = if room.x < SIDE_BY_SIDE_FROM {
        (rect, ui.allocate_exact_size(room, Sense::hover()).0)
    } else {
        let (left, right) = rect.split_left_right_at_fraction(1.0 - HISTOGRAM_PART);
        (left.with_max_x(left.right() - theme::GAP / 2.0), right.with_min_x(right.left() + theme::GAP / 2.0))
    };
    let within = |ui: &mut Ui, rect: Rect| ui.new_child(UiBuilder::new().max_rect(rect));
    let mut left = within(ui, left);
    let (mut find, mut undo) = (false, false);
    let can_undo = context.workbench.scans().can_undo_regions();
    widgets::card_with_height(
        &mut left,
        words::PLANES,
        height,
        |ui| {
            find = ui.button(words::FIND_PLANES).on_hover_text(words::FIND_PLANES_HINT).clicked();
            let button = ui.add_enabled(can_undo, egui::Button::new(words::UNDO_REGIONS));
            undo = button.on_hover_text(words::UNDO_REGIONS_HINT).clicked();
        },
        |ui| {
            let angles = angles(scan);
            let num_columns: u8 = if ui.available_width() < TWO_ANGLES_FROM { 1 } else { 2 };
            #[expect(clippy::cast_precision_loss, reason = "a few rows")]
            let foot = match angles.len().div_ceil(num_columns.into()).min(MOST_ANGLE_ROWS) {
                0 => 0.0,
                num_rows => 14.0 + ANGLE_ROW_HEIGHT * num_rows as f32,
            };
            let table_height = (ui.available_height() - foot).max(60.0);
            let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), table_height), Sense::hover());
            planes_table(&mut within(ui, rect), context, scan, table_height, state);
            ScrollArea::vertical().id_salt("angles").show(ui, |ui| angle_rows(ui, &angles, num_columns));
        },
    );
    if find {
        ask(context, ScanCommand::FindPlanes);
    }
    if undo {
        ask(context, ScanCommand::UndoRegions);
    }
    let mut right = within(ui, right);
    let region_idx = state.region_idx.filter(|idx| *idx < scan.regions.len());
    let shown = region_idx.map_or(words::ALL_REGIONS, |idx| scan.regions[idx].name.as_str());
    let num_drawn = scan.regions.iter().map(|region| region.distances_mm.len()).max().unwrap_or(0);
    let title = words::histogram_title(num_drawn, shown);
    widgets::card_with_height(
        &mut right,
        &title,
        height,
        |_| {},
        |ui| {
            let wanted = |idx: &usize| region_idx.is_none_or(|wanted| wanted == *idx);
            let marks: Vec<(usize, Mark)> = (0..scan.regions.len())
                .filter(wanted)
                .take(4)
                .map(|idx| (idx, Mark::plain(scan.regions[idx].name.clone(), region_color(idx))))
                .collect();
            let sizes = |idx: usize| scan.regions[idx].distances_mm.iter().map(|distance| distance.abs()).collect();
            let series: Vec<Series<'_>> =
                marks.iter().map(|(idx, mark)| Series { mark, distances_mm: sizes(*idx) }).collect();
            if series.is_empty() {
                widgets::nothing(ui, words::NO_PLANES);
                return;
            }
            let mut is_fitted = !state.is_unfitted;
            saveable(ui, &title, |ui| {
                histogram::legend(ui, &marks.iter().map(|(_, mark)| mark).collect::<Vec<_>>());
                histogram::show(ui, "workpiece distances", words::DISTANCE_AXIS, &series, &mut is_fitted);
            });
            state.is_unfitted = !is_fitted;
        },
    );
}

fn planes_table(
    ui: &mut Ui,
    context: &mut PanelContext<'_>,
    scan: &ExaminedScan,
    height: f32,
    state: &mut PlanesState,
) {
    // Where there is no room for them, the words over the equation tell σ and points.
    let has_room = ui.available_width() >= ALL_COLUMNS_FROM;
    let num_more = usize::from(has_room);
    ui.push_id("planes", |ui| {
        let builder = table(ui, "planes")
            .column(Column::exact(60.0))
            .column(Column::remainder().at_least(200.0).clip(true))
            .columns(Column::exact(66.0), num_more)
            .columns(Column::exact(54.0), num_more)
            .columns(Column::exact(54.0), 3)
            .column(Column::exact(30.0))
            .auto_shrink([false, false])
            .max_scroll_height(height - theme::ROW_HEIGHT)
            .sense(Sense::click());
        let header = builder.header(theme::ROW_HEIGHT, |mut row| {
            head(&mut row, words::REGION_COLUMN);
            head(&mut row, words::EQUATION_COLUMN);
            let more = [words::STD_COLUMN, words::POINTS_COLUMN].into_iter().filter(|_| has_room);
            for name in more.chain(words::FIGURE_COLUMNS) {
                number_head(&mut row, name);
            }
            head(&mut row, "");
        });
        header.body(|body| {
            body.rows(theme::ROW_HEIGHT, scan.regions.len(), |mut row| {
                let idx = row.index();
                let region = &scan.regions[idx];
                row.set_selected(state.region_idx == Some(idx));
                let mut is_chosen = false;
                row.col(|ui| is_chosen = name_cell(ui, context, &region.name, idx, state.region_idx == Some(idx)));
                row.col(|ui| match &region.plane {
                    Ok(fit) => {
                        let text = words::equation(&fit.equation()).replace('-', "−");
                        let label = egui::Label::new(egui::RichText::new(text).font(theme::number_font()));
                        ui.add(label.truncate()).on_hover_text(words::plane_hover(fit));
                    }
                    Err(error) => {
                        ui.add(egui::Label::new(theme::dim(ui, error.to_string())).truncate());
                    }
                });
                if has_room {
                    let fit = region.plane.as_ref().ok();
                    number_cell(&mut row, fit.map_or_else(String::new, words::height_std));
                    number_cell(&mut row, words::grouped(region.set.len()));
                }
                let sizes: Vec<f64> = region.distances_mm.iter().map(|distance| distance.abs()).collect();
                let figures = Figures::of(&sizes);
                for value in [figures.mean_mm, figures.std_mm, figures.max_mm] {
                    number_cell(&mut row, widgets::fixed(value, words::DISTANCE_DECIMALS));
                }
                row.col(|ui| {
                    if widgets::symbol_button(ui, "×", &words::remove_region(&region.name)).clicked() {
                        ask(context, ScanCommand::RemoveRegion(idx));
                    }
                });
                if row.response().clicked() || is_chosen {
                    state.region_idx = if state.region_idx == Some(idx) { None } else { Some(idx) };
                }
            });
        });
    });
}

/// The colour, by which the keyboard chooses the region, and the name, which can be changed in place. Whether it was chosen.
fn name_cell(ui: &mut Ui, context: &mut PanelContext<'_>, name: &str, idx: usize, is_shown: bool) -> bool {
    ui.add_space(5.0);
    let (square, response) = ui.allocate_exact_size(vec2(16.0, 16.0), Sense::click());
    response.widget_info(|| WidgetInfo::selected(Role::Button, true, is_shown, words::show_region(name)));
    ui.painter().rect_filled(square.shrink(3.0), 2.0, region_color(idx));
    if response.has_focus() || is_shown {
        let stroke = Stroke::new(1.0, theme::palette(ui).accent);
        ui.painter().rect_stroke(square, 3.0, stroke, StrokeKind::Inside);
    }
    let mut text = name.to_owned();
    let field = ui.add(
        TextEdit::singleline(&mut text)
            .id_salt(("region name", idx))
            .frame(egui::Frame::NONE)
            .background_color(Color32::TRANSPARENT)
            .align(Align2::LEFT_CENTER)
            .margin(Margin::ZERO)
            .desired_width(30.0)
            .char_limit(40),
    );
    widgets::name_field(&field, &words::region_name_field(name), &text);
    if field.changed() {
        ask(context, ScanCommand::RenameRegion(idx, text));
    }
    response.clicked()
}

/// Pairs of planes with the angle between them.
fn angles(scan: &ExaminedScan) -> Vec<(String, String)> {
    let fits: Vec<(&str, &PlaneFit)> =
        scan.regions.iter().filter_map(|region| Some((region.name.as_str(), region.plane.as_ref().ok()?))).collect();
    let pairs = (0..fits.len()).flat_map(|second| (0..second).map(move |first| (first, second)));
    pairs
        .map(|(first, second)| {
            let (a, b) = (fits[first], fits[second]);
            (words::angle_label(a.0, b.0), words::angle(a.1, b.1, scan.known.angle_deg).replace('-', "−"))
        })
        .collect()
}

/// One or two a row.
fn angle_rows(ui: &mut Ui, angles: &[(String, String)], num_columns: u8) {
    let part = 1.0 / f32::from(num_columns);
    for pair in angles.chunks(num_columns.into()) {
        let (row, _) = ui.allocate_exact_size(vec2(ui.available_width(), 16.0), Sense::hover());
        for (column, (label, value)) in [0.0, 0.5].into_iter().zip(pair) {
            let left = row.left() + 12.0 + column * row.width();
            let cell = row.with_min_x(left).with_max_x(left + part * row.width() - 24.0);
            let mut inside = ui.new_child(UiBuilder::new().max_rect(cell));
            inside.horizontal(|ui| {
                ui.label(theme::dim(ui, label));
                ui.add(egui::Label::new(widgets::number_text(value)).truncate());
            });
        }
    }
}
