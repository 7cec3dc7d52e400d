//! The motion from points known in space and seen again: by where they are seen, and by how far away they are as far as
//! depth is worth it.
//!
//! A point of the reference frame has a depth with noise, which moves it along its ray. So its residual has the
//! covariance D + v J Jᵀ: D of the sighting (pixels, and depth by its own noise), v the variance of the point's depth, J what
//! that does to the sighting. Its inverse weighs the residual; the depth of the points needs no unknowns of its own.

use nalgebra::{Matrix3, Matrix3x6, Matrix6, Vector3, Vector6};

use crate::geometry::stats;
use crate::geometry::{Mat3, Rigid, Vec3, se3, so3};

use super::camera::Intrinsics;
use super::ransac::{self, SAMPLE};
use super::rigid_motion;

/// A known point that is seen again.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sighting {
    /// The point in the reference frame, mm.
    pub point_mm: Vec3,
    /// Variance of its depth there, mm².
    pub point_depth_variance: f64,
    /// Where it is seen, px.
    pub pixel: [f64; 2],
    /// Its depth where it is seen, mm, and the variance of that, mm², if there is one.
    pub depth: Option<[f64; 2]>,
}

/// A motion and what speaks for it.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// The motion.
    pub sensor_from_reference: Rigid,
    /// Covariance of a perturbation from the right (rotation in rad, translation in mm).
    pub covariance: Matrix6<f64>,
    /// Which sightings agree with it.
    pub is_inlier: Vec<bool>,
    /// Standard deviation of a coordinate of a pixel, from the residuals.
    pub pixel_std: f64,
}

impl Estimate {
    /// How many agree.
    #[must_use]
    pub fn num_inliers(&self) -> usize {
        self.is_inlier.iter().filter(|is_inlier| **is_inlier).count()
    }
}

/// How the motion is sought.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Search {
    /// Samples drawn at most.
    pub most_trials: usize,
    /// A sample's motion agrees with a point that is seen as near to where it should be, px.
    pub threshold_px: f64,
    /// Seed of the draws.
    pub seed: u64,
}

/// The least and greatest standard deviation of a pixel that is believed.
const PIXEL_STD_RANGE: [f64; 2] = [0.02, 3.0];
/// Squared distance in standard deviations beyond which a sighting is an outlier: one in a thousand of three normal values.
const OUTLIER_SQUARED: f64 = 16.3;
/// Median of the sum of two squared normal values.
const MEDIAN_OF_TWO: f64 = 1.386;

/// Finds the motion without a good guess, and refines it with all that agrees.
///
/// `None` where no three points fix a motion.
#[must_use]
pub fn estimate(
    camera: &Intrinsics,
    sightings: &[Sighting],
    guess: Option<Rigid>,
    search: &Search,
) -> Option<Estimate> {
    let limit = search.threshold_px * search.threshold_px;
    let score = |motion: &Rigid| {
        let agreement = |sighting: &Sighting| {
            let off = pixel_residual(camera, motion, sighting)?;
            let squared = off[0] * off[0] + off[1] * off[1];
            (squared < limit).then_some(1.0 - squared / limit)
        };
        sightings.iter().filter_map(agreement).sum::<f64>()
    };
    let motion_of = |sample: [usize; SAMPLE]| {
        let sample = sample.map(|idx| sightings[idx]);
        let start = sample_motion(camera, &sample).or(guess)?;
        through(camera, &sample, start)
    };
    // Mostly the guess is as good that a fit to all settles it.
    let start = guess.map(|guess| settle(camera, sightings, guess, search.threshold_px).unwrap_or(guess));
    let best = ransac::consensus(sightings.len(), search.most_trials, search.seed, start, motion_of, score)?;
    refine(camera, sightings, best.motion, search.threshold_px)
}

/// The motion by the points' positions in space, as far as all of a sample have a depth.
fn sample_motion(camera: &Intrinsics, sample: &[Sighting; SAMPLE]) -> Option<Rigid> {
    let mut dst = [Vec3::zeros(); SAMPLE];
    for (dst, sighting) in dst.iter_mut().zip(sample) {
        *dst = camera.point_at(sighting.pixel, sighting.depth?[0]);
    }
    rigid_motion::dst_from_src(&dst, &sample.map(|sighting| sighting.point_mm))
}

/// The motion with which three points are seen exactly where they are, from one that is near.
fn through(camera: &Intrinsics, sample: &[Sighting; SAMPLE], start: Rigid) -> Option<Rigid> {
    let mut motion = start;
    for _ in 0..4 {
        let mut system = NormalEquations::default();
        for sighting in sample {
            let line = Linearised::at(camera, &motion, sighting)?;
            system.add(&line.jacobian, &line.residual, &Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, 0.0)));
        }
        motion = system.step(&motion)?;
    }
    Some(motion)
}

/// A few steps with a fixed spread of the pixels.
fn settle(camera: &Intrinsics, sightings: &[Sighting], start: Rigid, pixel_std: f64) -> Option<Rigid> {
    let mut motion = start;
    for _ in 0..3 {
        motion = equations(camera, sightings, &motion, pixel_std).step(&motion)?;
    }
    Some(motion)
}

