//! Where the camera goes: on a vehicle, in a hand, or on a robot.

use std::f64::consts::{FRAC_PI_2, TAU};

use nalgebra::{Quaternion, UnitQuaternion};

use crate::geometry::{Base, Flange, Frame, Sensor, Transform, Vec3, World, so3};
use crate::scene::{Random, rounded, rounded_rotation};

use super::stream;

/// Decimals of positions in mm: files hold metres with six decimals, and with them the truth to the last digit.
const POSITION_DECIMALS: u8 = 3;
/// Decimals of quaternions.
const QUATERNION_DECIMALS: u8 = 9;

/// What carries the camera.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Carrier {
    /// A vehicle that drives about the workbench, with the bob of a hand.
    #[default]
    Vehicle,
    /// A hand before the workbench.
    Hand,
    /// A robot's flange above the workbench.
    Robot,
}

/// A motion that swings with a few frequencies at once.
#[derive(Clone, Debug)]
struct Swing(Vec<Wave>);

#[derive(Clone, Copy, Debug)]
struct Wave {
    amplitude: f64,
    per_s: f64,
    phase: f64,
}

impl Swing {
    /// Waves of the given amplitudes and frequencies, in phases of their own.
    fn new(waves: Waves, unit: f64, random: &mut Random) -> Self {
        let wave = |(amplitude, per_s): &(f64, f64)| Wave {
            amplitude: unit * amplitude,
            per_s: *per_s,
            phase: TAU * random.unit(),
        };
        Self(waves.iter().map(wave).collect())
    }

    fn at(&self, time_s: f64) -> f64 {
        self.0.iter().map(|wave| wave.amplitude * (TAU * wave.per_s * time_s + wave.phase).sin()).sum()
    }
}

/// Amplitudes and frequencies, 1/s.
type Waves = &'static [(f64, f64)];

/// How a carrier swings along x, y and z of the room, mm, and about the camera's axes, degrees. The frequencies have no common
/// period.
const fn waves(carrier: Carrier) -> ([Waves; 3], [Waves; 3]) {
    match carrier {
        Carrier::Vehicle => (
            [&[(30.0, 0.13)], &[(30.0, 0.17), (2.5, 0.95)], &[(4.0, 1.9)]],
            [&[(3.0, 0.19), (0.25, 1.9)], &[(6.0, 0.11), (0.3, 0.95)], &[(1.0, 0.23), (0.4, 0.95)]],
        ),
        Carrier::Hand => (
            [
                &[(260.0, 0.11), (60.0, 0.29), (1.0, 4.1)],
                &[(330.0, 0.09), (70.0, 0.23), (1.0, 3.3)],
                &[(120.0, 0.13), (40.0, 0.31), (1.0, 5.3)],
            ],
            [
                &[(8.0, 0.14), (2.0, 0.37), (0.1, 4.7)],
                &[(11.0, 0.12), (3.0, 0.33), (0.1, 5.9)],
                &[(6.0, 0.10), (2.0, 0.27), (0.1, 3.7)],
            ],
        ),
        Carrier::Robot => (
            [&[(110.0, 0.10), (40.0, 0.21)], &[(160.0, 0.12), (40.0, 0.19)], &[(90.0, 0.14), (30.0, 0.23)]],
            [&[(15.0, 0.11), (5.0, 0.22)], &[(17.0, 0.09), (6.0, 0.20)], &[(20.0, 0.13), (8.0, 0.18)]],
        ),
    }
}

/// A camera's path through the room.
#[derive(Clone, Debug)]
pub(super) struct Path {
    carrier: Carrier,
    has_stops: bool,
    start_angle: f64,
    /// Along x, y, z, mm.
    shift_mm: [Swing; 3],
    /// About the camera's axes, rad.
    turn: [Swing; 3],
}

impl Path {
    pub fn new(carrier: Carrier, has_stops: bool, seed: u64) -> Self {
        let random = &mut Random::new(seed, stream::PATH);
        let start_angle = TAU * random.unit();
        let (shift_mm, turn_deg) = waves(carrier);
        let shift_mm = shift_mm.map(|waves| Swing::new(waves, 1.0, random));
        let turn = turn_deg.map(|waves| Swing::new(waves, 1_f64.to_radians(), random));
        Self { carrier, has_stops, start_angle, shift_mm, turn }
    }

