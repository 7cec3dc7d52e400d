//! Which plots stand on a page: one figure or a few for each question, from domain data.

mod arcs;
mod sheet;

use crate::calibrate::MethodResult;
use crate::diagnose::Diagnosis;
use crate::session::{Measured, Session};
use crate::verify::Verification;

use super::Figure;

/// What figures are made from. What is missing has no figures.
#[derive(Clone, Copy, Debug)]
pub struct Evidence<'a> {
    /// The document.
    pub session: &'a Session,
    /// What was found in its profiles.
    pub measured: &'a Measured,
    /// What the methods made of it.
    pub results: &'a [MethodResult],
    /// What is wrong with it, and how far it can be relied on.
    pub diagnosis: Option<&'a Diagnosis>,
    /// What the calibrations are worth on other data.
    pub verification: Option<&'a Verification>,
}

/// The figures that the data allow, in the order of a report.
#[must_use]
pub fn figures_of(evidence: &Evidence<'_>) -> Vec<Figure> {
    arcs::figures(evidence)
}
