//! Why a circle could not be fitted, or a profile holds no usable arc or edge.

use thiserror::Error;

use super::Feature;

/// Why a set of points has no circle.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum FitError {
    /// A circle has three unknowns.
    #[error("found {found} points; a circle needs at least {needed}")]
    TooFewPoints {
        /// Number of points given.
        found: usize,
        /// The least number that will do.
        needed: usize,
    },
    /// The points do not bend.
    #[error("the points lie on a straight line; a circle needs points that bend")]
    Collinear,
    /// The iteration left the realm of finite numbers.
    #[error("the circle fit did not settle on finite numbers; check the points for wild values")]
    Diverged,
}

/// Why a profile holds no usable arc of the ball.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum ArcRefusal {
    /// Next to nothing was measured.
    #[error("found {found} valid points; an arc needs at least {needed}. Move the ball into the sensor's range")]
    TooFewPoints {
        /// Number of valid points.
        found: usize,
        /// The least number that will do.
        needed: usize,
    },
    /// The target is something else.
    #[error("the session's target is no ball, so no arc is looked for")]
    NoBall,
    /// Nothing in the profile looks like a section of the ball.
    #[error(
        "no arc with a radius of up to {limit_mm:.2} mm found among {num_points} points. Check that the line crosses the ball"
    )]
    NoArc {
        /// The largest radius looked for, mm.
        limit_mm: f64,
        /// Number of valid points searched.
        num_points: usize,
    },
    /// There is a good arc, but no section of this ball is that large.
    #[error(
        "the arc has a radius of {found_mm:.3} mm, but the ball's is {ball_radius_mm:.3} mm. Check the ball's radius in the session"
    )]
    LargerThanBall {
        /// Radius of the arc found, mm.
        found_mm: f64,
        /// The ball's radius, mm.
        ball_radius_mm: f64,
    },
    /// The visible piece is too short to say where its centre is.
    #[error(
        "the arc spans only {found_deg:.1}°; at least {needed_deg:.0}° are needed. Move the line nearer to the ball's centre"
    )]
    TooShort {
        /// Angle seen from the centre, degrees.
        found_deg: f64,
        /// The least angle that will do, degrees.
        needed_deg: f64,
    },
    /// The circle could not be fitted.
    #[error(transparent)]
    Fit(#[from] FitError),
}

/// Why a profile holds no usable edge.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum EdgeRefusal {
    /// Next to nothing was measured.
    #[error("found {found} valid points; an edge needs at least {needed}. Move the plate into the sensor's range")]
    TooFewPoints {
        /// Number of valid points.
        found: usize,
        /// The least number that will do.
        needed: usize,
    },
    /// Nothing in the profile looks like what was asked for.
    #[error("no {name} found among {num_points} points. Check that the line crosses it", name = name(*feature))]
    NoFeature {
        /// What was looked for.
        feature: Option<Feature>,
        /// Number of valid points searched.
        num_points: usize,
    },
}

const fn name(feature: Option<Feature>) -> &'static str {
    match feature {
        None => "edge, corner or step",
        Some(Feature::Edge) => "edge",
        Some(Feature::Corner) => "corner",
        Some(Feature::Step) => "step",
        Some(Feature::Tip) => "tip",
    }
}

/// Why a profile does not show its target.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum Refusal {
    /// No arc of a ball.
    #[error(transparent)]
    Arc(#[from] ArcRefusal),
    /// No edge of a plate, and no tip.
    #[error(transparent)]
    Edge(#[from] EdgeRefusal),
}
