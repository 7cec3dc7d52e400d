//! Why nothing can be measured on a scan, in words.

use thiserror::Error;

/// Why nothing can be measured on a scan or a region of it.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum ScanError {
    /// There is no profile in it.
    #[error("found a scan without profiles, which take part in it; a scan is a path of captures that hold profiles")]
    NoProfiles,
    /// No profile has a valid point.
    #[error("found no valid point in {num_profiles} profiles; check the sensor's range and exposure, and scan again")]
    NoPoints {
        /// Profiles looked at.
        num_profiles: usize,
    },
    /// More than can be addressed.
    #[error("found {found} points, at most {most} can be held; scan less, or thin the profiles")]
    TooManyPoints {
        /// Points found.
        found: usize,
        /// The most that can be held.
        most: usize,
    },
    /// A region holds too few points for what is asked of it.
    #[error("found {found} points for {what}, at least {needed} are needed; choose a larger region")]
    TooFewPoints {
        /// What is fitted.
        what: &'static str,
        /// Points found.
        found: usize,
        /// Points needed.
        needed: usize,
    },
    /// The points of a plane lie along a line.
    #[error(
        "the points lie along a line ({width_mm:.3} mm wide), which fits many planes; choose a region that is wide both ways"
    )]
    Line {
        /// How wide they are across the line, mm.
        width_mm: f64,
    },
    /// The plane that was looked for is not there.
    #[error("found no plane that holds at least {needed} of the points within {tolerance_mm} mm; raise the tolerance")]
    NoPlane {
        /// Points needed.
        needed: usize,
        /// Greatest distance of a point, mm.
        tolerance_mm: f64,
    },
    /// The teeth cannot be told.
    #[error(
        "found {found} teeth, at least 2 whole ones are needed for a pitch; scan more of the part, across its teeth"
    )]
    TooFewTeeth {
        /// Teeth found.
        found: usize,
    },
    /// The part is not the same all along the teeth.
    #[error(
        "the surfaces do not share a direction along which the part stays the same ({misfit_deg:.1}° off); choose a region \
         with the teeth alone"
    )]
    NotPrismatic {
        /// How far the surfaces are from one direction, degrees.
        misfit_deg: f64,
    },
    /// The points do not tell a ball or cylinder.
    #[error("the points do not tell the {what}: {why}; choose a region with more of it")]
    NotRound {
        /// Ball or cylinder.
        what: &'static str,
        /// What is wrong.
        why: &'static str,
    },
    /// A polygon without an area.
    #[error("found a polygon of {found} corners, at least 3 are needed")]
    NotAPolygon {
        /// Corners found.
        found: usize,
    },
}
