//! How long work reports progress and learns that it is no longer wanted.

use std::sync::Arc;

use thiserror::Error;

/// The work was cancelled; there is no result.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[error("cancelled")]
pub struct Cancelled;

/// Takes progress and answers whether to go on. Long functions take `&mut dyn Watch`.
pub trait Watch {
    /// `done` of `total` parts are finished.
    ///
    /// # Errors
    /// [`Cancelled`] if nobody wants the result any more; pass it on with `?`.
    fn report(&mut self, done: usize, total: usize) -> Result<(), Cancelled>;
}

/// Watches nothing and never cancels.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unwatched;

impl Watch for Unwatched {
    fn report(&mut self, _done: usize, _total: usize) -> Result<(), Cancelled> {
        Ok(())
    }
}

/// Called from a worker when there is news, e.g. to ask for a repaint.
pub type Wake = Arc<dyn Fn() + Send + Sync>;
