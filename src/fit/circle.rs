//! A circle in the laser plane, and a fitted one with its standard deviations.

use crate::geometry::Mat3;

use super::{FitError, algebraic, geometric, robust};

/// A circle in the laser plane, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circle {
    /// Centre across the line, mm.
    pub x_mm: f64,
    /// Centre along the range axis, mm.
    pub z_mm: f64,
    /// Radius, mm.
    pub radius_mm: f64,
}

impl Circle {
    /// Signed distance of a point from the circle, positive outside, mm.
    #[must_use]
    pub fn distance_mm(&self, x_mm: f64, z_mm: f64) -> f64 {
        let (dx, dz) = (x_mm - self.x_mm, z_mm - self.z_mm);
        // Not `hypot`: coordinates are far from overflow, and this is the innermost loop.
        (dx * dx + dz * dz).sqrt() - self.radius_mm
    }
}

/// A fitted circle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CircleFit {
    /// The circle.
    pub circle: Circle,
    /// Covariance of (x, z, radius), mm², from the residuals of this fit.
    pub covariance: Mat3,
    /// Root mean square of the distances from the circle, mm.
    pub rms_mm: f64,
}

/// The fits on offer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CircleMethod {
    /// Least squares of the equation; biased to small radii on short arcs.
    Kasa,
    /// Pratt's normalisation.
    Pratt,
    /// Taubin's normalisation.
    Taubin,
    /// Al-Sharadqah and Chernov's "hyper": no essential bias.
    Hyper,
    /// Orthogonal distances.
    Geometric,
    /// Orthogonal distances, points beyond three robust standard deviations left out.
    Robust,
}

impl CircleMethod {
    /// All fits, in the order in which they are offered.
    pub const ALL: [Self; 6] = [Self::Robust, Self::Geometric, Self::Hyper, Self::Taubin, Self::Pratt, Self::Kasa];

    /// Fits a circle to points (x, z) in the laser plane, mm.
    ///
    /// # Errors
    /// [`FitError::TooFewPoints`] below 3, [`FitError::Collinear`] if they do not bend.
    pub fn fit(self, x_mm: &[f64], z_mm: &[f64]) -> Result<Circle, FitError> {
        match self {
            Self::Kasa => algebraic::kasa(x_mm, z_mm),
            Self::Pratt => algebraic::pratt(x_mm, z_mm),
            Self::Taubin => algebraic::taubin(x_mm, z_mm),
            Self::Hyper => algebraic::hyper(x_mm, z_mm),
            Self::Geometric => {
                algebraic::hyper(x_mm, z_mm).and_then(|start| geometric::fit(x_mm, z_mm, start)).map(|fit| fit.circle)
            }
            Self::Robust => robust::fit(x_mm, z_mm).map(|fit| fit.circle),
        }
    }
}
