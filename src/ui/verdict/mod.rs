//! The verdict in a band: a word, the headline figure, which method is better, and the next step. Compare and Diagnosis
//! both begin with it.

mod band;
mod model;

pub use band::show;
pub use model::NextStep;
