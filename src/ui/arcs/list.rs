//! The list of stations and their steps.

use std::collections::BTreeSet;

use egui::{Align2, Color32, FontId, Id, Rect, Role, ScrollArea, Sense, Ui, WidgetInfo, pos2, vec2};

use crate::text::arcs as text;
use crate::text::edges::edge_name;
use crate::ui::{Selection, theme, widgets};

use super::model::{CaptureRow, StationRow};

/// What the columns show.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Columns {
    /// Steps, section radius and RMS, of a ball.
    Arcs,
    /// Edge, and where the point is in the laser plane; of a plate.
    EdgePoints,
    /// The same without edges, of a tip.
    Tips,
    /// Points and depth, of a scan.
    Scans,
}

/// What the list tells the panel.
#[derive(Clone, Copy, Debug, Default)]
pub struct ListResponse {
    /// The step of the selected station under the pointer.
    pub hovered_capture: Option<usize>,
}

#[derive(Clone, Copy)]
enum Line {
    Station(usize),
    Capture(usize, usize),
}

/// Right edges of the columns as parts of the width, so that the list can be narrowed.
const STEPS_RIGHT: f32 = 0.40;
const RADIUS_RIGHT: f32 = 0.68;
const RMS_RIGHT: f32 = 0.87;
const STATUS_CENTRE: f32 = 0.94;
const EDGE_RIGHT: f32 = 0.33;
const X_RIGHT: f32 = 0.58;
const Z_RIGHT: f32 = 0.87;
const NUMBER_RIGHT: f32 = 0.36;
const POINTS_RIGHT: f32 = 0.60;
const DEPTH_RIGHT: f32 = 0.87;

/// Shows the list; `reveal` scrolls to the selected row.
pub fn show(
    ui: &mut Ui,
    rows: &[StationRow],
    columns: Columns,
    expanded: &mut BTreeSet<usize>,
    selection: &mut Selection,
    reveal: bool,
    from_top: &mut widgets::FromTop,
) -> ListResponse {
    ui.spacing_mut().item_spacing.y = 0.0;
    head(ui, columns);
    let mut lines = Vec::new();
    for (station_idx, row) in rows.iter().enumerate() {
        lines.push(Line::Station(station_idx));
        if expanded.contains(&station_idx) {
            lines.extend((0..row.captures.len()).map(|capture_idx| Line::Capture(station_idx, capture_idx)));
        }
    }
    let mut response = ListResponse::default();
    let scroll_area = from_top.apply(ScrollArea::vertical().id_salt("arcs stations").auto_shrink([false, false]));
    scroll_area.show_rows(ui, theme::ROW_HEIGHT, lines.len(), |ui, range| {
        ui.spacing_mut().item_spacing.y = 0.0;
        if reveal && let Some(line_idx) = selected_line(&lines, expanded, selection) {
            scroll_to(ui, line_idx, range.start);
        }
        for line in &lines[range] {
            match *line {
                Line::Station(station_idx) => {
                    station_line(ui, station_idx, &rows[station_idx], columns, expanded, selection);
                }
                Line::Capture(station_idx, capture_idx) => {
                    let row = &rows[station_idx];
                    if capture_line(ui, station_idx, capture_idx, row, columns, selection) {
                        response.hovered_capture = Some(capture_idx);
                    }
                }
            }
        }
    });
    response
}

fn selected_line(lines: &[Line], expanded: &BTreeSet<usize>, selection: &Selection) -> Option<usize> {
    lines.iter().position(|line| match *line {
        Line::Station(station_idx) => {
            station_idx == selection.station_idx && !expanded.contains(&selection.station_idx)
        }
        Line::Capture(station_idx, capture_idx) => {
            (station_idx, capture_idx) == (selection.station_idx, selection.capture_idx)
        }
    })
}

#[expect(clippy::cast_precision_loss, reason = "rows of a list on a screen")]
fn scroll_to(ui: &Ui, line_idx: usize, first_idx: usize) {
    let top = ui.min_rect().top() + (line_idx as f32 - first_idx as f32) * theme::ROW_HEIGHT;
    let row = Rect::from_min_size(pos2(ui.min_rect().left(), top), vec2(1.0, theme::ROW_HEIGHT));
    ui.scroll_to_rect(row, None);
}

