//! Where the robot goes: stations about the target, and the sweeps across a ball.

use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::{Translation3, UnitQuaternion};

use crate::calibrate::Mount;
use crate::geometry::{Rigid, Vec3, so3};
use crate::scene::{Random, rounded_rotation};

use super::options::SimulationOptions;

/// Turns by this angle from station to station never line up (the golden angle).
const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;
/// Decimals of the true mounting's quaternion.
const MOUNTING_DECIMALS: u8 = 12;
/// Distance of the near surface along the range axis, about, mm.
pub(super) const STANDOFF_MM: f64 = 80.0;

/// What is mounted where, and where the target is: a ball's centre, or the place that stands for a part.
///
/// The *world* is what the target stands still in, the *carrier* is what the sensor is mounted on. With the sensor on the
/// flange these are the base and the flange; a fixed sensor is the same with the roles exchanged.
#[derive(Clone, Debug)]
pub(super) struct Setup {
    pub carrier_from_sensor: Rigid,
    pub target_in_world: Vec3,
    /// Orientation of the carrier at which the sensor looks at the target along the world's −z.
    world_from_carrier_upright: UnitQuaternion<f64>,
}

impl Setup {
    pub fn new(options: &SimulationOptions) -> Self {
        let about = |axis: Vec3, angle: f64| so3::exp(axis * angle);
        // A mounting is never quite square.
        let odd_angles = so3::exp(Vec3::new(0.031, -0.024, 0.017));
        // With z towards the sensor the whole sensor frame is turned about its y.
        let flip = if options.z_towards_sensor { about(Vec3::y(), PI) } else { UnitQuaternion::identity() };
        let mounting = |turn: UnitQuaternion<f64>| rounded_rotation(&(turn * odd_angles * flip), MOUNTING_DECIMALS);
        match options.mount {
            // Turned about the flange's z, the laser looks along it; straight down the flange is a half turn about x.
            Mount::OnFlange => Self {
                carrier_from_sensor: Rigid::from_parts(
                    Translation3::new(12.0, -3.0, 118.0),
                    mounting(about(Vec3::z(), FRAC_PI_2)),
                ),
                target_in_world: Vec3::new(452.0, -118.0, 96.0),
                world_from_carrier_upright: UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(
                    0.0, 1.0, 0.0, 0.0,
                )),
            },
            // On a stand before the robot, looking back at it along −x of the base; the flange holds the ball out.
            Mount::Fixed => Self {
                carrier_from_sensor: Rigid::from_parts(
                    Translation3::new(820.0, 35.0, 410.0),
                    mounting(about(Vec3::y(), -FRAC_PI_2)),
                ),
                target_in_world: Vec3::new(4.0, -7.0, 132.0),
                world_from_carrier_upright: about(Vec3::y(), -FRAC_PI_2),
            },
        }
    }

    /// The same before another target, so far beside the first that none stands in the other's way.
    #[expect(clippy::cast_precision_loss, reason = "a handful of targets")]
    pub fn beside(&self, num_places: usize) -> Self {
        const PLACE_MM: Vec3 = Vec3::new(-70.0, 130.0, 0.0);
        Self { target_in_world: self.target_in_world + PLACE_MM * num_places as f64, ..self.clone() }
    }

    /// What the controller would report without an error, with the sensor there.
    pub fn base_from_flange(&self, mount: Mount, world_from_sensor: &Rigid) -> Rigid {
        let world_from_carrier = world_from_sensor * self.carrier_from_sensor.inverse();
        match mount {
            Mount::OnFlange => world_from_carrier,
            Mount::Fixed => world_from_carrier.inverse(),
        }
    }

    /// The sensor's orientation that looks straight down.
    pub fn upright(&self) -> UnitQuaternion<f64> {
        self.world_from_carrier_upright * self.carrier_from_sensor.rotation
    }

    /// The sensor's orientation at the station of this index. The first one looks straight down; the rest tilt and turn
    /// about it.
    #[expect(clippy::cast_precision_loss, reason = "a session has far fewer than 2^52 stations")]
    pub fn orientation(
        &self,
        options: &SimulationOptions,
        station_idx: usize,
        random: &mut Random,
    ) -> UnitQuaternion<f64> {
        let turn = if station_idx == 0 {
            UnitQuaternion::identity()
        } else {
            let azimuth = GOLDEN_ANGLE * station_idx as f64;
            let tilt = options.tilt_deg.to_radians() * (0.85 + 0.15 * random.unit());
            let spin = options.spin_deg.to_radians() * spread(station_idx) * (0.9 + 0.1 * random.unit());
            so3::exp(Vec3::z() * spin)
                * so3::exp(Vec3::y() * tilt * azimuth.sin())
                * so3::exp(Vec3::x() * tilt * azimuth.cos())
        };
        turn * self.world_from_carrier_upright * self.carrier_from_sensor.rotation
    }
}

/// One station: the sensor at the first strike, and how it travels on.
#[derive(Clone, Debug)]
pub(super) struct StationPath {
    pub world_from_sensor_at_strike: Rigid,
    /// The commanded step, signed: towards the ball's centre.
    pub step_mm: f64,
    /// The unit vector of a positive step, in the sensor.
    travel_in_sensor: Vec3,
}

impl StationPath {
    /// The station of this index.
    pub fn new(options: &SimulationOptions, setup: &Setup, station_idx: usize, random: &mut Random) -> Self {
        let world_from_sensor_rotation = setup.orientation(options, station_idx, random);
        let side = random.signed_unit().signum();
        let offset_mm = (options.section_offset_or_default_mm()
            * (1.0 + options.section_offset_spread * random.signed_unit()))
        .min(options.radius_mm);
        let ball_in_sensor = Vec3::new(
            0.2 * options.radius_mm * random.signed_unit(),
            side * offset_mm,
            options.range_sign() * (STANDOFF_MM + options.radius_mm * (1.0 + 0.3 * random.signed_unit())),
        );
        let origin_in_world = setup.target_in_world - world_from_sensor_rotation * ball_in_sensor;
        let off_normal = options.travel_off_normal_deg.to_radians();
        // Off towards x and z alike, the same at every station: the robot's Y is not quite the laser's normal.
        let aside = Vec3::new(0.8, 0.0, 0.6);
        Self {
            world_from_sensor_at_strike: Rigid::from_parts(origin_in_world.into(), world_from_sensor_rotation),
            step_mm: side * options.step_mm,
            travel_in_sensor: Vec3::y() * off_normal.cos() + aside * off_normal.sin(),
        }
    }

    /// The sensor after so many steps.
    #[expect(clippy::cast_precision_loss, reason = "a sweep has far fewer than 2^52 steps")]
    pub fn world_from_sensor(&self, num_steps: usize) -> Rigid {
        let travel = self.travel_in_sensor * (self.step_mm * num_steps as f64);
        self.world_from_sensor_at_strike * Translation3::from(travel)
    }
}

/// −1 … 1, well spread for any number of stations (the van der Corput sequence).
#[expect(clippy::cast_precision_loss, reason = "32 bits are exact")]
fn spread(station_idx: usize) -> f64 {
    let reversed = (station_idx as u64).reverse_bits() >> 32;
    2.0 * (reversed as f64 / f64::from(u32::MAX)) - 1.0
}