    /// Where the camera is at a time.
    pub fn world_from_sensor(&self, time_s: f64) -> Transform<World, Sensor> {
        let time_s = if self.has_stops { with_stops(time_s) } else { time_s };
        let (place_mm, heading, down) = match self.carrier {
            Carrier::Vehicle => self.drive(time_s),
            Carrier::Hand => (Vec3::new(-1450.0, -100.0, 1300.0), 0.0, 22_f64.to_radians()),
            Carrier::Robot => (Vec3::new(-820.0, 0.0, 1270.0), 0.0, 33_f64.to_radians()),
        };
        // The camera's z forward, its y down.
        let level = UnitQuaternion::new_unchecked(Quaternion::new(0.5, -0.5, 0.5, -0.5));
        let swing = |swings: &[Swing; 3]| Vec3::new(swings[0].at(time_s), swings[1].at(time_s), swings[2].at(time_s));
        let rotation =
            so3::exp(Vec3::z() * heading) * level * so3::exp(Vec3::x() * -down) * so3::exp(swing(&self.turn));
        written(&Transform::from_parts(place_mm + swing(&self.shift_mm), rotation))
    }

    /// Any angle, the same for the same seed.
    pub const fn start_angle(&self) -> f64 {
        self.start_angle
    }

    /// Half a metre a second along an ellipse, looking ahead.
    fn drive(&self, time_s: f64) -> (Vec3, f64, f64) {
        const RADII_MM: [f64; 2] = [2200.0, 1600.0];
        const TURN_PER_S: f64 = 0.26;
        const HEIGHT_MM: f64 = 950.0;
        let (sin, cos) = (self.start_angle + TURN_PER_S * time_s).sin_cos();
        let heading = (RADII_MM[1] * cos).atan2(-RADII_MM[0] * sin);
        (Vec3::new(RADII_MM[0] * cos, RADII_MM[1] * sin, HEIGHT_MM), heading, 8_f64.to_radians())
    }
}

/// Where the robot stands and how the camera is mounted on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arm {
    /// Where the robot stands in the room.
    pub world_from_base: Transform<World, Base>,
    /// The true calibration.
    pub flange_from_sensor: Transform<Flange, Sensor>,
}

impl Arm {
    pub(super) fn new() -> Self {
        // Turned about the flange's z, and never quite square.
        let turn = so3::exp(Vec3::z() * FRAC_PI_2) * so3::exp(Vec3::new(0.041, -0.028, 0.017));
        Self {
            world_from_base: written(&Transform::from_parts(
                Vec3::new(-1500.0, 250.0, 700.0),
                so3::exp(Vec3::z() * -0.3),
            )),
            flange_from_sensor: written(&Transform::from_parts(Vec3::new(-31.4, 62.7, 48.2), turn)),
        }
    }

    /// What the controller would report without an error, with the camera there.
    #[must_use]
    pub fn base_from_flange(&self, world_from_sensor: &Transform<World, Sensor>) -> Transform<Base, Flange> {
        self.world_from_base.inverse() * *world_from_sensor * self.flange_from_sensor.inverse()
    }
}

/// As files hold it: the last bits of sines and cosines differ between machines, after rounding the same seed gives the same.
pub(super) fn written<Dst: Frame, Src: Frame>(exact: &Transform<Dst, Src>) -> Transform<Dst, Src> {
    Transform::from_parts(
        exact.translation_mm().map(|value| rounded(value, Some(POSITION_DECIMALS))),
        rounded_rotation(&exact.rotation(), QUATERNION_DECIMALS),
    )
}

/// Time that stands still for a third of every period, and catches up smoothly.
fn with_stops(time_s: f64) -> f64 {
    const PERIOD_S: f64 = 1.5;
    const MOVING: f64 = 2.0 / 3.0;
    let periods = (time_s / PERIOD_S).floor();
    let part = ((time_s / PERIOD_S - periods) / MOVING).min(1.0);
    PERIOD_S * (periods + part * part * (3.0 - 2.0 * part))
}
