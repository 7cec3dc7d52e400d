//! What the pose table does with what it is asked: each of these ends in at most one edit of the document.

use std::collections::{BTreeSet, HashSet};
use std::sync::Arc;

use crate::app::{Command, Document};
use crate::session::edit::{CellValue, free_label};
use crate::session::table::fill::{fill_down, next_label};
use crate::session::table::order::order_by;
use crate::session::table::paste::{no_reading, station_without_reading};
use crate::session::table::{self, Column, TypedCell, has_cell, read_cells};
use crate::session::{Edit, Place, Reading, Row, Session, Station};
use crate::text::poses as words;

use super::ask::Ask;
use super::cursor::Cursor;
use super::editor::{Choice, Editor};
use super::pending::Pending;
use super::view::View;

/// The table's own state: what is shown, selected, being edited and waiting.
#[derive(Clone, Debug, Default)]
pub struct Sheet {
    /// Rows and columns.
    pub view: View,
    /// The cell cursor.
    pub cursor: Cursor,
    /// The cell being edited.
    pub editor: Option<Editor>,
    /// The list of choices that is open.
    pub choice: Option<Choice>,
    /// Texts that are not in the document.
    pub pending: Pending,
    /// What the last action did, where that cannot be seen.
    pub said: Option<String>,
    /// Whether the cursor is to be brought into view.
    pub brings_into_view: bool,
    /// Whether the keyboard goes to the table at the end of the frame.
    pub takes_keyboard: bool,
    /// The sweep to be folded or unfolded once the frame is drawn.
    pub folds: Option<String>,
    /// Stations to be selected once the document has them.
    selects: Option<BTreeSet<usize>>,
    /// What was asked for, to be done once the document has what was typed before.
    pub(super) asked: Option<Ask>,
    /// The cells to be selected once the document has them.
    pub(super) next_cursor: Option<Cursor>,
    num_editors: u64,
}

impl Sheet {
    /// Follows the document: an editor that was opened on another revision closes without a word.
    pub fn refresh(&mut self, document: &Document) {
        if let Some(before) = self.view.refresh(document) {
            self.pending.follow(&before, &document.session);
        }
        if self.editor.as_ref().is_some_and(|editor| editor.revision != document.revision) {
            self.editor = None;
        }
        if self.choice.as_ref().is_some_and(|choice| choice.revision != document.revision) {
            self.choice = None;
        }
        if let Some(stations) = self.selects.take() {
            let row_of = |station_idx| self.view.row_of(Place { station_idx, capture_idx: 0 });
            let rows: BTreeSet<usize> = stations.into_iter().filter_map(row_of).collect();
            if let (Some(first), Some(last)) = (rows.first().copied(), rows.last().copied()) {
                self.cursor = if first == last {
                    Cursor::at(first, self.cursor.column)
                } else if last - first + 1 == rows.len() {
                    Cursor::over_rows(&(first..=last), self.cursor.column)
                } else {
                    Cursor::over_picked_rows(rows, self.cursor.column)
                };
                self.brings_into_view = true;
            }
        }
        if let Some(cursor) = self.next_cursor.take() {
            self.cursor = cursor;
            self.brings_into_view = true;
        }
        self.cursor.clamp(self.view.rows.len(), self.view.columns.len());
    }

    fn session(&self) -> Option<Arc<Session>> {
        self.view.session.clone()
    }

    /// The row and the column of the cursor.
    #[must_use]
    pub fn cell(&self) -> Option<(Row, Column)> {
        Some((*self.view.rows.get(self.cursor.row)?, *self.view.columns.get(self.cursor.column)?))
    }

    pub(super) fn selected_rows(&self) -> Vec<Row> {
        self.cursor.rows().into_iter().filter_map(|row| self.view.rows.get(row).copied()).collect()
    }

    pub(super) fn selected_columns(&self) -> Vec<Column> {
        let columns = self.cursor.columns(self.view.columns.len());
        self.view.columns.get(columns).map(<[Column]>::to_vec).unwrap_or_default()
    }

    /// The stations of the selected rows, from top to bottom.
    fn selected_stations(&self) -> Vec<usize> {
        let mut stations: Vec<usize> = self.selected_rows().iter().map(|row| row.place().station_idx).collect();
        stations.dedup();
        stations
    }

    /// Folds or unfolds a sweep; the cursor stays on its row.
    pub fn fold(&mut self, label: &str) {
        let place = self.cell().map(|(row, _)| row.place());
        self.view.toggle(label);
        self.stay_on(place);
    }

    /// Folds or unfolds all sweeps; the cursor stays on its row.
    pub fn fold_all(&mut self, is_unfolded: bool) {
        let place = self.cell().map(|(row, _)| row.place());
        self.view.set_all_unfolded(is_unfolded);
        self.stay_on(place);
    }

