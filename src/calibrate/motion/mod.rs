//! `motion`: hand-eye calibration from the whole pose of a target at each pose of the robot, A X B = Z, which is A X = X B for
//! the motions between them.
//!
//! Data flows [`MotionProblem`] → the published closed forms ([`closed_form`]) → the best of them as a start → maximum
//! likelihood over the sensor on the flange and the target in the base, weighed by the noise of robot and target → poses that
//! contradict the others set aside → [`Solution`]. The robot's orientation noise acts through the lever from the flange to the
//! target and ties rotation and translation together; an unweighted refinement is worse than a closed form.

pub mod closed_form;
pub mod pair;
pub mod pose;

mod assemble;
mod found;
mod matched;
mod measured;
mod noise;
mod reduced;
mod refine;
mod rejection;
mod scale;
mod start;
mod steps;
pub mod streams;
mod stretches;
pub mod time_offset;
mod track;
mod track_noise;

pub use closed_form::ClosedForm;
pub use found::{Answered, ClosedFormAnswer, MotionData, MotionFound, MotionPose, RejectedPose, TimeOffset, Tracked};
pub use measured::MIN_POSES;
pub use pose::{MotionState, PosePair};
pub use reduced::{MotionReduced, MotionRefit};
pub use steps::UNKNOWN_STEP;
pub use steps::{TrackNoise, TrackPose};
pub use streams::{CameraPose, StreamProblem, Weighing, solve_streams};
pub use stretches::{TrackReduced, TrackRefit};

use crate::geometry::Rigid;

use super::{MotionProblem, Solution, SolveError, Warning};
use assemble::Found;
use measured::{Measured, measured};
use noise::MotionNoise;
use pair::chosen;
use refine::Minimum;
use rejection::settle_on_agreeing;

/// Solves.
///
/// # Errors
/// [`SolveError`] if nothing can be computed from this problem.
pub fn solve(problem: &MotionProblem) -> Result<Solution, SolveError> {
    let (measured, geometry) = measured(problem)?;
    let poses: Vec<PosePair> = measured.iter().map(|measured| measured.pose).collect();
    let start = start::start(&poses)?;
    let mut warnings = Vec::new();
    if let Some((ratio, distance_mm)) = start.other {
        warnings.push(Warning::OtherMinimum { ratio, distance_mm });
    }
    if let Some(ratio) = start::inverted(&poses, start::typical_mm(&start.state, &poses)) {
        warnings.push(Warning::StreamInverted { ratio });
    }
    let agreed = settle_on_agreeing(measured, start.state, MotionNoise::of(problem))?;
    Found { problem, geometry, answers: start.answers, agreed, warnings }.into_solution()
}

/// The refined answer alone, without tables and validation: from one closed form to the maximum of the likelihood.
///
/// # Errors
/// [`SolveError`] if nothing can be computed from this problem.
pub fn refined(problem: &MotionProblem) -> Result<Rigid, SolveError> {
    let (measured, start) = started(problem)?;
    Ok(refine::settle(&measured, start, MotionNoise::of(problem))?.minimum.unknowns.flange_from_sensor)
}

/// The minimum by the noise as it is stated.
fn least_squares(problem: &MotionProblem) -> Result<Minimum, SolveError> {
    let (measured, start) = started(problem)?;
    Ok(refine::settle_with(&measured, start, MotionNoise::of(problem))?.minimum)
}

fn started(problem: &MotionProblem) -> Result<(Vec<Measured<'_>>, MotionState), SolveError> {
    let (measured, _) = measured(problem)?;
    let poses: Vec<PosePair> = measured.iter().map(|measured| measured.pose).collect();
    let sensor = ClosedForm::Park.solve(&poses, &chosen(&poses)).ok_or(SolveError::Diverged)?;
    Ok((measured, MotionState::with_mean_target(sensor, &poses)))
}
