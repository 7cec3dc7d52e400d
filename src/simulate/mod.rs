//! Simulated sessions with their truth: for trying the program without a robot, and for measuring its accuracy.

mod fault;
mod options;
mod parts;
mod path;
pub mod poses;
pub mod room;

use std::collections::HashSet;
use std::sync::Arc;

use crate::calibrate::SideChoice;
use crate::geometry::{Rigid, Transform, Vec3, so3};
use crate::scene::{Random, Scene, rounded, rounded_rotation};
use crate::session::edit::free_label;
use crate::session::model::{
    Capture, FurtherTarget, Known, Reading, Robot, Sensor, Session, Station, Target, Truth, UnknownFields,
};

use path::{Setup, StationPath};

pub use crate::scene::Dirt;
pub use fault::Fault;
pub use options::{RoughMounting, SimulationOptions, SimulationTarget};

/// Decimals of reported quaternions where positions and points are rounded: a thousand times finer than any robot is.
const QUATERNION_DECIMALS: u8 = 9;
/// Decimals of a rough mounting's position.
const ROUGH_DECIMALS: u8 = 4;

/// Random streams, so that each kind of noise can be switched without a change to the others.
mod stream {
    pub const PATH: u64 = 1;
    pub const PROFILE: u64 = 2;
    pub const POSE: u64 = 3;
    pub const DIRT: u64 = 4;
    pub const FAULT: u64 = 5;
    pub const AIM: u64 = 6;
    pub const ROUGH: u64 = 7;
}

/// A session with a target, measured as `options` say, and the truth beside it.
///
/// Every capture's reported pose is its true pose with noise of its own; the profile is what the sensor sees from
/// the true pose. Without noise and rounding the data are exact to `f64`. Values beyond their limits are taken as the
/// limit, see [`SimulationOptions`].
#[must_use]
pub fn simulate(options: &SimulationOptions) -> Session {
    let mut options = options.within_limits();
    if let Some(fault) = options.fault {
        fault.prepare(&mut options);
    }
    let setup = Setup::new(&options);
    let own = measured(&options, &setup);
    let further = options.further.iter().enumerate().map(|(idx, target)| {
        let options = options.of_further(idx, *target);
        let Measurement { target, known, stations, .. } = measured(&options, &setup.beside(idx + 1));
        FurtherTarget {
            name: options.target.name().to_owned(),
            target,
            known,
            profile_std_mm: None,
            stations,
            unknown: UnknownFields::new(),
        }
    });
    let known = |std: f64| (std > 0.0).then_some(std);
    let mut session = Session {
        name: match options.target {
            SimulationTarget::Ball => format!("Simulated ball, {} mm", options.radius_mm),
            SimulationTarget::Part(_) => format!("Simulated {}", options.target.name()),
        },
        notes: String::new(),
        robot: Robot {
            model: "simulated".to_owned(),
            position_std_mm: known(options.position_std_mm),
            orientation_std_deg: known(options.orientation_std_deg),
            ..Robot::default()
        },
        sensor: Sensor {
            model: "simulated".to_owned(),
            profile_std_mm: known(options.profile_std_mm),
            reference_distance_mm: Some(80.0),
            rough_flange_from_sensor: options
                .rough_mounting
                .map(|rough| Transform::from_rigid(rough_mounting(&options, rough, &setup.carrier_from_sensor))),
            unknown: UnknownFields::new(),
        },
        target: own.target,
        known: own.known,
        mount: options.mount,
        stations: own.stations,
        further: named_apart(further.collect()),
        published: None,
        truth: Some(Truth {
            flange_from_sensor: Transform::from_rigid(setup.carrier_from_sensor),
            target_in_base_mm: if options.target.is_workpiece() { Vec3::zeros() } else { setup.target_in_world },
            base_from_plate: own.base_from_plate,
            base_from_target: None,
            unknown: UnknownFields::new(),
        }),
        unknown: UnknownFields::new(),
    };
    if let Some(fault) = options.fault {
        fault.spoil(&options, &mut session);
    }
    session
}

/// One target with its stations.
struct Measurement {
    target: Target,
    known: Known,
    stations: Vec<Station>,
    base_from_plate: Option<Rigid>,
}

fn measured(options: &SimulationOptions, setup: &Setup) -> Measurement {
    let mut randoms = Randoms::new(options.seed);
    match options.target {
        SimulationTarget::Ball => Measurement {
            target: Target::ball(options.radius_mm),
            known: Known::default(),
            stations: ball_stations(options, setup, &mut randoms),
            base_from_plate: None,
        },
        SimulationTarget::Part(kind) => parts::measured(options, setup, kind, &mut randoms),
    }
}

