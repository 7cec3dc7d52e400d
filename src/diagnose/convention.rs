//! The convention doctor: solves with the poses read in every way that people get wrong, and ranks the ways by residual.

use crate::session::Session;
use crate::watch::{Cancelled, Watch};

use super::Case;
use super::finding::Finding;

/// One way to read the poses of a session.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PoseReading {}

impl PoseReading {
    /// The code of the fault that this reading mends.
    #[must_use]
    pub const fn code(&self) -> &'static str {
        "pose-convention"
    }

    /// Reads the poses of a session in this way.
    pub fn apply(&self, _session: &mut Session) {}
}

/// How well the data fit with the poses read in one way.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadingFit {
    /// The way.
    pub reading: PoseReading,
    /// Other ways that give the same rotations, by name.
    pub ties: Vec<PoseReading>,
    /// RMS residual, mm.
    pub rms_mm: f64,
    /// Whether it is the session as it is.
    pub is_as_given: bool,
}

/// The finding, if another way fits far better, and the ranking.
///
/// # Errors
/// [`Cancelled`] if `watch` says so.
pub fn examine(_case: Case<'_>, _watch: &mut dyn Watch) -> Result<(Option<Finding>, Vec<ReadingFit>), Cancelled> {
    Ok((None, Vec::new()))
}
