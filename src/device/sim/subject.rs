//! What stands before a head: the ball on its post, or a part on its table, and from where each point of it is seen.

use crate::geometry::{Rigid, Vec3};
use crate::scene::{MAX_INCIDENCE_DEG, Part, PartKind, Scene, Surface};

/// Light that leaves the surface flatter than this does not get into the camera, degrees.
const MAX_RETURN_DEG: f64 = 80.0;

/// What a head looks at.
#[derive(Clone, Debug)]
pub enum Subject {
    /// A ball; its range sign is +1.
    Ball(Scene),
    /// A part.
    Part {
        /// The part at its place in the base.
        part: Part,
        /// Noise of a point along the range axis, mm.
        profile_std_mm: f64,
        /// Whether single points are lost for no reason.
        loses_points: bool,
    },
}

/// Where a head's light comes from and where it is seen from, in the sensor, mm.
#[derive(Clone, Copy, Debug)]
pub struct Eyes {
    /// Where the laser fans out.
    pub laser: Vec3,
    /// Where the camera is.
    pub camera: Vec3,
}

impl Eyes {
    /// Whether both see a surface, and neither too flatly.
    fn see_surface(&self, point: Vec3, normal: Vec3) -> bool {
        let flatness_deg = |eye: Vec3| normal.angle(&(eye - point)).to_degrees();
        flatness_deg(self.laser) <= MAX_INCIDENCE_DEG && flatness_deg(self.camera) <= MAX_RETURN_DEG
    }
}

/// What a head meets at one place across its line.
#[derive(Clone, Copy, Debug)]
pub struct Met {
    /// Along the range axis, mm.
    pub z_mm: f64,
    /// Whether laser and camera both see it.
    pub is_seen: bool,
}

impl Subject {
    /// Noise of a point along the range axis, mm.
    #[must_use]
    pub const fn profile_std_mm(&self) -> f64 {
        match self {
            Self::Ball(scene) => scene.profile_std_mm,
            Self::Part { profile_std_mm, .. } => *profile_std_mm,
        }
    }

    /// Whether single points are lost for no reason.
    #[must_use]
    pub const fn loses_points(&self) -> bool {
        match self {
            Self::Ball(scene) => scene.dirt.has_holes,
            Self::Part { loses_points, .. } => *loses_points,
        }
    }

    /// Whether it is a right-angle plate.
    #[must_use]
    pub fn is_plate(&self) -> bool {
        matches!(self, Self::Part { part, .. } if part.kind == PartKind::Plate)
    }

    /// Where the part stands, if it is one.
    #[must_use]
    pub const fn base_from_part(&self) -> Option<Rigid> {
        match self {
            Self::Ball(_) => None,
            Self::Part { part, .. } => Some(part.world_from_part),
        }
    }

    /// The same, pushed to another place.
    #[must_use]
    pub fn shifted_by(&self, shift_mm: Vec3) -> Self {
        match self {
            Self::Ball(scene) => Self::Ball(scene.with_ball_shifted_by(shift_mm)),
            Self::Part { part, profile_std_mm, loses_points } => Self::Part {
                part: part.shifted_by(shift_mm),
                profile_std_mm: *profile_std_mm,
                loses_points: *loses_points,
            },
        }
    }

    /// What is met at a place across the line of a sensor that stands there.
    #[must_use]
    pub fn met_at(&self, x_mm: f64, base_from_sensor: &Rigid, eyes: &Eyes) -> Option<Met> {
        match self {
            Self::Ball(scene) => {
                let ball_in_sensor = base_from_sensor.inverse_transform_point(&scene.ball_in_world.into()).coords;
                let surface = scene.surface_at(x_mm, ball_in_sensor, base_from_sensor)?;
                let (Surface::Ball { z_mm, .. } | Surface::Table { z_mm }) = surface;
                let point = Vec3::new(x_mm, 0.0, z_mm);
                let is_hidden = |eye: Vec3| is_hidden_by_ball(point, eye, ball_in_sensor, scene.radius_mm);
                let is_seen = match surface {
                    Surface::Ball { .. } => eyes.see_surface(point, (point - ball_in_sensor) / scene.radius_mm),
                    Surface::Table { .. } => !is_hidden(eyes.laser) && !is_hidden(eyes.camera),
                };
                Some(Met { z_mm, is_seen })
            }
            Self::Part { part, .. } => {
                let hit = part.surface_at(x_mm, 1.0, base_from_sensor)?;
                let point = Vec3::new(x_mm, 0.0, hit.distance_mm);
                let is_hidden = |eye: Vec3| part.hides(point, eye, base_from_sensor);
                let is_seen = eyes.see_surface(point, hit.normal) && !is_hidden(eyes.laser) && !is_hidden(eyes.camera);
                Some(Met { z_mm: hit.distance_mm, is_seen })
            }
        }
    }
}

/// Whether the ball stands between a point and an eye.
fn is_hidden_by_ball(point: Vec3, eye: Vec3, ball_in_sensor: Vec3, radius_mm: f64) -> bool {
    let way = eye - point;
    let nearest = ((ball_in_sensor - point).dot(&way) / way.norm_squared()).clamp(0.0, 1.0);
    (point + way * nearest - ball_in_sensor).norm() < radius_mm
}
