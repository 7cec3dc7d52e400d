//! Steps 5 to 7 of the patent as they are published: corners described in each frame, nearest neighbours under a threshold,
//! and the motion of the best random sample of pairs in space.
//!
//! Where the text cannot be followed: it draws two pairs, which do not fix a rigid motion; we draw three. What it does
//! worse than one could: the motion of the sample is kept as it is, though hundreds of pairs agree with it; and distances
//! in space let the noise of depth in, which is many times that of a pixel.

use nalgebra::{Matrix3, Matrix3x6, Matrix6};

use crate::geometry::{Rigid, Vec3, so3};

use super::camera::Intrinsics;
use super::depth_filter::DepthNoise;
use super::descriptors::{Descriptor, Pattern};
use super::features::{CornerSearch, corners};
use super::matching::nearest;
use super::outcome::{Estimated, EstimatedMotion, Failure, Match};
use super::ransac::{self, SAMPLE};
use super::rigid_motion;
use super::view::View;

/// What the text leaves open.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PublishedOptions {
    /// The corners of a frame.
    pub corners: CornerSearch,
    /// Descriptors that differ in fewer of 256 bits match (the first threshold of the text).
    pub most_bits: u32,
    /// Pairs nearer than this after the motion are inliers, mm (the second threshold).
    pub threshold_mm: f64,
    /// Samples drawn (b in the text).
    pub num_trials: usize,
}

impl Default for PublishedOptions {
    fn default() -> Self {
        Self {
            corners: CornerSearch { most: 500, min_distance: 8.0, min_strength: 4.0 },
            most_bits: 40,
            threshold_mm: 30.0,
            num_trials: 200,
        }
    }
}

/// The features of a frame: corners with a description and a place in space.
#[derive(Clone, Debug, Default)]
pub struct Features {
    /// Where they are, px.
    pub pixels: Vec<[f32; 2]>,
    /// What they look like.
    pub descriptors: Vec<Descriptor>,
    /// Where they are in the sensor, mm.
    pub points_mm: Vec<Vec3>,
}

impl Features {
    /// Of a frame, as far as they have a depth.
    #[must_use]
    pub fn of(view: &View, camera: &Intrinsics, search: &CornerSearch, pattern: &Pattern) -> Self {
        let mut features = Self::default();
        // The half-size picture is smooth enough to be compared pixel by pixel.
        let half = view.levels.get(1).unwrap_or(&view.levels[0]);
        let scale = if view.levels.len() > 1 { 0.5 } else { 1.0 };
        for corner in corners(&view.levels[0], search, |pixel| view.depth_mm(pixel).is_some()) {
            let described = pattern.describe(half, corner.pixel.map(|value| value * scale));
            let (Some(descriptor), Some(z_mm)) = (described, view.depth_mm(corner.pixel)) else { continue };
            features.pixels.push(corner.pixel);
            features.descriptors.push(descriptor);
            features.points_mm.push(camera.point_at(corner.pixel.map(f64::from), z_mm));
        }
        features
    }
}

/// Fewer inliers than this are a coincidence.
const MIN_INLIERS: usize = 10;

/// The estimator: it keeps the features of the last frame that was tracked.
#[derive(Clone, Debug, Default)]
pub struct Published {
    previous: Option<Features>,
}

impl Published {
    /// Forgets everything: the next frame is one to start with.
    pub fn restart(&mut self) {
        self.previous = None;
    }

    /// Takes the next frame.
    pub fn push(
        &mut self,
        view: &View,
        camera: &Intrinsics,
        pattern: &Pattern,
        options: &PublishedOptions,
    ) -> Estimated {
        let now = Features::of(view, camera, &options.corners, pattern);
        let features = now.pixels.clone();
        let (matches, motion) = match &self.previous {
            _ if features.len() < MIN_INLIERS => {
                (Vec::new(), Err(Failure::TooFewFeatures { found: features.len(), needed: MIN_INLIERS }))
            }
            None => (Vec::new(), Ok(None)),
            Some(previous) => {
                let (matches, motion) = motion(camera, previous, &now, options);
                (matches, motion.map(Some))
            }
        };
        if motion.is_ok() {
            self.previous = Some(now);
        }
        Estimated { features, matches, motion }
    }
}

