//! What to simulate.

use crate::calibrate::Mount;

use crate::scene::Dirt;

use super::fault::Fault;

/// A simulated session: the ball, the robot's path, the noise. Values beyond the named limits are taken as the limit.
#[derive(Clone, Debug, PartialEq)]
pub struct SimulationOptions {
    /// The same seed gives the same session.
    pub seed: u64,
    /// Number of stations.
    pub num_stations: usize,
    /// Captures a station, the first strike included: 1 gives a fixed-point session.
    pub num_steps: usize,
    /// Points a profile.
    pub num_points: usize,
    /// Radius of the ball, mm.
    pub radius_mm: f64,
    /// Commanded step, mm. With the defaults the sweep covers the largest arc, and l > 0.5 R everywhere.
    pub step_mm: f64,
    /// Distance of the first section from the ball's centre, mm; `None`: 0.6 R.
    pub section_offset_mm: Option<f64>,
    /// How much that distance varies from station to station, as a part of it.
    pub section_offset_spread: f64,
    /// Standard deviation of a point along the range axis, mm.
    pub profile_std_mm: f64,
    /// Standard deviation of each coordinate of a reported position, mm.
    pub position_std_mm: f64,
    /// Standard deviation of a reported orientation about each axis, degrees.
    pub orientation_std_deg: f64,
    /// How far the orientations tilt from straight down, about two axes, degrees.
    pub tilt_deg: f64,
    /// How far they turn about the vertical, either way, degrees.
    pub spin_deg: f64,
    /// Angle between the robot's travel and the laser's normal, degrees.
    pub travel_off_normal_deg: f64,
    /// Where the sensor is.
    pub mount: Mount,
    /// Whether z grows towards the sensor, as with some makers, instead of away from it.
    pub z_towards_sensor: bool,
    /// What the profiles hold besides the ball.
    pub dirt: Dirt,
    /// The index of a station whose reported poses are wrong by [`Self::BAD_POSE_MM`].
    pub bad_pose_station: Option<usize>,
    /// What is wrong with the session.
    pub fault: Option<Fault>,
    /// Decimals of profile points (mm) and reported positions; `None`: unrounded.
    pub decimals: Option<u8>,
}

impl SimulationOptions {
    /// How wrong the bad station's poses are, mm: a touched-up point, a bumped ball.
    pub const BAD_POSE_MM: f64 = 2.0;
    /// Smallest and largest radius of the ball, mm.
    pub const RADIUS_MM: [f64; 2] = [0.1, 1000.0];
    /// Largest standard deviation of a length, mm.
    pub const MAX_STD_MM: f64 = 10.0;
    /// Largest standard deviation of an orientation, degrees.
    pub const MAX_STD_DEG: f64 = 10.0;
    /// Largest tilt and largest angle of the travel, degrees: beyond it the sensor would look sideways.
    pub const MAX_TILT_DEG: f64 = 60.0;
    /// Most stations, and most captures a station.
    pub const MAX_COUNT: usize = 10_000;
    /// Most points a profile.
    pub const MAX_POINTS: usize = 100_000;

    /// Exact data: no noise, unrounded. For tests of accuracy.
    #[must_use]
    pub fn noise_free() -> Self {
        Self { profile_std_mm: 0.0, position_std_mm: 0.0, orientation_std_deg: 0.0, ..Self::default() }
    }

    /// Distance of the first section from the ball's centre, mm, before it varies.
    #[must_use]
    pub fn section_offset_or_default_mm(&self) -> f64 {
        /// At 0.6 R the section's radius is 0.8 R: well formed, and y is well known.
        const DEFAULT_RATIO: f64 = 0.6;
        self.section_offset_mm.unwrap_or(DEFAULT_RATIO * self.radius_mm)
    }

    /// The same with every value within its limits.
    #[must_use]
    pub(super) fn within_limits(&self) -> Self {
        let within = |value: f64, [min, max]: [f64; 2]| if value.is_nan() { min } else { value.clamp(min, max) };
        let radius_mm = within(self.radius_mm, Self::RADIUS_MM);
        Self {
            num_stations: self.num_stations.min(Self::MAX_COUNT),
            num_steps: self.num_steps.clamp(1, Self::MAX_COUNT),
            num_points: self.num_points.clamp(2, Self::MAX_POINTS),
            radius_mm,
            step_mm: within(self.step_mm, [0.0, radius_mm]),
            section_offset_mm: self.section_offset_mm.map(|offset| within(offset, [0.0, radius_mm])),
            section_offset_spread: within(self.section_offset_spread, [0.0, 1.0]),
            profile_std_mm: within(self.profile_std_mm, [0.0, Self::MAX_STD_MM]),
            position_std_mm: within(self.position_std_mm, [0.0, Self::MAX_STD_MM]),
            orientation_std_deg: within(self.orientation_std_deg, [0.0, Self::MAX_STD_DEG]),
            tilt_deg: within(self.tilt_deg, [0.0, Self::MAX_TILT_DEG]),
            spin_deg: within(self.spin_deg, [0.0, 180.0]),
            travel_off_normal_deg: within(self.travel_off_normal_deg, [0.0, Self::MAX_TILT_DEG]),
            // More decimals than f64 has at these sizes would round to nothing.
            decimals: self.decimals.map(|decimals| decimals.min(12)),
            ..self.clone()
        }
    }
}

impl Default for SimulationOptions {
    fn default() -> Self {
        Self {
            seed: 1,
            num_stations: 10,
            num_steps: 21,
            num_points: 800,
            radius_mm: 15.0,
            step_mm: 0.75,
            section_offset_mm: None,
            section_offset_spread: 0.15,
            profile_std_mm: 0.01,
            position_std_mm: 0.02,
            orientation_std_deg: 0.005,
            tilt_deg: 25.0,
            spin_deg: 60.0,
            travel_off_normal_deg: 0.0,
            mount: Mount::OnFlange,
            z_towards_sensor: false,
            dirt: Dirt::default(),
            bad_pose_station: None,
            fault: None,
            decimals: None,
        }
    }
}
