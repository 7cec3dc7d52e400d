//! Labels of stations and names of targets: each is given once.

use std::collections::{HashMap, HashSet};
use std::hash::BuildHasher;

use crate::session::model::Station;

/// The first that an earlier one is equal to.
pub(super) fn repeated<'l>(labels: impl Iterator<Item = &'l str>) -> Option<&'l str> {
    let mut seen = HashSet::new();
    labels.into_iter().find(|label| !seen.insert(*label))
}

/// The label itself, or the first number behind it (or after it, if it is a number) that is free.
#[must_use]
pub fn free_label<S: BuildHasher>(wanted: &str, taken: &HashSet<String, S>) -> String {
    if !taken.contains(wanted) {
        return wanted.to_owned();
    }
    other_labels(wanted, 0).map(|(_, label)| label).find(|label| !taken.contains(label)).unwrap_or_default()
}

/// The labels to try in place of one that is taken, each with its number: the numbers after it if it is one, otherwise the
/// label with a number behind it; from `first` on.
fn other_labels(wanted: &str, first: u32) -> impl Iterator<Item = (u32, String)> {
    let number = wanted.parse::<u32>().ok();
    let next = number.map_or(u32::MAX, |number| number.saturating_add(1).max(first));
    let numbers = number.into_iter().flat_map(move |_| next..u32::MAX).map(|number| (number, number.to_string()));
    numbers.chain((first.max(2)..u32::MAX).map(move |number| (number, format!("{wanted} ({number})"))))
}

/// The labels of stations, or the names of targets, while others are added to them: many that are taken cost no more than each its turn.
pub(super) struct Labels {
    taken: HashSet<String>,
    /// Where the search goes on: for numbers, under an empty name, and for each other label.
    next: HashMap<String, u32>,
}

impl Labels {
    /// Those that are taken already.
    pub fn of<'l>(taken: impl Iterator<Item = &'l str>) -> Self {
        Self { taken: taken.map(str::to_owned).collect(), next: HashMap::new() }
    }

    pub fn of_stations(stations: &[Station]) -> Self {
        Self::of(stations.iter().map(|station| station.label.as_str()))
    }

    /// The label itself, or another that is free; it is taken then.
    pub fn claim(&mut self, wanted: &str) -> String {
        if self.taken.insert(wanted.to_owned()) {
            return wanted.to_owned();
        }
        let name = if wanted.parse::<u32>().is_ok() { "" } else { wanted };
        let first = self.next.get(name).copied().unwrap_or_default();
        let found = other_labels(wanted, first).find(|(_, label)| !self.taken.contains(label));
        let (number, label) = found.unwrap_or_default();
        self.next.insert(name.to_owned(), number.saturating_add(1));
        self.taken.insert(label.clone());
        label
    }
}