    fn stay_on(&mut self, place: Option<Place>) {
        if let Some(row) = place.and_then(|place| self.view.row_of(place)) {
            self.cursor = Cursor::at(row, self.cursor.column);
        }
        self.cursor.clamp(self.view.rows.len(), self.view.columns.len());
    }

    /// Goes to a cell, unfolding its sweep.
    pub fn go_to(&mut self, place: Place, column: Column) {
        let station = self.view.session.as_ref().and_then(|session| session.stations.get(place.station_idx));
        let label = station.filter(|station| station.captures.len() > 1).map(|station| station.label.clone());
        if let Some(label) = label.filter(|label| !self.view.is_unfolded(label) && !column.is_of_station()) {
            self.view.toggle(&label);
        }
        let station_row = self.view.rows.iter().position(|row| *row == Row::Station(place.station_idx));
        let row = if column.is_of_station() { station_row } else { self.view.row_of(place) };
        if let (Some(row), Some(column)) = (row, self.view.columns.iter().position(|there| *there == column)) {
            self.cursor = Cursor::at(row, column);
            self.brings_into_view = true;
        }
    }

    /// Moves the cursor by rows and columns, or its rectangle.
    pub fn step(&mut self, rows: isize, columns: isize, extends: bool) {
        let moved = |value: usize, by: isize, len: usize| value.saturating_add_signed(by).min(len.saturating_sub(1));
        let row = moved(self.cursor.row, rows, self.view.rows.len());
        let column = moved(self.cursor.column, columns, self.view.columns.len());
        self.cursor.go_to(row, column, extends);
        self.brings_into_view = true;
    }

    /// The text of a cell as it is edited: what waits there, or what the document has.
    #[must_use]
    pub fn text(&self, session: &Session, place: Place, column: Column) -> String {
        let waiting = self.pending.get(session, place, column);
        waiting.map_or_else(|| table::text(session, place, column), |waiting| waiting.text.clone())
    }

    /// Opens an editor in the cell of the cursor, on its own text or on what was typed.
    pub fn edit(&mut self, document: &Document, typed: Option<&str>, commands: &mut Vec<Command>) {
        let Some((row, column)) = self.cell() else { return };
        let session = &document.session;
        if !has_cell(session, row, column) {
            // A folded sweep opens, as its poses are in the rows of its captures; what is said of a station is in its own.
            self.go_to(row.place(), column);
            if self.cell().is_some_and(|(row, column)| has_cell(session, row, column)) {
                self.edit(document, typed, commands);
            }
            return;
        }
        let choices = table::choices(column);
        let place = row.place();
        let present = self.text(session, place, column);
        if column == Column::Used {
            match typed.map(|text| TypedCell { place, column, text: text.to_owned() }) {
                None => self.toggle_used(session, commands),
                Some(cell) if read_cells(session, std::slice::from_ref(&cell)).refused.is_empty() => {
                    self.enter(session, vec![cell], commands);
                }
                Some(_) => {}
            }
            return;
        }
        if !choices.is_empty() {
            let picked = typed.map(|typed| typed.to_lowercase().replace('−', "-"));
            match picked.and_then(|typed| choices.iter().find(|choice| choice.starts_with(&typed))) {
                Some(choice) => {
                    let cell = TypedCell { place, column, text: (*choice).to_owned() };
                    self.enter(session, vec![cell], commands);
                }
                None if typed.is_none() => {
                    let picked = choices.iter().position(|choice| **choice == present).unwrap_or(0);
                    self.choice = Some(Choice { place, column, picked, revision: document.revision });
                }
                None => {}
            }
            return;
        }
        self.num_editors += 1;
        self.editor = Some(Editor {
            place,
            column,
            text: typed.map_or_else(|| present.clone(), str::to_owned),
            present,
            is_replacing: typed.is_some(),
            is_new: true,
            revision: document.revision,
            number: self.num_editors,
        });
        self.said = None;
    }

    /// Takes what was typed into the open editor.
    pub fn commit(&mut self, commands: &mut Vec<Command>) {
        let (Some(editor), Some(session)) = (self.editor.take(), self.session()) else { return };
        if editor.text == editor.present {
            return;
        }
        let cell = TypedCell { place: editor.place, column: editor.column, text: editor.text };
        self.enter(&session, vec![cell], commands);
    }

