//! What the arcs panel draws, made without egui from the session and what was measured in it.

use crate::app::Results;
use crate::calibrate::{self, Edge, Sweep};
use crate::fit::{CircleMethod, Feature};
use crate::report::figure::model::{ProfileModel, ball_radius_mm, profile_model, scan_model, sweep_of};
use crate::session::{Reading, ScanLine, Session};
use crate::text::arcs as text;

/// A capture in the list.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CaptureRow {
    /// Section radius of a ball, mm.
    pub section_radius_mm: Option<f64>,
    /// Fit RMS of a ball's arc, mm.
    pub rms_mm: Option<f64>,
    /// Point of an edge or tip in the laser plane, (x, z), mm.
    pub point_mm: Option<[f64; 2]>,
    /// What was found there.
    pub feature: Option<Feature>,
    /// What a profile of a scan holds.
    pub scan: Option<ScanLine>,
    /// What is wrong with it, in words.
    pub problem: Option<String>,
}

/// A station in the list.
#[derive(Clone, Debug, PartialEq)]
pub struct StationRow {
    /// The user's name for it.
    pub label: String,
    /// Whether it takes part.
    pub is_enabled: bool,
    /// The plate's edge that it saw.
    pub edge: Option<Edge>,
    /// Its captures.
    pub captures: Vec<CaptureRow>,
    /// Section radius of its first usable capture, mm: the one that the fixed-point method takes.
    pub section_radius_mm: Option<f64>,
    /// Fit RMS over its usable captures, mm.
    pub rms_mm: Option<f64>,
    /// What is wrong with it, in words.
    pub problem: Option<String>,
}

/// The list of stations.
#[must_use]
pub fn station_rows(session: &Session, results: Option<&Results>) -> Vec<StationRow> {
    session
        .stations
        .iter()
        .enumerate()
        .map(|(station_idx, station)| {
            let captures: Vec<CaptureRow> = (0..station.captures.len())
                .map(|capture_idx| {
                    let measured = results.map(|results| &*results.measured);
                    match measured.and_then(|measured| measured.scan_line(station_idx, capture_idx)) {
                        Some(line) => scan_row(line),
                        None => capture_row(measured.and_then(|measured| measured.reading(station_idx, capture_idx))),
                    }
                })
                .collect();
            let sweep = results.and_then(|results| sweep_of(&results.methods, station_idx));
            StationRow {
                label: station.label.clone(),
                is_enabled: station.enabled,
                edge: station.edge,
                section_radius_mm: captures.iter().find_map(|capture| capture.section_radius_mm),
                rms_mm: pooled_rms(&captures),
                problem: station_problem(&captures, sweep.map(|(_, sweep)| sweep)),
                captures,
            }
        })
        .collect()
}

fn capture_row(reading: Option<&calibrate::Reading>) -> CaptureRow {
    let mut row = CaptureRow::default();
    match reading {
        Some(calibrate::Reading::Arc(arc)) => {
            row.section_radius_mm = Some(arc.circle.radius_mm);
            row.rms_mm = Some(arc.rms_mm);
        }
        Some(calibrate::Reading::Refused(refusal)) => row.problem = Some(refusal.to_string()),
        Some(calibrate::Reading::Edge(edge)) => {
            row.point_mm = Some(edge.point_mm);
            row.feature = Some(edge.feature);
        }
        Some(calibrate::Reading::Point(point)) => row.point_mm = Some([point.x, point.z]),
        Some(calibrate::Reading::Pose(seen)) => {
            let place = seen.translation_mm();
            row.point_mm = Some([place.x, place.z]);
        }
        None => {}
    }
    row
}

/// Every point of a scan counts; that there is none is said.
fn scan_row(line: &ScanLine) -> CaptureRow {
    let problem = line.range_mm.is_none().then(|| text::EMPTY_PROFILE.to_owned());
    CaptureRow { scan: Some(*line), problem, ..CaptureRow::default() }
}

fn pooled_rms(captures: &[CaptureRow]) -> Option<f64> {
    let values: Vec<f64> = captures.iter().filter_map(|capture| capture.rms_mm).collect();
    (!values.is_empty()).then(|| crate::geometry::stats::rms(values))
}

