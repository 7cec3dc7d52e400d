//! Our estimator: points of a keyframe tracked to a few hundredths of a pixel, and the motion by where they are seen.
//!
//! A frame is first looked for where the motion so far lets it expect. If too little is found there, its corners are
//! compared by what they look like, as in the published method; the motion that this gives is then refined by tracking.

use nalgebra::Matrix6;

use crate::geometry::{Rigid, se3};

use super::camera::Intrinsics;
use super::depth_filter::DepthNoise;
use super::descriptors::Pattern;
use super::features::CornerSearch;
use super::keyframe::{Found, Keyframe};
use super::matching::mutual;
use super::outcome::{Estimated, EstimatedMotion, Failure, Match};
use super::published::Features;
use super::reprojection::{Estimate, Search, Sighting, estimate};
use super::view::View;

/// What can be set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OursOptions {
    /// The corners of a keyframe.
    pub corners: CornerSearch,
    /// How noisy depth is.
    pub noise: DepthNoise,
    /// Descriptors that differ in fewer of 256 bits may be the same place.
    pub most_bits: u32,
    /// The next keyframe is taken where less than this part of the landmarks is left.
    pub least_part: f64,
    /// The next keyframe is taken after this turn, rad.
    pub most_turn_rad: f64,
}

impl Default for OursOptions {
    fn default() -> Self {
        Self {
            corners: CornerSearch { most: 320, min_distance: 12.0, min_strength: 1.0 },
            noise: DepthNoise::KINECT,
            most_bits: 64,
            least_part: 0.8,
            most_turn_rad: 0.2,
        }
    }
}

/// With fewer points that agree a motion may be an accident.
pub const MIN_INLIERS: usize = 15;
/// Of what was tracked as much must agree, or something else than the room was tracked.
const LEAST_AGREEING: f64 = 0.3;
/// Levels down from which points are followed: an eighth of the size would hold too little of small pictures.
const COARSEST_LEVEL: usize = 2;
/// Points tracked are seen where they are to a pixel.
const TRACKED: Search = Search { most_trials: 60, threshold_px: 1.5, seed: 7 };
/// Points recognised are seen at whole pixels of the half-size picture, and some are others.
const RECOGNISED: Search = Search { most_trials: 500, threshold_px: 4.0, seed: 11 };

/// The estimator.
#[derive(Clone, Debug, Default)]
pub struct Ours {
    keyframe: Option<Current>,
}

#[derive(Clone, Debug)]
struct Current {
    keyframe: Keyframe,
    /// Of the last frame that was tracked; the identity where that is the keyframe.
    sensor_from_keyframe: Rigid,
    /// Covariance of that, without the part that all frames of the keyframe share.
    covariance: Matrix6<f64>,
    /// Twist a second of the last frames, as far as they were tracked without a gap.
    velocity: Option<nalgebra::Vector6<f64>>,
    time_s: f64,
}

impl Ours {
    /// Forgets everything: the next frame is one to start with.
    pub fn restart(&mut self) {
        self.keyframe = None;
    }

    /// Whether there is nothing yet to compare with.
    #[must_use]
    pub const fn is_at_start(&self) -> bool {
        self.keyframe.is_none()
    }

    /// Whatever comes next, it does not go on as before.
    pub const fn lose(&mut self) {
        if let Some(current) = &mut self.keyframe {
            current.velocity = None;
        }
    }

    /// Takes the next frame.
    pub fn push(
        &mut self,
        view: View,
        time_s: f64,
        camera: &Intrinsics,
        pattern: &Pattern,
        options: &OursOptions,
    ) -> Estimated {
        let Some(current) = &mut self.keyframe else {
            let keyframe = Keyframe::new(view, camera, &options.noise, &options.corners, pattern);
            if keyframe.num_landmarks() < MIN_INLIERS {
                let failure = Failure::TooFewFeatures { found: keyframe.num_landmarks(), needed: MIN_INLIERS };
                return Estimated {
                    features: keyframe.features().pixels.clone(),
                    matches: Vec::new(),
                    motion: Err(failure),
                };
            }
            let features = keyframe.features().pixels.clone();
            self.keyframe = Some(Current::of(keyframe, time_s));
            return Estimated { features, matches: Vec::new(), motion: Ok(None) };
        };
        let guess = current.predicted(time_s);
        let followed = current.follow(&view, camera, guess, COARSEST_LEVEL, options);
        let (sighted, is_recognised) = match followed {
            Ok(sighted) => (sighted, false),
            Err(lost) => match current.recognise(&view, camera, pattern, options) {
                Ok(sighted) => (sighted, true),
                Err(failure) => {
                    current.velocity = None;
                    let matches = lost.map_or_else(Vec::new, |lost| current.matches(&lost));
                    return Estimated { features: seen(&matches), matches, motion: Err(failure) };
                }
            },
        };
        let matches = current.matches(&sighted);
        let mut features = seen(&matches);
        let motion = current.advance(&sighted, time_s, is_recognised, options);
        let num_inliers = sighted.estimate.num_inliers();
        #[expect(clippy::cast_precision_loss, reason = "numbers of points")]
        let part = num_inliers as f64 / current.keyframe.num_landmarks() as f64;
        let turn_rad = current.sensor_from_keyframe.rotation.angle();
        if part < options.least_part || turn_rad > options.most_turn_rad {
            let keyframe = Keyframe::new(view, camera, &options.noise, &options.corners, pattern);
            // Where less can be seen than is left of the old one, that stays.
            if keyframe.num_landmarks() > num_inliers {
                features.clone_from(&keyframe.features().pixels);
                let velocity = current.velocity;
                *current = Current { velocity, ..Current::of(keyframe, time_s) };
            }
        }
        Estimated { features, matches, motion: Ok(Some(motion)) }
    }
}

