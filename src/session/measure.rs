//! From a session's profiles to arcs and edge points, and from these to the problem that the methods solve. Profiles of a scan
//! are kept as they are: nothing is looked for in them.

use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

use thiserror::Error;

use crate::calibrate::{self, BallProblem, MotionProblem, Mount, PlateProblem, PlateStation, Problem, TargetNoise};
use crate::fit::{ArcOptions, EdgeOptions, Feature, Sought};
use crate::geometry::{Profile, Transform};
use crate::odometry::OdometryOptions;
use crate::watch::{Cancelled, Watch};

use super::sequence::{FrameError, Sequence, SequenceError, TrackedSequence};
use super::{FurtherTarget, Reading, Session, Station, Target};

/// Why a session is none for the ball methods.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[error(
    "the session's target is {kind}, not a ball; the ball methods need \"target\": {{\"kind\": \"ball\", \"radius_mm\": …}}"
)]
pub struct NotABallSession {
    /// What the target is.
    pub kind: &'static str,
}

/// Why no method computes a calibration from a target.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum NothingToSolve {
    /// A workpiece is measured with a calibration, not for one.
    #[error("the session's target is a workpiece: it shows what a calibration is worth, but none is computed from it")]
    Workpiece,
    /// A sequence lies beside its session's file, and there is none, or nobody has looked at the sequence.
    #[error(
        "the RGB-D sequence in the folder {folder} was not tracked; it is looked for beside the session's file, so a \
         session without one has to be saved there first"
    )]
    SequenceWithoutPlace {
        /// The folder's name.
        folder: String,
    },
    /// The sequence cannot be read.
    #[error(transparent)]
    Sequence(#[from] SequenceError),
    /// No frame has a pose.
    #[error("no frame of the sequence has a pose{}", first_reason.as_ref().map_or_else(String::new, |reason| format!(": {reason}")))]
    NothingTracked {
        /// What is wrong with the first frame that could not be read.
        first_reason: Option<FrameError>,
    },
    /// The camera's motion is known, but not the robot's.
    #[error(
        "the sequence has no flange.txt with two poses of the robot or more: the camera's motion is known, but not how it is mounted"
    )]
    NoFlange,
}

/// What is looked for in the profiles of a target; `None` where the profiles themselves are the result.
#[must_use]
pub const fn sought(target: &Target, profile_std_mm: Option<f64>) -> Option<Sought> {
    match target {
        Target::Ball { radius_mm, .. } => Some(Sought::Arc(ArcOptions { ball_radius_mm: *radius_mm, profile_std_mm })),
        Target::RightAnglePlate => Some(Sought::Edge(EdgeOptions { feature: None, profile_std_mm })),
        Target::Point => Some(Sought::Edge(EdgeOptions { feature: Some(Feature::Tip), profile_std_mm })),
        Target::Pose { .. } | Target::Workpiece | Target::Rgbd { .. } => None,
    }
}

fn seen(sought: Option<&Sought>, profile: &Profile) -> Seen {
    sought.map_or_else(|| Seen::Scan(ScanLine::of(profile)), |sought| Seen::Target(sought.find(profile).into()))
}

/// A profile of a scan: which part of the surface it holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScanLine {
    /// Points of the profile, valid or not.
    pub num_points: usize,
    /// Those that are valid.
    pub num_valid: usize,
    /// Least and greatest x and z of these, mm; none where nothing was seen.
    pub range_mm: Option<ScanRange>,
}

/// Where the valid points of a profile lie, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScanRange {
    /// Least and greatest place across the line.
    pub x_mm: [f64; 2],
    /// Least and greatest range.
    pub z_mm: [f64; 2],
}

impl ScanLine {
    /// Looks through a profile.
    #[must_use]
    pub fn of(profile: &Profile) -> Self {
        let widened = |[low, high]: [f64; 2], value: f64| [low.min(value), high.max(value)];
        let nothing = [f64::INFINITY, f64::NEG_INFINITY];
        let (num_valid, x_mm, z_mm) = profile
            .valid_points()
            .fold((0, nothing, nothing), |(num, xs, zs), (_, x, z)| (num + 1, widened(xs, x), widened(zs, z)));
        Self { num_points: profile.len(), num_valid, range_mm: (num_valid > 0).then_some(ScanRange { x_mm, z_mm }) }
    }
}