fn station_problem(captures: &[CaptureRow], sweep: Option<&Sweep>) -> Option<String> {
    let num_refused = captures.iter().filter(|capture| capture.problem.is_some()).count();
    if num_refused > 0 {
        // The reason itself where there is only one.
        return Some(match captures {
            [CaptureRow { problem: Some(reason), .. }] => reason.clone(),
            _ => text::refused_captures(num_refused, captures.len()),
        });
    }
    sweep.filter(|sweep| !sweep.covers_peak).map(|_| text::PEAK_NOT_COVERED.to_owned())
}

/// A station's point in the laser plane.
#[derive(Clone, Debug, PartialEq)]
pub struct SpreadPoint {
    /// The station.
    pub station_idx: usize,
    /// Its capture.
    pub capture_idx: usize,
    /// The station's name.
    pub label: String,
    /// Whether it takes part.
    pub is_enabled: bool,
    /// The edge that it is on.
    pub edge: Option<Edge>,
    /// Where, (x, z), mm.
    pub point_mm: [f64; 2],
}

/// Where in the laser plane all stations have their points: what the calibration knows of the sensor's plane comes from there.
#[must_use]
pub fn spread(rows: &[StationRow]) -> Vec<SpreadPoint> {
    let of_station = |(station_idx, row): (usize, &StationRow)| {
        let of_capture = |(capture_idx, capture): (usize, &CaptureRow)| {
            Some(SpreadPoint {
                station_idx,
                capture_idx,
                label: row.label.clone(),
                is_enabled: row.is_enabled,
                edge: row.edge,
                point_mm: capture.point_mm?,
            })
        };
        row.captures.iter().enumerate().filter_map(of_capture).collect::<Vec<_>>()
    };
    rows.iter().enumerate().flat_map(of_station).collect()
}

/// What the middle of the panel shows for a capture.
#[derive(Clone, Debug, PartialEq)]
pub enum CaptureView {
    /// A profile.
    Profile(ProfileModel),
    /// A point, already reduced elsewhere: its coordinates in the sensor frame, mm.
    Point([f64; 3]),
}

/// The view of a capture; `None` if the session has no such capture.
#[must_use]
pub fn capture_view(
    session: &Session,
    results: Option<&Results>,
    station_idx: usize,
    capture_idx: usize,
    method: CircleMethod,
) -> Option<CaptureView> {
    let capture = session.stations.get(station_idx)?.captures.get(capture_idx)?;
    Some(match &capture.reading {
        Reading::Point(point) => CaptureView::Point([point.x, point.y, point.z]),
        Reading::Pose(seen) => CaptureView::Point(seen.translation_mm().into()),
        Reading::Profile(profile) => {
            let measured = results.map(|results| &*results.measured);
            let reading = measured.and_then(|measured| measured.reading(station_idx, capture_idx));
            let line = measured.and_then(|measured| measured.scan_line(station_idx, capture_idx));
            CaptureView::Profile(line.map_or_else(
                || profile_model(profile, reading, ball_radius_mm(session), method),
                |line| scan_model(profile, line),
            ))
        }
    })
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::fit::ArcRefusal;
    use crate::geometry::Profile;

    #[test]
    fn a_refused_capture_says_why() {
        let refusal = ArcRefusal::TooFewPoints { found: 3, needed: 8 };
        let row = capture_row(Some(&calibrate::Reading::Refused(refusal.clone().into())));
        assert_eq!(row.problem, Some(refusal.to_string()));
    }

    #[test]
    fn a_plates_capture_has_its_point() {
        let x_mm: Vec<f64> = (0..200).map(|idx| f64::from(idx) * 0.1).collect();
        let z_mm: Vec<Option<f64>> = x_mm.iter().map(|x| Some(60.0 + (x - 8.0).abs())).collect();
        let profile = Profile::new(x_mm, &z_mm).expect("valid");
        let found = crate::fit::extract_edge(&profile, &crate::fit::EdgeOptions::default()).expect("a corner");
        let row = capture_row(Some(&calibrate::Reading::Edge(Arc::new(found))));
        assert_eq!((row.feature, row.problem), (Some(Feature::Corner), None));
        assert!(row.point_mm.is_some() && row.section_radius_mm.is_none());
    }
}
