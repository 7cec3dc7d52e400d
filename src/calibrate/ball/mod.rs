//! Methods for a ball of known radius.
//!
//! Each file is one method; `assemble` turns what they find into a [`Solution`](super::Solution), the same way for all.

pub mod bundle;
pub mod fixed_point;
pub mod max_arc;
pub mod max_arc_step;

mod assemble;
mod curve;
mod passes;
mod pose_noise;
mod profile_sums;
mod side;
mod sweep;
mod variance_components;

pub use variance_components::VarianceSpread;

pub(crate) use curve::section_residual;

/// Three unknowns a station must cover the nine of the problem, with one station to spare for judging.
pub const MIN_STATIONS: usize = 4;
/// From here on the error figures are worth believing.
pub(crate) const RECOMMENDED_STATIONS: usize = 8;
