//! What the check column says of each row: what is odd about the session, and what the solver says of its stations.

use std::collections::{BTreeSet, HashMap};

use crate::app::Workbench;
use crate::calibrate::{self, Method, Warning};
use crate::session::Session;
use crate::session::check::{self, Finding};
use crate::text::finding_message;
use crate::text::poses as words;
use crate::text::warnings::warning_message;

use super::model::{labels_of, station_warnings};

/// Something to look at in a row.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    /// In a word or two.
    pub word: String,
    /// In a sentence.
    pub sentence: String,
    /// The capture that it is about; `None` if it is about the station.
    pub capture_idx: Option<usize>,
}

/// The notes of all stations, made anew when the document, the results or the method have changed.
#[derive(Clone, Debug, Default)]
pub struct Checks {
    made_of: Option<(u64, Option<u64>, Method)>,
    notes: Vec<Vec<Note>>,
}

impl Checks {
    /// Follows the document and its results. Results of an earlier revision say nothing, as rows may have moved since.
    pub fn refresh(&mut self, workbench: &Workbench, method: Method) {
        let Some(document) = workbench.document() else { return };
        let results = workbench.results().filter(|_| workbench.results_are_current());
        let made_of = (document.revision, results.map(|results| results.revision), method);
        if self.made_of == Some(made_of) {
            return;
        }
        self.made_of = Some(made_of);
        let stations = &document.session.stations;
        self.notes = vec![Vec::new(); stations.len()];
        let idx_of: HashMap<&str, usize> =
            stations.iter().enumerate().map(|(idx, station)| (station.label.as_str(), idx)).collect();
        let mut add = |label: &str, note: Note| {
            if let Some(notes) = idx_of.get(label).and_then(|idx| self.notes.get_mut(*idx)) {
                notes.push(note);
            }
        };
        let mut without_points: BTreeSet<(String, usize)> = BTreeSet::new();
        for finding in check::findings(&document.session) {
            let Some(label) = finding.station_label() else { continue };
            let capture_idx = match &finding {
                Finding::NoReading { capture_idx, .. } | Finding::EmptyProfile { capture_idx, .. } => {
                    without_points.insert((label.to_owned(), *capture_idx));
                    Some(*capture_idx)
                }
                Finding::PointOutsidePlane { capture_idx, .. }
                | Finding::StepDiffersFromPose { capture_idx, .. }
                | Finding::FarPose { capture_idx, .. } => Some(*capture_idx),
                _ => None,
            };
            let sentence = finding_message(&finding);
            if let Finding::TwinStations { label, twin_label, .. } = &finding {
                add(twin_label, Note { word: words::same_as(label), sentence: sentence.clone(), capture_idx });
            }
            add(label, Note { word: words::finding_word(&finding), sentence, capture_idx });
        }
        // Where nothing is computed, nothing is looked for in the profiles either.
        let Some(results) = results.filter(|results| results.refusal.is_none()) else { return };
        for (station_idx, station) in stations.iter().enumerate() {
            for capture_idx in 0..station.captures.len() {
                let reading = results.measured.reading(station_idx, capture_idx);
                let Some(calibrate::Reading::Refused(reason)) = reading else { continue };
                // That there are no points is said already.
                if !without_points.contains(&(station.label.clone(), capture_idx)) {
                    let sentence = words::refused(capture_idx + 1, &reason.to_string());
                    let word = words::not_found(&document.session.target).to_owned();
                    add(&station.label, Note { word, sentence, capture_idx: Some(capture_idx) });
                }
            }
        }
        let is_said = |warning: &&Warning| !matches!(warning, Warning::StepDiffersFromPose { .. });
        for warning in station_warnings(results, method).filter(is_said) {
            for label in labels_of(warning) {
                let word = words::warning_word(warning).to_owned();
                add(label, Note { word, sentence: warning_message(warning), capture_idx: None });
            }
        }
    }

    /// Number of stations with something to look at; those that take no part are looked at by nobody.
    #[must_use]
    pub fn num_stations(&self, session: &Session) -> usize {
        session.stations.iter().zip(&self.notes).filter(|(station, notes)| station.enabled && !notes.is_empty()).count()
    }

    /// What there is to look at in a station.
    #[must_use]
    pub fn of_station(&self, station_idx: usize) -> &[Note] {
        self.notes.get(station_idx).map_or(&[], Vec::as_slice)
    }
}