/// What a capture holds.
#[derive(Clone, Debug)]
enum Seen {
    /// Something of a target that a calibration is computed from, or why not.
    Target(calibrate::Reading),
    /// A line over a workpiece.
    Scan(ScanLine),
}

#[derive(Clone, Debug)]
struct MeasuredCapture {
    profile: Option<Arc<Profile>>,
    seen: Seen,
}

impl MeasuredCapture {
    const fn reading(&self) -> Option<&calibrate::Reading> {
        match &self.seen {
            Seen::Target(reading) => Some(reading),
            Seen::Scan(_) => None,
        }
    }
}

/// The readings of one target's captures, enabled or not.
#[derive(Clone, Debug)]
struct MeasuredTarget {
    sought: Option<Sought>,
    stations: Vec<Vec<MeasuredCapture>>,
}

/// The readings of all captures of a session, enabled or not: what was found in its profiles.
#[derive(Clone, Debug)]
pub struct Measured {
    target: MeasuredTarget,
    further: Vec<MeasuredTarget>,
    sequence: Option<Result<Arc<TrackedSequence>, SequenceError>>,
}

impl Measured {
    /// The same with the session's sequence tracked, or why it cannot be read.
    #[must_use]
    pub fn with_sequence(self, sequence: Result<Arc<TrackedSequence>, SequenceError>) -> Self {
        Self { sequence: Some(sequence), ..self }
    }

    /// What is known of the sequence that a target names; none of another one.
    fn sequence_of(&self, target: &Target) -> Option<Result<Arc<TrackedSequence>, SequenceError>> {
        let Target::Rgbd { sequence: folder } = target else { return None };
        let named: PathBuf = Path::new(folder).components().filter(|part| *part != Component::CurDir).collect();
        self.sequence
            .clone()
            .filter(|known| known.as_ref().map_or(true, |tracked| tracked.sequence.folder.ends_with(&named)))
    }

    /// The motion that the camera of an RGB-D session saw.
    #[must_use]
    pub fn sequence(&self) -> Option<&TrackedSequence> {
        self.sequence.as_ref()?.as_deref().ok()
    }

    /// What was found in a capture; none in one of a scan, see [`Self::scan_line`].
    #[must_use]
    pub fn reading(&self, station_idx: usize, capture_idx: usize) -> Option<&calibrate::Reading> {
        self.target.capture(station_idx, capture_idx)?.reading()
    }

    /// What a profile of a scan holds; none of a target in which something is looked for.
    #[must_use]
    pub fn scan_line(&self, station_idx: usize, capture_idx: usize) -> Option<&ScanLine> {
        match &self.target.capture(station_idx, capture_idx)?.seen {
            Seen::Scan(line) => Some(line),
            Seen::Target(_) => None,
        }
    }

    /// What was found in a capture of a further target; none in one of a scan.
    #[must_use]
    pub fn further_reading(
        &self,
        further_idx: usize,
        station_idx: usize,
        capture_idx: usize,
    ) -> Option<&calibrate::Reading> {
        self.further.get(further_idx)?.capture(station_idx, capture_idx)?.reading()
    }
}

impl MeasuredTarget {
    fn capture(&self, station_idx: usize, capture_idx: usize) -> Option<&MeasuredCapture> {
        self.stations.get(station_idx)?.get(capture_idx)
    }
}

/// The same as [`measure`] for a session whose file is in `folder`: a sequence that it names is tracked.
///
/// # Errors
/// [`Cancelled`] if `watch` says so.
pub fn measure_in(folder: &Path, session: &Session, watch: &mut dyn Watch) -> Result<Measured, Cancelled> {
    let measured = measure(session, None, watch)?;
    let Target::Rgbd { sequence } = &session.target else { return Ok(measured) };
    Ok(measured.with_sequence(match Sequence::open(&folder.join(sequence)) {
        Ok(sequence) => Ok(Arc::new(TrackedSequence::track(Arc::new(sequence), OdometryOptions::default(), watch)?)),
        Err(error) => Err(error),
    }))
}

