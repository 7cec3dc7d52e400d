//! What the results say of the stations, counted for the rail and told apart for the table.

use crate::app::Results;
use crate::calibrate::{self, Method, Warning};
use crate::session::Session;

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
        | Warning::StationStandsOut { label, .. }
        | Warning::PoseRejected { label, .. } => std::slice::from_ref(label),
        Warning::BlindInY { labels, .. } | Warning::SideAmbiguous { labels, .. } => labels,
        Warning::FewStations { .. }
        | Warning::FewEdgePoints { .. }
        | Warning::OtherMinimum { .. }
        | Warning::LittleRotation { .. }
        | Warning::NearlyOneAxis { .. }
        | Warning::RadiusDisagrees { .. }
        | Warning::StreamInverted { .. }
        | Warning::TargetScale { .. }
        | Warning::TimeOffsetUnknown
        | Warning::NotConverged { .. } => &[],
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

/// Warnings about single stations; refused captures are counted from the readings, for all methods alike.
pub(super) fn station_warnings(results: &Results, method: Method) -> impl Iterator<Item = &Warning> {
    results
        .method(method)
        .and_then(|result| result.outcome.as_ref().ok())
        .into_iter()
        .flat_map(|solution| &solution.warnings)
        .filter(|warning| !matches!(warning, Warning::CaptureRefused { .. }))
}