fn head(ui: &mut Ui, columns: Columns) {
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), theme::ROW_HEIGHT), Sense::hover());
    let palette = theme::palette(ui);
    let columns = match columns {
        Columns::Arcs => [
            (STEPS_RIGHT, text::STEPS, ""),
            (RADIUS_RIGHT, text::SECTION_RADIUS, text::SECTION_RADIUS_HINT),
            (RMS_RIGHT, text::RMS, text::RMS_HINT),
        ],
        Columns::EdgePoints => [
            (EDGE_RIGHT, text::EDGE, text::EDGE_HINT),
            (X_RIGHT, text::POINT_X, text::POINT_HINT),
            (Z_RIGHT, text::POINT_Z, text::POINT_HINT),
        ],
        Columns::Scans => [
            (NUMBER_RIGHT, "", ""),
            (POINTS_RIGHT, text::POINTS, text::POINTS_HINT),
            (DEPTH_RIGHT, text::DEPTH, text::DEPTH_HINT),
        ],
        Columns::Tips => {
            [(EDGE_RIGHT, "", ""), (X_RIGHT, text::POINT_X, text::TIP_HINT), (Z_RIGHT, text::POINT_Z, text::TIP_HINT)]
        }
    };
    let mut left = rect.left();
    for (right, name, hint) in columns {
        let right = rect.left() + right * rect.width();
        let font = FontId::proportional(theme::SMALL_SIZE);
        ui.painter().text(pos2(right, rect.center().y), Align2::RIGHT_CENTER, name, font, palette.text_dim);
        let cell = Rect::from_min_max(pos2(left, rect.top()), pos2(right, rect.bottom()));
        if !hint.is_empty() {
            ui.interact(cell, ui.scope_id().with(name), Sense::hover()).on_hover_text(hint);
        }
        left = right;
    }
    ui.painter().hline(rect.x_range(), rect.bottom(), egui::Stroke::new(1.0, palette.hairline));
}

struct Figures<'a> {
    /// Their right edges and what stands there.
    cells: [(f32, String); 3],
    problem: Option<&'a str>,
    is_enabled: bool,
}

fn figures(ui: &Ui, rect: Rect, row: &Figures<'_>) {
    let palette = theme::palette(ui);
    let color = if row.is_enabled { palette.text } else { palette.text_dim };
    let number = |right: f32, text: &str| {
        let at = pos2(rect.left() + right * rect.width(), rect.center().y);
        ui.painter().text(at, Align2::RIGHT_CENTER, text, theme::number_font(), color);
    };
    for (right, words) in &row.cells {
        number(*right, words);
    }
    let (mark, mark_color): (&str, Color32) = match (row.is_enabled, row.problem) {
        (false, _) => ("–", palette.text_dim),
        (true, Some(_)) => ("!", palette.warn),
        (true, None) => ("✔", palette.good),
    };
    let at = pos2(rect.left() + STATUS_CENTRE * rect.width(), rect.center().y);
    ui.painter().text(at, Align2::CENTER_CENTER, mark, FontId::proportional(theme::BODY_SIZE), mark_color);
    ui.painter().hline(rect.x_range(), rect.bottom(), egui::Stroke::new(1.0, palette.hairline));
}

fn arc_cells(steps: String, radius_mm: Option<f64>, rms_mm: Option<f64>) -> [(f32, String); 3] {
    [
        (STEPS_RIGHT, steps),
        (RADIUS_RIGHT, figure(radius_mm, 2)),
        (RMS_RIGHT, figure(rms_mm.map(|rms_mm| rms_mm * 1000.0), 1)),
    ]
}

fn point_cells(first: String, point_mm: Option<[f64; 2]>) -> [(f32, String); 3] {
    let [x, z] = [0, 1].map(|axis| figure(point_mm.map(|point| point[axis]), 2));
    [(EDGE_RIGHT, first), (X_RIGHT, x), (Z_RIGHT, z)]
}

fn scan_cells(first: String, captures: &[CaptureRow]) -> [(f32, String); 3] {
    let lines = || captures.iter().filter_map(|capture| capture.scan);
    let num_points = (lines().count() > 0).then(|| lines().map(|line| line.num_valid).sum::<usize>());
    let points = num_points.map_or_else(|| figure(None, 0), |num| num.to_string());
    [(NUMBER_RIGHT, first), (POINTS_RIGHT, points), (DEPTH_RIGHT, figure(depth_mm(captures), 1))]
}

/// From the nearest to the farthest point of some profiles.
fn depth_mm(captures: &[CaptureRow]) -> Option<f64> {
    let ranges = captures.iter().filter_map(|capture| Some(capture.scan?.range_mm?.z_mm));
    let [low, high] = ranges.reduce(|[low, high], [near, far]| [low.min(near), high.max(far)])?;
    Some(high - low)
}

fn figure(value: Option<f64>, decimals: usize) -> String {
    value.map_or_else(|| "–".to_owned(), |value| widgets::fixed(value, decimals))
}

