//! From the poses of any source to stations, with what could not be read listed on the way.

use std::borrow::Cow;
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use std::sync::Arc;

use crate::calibrate::{Edge, SideChoice};
use crate::geometry::notation::NotAPose;
use crate::geometry::{Base, Flange, PoseNotation, Profile, Tcp, Transform, Vec3};
use crate::session::edit::written_angles;
use crate::session::limits::{self, Quantity};
use crate::session::{Capture, Reading, Station};
use crate::sheet::text::{excerpt, is_missing};

use super::{MAX_PROBLEMS, Note, Problem};

/// Poses that are read; a session of more is a mistake.
pub const MAX_POSES: usize = 20_000;
/// Longer labels are cut.
const MAX_LABEL_CHARS: usize = 80;

/// A pose as its source has it.
#[derive(Clone, Debug, Default)]
pub(super) struct RawPose<'t> {
    /// Line and column of its beginning, from 1.
    pub at: (usize, usize),
    /// The station's name; its number where there is none.
    pub label: Option<Cow<'t, str>>,
    /// The numbers, as the notation has them.
    pub numbers: &'t [f64],
    /// The reduced point.
    pub point_in_sensor: Option<Vec3>,
    /// The target's pose in the sensor: how it is written, and its numbers.
    pub target: Option<(PoseNotation, &'t [f64])>,
    /// The side of the ball's centre.
    pub side: SideChoice,
    /// The edge of the plate that it saw.
    pub edge: Option<Edge>,
    /// Whether the station is left out for now.
    pub is_disabled: bool,
    /// Commanded step, mm.
    pub step_mm: Option<f64>,
    /// Name or number of its profile.
    pub profile: Option<&'t str>,
    /// Whether it is a further capture of the station before, if that has the same label.
    pub may_continue: bool,
    /// What its source says of it beside the others.
    pub frames: OwnFrames,
}

/// What the source of a pose says of its frames, where that is not what it says of all poses.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct OwnFrames {
    /// It is in the base, whatever the user frame of the others.
    pub is_in_base: bool,
    /// It is the flange's, whatever the tool of the others.
    pub is_of_flange: bool,
    /// Its own user frame, in place of that of the others.
    pub base_from_user: Option<Transform<Base, Base>>,
    /// Its own tool, likewise.
    pub flange_from_tcp: Option<Transform<Flange, Tcp>>,
}

/// What belongs to a capture until its profile is found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct ProfileKey {
    pub station_idx: usize,
    pub capture_idx: usize,
    /// As the table has it.
    pub name: String,
}

/// Stations under construction.
#[derive(Debug)]
pub(super) struct Gathered {
    pub stations: Vec<Station>,
    /// The profiles that a table names.
    pub profile_keys: Vec<ProfileKey>,
    /// Index of the first station of each source, and the source's folder.
    pub source_starts: Vec<(usize, String)>,
    pub problems: Vec<Problem>,
    pub num_problems: usize,
    pub notes: Vec<Note>,
    notation: PoseNotation,
    base_from_user: Option<Transform<Base, Base>>,
    pub no_profile: Arc<Profile>,
    /// How often a label was wanted, by its hash: for a session of many poses the labels would be there twice. Two labels
    /// of one hash would only cost one of them a number.
    labels: HashMap<u64, u32>,
    /// The label that the last pose wanted, if it had one and its source goes on.
    last_wanted: Option<String>,
    num_poses: usize,
    num_normalised: usize,
    num_points: usize,
}

impl Gathered {
    pub fn new(notation: PoseNotation) -> Self {
        Self {
            stations: Vec::new(),
            profile_keys: Vec::new(),
            source_starts: Vec::new(),
            problems: Vec::new(),
            num_problems: 0,
            notes: Vec::new(),
            notation,
            base_from_user: None,
            no_profile: Arc::new(Profile::default()),
            labels: HashMap::new(),
            last_wanted: None,
            num_poses: 0,
            num_normalised: 0,
            num_points: 0,
        }
    }

    /// How the next source writes its poses.
    ///
    /// The user frame is what the options say, numbers in that notation, else what the source itself says.
    pub fn set_notation(
        &mut self,
        notation: PoseNotation,
        said_frame: Option<[f64; 6]>,
        own_frame: Option<Transform<Base, Base>>,
    ) {
        self.notation = notation;
        self.base_from_user = said_frame.and_then(|numbers| user_frame(&numbers, &notation)).or(own_frame);
    }

