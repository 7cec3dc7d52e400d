//! Which ports a cell serves, and where it finds them free.

use std::io::ErrorKind;
use std::net::TcpListener;

use crate::device::error::DeviceError;
use crate::device::setup::{RobotKind, SensorKind};
use crate::scene::Random;

use super::fault::SimDevice;
use super::net::{Clients, Service, bind};
use super::{DEVICE, SimOptions, server};

/// Where a FANUC serves its pages.
const PAGE_PORT: u16 = 80;
/// Offsets that are tried where any ports will do.
const NUM_TRIES: usize = 200;
/// Ports below belong to the system.
const FIRST_FREE: u16 = 20_000;
/// The least and the greatest of those offsets, about: well between the system's own ports and the last one.
const LAST_FREE: u16 = 60_000;

/// A port to serve.
#[derive(Clone, Copy, Debug)]
pub struct PortPlan {
    /// Its number on a real device.
    pub default_port: u16,
    /// What answers there, for people.
    pub what: &'static str,
    /// Whose it is.
    pub device: SimDevice,
    /// How many clients at the same time.
    pub clients: Clients,
    /// What answers.
    pub service: Service,
    /// Whether it is the one that an endpoint names.
    pub is_main: bool,
}

/// Ports of a device; the first is the one that an endpoint names.
fn of_robot(robot: RobotKind) -> Vec<PortPlan> {
    let port = |default_port, what, clients, service: Service| PortPlan {
        default_port,
        what,
        device: SimDevice::Robot,
        clients,
        service,
        is_main: default_port == robot.default_port(),
    };
    let one_client = |default_port, what, service| port(default_port, what, Clients::One, service);
    let port = |default_port, what, service| port(default_port, what, Clients::Many, service);
    match robot {
        RobotKind::FanucMappdk | RobotKind::FanucPage => vec![
            one_client(18735, "FANUC MAPPDK server", server::mappdk::serve),
            one_client(18736, "FANUC MAPPDK logger", server::mappdk::serve),
            port(PAGE_PORT, "FANUC web pages (CURPOS.DG, PRGSTATE.DG)", server::curpos::serve),
        ],
        RobotKind::UniversalRobots => vec![
            port(30004, "Universal Robots RTDE", server::ur_rtde::serve),
            port(30001, "Universal Robots primary", server::ur_script::serve_state),
            port(30002, "Universal Robots secondary", server::ur_script::serve_state),
            port(30003, "Universal Robots real-time", server::ur_script::serve_realtime),
            port(29999, "Universal Robots dashboard", server::ur_dashboard::serve),
        ],
        RobotKind::Bridge => vec![port(27015, "text bridge of a robot", server::bridge::serve_robot)],
    }
}

fn of_sensor(sensor: SensorKind) -> Vec<PortPlan> {
    let port = |default_port, what, service: Service| PortPlan {
        default_port,
        what,
        device: SimDevice::Sensor,
        clients: Clients::Many,
        service,
        is_main: default_port == sensor.default_port(),
    };
    match sensor {
        SensorKind::KeyenceLjv => vec![
            port(24691, "Keyence LJ-V7000 command port", server::ljv::serve),
            port(24692, "Keyence LJ-V7000 high-speed port", server::ljv::serve_stream),
        ],
        SensorKind::Bridge => vec![port(27016, "text bridge of a profiler", server::bridge::serve_profiler)],
        SensorKind::Folder => Vec::new(),
    }
}

/// A port that is held, and what is to answer there.
pub type Bound = (u16, TcpListener, PortPlan);

/// Takes the ports of a cell. A device's ports keep their distances; robot and profiler may be offset differently where
/// any free ports will do.
///
/// # Errors
/// [`DeviceError::System`] with the port that is taken.
pub fn bind_all(options: &SimOptions) -> Result<Vec<Bound>, DeviceError> {
    let mut bound = Vec::new();
    for plans in [of_robot(options.robot), of_sensor(options.sensor)] {
        bound.extend(match options.port_offset {
            Some(offset) => bind_at(&plans, i32::from(offset))?,
            None => bind_anywhere(&plans)?,
        });
    }
    Ok(bound)
}

fn bind_at(plans: &[PortPlan], offset: i32) -> Result<Vec<Bound>, DeviceError> {
    let failed = |port: i32, reason: String| DeviceError::System {
        device: DEVICE,
        what: format!("serving port {port} on 127.0.0.1"),
        reason: format!("{reason}; choose other ports with --port-offset"),
    };
    let mut bound = Vec::new();
    for plan in plans {
        let wanted = i32::from(plan.default_port) + offset;
        let port = u16::try_from(wanted).map_err(|_| failed(wanted, "there is no such port".to_owned()))?;
        match bind(port) {
            Ok(listener) => bound.push((port, listener, *plan)),
            // Ports below 1024 belong to the system, and there many a computer has a page of its own: that of a robot is not
            // worth a refusal where moves are asked for.
            Err(error)
                if matches!(error.kind(), ErrorKind::PermissionDenied | ErrorKind::AddrInUse)
                    && plan.default_port == PAGE_PORT
                    && !plan.is_main => {}
            Err(error) => return Err(failed(wanted, error.to_string())),
        }
    }
    Ok(bound)
}

/// The system chooses where to begin: a port that it hands out is free, and others near it mostly are.
fn bind_anywhere(plans: &[PortPlan]) -> Result<Vec<Bound>, DeviceError> {
    let Some(first) = plans.first() else { return Ok(Vec::new()) };
    let chosen = bind(0).and_then(|listener| listener.local_addr()).map_or(FIRST_FREE, |address| address.port());
    let mut random = Random::new(chosen.into(), 0);
    let mut last = bind_at(plans, i32::from(chosen) - i32::from(first.default_port));
    for _ in 0..NUM_TRIES {
        if last.is_ok() {
            break;
        }
        let span = f64::from(LAST_FREE - FIRST_FREE);
        #[expect(clippy::cast_possible_truncation, reason = "below the span of ports")]
        let start = i32::from(FIRST_FREE) + (random.unit() * span) as i32;
        last = bind_at(plans, start - i32::from(first.default_port));
    }
    last
}
