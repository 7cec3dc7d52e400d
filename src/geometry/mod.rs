//! Frames, rotations, pose conventions, profiles and statistics: the conventions page.
//!
//! # Conventions
//! - `dst_from_src` maps coordinates given in *src* to coordinates in *dst*; adjacent names cancel:
//!   `base_from_sensor = base_from_flange * flange_from_sensor`.
//! - **base**: the robot's base. **flange**: the frame whose pose the controller reports (with an active TOOL it is
//!   that TOOL). **sensor**: the laser plane is `y = 0`, `x` runs across the line, `z` along the range axis.
//! - Millimetres and radians inside, `f64` throughout. Degrees appear only at the edges, and then in the name.
//! - The tangent of SE(3) is ordered (rotation, translation) and perturbs from the right:
//!   `dst_from_src * exp(delta)`, so a perturbation is expressed in *src*.
//!
//! This floor is pure: no I/O, no clock, no randomness.

mod angle_order;
pub mod convention;
pub mod frame;
mod makers;
pub mod notation;
pub mod profile;
pub mod scatter;
pub mod se3;
pub mod so3;
pub mod stats;
pub mod transform;

pub use angle_order::{AngleOrder, Axis};
pub use convention::PoseConvention;
pub use frame::{Base, DepthCamera, Flange, Frame, Sensor, Target, Tcp, World};
pub use notation::PoseNotation;
pub use profile::Profile;
pub use scatter::Scatter;
pub use transform::Transform;

/// A point or vector in three dimensions, mm.
pub type Vec3 = nalgebra::Vector3<f64>;
/// A 3 × 3 matrix.
pub type Mat3 = nalgebra::Matrix3<f64>;
/// A rigid motion without frames in its type, for the inside of solver loops.
pub type Rigid = nalgebra::Isometry3<f64>;