/// Matches two frames and finds the motion. The matches come back in any case.
fn motion(
    camera: &Intrinsics,
    previous: &Features,
    now: &Features,
    options: &PublishedOptions,
) -> (Vec<Match>, Result<EstimatedMotion, Failure>) {
    /// Whatever the seed, the same frames give the same motion.
    const SEED: u64 = 5;
    let pairs = nearest(&previous.descriptors, &now.descriptors, options.most_bits);
    let mut matches: Vec<Match> = pairs
        .iter()
        .map(|pair| Match { before: previous.pixels[pair.first], now: now.pixels[pair.second], is_inlier: false })
        .collect();
    if pairs.len() < MIN_INLIERS {
        return (matches, Err(Failure::TooFast { found: pairs.len(), needed: MIN_INLIERS }));
    }
    let points: Vec<(Vec3, Vec3)> =
        pairs.iter().map(|pair| (previous.points_mm[pair.first], now.points_mm[pair.second])).collect();
    let is_inlier = |motion: &Rigid, (before, now): &(Vec3, Vec3)| {
        (motion.rotation * before + motion.translation.vector - now).norm() < options.threshold_mm
    };
    #[expect(clippy::cast_precision_loss, reason = "a number of pairs")]
    let score = |motion: &Rigid| points.iter().filter(|pair| is_inlier(motion, pair)).count() as f64;
    let mut best_sample = None;
    let mut best_score = 0.0;
    let motion_of = |sample: [usize; SAMPLE]| {
        let src = sample.map(|idx| points[idx].0);
        let motion = rigid_motion::dst_from_src(&sample.map(|idx| points[idx].1), &src)?;
        let score = score(&motion);
        if score > best_score {
            best_score = score;
            best_sample = Some(src);
        }
        Some(motion)
    };
    let best = ransac::consensus(points.len(), options.num_trials, SEED, None, motion_of, score);
    let (Some(best), Some(sample)) = (best, best_sample) else {
        return (matches, Err(Failure::NoAgreement { found: 0, needed: MIN_INLIERS }));
    };
    let motion = best.motion;
    let (mut squares, mut num_inliers) = (0.0, 0);
    for (found, pair) in matches.iter_mut().zip(&points) {
        found.is_inlier = is_inlier(&motion, pair);
        if found.is_inlier {
            num_inliers += 1;
            let seen = camera.pixel_of(&(motion.rotation * pair.0 + motion.translation.vector));
            let off = seen.map_or(0.0, |seen| {
                (seen[0] - f64::from(found.now[0])).powi(2) + (seen[1] - f64::from(found.now[1])).powi(2)
            });
            squares += off;
        }
    }
    if num_inliers < MIN_INLIERS {
        return (matches, Err(Failure::NoAgreement { found: num_inliers, needed: MIN_INLIERS }));
    }
    let covariance = sample_covariance(&sample);
    #[expect(clippy::cast_precision_loss, reason = "a number of pairs")]
    let residual_px = (squares / num_inliers as f64).sqrt();
    (matches, Ok(EstimatedMotion { sensor_from_previous: motion, covariance, residual_px, is_recognised: false }))
}

/// How well three pairs fix the motion: the noise of depth along each ray, in both frames, and half a pixel across.
fn sample_covariance(points: &[Vec3; SAMPLE]) -> Matrix6<f64> {
    /// Of a corner, for the focal length of a common camera.
    const ACROSS_RAD: f64 = 0.5 / 525.0;
    let mut information = Matrix6::zeros();
    for point in points {
        let ray = point.normalize();
        let along = DepthNoise::KINECT.std_mm(point.z).powi(2);
        let across = (ACROSS_RAD * point.z).powi(2);
        // Twice: the noise of both frames.
        let covariance = (Matrix3::identity() * across + ray * ray.transpose() * (along - across).max(0.0)) * 2.0;
        let mut jacobian = Matrix3x6::zeros();
        jacobian.fixed_view_mut::<3, 3>(0, 0).copy_from(&-so3::hat(*point));
        jacobian.fixed_view_mut::<3, 3>(0, 3).copy_from(&Matrix3::identity());
        let weight = covariance.try_inverse().unwrap_or_default();
        information += jacobian.tr_mul(&(weight * jacobian));
    }
    information.try_inverse().unwrap_or_else(|| Matrix6::identity() * 1e6)
}
