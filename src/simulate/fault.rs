//! What people get wrong, done on purpose: one fault in an otherwise clean session, for trying the diagnosis.

use std::sync::Arc;

use nalgebra::{Quaternion, Translation3, UnitQuaternion};

use crate::calibrate::{Mount, Side, SideChoice};
use crate::geometry::{PoseConvention, Profile, Rigid, Transform, Vec3, so3};
use crate::scene::Random;
use crate::session::model::{Capture, Reading, Session, Target, Truth, WrittenAngles};

use super::options::SimulationOptions;
use super::path::StationPath;
use super::stream;

/// A fault. Its name is the code that the diagnosis gives it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// FANUC's W, P, R read as KUKA's A, B, C.
    PoseConvention,
    /// Quaternions written x y z w and read w x y z.
    QuaternionOrder,
    /// The controller's poses the wrong way round: flange from base.
    InvertedPoses,
    /// Positions in metres.
    PositionUnit,
    /// Angles in radians.
    AngleUnit,
    /// One section a station, all sides given, two of them the wrong one.
    WrongSide,
    /// One section a station, all sides given, the profiles' x the other way round.
    MirroredX,
    /// The sensor's height given for its distance, so that arcs bulge away from the sensor.
    MirroredZ,
    /// All stations look the same way.
    NoRotation,
    /// All stations look nearly the same way.
    LittleRotation,
    /// The stations turn about the vertical and never tilt.
    OneAxis,
    /// Two stations measured from the same pose.
    TwinPoses,
    /// The session gives the radius 0.3 mm too large.
    WrongRadius,
    /// Profiles 2 % too small.
    ProfileScale,
    /// The robot travels 5° off the laser's normal.
    TravelOffNormal,
    /// The file's steps are a tenth larger than the robot's moves.
    StepDiffersFromPose,
    /// The ball moves by 0.5 mm in the course of the session.
    Drift,
    /// From the middle on the poses are those of an active TOOL.
    ToolFrame,
    /// The poses of one station are off by [`SimulationOptions::BAD_POSE_MM`].
    WrongPose,
    /// One station has the poses of the one before.
    StalePose,
    /// The poses of two stations are exchanged.
    MixedOrder,
    /// The poses are ten times noisier than the session says.
    NoiseAboveStated,
}

/// How much too large the radius is given, mm.
const RADIUS_ERROR_MM: f64 = 0.3;
/// Size of the profiles over their true size.
const PROFILE_SCALE: f64 = 0.98;
/// Steps in the file over the robot's moves.
const STEP_SCALE: f64 = 1.1;
/// How far the ball moves from the first station to the last, mm: a stand that warms up.
const DRIFT_MM: Vec3 = Vec3::new(0.3, 0.0, 0.4);
/// Real noise of the poses over the stated.
const NOISE_FACTOR: f64 = 10.0;

impl Fault {
    /// All of them, in the order of the documentation.
    pub const ALL: [Self; 22] = [
        Self::PoseConvention,
        Self::QuaternionOrder,
        Self::InvertedPoses,
        Self::PositionUnit,
        Self::AngleUnit,
        Self::WrongSide,
        Self::MirroredX,
        Self::MirroredZ,
        Self::NoRotation,
        Self::LittleRotation,
        Self::OneAxis,
        Self::TwinPoses,
        Self::WrongRadius,
        Self::ProfileScale,
        Self::TravelOffNormal,
        Self::StepDiffersFromPose,
        Self::Drift,
        Self::ToolFrame,
        Self::WrongPose,
        Self::StalePose,
        Self::MixedOrder,
        Self::NoiseAboveStated,
    ];