fn line(ui: &mut Ui, is_selected: bool, is_enabled: bool, name: &str, problem: Option<&str>) -> egui::Response {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), theme::ROW_HEIGHT), Sense::click());
    response.widget_info(|| WidgetInfo::selected(Role::ListBoxOption, is_enabled, is_selected, name));
    let palette = theme::palette(ui);
    if is_selected {
        ui.painter().rect_filled(rect, 0.0, palette.selected);
    } else if response.hovered() {
        ui.painter().rect_filled(rect, 0.0, palette.hovered);
    }
    if response.has_focus() {
        // Arrow keys move the selection here, not the focus.
        let filter = egui::EventFilter { horizontal_arrows: true, vertical_arrows: true, ..Default::default() };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, filter));
    }
    match problem {
        Some(problem) => response.on_hover_text(problem),
        None => response,
    }
}

fn station_line(
    ui: &mut Ui,
    station_idx: usize,
    row: &StationRow,
    columns: Columns,
    expanded: &mut BTreeSet<usize>,
    selection: &mut Selection,
) {
    let is_selected = selection.station_idx == station_idx;
    let response = line(ui, is_selected, true, &text::station_name(&row.label), row.problem.as_deref());
    let rect = response.rect;
    figures(
        ui,
        rect,
        &Figures {
            cells: match columns {
                Columns::Arcs => arc_cells(row.captures.len().to_string(), row.section_radius_mm, row.rms_mm),
                Columns::EdgePoints | Columns::Tips => point_cells(
                    row.edge.map_or_else(String::new, |edge| edge_name(edge).to_owned()),
                    row.captures.iter().find_map(|capture| capture.point_mm),
                ),
                Columns::Scans => scan_cells(String::new(), &row.captures),
            },
            problem: row.problem.as_deref(),
            is_enabled: row.is_enabled,
        },
    );
    let palette = theme::palette(ui);
    let color = if row.is_enabled { palette.text } else { palette.text_dim };
    let label_right = match columns {
        Columns::Arcs => STEPS_RIGHT - 0.12,
        Columns::Scans => POINTS_RIGHT - 0.18,
        Columns::EdgePoints | Columns::Tips => EDGE_RIGHT - 0.08,
    };
    let clip = Rect::from_min_max(rect.min, pos2(rect.left() + label_right * rect.width(), rect.bottom()));
    ui.painter().with_clip_rect(clip.intersect(ui.clip_rect())).text(
        rect.left_center() + vec2(24.0, 0.0),
        Align2::LEFT_CENTER,
        &row.label,
        FontId::proportional(theme::BODY_SIZE),
        color,
    );
    if row.captures.len() > 1 {
        let handle = Rect::from_min_size(rect.min, vec2(22.0, rect.height()));
        let toggle = ui.interact(handle, Id::unique(("arcs expand", station_idx)), Sense::click());
        toggle.widget_info(|| WidgetInfo::labeled(Role::DisclosureTriangle, true, text::expand(&row.label)));
        let is_expanded = expanded.contains(&station_idx);
        let sign = if is_expanded { "▼" } else { "▶" };
        ui.painter().text(handle.center(), Align2::CENTER_CENTER, sign, FontId::proportional(9.0), palette.text_dim);
        if toggle.clicked() && !expanded.remove(&station_idx) {
            expanded.insert(station_idx);
        }
    }
    if response.clicked() && !is_selected {
        selection.station_idx = station_idx;
        selection.capture_idx = 0;
    }
}

fn capture_line(
    ui: &mut Ui,
    station_idx: usize,
    capture_idx: usize,
    station: &StationRow,
    columns: Columns,
    selection: &mut Selection,
) -> bool {
    let row: &CaptureRow = &station.captures[capture_idx];
    let is_selected = (selection.station_idx, selection.capture_idx) == (station_idx, capture_idx);
    let name = text::step_name(&station.label, capture_idx + 1);
    let response = line(ui, is_selected, true, &name, row.problem.as_deref());
    figures(
        ui,
        response.rect,
        &Figures {
            cells: match columns {
                Columns::Arcs => arc_cells((capture_idx + 1).to_string(), row.section_radius_mm, row.rms_mm),
                Columns::EdgePoints | Columns::Tips => point_cells((capture_idx + 1).to_string(), row.point_mm),
                Columns::Scans => scan_cells((capture_idx + 1).to_string(), std::slice::from_ref(row)),
            },
            problem: row.problem.as_deref(),
            is_enabled: station.is_enabled,
        },
    );
    if response.clicked() {
        selection.station_idx = station_idx;
        selection.capture_idx = capture_idx;
    }
    response.hovered() && selection.station_idx == station_idx
}