/// Two targets of one kind get numbers.
fn named_apart(mut further: Vec<FurtherTarget>) -> Vec<FurtherTarget> {
    let mut taken = HashSet::new();
    for one in &mut further {
        one.name = free_label(&one.name, &taken);
        taken.insert(one.name.clone());
    }
    further
}

/// The mounting as somebody would estimate it, off in any direction.
fn rough_mounting(options: &SimulationOptions, rough: RoughMounting, carrier_from_sensor: &Rigid) -> Rigid {
    let mut random = Random::new(options.seed, stream::ROUGH);
    let mut any_direction = || random.normal3().normalize();
    let turn = so3::exp(any_direction() * rough.off_deg.to_radians());
    let shift = any_direction() * rough.off_mm;
    let position = carrier_from_sensor.translation.vector + shift;
    Rigid::from_parts(
        position.map(|value| rounded(value, Some(ROUGH_DECIMALS))).into(),
        rounded_rotation(&(carrier_from_sensor.rotation * turn), QUATERNION_DECIMALS),
    )
}

fn ball_stations(options: &SimulationOptions, setup: &Setup, randoms: &mut Randoms) -> Vec<Station> {
    let scene = Scene {
        ball_in_world: setup.target_in_world,
        radius_mm: options.radius_mm,
        num_points: options.num_points,
        range_sign: options.range_sign(),
        profile_std_mm: options.profile_std_mm,
        dirt: options.dirt,
        decimals: options.decimals,
    };
    let mut paths: Vec<StationPath> = (0..options.num_stations)
        .map(|station_idx| StationPath::new(options, setup, station_idx, &mut randoms.path))
        .collect();
    if let Some(fault) = options.fault {
        fault.change_paths(options, &mut paths);
    }
    paths
        .iter()
        .enumerate()
        .map(|(station_idx, path)| station(options, setup, &scene, station_idx, path, randoms))
        .collect()
}

struct Randoms {
    path: Random,
    profile: Random,
    pose: Random,
    dirt: Random,
    aim: Random,
}

impl Randoms {
    fn new(seed: u64) -> Self {
        Self {
            path: Random::new(seed, stream::PATH),
            profile: Random::new(seed, stream::PROFILE),
            pose: Random::new(seed, stream::POSE),
            dirt: Random::new(seed, stream::DIRT),
            aim: Random::new(seed, stream::AIM),
        }
    }
}

fn station(
    options: &SimulationOptions,
    setup: &Setup,
    scene: &Scene,
    station_idx: usize,
    path: &StationPath,
    randoms: &mut Randoms,
) -> Station {
    let scene = &scene.with_ball_shifted_by(
        options.fault.map_or_else(Vec3::zeros, |fault| fault.ball_shift_mm(options, station_idx)),
    );
    let captures = (0..options.num_steps)
        .map(|capture_idx| {
            let world_from_sensor = path.world_from_sensor(capture_idx);
            let true_base_from_flange = setup.base_from_flange(options.mount, &world_from_sensor);
            let profile = scene.profile(&world_from_sensor, &mut randoms.profile, &mut randoms.dirt);
            let is_bad = options.bad_pose_station == Some(station_idx);
            Capture {
                base_from_flange: Transform::from_rigid(reported(
                    &true_base_from_flange,
                    options,
                    is_bad,
                    &mut randoms.pose,
                )),
                written_angles: None,
                reading: Reading::Profile(Arc::new(profile)),
                step_mm: (capture_idx > 0).then_some(path.step_mm),
                unknown: UnknownFields::new(),
            }
        })
        .collect();
    Station {
        label: (station_idx + 1).to_string(),
        enabled: true,
        side: SideChoice::Auto,
        edge: None,
        captures,
        unknown: UnknownFields::new(),
    }
}

/// The pose that the controller would report: with noise, rounded, and shifted at the bad station.
fn reported(true_base_from_flange: &Rigid, options: &SimulationOptions, is_bad: bool, random: &mut Random) -> Rigid {
    let position_error = random.normal3() * options.position_std_mm;
    let orientation_error = random.normal3() * options.orientation_std_deg.to_radians();
    let shift = if is_bad { Vec3::new(0.48, -0.64, 0.6) * SimulationOptions::BAD_POSE_MM } else { Vec3::zeros() };
    let position = true_base_from_flange.translation.vector + position_error + shift;
    // Without noise the rotation stays as it is, to the bit.
    let rotation = if options.orientation_std_deg > 0.0 {
        true_base_from_flange.rotation * so3::exp(orientation_error)
    } else {
        true_base_from_flange.rotation
    };
    let rotation = match options.decimals {
        Some(_) => rounded_rotation(&rotation, QUATERNION_DECIMALS),
        None => rotation,
    };
    Rigid::from_parts(position.map(|value| rounded(value, options.decimals)).into(), rotation)
}

#[cfg(test)]
mod tests;
