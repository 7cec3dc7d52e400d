//! Copying cells to the clipboard, and taking from it.

use crate::app::Command;
use crate::session::table::block::{block_text, is_for_import, parse_block};
use crate::session::table::paste::{Spot, paste};
use crate::session::table::{Column, TypedCell, column_name, column_unit, has_cell};
use crate::session::{Edit, Session};
use crate::text::poses as words;

use super::cursor::Cursor;
use super::sheet::{Sheet, push};

impl Sheet {
    /// The selected cells as text for spreadsheets; the whole table with a line of names.
    #[must_use]
    pub fn copied(&self, session: &Session) -> String {
        let (rows, columns) = (self.selected_rows(), self.selected_columns());
        let mut block = Vec::with_capacity(rows.len() + 1);
        let is_whole = rows.len() == self.view.rows.len() && columns.len() == self.view.columns.len() && rows.len() > 1;
        if is_whole {
            let notation = &session.robot.notation;
            let head = |column: &Column| match column_unit(notation, *column) {
                "" => column_name(notation, *column).to_owned(),
                unit => format!("{} ({unit})", column_name(notation, *column)),
            };
            block.push(columns.iter().map(head).collect());
        }
        for row in rows {
            let cell = |column: &Column| {
                let is_there = has_cell(session, row, *column);
                if is_there { self.text(session, row.place(), *column) } else { String::new() }
            };
            block.push(columns.iter().map(cell).collect());
        }
        block_text(&block)
    }

    /// Takes a text from the clipboard: cells for the table, or something for the import.
    pub fn paste(&mut self, session: &Session, text: &str, commands: &mut Vec<Command>) {
        // Into an empty table nothing can be placed by its neighbours: the preview shows what becomes of it.
        if is_for_import(text) || session.stations.is_empty() {
            commands.push(Command::ImportText(text.to_owned()));
            return;
        }
        let block = match parse_block(text) {
            Ok(block) => block,
            Err(refusal) => {
                self.said = Some(words::not_pasted(&refusal));
                return;
            }
        };
        let rows = self.cursor.rows();
        let columns = self.cursor.columns(self.view.columns.len());
        let column_idx = if self.cursor.has_whole_rows { 0 } else { *columns.start() };
        if let ([line], true) = (&block[..], rows.len() > 1 || columns.clone().count() > line_len(&block)) {
            self.paste_line(session, line, commands);
            return;
        }
        let row_idx = if self.view.rows.is_empty() { 0 } else { rows.first().copied().unwrap_or(0) };
        let spot = Spot { rows: &self.view.rows, columns: &self.view.columns, row_idx, column_idx };
        let pasted = paste(session, &spot, &block);
        for (place, column) in &pasted.overwritten {
            self.pending.forget(session, *place, *column);
        }
        for (label, refused) in &pasted.refused {
            self.pending.insert(label.clone(), refused);
        }
        for label in &pasted.held_back {
            self.pending.hold_back(label.clone());
        }
        let [num_rows, num_columns] = pasted.size;
        self.said = Some(words::pasted(
            [num_rows, num_columns],
            pasted.refused.len(),
            pasted.held_back.len(),
            pasted.num_left_out,
        ));
        let mut edits: Vec<Edit> = pasted.edit.into_iter().collect();
        let released = self.released(session, pasted.overwritten.iter().map(|(place, _)| *place).collect());
        if !released.is_empty() {
            edits.push(Edit::SetCells(released));
        }
        match edits.len() {
            0 => {}
            1 => edits.into_iter().for_each(|edit| push(edit, commands)),
            _ => push(Edit::Several(edits), commands),
        }
        let last_column = (column_idx + num_columns).min(self.view.columns.len()).saturating_sub(1);
        // With the corner that was pasted to as the cursor, so that typing goes on there.
        let mut cursor = Cursor::at((row_idx + num_rows).saturating_sub(1), last_column);
        cursor.go_to(row_idx, column_idx, true);
        self.next_cursor = Some(cursor);
    }

    /// One line of values into each of the selected rows, over and over if more columns are selected.
    fn paste_line(&mut self, session: &Session, line: &[String], commands: &mut Vec<Command>) {
        let first = if self.cursor.has_whole_rows { 0 } else { *self.cursor.columns(self.view.columns.len()).start() };
        let width = if line.len() == 1 { self.selected_columns().len() } else { line.len() };
        let columns = &self.view.columns[first..(first + width).min(self.view.columns.len())];
        let rows = self.selected_rows();
        let mut typed = Vec::new();
        let mut num_left_out = 0;
        for row in &rows {
            for (column, text) in columns.iter().zip(line.iter().cycle()) {
                if !has_cell(session, *row, *column) {
                    // One value for many cells goes to those that there are.
                    num_left_out += usize::from(line.len() > 1 && !text.is_empty());
                } else if column.can_be_empty() || !text.is_empty() {
                    typed.push(TypedCell { place: row.place(), column: *column, text: text.clone() });
                }
            }
            num_left_out += line.iter().skip(columns.len()).filter(|text| !text.is_empty()).count();
        }
        let size = [rows.len(), columns.len()];
        self.enter(session, typed, commands);
        if num_left_out > 0 {
            let num_refused = rows.iter().map(|row| self.pending.of_place(session, row.place()).len()).sum();
            self.said = Some(words::pasted(size, num_refused, 0, num_left_out));
        }
    }
}

fn line_len(block: &[Vec<String>]) -> usize {
    block.first().map_or(0, Vec::len)
}
