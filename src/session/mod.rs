//! The document: what a session holds, its file format, and the way from its profiles to a problem to solve.

pub mod check;
pub mod edit;
pub mod error;
pub mod export;
pub mod format;
pub mod history;
pub mod import;
mod limits;
pub mod measure;
pub mod model;
pub mod samples;
pub mod scans;
pub mod sequence;
pub mod table;

pub use edit::{Edit, EditRefusal, Place, Row, SetupField};
pub use error::SessionError;
pub use format::{load, load_with_bytes, parse, save, to_json};
pub use history::{History, new_gesture};
pub use measure::{
    Measured, NotABallSession, NothingToSolve, ScanLine, ScanRange, ball_problem, measure, measure_in, problem,
    problem_of, sought,
};
pub use model::{
    Capture, Edge, FurtherTarget, Known, Published, Reading, Robot, Sensor, Session, Station, Target, Truth,
    UnknownFields, WrittenAngles,
};
pub use scans::SessionScan;
