//! One card a method: its name and figures, then its table or the reason why there is none.

use egui::{
    Align, Align2, Checkbox, Color32, Frame, Layout, Margin, Rect, Role, Sense, Ui, UiBuilder, WidgetInfo, vec2,
};

use crate::app::Command;
use crate::calibrate::{Method, Mount};
use crate::report::comparison::{Column, ErrorReference, MethodTable, Row};
use crate::text::compare as text;
use crate::text::methods::{method_name, method_short_name};
use crate::text::typeset::std_text;
use crate::ui::{Selection, charts, theme, widgets};

use super::paper;
use super::table::{RowCells, coordinate, tint};

/// Height of a card's head.
const HEAD_HEIGHT: f32 = 34.0;
/// Height of the coloured edge.
const EDGE_HEIGHT: f32 = 3.0;
/// Parts of a row: station, x y z, Δx Δy Δz, |e|.
const PARTS: [f32; 8] = [46.0, 73.0, 73.0, 73.0, 54.0, 54.0, 54.0, 51.0];
/// The same where the edge stands behind the station.
const PARTS_OF_PLATE: [f32; 8] = [62.0, 69.0, 69.0, 69.0, 53.0, 53.0, 53.0, 50.0];

/// How the tables are shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CardOptions {
    /// What errors are relative to.
    pub reference: ErrorReference,
    /// Whether in the layout of the paper's tables.
    pub has_paper_layout: bool,
    /// Whether with the matrix.
    pub has_matrix: bool,
}

/// Shows a card in the space available.
pub fn show(
    ui: &mut Ui,
    column: &Column,
    options: CardOptions,
    selection: &mut Selection,
    commands: &mut Vec<Command>,
) {
    let top = ui.cursor().min;
    let width = ui.available_width();
    widgets::card(
        ui,
        "",
        |_| {},
        |ui| {
            ui.spacing_mut().item_spacing.y = 0.0;
            head(ui, column, options.reference, selection);
            match &column.outcome {
                Ok(table) => {
                    if options.has_paper_layout {
                        paper::show(ui, column.method, table, options.reference, selection, commands);
                    } else {
                        plain(ui, column.method, table, options.reference, selection, commands);
                    }
                    footer(ui, table);
                    if options.has_matrix {
                        matrix(ui, table);
                    }
                }
                Err(reason) => refused(ui, reason),
            }
        },
    );
    let edge = Rect::from_min_size(top, vec2(width, EDGE_HEIGHT));
    ui.painter().rect_filled(edge, 0.0, theme::method_color(column.method));
}

fn head(ui: &mut Ui, column: &Column, reference: ErrorReference, selection: &mut Selection) {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), HEAD_HEIGHT), Sense::click());
    let name = method_name(column.method);
    let is_selected = selection.method == column.method;
    response.widget_info(|| WidgetInfo::selected(Role::Button, true, is_selected, text::select_method(name)));
    let palette = theme::palette(ui);
    if response.hovered() {
        ui.painter().rect_filled(rect.shrink2(vec2(0.0, 1.0)), 0.0, palette.hovered);
    }
    ui.painter().hline(rect.x_range(), rect.bottom(), egui::Stroke::new(1.0, palette.hairline));
    if response.clicked() {
        selection.method = column.method;
    }
    let inner = rect.with_min_y(rect.top() + EDGE_HEIGHT).shrink2(vec2(theme::GAP, 0.0));
    let mut row = ui.new_child(UiBuilder::new().max_rect(inner).layout(Layout::left_to_right(Align::Center)));
    let (sign, _) = row.allocate_exact_size(vec2(14.0, 14.0), Sense::hover());
    let color = theme::method_color(column.method);
    charts::marker(row.painter(), theme::method_marker(column.method), sign.center(), 5.0, color, egui::Stroke::NONE);
    let figures = column.outcome.as_ref().ok().map(|table| {
        text::method_figures(
            &coordinate(table.max_error_mm(reference)),
            table.leave_one_out_rms_mm.map(std_text).as_deref(),
            table.workspace_std_mm.map(std_text).as_deref(),
        )
    });
    // Where the whole name leaves the figures no room, the short one does.
    let font = egui::TextStyle::Body.resolve(row.style());
    let width = |text: &str| row.painter().layout_no_wrap(text.to_owned(), font.clone(), Color32::PLACEHOLDER).size().x;
    let needed = width(name) + figures.as_deref().map_or(0.0, width) + 3.0 * theme::GAP;
    let shown_name = if needed > row.available_width() { method_short_name(column.method) } else { name };
    row.add(egui::Label::new(theme::strong(shown_name)).selectable(false).extend()).on_hover_text(name);
    if let (Ok(table), Some(figures)) = (&column.outcome, figures) {
        row.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let label = egui::Label::new(theme::dim(ui, figures)).selectable(false).truncate();
            ui.add(label).on_hover_text(text::method_figures_hint(table.is_of_plate));
        });
    }
}

