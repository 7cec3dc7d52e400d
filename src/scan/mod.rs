//! Points of a scanned part, in the base: profiles along a path become a cloud, and regions of it planes, teeth, cylinders
//! and balls.
//!
//! Long loops are shared by all processors, in pieces that do not depend on how many there are: same input, same bits. Only
//! [`files`] reads and writes.

pub mod cloud;
pub mod distances;
pub mod error;
pub mod examination;
pub mod files;
mod lanes;
mod linear;
mod neighbourhood;
pub mod plane;
pub mod point_set;
pub mod round;
pub mod segment;
pub mod teeth;

pub use cloud::{Cloud, ScanCapture};
pub use distances::{NUM_DRAWN, random_distances};
pub use error::ScanError;
pub use examination::{Region, Shapes, Wanted, plane_regions, region_name, shapes};
pub use plane::{MIN_PROFILES, Plane, PlaneAngle, PlaneEquation, PlaneFit, angle_between, fit_plane};
pub use point_set::PointSet;
pub use round::{Round, RoundKind, fit_round};
pub use segment::{SegmentOptions, find_planes, grow_plane, suitable_tolerance_mm};
pub use teeth::{Deviation, Measured, Teeth, Tooth, measure_teeth};
