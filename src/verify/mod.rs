//! What a calibration is worth on other data than its own: distances to lines and planes, a touched point, other targets
//! (Chen et al. 2023, section 4).
//!
//! Everything here takes a `flange_from_sensor`, wherever it comes from, and data that are already reduced from profiles:
//! a [`crate::calibrate::Problem`]. [`study`] puts the parts together for all calibrations and targets at hand.

pub mod ball_centre;
pub mod cross_target;
pub mod difference;
pub mod distances;
pub mod drift;
pub mod figures;
mod kendall;
pub mod matrix_check;
pub mod matrix_text;
pub mod stability;
pub mod study;

pub use cross_target::{Evaluation, NotEvaluated, Seen, StationError, evaluate};
pub use distances::{Distances, EdgePoint, Line};
pub use figures::{Figures, Histogram};
pub use matrix_check::{ColumnFault, GivenMatrix, MatrixCheck, MatrixDifference, Suspect};
pub use matrix_text::{MatrixRefusal, parse_matrix};
pub use stability::{Measurement, Stability};
pub use study::{Calibration, Joint, Origin, RefusedCapture, TargetCase, TargetEvidence, Verification, verify};