fn refused(ui: &mut Ui, reason: &str) {
    Frame::new().inner_margin(Margin::same(16)).show(ui, |ui| {
        ui.horizontal_top(|ui| {
            ui.label(theme::strong("!").color(theme::palette(ui).warn));
            ui.add(egui::Label::new(reason).wrap());
        });
    });
}

/// The same where a row is a stretch, named by its seconds.
const PARTS_OF_WAY: [f32; 8] = [78.0, 67.0, 62.0, 67.0, 54.0, 54.0, 54.0, 46.0];

/// Widths of the columns, so that they fill the card.
fn widths(ui: &Ui, table: &MethodTable) -> [f32; 8] {
    let parts = match table {
        MethodTable { is_of_plate: true, .. } => PARTS_OF_PLATE,
        _ if is_way(table) => PARTS_OF_WAY,
        _ => PARTS,
    };
    let scale = ui.available_width() / parts.iter().sum::<f32>();
    parts.map(|part| part * scale)
}

fn is_way(table: &MethodTable) -> bool {
    table.rows.iter().any(|row| !row.is_station())
}

fn plain(
    ui: &mut Ui,
    method: Method,
    table: &MethodTable,
    reference: ErrorReference,
    selection: &mut Selection,
    commands: &mut Vec<Command>,
) {
    let widths = widths(ui, table);
    let mut row = RowCells::new(ui, theme::ROW_HEIGHT);
    let [rows, in_base] =
        if is_way(table) { [text::STRETCH, text::SCENE_IN_BASE] } else { [text::STATION, text::in_base(method)] };
    row.head(widths[0], rows, Align2::LEFT_CENTER);
    row.head(widths[1..4].iter().sum(), in_base, Align2::CENTER_CENTER);
    row.head(widths[4..7].iter().sum(), &reference_head(reference, table), Align2::CENTER_CENTER);
    row.head(widths[7], text::ERROR_SIZE, Align2::RIGHT_CENTER);
    let mut row = RowCells::new(ui, theme::ROW_HEIGHT - 2.0);
    row.head(widths[0], "", Align2::LEFT_CENTER);
    for (width, name) in widths[1..7].iter().zip(["x", "y", "z", "Δx", "Δy", "Δz"]) {
        row.head(*width, name, Align2::RIGHT_CENTER);
    }
    for (row_idx, station) in table.rows.iter().enumerate() {
        ui.push_id((method, row_idx), |ui| {
            let mut row = RowCells::new(ui, theme::ROW_HEIGHT);
            if !station.is_enabled {
                row = row.faded();
            }
            station_cell(&mut row, widths[0], method, station, selection, commands);
            numbers(&mut row, &widths, station, reference);
        });
    }
}

fn reference_head(reference: ErrorReference, table: &MethodTable) -> String {
    if table.is_of_plate {
        return text::OFF_EDGE.to_owned();
    }
    match (reference, table.used().next()) {
        (ErrorReference::FirstStation, Some((row_idx, _))) => {
            let row = &table.rows[row_idx];
            text::error_from_first(&row.label, row.is_station())
        }
        _ => text::ERROR_FROM_MEAN.to_owned(),
    }
}

