//! What cameras see of the room, before noise.

use crate::geometry::{Frame, Transform, Vec3, World};
use crate::odometry::Intrinsics;

use super::Room;
use super::solid::{Point, Ray, Surface, along, dot, minus};
use super::texture::narrow;

/// Width of the box that a pixel sees, in pixels: a little blur, as every lens has, so that patterns do not flicker.
const PIXEL_BOX: f64 = 1.25;
/// Rays a side of a pixel at the edge of a shape.
const EDGE_RAYS: u32 = 4;
/// Share of the light that comes from everywhere.
const AMBIENT: f64 = 0.35;

/// Brightness by channel, 0 to 255 where the exposure is right, row by row.
#[derive(Clone, Debug)]
pub(super) struct Light(pub Vec<[f32; 3]>);

/// What a depth camera has to go by, row by row.
#[derive(Clone, Debug)]
pub(super) struct Range {
    /// Distance along the optical axis, mm.
    pub z_mm: Vec<f64>,
    /// Cosine of the angle at which the surface is seen.
    pub incidence_cos: Vec<f32>,
}

/// A camera that stands in the room.
struct View<'a> {
    intrinsics: &'a Intrinsics,
    origin: Point,
    /// The camera's axes in the room.
    axes: [Point; 3],
}

impl<'a> View<'a> {
    fn new<C: Frame>(intrinsics: &'a Intrinsics, world_from_camera: &Transform<World, C>) -> Self {
        let rotation = world_from_camera.rotation();
        let axes = [Vec3::x(), Vec3::y(), Vec3::z()].map(|axis| (rotation * axis).into());
        Self { intrinsics, origin: world_from_camera.translation_mm().into(), axes }
    }

    /// The ray through a pixel; its direction is as long as z is 1, so that distances along it are those along the axis.
    fn ray(&self, u: f64, v: f64) -> Ray {
        let Intrinsics { fx, fy, cx, cy, .. } = *self.intrinsics;
        let direction = along(along(self.axes[2], (u - cx) / fx, self.axes[0]), (v - cy) / fy, self.axes[1]);
        Ray { origin: self.origin, direction }
    }

    /// How wide a pixel is at a distance along the axis, across its ray.
    fn pixel_mm(&self, ray: &Ray, z_mm: f64) -> f64 {
        z_mm * dot(ray.direction, ray.direction).sqrt() / self.intrinsics.fx.abs()
    }
}

/// What a ray met: which solid, how far, which face.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Hit {
    solid: usize,
    z_mm: f64,
    face: u8,
}

impl Hit {
    fn is_beside(&self, other: &Self) -> bool {
        self.solid == other.solid && self.face == other.face
    }
}

impl Room {
    /// What a colour camera sees.
    pub(super) fn light<C: Frame>(&self, intrinsics: &Intrinsics, world_from_camera: &Transform<World, C>) -> Light {
        let view = View::new(intrinsics, world_from_camera);
        let hits = self.hits(&view);
        let [width, height] = [intrinsics.width as usize, intrinsics.height as usize];
        let mut light = Vec::with_capacity(hits.len());
        for (row, line) in hits.chunks_exact(width).enumerate() {
            for (column, hit) in line.iter().enumerate() {
                let is_other = |row: usize, column: usize| !hit.is_beside(&hits[row * width + column]);
                let is_edge = column > 0 && is_other(row, column - 1)
                    || column + 1 < width && is_other(row, column + 1)
                    || row > 0 && is_other(row - 1, column)
                    || row + 1 < height && is_other(row + 1, column);
                let [u, v] = [column, row].map(whole);
                light.push(if is_edge {
                    self.edge_light(&view, u, v)
                } else {
                    self.ray_light(&view, &view.ray(u, v), hit)
                });
            }
        }
        Light(light)
    }

    /// What a depth camera has to go by.
    pub(super) fn range<C: Frame>(&self, intrinsics: &Intrinsics, world_from_camera: &Transform<World, C>) -> Range {
        let view = View::new(intrinsics, world_from_camera);
        let hits = self.hits(&view);
        let width = intrinsics.width as usize;
        let incidence_cos = hits.iter().enumerate().map(|(idx, hit)| {
            let ray = view.ray(whole(idx % width), whole(idx / width));
            narrow(self.surface(&view, &ray, hit).incidence_cos)
        });
        Range { incidence_cos: incidence_cos.collect(), z_mm: hits.iter().map(|hit| hit.z_mm).collect() }
    }

    fn hits(&self, view: &View<'_>) -> Vec<Hit> {
        let Intrinsics { width, height, .. } = *view.intrinsics;
        let mut hits = Vec::with_capacity(width as usize * height as usize);
        for row in 0..height {
            hits.extend((0..width).map(|column| self.hit(&view.ray(f64::from(column), f64::from(row)))));
        }
        hits
    }

    fn hit(&self, ray: &Ray) -> Hit {
        let mut nearest = Hit { solid: 0, z_mm: f64::INFINITY, face: 0 };
        for (solid, candidate) in self.solids.iter().enumerate() {
            if let Some((z_mm, face)) = candidate.meets(ray).filter(|(z_mm, _)| *z_mm < nearest.z_mm) {
                nearest = Hit { solid, z_mm, face };
            }
        }
        nearest
    }

    fn surface(&self, view: &View<'_>, ray: &Ray, hit: &Hit) -> Surface {
        let pixel_mm = PIXEL_BOX * view.pixel_mm(ray, hit.z_mm);
        self.solids[hit.solid].surface(ray, (hit.z_mm, hit.face), pixel_mm)
    }

    /// Where shapes meet in a pixel, the mean of many rays.
    fn edge_light(&self, view: &View<'_>, u: f64, v: f64) -> [f32; 3] {
        let share = |idx: u32| PIXEL_BOX * ((f64::from(idx) + 0.5) / f64::from(EDGE_RAYS) - 0.5);
        let mut sum = [0.0; 3];
        for row in 0..EDGE_RAYS {
            for column in 0..EDGE_RAYS {
                let ray = view.ray(u + share(column), v + share(row));
                let light = self.ray_light(view, &ray, &self.hit(&ray));
                sum = [0, 1, 2].map(|channel| sum[channel] + light[channel]);
            }
        }
        sum.map(|sum: f32| sum / narrow(f64::from(EDGE_RAYS * EDGE_RAYS)))
    }

    fn ray_light(&self, view: &View<'_>, ray: &Ray, hit: &Hit) -> [f32; 3] {
        let surface = self.surface(view, ray, hit);
        let brightness = 255.0 * self.brightness(along(ray.origin, hit.z_mm, ray.direction), surface.normal);
        let albedo = self.solids[hit.solid].material(hit.face).albedo(&self.lattice, &surface.place);
        albedo.map(|albedo| albedo * narrow(brightness))
    }

    /// The light that falls onto a place: it depends on the place alone, so that a thing looks the same from everywhere.
    fn brightness(&self, at: Point, normal: Point) -> f64 {
        let from_lamps = self.lamps.iter().map(|(lamp, strength)| {
            let to_lamp = minus(*lamp, at);
            // A matt surface; beyond the horizon a little comes back from the other walls.
            let cos = dot(normal, to_lamp) / dot(to_lamp, to_lamp).sqrt();
            strength * (0.7 + 0.3 * cos)
        });
        AMBIENT + from_lamps.sum::<f64>()
    }
}

#[expect(clippy::cast_precision_loss, reason = "pixels of an image")]
fn whole(idx: usize) -> f64 {
    idx as f64
}
