//! Hand-eye methods: what they are given, what they compute, and how good it is.
//!
//! Data flows `Problem` → [`solve`] → [`Solution`]. All methods for the ball end in the same form: every capture says
//! something about where the ball's centre lies in the sensor frame (a [`observation::CentreObservation`]), and one
//! small solver on SE(3) × R³ finds the sensor on the flange and the ball in the base from that.
//!
//! For a sensor fixed beside the robot ([`Mount::Fixed`]) the same problem is posed with every pose inverted: read
//! "base" where a name says flange, and "flange" where it says base.

pub mod ball;
mod components;
pub mod error;
pub mod joint;
pub mod method;
pub mod motion;
pub mod observation;
pub mod plate;
pub mod problem;
pub mod reduced;
pub mod rotation_start;
mod shared_warnings;
pub mod solution;
pub mod solver;
pub mod uncertainty;
pub mod validation;
pub mod verdict;
pub mod warning;

pub use error::SolveError;
pub use joint::{JointSolution, JointTarget, solve_joint};
pub use method::{Method, MethodResult, best_available, solution_of, solve, solve_all};
pub use motion::{
    ClosedForm, ClosedFormAnswer, MotionData, MotionFound, MotionPose, MotionReduced, RejectedPose, TrackReduced,
};
pub use plate::PlateReduced;
pub use problem::{
    BallProblem, Capture, Edge, MotionProblem, Mount, Noise, PlateProblem, PlateStation, Problem, Reading, Side,
    SideChoice, Station, TargetNoise,
};
pub use reduced::Reduced;
pub(crate) use shared_warnings::{ONE_AXIS_RATIO, RECOMMENDED_SPAN_DEG};
pub use solution::{
    AboveStated, EstimatedRadius, NoiseModel, PlateFound, PlatePoint, RmsMax, Solution, Starts, StationSolution, Sweep,
    SweepPoint, Uncertainty,
};
pub use verdict::{Verdict, VerdictReason};
pub use warning::{PoseFault, Warning};
