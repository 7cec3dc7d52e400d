//! Data of the pose table, built without egui.

use std::collections::{BTreeMap, BTreeSet};

use crate::app::Results;
use crate::calibrate::{self, Method, Warning};
use crate::session::Session;
use crate::session::check::{self, Finding};
use crate::text::finding_message;
use crate::text::poses as words;
use crate::text::warnings::warning_message;

/// Refusals of single profiles that are listed for a station before the rest is only counted.
const MAX_LISTED_REFUSALS: usize = 3;

/// A row of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Row {
    /// A station, with the pose of its first capture.
    Station(usize),
    /// A capture of an unfolded station.
    Capture {
        /// Index of the station.
        station_idx: usize,
        /// Index of the capture in it.
        capture_idx: usize,
    },
}

/// The rows shown when the given stations are unfolded.
#[must_use]
pub fn rows(session: &Session, unfolded: &BTreeSet<usize>) -> Vec<Row> {
    let mut rows = Vec::with_capacity(session.stations.len());
    for (station_idx, station) in session.stations.iter().enumerate() {
        rows.push(Row::Station(station_idx));
        if unfolded.contains(&station_idx) {
            rows.extend((0..station.captures.len()).map(|capture_idx| Row::Capture { station_idx, capture_idx }));
        }
    }
    rows
}

/// Position (mm) and angles (°) of a capture as the robot's controller writes them.
#[must_use]
pub fn pose_figures(session: &Session, station_idx: usize, capture_idx: usize) -> Option<[f64; 6]> {
    let capture = session.stations.get(station_idx)?.captures.get(capture_idx)?;
    let position = capture.base_from_flange.translation_mm();
    let [a, b, c] = session.robot.notation.convention.angles_deg_from_rotation(&capture.base_from_flange.rotation());
    Some([position.x, position.y, position.z, a, b, c])
}

/// The labels of the stations that a warning speaks of.
#[must_use]
pub fn labels_of(warning: &Warning) -> &[String] {
    match warning {
        Warning::ArcLargerThanBall { label, .. }
        | Warning::CaptureRefused { label, .. }
        | Warning::StationSkipped { label, .. }
        | Warning::TravelOffNormal { label, .. }
        | Warning::PeakNotCovered { label, .. }
        | Warning::StepDiffersFromPose { label, .. }
        | Warning::StationStandsOut { label, .. } => std::slice::from_ref(label),
        Warning::BlindInY { labels, .. } | Warning::SideAmbiguous { labels, .. } => labels,
        Warning::FewStations { .. }
        | Warning::LittleRotation { .. }
        | Warning::NearlyOneAxis { .. }
        | Warning::RadiusDisagrees { .. }
        | Warning::NotConverged { .. } => &[],
    }
}

/// Why a profile has no arc, if it has none.
#[must_use]
pub fn refusal(results: &Results, station_idx: usize, capture_idx: usize) -> Option<String> {
    match results.measured.reading(station_idx, capture_idx)? {
        calibrate::Reading::Refused(reason) => Some(reason.to_string()),
        calibrate::Reading::Arc(_) | calibrate::Reading::Point(_) => None,
    }
}

/// Number of profiles of the enabled stations without a usable arc.
#[must_use]
pub fn num_refused(session: &Session, results: &Results) -> usize {
    session
        .stations
        .iter()
        .enumerate()
        .filter(|(_, station)| station.enabled)
        .flat_map(|(station_idx, station)| {
            (0..station.captures.len()).map(move |capture_idx| (station_idx, capture_idx))
        })
        .filter(|&(station_idx, capture_idx)| {
            matches!(results.measured.reading(station_idx, capture_idx), Some(calibrate::Reading::Refused(_)))
        })
        .count()
}