    /// The sweeps of the sources before do not go on in the next.
    pub fn begin_source(&mut self, name: &str) {
        let folder = name.rsplit_once(['/', '\\']).map_or("", |(folder, _)| folder);
        self.source_starts.push((self.stations.len(), folder.to_owned()));
        self.last_wanted = None;
    }

    pub const fn notation(&self) -> &PoseNotation {
        &self.notation
    }

    /// The user frame as numbers in the notation, as the options have it.
    pub fn user_frame_numbers(&self) -> Option<[f64; 6]> {
        let frame = self.base_from_user.as_ref()?;
        plain_angles(&self.notation).numbers(&Transform::from_rigid(*frame.rigid())).try_into().ok()
    }

    pub const fn has_user_frame(&self) -> bool {
        self.base_from_user.is_some()
    }

    pub const fn num_poses(&self) -> usize {
        self.num_poses
    }

    /// Poses with a reduced point.
    pub const fn num_points(&self) -> usize {
        self.num_points
    }

    /// Whether there is room for more.
    pub const fn is_full(&self) -> bool {
        self.num_poses >= MAX_POSES
    }

    /// Lists something that is left out.
    pub fn problem(&mut self, file: &str, (line, column): (usize, usize), found: &str, expected: &str) {
        self.num_problems += 1;
        if self.problems.len() < MAX_PROBLEMS {
            let found =
                if is_missing(found) && found.is_empty() { "nothing".to_owned() } else { excerpt(found).into() };
            self.problems.push(Problem { file: file.to_owned(), line, column, found, expected: expected.to_owned() });
        }
    }

    /// Takes a pose; one that is none is listed.
    pub fn take(&mut self, file: &str, raw: &RawPose<'_>) {
        if self.is_full() {
            let expected = format!("at most {MAX_POSES} poses");
            self.problem(file, raw.at, "one more pose", &expected);
            return;
        }
        match self.capture(raw) {
            Ok(capture) => self.add(raw, capture),
            Err((found, expected)) => self.problem(file, raw.at, &found, &expected),
        }
    }

    fn capture(&mut self, raw: &RawPose<'_>) -> Result<Capture, (String, String)> {
        let own_tool =
            raw.frames.flange_from_tcp.or(self.notation.flange_from_tcp).filter(|_| !raw.frames.is_of_flange);
        let notation = PoseNotation { flange_from_tcp: own_tool, ..self.notation };
        let base_from_user = raw.frames.base_from_user.or(self.base_from_user).filter(|_| !raw.frames.is_in_base);
        let user_from_flange = notation.base_from_flange(raw.numbers).map_err(|problem| not_a_pose(&problem))?;
        let base_from_flange = match &base_from_user {
            Some(base_from_user) => *base_from_user * user_from_flange,
            None => user_from_flange,
        };
        let check = |values: &[f64], quantity: &Quantity| match values.iter().find(|value| !quantity.admits(**value)) {
            Some(value) => Err((value.to_string(), quantity.to_string())),
            None => Ok(()),
        };
        check(base_from_flange.translation_mm().as_slice(), &limits::POSITION_MM)?;
        let reading = match (raw.target, raw.point_in_sensor) {
            (Some((notation, numbers)), _) => {
                let seen = notation.base_from_flange(numbers).map_err(|problem| not_a_pose(&problem))?;
                check(seen.translation_mm().as_slice(), &limits::POSITION_MM)?;
                Reading::Pose(Transform::from_rigid(*seen.rigid()))
            }
            (None, Some(point_in_sensor)) => {
                check(point_in_sensor.as_slice(), &limits::POINT_MM)?;
                Reading::Point(point_in_sensor)
            }
            (None, None) => Reading::Profile(Arc::clone(&self.no_profile)),
        };
        check(raw.step_mm.as_slice(), &limits::STEP_MM)?;
        if let [_, _, _, quaternion @ ..] = raw.numbers
            && let [_, _, _, _] = quaternion
        {
            let norm = quaternion.iter().map(|part| part * part).sum::<f64>().sqrt();
            self.num_normalised += usize::from((norm - 1.0).abs() > limits::QUATERNION_NORM_NOTED);
        }
        Ok(Capture {
            base_from_flange,
            written_angles: match base_from_user {
                Some(_) => None,
                None => written_angles(raw.numbers, &notation),
            },
            reading,
            step_mm: raw.step_mm,
            unknown: serde_json::Map::new(),
        })
    }

