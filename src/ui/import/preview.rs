//! The preview's right side: the table with what each column means, what was left out, and the raw text where nothing
//! could be read.

use std::collections::{BTreeMap, BTreeSet};

use egui::{Align, CornerRadius, Label, Layout, RichText, ScrollArea, Ui, UiBuilder, vec2};
use egui_extras::{Column, TableRow};

use crate::app::ImportDraft;
use crate::session::import::{ImportError, ImportOptions, Imported, Note, Role};
use crate::text::import as words;
use crate::ui::theme;
use crate::ui::widgets::tables::table;
use crate::ui::widgets::{card_with_height, number_text};

use super::{fields, model};

/// Height of the table's head: the list of roles, and the column's own name.
const HEAD_HEIGHT: f32 = 52.0;
/// Width of a column at least, points.
const MIN_COLUMN_WIDTH: f32 = 88.0;
/// Width of a column at most, points.
const MAX_COLUMN_WIDTH: f32 = 200.0;
/// Width of a figure, points.
const CHAR_WIDTH: f32 = 7.4;
/// Room that a list over a column needs beside its text, points.
const LIST_WIDTH: f32 = 52.0;
/// Width of the line numbers, points.
const LINE_WIDTH: f32 = 56.0;
/// Height of the list of problems and notes at most, as a part of the whole.
const MAX_REMARKS_PART: f32 = 0.35;
/// Height of a line of it, points.
const REMARK_HEIGHT: f32 = 22.0;
/// Height of a line of text in a list, points.
const LINE_HEIGHT: f32 = 16.0;

/// Draws what was read; answers the options with another meaning of a column.
pub fn show(ui: &mut Ui, draft: &ImportDraft, imported: &Imported) -> Option<ImportOptions> {
    let num_remarks = notes(imported).count() + imported.problems.len();
    let height = ui.available_height();
    let remarks_height = match num_remarks {
        0 => 0.0,
        _ => (lines_height(num_remarks) + 40.0).min(height * MAX_REMARKS_PART),
    };
    let gap = if num_remarks > 0 { theme::GAP } else { 0.0 };
    let preview = &imported.preview;
    let rows = words::more_rows(preview.rows.len(), preview.num_rows);
    let changed = card_with_height(
        ui,
        words::PREVIEW,
        height - remarks_height - gap,
        |ui| {
            ui.label(theme::dim(ui, rows).small());
        },
        |ui| ScrollArea::horizontal().id_salt("import columns").show(ui, |ui| columns(ui, draft, imported)).inner,
    );
    if num_remarks > 0 {
        ui.add_space(gap - ui.spacing().item_spacing.y);
        remarks(ui, imported, ui.available_height());
    }
    changed
}

/// What to know beside the table; what became of a bag stands with its topics.
fn notes(imported: &Imported) -> impl Iterator<Item = &Note> {
    imported.notes.iter().filter(|note| !matches!(note, Note::Bag(_)))
}

#[expect(clippy::cast_precision_loss, reason = "at most some hundred lines")]
const fn lines_height(num_lines: usize) -> f32 {
    num_lines as f32 * REMARK_HEIGHT
}

#[expect(clippy::cast_precision_loss, reason = "widths of texts, clamped")]
fn column_width(chars: usize, role_chars: usize) -> f32 {
    let of_cells = (chars as f32).mul_add(CHAR_WIDTH, 16.0).clamp(MIN_COLUMN_WIDTH, MAX_COLUMN_WIDTH);
    of_cells.max((role_chars as f32).mul_add(CHAR_WIDTH, LIST_WIDTH)).round()
}

/// What the role of a column is called.
fn role_text(imported: &Imported, role: Role) -> String {
    let notation = imported.options.notation.unwrap_or_default();
    words::role(role, &notation, imported.options.profile_length_unit.unwrap_or_default())
}

fn role_of(imported: &Imported, column: usize) -> Role {
    imported.preview.roles.get(column).copied().unwrap_or(Role::Ignore)
}

