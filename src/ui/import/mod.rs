//! The import's preview: what was read, how, and what to make of it.

mod fields;
pub mod memory;
pub mod model;
mod panel;
mod preview;
mod settings;

pub use memory::ImportMemory;
pub use panel::{ImportState, show};
