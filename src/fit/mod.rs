//! Fits of circles and lines to profile points, and the extraction of arcs, edges and tips from a real profile.
//!
//! Everything here works in the laser plane: points (x, z) in mm, z along the range axis, whichever way it points.
//! This floor is pure; the random searches are seeded, so the same profile gives the same bits.

pub mod algebraic;
pub mod arc;
pub mod circle;
pub mod edge;
pub mod error;
pub mod geometric;
pub mod line;
pub mod ransac;
pub mod robust;
mod sought;
pub(crate) mod sums;
mod windows;

pub use arc::{ArcFit, ArcOptions, PointClass, extract_arc};
pub use circle::{Circle, CircleFit, CircleMethod};
pub use edge::{EdgeFit, EdgeOptions, Feature, Flank, Sighting, extract_edge};
pub use error::{ArcRefusal, EdgeRefusal, FitError, Refusal};
pub use sought::{Found, Sought};