fn seen(matches: &[Match]) -> Vec<[f32; 2]> {
    matches.iter().map(|found| found.now).collect()
}

/// Landmarks found in a frame, and the motion by them.
struct Sighted {
    found: Vec<Found>,
    sightings: Vec<Sighting>,
    estimate: Estimate,
}

impl Current {
    fn of(keyframe: Keyframe, time_s: f64) -> Self {
        Self { keyframe, sensor_from_keyframe: Rigid::identity(), covariance: Matrix6::zeros(), velocity: None, time_s }
    }

    /// Where the keyframe is by now if the camera goes on as it did.
    fn predicted(&self, time_s: f64) -> Rigid {
        /// What happens within longer times nobody knows, s.
        const LONGEST_S: f64 = 0.5;
        let elapsed_s = time_s - self.time_s;
        let Some(velocity) = self.velocity.filter(|_| (0.0..LONGEST_S).contains(&elapsed_s)) else {
            return self.sensor_from_keyframe;
        };
        se3::exp(&(velocity * elapsed_s)) * self.sensor_from_keyframe
    }

    /// Tracks the landmarks from a guess. What was found comes back even if it does not suffice.
    fn follow(
        &self,
        view: &View,
        camera: &Intrinsics,
        guess: Rigid,
        coarsest_level: usize,
        options: &OursOptions,
    ) -> Result<Sighted, Option<Box<Sighted>>> {
        let found = self.keyframe.find_in(view, camera, &guess, coarsest_level);
        let sightings = self.keyframe.sightings(&found, view, &options.noise);
        let estimate = estimate(camera, &sightings, Some(guess), &TRACKED).ok_or(None)?;
        let sighted = Sighted { found, sightings, estimate };
        if is_enough(&sighted.estimate) { Ok(sighted) } else { Err(Some(Box::new(sighted))) }
    }

    /// Recognises the keyframe by what its corners look like, then tracks from there.
    fn recognise(
        &self,
        view: &View,
        camera: &Intrinsics,
        pattern: &Pattern,
        options: &OursOptions,
    ) -> Result<Sighted, Failure> {
        let needed = MIN_INLIERS;
        let features = Features::of(view, camera, &options.corners, pattern);
        if features.pixels.len() < needed {
            return Err(Failure::TooFewFeatures { found: features.pixels.len(), needed });
        }
        let known = self.keyframe.features();
        let pairs = mutual(&known.descriptors, &features.descriptors, options.most_bits);
        if pairs.len() < needed {
            return Err(Failure::TooFast { found: pairs.len(), needed });
        }
        let found: Vec<Found> =
            pairs.iter().map(|pair| Found { landmark: pair.first, pixel: features.pixels[pair.second] }).collect();
        let sightings = self.keyframe.sightings(&found, view, &options.noise);
        let coarse = estimate(camera, &sightings, None, &RECOGNISED);
        let coarse = coarse.ok_or(Failure::NoAgreement { found: 0, needed })?;
        // A few that agree are enough to look there: tracking tells whether it is so.
        let found = coarse.num_inliers();
        if found < needed / 2 {
            return Err(Failure::TooFast { found, needed });
        }
        self.follow(view, camera, coarse.sensor_from_reference, 1, options).map_err(|sighted| {
            let found = sighted.map_or(0, |sighted| sighted.estimate.num_inliers());
            Failure::NoAgreement { found, needed }
        })
    }

    fn matches(&self, sighted: &Sighted) -> Vec<Match> {
        let pairs = sighted.found.iter().zip(&sighted.estimate.is_inlier);
        pairs
            .map(|(found, is_inlier)| Match {
                before: self.keyframe.last_seen(found.landmark),
                now: found.pixel,
                is_inlier: *is_inlier,
            })
            .collect()
    }

    fn advance(
        &mut self,
        sighted: &Sighted,
        time_s: f64,
        is_recognised: bool,
        options: &OursOptions,
    ) -> EstimatedMotion {
        let Sighted { found, sightings, estimate } = sighted;
        self.keyframe.learn(found, sightings, estimate, &options.noise);
        let keyframe_from_previous = self.sensor_from_keyframe.inverse();
        let sensor_from_previous = estimate.sensor_from_reference * keyframe_from_previous;
        // A perturbation of the keyframe's side, as the frame before sees it.
        let by_previous = se3::adjoint(&self.sensor_from_keyframe);
        let covariance = by_previous * (estimate.covariance + self.covariance) * by_previous.transpose();
        let elapsed_s = time_s - self.time_s;
        self.velocity = (elapsed_s > 0.0 && !is_recognised).then(|| se3::log(&sensor_from_previous) / elapsed_s);
        self.sensor_from_keyframe = estimate.sensor_from_reference;
        self.covariance = estimate.covariance;
        self.time_s = time_s;
        EstimatedMotion { sensor_from_previous, covariance, residual_px: estimate.pixel_std, is_recognised }
    }
}

fn is_enough(estimate: &Estimate) -> bool {
    #[expect(clippy::cast_precision_loss, reason = "numbers of points")]
    let part = estimate.num_inliers() as f64 / estimate.is_inlier.len().max(1) as f64;
    estimate.num_inliers() >= MIN_INLIERS && part >= LEAST_AGREEING
}