/// Looks for arcs or edges in all profiles; what `previous` already holds is taken over, a tracked sequence as well.
///
/// # Errors
/// [`Cancelled`] if `watch` says so.
pub fn measure(session: &Session, previous: Option<&Measured>, watch: &mut dyn Watch) -> Result<Measured, Cancelled> {
    let of_further = session.further.iter().flat_map(|further| &further.stations);
    let total = session.num_captures() + of_further.map(|station| station.captures.len()).sum::<usize>();
    let mut done = 0;
    let mut step = || {
        watch.report(done, total)?;
        done += 1;
        Ok(())
    };
    let std_mm = session.sensor.profile_std_mm;
    let known = previous.map(|measured| &measured.target);
    let target = measure_target(&session.target, &session.stations, std_mm, known, &mut step)?;
    let further = session
        .further
        .iter()
        .enumerate()
        .map(|(idx, further)| {
            let known = previous.and_then(|measured| measured.further.get(idx));
            let std_mm = further.profile_std_mm.or(std_mm);
            measure_target(&further.target, &further.stations, std_mm, known, &mut step)
        })
        .collect::<Result<_, _>>()?;
    let sequence = previous.and_then(|measured| measured.sequence_of(&session.target));
    Ok(Measured { target, further, sequence })
}

fn measure_target(
    target: &Target,
    stations: &[Station],
    profile_std_mm: Option<f64>,
    previous: Option<&MeasuredTarget>,
    step: &mut impl FnMut() -> Result<(), Cancelled>,
) -> Result<MeasuredTarget, Cancelled> {
    let sought = sought(target, profile_std_mm);
    let previous = previous.filter(|measured| measured.sought == sought);
    let mut measured = Vec::with_capacity(stations.len());
    for (station_idx, station) in stations.iter().enumerate() {
        let mut captures = Vec::with_capacity(station.captures.len());
        for (capture_idx, capture) in station.captures.iter().enumerate() {
            step()?;
            captures.push(match &capture.reading {
                Reading::Point(point_in_sensor) => {
                    MeasuredCapture { profile: None, seen: Seen::Target(calibrate::Reading::Point(*point_in_sensor)) }
                }
                Reading::Pose(sensor_from_target) => {
                    MeasuredCapture { profile: None, seen: Seen::Target(calibrate::Reading::Pose(*sensor_from_target)) }
                }
                Reading::Profile(profile) => previous
                    .and_then(|measured| measured.stations.get(station_idx)?.get(capture_idx))
                    .filter(|known| known.profile.as_ref().is_some_and(|known| Arc::ptr_eq(known, profile)))
                    .cloned()
                    .unwrap_or_else(|| MeasuredCapture {
                        profile: Some(Arc::clone(profile)),
                        seen: seen(sought.as_ref(), profile),
                    }),
            });
        }
        measured.push(captures);
    }
    Ok(MeasuredTarget { sought, stations: measured })
}

/// The problem that the enabled stations of the session's own target pose. For a fixed sensor every pose is inverted, see
/// [`calibrate`].
///
/// # Errors
/// [`NothingToSolve`] for a target that no calibration is computed from.
pub fn problem(session: &Session, measured: &Measured) -> Result<Problem, NothingToSolve> {
    if let Target::Rgbd { sequence } = &session.target {
        return match &measured.sequence {
            None => Err(NothingToSolve::SequenceWithoutPlace { folder: sequence.clone() }),
            Some(Err(error)) => Err(error.clone().into()),
            Some(Ok(tracked)) if tracked.counts().tracked == 0 => {
                let broken = tracked.records.iter().find_map(|record| record.outcome.as_ref().err());
                Err(NothingToSolve::NothingTracked { first_reason: broken.cloned() })
            }
            Some(Ok(tracked)) => tracked.streams(session).map(Problem::Streams).ok_or(NothingToSolve::NoFlange),
        };
    }
    let std_mm = session.sensor.profile_std_mm;
    posed(session, &session.target, std_mm, &session.stations, &measured.target)
}

/// The same for one of the further targets.
///
/// # Errors
/// As [`problem`].
///
/// # Panics
/// If there is no such target.
pub fn problem_of(session: &Session, measured: &Measured, further_idx: usize) -> Result<Problem, NothingToSolve> {
    let FurtherTarget { target, stations, profile_std_mm, .. } = &session.further[further_idx];
    let std_mm = profile_std_mm.or(session.sensor.profile_std_mm);
    posed(session, target, std_mm, stations, &measured.further[further_idx])
}

