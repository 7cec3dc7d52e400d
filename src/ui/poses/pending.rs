//! Texts that stand in cells without being in the document: they could not be read, and wait to be corrected.

use std::collections::{BTreeMap, BTreeSet};

use crate::session::table::{Column, RefusedCell, TypedCell};
use crate::session::{Place, Session};

/// A cell by names that sorting, adding and deleting leave as they are.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Key {
    label: String,
    capture_idx: usize,
    column: Column,
}

/// A text that waits.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Waiting {
    /// The text.
    pub text: String,
    /// Why it is not in the document.
    pub reason: String,
}

/// All texts that wait, and the stations that wait with them.
#[derive(Clone, Debug, Default)]
pub struct Pending {
    texts: BTreeMap<Key, Waiting>,
    held_back: BTreeSet<String>,
}

impl Pending {
    /// Whether nothing waits.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.texts.is_empty()
    }

    /// The text that waits in a cell.
    #[must_use]
    pub fn get(&self, session: &Session, place: Place, column: Column) -> Option<&Waiting> {
        if self.texts.is_empty() {
            return None;
        }
        self.texts.get(&key(session, place, column)?)
    }

    /// Everything that waits in the rows of a place's capture, as if it were typed again.
    #[must_use]
    pub fn of_place(&self, session: &Session, place: Place) -> Vec<TypedCell> {
        let Some(station) = session.stations.get(place.station_idx) else { return Vec::new() };
        self.of_station(&station.label)
            .filter(|(key, _)| key.capture_idx == place.capture_idx)
            .map(|(key, waiting)| TypedCell { place, column: key.column, text: waiting.text.clone() })
            .collect()
    }

    /// Why texts wait at a station, in the order of its captures and columns.
    pub fn reasons<'a>(&'a self, label: &str) -> impl Iterator<Item = (Column, &'a str)> + 'a {
        self.of_station(label).map(|(key, waiting)| (key.column, waiting.reason.as_str()))
    }

    fn of_station<'a>(&'a self, label: &str) -> impl Iterator<Item = (&'a Key, &'a Waiting)> + 'a {
        let first = Key { label: label.to_owned(), capture_idx: 0, column: Column::Used };
        let label = label.to_owned();
        self.texts.range(first..).take_while(move |(key, _)| key.label == label)
    }

    /// Takes over what was refused of typed cells, and forgets those that were taken.
    pub fn update(&mut self, session: &Session, typed: &[TypedCell], refused: &[RefusedCell]) {
        for cell in typed {
            self.forget(session, cell.place, cell.column);
        }
        for RefusedCell { cell, reason } in refused {
            if let Some(key) = key(session, cell.place, cell.column) {
                self.texts.insert(key, Waiting { text: cell.text.clone(), reason: reason.to_string() });
            }
        }
    }

    /// A text that waits at a station that is about to be there.
    pub fn insert(&mut self, label: String, refused: &RefusedCell) {
        let key = Key { label, capture_idx: refused.cell.place.capture_idx, column: refused.cell.column };
        self.texts.insert(key, Waiting { text: refused.cell.text.clone(), reason: refused.reason.to_string() });
    }

    /// Throws a text away; the cell shows what the document has again.
    pub fn forget(&mut self, session: &Session, place: Place, column: Column) -> bool {
        key(session, place, column).is_some_and(|key| self.texts.remove(&key).is_some())
    }

    /// Leaves a station out until nothing waits there any more.
    pub fn hold_back(&mut self, label: String) {
        self.held_back.insert(label);
    }

    /// Whether the station was left out only because something waited, and nothing does any more; told once.
    pub fn release(&mut self, label: &str) -> bool {
        self.of_station(label).next().is_none() && self.held_back.remove(label)
    }

    /// Follows the document: labels that were changed are followed; texts of stations that are gone, and
    /// numbers that mean something else now, are dropped.
    pub fn follow(&mut self, before: &Session, now: &Session) {
        if self.texts.is_empty() && self.held_back.is_empty() {
            return;
        }
        for (old, new) in renamed(before, now) {
            let moved: Vec<Key> = self.texts.keys().filter(|key| key.label == old).cloned().collect();
            for key in moved {
                if let Some(waiting) = self.texts.remove(&key) {
                    self.texts.insert(Key { label: new.to_owned(), ..key }, waiting);
                }
            }
            if self.held_back.remove(old) {
                self.held_back.insert(new.to_owned());
            }
        }
        // A station that comes to bear the label of one that went is another.
        let labels: BTreeSet<&str> = now.stations.iter().map(|station| station.label.as_str()).collect();
        self.texts.retain(|key, _| labels.contains(key.label.as_str()));
        self.held_back.retain(|label| labels.contains(label.as_str()));
        if before.robot.notation != now.robot.notation {
            self.texts.retain(|key, _| !matches!(key.column, Column::Number(_)));
        }
    }

    /// How many texts wait in cells that are there.
    #[must_use]
    pub fn count(&self, session: &Session) -> usize {
        if self.texts.is_empty() {
            return 0;
        }
        self.places(session).count()
    }

    /// The row that shows the first of them, with its column.
    #[must_use]
    pub fn first(&self, session: &Session) -> Option<(Place, Column)> {
        self.places(session).min()
    }

    fn places<'a>(&'a self, session: &'a Session) -> impl Iterator<Item = (Place, Column)> + 'a {
        let stations = session.stations.iter().enumerate();
        stations.flat_map(|(station_idx, station)| {
            self.of_station(&station.label)
                .filter(|(key, _)| key.capture_idx < station.captures.len())
                .map(move |(key, _)| (Place { station_idx, capture_idx: key.capture_idx }, key.column))
        })
    }
}

fn key(session: &Session, place: Place, column: Column) -> Option<Key> {
    let label = session.stations.get(place.station_idx)?.label.clone();
    Some(Key { label, capture_idx: place.capture_idx, column })
}

/// Stations with another label than before at the same place, where it is clear that it is the same station.
pub fn renamed<'a>(before: &'a Session, now: &'a Session) -> Vec<(&'a str, &'a str)> {
    if before.stations.len() != now.stations.len() {
        return Vec::new();
    }
    let changed: Vec<(&str, &str)> = (before.stations.iter().zip(&now.stations))
        .map(|(before, now)| (before.label.as_str(), now.label.as_str()))
        .filter(|(before, now)| before != now)
        .collect();
    let (old, new): (BTreeSet<&str>, BTreeSet<&str>) = changed.iter().copied().unzip();
    changed.into_iter().filter(|(before, now)| !new.contains(before) && !old.contains(now)).collect()
}