    /// Reads typed cells, with what waits beside them: what can be read becomes an edit, the rest waits.
    pub(super) fn enter(&mut self, session: &Session, mut typed: Vec<TypedCell>, commands: &mut Vec<Command>) {
        let mut places: Vec<Place> = typed.iter().map(|cell| cell.place).collect();
        places.sort_unstable();
        places.dedup();
        let is_typed: HashSet<(Place, Column)> = typed.iter().map(|cell| (cell.place, cell.column)).collect();
        for place in &places {
            let waiting = self.pending.of_place(session, *place);
            typed.extend(waiting.into_iter().filter(|cell| !is_typed.contains(&(cell.place, cell.column))));
        }
        let read = read_cells(session, &typed);
        self.pending.update(session, &typed, &read.refused);
        self.said = (read.refused.len() > 1).then(|| words::refused_cells(read.refused.len()));
        let mut values = read.values;
        values.extend(self.released(session, places));
        change(values, commands);
    }

    /// Stations that were left out only until their texts could be read, and take part now.
    pub(super) fn released(&mut self, session: &Session, mut places: Vec<Place>) -> Vec<(Place, CellValue)> {
        places.sort_unstable();
        places.dedup_by_key(|place| place.station_idx);
        let is_complete = |place: &Place| {
            session.stations.get(place.station_idx).is_some_and(|station| self.pending.release(&station.label))
        };
        places.into_iter().filter(is_complete).map(|place| (place, CellValue::Used(true))).collect()
    }

    /// Lets the selected stations take part, or leaves them out: the opposite of the one at the cursor.
    fn toggle_used(&self, session: &Session, commands: &mut Vec<Command>) {
        let station = self.cell().and_then(|(row, _)| session.stations.get(row.place().station_idx));
        if let Some(station) = station {
            self.use_rows(session, !station.enabled, commands);
        }
    }

    /// Lets the selected stations take part, or leaves them out.
    pub fn use_rows(&self, session: &Session, is_used: bool, commands: &mut Vec<Command>) {
        let values = (self.selected_stations().into_iter())
            .filter(|station_idx| session.stations[*station_idx].enabled != is_used)
            .map(|station_idx| (Place { station_idx, capture_idx: 0 }, CellValue::Used(is_used)))
            .collect();
        change(values, commands);
    }

    /// The blank key: the checkbox, or the next choice.
    pub fn toggle(&mut self, document: &Document, commands: &mut Vec<Command>) {
        let Some((row, column)) = self.cell() else { return };
        let choices = table::choices(column);
        if choices.is_empty() || !has_cell(&document.session, row, column) {
            self.toggle_used(&document.session, commands);
        } else {
            let present = self.text(&document.session, row.place(), column);
            let next = choices.iter().position(|choice| **choice == present).map_or(0, |idx| (idx + 1) % choices.len());
            let cell = |row: &Row| TypedCell { place: row.place(), column, text: choices[next].to_owned() };
            let rows = self.selected_rows();
            let typed = rows.iter().filter(|row| has_cell(&document.session, **row, column)).map(cell).collect();
            self.enter(&document.session, typed, commands);
        }
    }

    /// Takes the choice that is picked.
    pub fn choose(&mut self, commands: &mut Vec<Command>) {
        let (Some(choice), Some(session)) = (self.choice.take(), self.session()) else { return };
        if let Some(text) = table::choices(choice.column).get(choice.picked) {
            let cell = TypedCell { place: choice.place, column: choice.column, text: (*text).to_owned() };
            self.enter(&session, vec![cell], commands);
        }
    }

    /// Empties the selected cells where that means something, and throws texts that wait in them away.
    pub fn clear(&mut self, session: &Session, commands: &mut Vec<Command>) {
        let mut values = Vec::new();
        let mut num_kept = 0;
        let columns = self.selected_columns();
        let has_points = columns.iter().any(|column| matches!(column, Column::Point(_)));
        for row in self.selected_rows() {
            let place = row.place();
            let Some(capture) = table::capture_at(session, place) else { continue };
            for column in columns.iter().filter(|column| has_cell(session, row, **column)) {
                let was_waiting = self.pending.forget(session, place, *column);
                match column {
                    Column::Side => values.push((place, CellValue::Side(crate::calibrate::SideChoice::Auto))),
                    Column::Step if capture.step_mm.is_some() => values.push((place, CellValue::Step(None))),
                    Column::Number(_) | Column::Label if !was_waiting => num_kept += 1,
                    _ => {}
                }
            }
            // A coordinate alone means nothing: the point goes as a whole.
            if has_points && matches!(capture.reading, Reading::Point(_)) && has_cell(session, row, Column::Point(0)) {
                values.push((place, CellValue::Reading(no_reading())));
            }
        }
        self.said = (values.is_empty() && num_kept > 0).then(|| words::NOT_CLEARED.to_owned());
        change(values, commands);
    }