/// The problem posed by the enabled stations of a ball session.
///
/// # Errors
/// [`NotABallSession`] for any other target.
pub fn ball_problem(session: &Session, measured: &Measured) -> Result<BallProblem, NotABallSession> {
    match problem(session, measured) {
        Ok(Problem::Ball(ball)) => Ok(ball),
        Ok(Problem::Plate(_)) => Err(NotABallSession { kind: "a right-angle plate" }),
        Ok(Problem::Point(_)) => Err(NotABallSession { kind: "a point" }),
        Ok(Problem::Motion(_)) => Err(NotABallSession { kind: "a pose" }),
        Err(NothingToSolve::Workpiece) => Err(NotABallSession { kind: "a workpiece" }),
        Ok(Problem::Streams(_))
        | Err(
            NothingToSolve::SequenceWithoutPlace { .. }
            | NothingToSolve::Sequence(_)
            | NothingToSolve::NothingTracked { .. }
            | NothingToSolve::NoFlange,
        ) => Err(NotABallSession { kind: "an RGB-D sequence" }),
    }
}

fn posed(
    session: &Session,
    target: &Target,
    profile_std_mm: Option<f64>,
    stations: &[Station],
    measured: &MeasuredTarget,
) -> Result<Problem, NothingToSolve> {
    let noise = session.robot.noise();
    let reference_distance_mm = session.sensor.reference_distance_mm;
    let used = stations.iter().zip(&measured.stations).enumerate().filter(|(_, (station, _))| station.enabled);
    let posed = used.map(|(idx, (station, readings))| (station, posed_station(session.mount, idx, station, readings)));
    let of_centres = |radius_mm, radius_std_mm, stations| BallProblem {
        radius_mm,
        radius_std_mm,
        mount: session.mount,
        noise,
        reference_distance_mm,
        stations,
    };
    Ok(match target {
        Target::Ball { radius_mm, radius_std_mm } => {
            Problem::Ball(of_centres(*radius_mm, *radius_std_mm, posed.map(|(_, station)| station).collect()))
        }
        Target::Point => Problem::Point(of_centres(0.0, None, posed.map(|(_, station)| of_tips(station)).collect())),
        Target::RightAnglePlate => Problem::Plate(PlateProblem {
            mount: session.mount,
            noise,
            profile_std_mm,
            reference_distance_mm,
            rough_flange_from_sensor: session.sensor.rough_flange_from_sensor,
            stations: posed.filter_map(|(given, station)| Some(PlateStation { edge: given.edge?, station })).collect(),
        }),
        Target::Pose { translation_std_mm, rotation_std_deg } => Problem::Motion(MotionProblem {
            mount: session.mount,
            noise,
            target_noise: TargetNoise {
                translation_std_mm: *translation_std_mm,
                rotation_std_rad: rotation_std_deg.map(f64::to_radians),
            },
            reference_distance_mm,
            stations: posed.map(|(_, station)| station).collect(),
        }),
        Target::Workpiece => return Err(NothingToSolve::Workpiece),
        // As a further target a session takes none.
        Target::Rgbd { sequence } => {
            return Err(NothingToSolve::SequenceWithoutPlace { folder: sequence.clone() });
        }
    })
}

fn posed_station(mount: Mount, idx: usize, station: &Station, readings: &[MeasuredCapture]) -> calibrate::Station {
    let mut travel_mm = Some(0.0);
    let captures = station
        .captures
        .iter()
        .zip(readings)
        .enumerate()
        .filter_map(|(capture_idx, (capture, measured_capture))| {
            if capture_idx > 0 {
                travel_mm = travel_mm.zip(capture.step_mm).map(|(travel, step)| travel + step);
            }
            Some(calibrate::Capture {
                base_from_flange: match mount {
                    Mount::OnFlange => capture.base_from_flange,
                    Mount::Fixed => Transform::from_rigid(capture.base_from_flange.rigid().inverse()),
                },
                commanded_travel_mm: travel_mm,
                reading: measured_capture.reading()?.clone(),
            })
        })
        .collect();
    calibrate::Station { idx, label: station.label.clone(), side: station.side, captures }
}

/// A tip seen in a profile is a point like one that was reduced elsewhere.
fn of_tips(station: calibrate::Station) -> calibrate::Station {
    let captures = station
        .captures
        .into_iter()
        .map(|capture| match capture.reading.point_in_sensor_mm() {
            Some(point) => calibrate::Capture { reading: calibrate::Reading::Point(point), ..capture },
            None => capture,
        })
        .collect();
    calibrate::Station { captures, ..station }
}
