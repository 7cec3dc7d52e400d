//! What is looked for in the profiles of a target, whatever it is, and what is found in one.

use std::sync::Arc;

use crate::geometry::Profile;

use super::{ArcFit, ArcOptions, EdgeFit, EdgeOptions, Feature, Refusal, extract_arc, extract_edge};

/// What is looked for in a profile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sought {
    /// The arc of a ball.
    Arc(ArcOptions),
    /// The edge of a plate, or a tip.
    Edge(EdgeOptions),
}

/// What was found in a profile.
#[derive(Clone, Debug, PartialEq)]
pub enum Found {
    /// The arc of a ball.
    Arc(Arc<ArcFit>),
    /// The edge of a plate, or a tip.
    Edge(Arc<EdgeFit>),
}

impl Sought {
    /// Looks for it.
    ///
    /// # Errors
    /// [`Refusal`], with the reason in words.
    pub fn find(&self, profile: &Profile) -> Result<Found, Refusal> {
        match self {
            Self::Arc(options) => Ok(Found::Arc(Arc::new(extract_arc(profile, options)?))),
            Self::Edge(options) => Ok(Found::Edge(Arc::new(extract_edge(profile, options)?))),
        }
    }

    /// The ball, if that is what is looked for.
    #[must_use]
    pub const fn ball(&self) -> Option<&ArcOptions> {
        match self {
            Self::Arc(options) => Some(options),
            Self::Edge(_) => None,
        }
    }

    /// Whether a tip is looked for.
    #[must_use]
    pub fn is_tip(&self) -> bool {
        matches!(self, Self::Edge(EdgeOptions { feature: Some(Feature::Tip), .. }))
    }
}

impl Found {
    /// The arc, if that is what was found.
    #[must_use]
    pub const fn arc(&self) -> Option<&Arc<ArcFit>> {
        match self {
            Self::Arc(arc) => Some(arc),
            Self::Edge(_) => None,
        }
    }

    /// The edge point or tip, if that is what was found.
    #[must_use]
    pub const fn edge(&self) -> Option<&Arc<EdgeFit>> {
        match self {
            Self::Arc(_) => None,
            Self::Edge(edge) => Some(edge),
        }
    }
}