/// Refines with all sightings, weighed by how well they fit; the spread of the pixels is taken from the residuals.
fn refine(camera: &Intrinsics, sightings: &[Sighting], start: Rigid, threshold_px: f64) -> Option<Estimate> {
    const ROUNDS: usize = 6;
    let mut motion = start;
    let mut pixel_std = pixel_spread(camera, sightings, &motion, threshold_px)?;
    for round in 0..ROUNDS {
        motion = equations(camera, sightings, &motion, pixel_std).step(&motion)?;
        if round < ROUNDS - 1 {
            pixel_std = pixel_spread(camera, sightings, &motion, pixel_std)?;
        }
    }
    let covariance = equations(camera, sightings, &motion, pixel_std).information.try_inverse()?;
    let is_inlier = sightings
        .iter()
        .map(|sighting| {
            Linearised::at(camera, &motion, sighting)
                .is_some_and(|line| line.distance_squared(sighting, pixel_std) < OUTLIER_SQUARED)
        })
        .collect();
    Some(Estimate { sensor_from_reference: motion, covariance, is_inlier, pixel_std })
}

/// The spread of a pixel's coordinate by the median of the residuals, each relieved of what the depth of its point adds.
fn pixel_spread(camera: &Intrinsics, sightings: &[Sighting], motion: &Rigid, expected: f64) -> Option<f64> {
    let mut squares: Vec<f64> = sightings
        .iter()
        .filter_map(|sighting| {
            let line = Linearised::at(camera, motion, sighting)?;
            let without_depth = Sighting { depth: None, ..*sighting };
            Some(line.distance_squared(&without_depth, expected))
        })
        .collect();
    let median = stats::median(&mut squares);
    (!median.is_nan())
        .then(|| (expected * (median / MEDIAN_OF_TWO).sqrt()).clamp(PIXEL_STD_RANGE[0], PIXEL_STD_RANGE[1]))
}

fn equations(camera: &Intrinsics, sightings: &[Sighting], motion: &Rigid, pixel_std: f64) -> NormalEquations {
    let mut system = NormalEquations::default();
    for sighting in sightings {
        let Some(line) = Linearised::at(camera, motion, sighting) else { continue };
        let weight = line.weight(sighting, pixel_std);
        let squared = line.residual.dot(&(weight * line.residual));
        // Tukey's weights: beyond the limit nothing counts, and nothing jumps at it.
        let part = 1.0 - squared / (2.0 * OUTLIER_SQUARED);
        if part > 0.0 {
            system.add(&line.jacobian, &line.residual, &(weight * (part * part)));
        }
    }
    system
}

fn pixel_residual(camera: &Intrinsics, motion: &Rigid, sighting: &Sighting) -> Option<[f64; 2]> {
    let seen = camera.pixel_of(&(motion.rotation * sighting.point_mm + motion.translation.vector))?;
    Some([seen[0] - sighting.pixel[0], seen[1] - sighting.pixel[1]])
}

/// A residual (px, px, mm) and how it changes.
struct Linearised {
    residual: Vector3<f64>,
    jacobian: Matrix3x6<f64>,
    /// With the point's depth in the reference frame.
    by_depth: Vector3<f64>,
}

impl Linearised {
    fn at(camera: &Intrinsics, motion: &Rigid, sighting: &Sighting) -> Option<Self> {
        /// Points nearer than this are at the camera's glass, mm.
        const NEAREST_MM: f64 = 1.0;
        let rotation = motion.rotation.to_rotation_matrix().into_inner();
        let point = rotation * sighting.point_mm + motion.translation.vector;
        if point.z.is_nan() || point.z < NEAREST_MM {
            return None;
        }
        let per_z = 1.0 / point.z;
        let seen = [camera.fx * point.x * per_z + camera.cx, camera.fy * point.y * per_z + camera.cy];
        let projection = Mat3::new(
            camera.fx * per_z,
            0.0,
            -camera.fx * point.x * per_z * per_z,
            0.0,
            camera.fy * per_z,
            -camera.fy * point.y * per_z * per_z,
            0.0,
            0.0,
            1.0,
        );
        let by_point = projection * rotation;
        let mut jacobian = Matrix3x6::zeros();
        jacobian.fixed_view_mut::<3, 3>(0, 0).copy_from(&(by_point * -so3::hat(sighting.point_mm)));
        jacobian.fixed_view_mut::<3, 3>(0, 3).copy_from(&by_point);
        let depth_off = sighting.depth.map_or(0.0, |[depth, _]| point.z - depth);
        Some(Self {
            residual: Vector3::new(seen[0] - sighting.pixel[0], seen[1] - sighting.pixel[1], depth_off),
            jacobian,
            by_depth: by_point * sighting.point_mm / sighting.point_mm.z,
        })
    }

