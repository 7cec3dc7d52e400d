//! The live cell: robots and laser profilers over their own protocols, and the routines that drive them.
//!
//! Data flows one way: wire → message → driver → worker → routine → event. Nothing here knows of sessions: a routine
//! yields poses with profiles, and the floor above makes captures of them.
//!
//! - [`driver`]: what a robot and a profiler can be asked, whatever their make; [`robot`] and [`sensor`] hold the makes.
//! - [`bridge`]: the text bridge by which any other robot or profiler can be connected.
//! - [`setup`]: which driver at which address.
//! - [`link`]: the state of a connection, with its back-off; pure.
//! - [`safety`]: which motion is allowed; pure.
//! - [`search`]: the paper's search for the largest arc; pure.
//! - [`worker`]: one thread a device, which owns its driver.
//! - [`settle`]: when a capture counts; pure.
//! - [`routine`]: what a cell does as a whole: move, settle, capture, search.
//! - [`sim`]: a cell that serves the real protocols on loopback.
//!
//! # Rules of the wire
//! Every wait has a deadline. Messages are read by length and never by segment, and lengths are checked before anything is
//! allocated. A closed connection is an error. There is one outstanding request a connection. Each message type has a pure
//! `encode` and `parse`; one place does the I/O.

pub mod bridge;
pub mod driver;
pub mod error;
#[cfg(test)]
mod fake;
pub mod link;
pub mod robot;
pub mod routine;
pub mod safety;
pub mod search;
pub mod sensor;
pub mod settle;
pub mod setup;
pub mod sim;
pub mod wire;
pub mod worker;

pub use driver::{LinearMove, MoveState, ProfileReading, Readiness, RobotDriver, RobotReport, SensorDriver};
pub use error::DeviceError;
pub use link::LinkState;
pub use routine::{Measurement, Routine, RoutineEnd, RoutineEvent, StepCapture, Task};
pub use safety::{Arming, MotionLimits, MotionRefusal, WorkspaceBox};
pub use search::{SearchEnd, SearchPhase, SearchReport, SearchSettings};
pub use settle::SettleSettings;
pub use setup::{Endpoint, RobotKind, RobotSetup, SensorKind, SensorSetup};
pub use worker::{Deadlines, LiveProfile, RobotWorker, SensorWorker};
