//! Names of a plate's edges, and of what a profile shows of them.

use crate::calibrate::Edge;
use crate::fit::Feature;

/// The edge's letter.
#[must_use]
pub const fn edge_name(edge: Edge) -> &'static str {
    match edge {
        Edge::P => "p",
        Edge::Q => "q",
    }
}

/// The feature in one word.
#[must_use]
pub const fn feature_name(feature: Feature) -> &'static str {
    match feature {
        Feature::Edge => "edge",
        Feature::Corner => "corner",
        Feature::Step => "step",
        Feature::Tip => "tip",
    }
}

/// What the feature is, in a sentence.
#[must_use]
pub const fn feature_hint(feature: Feature) -> &'static str {
    match feature {
        Feature::Edge => {
            "The surface ends and nothing follows: the point is half a pitch beyond its last one, on its line"
        }
        Feature::Corner => "Two flanks meet at an angle: the point is where their lines cross",
        Feature::Step => {
            "The surface jumps to another height: the point is at the jump, on the line of the nearer side"
        }
        Feature::Tip => {
            "A narrow thing stands out: the point is where its flanks meet, else its rounded top, else its middle"
        }
    }
}