fn columns(ui: &mut Ui, draft: &ImportDraft, imported: &Imported) -> Option<ImportOptions> {
    let preview = &imported.preview;
    let marked = model::marked_cells(imported, &draft.sources);
    let role_chars = |column| role_text(imported, role_of(imported, column)).chars().count();
    let widths: Vec<f32> = (model::column_chars(preview).into_iter().enumerate())
        .map(|(column, chars)| column_width(chars, role_chars(column)))
        .collect();
    ui.spacing_mut().item_spacing.x = 0.0;
    let mut builder = table(ui, ("import preview", draft.id, widths.len())).column(Column::exact(LINE_WIDTH));
    for width in &widths {
        builder = builder.column(Column::exact(*width).clip(true));
    }
    let mut changed = None;
    builder
        .column(Column::remainder())
        .header(HEAD_HEIGHT, |mut header| {
            header.col(|ui| {
                ui.add_space(8.0);
                ui.label(theme::dim(ui, words::LINE).small());
            });
            for column in 0..widths.len() {
                header.col(|ui| changed = head(ui, draft, imported, column).or(changed.take()));
            }
            header.col(|_| {});
        })
        .body(|body| {
            body.rows(theme::ROW_HEIGHT, preview.rows.len(), |mut row| {
                row.set_overline(true);
                cells(&mut row, imported, &marked, widths.len());
            });
        });
    changed
}

/// What a column means, over its own name.
fn head(ui: &mut Ui, draft: &ImportDraft, imported: &Imported, column: usize) -> Option<ImportOptions> {
    let role = role_of(imported, column);
    let mut picked = None;
    let rect = ui.max_rect();
    let split = rect.top() + 2.0 + fields::CONTROL_HEIGHT;
    let layout = cell_layout(role);
    let row = |rect: egui::Rect, layout| UiBuilder::new().max_rect(rect.shrink2(vec2(4.0, 0.0))).layout(layout);
    let text = |role| role_text(imported, role);
    let above = rect.with_min_y(rect.top() + 2.0).with_max_y(split);
    if model::has_free_roles(imported) {
        let ui = &mut ui.new_child(row(above, Layout::left_to_right(Align::Center)));
        ui.spacing_mut().button_padding.x = 8.0;
        let choices = model::role_choices(&imported.options.notation.unwrap_or_default());
        picked = fields::choice(ui, &words::column_role(column + 1), role, &choices, text);
    } else {
        let ui = &mut ui.new_child(row(above, layout));
        ui.add_space(4.0);
        let color = if role == Role::Ignore { theme::palette(ui).text_dim } else { theme::palette(ui).text };
        ui.label(RichText::new(text(role)).color(color));
    }
    let ui = &mut ui.new_child(row(rect.with_min_y(split), layout));
    ui.add_space(4.0);
    let name = imported.preview.header.get(column).map_or("", String::as_str);
    ui.add(Label::new(theme::dim(ui, name).small()).truncate());
    let roles = &imported.preview.roles;
    picked.map(|role| ImportOptions { roles: Some(model::with_role(roles, column, role)), ..draft.options.clone() })
}

/// Numbers stand at the right of their columns, texts at the left.
fn cell_layout(role: Role) -> Layout {
    match role {
        Role::Label | Role::Side | Role::Edge | Role::Used | Role::Profile | Role::Notation => {
            Layout::left_to_right(Align::Center)
        }
        _ => Layout::right_to_left(Align::Center),
    }
}