    /// A station behind the selected ones, at the same pose and without a reading.
    pub fn add(&mut self, session: &Session, commands: &mut Vec<Command>) {
        let last = self.selected_stations().last().copied();
        let model = last.and_then(|station_idx| session.stations.get(station_idx));
        let taken: HashSet<String> = session.stations.iter().map(|station| station.label.clone()).collect();
        let label = model.map_or_else(|| "1".to_owned(), |station| next_label(&station.label));
        let base_from_flange = model
            .and_then(|station| station.captures.last())
            .map_or_else(crate::geometry::Transform::identity, |capture| capture.base_from_flange);
        let station = Station {
            side: model.map_or_else(crate::calibrate::SideChoice::default, |station| station.side),
            ..station_without_reading(
                free_label(&label, &taken),
                base_from_flange,
                model.and_then(|station| station.edge),
            )
        };
        let at = last.map_or(session.stations.len(), |station_idx| station_idx + 1);
        self.selects = Some(BTreeSet::from([at]));
        push(Edit::InsertStations { at, stations: vec![station] }, commands);
    }

    /// A copy behind each of the selected rows.
    pub fn duplicate(&mut self, commands: &mut Vec<Command>) {
        let mut rows = self.selected_rows();
        // The captures of a station that is copied as a whole are copied with it.
        let whole: HashSet<usize> = stations_among(&rows);
        rows.retain(|row| matches!(row, Row::Station(_)) || !whole.contains(&row.place().station_idx));
        if let [Row::Station(station_idx)] = rows[..] {
            self.selects = Some(BTreeSet::from([station_idx + 1]));
        }
        if !rows.is_empty() {
            push(Edit::Duplicate(rows), commands);
        }
    }

    /// The selected rows taken out.
    pub fn remove(&mut self, commands: &mut Vec<Command>) {
        let rows = self.selected_rows();
        if rows.is_empty() {
            return;
        }
        let whole = stations_among(&rows);
        let kept = |row: &Row| matches!(row, Row::Station(_)) || !whole.contains(&row.place().station_idx);
        let rows: Vec<Row> = rows.into_iter().filter(kept).collect();
        self.said = Some(words::deleted(rows.len()));
        let first = self.cursor.rows().first().copied().unwrap_or(0);
        self.cursor = Cursor::at(first, self.cursor.column);
        push(Edit::Remove(rows), commands);
    }

    /// The selected stations one place up (negative) or down.
    pub fn shift(&mut self, session: &Session, is_up: bool, commands: &mut Vec<Command>) {
        let selected = self.selected_stations();
        let (Some(first), Some(last)) = (selected.first().copied(), selected.last().copied()) else { return };
        let num_stations = session.stations.len();
        if (is_up && first == 0) || (!is_up && last + 1 >= num_stations) {
            return;
        }
        let mut order: Vec<usize> = (0..num_stations).collect();
        let is_selected: HashSet<usize> = selected.iter().copied().collect();
        if is_up {
            (1..num_stations).filter(|idx| is_selected.contains(idx)).for_each(|idx| order.swap(idx - 1, idx));
        } else {
            (0..num_stations - 1)
                .rev()
                .filter(|idx| is_selected.contains(idx))
                .for_each(|idx| order.swap(idx, idx + 1));
        }
        self.selects = Some(selected.iter().map(|idx| if is_up { idx - 1 } else { idx + 1 }).collect());
        push(Edit::Reorder(order), commands);
    }

    /// The stations in the order of a column; once more turns the order around.
    pub fn sort(&mut self, session: &Session, column: Column, commands: &mut Vec<Command>) {
        let is_descending = self.view.sorted == Some((column, false));
        let order = order_by(session, column, is_descending);
        self.view.sorted = Some((column, is_descending));
        if !order.iter().copied().eq(0..order.len()) {
            push(Edit::Reorder(order), commands);
        }
    }

    /// The first of the selected rows filled into the others; a single row takes from the one above.
    pub fn fill(&mut self, session: &Session, commands: &mut Vec<Command>) {
        let mut rows = self.selected_rows();
        if let ([_], Some(above)) = (&rows[..], self.cursor.row.checked_sub(1)) {
            rows.insert(0, self.view.rows[above]);
        }
        let typed = fill_down(session, &rows, &self.selected_columns());
        if !typed.is_empty() {
            self.enter(session, typed, commands);
        }
    }
}

fn stations_among(rows: &[Row]) -> HashSet<usize> {
    let station = |row: &Row| match row {
        Row::Station(station_idx) => Some(*station_idx),
        Row::Capture(_) => None,
    };
    rows.iter().filter_map(station).collect()
}

fn change(values: Vec<(Place, CellValue)>, commands: &mut Vec<Command>) {
    if !values.is_empty() {
        push(Edit::SetCells(values), commands);
    }
}

pub(super) fn push(edit: Edit, commands: &mut Vec<Command>) {
    commands.push(Command::Edit { edit, gesture: None });
}
