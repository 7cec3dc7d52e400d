//! Frame after frame: the steps of the patent in their order, with either estimator.

use crate::geometry::{Sensor, Transform, World};

use super::cadence::Cadence;
use super::camera::{DepthImage, RgbdCamera, RgbdFrame};
use super::depth_filter::DepthFilter;
use super::descriptors::Pattern;
use super::ours::{Ours, OursOptions};
use super::outcome::{Estimated, FrameOutcome, Motion, Tracking};
use super::published::{Published, PublishedOptions};
use super::trajectory::Odometer;
use super::view::View;

/// How the motion is estimated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Estimator {
    /// As the patent has it: pairs in space, the motion of the best sample.
    Published,
    /// Tracking from keyframes, and the motion by where points are seen.
    #[default]
    Ours,
}

impl Estimator {
    /// Its name in files.
    #[must_use]
    pub const fn id(self) -> &'static str {
        match self {
            Self::Published => "published",
            Self::Ours => "ours",
        }
    }
}

/// What can be set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OdometryOptions {
    /// How the motion is estimated.
    pub estimator: Estimator,
    /// Only a frame every so many seconds is used (T of the patent).
    pub period_s: Option<f64>,
    /// Which depth is used.
    pub depth: DepthFilter,
    /// Of the published estimator.
    pub published: PublishedOptions,
    /// Of ours.
    pub ours: OursOptions,
    /// Where the camera is at the first frame.
    pub world_from_first: Transform<World, Sensor>,
}

impl Default for OdometryOptions {
    fn default() -> Self {
        Self {
            estimator: Estimator::default(),
            period_s: None,
            depth: DepthFilter::default(),
            published: PublishedOptions::default(),
            ours: OursOptions::default(),
            world_from_first: Transform::identity(),
        }
    }
}

/// After so many frames in a row without a motion tracking is given up, and starts anew with the next that will do.
const MOST_LOST: usize = 15;

/// The motion of a camera from its images. It holds a keyframe and what it needs of the last frame: no more, however long
/// the sequence is.
#[derive(Clone, Debug)]
pub struct Odometry {
    camera: RgbdCamera,
    options: OdometryOptions,
    pattern: Pattern,
    cadence: Cadence,
    engine: Engine,
    odometer: Odometer,
    num_pushed: usize,
    num_lost: usize,
    last: Option<Last>,
    depth: DepthImage,
}

#[derive(Clone, Copy, Debug)]
struct Last {
    number: usize,
    world_from_sensor: Transform<World, Sensor>,
}

#[derive(Clone, Debug)]
enum Engine {
    Published(Published),
    Ours(Box<Ours>),
}

impl Odometry {
    /// Nothing seen yet.
    #[must_use]
    pub fn new(camera: RgbdCamera, options: OdometryOptions) -> Self {
        let engine = match options.estimator {
            Estimator::Published => Engine::Published(Published::default()),
            Estimator::Ours => Engine::Ours(Box::default()),
        };
        Self {
            camera,
            options,
            pattern: Pattern::default(),
            cadence: Cadence::new(options.period_s),
            engine,
            odometer: Odometer::default(),
            num_pushed: 0,
            num_lost: 0,
            last: None,
            depth: DepthImage::default(),
        }
    }

    /// The last frame's depth as the colour camera sees it, without what is not used.
    #[must_use]
    pub const fn aligned_depth(&self) -> &DepthImage {
        &self.depth
    }

    /// Takes the next frame.
    pub fn push(&mut self, frame: &RgbdFrame) -> FrameOutcome {
        let number = self.num_pushed;
        self.num_pushed += 1;
        let mut outcome = FrameOutcome {
            number,
            time_s: frame.time_s,
            tracking: Tracking::LeftOut,
            world_from_sensor: None,
            travel: self.odometer.travel(),
            features: Vec::new(),
            matches: Vec::new(),
        };
        if !self.cadence.takes(frame.time_s) {
            return outcome;
        }
        if self.num_lost >= MOST_LOST {
            match &mut self.engine {
                Engine::Published(published) => published.restart(),
                Engine::Ours(ours) => ours.restart(),
            }
        }
        let estimated = match View::of(frame, &self.camera, &self.options.depth) {
            Ok(view) => {
                self.depth.clone_from(&view.depth);
                self.estimate(view, frame.time_s)
            }
            Err(failure) => {
                self.depth = DepthImage::default();
                if let Engine::Ours(ours) = &mut self.engine {
                    ours.lose();
                }
                Estimated { features: Vec::new(), matches: Vec::new(), motion: Err(failure) }
            }
        };
        outcome.features = estimated.features;
        outcome.matches = estimated.matches;
        let world_from_sensor = match estimated.motion {
            Err(failure) => {
                self.num_lost += 1;
                outcome.tracking = Tracking::Lost(failure);
                return outcome;
            }
            Ok(None) => {
                outcome.tracking = Tracking::Started { is_after_gap: self.last.is_some() };
                self.last.map_or(self.options.world_from_first, |last| last.world_from_sensor)
            }
            Ok(Some(motion)) => {
                let last = self.last.map_or(self.options.world_from_first, |last| last.world_from_sensor);
                let world_from_sensor = last * Transform::from_rigid(motion.sensor_from_previous.inverse());
                outcome.tracking = Tracking::Tracked(Box::new(Motion {
                    previous: self.last.map_or(0, |last| last.number),
                    sensor_from_previous: motion.sensor_from_previous,
                    covariance: motion.covariance,
                    num_inliers: outcome.matches.iter().filter(|found| found.is_inlier).count(),
                    num_matches: outcome.matches.len(),
                    residual_px: motion.residual_px,
                    is_recognised: motion.is_recognised,
                }));
                renormalised(&world_from_sensor)
            }
        };
        self.num_lost = 0;
        self.last = Some(Last { number, world_from_sensor });
        let is_after_gap = outcome.tracking == Tracking::Started { is_after_gap: true };
        outcome.travel = self.odometer.advance(&world_from_sensor, is_after_gap);
        outcome.world_from_sensor = Some(world_from_sensor);
        outcome
    }

    fn estimate(&mut self, view: View, time_s: f64) -> Estimated {
        let (camera, pattern, options) = (&self.camera.color, &self.pattern, &self.options);
        match &mut self.engine {
            Engine::Ours(ours) => ours.push(view, time_s, camera, pattern, &options.ours),
            Engine::Published(published) => published.push(&view, camera, pattern, &options.published),
        }
    }
}

/// A thousand products later a quaternion would not be one of length 1 any more.
fn renormalised(pose: &Transform<World, Sensor>) -> Transform<World, Sensor> {
    let rotation = nalgebra::UnitQuaternion::new_normalize(*pose.rotation().quaternion());
    Transform::from_parts(pose.translation_mm(), rotation)
}
