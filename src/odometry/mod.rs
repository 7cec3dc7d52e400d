//! RGB-D visual odometry: the motion of a colour and depth camera from its images alone (CN102692236, steps 1–7).
//!
//! # Conventions
//! - The **sensor** frame is that of the colour camera: x right, y down, z forward; a pixel's centre has whole coordinates.
//! - The **world** is the sensor at the first frame, or that of a given ground truth.
//! - Millimetres inside; metres at the edges, where the file formats have them.

pub mod camera;

pub use camera::{CameraError, DepthImage, Intrinsics, RgbdCamera, RgbdFrame};