/// What the check of a session says of single stations before anything is solved, by their labels. Empty profiles and
/// odd steps are left to the arcs and the solver, which say more about them.
#[must_use]
pub fn checks(session: &Session) -> BTreeMap<String, Vec<String>> {
    let mut checks: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for finding in check::findings(session) {
        if matches!(finding, Finding::EmptyProfile { .. } | Finding::StepDiffersFromPose { .. }) {
            continue;
        }
        if let Some(label) = finding.station_label() {
            checks.entry(label.to_owned()).or_default().push(finding_message(&finding));
        }
    }
    checks
}

/// What is the matter with a station: refused profiles, and the method's warnings about it.
#[must_use]
pub fn findings(session: &Session, results: &Results, method: Method, station_idx: usize) -> Vec<String> {
    let Some(station) = session.stations.get(station_idx) else { return Vec::new() };
    let mut findings: Vec<String> = (0..station.captures.len())
        .filter_map(|capture_idx| Some((capture_idx, refusal(results, station_idx, capture_idx)?)))
        .map(|(capture_idx, reason)| words::refused(capture_idx + 1, &reason))
        .collect();
    if findings.len() > MAX_LISTED_REFUSALS {
        let num_unlisted = findings.len() - MAX_LISTED_REFUSALS;
        findings.truncate(MAX_LISTED_REFUSALS);
        findings.push(words::more_refused(num_unlisted));
    }
    findings.extend(
        station_warnings(results, method)
            .filter(|warning| labels_of(warning).contains(&station.label))
            .map(warning_message),
    );
    findings
}

/// Number of enabled stations that the method warns of.
#[must_use]
pub fn num_stations_with_findings(session: &Session, results: &Results, method: Method) -> usize {
    let labels: BTreeSet<&String> = station_warnings(results, method).flat_map(labels_of).collect();
    let is_concerned = |station: &&crate::session::Station| station.enabled && labels.contains(&station.label);
    session.stations.iter().filter(is_concerned).count()
}

/// Warnings about single stations; refused captures are counted from the readings, for all methods alike.
fn station_warnings(results: &Results, method: Method) -> impl Iterator<Item = &Warning> {
    results
        .method(method)
        .and_then(|result| result.outcome.as_ref().ok())
        .into_iter()
        .flat_map(|solution| &solution.warnings)
        .filter(|warning| !matches!(warning, Warning::CaptureRefused { .. }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::{parse, samples};

    fn sample(file_name: &str) -> Session {
        let sample = samples::ALL.iter().find(|sample| sample.file_name == file_name).expect("there is this sample");
        parse(sample.json.as_bytes(), file_name).expect("the sample is a session")
    }

    #[test]
    fn an_unfolded_station_shows_its_captures_below_it() {
        let session = sample("few-rotations.json");
        assert_eq!(rows(&session, &BTreeSet::new()).len(), session.stations.len());
        let unfolded = rows(&session, &BTreeSet::from([1]));
        let num_captures = session.stations[1].captures.len();
        assert_eq!(unfolded.len(), session.stations.len() + num_captures);
        assert_eq!(unfolded[1..3], [Row::Station(1), Row::Capture { station_idx: 1, capture_idx: 0 }]);
        assert_eq!(unfolded[2 + num_captures], Row::Station(2));
    }

    #[test]
    fn poses_are_written_as_the_controller_writes_them() {
        let session = sample("few-rotations.json");
        let [x, y, z, w, p, r] = pose_figures(&session, 2, 1).expect("there is this capture");
        let pose = &session.stations[2].captures[1].base_from_flange;
        assert!((crate::geometry::Vec3::new(x, y, z) - pose.translation_mm()).norm() < 1e-9);
        let rotation = session.robot.notation.convention.rotation_from_angles_deg([w, p, r]);
        assert!(rotation.angle_to(&pose.rotation()) < 1e-9);
    }

    #[test]
    fn a_pose_measured_twice_is_told_of_its_station() {
        let mut session = sample("few-rotations.json");
        let twin = session.stations[0].captures.clone();
        session.stations[3].captures = twin;
        let checks = checks(&session);
        assert!(checks.values().flatten().any(|message| message.contains("same pose")), "{checks:?}");
    }
}
