//! Step 2: the live cell. Connection, live profile, safety strip, search, next station, run, replay.

mod connection;
mod edges;
mod fields;
mod live;
mod machine;
pub mod memory;
pub mod model;
pub mod mounting;
pub mod next;
mod orientation;
mod panel;
mod settings;
mod strip;
mod work;

pub use memory::CellMemory;
pub use model::View;
pub use panel::{CaptureState, show, show_view};
pub use strip::stop_button;