    /// The inverse of D + v J Jᵀ (Sherman & Morrison).
    fn weight(&self, sighting: &Sighting, pixel_std: f64) -> Mat3 {
        let per_pixel = 1.0 / (pixel_std * pixel_std);
        let inverse = Vector3::new(per_pixel, per_pixel, sighting.depth.map_or(0.0, |[_, variance]| 1.0 / variance));
        let along = inverse.component_mul(&self.by_depth);
        let variance = sighting.point_depth_variance;
        let shrink = variance / (1.0 + variance * along.dot(&self.by_depth));
        Mat3::from_diagonal(&inverse) - along * along.transpose() * shrink
    }

    /// The residual in standard deviations, squared.
    fn distance_squared(&self, sighting: &Sighting, pixel_std: f64) -> f64 {
        self.residual.dot(&(self.weight(sighting, pixel_std) * self.residual))
    }
}

#[derive(Default)]
struct NormalEquations {
    information: Matrix6<f64>,
    gradient: Vector6<f64>,
}

impl NormalEquations {
    fn add(&mut self, jacobian: &Matrix3x6<f64>, residual: &Vector3<f64>, weight: &Mat3) {
        let weighted = weight * jacobian;
        self.information += jacobian.tr_mul(&weighted);
        self.gradient += weighted.tr_mul(residual);
    }

    fn step(&self, motion: &Rigid) -> Option<Rigid> {
        let step = self.information.cholesky()?.solve(&self.gradient);
        step.iter().all(|value| value.is_finite()).then(|| motion * se3::exp(&-step))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::stats::SplitMix;

    const SEARCH: Search = Search { most_trials: 500, threshold_px: 3.0, seed: 1 };

    fn camera() -> Intrinsics {
        Intrinsics::new([640, 480], [525.0, -525.0], [319.5, 239.5]).expect("valid")
    }

    /// Points before the camera and where they are seen after a motion, with evenly spread noise; every `wrong_every`th is
    /// seen somewhere else.
    fn sightings(motion: &Rigid, noise_px: f64, wrong_every: usize) -> Vec<Sighting> {
        let mut random = SplitMix::new(4);
        let mut within = |from: f64, to: f64| {
            from + (to - from) * f64::from(u32::try_from(random.below(100_000)).expect("small")) / 1e5
        };
        (0..200)
            .map(|idx| {
                let point_mm = camera().point_at([within(20.0, 620.0), within(20.0, 460.0)], within(800.0, 4000.0));
                let moved = motion.rotation * point_mm + motion.translation.vector;
                let mut pixel = camera().pixel_of(&moved).expect("before the camera");
                for value in &mut pixel {
                    *value += within(-noise_px, noise_px);
                }
                if idx % wrong_every == 1 {
                    pixel = [within(0.0, 640.0), within(0.0, 480.0)];
                }
                Sighting { point_mm, point_depth_variance: 1.0, pixel, depth: Some([moved.z, 1.0]) }
            })
            .collect()
    }

    #[test]
    fn the_motion_is_found_without_a_guess_and_among_wrong_pairs() {
        for (motion, wrong_every) in [
            (Rigid::new(Vec3::new(20.0, -5.0, 40.0), Vec3::new(0.01, -0.02, 0.005)), 1000),
            (Rigid::new(Vec3::new(-300.0, 150.0, 200.0), Vec3::new(0.1, 0.3, -0.2)), 3),
        ] {
            let exact = estimate(&camera(), &sightings(&motion, 0.0, wrong_every), None, &SEARCH).expect("a motion");
            let off = motion.inverse() * exact.sensor_from_reference;
            assert!(off.translation.vector.norm() < 1e-3 && off.rotation.angle() < 1e-6, "{off}");
            let wrong =
                exact.is_inlier.iter().enumerate().filter(|(idx, is_inlier)| **is_inlier == (idx % wrong_every == 1));
            assert!(wrong.count() <= 1);
        }
    }

    #[test]
    fn the_covariance_says_how_far_it_is_off() {
        let motion = Rigid::new(Vec3::new(20.0, -5.0, 40.0), Vec3::new(0.01, -0.02, 0.005));
        let found =
            estimate(&camera(), &sightings(&motion, 0.5, 1000), Some(Rigid::identity()), &SEARCH).expect("a motion");
        let off = se3::log(&(motion.inverse() * found.sensor_from_reference));
        let squared = off.dot(&(found.covariance.try_inverse().expect("regular") * off));
        // Of six normal values more than 22 comes once in a thousand.
        assert!(squared < 22.0, "{squared}");
        // Even noise of ± 0.5 px has a σ of 0.29 px.
        assert!((0.2..0.45).contains(&found.pixel_std), "{}", found.pixel_std);
    }

    #[test]
    fn too_few_points_and_points_behind_give_no_motion() {
        let few = &sightings(&Rigid::identity(), 0.0, 1000)[..2];
        assert_eq!(estimate(&camera(), few, None, &SEARCH), None);
        let behind: Vec<Sighting> = sightings(&Rigid::identity(), 0.0, 1000)
            .into_iter()
            .map(|sighting| Sighting { point_mm: -sighting.point_mm, ..sighting })
            .collect();
        // A half turn brings them before the camera, but hardly one to where it was seen.
        let found = estimate(&camera(), &behind, Some(Rigid::identity()), &SEARCH);
        assert!(found.is_none_or(|found| found.num_inliers() < 10));
    }
}