    fn add(&mut self, raw: &RawPose<'_>, capture: Capture) {
        self.num_poses += 1;
        self.num_points += usize::from(raw.point_in_sensor.is_some() || raw.target.is_some());
        let wanted = raw.label.as_deref().map(usable_label).filter(|label| !label.is_empty());
        let continues = raw.may_continue && wanted.is_some() && wanted == self.last_wanted;
        self.last_wanted.clone_from(&wanted);
        if continues {
            if let Some(last) = self.stations.last_mut() {
                last.captures.push(capture);
            }
        } else {
            let label = self.free_label(&wanted.unwrap_or_else(|| (self.stations.len() + 1).to_string()));
            self.stations.push(Station {
                label,
                enabled: !raw.is_disabled,
                side: raw.side,
                edge: raw.edge,
                captures: vec![capture],
                unknown: serde_json::Map::new(),
            });
        }
        if let Some(name) = raw.profile.filter(|name| !is_missing(name)) {
            let station_idx = self.stations.len() - 1;
            let capture_idx = self.stations[station_idx].captures.len() - 1;
            self.profile_keys.push(ProfileKey { station_idx, capture_idx, name: usable_label(name) });
        }
    }

    /// Gives the pose that was taken last its reading.
    pub fn set_last_reading(&mut self, reading: Reading) {
        if let Some(capture) = self.stations.last_mut().and_then(|station| station.captures.last_mut()) {
            capture.reading = reading;
        }
    }

    /// The label, with a number behind it where another station has it.
    fn free_label(&mut self, wanted: &str) -> String {
        let mut label = wanted.to_owned();
        loop {
            if let Entry::Vacant(entry) = self.labels.entry(hash(&label)) {
                entry.insert(1);
                return label;
            }
            let times = self.labels.entry(hash(wanted)).or_insert(1);
            *times += 1;
            label = format!("{wanted} ({times})");
        }
    }

    /// Makes room for the stations of a text of so many rows.
    pub fn reserve(&mut self, num_rows: usize, num_bytes: usize) {
        /// No pose is shorter; a text of many short lines gets no more room than it could fill.
        const MIN_POSE_BYTES: usize = 24;
        self.stations.reserve_exact(num_rows.min(num_bytes / MIN_POSE_BYTES).min(MAX_POSES));
    }

    /// Notes what all poses together say, when every source is read.
    pub fn finish(&mut self) {
        if self.num_normalised > 0 {
            self.notes.push(Note::QuaternionsNormalised { num_poses: self.num_normalised });
        }
    }
}

fn hash(label: &str) -> u64 {
    let mut hasher = DefaultHasher::new();
    label.hash(&mut hasher);
    hasher.finish()
}

fn user_frame(numbers: &[f64; 6], notation: &PoseNotation) -> Option<Transform<Base, Base>> {
    plain_angles(notation).base_from_flange(numbers).ok().map(|pose| Transform::from_rigid(*pose.rigid()))
}

/// The notation of a frame beside poses: six numbers in their units.
const fn plain_angles(notation: &PoseNotation) -> PoseNotation {
    let orientation = crate::geometry::notation::OrientationForm::Angles;
    PoseNotation { orientation, flange_from_tcp: None, is_inverse: false, ..*notation }
}

fn not_a_pose(problem: &NotAPose) -> (String, String) {
    match problem {
        NotAPose::Count { found, needed } => (format!("{found} numbers"), format!("{needed} for a pose")),
        NotAPose::NotFinite => ("a number that is not finite".to_owned(), "a finite one".to_owned()),
        NotAPose::QuaternionNorm { norm, tolerance } => {
            (format!("a quaternion of norm {norm:.4}"), format!("norm 1 within {tolerance}"))
        }
    }
}

/// A label on one line and of a length that can be shown.
fn usable_label(text: &str) -> String {
    text.trim().chars().filter(|c| !c.is_control()).take(MAX_LABEL_CHARS).collect()
}
