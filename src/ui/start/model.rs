//! What the start page knows of the samples: their sizes and a picture, read in the background.

use std::sync::Arc;

use crate::geometry::Profile;
use crate::session::{self, Reading, Session, Station, samples};

/// Points drawn in a sample's picture; more would not be seen.
const MAX_PICTURE_POINTS: usize = 160;
/// Profiles drawn one behind the other.
const MAX_PICTURE_PROFILES: usize = 5;

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

/// The preview of a session: profiles of its first station with any, or its reduced points.
#[must_use]
pub fn preview(session: &Session) -> SamplePreview {
    let readings = || session.stations.iter().flat_map(|station| &station.captures).map(|capture| &capture.reading);
    let is_points_only = readings().all(|reading| matches!(reading, Reading::Point(_) | Reading::Pose(_)));
    let strokes = if is_points_only {
        let points = readings().filter_map(|reading| match reading {
            Reading::Point(point) => Some([point.x, point.z]),
            Reading::Pose(seen) => Some([seen.translation_mm().x, seen.translation_mm().z]),
            Reading::Profile(_) => None,
        });
        vec![points.collect()]
    } else {
        some_profiles(session)
    };
    SamplePreview {
        num_stations: session.stations.len(),
        num_captures: session.num_captures(),
        is_points_only,
        strokes,
    }
}

/// Some profiles of the first station with any, evenly over its sweep.
fn some_profiles(session: &Session) -> Vec<Vec<[f64; 2]>> {
    let profiles_of = |station: &Station| -> Vec<Arc<Profile>> {
        let readings = station.captures.iter().map(|capture| &capture.reading);
        readings
            .filter_map(|reading| match reading {
                Reading::Profile(profile) => Some(Arc::clone(profile)),
                Reading::Point(_) | Reading::Pose(_) => None,
            })
            .collect()
    };
    let Some(profiles) = session.stations.iter().map(profiles_of).find(|profiles| !profiles.is_empty()) else {
        return Vec::new();
    };
    let stride = profiles.len().div_ceil(MAX_PICTURE_PROFILES);
    profiles.iter().step_by(stride).map(|profile| picture_points(profile)).collect()
}

fn picture_points(profile: &Profile) -> Vec<[f64; 2]> {
    let stride = profile.len().div_ceil(MAX_PICTURE_POINTS).max(1);
    profile.valid_points().step_by(stride).map(|(_, x, z)| [x, z]).collect()
}