    /// The name on the command line.
    #[must_use]
    pub const fn id(self) -> &'static str {
        match self {
            Self::PoseConvention => "pose-convention",
            Self::QuaternionOrder => "quaternion-order",
            Self::InvertedPoses => "inverted-poses",
            Self::PositionUnit => "position-unit",
            Self::AngleUnit => "angle-unit",
            Self::WrongSide => "wrong-side",
            Self::MirroredX => "mirrored-x",
            Self::MirroredZ => "mirrored-z",
            Self::NoRotation => "no-rotation",
            Self::LittleRotation => "little-rotation",
            Self::OneAxis => "one-axis",
            Self::TwinPoses => "twin-poses",
            Self::WrongRadius => "wrong-radius",
            Self::ProfileScale => "profile-scale",
            Self::TravelOffNormal => "travel-off-normal",
            Self::StepDiffersFromPose => "step-differs-from-pose",
            Self::Drift => "drift",
            Self::ToolFrame => "tool-frame",
            Self::WrongPose => "wrong-pose",
            Self::StalePose => "stale-pose",
            Self::MixedOrder => "mixed-order",
            Self::NoiseAboveStated => "noise-above-stated",
        }
    }

    /// The fault with this name.
    #[must_use]
    pub fn by_id(id: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|fault| fault.id() == id)
    }

    /// The options with which a session with this fault is measured.
    pub(super) fn prepare(self, options: &mut SimulationOptions) {
        match self {
            // With several sections a station nobody is asked for sides.
            Self::WrongSide | Self::MirroredX => options.num_steps = 1,
            Self::NoRotation => (options.tilt_deg, options.spin_deg) = (0.0, 0.0),
            Self::LittleRotation => (options.tilt_deg, options.spin_deg) = (4.0, 6.0),
            Self::OneAxis => options.tilt_deg = 0.0,
            Self::TravelOffNormal => options.travel_off_normal_deg = 5.0,
            Self::WrongPose => {
                options.bad_pose_station = picked_stations(options).map(|[station, _]| station);
            }
            Self::NoiseAboveStated => {
                options.position_std_mm *= NOISE_FACTOR;
                options.orientation_std_deg *= NOISE_FACTOR;
            }
            _ => {}
        }
    }

    /// Where the robot goes with this fault.
    pub(super) fn change_paths(self, options: &SimulationOptions, paths: &mut [StationPath]) {
        if let (Self::TwinPoses, Some([first, second])) = (self, picked_stations(options)) {
            paths[second] = paths[first].clone();
        }
    }

    /// How far the ball has moved at a station, mm.
    #[expect(clippy::cast_precision_loss, reason = "a session has far fewer than 2^52 stations")]
    pub(super) fn ball_shift_mm(self, options: &SimulationOptions, station_idx: usize) -> Vec3 {
        match self {
            Self::Drift => DRIFT_MM * (station_idx as f64 / options.num_stations.max(2).saturating_sub(1) as f64),
            _ => Vec3::zeros(),
        }
    }

    /// Spoils what was measured.
    pub(super) fn spoil(self, options: &SimulationOptions, session: &mut Session) {
        match self {
            Self::PoseConvention => read_fanuc_as_kuka(session),
            Self::QuaternionOrder => change_poses(session, |pose| {
                let q = pose.rotation.coords;
                let misread = UnitQuaternion::new_unchecked(Quaternion::new(q.x, q.y, q.z, q.w));
                Rigid::from_parts(pose.translation, misread)
            }),
            Self::InvertedPoses => change_poses(session, Rigid::inverse),
            Self::PositionUnit => change_poses(session, |pose| {
                Rigid::from_parts(Translation3::from(pose.translation.vector / 1000.0), pose.rotation)
            }),
            Self::AngleUnit => read_radians_as_degrees(session),
            Self::WrongSide => {
                give_sides(session);
                for station_idx in picked_stations(options).into_iter().flatten() {
                    if let SideChoice::Given(side) = session.stations[station_idx].side {
                        session.stations[station_idx].side = SideChoice::Given(side.flipped());
                    }
                }
            }
            Self::MirroredX => {
                give_sides(session);
                change_profiles(session, |x, z| (-x, z));
            }
            Self::MirroredZ => {
                let range_sign = if options.z_towards_sensor { -1.0 } else { 1.0 };
                let twice_mm = 2.0 * range_sign * session.sensor.reference_distance_mm.unwrap_or(0.0);
                change_profiles(session, |x, z| (x, twice_mm - z));
            }
            Self::WrongRadius => {
                session.target = Target::Ball { radius_mm: options.radius_mm + RADIUS_ERROR_MM, radius_std_mm: None }
            }
            Self::ProfileScale => change_profiles(session, |x, z| (x * PROFILE_SCALE, z * PROFILE_SCALE)),
            Self::StepDiffersFromPose => {
                for step_mm in captures(session).filter_map(|capture| capture.step_mm.as_mut()) {
                    *step_mm *= STEP_SCALE;
                }
            }
            Self::ToolFrame => {
                let flange_from_tool =
                    Rigid::from_parts(Translation3::new(5.0, -3.0, 60.0), so3::exp(Vec3::z() * 30.0_f64.to_radians()));
                let middle = session.stations.len() / 2;
                for capture in session.stations.iter_mut().skip(middle).flat_map(|station| &mut station.captures) {
                    capture.base_from_flange =
                        Transform::from_rigid(*capture.base_from_flange.rigid() * flange_from_tool);
                }
            }
            Self::StalePose => {
                if let Some([station_idx, _]) = picked_stations(options) {
                    // The first one has no predecessor.
                    let stale = station_idx.max(1);
                    take_poses(session, &[(stale, stale - 1)]);
                }
            }
            Self::MixedOrder => {
                if let Some([first, second]) = picked_stations(options) {
                    take_poses(session, &[(first, second), (second, first)]);
                }
            }
            Self::NoiseAboveStated => {
                for std in [&mut session.robot.position_std_mm, &mut session.robot.orientation_std_deg] {
                    *std = std.map(|real| real / NOISE_FACTOR);
                }
            }
            Self::NoRotation
            | Self::LittleRotation
            | Self::OneAxis
            | Self::TwinPoses
            | Self::TravelOffNormal
            | Self::Drift
            | Self::WrongPose => {}
        }
    }
}

