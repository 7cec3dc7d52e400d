//! Filling down: the first of several rows into those below it.

use std::collections::HashSet;

use crate::session::{Row, Session};

use super::{Column, TypedCell, has_cell, text};

/// The cells of the first row typed into those below it. Labels count on, past those that other stations have.
#[must_use]
pub fn fill_down(session: &Session, rows: &[Row], columns: &[Column]) -> Vec<TypedCell> {
    let Some((source, targets)) = rows.split_first() else { return Vec::new() };
    let mut typed = Vec::new();
    for column in columns {
        // A row without this cell is passed over, so that captures can be filled across the rows of their stations.
        if !has_cell(session, *source, *column) {
            continue;
        }
        let mut value = text(session, source.place(), *column);
        let changing: HashSet<usize> = targets.iter().map(|row| row.place().station_idx).collect();
        let mut taken: HashSet<&str> = (session.stations.iter().enumerate())
            .filter(|(station_idx, _)| !changing.contains(station_idx))
            .map(|(_, station)| station.label.as_str())
            .collect();
        if let Some(station) = session.stations.get(source.place().station_idx) {
            taken.insert(&station.label);
        }
        for row in targets.iter().filter(|row| has_cell(session, **row, *column)) {
            if *column == Column::Label {
                value = next_label(&value);
                while taken.contains(value.as_str()) {
                    value = next_label(&value);
                }
            }
            typed.push(TypedCell { place: row.place(), column: *column, text: value.clone() });
        }
    }
    typed
}

/// The label with the number at its end counted on; one without a number gets a 2.
#[must_use]
pub fn next_label(label: &str) -> String {
    let stem = label.trim_end_matches(|letter: char| letter.is_ascii_digit());
    let digits = &label[stem.len()..];
    match digits.parse::<u64>().ok().and_then(|number| number.checked_add(1)) {
        Some(number) => format!("{stem}{number:0width$}", width = digits.len()),
        // Also behind a number that cannot be counted on.
        None => format!("{label} 2"),
    }
}
