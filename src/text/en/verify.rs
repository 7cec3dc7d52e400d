//! Wording of the Verify step.

/// Where no session is open.
pub const NO_SESSION: &str = "Open a session to see what its calibration is worth on other data.";
/// Heading of a section.
pub const DISTANCES: &str = "Distances to lines and plane";
/// Heading of a section.
pub const STABILITY: &str = "Stability at a known point";
/// Heading of a section.
pub const CROSS_TARGET: &str = "On other targets";
/// Heading of a section.
pub const WORKPIECE: &str = "Workpiece";
