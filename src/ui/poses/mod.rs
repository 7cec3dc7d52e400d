//! Step Poses: the stations in the robot's own convention, and which of them take part.

pub mod convention;
pub mod model;
pub mod panel;
