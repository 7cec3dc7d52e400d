//! A station's sweep: the steps with a usable arc, and what both largest-arc methods share.

use crate::calibrate::shared_warnings::{first_refusal, refused_captures};
use crate::calibrate::{BallProblem, Mount, Reading, SolveError, Station, Warning};
use crate::fit::ArcFit;
use crate::geometry::{Mat3, Rigid, Vec3};

use super::MIN_STATIONS;

/// Three unknowns (the ball's centre) need more than one section; three show that the curve bends.
pub(super) const MIN_STEPS: usize = 3;
/// Travel below this between first and last step is no sweep, mm.
const MIN_TRAVEL_MM: f64 = 1e-3;
/// Commanded and real travel that differ by more than this part of the step are worth a warning.
const STEP_TOLERANCE_PART: f64 = 0.1;
/// Below this the difference is the noise of any arm's display, mm.
const STEP_TOLERANCE_MM: f64 = 0.1;

/// A step of the sweep.
#[derive(Clone, Copy, Debug)]
pub(super) struct SweepStep<'a> {
    pub capture_idx: usize,
    pub base_from_flange: &'a Rigid,
    pub arc: &'a ArcFit,
    /// The robot's travel from the first capture, in the flange frame of the first capture, mm.
    pub travel_in_flange: Vec3,
    /// Commanded travel from the first capture, mm.
    pub commanded_mm: Option<f64>,
}

/// A station with a usable sweep.
#[derive(Clone, Debug)]
pub(super) struct StationSweep<'a> {
    pub station: &'a Station,
    pub first_pose: &'a Rigid,
    pub steps: Vec<SweepStep<'a>>,
}

/// All usable sweeps of a problem; stations without one are named in the warnings.
///
/// # Errors
/// [`SolveError::TooFewSweeps`] below four.
pub(super) fn sweeps<'a>(
    problem: &'a BallProblem,
    warnings: &mut Vec<Warning>,
) -> Result<Vec<StationSweep<'a>>, SolveError> {
    let mut sweeps = Vec::with_capacity(problem.stations.len());
    let mut skipped = Vec::new();
    for station in &problem.stations {
        let steps: Vec<SweepStep<'a>> = steps(station, problem.mount);
        let travels = steps.iter().any(|step| step.travel_in_flange.norm() > MIN_TRAVEL_MM);
        if steps.len() >= MIN_STEPS && travels {
            sweeps.push(StationSweep { station, first_pose: station.captures[0].base_from_flange.rigid(), steps });
        } else {
            skipped.push(Warning::StationSkipped {
                label: station.label.clone(),
                found: steps.len(),
                needed: MIN_STEPS,
            });
        }
    }
    if sweeps.len() < MIN_STATIONS {
        return Err(SolveError::TooFewSweeps {
            found: sweeps.len(),
            needed: MIN_STATIONS,
            steps: MIN_STEPS,
            refusal: first_refusal(&problem.stations),
        });
    }
    warnings.extend(refused_captures(&problem.stations));
    warnings.append(&mut skipped);
    Ok(sweeps)
}

fn steps(station: &Station, mount: Mount) -> Vec<SweepStep<'_>> {
    let Some(first) = station.captures.first() else {
        return Vec::new();
    };
    let first_pose = first.base_from_flange.rigid();
    let travel_in_flange = |pose: &Rigid| match mount {
        Mount::OnFlange => first_pose.rotation.inverse() * (pose.translation.vector - first_pose.translation.vector),
        // The poses are inverted and the sensor stands still: the robot's own travel, turned round. Taken from the inverted
        // translations it would carry the noise of the orientation at the lever of the whole arm.
        Mount::Fixed => first_pose.inverse().translation.vector - pose.inverse().translation.vector,
    };
    station
        .captures
        .iter()
        .enumerate()
        .filter_map(|(capture_idx, capture)| match &capture.reading {
            Reading::Arc(arc) => {
                let base_from_flange = capture.base_from_flange.rigid();
                Some(SweepStep {
                    capture_idx,
                    base_from_flange,
                    arc,
                    travel_in_flange: travel_in_flange(base_from_flange),
                    commanded_mm: capture.commanded_travel_mm,
                })
            }
            Reading::Edge(_) | Reading::Refused(_) | Reading::Point(_) | Reading::Pose(_) => None,
        })
        .collect()
}

/// The direction in the flange frame along which the sweeps travel, its sign as of the commanded steps where recorded.
pub(super) fn travel_direction(sweeps: &[StationSweep<'_>]) -> Vec3 {
    let steps = || sweeps.iter().flat_map(|sweep| &sweep.steps);
    let spread: Mat3 = steps().map(|step| step.travel_in_flange * step.travel_in_flange.transpose()).sum();
    let eigen = spread.symmetric_eigen();
    let direction = eigen.eigenvectors.column(eigen.eigenvalues.imax()).into_owned();
    let agreement: f64 =
        steps().map(|step| step.commanded_mm.unwrap_or(0.0) * direction.dot(&step.travel_in_flange)).sum();
    if agreement < 0.0 { -direction } else { direction }
}

/// A warning for the station whose recorded poses differ most from the commanded steps.
pub(super) fn step_warning(sweeps: &[StationSweep<'_>], direction: Vec3) -> Option<Warning> {
    sweeps
        .iter()
        .filter_map(|sweep| {
            let difference_mm = sweep
                .steps
                .iter()
                .filter_map(|step| {
                    step.commanded_mm.map(|commanded| (commanded - direction.dot(&step.travel_in_flange)).abs())
                })
                .fold(0.0, f64::max);
            let extent_mm = sweep.steps.iter().map(|step| step.travel_in_flange.norm()).fold(0.0, f64::max);
            #[expect(clippy::cast_precision_loss, reason = "a sweep has few steps")]
            let mean_step_mm = extent_mm / sweep.steps.len() as f64;
            let tolerance_mm = STEP_TOLERANCE_MM.max(STEP_TOLERANCE_PART * mean_step_mm);
            (difference_mm > tolerance_mm)
                .then(|| Warning::StepDiffersFromPose { label: sweep.station.label.clone(), difference_mm })
        })
        .max_by(|a, b| match (a, b) {
            (
                Warning::StepDiffersFromPose { difference_mm: a, .. },
                Warning::StepDiffersFromPose { difference_mm: b, .. },
            ) => a.total_cmp(b),
            _ => std::cmp::Ordering::Equal,
        })
}
