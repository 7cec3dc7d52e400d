//! A simulated room for RGB-D odometry: what a colour and a depth camera see of it, with known truth.
//!
//! The room is ray-cast. Its patterns come in many sizes, are fixed in the world, and are filtered to the width of a pixel, so
//! that what is tracked below a pixel is the camera's motion and not an artefact. The same seed gives the same bytes: rendering
//! takes no function that differs between machines.
//!
//! # Conventions
//! The **world** of the room: z up, its origin on the floor in the room's middle, mm.

mod folder;
mod noise;
mod path;
mod render;
mod sequence;
mod session;
mod solid;
#[cfg(test)]
mod tests;
mod texture;

use image::{ImageBuffer, RgbImage};

use crate::geometry::{Sensor, Transform, World};
use crate::odometry::{DepthImage, RgbdCamera, RgbdFrame};
use crate::scene::Random;

use render::{Light, Range};
use solid::{Point, Solid};
use texture::{Lattice, Material};

pub use folder::{FolderError, write_folder};
pub use noise::{CameraNoise, DepthNoise};
pub use path::{Arm, Carrier};
pub use sequence::{RoomFault, RoomFrame, RoomOptions, RoomRecording, kinect};

/// Half the room along x, y and z, mm.
const HALF_MM: Point = [4000.0, 3000.0, 1400.0];
/// Height of the workbench in its middle, mm.
const BENCH_HEIGHT_MM: f64 = 740.0;

/// Random streams, so that each kind of noise can be switched without a change to the others.
mod stream {
    pub const ROOM: u64 = 101;
    pub const TEXTURE: u64 = 102;
    pub const PATH: u64 = 103;
    pub const COLOR: u64 = 104;
    pub const DEPTH: u64 = 105;
    pub const POSE: u64 = 106;
    /// So far are the streams of one frame from those of the next.
    pub const FRAME: u64 = 1000;
}

/// A room with furniture about a workbench, all of it patterned.
#[derive(Clone, Debug)]
pub struct Room {
    solids: Vec<Solid>,
    lattice: Lattice,
    /// Where lamps are, and how strong.
    lamps: Vec<(Point, f64)>,
}

impl Room {
    /// The same seed gives the same room.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        let (random, texture) = (&mut Random::new(seed, stream::ROOM), &mut Random::new(seed, stream::TEXTURE));
        let lattice = Lattice::new(texture);
        let centre = [0.0, 0.0, HALF_MM[2]];
        // Posters on the walls; none on ceiling and floor, whose faces come last.
        let faces = (0..6).map(|face| {
            let num_posters = if face < 4 { 5 } else { 0 };
            Material::patterned(texture).with_posters(num_posters, &Solid::face_of_block(HALF_MM, face), texture)
        });
        let mut solids = vec![Solid::room(HALF_MM, centre, faces.collect())];
        let bench_half = [600.0, 450.0, 0.5 * BENCH_HEIGHT_MM];
        solids.push(Solid::block(bench_half, [0.0, 0.0, bench_half[2]], 0.0, Material::patterned(texture)));
        // On the bench: boxes and a ball, as they lie.
        for (x, y) in [(-350.0, -250.0), (-280.0, 230.0), (60.0, -40.0), (300.0, 260.0), (330.0, -240.0)] {
            let half = [0; 3].map(|_| 45.0 + 60.0 * random.unit());
            let at = [x + 60.0 * random.signed_unit(), y + 60.0 * random.signed_unit(), BENCH_HEIGHT_MM + half[2]];
            solids.push(Solid::block(half, at, random.signed_unit(), Material::patterned(texture)));
        }
        let radius = 70.0 + 30.0 * random.unit();
        solids.push(Solid::ball(radius, [-60.0, 290.0, BENCH_HEIGHT_MM + radius], Material::patterned(texture)));
        // Along the walls: cupboards, and a column in a corner.
        for (x, y, along_x) in [
            (3700.0, 900.0, 0),
            (3700.0, -1400.0, 0),
            (-3700.0, -300.0, 0),
            (-900.0, 2750.0, 1),
            (1300.0, -2750.0, 1),
            (-1800.0, -2750.0, 1),
        ] {
            let mut half = [200.0 + 80.0 * random.unit(), 350.0 + 250.0 * random.unit(), 450.0 + 550.0 * random.unit()];
            if along_x == 1 {
                half.swap(0, 1);
            }
            let turn = 0.04 * random.signed_unit();
            solids.push(Solid::block(half, [x, y, half[2]], turn, Material::patterned(texture)));
        }
        let column = [3100.0 + 200.0 * random.signed_unit(), 2300.0 + 200.0 * random.signed_unit(), HALF_MM[2]];
        solids.push(Solid::column(170.0 + 60.0 * random.unit(), HALF_MM[2], column, Material::patterned(texture)));
        let radius = 200.0 + 80.0 * random.unit();
        solids.push(Solid::ball(radius, [-3200.0, 2200.0, radius], Material::patterned(texture)));
        let lamps = vec![([-1500.0, 800.0, 2700.0], 0.35), ([2000.0, -1000.0, 2500.0], 0.3)];
        Self { solids, lattice, lamps }
    }

    /// Bare walls of one colour: nothing for a camera to go by.
    #[must_use]
    pub fn blank() -> Self {
        let walls = Solid::room(HALF_MM, [0.0, 0.0, HALF_MM[2]], vec![Material::plain()]);
        Self { solids: vec![walls], lattice: Lattice::new(&mut Random::new(0, stream::TEXTURE)), lamps: Vec::new() }
    }

    /// What a camera at a place sees, without noise; the depth is rounded to its unit.
    #[must_use]
    pub fn render(&self, camera: &RgbdCamera, world_from_sensor: &Transform<World, Sensor>) -> RgbdFrame {
        let Range { z_mm, .. } = self.range(&camera.depth, &(*world_from_sensor * camera.color_from_depth));
        RgbdFrame {
            time_s: 0.0,
            color: color_image(camera, &self.light(&camera.color, world_from_sensor)),
            depth: depth_image(camera, &z_mm),
        }
    }
}

/// As bytes.
fn color_image(camera: &RgbdCamera, Light(light): &Light) -> RgbImage {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a cast of a float saturates")]
    let bytes = light.iter().flatten().map(|value| (value + 0.5) as u8).collect();
    ImageBuffer::from_raw(camera.color.width, camera.color.height, bytes).unwrap_or_default()
}

/// In units of the camera; 0 where nothing was measured or the number does not fit.
fn depth_image(camera: &RgbdCamera, z_mm: &[f64]) -> DepthImage {
    let units_per_mm = 1.0 / camera.mm_per_unit();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "it is checked to fit")]
    let unit = |z_mm: &f64| {
        let units = (z_mm * units_per_mm).round();
        if units < f64::from(u16::MAX) { units as u16 } else { 0 }
    };
    ImageBuffer::from_raw(camera.depth.width, camera.depth.height, z_mm.iter().map(unit).collect()).unwrap_or_default()
}
