//! The sequence of an RGB-D session: pictures, what the motion was found from, the way, and curves over time.

mod controls;
mod model;
mod over_time;
mod panel;
mod picture;
mod player;
mod trajectory;

pub use panel::{SequenceState, show};
