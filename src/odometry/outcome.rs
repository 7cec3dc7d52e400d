//! What is known of a frame: its motion, or why there is none, and what was seen in it.

use nalgebra::Matrix6;

use crate::geometry::{Rigid, Sensor, Transform, World, se3};

use super::trajectory::Travel;

/// What became of one frame.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameOutcome {
    /// Number of the frame among those that were given, from 0.
    pub number: usize,
    /// Its time, s.
    pub time_s: f64,
    /// Its motion, or why there is none.
    pub tracking: Tracking,
    /// Where the camera was; `None` where tracking failed or the frame was left out.
    pub world_from_sensor: Option<Transform<World, Sensor>>,
    /// How far it has come by then.
    pub travel: Travel,
    /// Corners seen in this frame, px.
    pub features: Vec<[f32; 2]>,
    /// Points seen in an earlier frame and in this one.
    pub matches: Vec<Match>,
}

/// A point seen in two frames.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Match {
    /// Where it was seen before, px.
    pub before: [f32; 2],
    /// Where it is seen in this frame, px.
    pub now: [f32; 2],
    /// Whether it agrees with the motion.
    pub is_inlier: bool,
}

/// Whether the motion of a frame is known.
#[derive(Clone, Debug, PartialEq)]
pub enum Tracking {
    /// Between two frames of the period: left out on purpose.
    LeftOut,
    /// The first frame, or the first one after tracking was given up: nothing to compare with.
    Started {
        /// What the camera did before is not known: the trajectory has a gap here, and goes on from the last known pose.
        is_after_gap: bool,
    },
    /// The motion is known.
    Tracked(Box<Motion>),
    /// It is not.
    Lost(Failure),
}

/// The motion since the last frame that was tracked.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    /// Number of that frame.
    pub previous: usize,
    /// Maps points of that frame's sensor to this one's, mm.
    pub sensor_from_previous: Rigid,
    /// Covariance of a perturbation from the right (rotation in rad, translation in mm).
    pub covariance: Matrix6<f64>,
    /// Matches that agree with it.
    pub num_inliers: usize,
    /// Matches in all.
    pub num_matches: usize,
    /// Spread of a coordinate of a pixel about where the motion has it, px; of the published method, root mean square.
    pub residual_px: f64,
    /// Whether the place was recognised by what it looks like, as it could not be followed.
    pub is_recognised: bool,
}

impl Motion {
    /// The covariance along the axes of the camera at this frame: of a perturbation from the left.
    #[must_use]
    pub fn covariance_in_sensor(&self) -> Matrix6<f64> {
        let by_sensor = se3::adjoint(&self.sensor_from_previous);
        by_sensor * self.covariance * by_sensor.transpose()
    }
}

/// What an estimator makes of a frame.
#[derive(Clone, Debug)]
pub struct Estimated {
    /// Corners of this frame.
    pub features: Vec<[f32; 2]>,
    /// Points of an earlier frame seen again.
    pub matches: Vec<Match>,
    /// The motion; none for a frame to start with.
    pub motion: Result<Option<EstimatedMotion>, Failure>,
}

/// The motion since the last frame that was tracked, as an estimator has it.
#[derive(Clone, Debug)]
pub struct EstimatedMotion {
    /// As in [`Motion`].
    pub sensor_from_previous: Rigid,
    /// As in [`Motion`].
    pub covariance: Matrix6<f64>,
    /// As in [`Motion`].
    pub residual_px: f64,
    /// As in [`Motion`].
    pub is_recognised: bool,
}

/// Why the motion of a frame is not known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Failure {
    /// The images have not the size of the camera.
    WrongSize {
        /// Columns and rows of the colour image, then of the depth image.
        found: [u32; 4],
        /// What they must be.
        needed: [u32; 4],
    },
    /// The picture is black, or nearly so.
    TooDark {
        /// Mean grey value, of 255.
        mean: f64,
        /// The least that will do.
        needed: f64,
    },
    /// Hardly anything is known of the depth.
    BlankDepth {
        /// Part of the pixels that have a depth, %.
        found_percent: f64,
        /// The least that will do, %.
        needed_percent: f64,
    },
    /// The picture shows too little to hold on to, or what it shows has no depth.
    TooFewFeatures {
        /// Corners with a depth.
        found: usize,
        /// The least that will do.
        needed: usize,
    },
    /// What was seen before is not seen again: moved too fast, covered, or elsewhere.
    TooFast {
        /// Points seen again.
        found: usize,
        /// The least that will do.
        needed: usize,
    },
    /// Points are seen again, but they do not agree on one motion.
    NoAgreement {
        /// Points that agree.
        found: usize,
        /// The least that will do.
        needed: usize,
    },
}

impl Failure {
    /// Its name in files.
    #[must_use]
    pub const fn code(&self) -> &'static str {
        match self {
            Self::WrongSize { .. } => "wrong-size",
            Self::TooDark { .. } => "too-dark",
            Self::BlankDepth { .. } => "blank-depth",
            Self::TooFewFeatures { .. } => "too-few-features",
            Self::TooFast { .. } => "too-fast",
            Self::NoAgreement { .. } => "no-agreement",
        }
    }
}
