//! Simulated sessions of a marker or board whose whole pose a camera sees.

use crate::calibrate::{Mount, SideChoice};
use crate::geometry::{Rigid, Transform, Vec3, so3};
use crate::scene::{Random, rounded, rounded_rotation};
use crate::session::model::{Capture, Known, Reading, Robot, Sensor, Session, Station, Target, Truth, UnknownFields};

use super::{QUATERNION_DECIMALS, SimulationOptions, stream};

/// What is simulated.
#[derive(Clone, Debug, PartialEq)]
pub struct PoseOptions {
    /// The same seed gives the same session.
    pub seed: u64,
    /// Number of stations, one capture each.
    pub num_stations: usize,
    /// How far the camera tilts about two axes, degrees.
    pub tilt_deg: f64,
    /// How far it turns about its line of sight, either way, degrees.
    pub spin_deg: f64,
    /// Standard deviation of each coordinate of a reported position, mm.
    pub position_std_mm: f64,
    /// Standard deviation of a reported orientation about each axis, degrees.
    pub orientation_std_deg: f64,
    /// Standard deviation of each coordinate of the target's origin in the camera, mm.
    pub target_std_mm: f64,
    /// Standard deviation of the target's orientation about each axis, degrees.
    pub target_std_deg: f64,
    /// Where the camera is.
    pub mount: Mount,
    /// The index of a station whose reported pose is wrong by [`SimulationOptions::BAD_POSE_MM`].
    pub bad_pose_station: Option<usize>,
    /// Decimals of positions; `None`: unrounded.
    pub decimals: Option<u8>,
}

impl Default for PoseOptions {
    /// A board of a hand's size, half a metre away.
    fn default() -> Self {
        let usual = SimulationOptions::default();
        Self {
            seed: usual.seed,
            num_stations: 15,
            tilt_deg: 25.0,
            spin_deg: 60.0,
            position_std_mm: usual.position_std_mm,
            orientation_std_deg: usual.orientation_std_deg,
            target_std_mm: 0.2,
            target_std_deg: 0.1,
            mount: Mount::OnFlange,
            bad_pose_station: None,
            decimals: None,
        }
    }
}

/// From the camera to the board, mm, and how much that varies.
const RANGE_MM: [f64; 2] = [500.0, 80.0];
/// How far the board's origin is off the line of sight, mm.
const OFF_CENTRE_MM: f64 = 60.0;

/// A session with the poses of a board and the truth beside it.
#[must_use]
pub fn simulate_poses(options: &PoseOptions) -> Session {
    let mut path = Random::new(options.seed, stream::PATH);
    let mut noise = Random::new(options.seed, stream::POSE);
    let carrier_from_sensor =
        Rigid::from_parts(Vec3::new(42.0, -18.0, 65.0).into(), so3::exp(Vec3::new(0.08, -0.05, 1.5)));
    let (carrier_from_sensor, world_from_target) = match options.mount {
        Mount::OnFlange => (carrier_from_sensor, board(Vec3::new(560.0, -40.0, 12.0))),
        // The camera looks at the robot from beside it, the board is on the flange.
        Mount::Fixed => (
            Rigid::from_parts(Vec3::new(900.0, 150.0, 420.0).into(), so3::exp(Vec3::new(0.1, -2.1, 0.3))),
            board(Vec3::new(10.0, 25.0, 90.0)),
        ),
    };
    let stations = (0..options.num_stations)
        .map(|idx| {
            let sensor_from_target = look(options, &mut path);
            let world_from_carrier = world_from_target * sensor_from_target.inverse() * carrier_from_sensor.inverse();
            let base_from_flange = match options.mount {
                Mount::OnFlange => world_from_carrier,
                Mount::Fixed => world_from_carrier.inverse(),
            };
            let mut reported = noisy(
                &base_from_flange,
                [options.position_std_mm, options.orientation_std_deg],
                &mut noise,
                options.decimals,
            );
            if options.bad_pose_station == Some(idx) {
                reported.translation.vector.x += SimulationOptions::BAD_POSE_MM;
            }
            let seen = noisy(
                &sensor_from_target,
                [options.target_std_mm, options.target_std_deg],
                &mut noise,
                options.decimals,
            );
            Station {
                label: (idx + 1).to_string(),
                enabled: true,
                side: SideChoice::Auto,
                edge: None,
                captures: vec![Capture {
                    base_from_flange: Transform::from_rigid(reported),
                    written_angles: None,
                    reading: Reading::Pose(Transform::from_rigid(seen)),
                    step_mm: None,
                    unknown: UnknownFields::new(),
                }],
                unknown: UnknownFields::new(),
            }
        })
        .collect();
    let known = |std: f64| (std > 0.0).then_some(std);
    Session {
        name: "Simulated poses of a board".to_owned(),
        notes: String::new(),
        robot: Robot {
            model: "simulated".to_owned(),
            position_std_mm: known(options.position_std_mm),
            orientation_std_deg: known(options.orientation_std_deg),
            ..Robot::default()
        },
        sensor: Sensor { model: "simulated".to_owned(), reference_distance_mm: Some(RANGE_MM[0]), ..Sensor::default() },
        target: Target::Pose {
            translation_std_mm: known(options.target_std_mm),
            rotation_std_deg: known(options.target_std_deg),
        },
        known: Known::default(),
        mount: options.mount,
        stations,
        further: Vec::new(),
        published: None,
        truth: Some(Truth {
            flange_from_sensor: Transform::from_rigid(carrier_from_sensor),
            target_in_base_mm: world_from_target.translation.vector,
            base_from_plate: None,
            base_from_target: Some(world_from_target),
            unknown: UnknownFields::new(),
        }),
        unknown: UnknownFields::new(),
    }
}

/// A board that lies flat, a little turned.
fn board(place: Vec3) -> Rigid {
    Rigid::from_parts(place.into(), so3::exp(Vec3::z() * 0.35))
}

/// Where the camera sees the board: in front of it, tilted and turned.
fn look(options: &PoseOptions, path: &mut Random) -> Rigid {
    let (tilt, spin) = (options.tilt_deg.to_radians(), options.spin_deg.to_radians());
    let place = Vec3::new(
        OFF_CENTRE_MM * path.signed_unit(),
        OFF_CENTRE_MM * path.signed_unit(),
        RANGE_MM[0] + RANGE_MM[1] * path.signed_unit(),
    );
    let tilted = so3::exp(Vec3::new(tilt * path.signed_unit(), tilt * path.signed_unit(), 0.0));
    let turned = so3::exp(Vec3::z() * (spin * path.signed_unit()));
    // The board's z points at the camera.
    let facing = so3::exp(Vec3::x() * std::f64::consts::PI);
    Rigid::from_parts(place.into(), turned * tilted * facing)
}

fn noisy(pose: &Rigid, [std_mm, std_deg]: [f64; 2], noise: &mut Random, decimals: Option<u8>) -> Rigid {
    let place = pose.translation.vector + noise.normal3() * std_mm;
    let rotation = pose.rotation * so3::exp(noise.normal3() * std_deg.to_radians());
    Rigid::from_parts(
        place.map(|value| rounded(value, decimals)).into(),
        if decimals.is_some() { rounded_rotation(&rotation, QUATERNION_DECIMALS) } else { rotation },
    )
}
