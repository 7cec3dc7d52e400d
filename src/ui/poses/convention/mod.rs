//! In which numbers the poses are shown, and what numbers mean: the bar above the pose table, its dialogs, and the picture
//! of the first poses.

mod editor;
pub mod model;
mod paint;
mod panel;
mod picker;
mod reinterpret;

pub use panel::{ConventionState, bar};
