//! Suspicions with a number: radius, profile scale, drift, a switched tool, mirrored axes, wrong sides.

use super::Case;
use super::finding::Finding;

/// What there is to find.
#[must_use]
pub fn examine(_case: Case<'_>) -> Vec<Finding> {
    Vec::new()
}
