//! What the start page knows of the samples: their sizes and a picture, read in the background.

use crate::session::{self, Reading, Session, samples};

/// Points drawn in a sample's picture; more would not be seen.
const MAX_PICTURE_POINTS: usize = 240;

/// A sample as its card shows it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SamplePreview {
    /// Stations.
    pub num_stations: usize,
    /// Captures over all stations.
    pub num_captures: usize,
    /// Whether the captures are reduced points instead of profiles.
    pub is_points_only: bool,
    /// What is drawn: (x, z) in the sensor's frame, mm; several profiles one after the other.
    pub strokes: Vec<Vec<[f64; 2]>>,
}

/// Reads all samples; `None` for one that cannot be read.
#[must_use]
pub fn preview_samples() -> Vec<Option<SamplePreview>> {
    samples::ALL
        .iter()
        .map(|sample| session::parse(sample.json.as_bytes(), sample.file_name).ok())
        .map(|session| session.map(|session| preview(&session)))
        .collect()
}

/// The preview of a session: the profiles of its first station with any, or its reduced points.
#[must_use]
pub fn preview(session: &Session) -> SamplePreview {
    let readings = || session.stations.iter().flat_map(|station| &station.captures).map(|capture| &capture.reading);
    let is_points_only = readings().all(|reading| matches!(reading, Reading::Point(_)));
    let strokes = if is_points_only {
        let points = readings().filter_map(|reading| match reading {
            Reading::Point(point) => Some([point.x, point.z]),
            Reading::Profile(_) => None,
        });
        vec![points.collect()]
    } else {
        middle_profiles(session)
    };
    SamplePreview {
        num_stations: session.stations.len(),
        num_captures: session.num_captures(),
        is_points_only,
        strokes,
    }
}

/// A profile from the middle of the first station's sweep.
fn middle_profiles(session: &Session) -> Vec<Vec<[f64; 2]>> {
    let profiles = session.stations.iter().map(|station| {
        let profiles: Vec<_> = station
            .captures
            .iter()
            .filter_map(|capture| match &capture.reading {
                Reading::Profile(profile) => Some(profile),
                Reading::Point(_) => None,
            })
            .collect();
        profiles.get(profiles.len() / 2).copied()
    });
    let Some(profile) = profiles.flatten().next() else { return Vec::new() };
    let stride = profile.len().div_ceil(MAX_PICTURE_POINTS).max(1);
    vec![profile.valid_points().step_by(stride).map(|(_, x, z)| [x, z]).collect()]
}
