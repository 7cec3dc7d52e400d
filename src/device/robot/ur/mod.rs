//! Universal Robots: RTDE for pose and state, `URScript` for motion, the dashboard for whether it takes any.

pub mod dashboard;
mod driver;
pub mod rtde;
pub mod script;
mod state;
mod stream;

pub use driver::UrRobot;
