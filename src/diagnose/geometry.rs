//! What the poses alone show: too little rotation, one axis, twins, travel and steps.

use super::Case;
use super::finding::Finding;

/// What there is to find.
#[must_use]
pub fn examine(_case: Case<'_>) -> Vec<Finding> {
    Vec::new()
}
