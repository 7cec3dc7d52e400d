//! The document: what a session holds, its file format, and the way from its profiles to a problem to solve.

pub mod check;
pub mod error;
pub mod format;
pub mod history;
pub mod measure;
pub mod model;
pub mod samples;

pub use error::SessionError;
pub use format::{load, parse, save, to_json};
pub use history::History;
pub use measure::{Measured, NotABallSession, ball_problem, measure};
pub use model::{Capture, Edge, Published, Reading, Robot, Sensor, Session, Station, Target, Truth, WrittenAngles};
