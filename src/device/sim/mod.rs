//! A simulated cell that serves the real protocols on loopback: for practice, and for tests.

use crate::geometry::{Rigid, Vec3};

use super::error::DeviceError;
use super::setup::{RobotKind, RobotSetup, SensorKind, SensorSetup};

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
    /// How much faster than real time the robot moves: 1 for practice, more for tests.
    pub time_scale: f64,
}

impl Default for SimOptions {
    fn default() -> Self {
        Self {
            robot: RobotKind::FanucMappdk,
            sensor: SensorKind::KeyenceLjv,
            port_offset: None,
            seed: 1,
            time_scale: 1.0,
        }
    }
}

/// What is true in a simulated cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SimTruth {
    /// The calibration.
    pub flange_from_sensor: Rigid,
    /// The ball's centre, mm.
    pub ball_in_base: Vec3,
    /// Its radius, mm.
    pub radius_mm: f64,
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
}

impl SimCell {
    /// Starts its servers, on loopback only.
    ///
    /// # Errors
    /// [`DeviceError::System`] if a port is taken.
    pub fn start(options: &SimOptions) -> Result<Self, DeviceError> {
        let _ = options;
        Err(DeviceError::Stopped { device: "Simulated cell" })
    }
}
