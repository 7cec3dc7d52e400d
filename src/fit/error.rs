//! Why a circle could not be fitted, or a profile holds no usable arc or edge.

use thiserror::Error;

use super::{Feature, Sighting};

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
    /// No piece of the profile is straight.
    #[error(
        "no straight piece of at least {needed} points found among {num_points}; a plate's surface is one. Check that the line crosses the plate"
    )]
    NoFlank {
        /// Number of valid points searched.
        num_points: usize,
        /// Points that make a flank.
        needed: usize,
    },
    /// Nothing in the profile looks like what was asked for.
    #[error("no {name} found among {num_points} points. Check that the line crosses it, and that it is well inside the field of view", name = name(*feature))]
    NoFeature {
        /// What was looked for.
        feature: Option<Feature>,
        /// Number of valid points searched.
        num_points: usize,
    },
    /// The profile shows something, but not what was asked for.
    #[error(
        "no {name} found, but {seen}. Move the line to the {name}, or choose what is seen",
        name = name(Some(*wanted)),
        seen = listed(seen)
    )]
    OtherFeature {
        /// What was looked for.
        wanted: Feature,
        /// What there is.
        seen: Vec<Sighting>,
    },
    /// There are several, and nothing tells which is meant.
    #[error("found {seen}; exactly one may be in view. Move the sensor so that the others leave its field of view", seen = listed(seen))]
    Ambiguous {
        /// What there is.
        seen: Vec<Sighting>,
    },
    /// The surface hardly bends.
    #[error(
        "the flanks meet at {found_deg:.1}°; a corner needs at least {needed_deg:.0}°. Tilt the sensor, or let the line cross a sharper edge"
    )]
    TooFlat {
        /// Angle between the flanks, degrees.
        found_deg: f64,
        /// The least angle that will do, degrees.
        needed_deg: f64,
    },
    /// What stands out is no tip.
    #[error(
        "what stands out is {found_mm:.2} mm wide; a tip is below {limit_mm:.2} mm in this field of view. Move the line nearer to its end"
    )]
    TipTooWide {
        /// Its width, mm.
        found_mm: f64,
        /// The largest width that will do, mm.
        limit_mm: f64,
    },
}

fn listed(seen: &[Sighting]) -> String {
    let named: Vec<String> =
        seen.iter().map(|seen| format!("{} at x = {:.2} mm", article(seen.feature), seen.x_mm)).collect();
    named.join(" and ")
}

const fn article(feature: Feature) -> &'static str {
    match feature {
        Feature::Edge => "an edge",
        Feature::Corner => "a corner",
        Feature::Step => "a step",
        Feature::Tip => "a tip",
    }
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
