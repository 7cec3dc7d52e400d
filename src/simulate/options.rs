//! What to simulate.

use crate::calibrate::Mount;

use crate::scene::{Dirt, PartKind};

use super::fault::Fault;

/// What is measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SimulationTarget {
    /// A ball of known radius on a post.
    #[default]
    Ball,
    /// Another part on its table: a plate, a pin, or a workpiece that is scanned.
    Part(PartKind),
}

impl SimulationTarget {
    /// As sessions name it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ball => "ball",
            Self::Part(PartKind::Plate) => "plate",
            Self::Part(PartKind::Pin) => "point",
            Self::Part(PartKind::Square) => "square block",
            Self::Part(PartKind::Teeth) => "toothed standard",
            Self::Part(PartKind::Cylinder) => "cylinder",
        }
    }

    /// Whether it is scanned for what a calibration is worth, rather than measured for one.
    #[must_use]
    pub const fn is_workpiece(self) -> bool {
        matches!(self, Self::Part(PartKind::Square | PartKind::Teeth | PartKind::Cylinder))
    }
}

/// How far the rough mounting in the session is off the true one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoughMounting {
    /// Angle, degrees.
    pub off_deg: f64,
    /// Distance, mm.
    pub off_mm: f64,
}

/// A simulated session: the target, the robot's path, the noise. Values beyond the named limits are taken as the limit.
#[derive(Clone, Debug, PartialEq)]
pub struct SimulationOptions {
    /// The same seed gives the same session.
    pub seed: u64,
    /// What is measured.
    pub target: SimulationTarget,
    /// What else the same sensor measures, each as [`Self::of`] has it with this session's noise.
    pub further: Vec<SimulationTarget>,
    /// Number of stations; of a plate, of each edge; of a workpiece, scans.
    pub num_stations: usize,
    /// Captures a station. Of a ball, the first strike included: 1 gives a fixed-point session. Of a workpiece, profiles a
    /// scan.
    pub num_steps: usize,
    /// Points a profile.
    pub num_points: usize,
    /// Radius of the ball, mm.
    pub radius_mm: f64,
    /// Commanded step, mm. With the defaults the sweep covers the largest arc, and l > 0.5 R everywhere. Of a workpiece, from
    /// profile to profile.
    pub step_mm: f64,
    /// Distance of the first section from the ball's centre, mm; `None`: 0.6 R.
    pub section_offset_mm: Option<f64>,
    /// How much that distance varies from station to station, as a part of it.
    pub section_offset_spread: f64,
    /// Standard deviation of a point along the range axis, mm.
    pub profile_std_mm: f64,
    /// Whether points that are already reduced stand in place of the profiles of a plate or pin.
    pub has_points: bool,
    /// How well the laser is brought onto a pin's point, across the line, mm.
    pub aim_std_mm: f64,
    /// How well that point was touched with a calibrated tip, mm.
    pub touch_std_mm: f64,
    /// The rough mounting that the session gives; none if `None`.
    pub rough_mounting: Option<RoughMounting>,
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
    /// Largest error of a rough mounting: degrees, mm.
    pub const MAX_ROUGH: [f64; 2] = [90.0, 1000.0];

    /// What is usual for a target: how many stations, how they turn, and for a plate a rough mounting to start from.
    #[must_use]
    pub fn of(target: SimulationTarget) -> Self {
        /// 10 mm/s at 30 profiles a second.
        const SCAN_STEP_MM: f64 = 0.33;
        let usual = Self { target, ..Self::default() };
        let SimulationTarget::Part(kind) = target else { return usual };
        let turned = Self { num_steps: 1, tilt_deg: 20.0, spin_deg: 20.0, ..usual };
        match kind {
            PartKind::Plate => {
                let rough_mounting = Some(RoughMounting { off_deg: 5.0, off_mm: 10.0 });
                Self { num_stations: 9, rough_mounting, ..turned }
            }
            PartKind::Pin => Self { num_stations: 12, ..turned },
            PartKind::Square | PartKind::Teeth | PartKind::Cylinder => Self {
                num_stations: 2,
                num_steps: Self::steps_to_scan(kind, SCAN_STEP_MM),
                step_mm: SCAN_STEP_MM,
                ..turned
            },
        }
    }

    /// Profiles that a scan of a part's whole length takes.
    #[must_use]
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a cast of a float saturates")]
    pub fn steps_to_scan(kind: PartKind, step_mm: f64) -> usize {
        (2.0 * kind.half_length_mm() / step_mm) as usize
    }

    /// Those of a further target, measured by the same sensor on the same robot.
    pub(super) fn of_further(&self, idx: usize, target: SimulationTarget) -> Self {
        let mut usual = Self::of(target);
        match target {
            SimulationTarget::Ball => usual.step_mm *= self.radius_mm / usual.radius_mm,
            // One path for all workpieces.
            SimulationTarget::Part(kind) if target.is_workpiece() && self.target.is_workpiece() => {
                usual.step_mm = self.step_mm;
                usual.num_steps = Self::steps_to_scan(kind, self.step_mm);
            }
            SimulationTarget::Part(_) => {}
        }
        Self {
            // Its noise is its own.
            seed: self.seed.wrapping_add((idx as u64 + 1).wrapping_mul(0x1_0000_0001)),
            target,
            further: Vec::new(),
            num_stations: usual.num_stations,
            num_steps: usual.num_steps,
            step_mm: usual.step_mm,
            section_offset_mm: usual.section_offset_mm,
            tilt_deg: usual.tilt_deg,
            spin_deg: usual.spin_deg,
            bad_pose_station: None,
            fault: None,
            ..self.clone()
        }
        .within_limits()
    }

    /// Exact data: no noise, unrounded. For tests of accuracy.
    #[must_use]
    pub fn noise_free() -> Self {
        Self::default().without_noise()
    }

    /// The same with exact data.
    #[must_use]
    pub fn without_noise(self) -> Self {
        Self {
            profile_std_mm: 0.0,
            position_std_mm: 0.0,
            orientation_std_deg: 0.0,
            aim_std_mm: 0.0,
            touch_std_mm: 0.0,
            ..self
        }
    }

    /// +1 where z grows away from the sensor, −1 where it grows towards it.
    pub(super) const fn range_sign(&self) -> f64 {
        if self.z_towards_sensor { -1.0 } else { 1.0 }
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
            aim_std_mm: within(self.aim_std_mm, [0.0, Self::MAX_STD_MM]),
            touch_std_mm: within(self.touch_std_mm, [0.0, Self::MAX_STD_MM]),
            rough_mounting: self.rough_mounting.map(|RoughMounting { off_deg, off_mm }| RoughMounting {
                off_deg: within(off_deg, [0.0, Self::MAX_ROUGH[0]]),
                off_mm: within(off_mm, [0.0, Self::MAX_ROUGH[1]]),
            }),
            // What people get wrong is told of the ball only.
            fault: self.fault.filter(|_| self.target == SimulationTarget::Ball),
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
            target: SimulationTarget::Ball,
            further: Vec::new(),
            num_stations: 10,
            num_steps: 21,
            num_points: 800,
            radius_mm: 15.0,
            step_mm: 0.75,
            section_offset_mm: None,
            section_offset_spread: 0.15,
            profile_std_mm: 0.01,
            has_points: false,
            aim_std_mm: 0.02,
            touch_std_mm: 0.02,
            rough_mounting: None,
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
