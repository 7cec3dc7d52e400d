//! Universal Robots: RTDE for pose and state, `URScript` for motion, the dashboard for whether it takes any.

pub mod dashboard;
pub mod rtde;
pub mod script;
