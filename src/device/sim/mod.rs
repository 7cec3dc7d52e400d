//! A simulated cell that serves the real protocols on loopback: for practice, and for tests.
//!
//! An arm with its real reach (`chain`, `motion`), a profiler with its real field of view (`head`) and a ball on a post or a
//! part on a table (`subject`) stand in one `world`; `server` answers for them in the messages of the drivers, over `net`. `fault` says what goes
//! wrong on request. What is not simulated: collisions, the arm's dynamics, the optics beyond what is hidden or too flat.

pub mod chain;
pub mod fault;
pub mod head;
pub mod layout;
pub mod motion;
mod net;
mod ports;
mod server;
mod subject;
mod world;

use std::path::PathBuf;

use crate::calibrate::Edge;
use crate::geometry::{Rigid, Vec3};
use crate::scene::PartKind;

use super::error::{DeviceError, system_words};
use super::setup::{Endpoint, RobotKind, RobotSetup, SensorKind, SensorSetup};

pub use fault::{Fault, FaultSpec, FaultStart, SimDevice};
pub use head::Head;

use net::Servers;
use world::World;

/// What to simulate.
#[derive(Clone, Debug, PartialEq)]
pub struct SimOptions {
    /// The robot, by the protocol that it speaks.
    pub robot: RobotKind,
    /// The profiler, by the protocol that it speaks.
    pub sensor: SensorKind,
    /// Added to every default port; `None`: any free ports.
    pub port_offset: Option<u16>,
    /// Of all that is random.
    pub seed: u64,
    /// How much faster than real time the cell's clock runs, for motions and profiles alike: 1 for practice, more for tests.
    pub time_scale: f64,
    /// The profiler's head.
    pub head: Head,
    /// Radius of the ball, mm.
    pub radius_mm: f64,
    /// What stands there in place of the ball.
    pub part: Option<PartKind>,
    /// The tool point that the operator has made active; only Universal Robots go by it.
    pub flange_from_tcp: Rigid,
    /// Whether poses and profiles have noise, and profiles lost points.
    pub is_noisy: bool,
    /// What goes wrong.
    pub faults: Vec<FaultSpec>,
}

impl Default for SimOptions {
    fn default() -> Self {
        Self {
            robot: RobotKind::FanucMappdk,
            sensor: SensorKind::KeyenceLjv,
            port_offset: None,
            seed: 1,
            time_scale: 1.0,
            head: Head::default(),
            radius_mm: 15.0,
            part: None,
            flange_from_tcp: Rigid::identity(),
            is_noisy: true,
            faults: Vec::new(),
        }
    }
}

/// What is true in a simulated cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SimTruth {
    /// The calibration, for profiles whose z grows away from the sensor and is 0 at the reference distance.
    pub flange_from_sensor: Rigid,
    /// The ball's centre, mm; where it would be, with a part in its place.
    pub ball_in_base: Vec3,
    /// Its radius, mm.
    pub radius_mm: f64,
    /// The part that stands there in place of the ball, in the frame that its kind has.
    pub base_from_part: Option<Rigid>,
    /// How far [`Fault::BallMoved`] pushes it, or the part, mm.
    pub push_mm: Vec3,
    /// The mounting as a drawing would have it: off by some degrees and millimetres.
    pub rough_flange_from_sensor: Rigid,
    /// Noise of the robot's pose: mm, degrees.
    pub pose_std_mm_deg: [f64; 2],
    /// Noise of a point of a profile, mm.
    pub profile_std_mm: f64,
    /// From the head to the middle of its range, mm.
    pub reference_distance_mm: f64,
}

/// A cell that runs until it is dropped.
#[derive(Debug)]
pub struct SimCell {
    /// How to connect to its robot.
    pub robot_setup: RobotSetup,
    /// How to connect to its profiler.
    pub sensor_setup: SensorSetup,
    /// What is true in it.
    pub truth: SimTruth,
    /// The ports that are served, with what for.
    pub ports: Vec<(u16, &'static str)>,
    servers: Servers,
}

impl SimCell {
    /// Starts its servers, on loopback only.
    ///
    /// # Errors
    /// [`DeviceError::System`] if a port is taken, or the options are none of a cell.
    pub fn start(options: &SimOptions) -> Result<Self, DeviceError> {
        check(options)?;
        let bound = ports::bind_all(options)?;
        let mut servers = Servers::new(World::new(options));
        let mut served = Vec::new();
        let [mut robot_port, mut sensor_port] = [0; 2];
        for (port, listener, plan) in bound {
            if plan.is_main {
                *(if plan.device == SimDevice::Robot { &mut robot_port } else { &mut sensor_port }) = port;
            }
            served.push((port, plan.what));
            servers.serve(listener, plan.device, plan.clients, plan.service).map_err(|error| DeviceError::System {
                device: DEVICE,
                what: "starting a thread".to_owned(),
                reason: system_words(&error),
            })?;
        }
        let here = |port| Endpoint { host: "127.0.0.1".to_owned(), port };
        Ok(Self {
            robot_setup: RobotSetup { kind: options.robot, endpoint: here(robot_port) },
            sensor_setup: SensorSetup {
                kind: options.sensor,
                endpoint: here(sensor_port),
                folder: PathBuf::new(),
                // On the LJ-V's wire z grows towards the head.
                is_z_inverted: options.sensor == SensorKind::KeyenceLjv,
            },
            truth: servers.world().truth(),
            ports: served,
            servers,
        })
    }

    /// Where the arm holds the flange now, whatever the controller tells: `base_from_flange`.
    #[must_use]
    pub fn base_from_flange(&self) -> Rigid {
        self.servers.world().arm().base_from_flange
    }

    /// Brings the line onto an edge of the plate, as somebody with the pendant would, and says so before it is there.
    ///
    /// # Errors
    /// [`DeviceError::System`] if there is no plate, or the arm does not go.
    pub fn jog_to_edge(&self, edge: Edge) -> Result<(), DeviceError> {
        self.servers.world().jog_to_edge(edge).map_err(|reason| DeviceError::System {
            device: DEVICE,
            what: format!("jogging to edge {}", edge.symbol()),
            reason,
        })
    }

    /// One more fault, its counts from now on.
    pub fn inject(&self, fault: FaultSpec) {
        self.servers.world().inject(fault);
    }

    /// Ends all faults; a ball that was pushed is back in its place.
    pub fn clear_faults(&self) {
        self.servers.world().clear_faults();
    }
}

/// What messages call it.
const DEVICE: &str = "Simulated cell";
/// Radii of balls that a cell has room for, mm.
const RADIUS_MM: [f64; 2] = [2.0, 60.0];
/// How much faster or slower than real time a cell may run.
const TIME_SCALE: [f64; 2] = [0.01, 1e4];

fn check(options: &SimOptions) -> Result<(), DeviceError> {
    let within = |what: &str, found: f64, [min, max]: [f64; 2]| {
        if (min..=max).contains(&found) {
            Ok(())
        } else {
            let reason = format!("found {found}, needed {min} to {max}");
            Err(DeviceError::System { device: DEVICE, what: what.to_owned(), reason })
        }
    };
    within("a ball of this radius in mm", options.radius_mm, RADIUS_MM)?;
    within("a clock of this speed", options.time_scale, TIME_SCALE)?;
    if options.sensor == SensorKind::Folder {
        let what = "serving a watched folder".to_owned();
        let reason = "it has no protocol; choose the LJ-V7000 or the bridge".to_owned();
        return Err(DeviceError::System { device: DEVICE, what, reason });
    }
    Ok(())
}
