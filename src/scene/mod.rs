//! What a laser line sees: a ball or a part, and the table below it; and the seeded randomness of all that is simulated.

mod dirt;
mod line;
mod part;
pub mod random;
mod solid;

use nalgebra::{Quaternion, UnitQuaternion};

use crate::geometry::{Profile, Rigid, Vec3};

pub use dirt::Dirt;
pub use line::{LINE_WIDTH_MM, Line};
pub use part::{CYLINDER_DIAMETER_MM, PITCH_MM, PLATE_EDGE_MM, Part, PartKind, TOOTH_HEIGHT_MM};
pub use random::Random;

/// Steeper than this, no light comes back to the sensor.
pub const MAX_INCIDENCE_DEG: f64 = 75.0;
/// From here on steep flanks are measured too high where [`Dirt::has_flank_bias`] is on.
const BIASED_INCIDENCE_DEG: f64 = 50.0;
/// The bias at the steepest flank that is still seen, mm.
const FLANK_BIAS_MM: f64 = 0.12;
/// Gap between the ball and the table, in radii: the ball stands on a post.
const POST_RADII: f64 = 0.8;
/// Half of the measuring range along z, in radii, about the ball's centre.
const HALF_RANGE_RADII: f64 = 3.5;
/// Width of the profile, in radii.
const WIDTH_RADII: f64 = 3.0;

/// The ball and its table, standing still in their world: the base, or the flange for a fixed sensor.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Centre of the ball, mm.
    pub ball_in_world: Vec3,
    /// Its radius, mm.
    pub radius_mm: f64,
    /// Points of a profile.
    pub num_points: usize,
    /// +1 where z grows away from the sensor, −1 where it grows towards it.
    pub range_sign: f64,
    /// Noise of a point along the range axis, mm.
    pub profile_std_mm: f64,
    /// What else the profiles hold.
    pub dirt: Dirt,
    /// Decimals that coordinates are rounded to.
    pub decimals: Option<u8>,
}

/// What a line along the range axis meets first, before noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Surface {
    /// The ball.
    Ball {
        /// Where along the range axis, mm.
        z_mm: f64,
        /// How far from the ball's middle towards the sensor, mm.
        height_mm: f64,
    },
    /// The table.
    Table {
        /// Where along the range axis, mm.
        z_mm: f64,
    },
}

impl Scene {
    /// The same with the ball somewhere else; the table stays below it.
    #[must_use]
    pub fn with_ball_shifted_by(&self, shift_mm: Vec3) -> Self {
        Self { ball_in_world: self.ball_in_world + shift_mm, ..self.clone() }
    }

    /// The profile of a sensor standing at `world_from_sensor`.
    #[must_use]
    pub fn profile(&self, world_from_sensor: &Rigid, noise: &mut Random, dirt: &mut Random) -> Profile {
        let ball_in_sensor = world_from_sensor.inverse_transform_point(&self.ball_in_world.into()).coords;
        let line = Line {
            num_points: self.num_points,
            width_mm: WIDTH_RADII * self.radius_mm,
            profile_std_mm: self.profile_std_mm,
            dirt: self.dirt,
            decimals: self.decimals,
        };
        line.profile(noise, dirt, |x| self.seen_z_mm(x, ball_in_sensor, world_from_sensor))
    }

    /// What the line at `x` along the range axis meets first; the table counts whether the profiles show it or not.
    #[must_use]
    pub fn surface_at(&self, x: f64, ball_in_sensor: Vec3, world_from_sensor: &Rigid) -> Option<Surface> {
        let dx = x - ball_in_sensor.x;
        let height_squared = self.radius_mm * self.radius_mm - ball_in_sensor.y * ball_in_sensor.y - dx * dx;
        if height_squared > 0.0 {
            // The ball stands above the table, so it is met first; of its two sides, the one towards the sensor.
            let height_mm = height_squared.sqrt();
            return Some(Surface::Ball { z_mm: ball_in_sensor.z - self.range_sign * height_mm, height_mm });
        }
        self.table_z_mm(x, world_from_sensor).map(|z_mm| Surface::Table { z_mm })
    }

    /// What parallel rays along the range axis see of it.
    fn seen_z_mm(&self, x: f64, ball_in_sensor: Vec3, world_from_sensor: &Rigid) -> Option<f64> {
        match self.surface_at(x, ball_in_sensor, world_from_sensor)? {
            Surface::Ball { z_mm, height_mm } => {
                let incidence_deg = (height_mm / self.radius_mm).acos().to_degrees();
                (incidence_deg <= MAX_INCIDENCE_DEG).then(|| z_mm + self.flank_bias_mm(incidence_deg))
            }
            Surface::Table { z_mm } => (self.dirt.has_table
                && (z_mm - ball_in_sensor.z).abs() <= HALF_RANGE_RADII * self.radius_mm)
                .then_some(z_mm),
        }
    }

    fn table_z_mm(&self, x: f64, world_from_sensor: &Rigid) -> Option<f64> {
        let table_height_mm = self.ball_in_world.z - (1.0 + POST_RADII) * self.radius_mm;
        let start = world_from_sensor * nalgebra::Point3::new(x, 0.0, 0.0);
        let climb = (world_from_sensor.rotation * Vec3::z()).z;
        let z_mm = (table_height_mm - start.z) / climb;
        z_mm.is_finite().then_some(z_mm)
    }

    /// Steep flanks are seen nearer to the sensor than they are: the light that comes back is that of the upper edge.
    fn flank_bias_mm(&self, incidence_deg: f64) -> f64 {
        let steepness =
            ((incidence_deg - BIASED_INCIDENCE_DEG) / (MAX_INCIDENCE_DEG - BIASED_INCIDENCE_DEG)).clamp(0.0, 1.0);
        if self.dirt.has_flank_bias { -self.range_sign * FLANK_BIAS_MM * steepness * steepness } else { 0.0 }
    }
}

/// To so many decimals.
#[must_use]
pub fn rounded(value: f64, decimals: Option<u8>) -> f64 {
    decimals.map_or(value, |decimals| {
        let scale = 10.0_f64.powi(i32::from(decimals));
        (value * scale).round() / scale
    })
}

/// A rotation whose quaternion was rounded to so many decimals and normalised again.
///
/// The last bits of sines and cosines differ between systems; after rounding the same seed gives the same file.
#[must_use]
pub fn rounded_rotation(rotation: &UnitQuaternion<f64>, decimals: u8) -> UnitQuaternion<f64> {
    let quaternion = rotation.as_ref().coords.map(|value| rounded(value, Some(decimals)));
    UnitQuaternion::new_normalize(Quaternion::from_vector(quaternion))
}
