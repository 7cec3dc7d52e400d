//! Which plots stand on a page: one figure or a few for each question, from domain data.

mod arcs;
mod sheet;

use crate::report::evidence::Evidence;

use super::Figure;

/// The figures that the data allow, in the order of a report.
#[must_use]
pub fn figures_of(evidence: &Evidence<'_>) -> Vec<Figure> {
    arcs::figures(evidence)
}