fn cells(
    row: &mut TableRow<'_, '_>,
    imported: &Imported,
    marked: &BTreeMap<usize, BTreeSet<usize>>,
    num_columns: usize,
) {
    let row_idx = row.index();
    let Some((line, cells)) = imported.preview.rows.get(row_idx) else { return };
    let marks = marked.get(&row_idx);
    row.col(|ui| {
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            ui.add_space(12.0);
            ui.label(number_text(line.to_string()).color(theme::palette(ui).text_dim));
            if marks.is_some() {
                ui.add_space(4.0);
                ui.label(RichText::new("✖").color(theme::palette(ui).bad).small());
            }
        });
    });
    for column in 0..num_columns {
        row.col(|ui| {
            let Some(cell) = cells.get(column) else { return };
            let palette = theme::palette(ui);
            let role = role_of(imported, column);
            let is_marked = marks.is_some_and(|marks| marks.contains(&column));
            if is_marked {
                let ground = ui.max_rect().shrink2(vec2(1.0, 1.0));
                ui.painter().rect_filled(ground, CornerRadius::same(theme::RADIUS), palette.bad.gamma_multiply(0.15));
            }
            let color = match role {
                _ if is_marked => palette.bad,
                Role::Ignore => palette.text_dim.gamma_multiply(0.7),
                _ => palette.text,
            };
            let text = number_text(cell.as_str()).color(color);
            ui.with_layout(cell_layout(role), |ui| {
                ui.add_space(8.0);
                ui.add(Label::new(text).truncate());
            });
        });
    }
    row.col(|_| {});
}

/// What was left out and what else to know.
fn remarks(ui: &mut Ui, imported: &Imported, height: f32) {
    let count = match imported.num_problems {
        0 => String::new(),
        num_problems => words::problems(imported.problems.len(), num_problems),
    };
    card_with_height(
        ui,
        words::NOTES,
        height,
        |ui| {
            ui.label(theme::dim(ui, count).small());
        },
        |ui| {
            ScrollArea::vertical().id_salt("import remarks").auto_shrink(false).show(ui, |ui| {
                egui::Frame::new().inner_margin(egui::Margin::symmetric(12, 4)).show(ui, |ui| {
                    let palette = theme::palette(ui);
                    for note in notes(imported) {
                        fields::marked(ui, "!", palette.warn, &words::note(note));
                    }
                    for problem in &imported.problems {
                        fields::marked(ui, "✖", palette.bad, &problem.to_string());
                    }
                });
            });
        },
    );
}

/// Where nothing could be read: why, what could be, and how the text begins.
pub fn show_error(ui: &mut Ui, draft: &ImportDraft, error: &ImportError) {
    let is_empty = draft.sources.iter().all(|source| source.text().trim().is_empty() && source.bag().is_none());
    let is_pasted = draft.sources.iter().any(|source| source.name == words::PASTED);
    let height = ui.available_height();
    ScrollArea::vertical().id_salt("import error").auto_shrink(false).max_height(height).show(ui, |ui| {
        if is_empty && is_pasted {
            ui.label(words::CLIPBOARD_EMPTY);
        } else {
            fields::marked(ui, "✖", theme::palette(ui).bad, &error.to_string());
        }
        ui.add_space(8.0);
        if !is_empty || !is_pasted {
            ui.label(words::CHOOSE_FORM);
        }
        egui::Grid::new("import forms").num_columns(2).min_row_height(LINE_HEIGHT).spacing([16.0, 4.0]).show(
            ui,
            |ui| {
                for (kind, description) in words::FORMS {
                    ui.label(words::kind(kind));
                    ui.add(Label::new(theme::dim(ui, description)));
                    ui.end_row();
                }
            },
        );
        if is_pasted && !is_empty {
            ui.add_space(4.0);
            ui.label(theme::dim(ui, words::PASTE_AGAIN));
        }
        let lines = model::beginning(&draft.sources);
        if !is_empty {
            ui.add_space(12.0);
            raw_text(ui, &lines);
        }
    });
}

fn raw_text(ui: &mut Ui, lines: &[String]) {
    ui.label(theme::strong(words::BEGINNING));
    ui.add_space(4.0);
    ScrollArea::horizontal().id_salt("import raw text").show(ui, |ui| {
        egui::Grid::new("import raw lines").num_columns(2).min_row_height(LINE_HEIGHT).spacing([12.0, 2.0]).show(
            ui,
            |ui| {
                for (idx, line) in lines.iter().enumerate() {
                    ui.label(theme::dim(ui, (idx + 1).to_string()).font(theme::number_font()));
                    ui.add(Label::new(RichText::new(line).family(egui::FontFamily::Monospace).small()).extend());
                    ui.end_row();
                }
            },
        );
    });
}
