//! Why a circle could not be fitted, or a profile holds no usable arc.

use thiserror::Error;

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
