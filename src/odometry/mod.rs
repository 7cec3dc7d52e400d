//! RGB-D visual odometry: the motion of a colour and depth camera from its images alone (CN102692236, steps 1–7).
//!
//! # Conventions
//! - The **sensor** frame is that of the colour camera: x right, y down, z forward; a pixel's centre has whole coordinates.
//! - The **world** is the sensor at the first frame, or that of a given ground truth.
//! - Millimetres inside; metres at the edges, where the file formats have them.

//!
//! # Steps
//! | step of the patent | module |
//! | --- | --- |
//! | 1 the camera gives colour and depth | [`camera`] |
//! | 2 depth is aligned to colour, eq. (1)–(5) | [`align`] |
//! | 3 invalid and unstable depth is removed, the picture smoothed | [`depth_filter`], [`smooth`] ([`grey`]); both together: [`view`] |
//! | 4 a frame every T | [`cadence`] |
//! | 5 features and their descriptions | [`features`], [`descriptors`] |
//! | 6 nearest neighbours under a threshold | [`matching`] |
//! | 7 random samples, rigid motion | [`ransac`], [`rigid_motion`]; the whole as published: [`published`] |
//! | ours in place of 5 to 7 | [`ours`]: [`keyframe`], [`flow`], [`reprojection`] |
//! | distance and direction | [`trajectory`], [`evaluation`] |
//!
//! [`pipeline`] goes through them, frame after frame.

pub mod align;
pub mod cadence;
pub mod camera;
pub mod depth_filter;
pub mod descriptors;
pub mod evaluation;
pub mod features;
pub mod flow;
pub mod grey;
pub mod keyframe;
pub mod matching;
pub mod ours;
pub mod outcome;
pub mod pipeline;
pub mod published;
pub mod ransac;
pub mod reprojection;
pub mod rigid_motion;
pub mod smooth;
pub mod trajectory;
pub mod view;

pub use camera::{CameraError, DepthImage, Intrinsics, RgbdCamera, RgbdFrame};
pub use evaluation::{Evaluation, TimedPose, evaluate};
pub use outcome::{Failure, FrameOutcome, Match, Motion, Tracking};
pub use pipeline::{Estimator, Odometry, OdometryOptions};
pub use trajectory::{Odometer, Travel};