/// Two stations by chance; `None` with fewer.
#[expect(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "few stations, and a part of their number"
)]
fn picked_stations(options: &SimulationOptions) -> Option<[usize; 2]> {
    let num = options.num_stations;
    if num < 2 {
        return None;
    }
    let mut random = Random::new(options.seed, stream::FAULT);
    let first = (random.unit() * num as f64) as usize;
    let apart = 1 + (random.unit() * (num - 1) as f64) as usize;
    Some([first, (first + apart) % num])
}

fn captures(session: &mut Session) -> impl Iterator<Item = &mut Capture> {
    session.stations.iter_mut().flat_map(|station| &mut station.captures)
}

fn change_poses(session: &mut Session, change: impl Fn(&Rigid) -> Rigid) {
    for capture in captures(session) {
        capture.base_from_flange = Transform::from_rigid(change(capture.base_from_flange.rigid()));
    }
}

/// Gives stations the poses of others, `(station, whose)`, all at once.
fn take_poses(session: &mut Session, pairs: &[(usize, usize)]) {
    let before: Vec<Vec<_>> = session
        .stations
        .iter()
        .map(|station| station.captures.iter().map(|capture| capture.base_from_flange).collect())
        .collect();
    for (to, from) in pairs {
        for (capture, pose) in session.stations[*to].captures.iter_mut().zip(&before[*from]) {
            capture.base_from_flange = *pose;
        }
    }
}

fn change_profiles(session: &mut Session, change: impl Fn(f64, f64) -> (f64, f64)) {
    for capture in captures(session) {
        let Reading::Profile(profile) = &capture.reading else { continue };
        let (x_mm, z_mm): (Vec<f64>, Vec<Option<f64>>) = profile
            .x_mm()
            .iter()
            .zip(profile.z_mm())
            .map(|(x, z)| {
                let (x, z) = change(*x, *z);
                (x, (!z.is_nan()).then_some(z))
            })
            .unzip();
        // Points stay within reach, as the changes are small or turn the profile about its middle.
        if let Ok(changed) = Profile::new(x_mm, &z_mm) {
            capture.reading = Reading::Profile(Arc::new(changed));
        }
    }
}

fn give_sides(session: &mut Session) {
    let Some(Truth { flange_from_sensor, target_in_base_mm, .. }) = session.truth else { return };
    for station in &mut session.stations {
        let Some(first) = station.captures.first() else { continue };
        let world_from_carrier = match session.mount {
            Mount::OnFlange => *first.base_from_flange.rigid(),
            Mount::Fixed => first.base_from_flange.rigid().inverse(),
        };
        let world_from_sensor = world_from_carrier * flange_from_sensor.rigid();
        let y = world_from_sensor.inverse_transform_point(&target_in_base_mm.into()).y;
        station.side = SideChoice::Given(if y < 0.0 { Side::Minus } else { Side::Plus });
    }
}

fn read_fanuc_as_kuka(session: &mut Session) {
    let [Some(fanuc), Some(kuka)] = ["fanuc-wpr", "kuka-abc"].map(PoseConvention::by_id) else { return };
    session.robot.notation.convention = kuka;
    write_angles(session, |rotation| fanuc.angles_deg_from_rotation(rotation));
}

fn read_radians_as_degrees(session: &mut Session) {
    let convention = session.robot.notation.convention;
    write_angles(session, |rotation| convention.angles_deg_from_rotation(rotation).map(f64::to_radians));
}

/// Writes the orientations as three numbers, and reads them as degrees in the session's convention.
fn write_angles(session: &mut Session, written: impl Fn(&UnitQuaternion<f64>) -> [f64; 3]) {
    let convention = session.robot.notation.convention;
    for capture in captures(session) {
        let angles_deg = written(&capture.base_from_flange.rotation());
        capture.base_from_flange = Transform::from_parts(
            capture.base_from_flange.translation_mm(),
            convention.rotation_from_angles_deg(angles_deg),
        );
        capture.written_angles = Some(WrittenAngles { angles_deg, convention });
    }
}
