//! The search for the largest arc (Lin & Mu 2019, §2 and Fig. 3) as a pure state machine: it is told what was seen at each
//! step, and says where to go next.
//!
//! - [`settings`]: how to search, and where a step leads; [`report`]: a search as it stands; [`end`]: how it ended.
//! - `curve`: the fit of l² = R² − c (m − m₀)² over the real travel.
//! - `trace`: what the captures say, whoever decided on them: the curve, both stops, what does not fit.
//! - [`machine`]: where to go next. [`replay`]: the same captures played again, without deciding.
//!
//! - [`tip`]: the search for a tip, which is its own.
//!
//! `docs/search.md` tells it in words, with figures.

mod curve;
pub mod end;
pub mod machine;
pub mod replay;
pub mod report;
pub mod settings;
#[cfg(test)]
mod tests;
pub mod tip;
mod trace;

pub use end::SearchEnd;
pub use machine::{Search, SearchNext};
pub use replay::Replay;
pub use report::{CurveEstimate, SearchPhase, SearchPoint, SearchReport, StepSeen};
pub use settings::{DirectionFrame, SearchSettings, SettingsRefusal, StopRule};
pub use tip::{TipEnd, TipNext, TipSearch};
