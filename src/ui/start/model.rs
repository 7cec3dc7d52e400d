//! What the start page knows of the samples: their sizes and a picture, read in the background.

use std::env;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::geometry::{Profile, Sensor, Target as TargetFrame, Transform, Vec3};
use crate::session::sequence::Sequence;
use crate::session::{self, Reading, Session, Station, Target, samples};

/// Points drawn in a sample's picture; more would not be seen.
const MAX_PICTURE_POINTS: usize = 160;
/// Profiles drawn one behind the other.
const MAX_PICTURE_PROFILES: usize = 5;
/// Boards drawn one behind the other.
const MAX_PICTURE_BOARDS: usize = 9;
/// Half the side of a board that is drawn, as a part of its distance.
const BOARD_PART: f64 = 0.1;

/// What a sample's picture is made of, and what its sizes count.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Drawn {
    /// Profiles, each a stroke.
    #[default]
    Profiles,
    /// Reduced points, all in one stroke.
    Points,
    /// Boards as a camera sees them, each a closed stroke.
    Boards,
    /// The way of a camera, in one stroke.
    Way,
}

/// A sample as its card shows it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SamplePreview {
    /// Stations.
    pub num_stations: usize,
    /// Captures over all stations; of a sequence its frames.
    pub num_captures: usize,
    /// What the strokes are.
    pub drawn: Drawn,
    /// What is drawn: to the right and down, mm; of profiles (x, z) in the sensor's frame.
    pub strokes: Vec<Vec<[f64; 2]>>,
}

/// All samples that are there.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SamplePreviews {
    /// Those that are carried, in their order; `None` for one that cannot be read.
    pub carried: Vec<Option<SamplePreview>>,
    /// The recorded sequence and its session's file, where it is found.
    pub sequence: Option<(PathBuf, SamplePreview)>,
}

/// Reads all samples. The recorded sequence is looked for where the program was started, and around the program itself.
#[must_use]
pub fn preview_samples() -> SamplePreviews {
    let carried = samples::ALL
        .iter()
        .map(|sample| session::parse(sample.json.as_bytes(), sample.file_name).ok())
        .map(|session| session.map(|session| preview(&session)))
        .collect();
    let started_in = env::current_dir().ok();
    let program = env::current_exe().ok();
    let around_program = program.iter().flat_map(|program| program.ancestors().skip(1));
    let sequence = samples::recorded_sequence(started_in.as_deref().into_iter().chain(around_program));
    SamplePreviews { carried, sequence: sequence.and_then(|file| preview_sequence(&file).map(|found| (file, found))) }
}

/// The preview of the sequence that a session's file names; `None` where it cannot be read.
#[must_use]
pub fn preview_sequence(file: &Path) -> Option<SamplePreview> {
    let Target::Rgbd { sequence } = session::load(file).ok()?.target else { return None };
    let sequence = Sequence::open(&file.parent()?.join(sequence)).ok()?;
    let truth = sequence.ground_truth.unwrap_or_default();
    let stride = truth.len().div_ceil(MAX_PICTURE_POINTS).max(1);
    // As the first camera has it, whose y axis points down.
    let first_from_world = truth.first()?.world_from_sensor.inverse();
    let way = truth.iter().step_by(stride).map(|pose| first_from_world * pose.world_from_sensor);
    let way = way.map(|first_from_sensor| first_from_sensor.translation_mm()).map(|at| [at.x, at.y]).collect();
    Some(SamplePreview { num_stations: 0, num_captures: sequence.frames.len(), drawn: Drawn::Way, strokes: vec![way] })
}

/// The preview of a session: profiles of its first station with any, its reduced points, or its boards.
#[must_use]
pub fn preview(session: &Session) -> SamplePreview {
    let readings = || session.stations.iter().flat_map(|station| &station.captures).map(|capture| &capture.reading);
    let boards = || {
        readings().filter_map(|reading| match reading {
            Reading::Pose(sensor_from_target) => Some(sensor_from_target),
            Reading::Profile(_) | Reading::Point(_) => None,
        })
    };
    let is_points_only = readings().all(|reading| matches!(reading, Reading::Point(_)));
    let (drawn, strokes) = if boards().next().is_some() {
        let stride = boards().count().div_ceil(MAX_PICTURE_BOARDS);
        (Drawn::Boards, boards().step_by(stride).map(board).collect())
    } else if is_points_only {
        let points = readings().filter_map(|reading| match reading {
            Reading::Point(point) => Some([point.x, point.z]),
            Reading::Profile(_) | Reading::Pose(_) => None,
        });
        (Drawn::Points, vec![points.collect()])
    } else {
        (Drawn::Profiles, some_profiles(session))
    };
    SamplePreview { num_stations: session.stations.len(), num_captures: session.num_captures(), drawn, strokes }
}

/// The corners of a board as a camera sees it, which looks along z; y points down.
fn board(sensor_from_target: &Transform<Sensor, TargetFrame>) -> Vec<[f64; 2]> {
    let middle = sensor_from_target.translation_mm();
    let half_mm = BOARD_PART * middle.norm();
    let corner = |[x, y]: [f64; 2]| middle + sensor_from_target.rotation() * Vec3::new(x * half_mm, y * half_mm, 0.0);
    [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(corner).map(|at| [at.x, at.y]).to_vec()
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