fn numbers(row: &mut RowCells<'_>, widths: &[f32; 8], station: &Row, reference: ErrorReference) {
    let Some(used) = &station.used else {
        let words = if station.is_enabled { text::NOT_USED } else { text::LEFT_OUT };
        row.text(widths[1..].iter().sum(), words);
        return;
    };
    let error_mm = used.error_mm(reference);
    let shows_tint = station.is_enabled;
    let ground = |error_mm: f64| if shows_tint { tint(error_mm) } else { Color32::TRANSPARENT };
    for axis in 0..3 {
        let value = used.target_in_base_mm[axis];
        row.number(widths[1 + axis], value, &coordinate(value), Color32::TRANSPARENT);
    }
    for axis in 0..3 {
        let value = error_mm[axis];
        row.number(widths[4 + axis], value, &widgets::signed(value, 3), ground(value));
    }
    row.number(widths[7], error_mm.norm(), &coordinate(error_mm.norm()), Color32::TRANSPARENT);
}

/// The tick box and the label; a click on the label selects the station.
pub fn station_cell(
    row: &mut RowCells<'_>,
    width: f32,
    method: Method,
    station: &Row,
    selection: &mut Selection,
    commands: &mut Vec<Command>,
) {
    let station_idx = station.station_idx;
    let cell = row.next(width);
    let row_rect = row.rect();
    let method = method_name(method);
    let ui = row.ui();
    let palette = theme::palette(ui);
    if selection.station_idx == station_idx {
        let marker = Rect::from_min_size(row_rect.min, vec2(3.0, row_rect.height()));
        ui.painter().rect_filled(marker, 0.0, palette.accent);
    }
    let box_rect = Rect::from_min_size(cell.min + vec2(6.0, 0.0), vec2(20.0, cell.height()));
    let mut label_rect = cell.with_min_x(box_rect.left());
    if station.is_station() {
        let mut is_enabled = station.is_enabled;
        let layout = Layout::left_to_right(Align::Center);
        let mut inside = ui.new_child(UiBuilder::new().max_rect(box_rect).layout(layout));
        inside.spacing_mut().interact_size = vec2(18.0, 18.0);
        let tick = inside.add(Checkbox::without_text(&mut is_enabled));
        let name = text::use_station(&station.label, method);
        tick.widget_info(|| WidgetInfo::selected(Role::CheckBox, true, is_enabled, &name));
        if tick.changed() {
            commands.push(Command::SetStationEnabled { station_idx, enabled: is_enabled });
        }
        label_rect = cell.with_min_x(box_rect.right() + 2.0);
    }
    let response = ui.interact(label_rect, ui.scope_id().with(("station", method, station_idx)), Sense::click());
    let name = text::station_row(&station.label, method);
    response.widget_info(|| WidgetInfo::selected(Role::Button, true, selection.station_idx == station_idx, &name));
    let painter = ui.painter().with_clip_rect(label_rect.intersect(ui.clip_rect()));
    let color = if station.is_enabled { palette.text } else { palette.text_dim };
    let font = egui::FontId::proportional(theme::BODY_SIZE);
    painter.text(label_rect.left_center(), Align2::LEFT_CENTER, &station.label, font, color);
    if response.clicked() && selection.station_idx != station_idx {
        selection.station_idx = station_idx;
        selection.capture_idx = 0;
    }
}

fn footer(ui: &mut Ui, table: &MethodTable) {
    let Some(truth) = &table.truth else { return };
    let mut row = RowCells::new(ui, theme::ROW_HEIGHT);
    let width = row.rect().width();
    row.head(width * 0.36, text::FROM_TRUTH, Align2::LEFT_CENTER);
    let figures =
        text::truth_figures(&coordinate(truth.workspace_point_mm), &widgets::fixed(truth.rotation_rad.to_degrees(), 3));
    let color = theme::palette(row.ui()).text;
    row.word(width * 0.64, &figures, color);
}

fn matrix(ui: &mut Ui, table: &MethodTable) {
    let title = match table.mount {
        Mount::OnFlange => text::FLANGE_FROM_SENSOR,
        Mount::Fixed => text::BASE_FROM_SENSOR,
    };
    let mut row = RowCells::new(ui, theme::ROW_HEIGHT);
    let width = row.rect().width();
    row.head(width, title, Align2::LEFT_CENTER);
    for line in 0..4 {
        let mut row = RowCells::new(ui, theme::ROW_HEIGHT);
        for column in 0..4 {
            let value = table.matrix[(line, column)];
            let text = match (line, column) {
                (3, _) => widgets::fixed(value, 0),
                (_, 3) => coordinate(value),
                _ => widgets::fixed(value, 6),
            };
            row.number(width / 4.0, value, &text, Color32::TRANSPARENT);
        }
    }
}
