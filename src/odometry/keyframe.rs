//! A frame that later ones are compared with, so that errors do not add up from frame to frame.

use crate::geometry::{Rigid, Vec3};

use super::camera::Intrinsics;
use super::depth_filter::DepthNoise;
use super::descriptors::Pattern;
use super::features::CornerSearch;
use super::flow::{self, Sought};
use super::published::Features;
use super::reprojection::{Estimate, Sighting};
use super::view::View;

/// A corner of a keyframe with its depth, which gets better as it is seen again.
#[derive(Clone, Debug)]
pub struct Landmark {
    pixel: [f32; 2],
    /// Its point at a depth of 1.
    ray: Vec3,
    z_mm: f64,
    variance: f64,
    /// Frames in a row in which its depth was another: it flickers, or the thing moves.
    disagreements: u8,
    /// Where it was last seen.
    last_seen: [f32; 2],
}

/// A keyframe.
#[derive(Clone, Debug)]
pub struct Keyframe {
    view: View,
    landmarks: Vec<Landmark>,
    features: Features,
}

/// A landmark found in a frame.
#[derive(Clone, Copy, Debug)]
pub struct Found {
    /// Its place in the keyframe's list.
    pub landmark: usize,
    /// Where it is, px.
    pub pixel: [f32; 2],
}

impl Keyframe {
    /// Of a frame: its corners with a depth.
    #[must_use]
    pub fn new(view: View, camera: &Intrinsics, noise: &DepthNoise, search: &CornerSearch, pattern: &Pattern) -> Self {
        let features = Features::of(&view, camera, search, pattern);
        let landmarks = features
            .pixels
            .iter()
            .zip(&features.points_mm)
            .map(|(pixel, point_mm)| Landmark {
                pixel: *pixel,
                ray: point_mm / point_mm.z,
                z_mm: point_mm.z,
                variance: noise.std_mm(point_mm.z).powi(2),
                disagreements: 0,
                last_seen: *pixel,
            })
            .collect();
        Self { view, landmarks, features }
    }

    /// How many landmarks it has.
    #[must_use]
    pub fn num_landmarks(&self) -> usize {
        self.landmarks.len()
    }

    /// Its corners as they are described, to be recognised.
    #[must_use]
    pub const fn features(&self) -> &Features {
        &self.features
    }

    /// Where a landmark was last seen, px.
    #[must_use]
    pub fn last_seen(&self, landmark: usize) -> [f32; 2] {
        self.landmarks[landmark].last_seen
    }

    /// Looks for the landmarks in a frame, near where a guess of the motion has them.
    #[must_use]
    pub fn find_in(
        &self,
        view: &View,
        camera: &Intrinsics,
        sensor_from_keyframe: &Rigid,
        coarsest_level: usize,
    ) -> Vec<Found> {
        let find = |(idx, landmark): (usize, &Landmark)| {
            let sought = landmark.sought(camera, sensor_from_keyframe)?;
            let pixel = flow::find(&self.view.levels, &view.levels, &sought, coarsest_level)?;
            Some(Found { landmark: idx, pixel })
        };
        self.landmarks.iter().enumerate().filter_map(find).collect()
    }

    /// What the found landmarks say about the motion.
    #[must_use]
    pub fn sightings(&self, found: &[Found], view: &View, noise: &DepthNoise) -> Vec<Sighting> {
        found
            .iter()
            .map(|found| {
                let landmark = &self.landmarks[found.landmark];
                Sighting {
                    point_mm: landmark.ray * landmark.z_mm,
                    point_depth_variance: landmark.variance,
                    pixel: found.pixel.map(f64::from),
                    depth: view.depth_mm(found.pixel).map(|z_mm| [z_mm, noise.std_mm(z_mm).powi(2)]),
                }
            })
            .collect()
    }

    /// Learns from a frame whose motion is known: depths get better, and landmarks whose depth flickers are dropped.
    pub fn learn(&mut self, found: &[Found], sightings: &[Sighting], estimate: &Estimate, noise: &DepthNoise) {
        /// So often in a row is no accident.
        const MOST_DISAGREEMENTS: u8 = 3;
        /// Errors of one place do not average out: the distortion of a camera, the steps of its disparity. Part of σ.
        const LEAST_STD_PART: f64 = 0.3;
        let motion = &estimate.sensor_from_reference;
        for ((found, sighting), is_inlier) in found.iter().zip(sightings).zip(&estimate.is_inlier) {
            let landmark = &mut self.landmarks[found.landmark];
            landmark.last_seen = found.pixel;
            let Some([depth_mm, variance]) = sighting.depth.filter(|_| *is_inlier) else { continue };
            let along = motion.rotation * landmark.ray;
            let expected_mm = along.z * landmark.z_mm + motion.translation.vector.z;
            if !noise.agree(depth_mm, expected_mm, landmark.variance) {
                landmark.disagreements = landmark.disagreements.saturating_add(1);
                continue;
            }
            landmark.disagreements = 0;
            let gain = landmark.variance * along.z / (along.z * along.z * landmark.variance + variance);
            landmark.z_mm += gain * (depth_mm - expected_mm);
            let least = (LEAST_STD_PART * noise.std_mm(landmark.z_mm)).powi(2);
            landmark.variance = (landmark.variance * (1.0 - gain * along.z)).max(least);
        }
        // Places in the list are those of the features: landmarks stay, but count for nothing.
        for landmark in &mut self.landmarks {
            if landmark.disagreements >= MOST_DISAGREEMENTS {
                landmark.z_mm = f64::NAN;
            }
        }
    }
}

impl Landmark {
    /// Where it should be seen, and how its surroundings look there if they face the camera.
    fn sought(&self, camera: &Intrinsics, sensor_from_keyframe: &Rigid) -> Option<Sought> {
        let rotation = sensor_from_keyframe.rotation.to_rotation_matrix().into_inner();
        let point = rotation * (self.ray * self.z_mm) + sensor_from_keyframe.translation.vector;
        if point.z.is_nan() || point.z <= 0.0 {
            return None;
        }
        let [u, v] = camera.pixel_of(&point)?;
        // How the place changes with that in the keyframe: a step of a pixel there is z/f across the ray.
        let step = |axis: usize, focal: f64| {
            let across = rotation.column(axis) * (self.z_mm / focal);
            [
                camera.fx * (across.x - across.z * point.x / point.z) / point.z,
                camera.fy * (across.y - across.z * point.y / point.z) / point.z,
            ]
        };
        let (right, down) = (step(0, camera.fx), step(1, camera.fy));
        let determinant = right[0] * down[1] - right[1] * down[0];
        // Seen from the side or from far away it looks like nothing known.
        if !(0.2..5.0).contains(&determinant) {
            return None;
        }
        #[expect(clippy::cast_possible_truncation, reason = "pixels to a ten-thousandth")]
        Some(Sought {
            reference: self.pixel,
            guess: [u as f32, v as f32],
            reference_per_px: [
                [(down[1] / determinant) as f32, (-right[1] / determinant) as f32],
                [(-down[0] / determinant) as f32, (right[0] / determinant) as f32],
            ],
        })
    }
}
